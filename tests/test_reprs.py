"""What a value is called where it is typed at a prompt: a line, however much it holds."""

from pathlib import Path

import numpy as np
import pytest

import lightcube as lc
from lightcube.pictures import samples

ROOT = Path(__file__).parents[1]


def of_everything() -> dict[str, object]:
    pictures = samples.photographs(3)
    plan = lc.plan(pictures, 8)
    solution = lc.solve(plan.targets, plan.grid, lc.Recipe(passes=2))
    stage, *_ = lc.read_stage(str(ROOT / "examples" / "stages" / "two-screens.toml"))
    alike = lc.Pictures((np.ones((2, 3, 3), np.float32), np.ones((2, 3, 3), np.float32)), ("a", "b"))
    values = [pictures, alike, plan, plan.targets, plan.targets.rig, plan.prediction, solution, solution.cube, stage]
    values += [
        lc.Grid((5, 7, 6)),
        lc.Recipe(),
        lc.Material(),
        lc.read_dyes("polyjet"),
        lc.METHODS,
        lc.Projector(plan.grid, plan.targets.rig),
    ]
    values += [lc.Mesh(np.eye(4, 3), np.array([[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]))]
    square = np.pad(np.zeros((4, 4, 3), np.float32), ((2, 2), (2, 2), (0, 0)), constant_values=1)
    drawn = lc.Pictures((square,) * 3, ("a", "b", "c"))
    given = lc.silhouettes(lc.cut(drawn), lc.walls(lc.Grid((5, 7, 6))).rig())
    shape = lc.hull(given, lc.Grid((5, 7, 6)))
    values += [*lc.cut(drawn), given, shape, lc.reach(given, shape.grid), lc.certify(shape.mesh, given)]
    return {f"{type(value).__name__}-{index}": value for index, value in enumerate(values)}


EVERYTHING = of_everything()


@pytest.mark.parametrize("name", EVERYTHING)
def test_a_value_is_a_line(name: str) -> None:
    said = repr(EVERYTHING[name])
    assert len(said) <= 240
    assert "\n" not in said
    assert "array(" not in said


def test_it_says_how_much_there_is() -> None:
    assert repr(EVERYTHING["Pictures-0"]) == "<3 pictures of 2 sizes>"
    assert repr(EVERYTHING["Pictures-1"]) == "<2 pictures of 2 x 3 pixels>"
    assert repr(EVERYTHING["Stage-8"]).startswith("<stage of 2 lamps, 2 screens, 16 pictures, 8 stops, Grid(")
    assert "after 2 passes (iterations)" in repr(EVERYTHING["Solution-6"])
