"""Conventions: axes, the screen raster, angles and their spreading, absorption, display values."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from lightcube.errors import InputError
from lightcube.kernels.layout import (
    columns_from_pictures,
    columns_from_volume,
    pictures_from_columns,
    volume_from_columns,
)
from lightcube.optics.absorption import absorbance, extinction, transmittance, transparency
from lightcube.optics.grid import Grid, picture_shape, raster_shape
from lightcube.optics.transfer import check_transfer, decode, encode, from_levels, to_uint8
from lightcube.optics.views import Views, spread_angles, turntable_views
from tests.helpers import plain


def test_the_papers_rasters() -> None:
    assert raster_shape(Grid((3, 3, 3))) == (3, 5)
    assert raster_shape(Grid((300, 300, 300))) == (300, 426)


@given(st.tuples(*[st.integers(1, 40)] * 3), st.floats(-80, 80), st.integers(1, 5), st.integers(1, 3))
def test_the_raster_holds_the_whole_shadow_and_is_no_larger_than_it_must(
    shape: tuple[int, int, int], elevation_deg: float, pixel: int, tall: int
) -> None:
    nz, ny, nx = tall * shape[0], *shape[1:]
    rows, columns = raster_shape(Grid(shape, tall=tall), elevation_deg, pixel)
    diagonal = math.hypot(nx, ny)
    height = nz + diagonal * abs(math.tan(math.radians(elevation_deg)))
    assert (columns - -(-ny // pixel)) % 2 == 0
    assert (rows - -(-nz // pixel)) % 2 == 0
    assert diagonal - 1e-6 <= pixel * columns < diagonal + 2 * pixel
    assert height - 1e-6 <= pixel * rows < height + 2 * pixel


def test_a_grid_of_tall_slices_measures_what_it_counts() -> None:
    grid = Grid((3, 5, 7), 0.5, 2.5)
    assert grid.size_mm == (3.75, 2.5, 3.5)
    assert (grid.slice_mm, grid.longest) == (1.25, 7.5)
    assert grid.coarser((2, 3, 4), 2) == Grid((2, 3, 4), 1.0, 2.5)
    assert repr(grid) == "Grid(shape=(3, 5, 7), voxel_mm=0.5, tall=2.5)"
    assert Grid((3, 5, 7), 0.5) == Grid((3, 5, 7), 0.5, 1)


def test_light_screen_and_turning_are_as_the_conventions_say() -> None:
    grid = Grid((3, 5, 7), 2.0)
    views = turntable_views(grid, [0.0, 90.0], elevation_deg=30.0)
    assert np.allclose(views.lamps[0], [math.cos(math.pi / 6), 0, -0.5, 0])
    assert np.allclose(views.column_steps_mm[0], [0, -2, 0])
    assert np.allclose(views.row_steps_mm[0], [0, 0, -2])
    wide = turntable_views(grid, [0.0, 90.0], elevation_deg=30.0, pixel=3)
    assert np.allclose(wide.column_steps_mm, 3 * views.column_steps_mm)
    assert np.allclose(wide.row_steps_mm, 3 * views.row_steps_mm)
    assert wide.pixel_in(grid) == pytest.approx((3, 3))
    # turned by +90 degrees, the cube's own +x points along the room's +y: in its frame light goes along -y
    assert np.allclose(views.lamps[1], [0, -math.cos(math.pi / 6), -0.5, 0])
    assert np.allclose(views.column_steps_mm[1], [-2, 0, 0])


@given(st.floats(0, 359.99), st.floats(-85, 85))
def test_angles_and_elevations_come_back(angle_deg: float, elevation_deg: float) -> None:
    views = turntable_views(Grid((2, 2, 2)), [angle_deg], elevation_deg=elevation_deg)
    assert (views.angles_deg[0] - angle_deg + 180) % 360 - 180 == pytest.approx(0, abs=2e-9)
    assert views.elevations_deg[0] == pytest.approx(elevation_deg, abs=2e-9)


@pytest.mark.parametrize("span_deg", [180.0, 360.0])
@pytest.mark.parametrize("count", range(1, 40))
def test_spread_angles_avoid_multiples_of_90(count: int, span_deg: float) -> None:
    angles_deg = spread_angles(count, span_deg)
    assert np.allclose(np.diff(angles_deg), span_deg / count)
    assert np.all((angles_deg > 0) & (angles_deg < span_deg))
    assert np.min(np.abs((angles_deg + 45) % 90 - 45)) > 0.1
    half = np.abs((span_deg / count * (np.arange(count) + 0.5) + 45) % 90 - 45).min() > 1e-9
    assert angles_deg[0] == pytest.approx(span_deg / count * (1 / 2 if half else 1 / 3))


def test_spread_follows_the_elevation() -> None:
    assert spread_angles(4)[-1] < 180
    assert spread_angles(4, elevation_deg=35)[-1] > 180


@given(
    st.floats(0.01, 1.4), st.floats(0.2, 5), st.floats(-60, 60), st.tuples(*[st.integers(3, 60)] * 3), st.integers(1, 3)
)
def test_picture_shapes_have_the_rasters_parity_and_fit(
    width: float, aspect: float, elevation_deg: float, shape: tuple[int, int, int], pixel: int
) -> None:
    grid = Grid(shape)
    raster = raster_shape(grid, elevation_deg, pixel)
    try:
        rows, columns = picture_shape(grid, width, aspect, elevation_deg, pixel)
    except InputError:
        assert width * shape[1] / pixel > raster[1] - 2
        return
    assert 1 <= rows <= raster[0]
    assert 1 <= columns <= raster[1]
    assert (raster[0] - rows) % 2 == 0
    assert (raster[1] - columns) % 2 == 0
    assert abs(columns - width * shape[1] / pixel) <= 2


@pytest.mark.parametrize(
    "make",
    [
        lambda: Grid((0, 3, 3)),
        lambda: Grid((3, 3)),  # type: ignore[arg-type]
        lambda: Grid((3, 3, 3), -1.0),
        lambda: Grid((3, 3, 3), math.nan),
        lambda: Grid((3, 3, 3), tall=0.0),
        lambda: Grid((3, 3, 3), tall=math.inf),
        lambda: turntable_views(Grid((3, 3, 3)), []),
        lambda: turntable_views(Grid((3, 3, 3)), [math.nan]),
        lambda: turntable_views(Grid((3, 3, 3)), [0], elevation_deg=90),
        lambda: turntable_views(Grid((3, 3, 3)), [0], elevation_deg=-90),
        lambda: turntable_views(Grid((3, 3, 3)), [0], picture_shape=(3, 7)),
        lambda: turntable_views(Grid((3, 3, 3)), [0], picture_shape=(0, 3)),
        lambda: turntable_views(Grid((3, 4, 5)), [0], pixel=0),
        lambda: turntable_views(Grid((3, 4, 5)), [0], pixel=4),
        lambda: turntable_views(Grid((4, 4, 4)), [0], picture_shape=(3, 3), pixel=2),
        lambda: picture_shape(Grid((3, 4, 5)), 0.5, 1.0, pixel=4),
        lambda: picture_shape(Grid((3, 3, 3)), 0.0, 1.0),
        lambda: picture_shape(Grid((3, 3, 3)), 9.0, 1.0),
        lambda: picture_shape(Grid((3, 3, 3)), 1.0, math.inf),
        lambda: spread_angles(0),
        lambda: spread_angles(3, 400),
        lambda: Views(np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 3)), (1, 1)),
        lambda: absorbance(np.array([0.5, 0.0])),
        lambda: check_transfer("gamma"),
    ],
)
def test_nonsense_is_refused(make) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError):
        make()


@given(arrays(np.float32, array_shapes(min_dims=4, max_dims=4, max_side=4), elements=st.floats(0, 1, width=32)))
def test_layouts_go_there_and_back(block: np.ndarray) -> None:
    channels, *shape = block.shape
    columns = columns_from_volume(block)
    assert columns.shape == (shape[1] * shape[2], shape[0] * channels)
    assert np.array_equal(volume_from_columns(columns, (shape[0], shape[1], shape[2]), channels), block)
    views, rows, width, colours = block.shape
    stacked = columns_from_pictures(block)
    assert stacked.shape == (views * width, rows * colours)
    assert np.array_equal(pictures_from_columns(stacked, (rows, width), colours), block)
    assert stacked[0, 0] == block[0, rows - 1, 0, 0]


@given(st.floats(0, 3))
def test_srgb_is_the_standard_curve_and_its_inverse(value: float) -> None:
    display = np.array([value])
    assert decode(display)[0] == pytest.approx(plain.srgb_decode(value), rel=1e-9)
    assert encode(decode(display))[0] == pytest.approx(value, rel=1e-6, abs=1e-6)


def test_8_bit_levels_come_back() -> None:
    levels = np.arange(256, dtype=np.uint8)
    for transfer in ("srgb", "linear"):
        known = check_transfer(transfer)
        assert np.array_equal(to_uint8(from_levels(levels, known), known), levels)
    assert to_uint8(np.array([2.0]))[0] == 255


@given(st.floats(1e-3, 1.0), st.floats(0.01, 10))
def test_the_papers_transparency_is_that_of_a_voxels_diagonal(k: float, side: float) -> None:
    sigma = extinction(np.array([k]), side)
    assert transparency(sigma, side)[0] == pytest.approx(k)
    assert transmittance(sigma * math.sqrt(2) * side)[0] == pytest.approx(k)
    assert absorbance(transmittance(sigma))[0] == pytest.approx(sigma[0], abs=1e-12)
