"""Whatever is wrong with what a public function is given is one sentence."""

import inspect
import re
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lightcube as lc
from lightcube.pictures import samples

GRID = lc.Grid((3, 5, 7))
RIG = lc.turntable(GRID, [20, 70], elevation_deg=35, picture_shape=(3, 3))
TARGETS = lc.Targets(np.full((2, 3, 3, 3), 0.5, np.float32), RIG)
CUBE = lc.Cube(np.ones((3, 3, 5, 7), np.float32), GRID, RIG)
MADE = replace(CUBE, targets=np.full((2, 3, 3, 4), 30_000, np.uint16))
PICTURES = samples.photographs(2)
RECIPE = lc.Recipe(passes=2)
PREDICTION = lc.Prediction(np.ones(2), 20)
SCENE = lc.read_scene("gems")
LAMP = lc.Lamp("sun", direction=(1, 0, -0.5))
SCREEN = lc.Screen("wall", (9, 0, 0), (5, 5), 1)
RELIEF = lc.Relief(np.ones((8, 9)), np.ones((1, 8, 9)), lc.ReliefRecipe())
SHOT = lc.Shot("a", "wall", ("sun",))
VECTORS = {name: np.ones((2, 3)) for name in ("origins_mm", "column_steps_mm", "row_steps_mm")}

SQUARE = np.pad(np.zeros((4, 4, 3), np.float32), ((2, 2), (2, 2), (0, 0)), constant_values=1)
DRAWN = lc.Pictures((SQUARE,) * 3, ("a", "b", "c"))
CUTS = lc.cut(DRAWN)
SILHOUETTES = lc.silhouettes(CUTS, lc.walls(GRID).rig())
SHAPE = lc.hull(SILHOUETTES, GRID)
REACH = lc.reach(SILHOUETTES, GRID)

#: What would do of every public function and class.
GIVEN: dict[str, dict[str, Any]] = {
    "Cube": {"extinction": CUBE.extinction, "grid": GRID, "rig": RIG},
    "Films": {},
    "Dyes": {"names": ("a", "b"), "extinction": np.array([[1.0, 2, 3], [3, 2, 1]])},
    "Glass": {},
    "Grid": {"shape": (3, 5, 7)},
    "Label": {"title": "a"},
    "Lamp": {"name": "sun", "direction": (1, 0, -0.5)},
    "Light": {},
    "Mat": {},
    "Material": {},
    "Mesh": {"vertices_mm": np.eye(4, 3), "faces": [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]},
    "Move": {"name": "slid"},
    "Pictures": {"images": [np.ones((2, 3, 3))], "names": ["a"]},
    "Plan": {
        "pictures": PICTURES,
        "targets": TARGETS,
        "grid": GRID,
        "recipe": RECIPE,
        "fit": "crop",
        "prediction": PREDICTION,
    },
    "Prediction": {"psnr": np.ones(2), "rehearsed": 20},
    "Projector": {"grid": GRID, "rig": RIG},
    "Reach": {each.name: getattr(REACH, each.name) for each in fields(REACH)},
    "Recipe": {},
    "Relief": {"heights_px": np.ones((2, 3)), "wanted": np.ones((1, 2, 3)), "recipe": RELIEF.recipe},
    "ReliefRecipe": {},
    "Result": {"x": np.ones((4, 2)), "lamp_powers": np.ones((1, 1)), "residuals": np.ones(2)},
    "Rig": {name: getattr(RIG, name) for name in inspect.signature(lc.Rig).parameters},
    "Scene": {"description": SCENE.description},
    "Screen": {"name": "wall", "centre_mm": (1, 2, 3), "size_mm": (4, 5), "pitch_mm": 1},
    "Shape": {"field": SHAPE.field, "grid": GRID, "silhouettes": SILHOUETTES},
    "Shot": {"name": "a", "screen": "wall", "lamps": ["sun"]},
    "Silhouettes": {"inside": SILHOUETTES.inside, "rig": SILHOUETTES.rig, "names": SILHOUETTES.names},
    "Solution": {
        "cube": CUBE,
        "residuals": [1.0],
        "rejected": np.empty((0, 4), int),
        "undetermined": 0,
        "stop_reason": "enough",
    },
    "Stack": {"shape": (3, 5, 7)},
    "Stage": {"grid": GRID, "lamps": [LAMP], "screens": [SCREEN], "shots": [SHOT]},
    "Targets": {"pictures": TARGETS.pictures, "rig": RIG},
    "Turntable": {},
    "Views": {"lamps": np.ones((2, 4)), **VECTORS, "picture_shape": (3, 3)},
    "Repaired": {"given": SILHOUETTES, "shape": SHAPE, "way": "none", "warped": None},
    "Warped": {"given": SILHOUETTES, "nodes": np.zeros((len(SILHOUETTES), 2, 11, 11)), "weight": 1.0},
    "as_cube": {"shape": SHAPE},
    "carve": {"shape": SHAPE, "how": "lace"},
    "with_base": {"shape": SHAPE, "thick_mm": 0.5},
    "repair": {"silhouettes": SILHOUETTES, "grid": GRID, "way": "warp"},
    "warp": {"silhouettes": SILHOUETTES, "grid": GRID},
    "attenuator": {"names": ["a", "b"]},
    "best_order": {"targets": TARGETS, "grid": GRID},
    "cast": {"cube": CUBE},
    "certify": {"mesh": SHAPE.mesh, "silhouettes": SILHOUETTES},
    "check": {"targets": TARGETS, "grid": GRID},
    "cut": {"pictures": DRAWN},
    "dot_test": {"operator": lc.Projector(GRID, RIG)},
    "fit": {"pictures": PICTURES, "rig": RIG},
    "hull": {"silhouettes": SILHOUETTES, "grid": GRID},
    "load": {"path": "no.zarr"},
    "page": {"cube": CUBE, "label": "a"},
    "plan": {"pictures": PICTURES, "n": 6, "picture_width": 0.5},
    "as_films": {"cube": MADE, "films": 2},
    "export": {"cube": CUBE, "path": "/no/such/folder/a.vdb", "kind": "volume"},
    "film": {"cube": CUBE},
    "read_export": {"path": "no.vdb"},
    "play": {"cube": CUBE},
    "player": {"cube": CUBE},
    "predict": {"targets": TARGETS, "grid": GRID},
    "publish": {"partial": "no.zarr.partial"},
    "read_dyes": {"place_or_name": "polyjet"},
    "read_pictures": {"path": "no.gif"},
    "read_relief": {"path": "no.relief.zarr"},
    "read_scene": {"path_or_name": "gems"},
    "reach": {"silhouettes": SILHOUETTES, "grid": GRID},
    "read_shape": {"path": "no.shape.zarr"},
    "read_stage": {"path": "no.toml"},
    "read_stage_targets": {"path": "no.toml"},
    "relief": {"pictures": PICTURES, "recipe": lc.ReliefRecipe(side=8, sweeps=1)},
    "relief_mesh": {"relief": RELIEF},
    "relief_shadow": {"relief": RELIEF, "azimuth_deg": 0.0},
    "save": {"thing": CUBE, "path": "/no/such/folder/a.zarr"},
    "scene_rig": {"scene": SCENE},
    "scene_targets": {"scene": SCENE, "rig": RIG, "grid": GRID},
    "score": {"cube": CUBE, "targets": TARGETS},
    "score_relief": {"relief": RELIEF},
    "show": {"cube": CUBE},
    "silhouettes": {"cuts": CUTS, "rig": SILHOUETTES.rig},
    "solve": {"targets": TARGETS, "grid": GRID, "recipe": RECIPE},
    "spread_angles": {"count": 3},
    "threads": {},
    "turntable": {"grid": GRID, "angles_deg": [0]},
    "walls": {"grid": GRID},
}
#: No sensible argument of anything.
ABSURD: dict[str, Any] = {
    "None": None,
    "a word": "abc",
    "a path": Path("cube.zarr"),
    "yes": True,
    "a fraction": 2.5,
    "complex": 1j,
    "complex numbers": np.array([1j, 2]),
    "objects": np.array([None, "a"], object),
    "ragged": [[1, 2], [3]],
    "words": ["a", "b", "c"],
    "a table": {"a": 1},
    "a set": {1, 2},
    "a cube": CUBE,
    "targets": TARGETS,
    "a class": lc.Grid,
}
#: Of what is absurd elsewhere, what some arguments may be: by function, argument and value, ``*`` for any.
SENSIBLE = {
    *((name, argument, "a word") for name in GIVEN for argument in ("name", "title", "screen", "stop_reason")),
    *(("Label", argument, "a word") for argument in ("by", "note", "picture")),
    ("page", "label", "a word"),
    *(
        (name, argument, value)
        for name in ("Targets", "Cube", "Pictures", "Silhouettes")
        for argument, value in [("names", "words")]
    ),
    ("Shot", "lamps", "words"),
    ("attenuator", "names", "words"),
    ("Cube", "scores", "a table"),
    ("Cube", "provenance", "a table"),
    ("Shape", "provenance", "a table"),
    ("solve", "provenance", "a table"),
    ("Relief", "provenance", "a table"),
    ("Relief", "names", "words"),
    ("relief", "tell", "a class"),
    *((name, "callback", "a class") for name in ("page", "solve", "scene_targets")),
    ("dot_test", "dtype", "a class"),
    ("save", "path", "a path"),
    ("save", "path", "a word"),
    ("save", "thing", "a word"),
}


def arguments() -> list[tuple[str, str]]:
    return [(name, argument) for name in GIVEN for argument in inspect.signature(getattr(lc, name)).parameters]


def may_be(name: str, argument: str, what: str) -> bool:
    """Whether a value that is absurd elsewhere is sensible here, as the annotation says in words."""
    annotation = str(inspect.signature(getattr(lc, name)).parameters[argument].annotation)
    words = {part.strip() for part in annotation.split("|")}
    kinds = {
        "None": {"None", "Any"},
        "yes": {"bool"},
        "a fraction": {"float", "Numbers"},
        "a cube": {"Cube"},
        "targets": {"Targets"},
    }
    return bool(words & kinds.get(what, set())) or (name, argument, what) in SENSIBLE


def test_every_public_function_is_tried() -> None:
    assert set(GIVEN) == set(lc.__all__) - {"METHODS", "InputError"}


@pytest.mark.parametrize("name", GIVEN)
def test_what_is_right_is_taken(name: str) -> None:
    """Else the law below says nothing: what is refused is refused for the one thing that is wrong."""
    if name in (
        "load",
        "publish",
        "read_pictures",
        "read_relief",
        "read_shape",
        "read_stage",
        "read_stage_targets",
        "export",
        "read_export",
        "save",
    ):
        return
    getattr(lc, name)(**GIVEN[name])


@pytest.mark.parametrize(("name", "argument"), arguments(), ids=lambda said: said)
def test_whatever_is_absurd_is_one_sentence(name: str, argument: str) -> None:
    for what, value in ABSURD.items():
        if may_be(name, argument, what):
            continue
        with pytest.raises(lc.InputError) as refused:  # noqa: PT012
            getattr(lc, name)(**{**GIVEN[name], argument: value})
            pytest.fail(f"{what} was taken")
        assert "\n" not in str(refused.value)
        assert len(str(refused.value)) < 300


#: Numbers that nothing is: none, two kinds of infinity, and what float32 does not hold.
NO_NUMBERS = {"nan": np.nan, "numpy's nan": np.float32(np.nan), "inf": np.inf, "-inf": -np.inf, "1e308": 1e308}
#: What may be infinite, or so large that it is as good: limits that do not hold, results that were not reached.
LIMITLESS = {
    *("max_extinction", "hold_deg", "enough_db", "lower_bound", "reach_mm", "full_at_mm", "falloff_mm"),
    *("width", "memory", "hours", "cores", "steepest_px"),
}


def floats_of(name: str) -> list[tuple[str, int]]:
    """Arguments of one number or of a vector of numbers, and how many, as the annotation says in words."""
    lengths = {"float": 1, "float | None": 1, "Vector": 3, "Vector | None": 3, "tuple[float, float]": 2}
    parameters = inspect.signature(getattr(lc, name)).parameters.values()
    return [(each.name, lengths[said]) for each in parameters if (said := str(each.annotation)) in lengths]


@pytest.mark.parametrize(("name", "argument", "length"), [(name, *each) for name in GIVEN for each in floats_of(name)])
@pytest.mark.filterwarnings("error")
def test_what_is_no_number_is_no_limit(name: str, argument: str, length: int) -> None:
    for what, number in NO_NUMBERS.items():
        if "nan" not in what and argument in LIMITLESS:
            continue
        given = number if length == 1 else (1.0,) * (length - 1) + (number,)
        with pytest.raises(lc.InputError) as refused:  # noqa: PT012
            getattr(lc, name)(**{**GIVEN[name], argument: given})
            pytest.fail(f"{what} was taken")
        assert "\n" not in str(refused.value)


@pytest.mark.parametrize("argument", ["extinction", "pictures", "weights"])
@pytest.mark.filterwarnings("error")
def test_numbers_too_large_for_pictures_and_cubes_are_refused_without_a_warning(argument: str) -> None:
    name = "Cube" if argument == "extinction" else "Targets"
    shape = {"extinction": (3, 3, 5, 7), "pictures": (2, 3, 3, 3), "weights": (2, 3, 3)}[argument]
    with pytest.raises(lc.InputError, match="non-finite"):
        getattr(lc, name)(**{**GIVEN[name], argument: np.full(shape, 1e308)})


@pytest.mark.parametrize("tall", [0, 1e-320, -1, 1e9])
def test_slices_that_cannot_be_are_refused_before_they_are_counted(tall: float) -> None:
    with pytest.raises(lc.InputError, match="a slice is from"):
        lc.plan(PICTURES, tall=tall)


@pytest.mark.parametrize("count", [0, -1, 2**40, 2**62])
def test_angles_are_spread_for_as_many_pictures_as_can_be(count: int) -> None:
    for spread in (lc.spread_angles, lambda count: lc.scene_rig(SCENE, count)):
        with pytest.raises(lc.InputError):
            spread(count)


STAGE = lc.Stage(GRID, (LAMP,), (SCREEN,), (SHOT,))
MATRIX = lc.Projector(GRID, RIG)
#: Methods of public classes, and what is no sensible argument of theirs.
METHODS: dict[str, tuple[Callable[[Any], Any], list[Any]]] = {
    "Rig.take": (RIG.take, [[], slice(9, 12), slice("a"), "abc", [2], [-3], [0.5], 1, None, [[0]], [True]]),
    "Rig.at": (RIG.at, ["abc", None, [], [np.nan], 1j, [[1]]]),
    "Rig.turned": (RIG.turned, ["abc", None, [1, 2, 3], {}, [[1]], True]),
    "Rig.held": (lambda given: RIG.held(given, 1.0), ["abc", None, -1, np.nan]),
    "Rig.shifted": (RIG.shifted, ["abc", None, [1, 2], np.ones((2, 2))]),
    "Rig.whole": (RIG.whole, ["abc", None, RIG]),
    "Rig.of": (lc.Rig.of, ["abc", None, RIG]),
    "Views.take": (RIG.views.take, [[], slice(9, 12), "abc", [2], [0.5], 1, None, [[0]]]),
    "Views.joined": (RIG.views.joined, ["abc", None, lc.turntable(GRID, [0]).views]),
    "Targets.take": (TARGETS.take, [[], slice(9, 12), "abc", [2], [0.5], 1, None, [[0]], {}]),
    "Stage.lamp": (STAGE.lamp, ["abc", None]),
    "Stage.screen": (STAGE.screen, ["abc", None]),
    "Material.most": (lc.Material().most, ["abc", None]),
    "Projector": (MATRIX, ["abc", None, 1, [1, 2], [[None]]]),
    "Projector.T": (MATRIX.T, ["abc", None, 1, [1, 2], [[None]]]),
    "Projector.forward": (MATRIX.forward, ["abc", None, 1, [1, 2], [[None]]]),
    "Projector.row": (MATRIX.row, ["abc", None, -1, 1.5]),
    "Projector.as_linear_operator": (MATRIX.as_linear_operator, ["abc", int, lc]),
    "player": (lc.player(CUBE), ["abc", [], [np.nan], 1j]),
    "cast": (lambda given: lc.cast(CUBE, None, given), [np.ones((3, 3)), np.ones(2)]),
}


@pytest.mark.parametrize("name", METHODS)
def test_methods_refuse_what_is_absurd(name: str) -> None:
    method, absurd = METHODS[name]
    for value in absurd:
        with pytest.raises(lc.InputError) as refused:  # noqa: PT012
            method(value)
            pytest.fail(f"{value!r} was taken")
        assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("name", "values", "sentence"),
    [
        (
            "solve",
            ["photos", GRID],
            "solve takes Targets as targets, not 'photos': fit pictures to a rig with",
        ),
        ("play", ["cube.zarr"], "play takes a Cube as cube, not 'cube.zarr': read one with lightcube.load, or take"),
        ("Projector", [RIG, GRID], "Projector takes a Grid as grid, not a Rig: make one with lightcube.Grid("),
        ("Grid", [(3, 5, None)], "Grid takes 3 whole numbers as shape, not (3, 5, None): give 3 whole numbers"),
        ("Material", [1.0, "m"], "Material takes a known word as per, not 'm': use one of mm, voxel"),
        ("Shot", ["a", "b", [], "c"], "Shot takes a whole number as stop, not 'c': give a whole number"),
        ("turntable", [GRID, [[1], []]], "turntable takes numbers as angles_deg, not [[1], []]: give numbers"),
    ],
)
def test_sentences_say_where_what_and_what_to_do(name: str, values: list[Any], sentence: str) -> None:
    with pytest.raises(lc.InputError, match=re.escape(sentence)):
        getattr(lc, name)(*values)


def test_numpys_numbers_and_lists_are_as_good() -> None:
    grid = lc.Grid(np.array([3, 5, 7]), np.float32(0.5))  # type: ignore[arg-type]
    assert grid == lc.Grid((3, 5, 7), 0.5)
    assert len(lc.spread_angles(np.int64(3))) == 3  # type: ignore[arg-type]
    turned = lc.turntable(GRID, [np.float32(0.5), np.int8(3)])  # type: ignore[arg-type]
    assert turned.stops.angle_deg.tolist() == [0.5, 3.0]
    assert lc.Lamp("sun", direction=np.array([1, 0, 0])).direction == (1, 0, 0)  # type: ignore[arg-type]


def test_a_missing_argument_and_an_unknown_one_are_pythons_own_errors() -> None:
    with pytest.raises(TypeError, match="missing 1 required"):
        lc.play()  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="unexpected keyword argument 'angle'"):
        lc.play(CUBE, angle=3)  # type: ignore[call-arg]


@given(st.data())
@settings(max_examples=150)
def test_arrays_of_any_shape_are_taken_or_refused(data: st.DataObject) -> None:
    kinds = ["Cube", "Targets", "Views", "Prediction", "Result", "Solution"]
    name = data.draw(st.sampled_from(kinds))
    made = getattr(lc, name)(**GIVEN[name])
    field = data.draw(st.sampled_from([key for key, value in vars(made).items() if isinstance(value, np.ndarray)]))
    shape = data.draw(st.lists(st.integers(0, 4), max_size=4))
    kind = data.draw(st.sampled_from([np.float32, np.float64, np.int8, np.uint8, np.bool_, np.complex64, object]))
    array: Any = np.ones(shape, kind)
    try:
        value = getattr(lc, name)(**{**GIVEN[name], field: array})
    except lc.InputError:
        return
    assert getattr(value, field).shape == array.shape
    assert array.dtype.kind in "iufb"
