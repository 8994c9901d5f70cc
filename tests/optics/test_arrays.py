"""Arrays of a value are its own: what the caller's arrays become later does not matter, and nobody writes to them."""

from collections.abc import Callable
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np
import pytest

import lightcube as lc
from lightcube.optics.arrays import locked, owned
from lightcube.optics.tables import Stops
from lightcube.scoring.between import Curve

GRID = lc.Grid((3, 5, 7))
RIG = lc.turntable(GRID, [20, 70], elevation_deg=35, picture_shape=(3, 5))
PICTURES, WEIGHTS = np.full((2, 3, 5, 3), 0.5, np.float32), np.ones((2, 3, 5), np.float32)
EXTINCTION, POWERS = np.ones((3, 3, 5, 7), np.float32), np.ones((2, 3))
LEVELS = np.full((2, 3, 5, 4), 9, np.uint16)
CUBE = lc.Cube(EXTINCTION, GRID, RIG, POWERS, LEVELS)
VIEWS = {name: getattr(RIG.views, name).copy() for name in ("lamps", "origins_mm", "column_steps_mm", "row_steps_mm")}

#: Values that hold arrays: their class, their arrays, and what else they are made of.
HOLDERS: dict[str, tuple[Callable[..., Any], dict[str, Any], dict[str, Any]]] = {
    "Targets": (lc.Targets, {"pictures": PICTURES, "weights": WEIGHTS}, {"rig": RIG}),
    "Cube": (lc.Cube, {"extinction": EXTINCTION, "lamp_powers": POWERS, "targets": LEVELS}, {"grid": GRID, "rig": RIG}),
    "Views": (lc.Views, VIEWS, {"picture_shape": (3, 5)}),
    "Pictures": (lc.Pictures, {"angles_deg": np.arange(1.0)}, {"images": (PICTURES[0],), "names": ("a",)}),
    "Prediction": (lc.Prediction, {"psnr": np.ones(2)}, {"rehearsed": 20}),
    "Solution": (
        lc.Solution,
        {"residuals": np.ones(2), "rejected": np.zeros((1, 4), np.int64)},
        {"cube": CUBE, "undetermined": 0, "stop_reason": "converged"},
    ),
    "Result": (
        lc.Result,
        {"x": np.ones((4, 2), np.float32), "lamp_powers": np.ones((1, 1)), "residuals": np.ones(1)},
        {},
    ),
    "Stops": (Stops, {"angle_deg": np.ones(2), "screen": np.zeros(2, np.intp), "window": np.ones((2, 2), np.intp)}, {}),
    "Curve": (
        Curve,
        {name: np.ones(3) for name in ("angles_deg", "offsets_deg", "psnr", "ssim", "lobes_deg")},
        {"nearest": np.zeros(3, np.intp), "period_deg": 360.0},
    ),
}
CASES = [(name, array) for name, (_, arrays, _) in HOLDERS.items() for array in arrays]


def made(name: str, **changes: Any) -> tuple[Any, dict[str, Any]]:
    """A value, and the writable arrays that it was made of."""
    kind, arrays, more = HOLDERS[name]
    given = {key: array.copy() for key, array in arrays.items()} | changes
    return kind(**given, **more), given


def arrays_in(value: Any) -> list[np.ndarray]:
    """All arrays of a value, and of the values in it."""
    if isinstance(value, np.ndarray):
        return [value]
    if isinstance(value, tuple):
        return [array for each in value for array in arrays_in(each)]
    if not is_dataclass(value):
        return []
    return [array for each in fields(value) for array in arrays_in(getattr(value, each.name))]


@pytest.mark.parametrize(("name", "field"), CASES)
def test_arrays_are_not_shared_with_the_caller(name: str, field: str) -> None:
    value, given = made(name)
    before = getattr(value, field).copy()
    given[field][...] = 0
    given[field] -= 0
    assert np.array_equal(getattr(value, field), before)
    with pytest.raises(ValueError, match="read-only"):
        getattr(value, field)[...] = 1


def test_pictures_that_were_read_are_not_shared() -> None:
    image = PICTURES[0].copy()
    pictures = lc.Pictures((image,), ("a",))
    image[...] = 0
    assert np.all(pictures.images[0] == 0.5)


@pytest.mark.parametrize(("name", "field"), CASES)
def test_arrays_of_any_layout_are_taken(name: str, field: str) -> None:
    array = HOLDERS[name][1][field]
    layouts = {
        "backwards": array[::-1].copy()[::-1],
        "by columns": np.asfortranarray(array),
        "broadcast": np.broadcast_to(array[:1], array.shape),
        "every other": np.repeat(array, 2, axis=0)[::2],
    }
    for layout, given in layouts.items():
        value, _ = made(name, **{field: given})
        assert np.array_equal(getattr(value, field), given), layout
        assert not getattr(value, field).flags.writeable


def test_nothing_that_is_computed_can_be_written_to() -> None:
    solution = lc.solve(lc.Targets(PICTURES, RIG), GRID, lc.Recipe(passes=2))
    targets = lc.Targets(PICTURES, RIG)
    values = [solution, solution.cube, RIG.at([1, 2])[0], RIG.take([1]), targets.take([1, 0]), targets.take(slice(1))]
    for value in values:
        arrays = arrays_in(value)
        assert arrays
        assert not any(array.flags.writeable for array in arrays)
    assert not RIG.pairs.flags.writeable
    assert not RIG.pair.flags.writeable


def test_what_nobody_can_write_to_is_taken_without_a_copy() -> None:
    targets, cube = lc.Targets(PICTURES, RIG), lc.Cube(EXTINCTION, GRID, RIG)
    assert replace(targets, names=("a", "b")).pictures is targets.pictures
    assert replace(cube, status="interrupted").extinction is cube.extinction
    assert np.shares_memory(owned(cube.extinction[1:], np.float32), cube.extinction)
    fresh = np.ones((3, 5, 7))
    assert owned(locked(fresh), np.float64) is fresh
    turned = np.ones((3, 5, 7)).T
    assert owned(locked(turned), np.float64) is turned


@pytest.mark.parametrize("kind", ["a view", "a memoryview", "a bytearray", "handed out"])
def test_what_can_be_written_to_by_another_name_is_copied(kind: str) -> None:
    memory = np.ones((3, 5, 7))

    class Handing:
        def __array__(self, dtype: object = None, copy: object = None) -> np.ndarray:
            return memory

    view = memory[:]
    view.setflags(write=False)
    raw = bytearray(memory.tobytes())
    given: dict[str, Any] = {
        "a view": view,
        "a memoryview": np.asarray(memory.data.toreadonly()),
        "a bytearray": np.frombuffer(raw),
        "handed out": Handing(),
    }
    kept = owned(given[kind], np.float64)
    memory[...], raw[:] = 0, bytes(len(raw))
    assert np.all(kept == 1)
    assert not kept.flags.writeable
    assert memory.flags.writeable


def test_read_only_volumes_are_no_new_kind_to_the_compiler() -> None:
    """The shadows of a cube are computed by the loops that everything else uses."""
    from lightcube.kernels import rays, stacked

    point = replace(RIG.views, lamps=np.array([[-30.0, 2, 3, 1], [-30.0, 9, 3, 1]]))
    loops: list[tuple[lc.Views, Any]] = [(RIG.views, stacked._forward), (point, rays._forward)]
    for views, loop in loops:
        if not hasattr(loop, "signatures"):
            pytest.skip("kernels run interpreted: there is no compiler")
        A = lc.Projector(GRID, views)
        x = np.random.default_rng(4).random((A.shape[1], 3), np.float32)
        first = A.forward(x)
        kinds = list(loop.signatures)
        assert np.array_equal(A.forward(locked(x)), first)
        assert loop.signatures == kinds


@pytest.mark.parametrize("field", ["scores", "provenance"])
def test_what_a_cube_says_is_not_shared_with_the_caller(field: str) -> None:
    grid, numbers = lc.Grid((2, 3, 4)), np.arange(3.0)
    said: dict[str, Any] = {"a": 1, "in": {"b": [1, {"c": 2}], "d": ([3],)}, "array": numbers}
    as_it_was = repr(said)
    given: dict[str, Any] = {field: said}
    cube = lc.Cube(np.zeros((3, 2, 3, 4), np.float32), grid, lc.turntable(grid, [0.0]), **given)
    said["in"]["b"][1]["c"] = said["in"]["d"][0][0] = 9
    said["in"]["e"], said["a"] = 1, 2
    numbers[0] = 7.0
    assert repr(getattr(cube, field)) == as_it_was
