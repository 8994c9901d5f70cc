"""The command line with a stage: check, draw, solve, play, score, and what cannot be."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from lightcube.jobs.reading import load
from tests.cli.test_cli import run

__all__ = ["run"]

STAGE = """
[cube]
shape = [4, 6, 5]
size_mm = 60

[turntable]
stops_deg = [10, 130]

[[lamp]]
name = "sun"
direction = [1, 0, -0.4]

[[lamp]]
name = "bulb"
position_mm = [-20, -150, 30]

[[screen]]
name = "wall"
centre_mm = [90, 0, -36]
normal = [-1, 0, 0]
size_mm = [40, 50]

[[screen]]
name = "side"
centre_mm = [0, 90, 0]
size_mm = [60, 70]

[[picture]]
file = "pictures"
screen = "wall"
lamps = ["sun"]

[[picture]]
file = "pictures/a.png"
screen = "side"
lamps = ["bulb"]
"""


@pytest.fixture
def stage(tmp_path: Path) -> Path:
    """A stage of three pictures on two screens."""
    random = np.random.default_rng(0)
    (tmp_path / "pictures").mkdir()
    for name in ("a", "b"):
        Image.fromarray(random.integers(60, 255, (7, 9, 3)).astype(np.uint8)).save(tmp_path / f"pictures/{name}.png")
    path = tmp_path / "room.toml"
    path.write_text(STAGE)
    return path


def solved(run, stage: Path, *more: str) -> Path:  # type: ignore[no-untyped-def]
    cube = stage.parent / "cube.zarr"
    done = run("solve", stage, "-o", cube, "--iterations", "5", "--overwrite", *more)
    assert done.code == 0, done.err
    return cube


def test_a_stage_goes_through_all_commands(run, stage: Path) -> None:  # type: ignore[no-untyped-def]
    cube = solved(run, stage)
    made = load(cube)
    assert (made.rig.screens.names, len(made.names), made.extinction.shape) == (("wall", "side"), 3, (3, 4, 6, 5))
    assert made.names == ("a on wall", "b", "a on side")
    own, given = (json.loads(run("score", cube, *more, "--json").out) for more in ((), (stage,)))
    assert own["psnr_mean"] == pytest.approx(given["psnr_mean"], abs=0.2)
    assert [view["angle_deg"] for view in given["pictures"]] == [10, 130, 10]
    assert "bulb" in run("info", cube).out
    checked = run("check", stage)
    assert checked.code == 0
    assert "nothing here is impossible" in checked.out


@pytest.mark.parametrize(
    ("options", "count", "shape"),
    [
        (["--stops"], 3, (7, 6)),
        (["--stops", "--screens"], 2, (6, 3 + 2 + 5)),
        (["--angles-deg", "0,50,90"], 3, (6, 3 + 2 + 5)),
        (["--angles-deg", "0,50", "--light", "thin"], 2, (6, 10)),
        (["--angles-deg", "10,20", "--view", "room"], 2, (540, 960)),
    ],
)
def test_play_shows_screens_and_the_room(run, stage: Path, options: list[str], count: int, shape) -> None:  # type: ignore[no-untyped-def]
    out = stage.parent / "shown.npy"
    done = run("play", solved(run, stage), "-o", out, *options)
    assert done.code == 0, done.err
    shown = np.load(out)
    assert shown.shape[0] == count
    assert np.all(np.isfinite(shown))


def test_a_still_is_a_png(run, stage: Path) -> None:  # type: ignore[no-untyped-def]
    cube, out = solved(run, stage), stage.parent / "still.png"
    assert run("play", cube, "-o", out, "--angles-deg", "10").code == 0
    with Image.open(out) as still:
        assert still.format == "PNG"
    done = run("play", cube, "-o", stage.parent / "two.png", "--angles-deg", "10,20")
    assert done.code == 2
    assert "holds one picture, not 2" in done.err


def test_a_drawing_is_an_svg_that_is_not_overwritten(run, stage: Path) -> None:  # type: ignore[no-untyped-def]
    out = stage.parent / "room.svg"
    assert run("draw", stage, "-o", out).code == 0
    assert out.read_text().startswith("<svg")
    for more, said in (
        (("-o", out), "exists already"),
        (("-o", stage.parent / "room.png"), "no suffix that a drawing can have: use .svg"),
        (("-o", stage.parent / "other.svg", "--angle-deg", 5), "--angle-deg is for a cube"),
    ):
        done = run("draw", stage, *more)
        assert (done.code, done.out) == (2, "")
        assert said in done.err


@pytest.mark.usefixtures("large_rooms")
def test_a_cubes_room_is_drawn_as_it_is_played(run, stage: Path) -> None:  # type: ignore[no-untyped-def]
    cube, out = solved(run, stage), stage.parent / "room.png"
    for more, angle_deg in (((), 10), (("--angle-deg", 25), 25)):
        assert run("draw", cube, "-o", out, "--overwrite", *more).code == 0
        still = ("-o", stage.parent / "still.png", "--view", "room", "--angles-deg", angle_deg, "--overwrite")
        assert run("play", cube, *still).code == 0
        with Image.open(out) as drawn, Image.open(stage.parent / "still.png") as played:
            np.testing.assert_array_equal(np.asarray(drawn), np.asarray(played))
    done = run("draw", cube, "-o", stage.parent / "other.svg")
    assert done.code == 2
    assert "use one of .png, .webp, .jpg, .jpeg" in done.err


def test_points_are_of_the_solver_and_a_cube_keeps_its_own_room(run, stage: Path) -> None:  # type: ignore[no-untyped-def]
    cube = solved(run, stage, "--points", "2")
    assert len(load(cube).rig.views) == 3
    assert load(cube).provenance["points"] == 2
    assert run("score", cube, stage).code == 0


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--n", "8"], "--n is not for a stage"),
        (["--elevation-deg", "0"], "--elevation-deg is not for a stage"),
        (["--lamp-max", "4"], "--lamp-max is not for a stage"),
        (["--lamp-power", "1"], "--lamp-power is not for a stage"),
        (["--slices-tall", "2"], "--slices-tall is not for a stage"),
        (["--pixel", "2"], "--pixel is not for a stage"),
        (["--lamp-deg", "0.5"], "--lamp-deg is not for a stage"),
        (["--screen-mm", "50"], "--screen-mm is not for a stage"),
        (["--paper"], "--paper is not for a stage"),
        (["--method", "sirt"], "cannot choose the power of lamp 'sun'"),
        (["--quality", "best", "--iterations", "3"], "--quality and --iterations both"),
        (["--hold-deg", "90"], "wider than half the way"),
        (["--points", "0"], "points"),
        (["--light", "thin", "--points", "4"], "leave out one of the two"),
    ],
)
def test_options_that_contradict_a_stage_are_refused(run, stage: Path, options: list[str], said: str) -> None:  # type: ignore[no-untyped-def]
    done = run("solve", stage, "-o", stage.parent / "cube.zarr", *options)
    assert (done.code, done.out) == (2, "")
    assert said in done.err
    assert not list(stage.parent.glob("cube*"))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("direction = [1, 0, -0.4]", "direction = [0, 1, 0]", "edge-on"),
        ("direction = [1, 0, -0.4]", "direction = [-1, 0, -0.4]", "'sun'"),
        ("position_mm = [-20, -150, 30]", "position_mm = [0, 0, 3]", "'bulb'"),
        ("centre_mm = [90, 0, -36]", "centre_mm = [90, 400, -36]", "miss"),
        ('lamps = ["bulb"]', 'lamps = ["moon"]', "'moon'"),
        ("size_mm = [40, 50]", "size_mm = [0, 50]", "'wall'"),
        ('name = "bulb"', 'name = "sun"', "two lamps called 'sun'"),
        ('"pictures/a.png"', '"pictures/c.png"', "c.png"),
    ],
)
def test_what_cannot_be_is_said_by_check_and_solve(run, stage: Path, old: str, new: str, said: str) -> None:  # type: ignore[no-untyped-def]
    assert old in STAGE
    stage.write_text(STAGE.replace(old, new, 1))
    for command in (["check", stage], ["solve", stage, "-o", stage.parent / "cube.zarr"]):
        done = run(*command)
        assert done.code == 2
        assert said in done.err
        assert "Traceback" not in done.err
    assert not (stage.parent / "cube.zarr").exists()


def test_a_turntables_cube_is_played_as_a_stages(run, stage: Path) -> None:  # type: ignore[no-untyped-def]
    folder = stage.parent / "pictures"
    cube = stage.parent / "turntable.zarr"
    done = run("solve", folder, "-o", cube, "--shape", "4,6,5", "--iterations", "2", "--picture-width", "0.5")
    assert done.code == 0, done.err
    shown = {}
    for name, options in {"stops": ["--stops"], "screens": ["--screens", "--stops"]}.items():
        assert run("play", cube, "-o", stage.parent / f"{name}.npy", *options).code == 0
        shown[name] = np.load(stage.parent / f"{name}.npy")
    np.testing.assert_allclose(shown["screens"], shown["stops"], rtol=1e-5)
    done = run("play", cube, "-o", stage.parent / "x.npy", "--view", "room", "--target")
    assert done.code == 2
    assert "--view room shows the room" in done.err
    assert run("play", cube, "-o", stage.parent / "room.npy", "--view", "room", "--angles-deg", "5").code == 0
    done = run("score", cube, stage)
    assert done.code == 2
    assert "was not made on the stage" in done.err


def test_a_lamps_size_that_is_not_minded_is_said(run, stage: Path) -> None:  # type: ignore[no-untyped-def]
    stage.write_text(STAGE.replace('name = "sun"', 'name = "sun"\nsize_deg = 2'))
    for more, said in ((("--light", "thin"), True), (("--points", "2"), False)):
        done = run("solve", stage, "-o", stage.parent / "cube.zarr", "--iterations", "2", "--overwrite", *more)
        assert done.code == 0, done.err
        assert ("do not mind the size of lamp 'sun'" in done.err) is said


def test_a_cube_before_which_nothing_turns_is_played_once(run, stage: Path) -> None:  # type: ignore[no-untyped-def]
    still = STAGE.replace("size_mm = 60\n", "size_mm = 60\nturns = false\n").replace(
        "stops_deg = [10, 130]", "stops_deg = [10]"
    )
    stage.write_text(still.replace('"pictures"', '"pictures/b.png"'))
    assert run("play", solved(run, stage), "-o", stage.parent / "x.npy", "--screens").code == 0
    assert len(np.load(stage.parent / "x.npy")) == 1


def test_pictures_alone_do_not_say_how_a_stage_is_lit(run, stage: Path) -> None:  # type: ignore[no-untyped-def]
    done = run("score", solved(run, stage), stage.parent / "pictures")
    assert done.code == 2
    assert "made on a stage: give its file" in done.err
