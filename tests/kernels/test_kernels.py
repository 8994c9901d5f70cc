"""The fast paths of the kernels against plain ones: any tiles, vectors that are not full."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit

from lightcube.kernels import exponential, layout, rows
from lightcube.kernels.marching import ABREAST, march
from lightcube.kernels.ray import END, FIELDS, enter, follow, parts_of
from lightcube.kernels.stacked import GROUP
from lightcube.kernels.tiles import TILE
from lightcube.optics.grid import Grid
from lightcube.optics.views import turntable_views
from lightcube.projection.projector import Projector, dot_test
from tests.conftest import INTERPRETED
from tests.helpers import plain

#: Longer than a tile, one more than two tiles, and shorter.
SHAPES = [(2, TILE + 1, 5), (3, 3, 2 * TILE + 1), (2, TILE, TILE + 3)]


@njit
def compiled_add_rows(  # type: ignore[no-untyped-def]
    target, at, source, base, columns, places, shifts, weights, first, count, step, low, high, start, stop
):
    rows.add_rows(
        target, at, source, base, columns, places, shifts, weights, first, count, step, low, high, start, stop
    )


@njit
def compiled_march(state, size, strides, places, shifts, weights, first, counts, met):  # type: ignore[no-untyped-def]
    return march(state, size, strides, places, shifts, weights, first, counts, met)


@njit
def compiled_exp(numbers, out):  # type: ignore[no-untyped-def]
    for i in range(len(numbers)):
        out[i] = exponential.exp(numbers[i])


@njit
def compiled_log(numbers, out):  # type: ignore[no-untyped-def]
    for i in range(len(numbers)):
        out[i] = exponential.log(numbers[i])


@settings(max_examples=60)
@given(
    columns=st.integers(1, 150),
    target_columns=st.integers(1, 150),
    first=st.integers(0, 149),
    most=st.integers(0, 40),
    pieces=st.integers(1, 5),
    step=st.integers(1, 3),
    single=st.booleans(),
)
def test_vectors_of_sums_are_the_plain_sums(
    columns: int, target_columns: int, first: int, most: int, pieces: int, step: int, single: bool
) -> None:
    dtype = np.float32 if single else np.float64
    random = np.random.default_rng(columns + 1000 * most)
    source = random.random(7 * columns).astype(dtype)
    target = random.random(target_columns + 20).astype(dtype)
    places = (columns * random.integers(0, 6, 1 + step * pieces)).astype(np.int32)
    shifts = random.integers(-most, most + 1, 1 + step * pieces).astype(np.int32)
    weights = random.random(1 + step * pieces).astype(dtype)
    start = min(first, target_columns)
    wanted, found = target.copy(), target.copy()
    own = shifts[1::step][:pieces]
    which = places, shifts, weights, 1, pieces, step, int(own.min()), int(own.max()), start, target_columns
    rows.add_rows(wanted, 10, source, columns, columns, *which)
    compiled_add_rows(found, 10, source, columns, columns, *which)
    assert np.allclose(found, wanted, rtol=1e-6, atol=0)
    assert np.array_equal(found[: 10 + start], target[: 10 + start])
    assert np.array_equal(found[10 + target_columns :], target[10 + target_columns :])


@settings(max_examples=60)
@given(
    rays=st.lists(
        st.tuples(st.floats(-2, 9), st.floats(-1, 1), st.floats(-3, 3), st.floats(0, 6.3), st.floats(-2, 2)),
        max_size=ABREAST,
    ),
    nz=st.sampled_from([0, 1, 4]),
    single=st.booleans(),
)
def test_rays_side_by_side_go_as_each_alone(
    rays: list[tuple[float, float, float, float, float]], nz: int, single: bool
) -> None:
    """As many as there are, some through corners; whatever misses the block or is not there has no pieces."""
    size, most = (7, 5, nz), 80
    state = np.zeros((FIELDS, ABREAST))
    for lane, (px, py, pz, angle, dz) in enumerate(rays):
        dx, dy = np.cos(angle), np.sin(angle)
        ray = (px - 9 * dx, py - 9 * dy, pz, dx, dy, dz, -np.inf, np.inf)
        if parts_of(ray) > 1 or not enter(ray, size, 0.5 + lane, state, lane):
            state[END, lane] = -np.inf
    state[END, len(rays) :] = -np.inf
    strides, dtype = (3, 40, -2), np.float32 if single else np.float64

    def paper() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        room = 3 + most * ABREAST
        return np.zeros(room, np.uint32), np.zeros(room, np.int32), np.zeros(room, dtype)

    found, counts = paper(), np.full(ABREAST + 2, -1)
    end = compiled_march(state, size, strides, *found, 3, counts, 1)
    assert counts[0] == counts[-1] == -1
    assert end >= 3 + ABREAST * counts.max()
    for lane in range(ABREAST):
        alone = paper()
        count = follow(state, lane, size, strides, *alone, 0, 1)
        assert counts[1 + lane] == count
        for together, own in zip(found, alone, strict=True):
            assert np.array_equal(together[3 + lane :: ABREAST][:count], own[:count])


def test_exponential_is_exact_to_two_units_in_the_last_place() -> None:
    numbers = np.linspace(-86.5, 87.5, 20_001, dtype=np.float32)
    out = np.empty_like(numbers)
    compiled_exp(numbers, out)
    exact = np.exp(numbers.astype(np.float64))
    assert np.all(np.abs(out - exact) <= 2 * np.spacing(exact.astype(np.float32)))


def test_logarithm_is_exact_to_two_units_in_the_last_place() -> None:
    """Also near 1, where it is nearly 0, and where a number's exponent changes."""
    far = np.exp(np.linspace(-87, 88, 20_001)).astype(np.float32)
    near = np.float32(1) + np.linspace(-0.4, 0.6, 20_001, dtype=np.float32) ** 3
    numbers = np.concatenate([far, near, np.float32(2) ** np.arange(-126, 128, dtype=np.float32)])
    out = np.empty_like(numbers)
    compiled_log(numbers, out)
    exact = np.log(numbers.astype(np.float64))
    assert np.all(np.abs(out - exact) <= 2 * np.spacing(np.abs(exact).astype(np.float32)))


def test_logarithm_of_nothing_is_a_number() -> None:
    numbers = np.array([0, 1e-42, np.finfo(np.float32).tiny], np.float32)
    out = np.empty_like(numbers)
    compiled_log(numbers[2:], out[2:])
    assert out[2] == pytest.approx(-87.3365, abs=1e-4)
    if not INTERPRETED:
        compiled_log(numbers, out)
        assert np.all(out == out[2])


def test_exponential_ends_in_0_and_in_numbers() -> None:
    numbers = np.array([-100, -95, 87, 88], np.float32)
    out = np.empty_like(numbers)
    compiled_exp(numbers, out)
    assert np.all(out[:2] < 1e-37)
    assert np.all(out >= 0)
    assert np.all(np.isfinite(out))


@pytest.mark.parametrize("elevation", [0.0, 35.0, -75.0])
@pytest.mark.parametrize("shape", SHAPES)
def test_tiles_that_do_not_divide_agree_with_plain_boxes(shape: tuple[int, int, int], elevation: float) -> None:
    grid = Grid(shape, voxel_mm=0.7)
    rig = turntable_views(grid, [0.0, 33.0, 90.0], elevation_deg=elevation, picture_shape=(shape[0], 2 + shape[2] % 2))
    volume = np.random.default_rng(1).random((1, *shape))
    matrix = Projector(grid, rig)
    x = volume[0].transpose(1, 2, 0).reshape(matrix.shape[1], -1)
    shown = matrix.forward(np.ascontiguousarray(x)).reshape(len(rig), rig.picture_shape[1], -1)
    wanted = plain.absorbance_pictures(grid, rig, volume)[..., 0]
    assert np.allclose(shown[:, :, ::-1].transpose(0, 2, 1), wanted, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(("dtype", "bound"), [(np.float32, 1e-5), (np.float64, 1e-12)])
@pytest.mark.parametrize("elevation", [0.0, 35.0])
@pytest.mark.parametrize("channels", [1, 2, 5])
@pytest.mark.parametrize("shape", SHAPES)
def test_many_groups_of_views_and_all_tiles_are_one_matrix(
    shape: tuple[int, int, int], channels: int, elevation: float, dtype: type[np.floating], bound: float
) -> None:
    """`to_sparse` traces each beam through the whole grid at once."""
    grid = Grid(shape)
    angles = np.linspace(0, 180, GROUP + 3, endpoint=False) + 1
    matrix = Projector(
        grid, turntable_views(grid, angles, elevation_deg=elevation, picture_shape=(shape[0], 4 + shape[2] % 2))
    )
    sparse = matrix.to_sparse()
    columns = channels * (shape[0] if matrix.shape[1] == shape[1] * shape[2] else 1)
    random = np.random.default_rng(5)
    x = random.random((matrix.shape[1], columns)).astype(dtype)
    b = random.random((matrix.shape[0], columns)).astype(dtype)
    there, back = sparse @ x.astype(np.float64), sparse.T @ b.astype(np.float64)
    assert np.max(np.abs(matrix.forward(x) - there)) <= bound * np.max(there)
    assert np.max(np.abs(matrix.adjoint(b) - back)) <= bound * np.max(back)
    assert dot_test(matrix, columns, dtype) < bound


def test_products_begin_at_whole_cache_lines() -> None:
    matrix = Projector(Grid((3, 5, 7)), turntable_views(Grid((3, 5, 7)), [0.0, 33.0]))
    b = matrix.forward(np.ones((matrix.shape[1], 9), np.float32))
    for array in (b, matrix.adjoint(b), layout.copied(b[1:], np.float64)):
        assert array.ctypes.data % 64 == 0
        assert array.flags.c_contiguous
