"""The matrix as an operator: volumes to pictures and back, columns to columns, scipy's operator, copies by pickle."""

import pickle
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.kernels.layout import (
    columns_from_pictures,
    columns_from_volume,
    pictures_from_columns,
    volume_from_columns,
)
from lightcube.optics.grid import Grid
from lightcube.optics.views import turntable_views
from lightcube.projection.projector import Projector, dot_test
from tests.projection.test_rays import lamps_for, lit, screens_for

KINDS = ["level", "raised", "point", "any direction", "some pixels", "level windows", "raised windows"]
KINDS += ["level by 2", "raised by 3 windows"]


def windows(shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Pixels that count in four views: all, some inside a window at two corners, a column, none."""
    heard = np.zeros(shape, bool)
    heard[0] = True
    heard[1, 1:, :2] = np.random.default_rng(0).random((shape[1] - 1, 2)) < 0.6
    heard[2, : shape[1] // 2 + 1, 1] = True
    return heard


def as_window(heard: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """All pixels of the least window around those of each view."""
    full = np.zeros_like(heard)
    for view, own in enumerate(heard):
        if own.any():
            (top, left), (bottom, right) = np.argwhere(own).min(axis=0), np.argwhere(own).max(axis=0)
            full[view, top : bottom + 1, left : right + 1] = True
    return full


def operator(kind: str, shape: tuple[int, int, int] = (3, 5, 7)) -> Projector:
    """One of each kind of matrix, on four views of unequal sizes."""
    grid = Grid(shape, 0.7)
    if kind.startswith(("level", "raised")):
        raised, pixel = 35.0 * kind.startswith("raised"), next((n for n in (2, 3) if f"by {n}" in kind), 1)
        views = turntable_views(grid, [0.0, 13.0, 90.0, 200.0], elevation_deg=raised, pixel=min(pixel, *shape))
        return Projector(grid, views, windows((4, *views.picture_shape)) if kind.endswith("windows") else None)
    lamps = ["near", "inside"] if kind == "point" else ["aslant", "+x"]
    screens = [screens_for(shape)[name] for name in ("slanted", "on faces of x")]
    heard = np.random.default_rng(0).random((4, 2, 5)) < 0.6 if kind == "some pixels" else None
    return Projector(grid, lit(grid, [lamps_for(shape)[name] for name in lamps], screens, (2, 5)), heard)


def some(shape: tuple[int, ...], seed: int = 1) -> Any:
    return np.random.default_rng(seed).random(shape)


@pytest.mark.parametrize(("dtype", "bound"), [(np.float32, 1e-5), (np.float64, 1e-12)])
@pytest.mark.parametrize("shape", [(3, 5, 7), (4, 6, 5), (1, 4, 3)])
@pytest.mark.parametrize("kind", KINDS)
def test_inner_products_are_the_same_on_either_side(
    kind: str, shape: tuple[int, int, int], dtype: type[np.floating], bound: float
) -> None:
    A = operator(kind, shape)
    volume, pictures = some((2, *A.domain_shape)).astype(dtype), some((*A.range_shape, 2)).astype(dtype)
    cast, thrown_back = A(volume), A.T(pictures)
    assert cast.dtype == thrown_back.dtype == dtype
    size = float(np.linalg.norm(cast) * np.linalg.norm(pictures))
    assert abs(float(np.vdot(cast, pictures) - np.vdot(volume, thrown_back))) < bound * size
    assert dot_test(A.T, 3, dtype) < bound


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("shape", [(3, 5, 7), (4, 6, 5), (2, 17, 40)])
@pytest.mark.parametrize("kind", ["level", "raised", "level by 2", "raised by 2"])
def test_stacked_beams_are_those_of_each_views_window(
    kind: str, shape: tuple[int, int, int], dtype: type[np.floating]
) -> None:
    """As the whole matrix has them; rows are whole where the beams are level. What stands elsewhere is not read."""
    whole, part = operator(kind, shape), operator(f"{kind} windows", shape)
    heard = as_window(windows(part.range_shape))
    if kind == "level":
        heard = np.repeat(heard.any(axis=1, keepdims=True), heard.shape[1], axis=1)
    volume, pictures = some((2, *shape)).astype(dtype), some((*part.range_shape, 2)).astype(dtype)
    close: dict[str, Any] = {
        "rtol": 1e-5 if dtype == np.float32 else 1e-12,
        "atol": 1e-6 if dtype == np.float32 else 1e-13,
    }
    np.testing.assert_array_equal(part(volume)[~heard], 0)
    np.testing.assert_allclose(part(volume)[heard], whole(volume)[heard], **close)
    unread = np.where(heard[..., None], pictures, np.nan)
    np.testing.assert_allclose(part.T(unread), whole.T(np.where(heard[..., None], pictures, 0).astype(dtype)), **close)
    sparse = part.to_sparse()
    columns = columns_from_volume(volume).reshape(part.shape[1], -1)
    np.testing.assert_allclose(sparse @ columns, part @ columns, **close)
    cast = part @ columns
    for index in range(0, part.shape[0], 3):
        unknowns, lengths = part.row(index)
        np.testing.assert_allclose(lengths @ columns[unknowns], cast[index], **close)


@pytest.mark.parametrize("kind", KINDS)
def test_an_array_without_channels_is_one_of_one_channel(kind: str) -> None:
    A = operator(kind)
    volume, pictures = some(A.domain_shape), some(A.range_shape)
    assert A(volume).shape == A.range_shape
    assert A.T(pictures).shape == A.domain_shape
    assert np.array_equal(A(volume), A(volume[None])[..., 0])
    assert np.array_equal(A.T(pictures), A.T(pictures[..., None])[0])


@pytest.mark.parametrize("kind", KINDS)
def test_the_transpose_of_the_transpose_is_the_matrix_itself(kind: str) -> None:
    A = operator(kind)
    assert A.T.T is A
    assert A.T is A.T
    assert A.T.shape == A.shape[::-1]
    assert A.T.domain_shape == A.range_shape == (4, *A.views.picture_shape)
    assert A.T.range_shape == A.domain_shape == A.grid.shape
    dense = A.to_sparse().toarray()
    assert np.array_equal(A.T.to_sparse().toarray(), dense.T)
    x, b = some((A.shape[1], 2)), some((A.shape[0], 2))
    assert np.array_equal(A.T.forward(b), A.adjoint(b))
    assert np.array_equal(A.T.adjoint(x), A.forward(x))


@pytest.mark.parametrize("kind", KINDS)
def test_at_multiplies_vectors_and_blocks_of_columns(kind: str) -> None:
    A = operator(kind)
    for matrix in (A, A.T):
        dense = matrix.to_sparse().toarray()
        for shape in ((), (1,), (4,), (0,)):
            x = some((matrix.shape[1], *shape))
            assert np.allclose(matrix @ x, dense @ x, rtol=1e-12, atol=1e-12)
            assert (matrix @ x).shape == (matrix.shape[0], *shape)


@pytest.mark.parametrize("kind", KINDS)
def test_volumes_and_columns_are_the_same_numbers(kind: str) -> None:
    """The ways that errors name, there and back."""
    A = operator(kind)
    volume, pictures = some((2, *A.domain_shape)), some((*A.range_shape, 2))
    b = A @ columns_from_volume(volume).reshape(A.shape[1], -1)
    x = A.T @ columns_from_pictures(pictures).reshape(A.shape[0], -1)
    assert np.array_equal(A(volume), pictures_from_columns(b, A.range_shape[1:], 2))
    assert np.array_equal(A.T(pictures), volume_from_columns(x, A.domain_shape, 2))


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_given_is_neither_written_nor_kept_and_may_lie_in_any_order(kind: str) -> None:
    A = operator(kind)
    for matrix, channels_last in ((A, False), (A.T, True)):
        array = some((*matrix.domain_shape, 2) if channels_last else (2, *matrix.domain_shape))
        kept = array.copy()
        expected = matrix(array)
        assert np.array_equal(array, kept)
        assert np.array_equal(matrix(np.asfortranarray(array)), expected)
        array.setflags(write=False)
        assert not np.shares_memory(matrix(array), array)


@pytest.mark.parametrize("kind", KINDS)
def test_errors_say_how_to_get_from_one_to_the_other(kind: str) -> None:
    A = operator(kind)
    volume, pictures = np.ones((2, *A.domain_shape)), np.ones((*A.range_shape, 2))
    for columns in (A.forward, A.T.adjoint, A.__matmul__):
        for array in (volume, volume[0]):
            with pytest.raises(InputError, match=r"A\(volume\).*columns_from_volume\(volume\)\.reshape\(A\.shape\[1\]"):
                columns(array)
    for columns in (A.adjoint, A.T.forward, A.T.__matmul__):
        for array in (pictures, pictures[..., 0]):
            with pytest.raises(
                InputError, match=r"A\.T\(pictures\).*columns_from_pictures\(pictures\)\.reshape\(A\.sh"
            ):
                columns(array)
    with pytest.raises(InputError, match=r"\(3, 5, 7\) or \(channels, 3, 5, 7\).*A @ x.*volume_from_columns\(x, "):
        A(np.ones((A.shape[1], 2)))
    with pytest.raises(InputError, match=r"A\.T @ b.*pictures_from_columns\(b, "):
        A.T(np.ones((A.shape[0], 2)))
    for wrong in (volume[..., :-1], volume[:0], pictures, volume.transpose(1, 2, 3, 0), volume[None]):
        with pytest.raises(InputError, match="a volume for this matrix has shape"):
            A(wrong)
    for wrong in (pictures[:, :-1], pictures[..., :0], volume, pictures.transpose(3, 0, 1, 2), pictures[None]):
        with pytest.raises(InputError, match="pictures for this matrix have shape"):
            A.T(wrong)
    for call in (A, A.T, A.forward, A.adjoint, A.__matmul__, A.T.__matmul__):
        with pytest.raises(InputError, match="float32 or float64, not complex128"):
            call(_fitting(A, call).astype(complex))
    with pytest.raises(TypeError, match="unsupported operand"):
        A @ [1.0, 2.0]  # type: ignore[operator]


def _fitting(A: Projector, call: Any) -> Any:
    """Something of the right shape for a way to call it."""
    if call in (A, A.T):
        return np.ones(call.domain_shape)
    return np.ones((A.shape[1] if call in (A.forward, A.__matmul__) else A.shape[0], 2))


def test_neither_name_is_long() -> None:
    A = operator("level")
    assert repr(A) == "<projector of 3 x 5 x 7 voxels, <4 views of 3 x 9 pixels>>"
    assert repr(A.T) == "<transpose of <projector of 3 x 5 x 7 voxels, <4 views of 3 x 9 pixels>>>"


@pytest.mark.parametrize("kind", KINDS)
def test_a_pickled_copy_gives_the_same_products(kind: str) -> None:
    A = operator(kind)
    for matrix in (A, A.T):
        copy = pickle.loads(pickle.dumps(matrix))  # noqa: S301 - our own
        assert type(copy) is type(matrix)
        assert copy.T.T is copy
        x = some((matrix.shape[1], 2))
        assert np.array_equal(copy @ x, matrix @ x)
        assert np.array_equal(copy.T @ (copy @ x), matrix.T @ (matrix @ x))


@pytest.mark.parametrize(("dtype", "bound"), [(np.float32, 1e-5), (np.float64, 1e-12)])
@pytest.mark.parametrize("kind", KINDS)
def test_scipys_operator_is_the_same_matrix_and_so_is_its_pickled_copy(
    kind: str, dtype: type[np.floating], bound: float
) -> None:
    A = operator(kind)
    ours = A.as_linear_operator(dtype)
    dense = A.to_sparse().toarray()
    for linear in (ours, pickle.loads(pickle.dumps(ours))):  # noqa: S301 - our own
        assert linear.dtype == dtype
        for matrix, wanted in ((linear, dense), (linear.T, dense.T), (linear.H, dense.T), (linear.T.T, dense)):
            for shape in ((), (1,), (4,), (0,)):
                x = some((wanted.shape[1], *shape)).astype(dtype)
                product = matrix @ x
                assert product.dtype == dtype
                assert product.shape == (wanted.shape[0], *shape)
                assert np.allclose(product, wanted @ x, rtol=bound, atol=bound * 9)
    assert np.allclose(ours @ np.ones(A.shape[1], int), dense.sum(axis=1), rtol=bound)


@pytest.mark.parametrize("dtype", [np.float16, np.longdouble, np.complex128, int, bool, object, ">f8"])
def test_scipys_operator_refuses_numbers_that_no_product_has(dtype: Any) -> None:
    with pytest.raises(InputError, match="float32 or float64"):
        operator("level").as_linear_operator(dtype)


@pytest.mark.parametrize("kind", ["level", "point"])
def test_scipys_operator_refuses_complex_numbers(kind: str) -> None:
    A = operator(kind)
    linear = A.as_linear_operator()
    for matrix, length in ((linear, A.shape[1]), (linear.T, A.shape[0]), (linear.H, A.shape[0])):
        for shape in ((), (1,), (3,), (0,)):
            with pytest.raises(InputError, match="complex"):
                matrix @ np.ones((length, *shape), complex)


def test_scipy_solves_with_it() -> None:
    from scipy.sparse.linalg import lsqr

    A = operator("raised")
    b = A @ some((A.shape[1],))
    found = lsqr(A.as_linear_operator(), b, atol=1e-12, btol=1e-12)[0]
    assert np.allclose(A @ found, b, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("shape", [(3, 5, 7), (4, 6, 5), (1, 4, 3)])
@pytest.mark.parametrize("kind", KINDS)
def test_the_sparse_matrix_is_its_rows(kind: str, shape: tuple[int, int, int]) -> None:
    """Row by row, each unknown once and in order: lengths of beams along faces come in parts."""
    A = operator(kind, shape)
    sparse = A.to_sparse()
    assert sparse.dtype == np.float64
    assert sparse.has_canonical_format
    for index in range(A.shape[0]):
        unknowns, lengths = A.row(index)
        expected = np.zeros(A.shape[1])
        np.add.at(expected, unknowns, lengths)
        own = slice(sparse.indptr[index], sparse.indptr[index + 1])
        assert np.array_equal(sparse.indices[own], np.flatnonzero(expected))
        assert np.allclose(sparse.data[own], expected[expected > 0], rtol=1e-12, atol=0)
