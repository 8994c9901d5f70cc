"""Stage files: what they say, which pictures they name, and what is refused."""

import json
import math
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image

from lightcube.backward.recipe import Recipe
from lightcube.errors import InputError
from lightcube.io import TransparentPictures, is_stage, read_stage, read_stage_targets
from lightcube.optics.material import Material
from lightcube.optics.stage import Lamp, Screen
from lightcube.optics.transfer import from_levels
from lightcube.optics.views import DoubtfulAngles, spread_angles
from lightcube.pictures.fitting import fit
from lightcube.pictures.pictures import Pictures
from lightcube.planning.plan import plan_stage

SUN = {"name": "sun", "direction": [1, 0.25, -0.5]}
BULB = {"name": "bulb", "position_mm": [-300, 20, 150.5]}
WALL = {"name": "wall", "centre_mm": [90, 0, -45], "size_mm": [28, 20], "pitch_mm": 4}
FLOOR = {"name": "floor", "centre_mm": [0, 10, -90], "size_mm": [12, 44], "pitch_mm": 4}
MINIMAL: dict[str, Any] = {
    "cube": {"shape": [4, 5, 8]},
    "lamp": [SUN],
    "screen": [WALL],
    "picture": [{"file": "one.png", "screen": "wall"}],
}


def toml(value: Any) -> str:
    """A value as TOML writes it on one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{toml(key)} = {toml(each)}" for key, each in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return str(value).lower()


def stage_file(folder: Path, tables: dict[str, Any]) -> Path:
    file = folder / "stage.toml"
    file.write_text("".join(f"{key} = {toml(value)}\n" for key, value in tables.items()), encoding="utf-8")
    return file


def test_what_the_clearest_voxel_takes_is_said_of_the_cube(tmp_path: Path) -> None:
    picture(tmp_path / "one.png", 5, 7)

    def planned(cube: dict[str, Any], recipe: Recipe | None = None) -> Material:
        stage, pictures, ways = read_stage(stage_file(tmp_path, MINIMAL | {"cube": {"shape": [4, 5, 6]} | cube}))
        return plan_stage(stage, pictures, ways, recipe, told=False).recipe.bounded_by

    assert planned({}) == Recipe().bounded_by
    assert planned({"clear": 0.01}) == Material(3.0, "voxel", clear=0.01)
    assert planned({"clear": [0.01, 0.02, 0.03]}, Recipe(material=Material(2.0))) == Material(
        2.0, clear=(0.01, 0.02, 0.03)
    )
    said = Recipe().in_clear(0.05)
    assert planned({"clear": 0.01}, said) == said.bounded_by, "who solves says otherwise"
    for wrong in (-1, [0.1, 0.2], "much"):
        with pytest.raises(InputError, match="clear"):
            planned({"clear": wrong})


def test_slices_may_be_taller_than_voxels_are_wide(tmp_path: Path) -> None:
    picture(tmp_path / "one.png", 5, 7)
    cube = {"shape": [4, 5, 6], "size_mm": 24, "slices_tall": 3}
    grid = read_stage(stage_file(tmp_path, MINIMAL | {"cube": cube}))[0].grid
    assert (grid.shape, grid.tall, grid.voxel_mm) == ((4, 5, 6), 3.0, 2.0)
    assert max(grid.size_mm) == 24
    with pytest.raises(InputError, match="slices_tall"):
        read_stage(stage_file(tmp_path, MINIMAL | {"cube": cube | {"slices_tall": 0}}))


def levels_of(rows: int, columns: int) -> NDArray[np.uint8]:
    return np.random.default_rng([rows, columns]).integers(0, 256, (rows, columns, 3), dtype=np.uint8)


def picture(path: Path, rows: int, columns: int) -> NDArray[np.float32]:
    """Noise in a file, and its linear light."""
    path.parent.mkdir(exist_ok=True)
    Image.fromarray(levels_of(rows, columns)).save(path)
    return from_levels(levels_of(rows, columns))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A single picture, a folder of three, one of a single picture, and an empty one."""
    base = tmp_path_factory.mktemp("stage")
    picture(base / "one.png", 9, 11)
    for name, size in (("a.png", (7, 6)), ("b.png", (5, 7)), ("c.png", (3, 8))):
        picture(base / "photos" / name, *size)
    picture(base / "alone" / "me.png", 6, 5)
    (base / "empty").mkdir()
    return base


def test_what_a_file_leaves_out_has_its_default(folder: Path) -> None:
    stage, pictures, fits = read_stage(stage_file(folder, MINIMAL | {"screen": [WALL | {"pitch_mm": 2.5}]}))
    assert (stage.grid.shape, stage.grid.voxel_mm, stage.cube_turns) == ((4, 5, 8), 100 / 8, True)
    assert (stage.stops_deg, stage.axis) == ((0.0,), (0.0, 0.0, 1.0))
    assert stage.lamps == (Lamp("sun", direction=(1.0, 0.25, -0.5)),)
    assert stage.screens == (Screen("wall", (90.0, 0.0, -45.0), (28.0, 20.0), 2.5),)
    assert [(shot.name, shot.screen, shot.lamps, shot.stop) for shot in stage.shots] == [("one", "wall", ("sun",), 0)]
    assert (pictures.names, pictures.transfer, fits) == (("one",), "srgb", ("crop",))
    np.testing.assert_array_equal(pictures.images[0], from_levels(levels_of(9, 11)))


def test_a_screen_has_the_pitch_of_the_voxels(folder: Path) -> None:
    screen = {key: value for key, value in WALL.items() if key != "pitch_mm"}
    stage, _, _ = read_stage(
        stage_file(folder, MINIMAL | {"cube": {"shape": [9, 5, 6], "size_mm": 63}} | {"screen": [screen]})
    )
    assert stage.screens[0].pitch_mm == stage.grid.voxel_mm == 7


def test_every_key_is_heard(folder: Path) -> None:
    lamp = {"colour": [1, 0.5, 2.25], "power": 3.5, "turns": True, "size_deg": 2, "reach_mm": 40, "falloff_mm": 7}
    point = {"colour": "#ff8000", "power_max": 5, "full_at_mm": 320}
    screen = {"normal": [-1, 0, 0.5], "up": [0, 0.1, 1], "rear": True, "turns": True}
    screen |= {"reach_mm": 60, "falloff_mm": 3, "cosine": True}
    tables = {
        "cube": {"shape": [4, 5, 8], "size_mm": 64, "turns": False},
        "turntable": {"stops_deg": [5, 20.5], "axis": [0, 1, 1]},
        "lamp": [SUN | lamp, BULB | point],
        "screen": [WALL | screen],
        "picture": [{"file": "one.png", "screen": "wall", "lamps": ["bulb", "sun"], "stop": 2, "fit": "pad"}],
    }
    stage, _, fits = read_stage(stage_file(folder, tables))
    assert (stage.grid.voxel_mm, stage.cube_turns, stage.stops_deg, stage.axis) == (8, False, (5, 20.5), (0, 1, 1))
    for made, said in ((stage.lamps[0], SUN | lamp), (stage.screens[0], WALL | screen), (stage.lamps[1], BULB | point)):
        for key, value in said.items():
            if key != "colour" or not isinstance(value, str):
                assert getattr(made, key) == (tuple(value) if isinstance(value, list) else value), key
    np.testing.assert_allclose(stage.lamps[1].colour, from_levels(np.array([255, 128, 0], np.uint8)), atol=1e-6)
    assert (stage.shots[0].lamps, stage.shots[0].stop, fits) == (("bulb", "sun"), 1, ("pad",))


def test_stops_are_counted_over_the_whole_turn(folder: Path) -> None:
    stage, _, _ = read_stage(stage_file(folder, MINIMAL | {"turntable": {"count": 7}}))
    np.testing.assert_array_equal(stage.stops_deg, spread_angles(7, 360.0))


def test_stops_that_may_be_radians_are_told(folder: Path) -> None:
    said = MINIMAL | {"turntable": {"stops_deg": [0, 2.0944, 4.1888]}}
    with pytest.warns(DoubtfulAngles, match=r"^stage\.toml: turntable: stops_deg: .* if they are radians, multiply"):
        read_stage(stage_file(folder, said))
    read_stage(stage_file(folder, said | {"turntable": {"stops_deg": [0, 120, 240]}}))


def test_pictures_of_a_folder_go_to_stop_after_stop(folder: Path) -> None:
    pictures = [
        {"file": "photos", "screen": "floor", "stop": 2, "fit": "stretch"},
        {"file": "one.png", "screen": "wall", "stop": 4},
        {"file": "alone", "screen": "wall"},
    ]
    tables = MINIMAL | {"turntable": {"count": 4}, "screen": [WALL, FLOOR], "picture": pictures}
    stage, read, fits = read_stage(stage_file(folder, tables))
    assert [(shot.name, shot.screen, shot.stop) for shot in stage.shots] == [
        *(("a", "floor", 1), ("b", "floor", 2), ("c", "floor", 3), ("one", "wall", 3), ("me", "wall", 0)),
    ]
    assert fits == ("stretch", "stretch", "stretch", "crop", "crop")
    assert read.names == ("a", "b", "c", "one", "me")
    for image, size in zip(read.images, ((7, 6), (5, 7), (3, 8), (9, 11), (6, 5)), strict=True):
        np.testing.assert_array_equal(image, from_levels(levels_of(*size)))


def test_a_movie_gives_its_pictures(folder: Path) -> None:
    targets = [Image.fromarray(levels_of(5, 6)), Image.fromarray(levels_of(6, 5).reshape(5, 6, 3))]
    targets[0].save(folder / "two.webp", save_all=True, append_images=targets[1:], lossless=True)
    tables = MINIMAL | {"turntable": {"count": 2}, "picture": [{"file": "two.webp", "screen": "wall"}]}
    stage, read, _ = read_stage(stage_file(folder, tables))
    assert [(shot.name, shot.stop) for shot in stage.shots] == [("1", 0), ("2", 1)]
    np.testing.assert_array_equal(read.images[1], from_levels(np.asarray(targets[1])))


def test_equal_names_are_told_apart(folder: Path) -> None:
    wanted = [("wall", 1), ("floor", 1), ("floor", 2)]
    pictures = [{"file": "one.png", "screen": screen, "stop": stop} for screen, stop in wanted]
    pictures += [{"file": "alone", "screen": "wall", "stop": 2}]
    tables = MINIMAL | {"turntable": {"count": 2}, "screen": [WALL, FLOOR], "picture": pictures}
    stage, read, _ = read_stage(stage_file(folder, tables))
    assert read.names == ("one on wall", "one on floor at stop 1", "one on floor at stop 2", "me")
    assert read.names == tuple(shot.name for shot in stage.shots)


def test_pictures_are_called_as_the_file_says_and_several_are_numbered(folder: Path) -> None:
    pictures = [{"file": "one.png", "name": "spring", "screen": "wall"}]
    pictures += [{"file": "one.png", "screen": "floor"}]
    tables = MINIMAL | {"screen": [WALL, FLOOR], "picture": pictures}
    assert read_stage(stage_file(folder, tables))[1].names == ("spring", "one")
    (folder / "several").mkdir()
    for number in range(2):
        (folder / "several" / f"{number}.png").write_bytes((folder / "one.png").read_bytes())
    several = {"file": "several", "name": "ball", "screen": "wall"}
    tables = MINIMAL | {"turntable": {"count": 2}, "picture": [several]}
    assert read_stage(stage_file(folder, tables))[1].names == ("ball 1", "ball 2")


def test_pictures_are_looked_up_beside_the_file(folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    inner = folder / "far" / "inner"
    inner.mkdir(parents=True, exist_ok=True)
    file = stage_file(inner, MINIMAL | {"picture": [{"file": "../../alone/me.png", "screen": "wall"}]})
    monkeypatch.chdir(inner)
    for path in (file, "stage.toml"):
        assert read_stage(path)[1].names == ("me",)
    assert is_stage("stage.toml")
    monkeypatch.chdir(tmp_path)
    assert not is_stage("stage.toml")


def test_which_paths_are_stages(folder: Path, tmp_path: Path) -> None:
    assert is_stage(stage_file(folder, MINIMAL))
    (tmp_path / "pictures.toml").mkdir()
    (tmp_path / "STAGE.TOML").touch()
    assert is_stage(str(tmp_path / "STAGE.TOML"))
    for other in (folder / "photos", folder / "one.png", tmp_path / "pictures.toml", "s3://bucket/stage.toml"):
        assert not is_stage(other)


def test_transfer_and_opacity_are_as_of_other_pictures(folder: Path, tmp_path: Path) -> None:
    levels = np.dstack([levels_of(4, 6), np.full((4, 6), 51, np.uint8)])
    Image.fromarray(levels).save(tmp_path / "one.png")
    file = stage_file(tmp_path, MINIMAL)
    with pytest.warns(TransparentPictures, match=r"1 of 1 picture in .*one\.png"):
        _, pictures, _ = read_stage(file, transfer="linear")
    assert pictures.transfer == "linear"
    np.testing.assert_allclose(pictures.images[0], 0.2 * (levels[..., :3] / 255) + 0.8, atol=1e-6)
    for name, size in (("a", (2, 3)), ("b", (4, 1))):
        picture(tmp_path / "two" / f"{name}.png", *size)
    tables = {"turntable": {"count": 2}, "picture": [{"file": "two", "screen": "wall"}]}
    _, pictures, _ = read_stage(stage_file(tmp_path, MINIMAL | tables), transfer="linear")
    for image, size in zip(pictures.images, ((2, 3), (4, 1)), strict=True):
        np.testing.assert_array_equal(image, from_levels(levels_of(*size), "linear"))
    with pytest.raises(InputError, match="transfer, not 'gamma': use one of srgb, linear"):
        read_stage(stage_file(folder, MINIMAL), transfer="gamma")  # type: ignore[arg-type]


def test_pictures_lie_at_the_upper_left_of_the_raster(folder: Path) -> None:
    """Screens of 5 x 7 and 11 x 3 pixels, pictures of three sizes and three ways to fit."""
    pictures = [
        {"file": "photos/b.png", "screen": "wall", "lamps": ["sun"]},
        {"file": "one.png", "screen": "floor", "lamps": ["sun", "bulb"], "fit": "pad"},
        {"file": "one.png", "screen": "wall", "lamps": ["bulb"], "fit": "stretch"},
    ]
    tables = MINIMAL | {"lamp": [SUN | {"size_deg": 2}, BULB], "screen": [WALL, FLOOR], "picture": pictures}
    stage, targets = read_stage_targets(stage_file(folder, tables), transfer="linear")
    assert targets.pictures.shape == (3, 11, 7, 3)
    assert len(targets.rig.views) == 4
    assert targets.names == tuple(shot.name for shot in stage.shots) == ("b", "one on floor", "one on wall")
    np.testing.assert_array_equal(targets.pictures[0, :5, :7], from_levels(levels_of(5, 7), "linear"))
    windows = targets.rig.inside
    assert np.all(targets.weight <= windows)
    np.testing.assert_array_equal(targets.weight[[0, 2]], windows[[0, 2]])
    # 9 x 11 pixels padded to the 11 x 3 of the floor: a band across it, in the middle.
    np.testing.assert_array_equal(targets.weight[1, :, 0], [0, 0, 0, 0, 1, 1, 1, 0, 0, 0, 0])
    np.testing.assert_array_equal(targets.weight[1].sum(axis=1) // 3, targets.weight[1, :, 0])
    assert np.all(targets.pictures[targets.weight == 0] == 1)


def test_a_stage_wants_as_many_pictures_as_it_has(folder: Path) -> None:
    stage, pictures, fits = read_stage(stage_file(folder, MINIMAL))
    rig = stage.rig()
    twice = Pictures(pictures.images * 2, pictures.names * 2)
    for given_pictures, given_fits in ((twice, (*fits, *fits)), (pictures, (*fits, *fits)), (pictures, ())):
        with pytest.raises(InputError, match="give one of each"):
            fit(given_pictures, rig, given_fits)
    wrong: tuple[Any, ...] = ("zoom",)
    with pytest.raises(InputError, match=r"zoom.*use one of crop, pad, stretch"):
        fit(pictures, rig, wrong)


def many(kind: dict[str, Any], count: int) -> list[dict[str, Any]]:
    return [kind | {"name": f"{kind['name']}{i}"} for i in range(count)]


INF, NAN = math.inf, math.nan
BAD = [
    ({"screen": many(WALL, 50)}, "a stage has at most 32 screens, not 50: leave out 'wall32' and the like"),
    ({"screen": [WALL | {"size_mm": [0, 20]}]}, "screen 'wall': size_mm must be above 0, not 0"),
    ({"screen": [WALL | {"size_mm": [28, -3]}]}, "screen 'wall': size_mm must be above 0, not -3"),
    ({"screen": [WALL | {"size_mm": [28]}]}, "screen 1: size_mm.1: is missing"),
    ({"screen": [WALL | {"pitch_mm": 1e-9}]}, "screen 'wall': more than 2048 pixels along a side"),
    ({"screen": [WALL, WALL]}, "there are two screens called 'wall'"),
    ({"screen": []}, "there is no screen on this stage"),
    ({"screen": WALL}, "screen: must be a list of tables: begin each with [[screen]]"),
    ({"screen": [WALL, 5]}, "screen 2: must be a table, not 5"),
    ({"screen": [WALL | {"rear": 1}]}, "screen 1: rear: must be true or false, not 1"),
    ({"screen": [WALL | {"centre_mm": [1, 2, INF]}]}, "screen 1: centre_mm.2: must be a finite number, not inf"),
    ({"lamp": [SUN, BULB, SUN]}, "there are two lamps called 'sun'"),
    ({"lamp": [SUN | {"position_mm": [1, 2, 3]}]}, "lamp 'sun': give either a direction"),
    ({"lamp": [{"name": "sun"}]}, "lamp 'sun': give either a direction"),
    ({"lamp": [SUN | {"power": -2.5}]}, "lamp 'sun': power must lie between 0.0001 and 1e6, not -2.5"),
    ({"lamp": [SUN | {"power": True}]}, "lamp 1: power: must be a number, not True"),
    ({"lamp": [SUN | {"power": "bright"}]}, "lamp 1: power: must be a number, not 'bright'"),
    ({"lamp": [SUN | {"reach_mm": NAN}]}, "lamp 1: reach_mm: must be a finite number, not nan"),
    ({"lamp": [SUN | {"colour": "red"}]}, "lamp 1: colour: must be '#rgb', '#rrggbb' or three numbers"),
    ({"lamp": [SUN | {"colour": "#000"}]}, "lamp 'sun': colour must be three numbers of at least 0, not all 0"),
    ({"lamp": [SUN, BULB | {"watts": 60}]}, "lamp 2: watts: no such key here"),
    ({"lamp": [{"direction": [1, 0, 0]}]}, "lamp 1: name: is missing"),
    ({"lamp": [SUN | {"name": "two\nlines"}]}, "lamp 1: name: must be one line"),
    ({"lamp": [SUN | {"name": "s" * 65}]}, "lamp 1: name: is too long"),
    ({"lamp": [SUN, BULB]}, "picture 1: lamps: is missing: say which of sun, bulb are lit"),
    ({"cube": {"shape": [4, 5]}}, "cube.shape.2: is missing"),
    ({"cube": {"shape": [4, 5, 6, 7]}}, "cube.shape: is too long"),
    ({"cube": {"shape": [4, 0, 6]}}, "cube.shape.1: must be >= 1, not 0"),
    ({"cube": {"shape": [4, 5.0, 6]}}, "cube.shape.1: must be a whole number, not 5.0"),
    ({"cube": {"shape": [4, 5, 8], "size_mm": 0}}, "cube.size_mm: must be > 0, not 0"),
    ({"cube": {"shape": [4, 5, 8], "size_mm": 1e-6}}, "cube: a voxel's side must lie between"),
    ({"cube": {}}, "cube.shape: is missing"),
    ({"cube": {"shape": [4, 5, 8], "a\nb": 1}}, r"cube.'a\nb': no such key here"),
    ({"cubes": 3}, "cubes: no such key here"),
    ({"turntable": {"stops_deg": []}}, "turntable.stops_deg: is too short"),
    ({"turntable": {"stops_deg": [0, NAN]}}, "turntable.stops_deg.1: must be a finite number, not nan"),
    ({"turntable": {"stops_deg": [0], "count": 3}}, "turntable: stops_deg and count are both given"),
    ({"turntable": {"count": 0}}, "turntable.count: must be >= 1, not 0"),
    ({"turntable": {"axis": [0, 0, 0]}}, "the turntable: axis must be three finite numbers that are not all 0"),
    ({"picture": []}, "no picture is wanted on this stage"),
    (
        {"turntable": {"count": 2}, "picture": [{"file": "photos", "screen": "wall"}]},
        "picture 1: photos holds 3 pictures for the stops from 1 on, and the last one is 2",
    ),
]
PICTURE = MINIMAL["picture"][0]
BAD += [
    ({"picture": [PICTURE, PICTURE | changed]}, said)
    for changed, said in (
        ({"screen": "wal"}, "picture 'one.png': there is no screen 'wal': use one of wall"),
        ({"lamps": ["moon"]}, "picture 'one.png': there is no lamp 'moon': use one of sun"),
        ({"lamps": []}, "picture 'one.png': no lamp is lit: name one of sun"),
        ({"lamps": "sun"}, "picture 2: lamps: must be a list, not 'sun'"),
        ({"stop": 2}, "picture 'one.png': there is no stop 2: the turntable has 1"),
        ({"stop": 0}, "picture 2: stop: must be >= 1, not 0"),
        ({"fit": "zoom"}, "picture 2: fit: must be 'crop', 'pad' or 'stretch', not 'zoom'"),
        ({"file": "none.png"}, "picture 2: there is no {folder}/none.png: give"),
        ({"file": "nowhere/"}, "picture 2: there is no {folder}/nowhere: give"),
        ({"file": ""}, "picture 2: file: "),
        ({"file": "o" * 300}, "picture 2: reading {folder}/" + "o" * 300 + " failed: File name too long"),
        ({"file": "empty"}, "picture 2: the folder {folder}/empty is empty"),
        ({"file": "stage.toml"}, "picture 2: {folder}/stage.toml has no suffix that pictures can have"),
        ({"file": "photos"}, "picture 2: photos holds 3 pictures for the stops from 1 on, and the last one is 1"),
    )
]


@pytest.mark.parametrize(("changed", "said"), BAD, ids=[said[:60] for _, said in BAD])
def test_what_is_wrong_is_named_in_one_sentence(folder: Path, changed: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as error:
        read_stage(stage_file(folder, deepcopy(MINIMAL) | changed))
    assert str(error.value).startswith("stage.toml: " + said.format(folder=folder))
    assert "\n" not in str(error.value)


LONG = ["0x" + "f" * 5000, f"{10**300}", json.dumps("very " * 20), "[1, 2]"]


@pytest.mark.parametrize("extra", ["watts = 60", *(f"power = {value}" for value in LONG)], ids=len)
def test_only_a_short_value_of_a_known_key_is_said_again(folder: Path, extra: str) -> None:
    file = stage_file(folder, MINIMAL)
    file.write_text(file.read_text().replace("[{", f"[{{{extra}, ", 1))
    with pytest.raises(InputError, match=r"^stage\.toml: lamp 1: (watts|power): [a-z0-9=<,:+ ]{10,60}$") as error:
        read_stage(file)
    assert ", not" not in str(error.value)


def test_files_that_are_no_stage(tmp_path: Path) -> None:
    digits = b"x = " + b"9" * 5000
    for content in (b"[[[", b"\xff\xfe", b"x = 1\nx = 2", b"x = " + b"[" * 5000, digits):
        (tmp_path / "a.toml").write_bytes(content)
        with pytest.raises(InputError, match=r"^a\.toml is not a TOML file( for us)?: [^\n]*$"):
            read_stage(tmp_path / "a.toml")
    (tmp_path / "a.toml").write_bytes(b"")
    with pytest.raises(InputError, match=r"^a\.toml: cube: is missing$"):
        read_stage(tmp_path / "a.toml")
    with pytest.raises(InputError, match=r"^reading .*b\.toml failed: No such file or directory$"):
        read_stage(tmp_path / "b.toml")
    with pytest.raises(InputError, match="failed: Is a directory"):
        read_stage(tmp_path)


def test_a_broken_picture_is_named_with_its_table(tmp_path: Path) -> None:
    (tmp_path / "one.png").write_bytes(b"no picture")
    with pytest.raises(InputError, match=r"^stage\.toml: picture 1: .*one\.png cannot be read"):
        read_stage(stage_file(tmp_path, MINIMAL))


TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
SIMPLE = (
    st.integers()
    | st.integers().map(lambda n: 10 ** (abs(n) % 400))
    | st.floats()
    | TEXTS
    | st.booleans()
    | st.dates()
    | st.sampled_from(["#fff", "sun", "wall", "one.png", "photos", ".", "crop", -1, 0, 1, 1e-300, 1e6])
)
JUNK = st.recursive(
    SIMPLE, lambda each: st.lists(each, max_size=4) | st.dictionaries(TEXTS, each, max_size=3), max_leaves=6
) | st.lists(st.floats(-10, 10), min_size=2, max_size=4)
PLACES = [
    *((key,) for key in ("cube", "turntable", "lamp", "screen", "picture", "other")),
    *(("cube", key) for key in ("shape", "size_mm", "turns", "other")),
    *(("turntable", key) for key in ("stops_deg", "count", "axis", "other")),
    *(("lamp", key) for key in ("name", "direction", "position_mm", "colour", "power", "power_max", "turns")),
    *(("lamp", key) for key in ("size_deg", "reach_mm", "falloff_mm", "full_at_mm", "other")),
    *(("screen", key) for key in ("name", "centre_mm", "size_mm", "pitch_mm", "normal", "up", "rear", "turns")),
    *(("screen", key) for key in ("reach_mm", "falloff_mm", "cosine", "other")),
    *(("picture", key) for key in ("file", "screen", "lamps", "stop", "fit", "other")),
]


@pytest.mark.filterwarnings("ignore::lightcube.optics.views.DoubtfulAngles")
@given(st.lists(st.tuples(st.sampled_from(PLACES), JUNK), min_size=1, max_size=2))
@settings(max_examples=150)
def test_any_rubbish_gives_a_stage_or_one_sentence(folder: Path, rubbish: list[tuple[tuple[str, ...], Any]]) -> None:
    tables = deepcopy(MINIMAL) | {"turntable": {}}
    for place, value in rubbish:
        table = tables[place[0]] if len(place) > 1 else tables
        table = table[0] if isinstance(table, list) and table else table
        if isinstance(table, dict):
            table[place[-1]] = value
    said = ""
    try:
        stage, pictures, fits = read_stage(stage_file(folder, tables))
    except InputError as error:
        said = str(error)
    assert "\n" not in said
    assert said.startswith("stage.toml: ") if said else len(stage.shots) == len(pictures) == len(fits)
