"""The laws that the matrix of any rays keeps: parallel and from points, screens in any position, bricks of voxels."""

from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike

from lightcube.errors import InputError
from lightcube.kernels.rays import BRICK
from lightcube.optics.grid import Grid, raster_shape
from lightcube.optics.views import Views, rotations, turntable_views
from lightcube.projection.projector import Projector, dot_test
from lightcube.projection.rays import Rays, shadow_matrices
from lightcube.projection.stacked import StackedBeams
from tests.helpers import plain

Lamp = tuple[float, ...]
ROOT = Path(__file__).parents[2]
SHAPES = [(3, 5, 7), (4, 6, 5), (1, 4, 4)]
#: Longer than two bricks along an axis, and than one along another.
BRICKS = [(2, 2 * BRICK + 6, BRICK + 3), (BRICK + 1, 2, BRICK + 5)]
EITHER = [(np.float64, 1e-9), (np.float32, 1e-5)]


class Screen(NamedTuple):
    """Its middle, and from pixel to pixel, in voxel sides from the grid's lowest corner."""

    middle: ArrayLike
    right: ArrayLike
    down: ArrayLike


def lit(grid: Grid, lamps: Sequence[Lamp], screens: Sequence[Screen], picture_shape: tuple[int, int]) -> Views:
    """Views of every lamp on every screen; lamps are homogeneous, in voxel sides from the grid's lowest corner."""
    side, half = grid.voxel_mm, np.array(grid.shape[::-1]) / 2
    pairs = list(product(np.array(lamps, float), screens))
    return Views(
        np.array([[*(side * (lamp[:3] - lamp[3] * half)), lamp[3]] for lamp, _ in pairs]),
        side * np.array([np.array(screen.middle) - half for _, screen in pairs]),
        side * np.array([screen.right for _, screen in pairs]),
        side * np.array([screen.down for _, screen in pairs]),
        picture_shape,
    )


def lamps_for(shape: tuple[int, int, int]) -> dict[str, Lamp]:
    nz, ny, nx = shape
    axes = {sign + "xyz"[axis]: (*(int(sign + "1") * np.eye(3)[axis]), 0) for sign in "+-" for axis in range(3)}
    return axes | {
        "aslant": (1, -0.7, 0.4, 0),
        "steep": (-0.2, 0.3, -2, 0),
        "along a diagonal": (1, 1, 0, 0),
        "through corners": (1, -1, 1, 0),
        "near": (-1.3, 0.5 * ny + 0.2, 0.5 * nz - 0.3, 1),
        "far": (-1000, 400, 300, 1),
        "as far as the sun": (-1.2e14, 3e13, 5e13, 1),
        "above": (0.5 * nx + 0.1, 0.5 * ny - 0.2, nz + 6, 1),
        "level with faces": (-2, 1, 1, 1),
        "inside": (0.4 * nx, 0.6 * ny, 0.3 * nz, 1),
        "on a corner inside": (1, 1, 1, 1),
        "beyond the screen": (3 * nx + 8, 0.4 * ny, 0.6 * nz, 1),
    }


def screens_for(shape: tuple[int, int, int]) -> dict[str, Screen]:
    nz, ny, nx = shape
    middle, x = np.array([nx, ny, nz]) / 2, np.array([nx, 0, 0])
    slanted, through = (np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0] for seed in (1, 2))
    return {
        "behind": Screen(middle + x, (0, -1.3, 0), (0, 0, -0.9)),
        "behind, seen from its rear": Screen(middle + x + 0.1, (0, 1.3, 0), (0, 0, -0.9)),
        "floor": Screen(middle - [0.1, 0.2, nz], (0, -1.3, 0), (-1.1, 0, 0)),
        "slanted": Screen(middle + x - 0.2, 1.2 * slanted[0], 0.8 * slanted[1]),
        "through the cube": Screen(middle + 0.1, 1.1 * through[0], 1.1 * through[1]),
        "pixels not square": Screen(middle - [0, ny, 0], (1, 0.2, 0), (0.3, 0.1, -1)),
        # in steps of half a voxel: on faces, on edges and in the middle of voxels
        "on faces of x": Screen((nx + 1, 1, 1), (0, -0.5, 0), (0, 0, -0.5)),
        "on faces of y": Screen((1, ny + 1, 1), (0.5, 0, 0), (0, 0, -0.5)),
        "on faces of z": Screen((1, 1, -1), (0, -0.5, 0), (-0.5, 0, 0)),
    }


def check(grid: Grid, views: Views) -> None:
    """Both products are the plain matrix's."""
    matrix, wanted = Projector(grid, views), plain.matrix(grid, views)
    random = np.random.default_rng(1)
    for columns, (dtype, bound) in [*product((1, 3), EITHER), (2, EITHER[1]), (5, EITHER[0])]:
        x = random.random((matrix.shape[1], columns)).astype(dtype)
        b = random.random((matrix.shape[0], columns)).astype(dtype)
        for found, plainly in ((matrix.forward(x), wanted @ x), (matrix.adjoint(b), wanted.T @ b)):
            assert found.dtype == dtype
            assert np.max(np.abs(found - plainly)) <= bound * max(np.max(plainly), grid.voxel_mm)


@pytest.mark.parametrize("lamp", lamps_for((1, 1, 1)))
@pytest.mark.parametrize("shape", SHAPES)
def test_agrees_with_plain_boxes(shape: tuple[int, int, int], lamp: str) -> None:
    grid = Grid(shape, 0.7)
    check(grid, lit(grid, [lamps_for(shape)[lamp]], list(screens_for(shape).values()), (3, 5)))


@pytest.mark.parametrize(("dtype", "bound"), [(np.float64, 1e-12), (np.float32, 1e-5)])
@pytest.mark.parametrize("columns", [1, 2, 3, 5])
@pytest.mark.parametrize("shape", [*SHAPES, BRICKS[0]])
def test_adjoint_is_the_transpose(
    shape: tuple[int, int, int], columns: int, dtype: type[np.floating], bound: float
) -> None:
    grid = Grid(shape, 1.3)
    views = lit(grid, list(lamps_for(shape).values()), list(screens_for(shape).values()), (2, 3))
    assert dot_test(Projector(grid, views), columns, dtype) < bound


@pytest.mark.parametrize("shape", BRICKS)
def test_bricks_leave_no_seam(shape: tuple[int, int, int]) -> None:
    """Rays along the faces and edges that bricks share, through their corners, and shadows on a few large pixels."""
    grid = Grid(shape, 0.9)
    nz, ny, nx = shape
    seam = tuple(BRICK if n > BRICK else 1 for n in (nx, ny, nz))
    lamps = [*lamps_for(shape).values(), (*seam, 1), (-3, *seam[1:], 1), (*seam[:2], nz + 2, 1)]
    screens = [
        Screen((nx + 9, *seam[1:]), (0, -0.5, 0), (0, 0, -0.5)),
        Screen((seam[0], ny + 9, seam[2]), (0.5, 0, 0), (0, 0, -0.5)),
        Screen((*seam[:2], -9), (0, -0.5, 0), (-0.5, 0, 0)),
        Screen((2 * nx, 0.5 * ny, 0.5 * nz), (0, -ny / 4, 0), (0, ny / 30, -nz / 4)),
        Screen((0.5 * nx, 0.5 * ny, -nz), (0, -ny / 4, 0), (-nx / 4, 0, 0)),
    ]
    check(grid, lit(grid, lamps, screens, (3, 5)))


@st.composite
def grids_and_views(draw: st.DrawFn) -> tuple[Grid, Views]:
    """Lamps and pixels at halves of voxels, where ties abound, as they are or turned together."""
    grid = Grid(draw(st.tuples(*[st.integers(1, 5)] * 3)), draw(st.sampled_from([0.01, 0.7, 1.0, 13.7])))
    place = st.tuples(*[st.integers(-8, 16).map(lambda halves: halves / 2)] * 3)
    way = st.tuples(*[st.integers(-2, 2)] * 3).filter(any)
    right, down = np.array(draw(way)) / 2, np.array(draw(way)) / 2
    assume(np.any(np.cross(right, down)))
    lamps = [(*draw(place), 1), (*draw(way), 0)]
    views = lit(grid, lamps, [Screen(draw(place), right, down)], draw(st.sampled_from([(3, 3), (2, 4)])))
    degrees = draw(st.sampled_from([0.0, 90.0, 120.0]) | st.integers(-999, 999).map(lambda number: number / 7))
    turn = rotations(draw(way), np.array([degrees]))[0].T
    turned = np.column_stack([views.lamps[:, :3] @ turn, views.lamps[:, 3]])
    steps = views.column_steps_mm @ turn, views.row_steps_mm @ turn
    return grid, Views(turned, views.origins_mm @ turn, *steps, views.picture_shape)


@settings(max_examples=60)
@given(grids_and_views())
def test_any_rays_agree_with_plain_boxes(case: tuple[Grid, Views]) -> None:
    check(*case)
    matrix = Rays(*case)
    assert matrix.to_sparse().nnz == 0 or dot_test(matrix) < 1e-12


@pytest.mark.parametrize(("dtype", "bound"), [(np.float64, 1e-12), (np.float32, 1e-5)])
@pytest.mark.parametrize("elevation_deg", [0.0, 35.0, -35.0])
@pytest.mark.parametrize(
    ("shape", "pixel", "tall"),
    [
        *((shape, 1, 1.0) for shape in SHAPES),
        *(((5, 6, 7), 2, 1.0), ((5, 6, 7), 3, 1.0), ((11, 18, 33), 2, 1.0)),
        *(((5, 6, 7), 2, 2.0), ((5, 6, 7), 3, 1.5), ((5, 6, 7), 1, 0.5), ((11, 18, 33), 4, 2.0)),
    ],
)
def test_on_a_turntable_both_engines_are_one_matrix(
    shape: tuple[int, int, int],
    pixel: int,
    tall: float,
    elevation_deg: float,
    dtype: type[np.floating],
    bound: float,
) -> None:
    """Windows one narrower or lower put the beams of 0 and 90 degrees on faces and edges."""
    grid = Grid(shape, 0.7, tall)
    rows, columns = raster_shape(grid, elevation_deg, pixel)
    random = np.random.default_rng(2)
    angles_deg = [0.0, 13.0, 90.0, 133.7, 180.0]
    for picture_shape in {(rows, columns), (rows, columns - 1), (max(rows - 1, 1), columns - 2)}:
        views = turntable_views(grid, angles_deg, elevation_deg=elevation_deg, picture_shape=picture_shape, pixel=pixel)
        any_rays, stacked = Rays(grid, views), StackedBeams(grid, views)
        x = random.random((any_rays.shape[1], 3)).astype(dtype)
        b = random.random((any_rays.shape[0], 3)).astype(dtype)
        there = stacked.forward(x.reshape(stacked.shape[1], -1)).reshape(-1, 3)
        back = stacked.adjoint(b.reshape(stacked.shape[0], -1)).reshape(-1, 3)
        assert np.max(np.abs(any_rays.forward(x) - there)) <= bound * np.max(there)
        assert np.max(np.abs(any_rays.adjoint(b) - back)) <= bound * np.max(back)


def test_the_engine_follows_from_where_lamps_and_screens_stand() -> None:
    """Stacked beams are many times quicker and cast a turntable's geometry alone: they must not take another."""
    grid = Grid((3, 5, 7), 2.0)
    table = turntable_views(grid, [0.0, 30.0, 200.0], elevation_deg=20.0)

    def changed(**vectors: np.ndarray) -> Views:
        kept = {name: getattr(table, name) for name in ("lamps", "origins_mm", "column_steps_mm", "row_steps_mm")}
        return Views(**{**kept, **vectors}, picture_shape=(3, 9))

    up, lamps = np.array([0, 0, 1.0]), table.lamps
    point = np.array([[*(-9 * lamps[0, :3]), 1], *lamps[1:]])
    stacked = {
        "a turntable": table,
        "one whose lamp is level": turntable_views(grid, [0.0, 30.0]),
        "rows and columns two voxels apart": turntable_views(grid, [0.0, 30.0], elevation_deg=20.0, pixel=2),
        "columns of any width": changed(column_steps_mm=1.3 * table.column_steps_mm),
        "another window": changed(origins_mm=table.origins_mm + 0.3),
        "light aslant on the screen": changed(column_steps_mm=table.column_steps_mm + np.array([0.3, -0.2, 0])),
        "another length of the direction": changed(lamps=3 * lamps),
    }
    others = {
        "a point among parallel lamps": changed(lamps=point),
        "rows not a voxel apart": changed(row_steps_mm=1.01 * table.row_steps_mm),
        "rows one and two voxels apart": changed(row_steps_mm=table.row_steps_mm * np.array([[1], [2], [1]])),
        "rows half a voxel apart": changed(row_steps_mm=0.5 * table.row_steps_mm),
        "a picture upside down": changed(row_steps_mm=-table.row_steps_mm),
        "columns that rise": changed(column_steps_mm=table.column_steps_mm + 0.1 * up),
        "a screen that leans": changed(row_steps_mm=table.row_steps_mm + np.array([0.1, 0, 0])),
        "light from above": changed(lamps=np.tile([*-up, 0], (3, 1))),
    }
    for name, views in stacked.items():
        assert type(Projector(grid, views)._engine) is StackedBeams, name
    slices = {1.0: (StackedBeams, False), 2.0: (StackedBeams, True), 4.0: (Rays, False), 1.5: (Rays, False)}
    for tall, (engine, level) in slices.items():
        high = Projector(Grid((3, 5, 7), tall=tall), turntable_views(Grid((3, 5, 7), tall=tall), [0.0], pixel=2))
        assert (type(high._engine), high.level) == (engine, level), tall
    for name, views in others.items():
        assert type(Projector(grid, views)._engine) is Rays, name
        assert not Projector(grid, views).level


@pytest.mark.parametrize("light", [(1, -0.7, 0.4), (-0.2, 0.3, -2), (0, 1, 0.3)])
def test_shadows_hold_the_whole_mass(light: tuple[float, float, float]) -> None:
    """Parallel light: over a screen that holds the whole shadow, aslant, absorbance times ``|u.n|`` adds up to it."""
    grid = Grid((3, 5, 7), 0.7)
    unit = np.array(light) / np.linalg.norm(light)
    aside = np.cross(unit, [0.3, 0.5, 0.9])
    right = 0.25 * (aside / np.linalg.norm(aside) + 0.4 * unit)
    down = 0.2 * (np.cross(unit, aside) / np.linalg.norm(aside) - 0.3 * unit)
    views = lit(grid, [(*light, 0)], [Screen((3.5, 2.5, 1.5), right, down)], (51, 41))
    matrix = Projector(grid, views)
    extinction = np.random.default_rng(3).random((matrix.shape[1], 2))
    pictures = matrix.forward(extinction).reshape(41, 51, 2)
    assert not np.any(pictures[[0, -1]])
    assert not np.any(pictures[:, [0, -1]])
    area = abs(np.cross(views.column_steps_mm[0], views.row_steps_mm[0]) @ unit)
    mass = grid.voxel_mm**3 * np.sum(extinction, axis=0)
    assert np.sum(pictures, axis=(0, 1)) * area == pytest.approx(mass, rel=0.01)


@pytest.mark.parametrize("aside", [0.0, 0.5])
@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", [-1, 1])
def test_light_along_an_axis_holds_the_whole_mass_to_the_last_digit(axis: int, sign: int, aside: float) -> None:
    """Pixels a voxel apart, in the middle of voxels or on their edges: neither may lose or double anything."""
    grid = Grid((3, 5, 7), 0.7)
    right, down = np.eye(3)[axis - 2], np.eye(3)[axis - 1]
    views = lit(
        grid, [(*(sign * np.eye(3)[axis]), 0)], [Screen((3.5 + aside, 2.5 + aside, 1.5 + aside), right, down)], (9, 9)
    )
    matrix = Projector(grid, views)
    extinction = np.random.default_rng(4).random((matrix.shape[1], 1))
    assert np.sum(matrix.forward(extinction)) == pytest.approx(0.7 * np.sum(extinction), rel=1e-12)


def test_a_far_point_is_parallel_light() -> None:
    grid = Grid((3, 5, 7), 0.7)
    light = np.array([1, -0.7, 0.4]) / np.linalg.norm([1, -0.7, 0.4])
    screen = Screen(np.array([3.5, 2.5, 1.5]) + 6 * light, (0.2, -1.1, 0), (0.3, 0, -0.9))
    lamps = [(*light, 0), (*(-1e6 / 0.7 * light), 1)]
    matrix = Projector(grid, lit(grid, lamps, [screen], (6, 8)))
    pictures = matrix.forward(np.random.default_rng(5).random((matrix.shape[1], 2))).reshape(2, -1)
    assert np.max(pictures) > 1
    assert np.max(np.abs(pictures[1] - pictures[0])) < 1e-4


def some_rays(heard: np.ndarray | None = None) -> Projector:
    shape = (2, 4, 3)
    lamps = [lamps_for(shape)[name] for name in ("-y", "aslant", "near", "on a corner inside")]
    screens = [screens_for(shape)[name] for name in ("on faces of y", "slanted")]
    grid = Grid(shape, 0.5)
    return Projector(grid, lit(grid, lamps, screens, (3, 5)), heard)


def test_rows_know_their_views_and_end() -> None:
    matrix = some_rays()
    assert np.array_equal(matrix.view_of_row, np.repeat(np.arange(8), 15))
    with pytest.raises(InputError, match="row 120"):
        matrix.row(120)


@pytest.mark.parametrize("columns", [1, 3])
def test_pixels_that_do_not_count_are_empty_rows_and_change_no_other(columns: int) -> None:
    heard = np.random.default_rng(6).random((8, 3, 5)) < 0.6
    whole, part = some_rays(), some_rays(heard)
    rows = heard[:, ::-1].transpose(0, 2, 1).ravel()
    x = np.random.default_rng(7).random((whole.shape[1], columns))
    assert np.array_equal(part.forward(x), np.where(rows[:, None], whole.forward(x), 0))
    b = np.random.default_rng(8).random((whole.shape[0], columns))
    silent = np.where(rows[:, None], b, np.nan)
    assert np.array_equal(part.adjoint(silent), whole.adjoint(np.where(rows[:, None], b, 0)))
    assert np.array_equal(part.to_sparse().toarray(), np.where(rows[:, None], whole.to_sparse().toarray(), 0))
    assert len(part.row(int(np.argmin(rows)))[0]) == 0
    with pytest.raises(InputError, match="which pixels count"):
        some_rays(heard[1:])


def test_a_lamp_on_a_pixel_or_pixels_on_one_line_cast_no_error() -> None:
    """No light passes the cube on its way from a lamp to where it stands."""
    grid = Grid((3, 5, 7), 2.0)
    matrix = Projector(grid, lit(grid, [(3, 2, 1, 1)], [Screen((3, 2, 1), (0, -0.75, 0), (0.125, 0, -0.75))], (3, 5)))
    assert len(matrix.row(7)[0]) == 0
    assert np.count_nonzero(matrix.forward(np.ones((matrix.shape[1], 1)))) == 14
    check(
        grid, lit(grid, [(-3, 2, 1, 1), (1, 0.2, 0.3, 0)], [Screen((9, 2.1, 1.1), (0, 0, 0), (0, 0.3, -0.8))], (5, 1))
    )


@pytest.mark.parametrize("seed", range(5))
def test_shadow_matrices_agree_with_plain_intersection(seed: int) -> None:
    """Where the line of light through a point meets the screen's plane; above 0 on its side of the lamp."""
    random = np.random.default_rng(seed)
    screen = random.normal(size=(3, 3))
    corner, right, up = screen
    normal = np.cross(right, up)
    light = random.normal(size=3)
    for lamp in np.array([[*light, 1], [*(1e14 * light), 1], [*light, 0]]):
        (matrix,) = shadow_matrices(lamp[None], screen[None])
        for point in 9 * random.normal(size=(20, 3)):
            way = point - lamp[:3] if lamp[3] else lamp[:3]
            column, row, _ = np.linalg.solve(np.stack([right, up, -way], axis=1), point - corner)
            shadow = matrix @ [*point, 1]
            assert shadow[:2] / shadow[2] == pytest.approx([column, row], rel=1e-9, abs=1e-9)
            in_front = lamp[3] == 0 or (way @ normal) * ((corner - lamp[:3]) @ normal) > 0
            assert (shadow[2] > 0) == in_front


def test_more_voxels_than_have_numbers_are_refused() -> None:
    grid = Grid((2**11, 2**11, 2**10 + 1))
    views = Views(
        np.array([[1.0, 0, 0, 0]]), np.zeros((1, 3)), np.array([[0, 1.0, 0]]), np.array([[0, 0, -1.0]]), (1, 1)
    )
    with pytest.raises(InputError, match="too large for rays in any direction"):
        Rays(grid, views)
