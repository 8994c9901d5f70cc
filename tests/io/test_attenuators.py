"""Stage files of films, and stacks in files."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import lightcube as lc
from lightcube.errors import InputError
from tests.helpers import films as plain

STACK = "[stack]\nfilms = 3\ngap_mm = 8\nsize_mm = 40\npixels = 8\n"
TWO = '[[picture]]\nfile = "a.png"\n[[picture]]\nfile = "b.png"\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    random = np.random.default_rng(0)
    for name in "ab":
        Image.fromarray(random.integers(0, 255, (8, 12, 3), np.uint8)).save(tmp_path / f"{name}.png")
    return tmp_path


def read(folder: Path, text: str) -> tuple[lc.Stage, lc.Pictures, tuple[str, ...]]:
    (folder / "films.toml").write_text(text)
    return lc.read_stage(folder / "films.toml")


def test_a_stack_needs_no_more_than_its_pictures(folder: Path) -> None:
    stage, pictures, ways = read(folder, STACK + TWO)
    assert plain.stack_of(stage).heights_mm == (-8, 0, 8)
    assert stage.screen("wall").pixels == (5, 8)
    assert [shot.name for shot in stage.shots] == list(pictures.names) == ["a", "b"]
    assert [shot.lamps for shot in stage.shots] == [("lamp 1",), ("lamp 2",)]
    assert ways == ("crop", "crop")


def test_a_folder_of_pictures_is_as_good_as_its_files(folder: Path) -> None:
    (folder / "photos").mkdir()
    for name in "ab":
        (folder / f"{name}.png").rename(folder / "photos" / f"{name}.png")
    stage, _, ways = read(folder, STACK + '[[picture]]\nfile = "photos"\nfit = "pad"\n')
    assert [shot.name for shot in stage.shots] == ["a", "b"]
    assert ways == ("pad", "pad")


def test_pictures_are_called_as_the_file_says(folder: Path) -> None:
    (folder / "photos").mkdir()
    for name in "cd":
        Image.new("RGB", (12, 8)).save(folder / "photos" / f"{name}.png")
    called = TWO.replace('"a.png"\n', '"a.png"\nname = "dawn"\n') + '[[picture]]\nfile = "photos"\nname = "dusk"\n'
    stage, pictures, _ = read(folder, STACK.replace("films = 3", "films = 4") + called)
    assert [shot.name for shot in stage.shots] == list(pictures.names) == ["dawn", "b", "dusk 1", "dusk 2"]


def test_lamps_stand_where_they_are_said_to(folder: Path) -> None:
    lamps = (
        '[[lamp]]\nname = "sun"\nsun = {latitude_deg = 48, day = "06-21", hour = 10.0}\npower_max = 4\n'
        '[[lamp]]\nname = "left"\ndirection = [0.3, 0.1, -1]\ncolour = "#ffeedd"\n'
    )
    lit = TWO.replace('"a.png"\n', '"a.png"\nlamp = "sun"\n').replace('"b.png"\n', '"b.png"\nlamps = ["left"]\n')
    stage, _, _ = read(folder, STACK + lamps + lit)
    assert [shot.lamps for shot in stage.shots] == [("sun",), ("left",)]
    assert stage.lamp("sun").power_max == 4
    assert stage.lamp("sun").direction is not None
    assert stage.lamp("left").direction == (0.3, 0.1, -1)
    snapped, _, _ = read(folder, STACK.replace("\n", "\nsnap = true\n", 1) + lamps + lit)
    assert snapped.lamp("left").direction == pytest.approx((0.3125, 0.0, -1))


def test_films_move_as_they_are_said_to(folder: Path) -> None:
    moves = '[[move]]\nname = "slid"\nfilm = 2\nshift_mm = [5, 0]\n[[move]]\nname = "turned"\nturn_deg = [0, 90, 0]\n'
    lit = TWO.replace('"a.png"\n', '"a.png"\nmove = "slid"\n').replace('"b.png"\n', '"b.png"\nmove = "turned"\n')
    stage, _, _ = read(folder, STACK + moves + lit)
    moved = [(shot.move.shift_mm, shot.move.turn_deg) for shot in stage.shots if shot.move is not None]
    assert moved == [(((0, 0), (5, 0), (0, 0)), (0, 0, 0)), ((), (0, 90, 0))]
    assert len(stage.lamps) == 1


def test_ink_and_medium_bound_what_is_solved(folder: Path) -> None:
    stage, _, _ = read(folder, STACK + 'max_density = 1.2\nmedium = "acrylic"\nscreen_mm = 30\n' + TWO)
    assert stage.material is not None
    assert stage.material.most(stage.grid) * stage.grid.voxel_mm == pytest.approx(1.2 * np.log(10))
    assert plain.stack_of(stage).index == 1.49
    assert stage.screen("wall").centre_mm[2] == -38


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (STACK, "no picture is wanted"),
        (STACK + "heights_mm = [0, 1, 2]\n" + TWO, "heights_mm says what films and gap_mm say"),
        (STACK + 'medium = "jelly"\n' + TWO, "medium: must be a number"),
        (STACK + "medium = 0.5\n" + TWO, "medium"),
        (STACK + "max_density = 0\n" + TWO, "max_density"),
        (STACK + "turns = true\n" + TWO, "turns"),
        (STACK.replace("films = 3", "films = 1") + TWO, "are cast by the same light"),
        (STACK + TWO + 'move = "none"\n', "there is no move 'none'"),
        (STACK + TWO + 'lamp = "lamp 1"\n', "picture 1: lamp is missing"),
        (STACK + TWO + 'lamp = "a"\nlamps = ["b"]\n', "lamp and lamps are both given"),
        (STACK + '[[lamp]]\nname = "x"\ndirection = [0, 0, -1]\n' + TWO, "are cast by the same light"),
        (STACK + '[[lamp]]\nname = "x"\n' + TWO, "either a direction"),
        (STACK + '[[move]]\nname = "m"\nfilm = 4\nshift_mm = [1, 0]\n' + TWO, "there is no film 4"),
        (STACK + '[[move]]\nname = "m"\nshift_mm = [1, 0]\n' + TWO, "shift_mm is of 1 films"),
        (STACK + '[[move]]\nname = "m"\n[[move]]\nname = "m"\n' + TWO, "two moves have the same name"),
        (STACK + "[cube]\nshape = [3, 3, 3]\n" + TWO, "cube"),
        (STACK + '[[picture]]\nfile = "missing.png"\n', "picture 1"),
    ],
)
def test_what_is_wrong_is_said_in_a_sentence(folder: Path, text: str, said: str) -> None:
    with pytest.raises(InputError) as caught:
        read(folder, text)
    assert said in str(caught.value)
    assert str(caught.value).startswith("films.toml: ")


def test_a_stack_comes_back_from_its_file_bit_for_bit(folder: Path) -> None:
    moves = '[[move]]\nname = "slid"\nfilm = 2\nshift_mm = [5, 0]\n'
    lit = TWO + 'move = "slid"\n'
    stage, _, _ = read(folder, STACK + "medium = 1.3\n" + moves + lit)
    rig = stage.rig()
    random = np.random.default_rng(1)
    cube = lc.Cube(random.random((3, *stage.grid.shape)).astype(np.float32), stage.grid, rig)
    lc.save(cube, folder / "stack.zarr")
    again = lc.load(folder / "stack.zarr")
    assert again.grid == stage.grid
    np.testing.assert_array_equal(again.rig.stops.films, rig.stops.films)
    np.testing.assert_array_equal(again.extinction, cube.extinction)
    np.testing.assert_array_equal(next(lc.cast(again)), next(lc.cast(cube)))
