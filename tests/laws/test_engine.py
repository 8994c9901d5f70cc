"""Laws that every engine keeps, in every geometry that it takes: what a matrix of beams is, however multiplied."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lightcube.errors import InputError
from lightcube.kernels.layout import (
    columns_from_pictures,
    columns_from_volume,
    pictures_from_columns,
    volume_from_columns,
)
from lightcube.optics.grid import Grid, raster_shape
from lightcube.optics.setups import turntable
from lightcube.optics.views import Views, turntable_views
from lightcube.projection.projector import Projector, dot_test
from lightcube.projection.rays import Rays
from lightcube.projection.stacked import StackedBeams
from tests.helpers import plain
from tests.projection.test_rays import lamps_for, lit, screens_for

Geometry = Callable[[Grid], Views]
ANGLES = [0.0, 13.0, 45.0, 90.0, 133.7, 180.0, 270.0, 301.5]
SHAPES = [(3, 5, 7), (4, 6, 5), (2, 3, 8), (1, 4, 4)]
DTYPES = [(np.float32, 1e-5), (np.float64, 1e-12)]


def table(elevation_deg: float, narrower: int = 0, pixel: int = 1) -> Geometry:
    """A turntable; a window narrower by an odd number puts the beams of 0 and 90 degrees on faces and edges."""

    def views(grid: Grid) -> Views:
        side = min(pixel, grid.largest_pixel)
        rows, columns = raster_shape(grid, elevation_deg, side)
        shape = rows, max(columns - narrower, 1)
        return turntable_views(grid, ANGLES, elevation_deg=elevation_deg, picture_shape=shape, pixel=side)

    return views


def room(*lamps: str) -> Geometry:
    """Lamps and screens of any kind."""

    def views(grid: Grid) -> Views:
        screens = [screens_for(grid.shape)[name] for name in ("slanted", "through the cube", "on faces of x")]
        return lit(grid, [lamps_for(grid.shape)[lamp] for lamp in lamps], screens, (2, 5))

    return views


TURNTABLES = {"level": table(0), "raised": table(35), "from below": table(-20), "on faces": table(0, narrower=1)}
TURNTABLES |= {"pixels of 2 voxels": table(35, pixel=2), "level pixels of 3": table(0, pixel=3)}
ROOMS = {"points": room("near", "inside", "level with faces"), "any direction": room("aslant", "+x", "steep")}
#: Every engine, and what stands where it can be asked for.
ENGINES: dict[type, dict[str, Geometry]] = {StackedBeams: TURNTABLES, Rays: TURNTABLES | ROOMS}
CASES = [
    pytest.param(engine, each[name], id=f"{engine.__name__}, {name}")
    for engine, each in ENGINES.items()
    for name in each
]
ON_TABLES = [pytest.param(engine, id=engine.__name__) for engine in ENGINES]


def cast(matrix: Any, views: Views, volume: np.ndarray) -> np.ndarray:
    """Pictures ``(view, row, column, channel)`` of a volume ``(channel, z, y, x)``."""
    columns = columns_from_volume(volume).reshape(matrix.shape[1], -1)
    return pictures_from_columns(matrix.forward(columns), views.picture_shape, len(volume))


def thrown_back(matrix: Any, grid: Grid, pictures: np.ndarray) -> np.ndarray:
    """Volume of pictures."""
    columns = matrix.adjoint(columns_from_pictures(pictures).reshape(matrix.shape[0], -1))
    ny, nx = grid.shape[1:]
    return volume_from_columns(columns.reshape(ny * nx, -1), grid.shape, pictures.shape[-1])


@pytest.mark.parametrize(("shape", "tall"), [*((shape, 1.0) for shape in SHAPES), ((5, 6, 7), 0.5)])
@pytest.mark.parametrize(("engine", "geometry"), CASES)
def test_both_products_are_those_of_plain_boxes(
    engine: type, geometry: Geometry, shape: tuple[int, int, int], tall: float
) -> None:
    grid = Grid(shape, 0.7, tall)
    views, random = geometry(grid), np.random.default_rng(1)
    matrix = engine(grid, views)
    for channels in (1, 2, 3, 5):
        volume, pictures = (
            random.random((channels, *shape)),
            random.random((len(views), *views.picture_shape, channels)),
        )
        np.testing.assert_allclose(
            cast(matrix, views, volume), plain.absorbance_pictures(grid, views, volume), rtol=1e-9, atol=1e-9
        )
        back = plain.back_projection(grid, views, pictures)
        np.testing.assert_allclose(thrown_back(matrix, grid, pictures), back, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(("dtype", "bound"), DTYPES)
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(("engine", "geometry"), CASES)
def test_the_adjoint_is_the_transpose(
    engine: type, geometry: Geometry, shape: tuple[int, int, int], dtype: type[np.floating], bound: float
) -> None:
    grid = Grid(shape, 1.3)
    for columns in (1, 3, 7):
        assert dot_test(engine(grid, geometry(grid)), columns, dtype) < bound


@pytest.mark.parametrize("tall", [1.0, 0.5])
@pytest.mark.parametrize(("engine", "geometry"), CASES)
def test_chords_of_a_box_are_analytic(engine: type, geometry: Geometry, tall: float) -> None:
    """A grid of ones is a box: each beam's absorbance is its chord by the slab method, half of it on a face."""
    grid = Grid((3, 5, 7), 2.0, tall)
    views, half = geometry(grid), np.array(grid.size_mm[::-1]) / 2
    chords = cast(engine(grid, views), views, np.ones((1, *grid.shape)))[..., 0]
    for view, row, column in np.ndindex(*chords.shape):
        point, direction, enter, leave = plain.beam_of_pixel(views, view, row, column)
        along = np.abs(direction) < 1e-12
        part = np.prod(
            np.where(np.abs(np.abs(point[along]) - half[along]) < 1e-9, 0.5, np.abs(point[along]) < half[along])
        )
        for axis in np.flatnonzero(~along):
            first, second = sorted((side * half[axis] - point[axis]) / direction[axis] for side in (-1, 1))
            enter, leave = max(enter, first), min(leave, second)
        assert chords[view, row, column] == pytest.approx(part * max(leave - enter, 0), abs=1e-9)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("engine", ON_TABLES)
def test_a_view_along_an_axis_holds_the_whole_mass(engine: type, shape: tuple[int, int, int]) -> None:
    """Where toolkits err: beams on faces must neither lose nor double what they run along."""
    grid = Grid(shape, 0.5)
    volume = np.random.default_rng(3).random((1, *shape))
    for columns in (raster_shape(grid)[1], raster_shape(grid)[1] - 1):
        views = turntable_views(grid, [0.0, 90.0, 180.0, 270.0], picture_shape=(shape[0], columns))
        for picture in cast(engine(grid, views), views, volume):
            assert np.sum(picture, axis=(1, 2)) == pytest.approx(0.5 * np.sum(volume, axis=(0, 2, 3))[::-1])


@pytest.mark.parametrize("engine", ON_TABLES)
def test_the_tie_rule_starts_at_a_billionth_of_a_voxel(engine: type) -> None:
    """Within 1e-9 of a face a beam along it is shared; a thousandth of a voxel beside it is not."""
    grid = Grid((1, 2, 4))
    views = turntable_views(grid, [0.0], picture_shape=(1, 1))
    volume = np.zeros((1, 1, 2, 4))
    volume[:, :, 0] = 1
    for aside, expected in ((0.0, 2.0), (0.5e-9, 2.0), (-0.5e-9, 2.0), (1e-6, 0.0), (-1e-6, 4.0)):
        origins = views.origins_mm + np.array([0, aside, 0])
        moved = Views(views.lamps, origins, views.column_steps_mm, views.row_steps_mm, (1, 1))
        assert cast(engine(grid, moved), moved, volume)[0, 0, 0, 0] == pytest.approx(expected, abs=1e-6)
        assert plain.absorbance_pictures(grid, moved, volume)[0, 0, 0, 0] == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("tall", [1.0, 0.5])
@pytest.mark.parametrize(("engine", "geometry"), CASES)
def test_rows_and_the_sparse_matrix_are_what_is_multiplied_by(engine: type, geometry: Geometry, tall: float) -> None:
    grid = Grid((2, 4, 3), 0.5, tall)
    matrix = engine(grid, geometry(grid))
    dense = matrix.forward(np.eye(matrix.shape[1]))
    np.testing.assert_allclose(matrix.adjoint(np.eye(matrix.shape[0])), dense.T, rtol=0, atol=1e-12)
    np.testing.assert_allclose(matrix.to_sparse().toarray(), dense, rtol=0, atol=1e-12)
    for index in range(matrix.shape[0]):
        row = np.zeros(matrix.shape[1])
        np.add.at(row, *matrix.row(index))
        np.testing.assert_allclose(row, dense[index], rtol=0, atol=1e-12)


@pytest.mark.parametrize("geometry", (TURNTABLES | ROOMS).values(), ids=TURNTABLES | ROOMS)
@pytest.mark.parametrize("times", [2, 3])
def test_tall_slices_cast_what_as_many_thin_ones_of_the_same_glass_do(geometry: Geometry, times: int) -> None:
    """A voxel `times` as tall as wide, or as many cubes upon each other; half a view's mass, too, stays where it is."""
    tall, thin = Grid((3, 5, 6), 0.7, times), Grid((3 * times, 5, 6), 0.7)
    views, volume = geometry(tall), np.random.default_rng(4).random((2, *tall.shape))
    pictures = np.random.default_rng(5).random((len(views), *views.picture_shape, 2))
    A, B = Projector(tall, views), Projector(thin, views)
    np.testing.assert_allclose(A(volume), B(volume.repeat(times, axis=1)), rtol=1e-9, atol=1e-9)
    thrown_back = B.T(pictures).reshape(2, 3, times, 5, 6).sum(axis=2)
    np.testing.assert_allclose(A.T(pictures), thrown_back, rtol=1e-9, atol=1e-9)
    assert dot_test(A) < 1e-12


@pytest.mark.parametrize(("engine", "geometry"), CASES)
def test_the_projector_is_its_engine(engine: type, geometry: Geometry) -> None:
    """Whichever it chooses, the products are this one's, and by columns they are scipy's operator's too."""
    grid = Grid((3, 5, 7), 0.7)
    views, volume = geometry(grid), np.random.default_rng(2).random((3, 3, 5, 7))
    A = Projector(grid, views)
    np.testing.assert_allclose(A(volume), cast(engine(grid, views), views, volume), rtol=1e-9, atol=1e-9)
    columns = columns_from_volume(volume).reshape(A.shape[1], -1)
    np.testing.assert_allclose(A.as_linear_operator() @ columns, A @ columns, rtol=1e-12)
    assert len(A.view_of_row) == A.shape[0]


@pytest.mark.parametrize("columns", [0, 1001, 2**62])
def test_a_dot_test_of_more_columns_than_it_needs_is_refused(columns: int) -> None:
    grid = Grid((2, 3, 4))
    with pytest.raises(InputError, match=f"takes 1 to 1000 columns .*, not {columns} and 0"):
        dot_test(Projector(grid, turntable(grid, [20.0])), columns)
