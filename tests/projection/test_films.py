"""The laws that the matrix of a stack of films keeps: beams one by one, exact means, moves, acrylic, near lamps."""

from dataclasses import replace

import numpy as np
import pytest

import lightcube as lc
from lightcube.errors import InputError
from lightcube.optics.light import is_exact
from lightcube.optics.moves import Move, misplaced, moved
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.projection.projector import Projector, dot_test
from tests.helpers import films as plain

STACK = Stack((3, 11, 13), 2.5, heights_mm=(-9.0, 1.0, 8.0))


def crossed(rig: Rig) -> Rig:
    """Films in another order, shifted, turned by quarters and turned over."""
    moves = [
        Move("x", order=(2, 3, 1), shift_mm=((1, 2), (0, 0.3), (-3, 0))),
        Move("y", turn_deg=(90, 0, 180), shift_mm=((0, 0.7), (0.2, 0), (0, 0))),
    ]
    return moved(rig, STACK, moves)


ACRYLIC = replace(STACK, index=1.49)
ROOMS = {
    "far": (STACK, plain.room(STACK)),
    "acrylic": (ACRYLIC, plain.room(ACRYLIC, low_mm=-12.0)),
    "near": (STACK, plain.room(STACK, near=True, low_mm=-12.0)),
    "moved": (STACK, crossed(plain.room(STACK))),
    "off": (STACK, misplaced(plain.room(STACK), STACK, np.array([[0.3, 0, 0.1], [0, -0.4, 0], [0.2, 0.2, -0.5]]))),
}


@pytest.fixture(params=ROOMS)
def case(request: pytest.FixtureRequest) -> tuple[lc.Cube, Rig]:
    stack, rig = ROOMS[request.param]
    random = np.random.default_rng(5)
    extinction = 0.2 * random.random((3, *stack.shape)) * (random.random(stack.shape) < 0.7)
    return lc.Cube(extinction.astype(np.float32), stack, rig), rig


def test_beams_lose_what_each_film_takes_one_by_one(case: tuple[lc.Cube, Rig]) -> None:
    cube, rig = case
    shown = np.stack(list(lc.cast(cube, rig, light="thin")))
    np.testing.assert_allclose(shown, plain.cast(cube, rig, 1), atol=1e-6)
    assert np.ptp(shown) > 0.2


def test_means_are_those_of_ever_more_beams(case: tuple[lc.Cube, Rig]) -> None:
    cube, rig = case
    assert is_exact(rig, cube.grid)
    shown = np.stack(list(lc.cast(cube, rig)))
    coarse, fine = (np.sqrt(np.mean((plain.cast(cube, rig, beams) - shown) ** 2)) for beams in (7, 28))
    assert fine < 4e-3
    assert fine < coarse / 4


def test_rectangles_fill_their_pixels(case: tuple[lc.Cube, Rig]) -> None:
    cube, rig = case
    areas = Projector(cube.grid, rig.squared(1.0)).areas
    assert areas is not None
    sums = areas.reshape(len(rig.views), -1, np.prod(rig.picture_shape)).sum(axis=1)
    np.testing.assert_allclose(sums, 1, atol=1e-6)


def test_parts_of_pixels_make_up_their_means(case: tuple[lc.Cube, Rig]) -> None:
    cube, rig = case
    whole, parts = (np.stack(list(lc.cast(cube, rig, zoom=zoom))) for zoom in (1, 3))
    rows, columns = rig.picture_shape
    parts = parts.reshape(len(rig), rows, 3, columns, 3, -1)
    np.testing.assert_allclose(parts.mean(axis=(2, 4)), whole, atol=1e-6)
    assert np.ptp(parts, axis=(2, 4)).max() > 0.05


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("square", [0.0, 1.0])
def test_products_are_each_others_transposes(case: tuple[lc.Cube, Rig], square: float, dtype: str) -> None:
    cube, rig = case
    matrix = Projector(cube.grid, rig.squared(square))
    assert dot_test(matrix, columns=3, dtype=dtype) < (1e-6 if dtype == "float32" else 1e-14)
    assert dot_test(matrix, columns=2) < 1e-14


@pytest.mark.parametrize("square", [0.0, 1.0])
def test_rows_and_the_sparse_matrix_are_those_of_the_products(case: tuple[lc.Cube, Rig], square: float) -> None:
    cube, rig = case
    matrix = Projector(cube.grid, rig.squared(square))
    x = np.random.default_rng(2).random((matrix.shape[1], 3))
    products = matrix.forward(x)
    np.testing.assert_allclose(matrix.to_sparse() @ x, products, atol=1e-12)
    for index in range(0, matrix.shape[0], 97):
        unknowns, lengths = matrix.row(index)
        np.testing.assert_allclose(lengths @ x[unknowns], products[index], atol=1e-12)
    assert np.all(products.max(axis=0) > 0)


def test_upright_light_meets_each_film_in_the_cell_above_the_pixel() -> None:
    """A film of one dark cell, at (y, x) = (1, 4) of 3 x 5, under light from above: one pixel is dark."""
    stack = Stack((2, 3, 5), 1.0, heights_mm=(-1.0, 1.0))
    lamp = lc.Lamp("lamp", direction=(0.0, 0.0, -1.0))
    wall = lc.Screen("wall", (0.0, 0.0, 0.0), (5.0, 3.0), 1.0, normal=(0.0, 0.0, 1.0), up=(0.0, 1.0, 0.0))
    rig = lc.Stage(stack, (lamp,), (wall,), (lc.Shot("p", "wall", ("lamp",)),)).rig()
    extinction = np.zeros((3, 2, 3, 5), np.float32)
    extinction[:, :, 2, 4] = (1.0, 2.0)
    shown = next(lc.cast(lc.Cube(extinction, stack, rig), rig))[..., 0]
    expected = np.ones((3, 5))
    expected[0, 4] = np.exp(-3)  # y points up
    np.testing.assert_allclose(shown, expected, atol=1e-6)


def test_a_film_that_is_slid_casts_what_a_lamp_aslant_does() -> None:
    """Slid by s over another, g below it: a lamp of slope s / g, but for the longer way."""
    stack = Stack((2, 9, 9), 1.0, heights_mm=(-2.0, 2.0))
    wall = lc.Screen("wall", (0.0, 0.0, -2.0), (3.0, 3.0), 1.0, normal=(0.0, 0.0, 1.0), up=(0.0, 1.0, 0.0))
    shot = lc.Shot("p", "wall", ("lamp",))
    extinction = np.random.default_rng(0).random((3, 2, 9, 9)).astype(np.float32)
    slope = 0.35
    rooms = [
        lc.Stage(stack, (lc.Lamp("lamp", direction=(slope, 0.0, -1.0)),), (wall,), (shot,)),
        lc.Stage(
            stack,
            (lc.Lamp("lamp", direction=(0.0, 0.0, -1.0)),),
            (wall,),
            (replace(shot, move=Move("slid", shift_mm=((0.0, 0.0), (4 * slope, 0.0)))),),
        ),
    ]
    longer = np.sqrt(1 + slope**2)
    aslant, slid = (
        next(lc.cast(lc.Cube(extinction / way, stack, room.rig())))
        for room, way in zip(rooms, (longer, 1), strict=True)
    )
    np.testing.assert_allclose(aslant, slid, atol=1e-5)


def test_light_along_the_films_is_refused() -> None:
    rig = plain.room(STACK)
    level = replace(rig, views=replace(rig.views, lamps=np.array([[1.0, 0, 0, 0], [0, 1.0, 0, 0]])))
    with pytest.raises(InputError, match="picture 1 runs along the films"):
        Projector(STACK, level)


def test_near_lamps_shine_through_air_only() -> None:
    with pytest.raises(InputError, match="in air only"):
        Projector(ACRYLIC, plain.room(ACRYLIC, near=True, low_mm=-12.0))


def test_turned_films_have_no_exact_means_and_are_averaged_over_points() -> None:
    rig = moved(plain.room(STACK), STACK, [Move("z", turn_deg=(30, 0, 0)), None])
    assert not is_exact(rig, STACK)
    with pytest.raises(InputError, match="do not lie along the pixels"):
        Projector(STACK, rig.squared(1.0))
    cube = lc.Cube(np.full((3, *STACK.shape), 0.1, np.float32), STACK, rig)
    shown = np.stack(list(lc.cast(cube)))
    assert np.abs(shown - plain.cast(cube, rig, 16)).max() < 0.03


def test_any_number_of_threads_gives_the_same_bits() -> None:
    from lightcube.kernels import tasks

    stack = Stack((3, 40, 40), 1.0, heights_mm=(-3.0, 0.0, 3.0))
    wall = lc.Screen("wall", (0.0, 0.0, 0.0), (30.0, 30.0), 1.5, normal=(0.0, 0.0, 1.0), up=(0.0, 1.0, 0.0))
    rig = lc.Stage(
        stack, (lc.Lamp("lamp", direction=(0.2, 0.1, -1.0)),), (wall,), (lc.Shot("p", "wall", ("lamp",)),)
    ).rig()
    matrix = Projector(stack, rig.squared(1.0))
    random = np.random.default_rng(1)
    x, b = (random.random((count, 3), np.float32) for count in matrix.shape[::-1])
    found = []
    for count in (1, 3):
        with tasks.using(count):
            found.append((matrix.forward(x), matrix.adjoint(b)))
    for one, three in zip(*found, strict=True):
        np.testing.assert_array_equal(one, three)
