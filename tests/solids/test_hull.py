"""The hull against plain reckoning for every voxel; its surface against what it casts; what cannot be a hull."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from skimage.measure import marching_cubes

import lightcube as lc
from lightcube.errors import InputError
from lightcube.kernels.hull import MOST, STEP
from lightcube.kernels.tasks import using
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.solids import projections
from lightcube.solids.certificate import cast_mesh, certify
from lightcube.solids.field import hull_field
from lightcube.solids.mesh import Mesh
from lightcube.solids.shape import Shape, as_cube, hull
from lightcube.solids.silhouettes import FINE, Silhouettes
from lightcube.solids.surface import surface
from lightcube.solids.walls import walls
from tests.conftest import INTERPRETED
from tests.helpers.solid import (
    Flags,
    around,
    blobs,
    compiled_only,
    near_lamps,
    of_pixels,
    plain_field,
    products,
    seen,
    windows,
)

SHAPE = (7, 5, 6) if INTERPRETED else (16, 13, 15)


@pytest.mark.parametrize("count", [2, 3, 5, 8])
@pytest.mark.parametrize("rig_of", [around, near_lamps, windows])
def test_the_field_is_the_greatest_distance_over_views(rig_of: Callable[[Grid, int], Rig], count: int) -> None:
    grid = Grid(SHAPE, 0.7, 1.3)
    given = blobs(rig_of(grid, count), count, full=0.7)
    field = hull_field(given, grid, is_skipping=False)
    plain = plain_field(given, grid, projections.voxels_a_pixel(given.rig, grid))
    clear = np.abs(plain) > 1e-4
    assert 0 < np.count_nonzero(plain < 0) < plain.size
    np.testing.assert_array_equal(field[clear] < 0, plain[clear] < 0)
    np.testing.assert_allclose(field, np.clip(plain, -MOST, MOST), atol=STEP + 1e-9)  # what is nothing is a step
    assert np.all(np.abs(field) >= STEP)


@pytest.mark.parametrize("rig_of", [around, near_lamps])
def test_what_is_skipped_changes_no_voxel_and_no_vertex(rig_of: Callable[[Grid, int], Rig]) -> None:
    grid = Grid((32, 33, 31) if INTERPRETED else (44, 48, 47))
    given = blobs(rig_of(grid, 2), 5, full=0.7)
    rows, columns = given.inside.shape[1:]
    middle = np.zeros(given.inside.shape, np.bool_)
    middle[:, rows * 3 // 8 : rows * 5 // 8, columns * 3 // 8 : columns * 5 // 8] = True
    given = replace(given, inside=given.inside & middle)
    all_of_it, skipping = (hull_field(given, grid, is_skipping=each) for each in (False, True))
    left_out = skipping != all_of_it
    assert np.any(left_out)
    assert np.all(skipping[left_out] == MOST)
    assert np.all(all_of_it[left_out] > 0)
    first, second = (surface(each, grid) for each in (all_of_it, skipping))
    np.testing.assert_array_equal(first.triangles, second.triangles)


def test_any_number_of_threads_gives_the_same_bits() -> None:
    grid = Grid((25, 20, 21))
    made = []
    for count in (1, 3):
        with using(count):
            shape = hull(blobs(around(grid, 3), 1, full=0.7), grid)
            made.append((shape.field, cast_mesh(shape.mesh, shape.rig)))
    for first, second in zip(*made, strict=True):
        np.testing.assert_array_equal(first, second)


def three_pictures(seed: int, shape: tuple[int, int, int]) -> tuple[Flags, Flags, Flags]:
    nz, ny, nx = shape
    random = np.random.default_rng(seed)
    return random.random((nz, nx)) < 0.5, random.random((nz, ny)) < 0.5, random.random((ny, nx)) < 0.5


@pytest.mark.parametrize("seed", range(4))
def test_on_three_walls_it_casts_the_boolean_products_and_never_more(seed: int) -> None:
    shape = (5, 6, 7)
    grid = Grid(shape)
    front, side, top = three_pictures(seed, shape)
    inside = hull(of_pixels(walls(grid).rig(), front, side, top), grid).inside
    for shown, wanted, given in zip(seen(inside), products(front, side, top), (front, side, top), strict=True):
        np.testing.assert_array_equal(shown, wanted)
        assert not np.any(shown & ~given)


def test_walls_show_a_body_as_it_is_seen_from_the_front_the_right_and_above() -> None:
    grid = Grid((4, 5, 6))
    body = np.zeros(grid.shape, np.bool_)
    body[0, 0, :] = body[0, :, 5] = body[:, 0, 0] = True  # an edge along x, one along y, one along z
    glass = np.repeat(np.where(body, np.float32(99), np.float32(0))[None], 3, axis=0)
    rig = walls(grid).rig()
    shown = np.stack(list(lc.cast(lc.Cube(glass, grid, rig))))[..., 0] < 0.5
    for picture, wanted, (high, wide) in zip(shown, seen(body), rig.stops.window, strict=True):
        np.testing.assert_array_equal(picture[:high, :wide], wanted)


def test_as_black_glass_it_casts_the_same() -> None:
    grid = Grid((6, 7, 5))
    shape = hull(of_pixels(walls(grid).rig(), *three_pictures(3, grid.shape)), grid)
    cube = as_cube(shape)
    for picture, shadow, (high, wide) in zip(lc.cast(cube), seen(shape.inside), shape.rig.stops.window, strict=True):
        np.testing.assert_allclose(picture[:high, :wide, 1], ~shadow, atol=1e-4)
    assert cube.targets is not None
    np.testing.assert_array_equal(cube.targets[0, :6, :5, 0] == 0, three_pictures(3, grid.shape)[0])
    np.testing.assert_array_equal(cube.targets[..., 3] > 0, shape.rig.inside)


def body(grid_side: int) -> Flags | np.ndarray[tuple[int, int, int], np.dtype[np.float32]]:
    """Distances to a ring, a bar and a ball, from -1 to 1 along each axis."""
    x, y, z = np.meshgrid(*[(np.arange(grid_side) - (grid_side - 1) / 2) / (grid_side / 2)] * 3, indexing="ij")
    ring = np.hypot(np.hypot(x, y) - 0.5, z + 0.3) - 0.13
    ball = np.sqrt((x - 0.2) ** 2 + y**2 + (z - 0.35) ** 2) - 0.28
    bar = np.maximum(np.maximum(abs(x + 0.1) - 0.08, abs(y) - 0.08), abs(z) - 0.6)
    return np.minimum.reduce([ring, ball, bar]).astype(np.float32)


def shadows_of_the_body(n: int, count: int) -> tuple[Grid, Silhouettes, Mesh]:
    """Silhouettes of its mesh under a raised lamp."""
    corners, faces, _, _ = marching_cubes(body(128), 0.0)
    mesh = Mesh((corners.astype(float) - 63.5) / 64 * 50, faces[:, ::-1].astype(np.int64))
    grid = Grid((n, n, n), 100 / n)
    rig = turntable(grid, (np.arange(count) + 0.5) * 360 / count, elevation_deg=35)
    return grid, Silhouettes(cast_mesh(mesh, rig), rig, tuple(map(str, range(count)))), mesh


@compiled_only
def test_shadows_of_its_mesh_are_the_silhouettes_and_the_body_is_in_it() -> None:
    n = 128
    grid, given, _ = shadows_of_the_body(n, 12)
    shape = hull(given, grid)
    found = certify(shape.mesh, given)
    assert found.overlap.mean() >= 0.995
    assert found.overlap.min() >= 0.99
    assert shape.mesh.is_watertight
    true = body(n).transpose(2, 1, 0) < 0
    assert np.count_nonzero(true & ~shape.inside) <= 0.005 * np.count_nonzero(true)


@compiled_only
def test_a_point_lamps_shadows_too() -> None:
    _, _, mesh = shadows_of_the_body(8, 2)
    grid = Grid((96, 96, 96), 100 / 96)
    size = 100.0
    lamps = tuple(Lamp(str(k), position_mm=(-300 * np.cos(k), -300 * np.sin(k), 20.0 * k)) for k in range(6))
    screens = tuple(
        Screen(str(k), (100 * np.cos(k), 100 * np.sin(k), 0.0), (2.2 * size, 2.2 * size), 1.4) for k in range(6)
    )
    rig = Stage(grid, lamps, screens, tuple(Shot(str(k), str(k), (str(k),)) for k in range(6))).rig()
    given = Silhouettes(cast_mesh(mesh, rig), rig, tuple("abcdef"))
    shape = hull(given, grid)
    found = certify(shape.mesh, given)
    assert found.overlap.min() >= 0.985
    assert shape.mesh.is_watertight


def test_what_fills_the_block_ends_on_its_faces() -> None:
    grid = Grid((4, 6, 5), 0.5)
    full = (np.ones(size, bool) for size in ((4, 5), (4, 6), (6, 5)))
    shape = hull(of_pixels(walls(grid).rig(), *full), grid)
    assert shape.mesh.size_mm == pytest.approx((2.5, 3.0, 2.0))
    assert shape.mesh.volume_mm3 == pytest.approx(15, rel=0.1)  # edges are cut by less than half a voxel
    assert shape.mesh.standing().vertices_mm[:, 2].min() == 0


def test_a_box_casts_a_rectangle() -> None:
    """Level, as large as it is; of a point lamp twice as far from the screen, twice as large."""
    corners = np.array([[x, y, z] for x in (-0.001, 0.001) for y in (-2.0, 1) for z in (-1.0, 2)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    box = Mesh(corners, np.array([(q[0], q[i], q[i + 1]) for q in quads for i in (1, 2)]))
    grid = Grid((8, 8, 8))
    lamps = Lamp("far", direction=(1, 0, 0)), Lamp("near", position_mm=(-20, 0, 0))
    screen = Screen("wall", (20, 0, 0), (12, 10), 1)
    rig = Stage(grid, lamps, (screen,), (Shot("far", "wall", ("far",)), Shot("near", "wall", ("near",)))).rig()
    wanted = np.zeros((2, 10 * FINE, 12 * FINE), np.bool_)
    wanted[0, 3 * FINE : 6 * FINE, 5 * FINE : 8 * FINE] = True  # y goes to the left
    wanted[1, 1 * FINE : 7 * FINE, 4 * FINE : 10 * FINE] = True
    np.testing.assert_array_equal(cast_mesh(box, rig), wanted)


def test_a_wedge_casts_a_triangle() -> None:
    """Level along x, of a point lamp, whichever way its faces run: pixels on this side of three lines."""
    corners = np.array([(0.0, -3.1, -2.3), (0.0, 3.4, -1.2), (0.0, 0.3, 3.7), (0.7, 0.2, 0.1)])
    wedge = Mesh(corners, np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]))
    grid = Grid((8, 8, 8))
    screen = Screen("wall", (20, 0, 0), (10, 10), 1)
    rig = Stage(grid, (Lamp("far", direction=(1, 0, 0)),), (screen,), (Shot("a", "wall", ("far",)),)).rig()
    places = (np.arange(10 * FINE) + 0.5) / FINE - 5
    y, z = -places[None, :], -places[:, None]  # seen from the lamp y goes to the left
    a, b, c = corners[:3, 1:]
    sides = [(q[0] - p[0]) * (z - p[1]) - (q[1] - p[1]) * (y - p[0]) > 0 for p, q in ((a, b), (b, c), (c, a))]
    wanted = np.logical_and.reduce(np.broadcast_arrays(*sides))
    assert 0.1 < wanted.mean() < 0.3
    for mesh in (wedge, Mesh(wedge.vertices_mm, wedge.faces[:, ::-1])):
        np.testing.assert_array_equal(cast_mesh(mesh, rig)[0], wanted)


def test_a_certificate_counts_what_is_missing_and_what_is_beyond() -> None:
    grid = Grid((8, 8, 8))
    full = np.ones((8, 8), bool)
    box = hull(of_pixels(walls(grid).rig(), full, full, full), grid)
    half = np.arange(8) < 4
    found = certify(box.mesh, of_pixels(walls(grid).rig(), full, full & half, full))
    assert found.beyond == pytest.approx([0, 1, 0], abs=0.02)
    assert found.overlap == pytest.approx([1, 0.5, 1], abs=0.02)
    smaller = hull(of_pixels(walls(grid).rig(), full, full & half, full), grid)
    found = certify(smaller.mesh, box.silhouettes)
    assert found.missing == pytest.approx([0, 0.5, 0.5], abs=0.02)


def stage_with(grid: Grid, *lamps: Lamp, together: bool = False) -> Rig:
    screen = Screen("wall", (60, 0, 0), (60, 60), 1)
    names = tuple(lamp.name for lamp in lamps)
    shots = (Shot("a", "wall", names),) if together else tuple(Shot(name, "wall", (name,)) for name in names)
    return Stage(grid, lamps, (screen,), shots).rig()


def test_what_cannot_be_is_one_sentence() -> None:
    grid = Grid((10, 10, 10))
    far, near = Lamp("far", direction=(1, 0, 0)), Lamp("near", position_mm=(-4, 0, 0))
    full = np.ones((60, 60), bool)
    with pytest.raises(InputError, match=r"^lamp 'near' of picture 2 stands in the block or too near to it"):
        hull(of_pixels(stage_with(grid, far, near), full, full), grid)
    with pytest.raises(InputError, match="let one lamp light each picture"):
        hull(of_pixels(stage_with(grid, far, Lamp("too", direction=(1, 1, 0)), together=True), full), grid)
    rig = walls(grid).rig()
    left, right = np.zeros((10, 10), bool), np.zeros((10, 10), bool)
    left[:, :3], right[:, 7:] = True, True
    with pytest.raises(InputError, match=r"^nothing casts shadows in all these silhouettes: look whether"):
        hull(of_pixels(rig, left, left, right), grid)
    with pytest.raises(InputError, match="nothing of 1 is on its screen"):
        of_pixels(rig, left, left & False, left)


def test_a_shape_is_checked_when_it_is_made() -> None:
    grid = Grid((4, 4, 4))
    full = np.ones((4, 4), bool)
    shape = hull(of_pixels(walls(grid).rig(), full, full, full), grid)
    for field, said in (
        (shape.field[1:], "has shape"),
        (np.where(shape.field < 0, np.nan, 1).astype(np.float32), "zeros, NaN or infinities"),
        (shape.field * 0, "zeros, NaN or infinities"),
        (np.abs(shape.field), "nothing casts shadows"),
    ):
        with pytest.raises(InputError, match=said):
            Shape(field, grid, shape.silhouettes)
    with pytest.raises(InputError, match="extinction of black glass"):
        as_cube(shape, 0.0)
