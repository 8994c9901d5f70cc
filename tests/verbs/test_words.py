"""What is said of pictures: how near they come, which are no good, and what would help."""

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lightcube.backward.recipe import Recipe
from lightcube.optics.glass import Glass
from lightcube.optics.grid import Grid
from lightcube.optics.light import Light
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.pictures.fitting import Fit
from lightcube.pictures.pictures import Pictures
from lightcube.pictures.turntable import Turntable
from lightcube.planning.plan import Plan, plan
from lightcube.scoring.metrics import nearness
from lightcube.verbs import words

NAMES = ("a", "b", "c", "d")
GRID = Grid((6, 8, 8))


def rig(shape: tuple[int, int]) -> Rig:
    return turntable(GRID, [0, 90], picture_shape=shape)


def planned(*sizes: tuple[int, int], fit: Fit = "crop") -> Plan:
    """A plan for grey pictures of sizes, called after their numbers."""
    read = Pictures(tuple(np.full((*size, 3), 0.5, np.float32) for size in sizes), tuple(map(str, range(len(sizes)))))
    return plan(read, 8, fit=fit, recipe=Recipe(), picture_width=1.0)


def doubts_of_cropping(planned: Plan) -> list[str]:
    return [line for line in words.in_short(planned, None) if "cropping" in line]


def test_pictures_that_lose_more_than_a_third_are_named_the_worst_first() -> None:
    (said,) = doubts_of_cropping(planned((24, 24), (24, 60), (96, 24), (24, 35)))
    assert said.startswith("doubtful: cropping cuts off 75% of 2, 60% of 1: ")
    for helps in ("check --sheet", "--focus X,Y", "--fit pad"):
        assert helps in said
    (said,) = doubts_of_cropping(planned((9, 9), *[(9, 14 + each) for each in range(7)]))
    assert said.startswith("doubtful: cropping cuts off 55% of 7, 53% of 6, 50% of 5, 47% of 4, 44% of 3 and 2 more: ")


@pytest.mark.parametrize("fit", ["pad", "stretch"])
def test_nothing_is_cut_off_where_nothing_is_cropped_or_little(fit: Fit) -> None:
    assert doubts_of_cropping(planned((24, 24), (24, 60), fit=fit)) == []
    assert doubts_of_cropping(planned((24, 24), (24, 35), (24, 24))) == []


def test_how_far_away_the_screen_stands_is_said_where_it_matters() -> None:
    read = Pictures((np.full((4, 4, 3), 0.5, np.float32),) * 2, ("a", "b"))

    def said(**table: Any) -> list[str]:
        made = plan(read, 8, size_mm=80.0, picture_width=0.5, turntable=Turntable(**table), told=False)
        return [line for line in words.in_short(made, None) if "screen stands" in line]

    assert said() == []
    assert said(glass=Glass(1.5, "cylinder")) == ["the screen stands 120 mm behind the axis"]
    assert said(lamp_deg=0.5, screen_mm=30.0) == [f"the screen stands {30 + 40 * 2**0.5:.0f} mm behind the axis"]


@pytest.mark.parametrize("light", [Light(), Light(grain=0.01), Light(grain=2.0), Light.thin()])
def test_what_is_grainy_from_close_up_is_told_plainly_and_what_helps(light: Light) -> None:
    smooth, fine, coarse = (words.from_near(rms, light) for rms in (0.02, 0.05, 0.2))
    assert "smooth" in smooth
    assert "a little grainy" in fine
    assert "--" not in smooth + fine
    assert coarse.startswith("from close up, the pictures look grainy, like coarse film: stand further back")
    asked = re.findall(r"--grain ([0-9.]+)", coarse)
    assert len(asked) == (light.grain < 2 and not light.is_thin)
    assert all(light.grain < float(each) <= 2 for each in asked)
    assert ("--light thin" in coarse) == light.is_thin


def test_words_for_how_near_pictures_come_fall_with_the_figures() -> None:
    kinds = ["poor", "fair", "good", "hard to tell from what is wanted"]
    found = [nearness(decibels) for decibels in (0, 25.99, 26, 32.9, 33, 39.9, 40, 100)]
    assert found == [kind for kind in kinds for _ in (0, 1)]


@pytest.mark.parametrize(
    ("psnr", "said"),
    [
        ((44, 50, 41, 90), "well: all 4 pictures are hard to tell from what is wanted"),
        ((20, 9, 3, 1), "wrong: all 4 pictures are poor"),
        ((34, 45, 35, 46), "well: of 4 pictures 2 are hard to tell from what is wanted and 2 are good"),
        (
            (34, 9, 45, 20),
            "wrong: of 4 pictures 1 are hard to tell from what is wanted, 1 are good and 2 are poor (b, d)",
        ),
        ((34, 29, 28, 35), "well: of 4 pictures 2 are good and 2 are fair (c, b)"),
    ],
)
def test_pictures_are_judged_best_first_and_the_worst_are_named(psnr: tuple[float, ...], said: str) -> None:
    assert words.judged(NAMES, psnr, "are", rig((3, 5))) == said.replace("1 are", "1 is") + ", at 5 x 3 pixels"


def test_one_picture_is_one() -> None:
    assert words.judged(("a",), (35.0,), "will be", rig((4, 2))) == "well: it will be good, at 2 x 4 pixels"


def test_pictures_on_screens_of_two_sizes_are_not_all_of_one() -> None:
    both = rig((3, 5))
    both = replace(both, stops=replace(both.stops, window=np.array([[3, 5], [2, 5]])))
    assert words.judged(("a", "b"), (35.0, 36.0), "are", both).endswith("are good, at 5 x 3 pixels and 1 other size")


def test_of_many_bad_pictures_the_worst_five_are_named() -> None:
    said = words.judged([f"p{i}" for i in range(9)], range(20, 11, -1), "are", rig((3, 5)))
    assert said == "wrong: all 9 pictures are poor, at 5 x 3 pixels"
    said = words.judged([f"p{i}" for i in range(9)], [50, *range(20, 12, -1)], "are", rig((3, 5)))
    assert said.endswith("8 are poor (p8, p7, p6, p5, p4 and 3 more), at 5 x 3 pixels")
