"""The laws that the matrix keeps, on unequal shapes, against a plain second implementation and an oracle."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lightcube.errors import InputError
from lightcube.kernels.layout import columns_from_volume, pictures_from_columns
from lightcube.optics.grid import Grid
from lightcube.optics.views import Views, turntable_views
from lightcube.projection.projector import Projector, dot_test
from tests.helpers import plain


def project(projector: Projector, volume: np.ndarray) -> np.ndarray:
    """Pictures of absorbance of a volume ``(channel, z, y, x)``."""
    x = columns_from_volume(volume).reshape(projector.shape[1], -1)
    return pictures_from_columns(projector.forward(x), projector.views.picture_shape, len(volume))


@pytest.mark.parametrize("turns", [3, 40])
def test_long_rows_agree_with_the_sparse_matrix(turns: int) -> None:
    """Rows of 131 numbers are copied to begin at cache lines, those of the voxels where there are many beams."""
    grid = Grid((1, 5, 7), voxel_mm=0.7)
    matrix = Projector(grid, turntable_views(grid, np.linspace(0, 300, turns)))
    x = np.random.default_rng(3).random((matrix.shape[1], 131)).astype(np.float32)
    b = np.random.default_rng(4).random((matrix.shape[0], 131)).astype(np.float32)
    assert np.allclose(matrix.forward(x), matrix.to_sparse() @ x, rtol=1e-5, atol=1e-5)
    assert np.allclose(matrix.adjoint(b), matrix.to_sparse().T @ b, rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
@pytest.mark.parametrize(("rows", "columns"), [(1, 4), (2, 3), (3, 6), (4, 5), (3, 1)])
def test_windows_of_any_size_agree_with_plain_boxes(rows: int, columns: int, elevation_deg: float) -> None:
    """Wrong parities put every beam of 0 and 90 degrees on faces and edges: the tie rule in all its forms."""
    grid = Grid((4, 6, 5))
    if elevation_deg == 0 and rows > 4:
        rows = 4
    views = turntable_views(grid, [0.0, 90.0, 30.0], elevation_deg=elevation_deg, picture_shape=(rows, columns))
    volume = np.random.default_rng(2).random((3, 4, 6, 5))
    assert np.allclose(
        project(Projector(grid, views), volume), plain.absorbance_pictures(grid, views, volume), rtol=1e-9, atol=1e-9
    )


def test_dot_test_finds_a_wrong_transpose() -> None:
    class Wrong:
        shape = (4, 4)

        def forward(self, x: np.ndarray) -> np.ndarray:
            return x

        def adjoint(self, b: np.ndarray) -> np.ndarray:
            return b[::-1]

    assert dot_test(Wrong()) > 1e-3


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_chords_of_a_sphere_are_analytic(elevation_deg: float) -> None:
    """A voxelised ball's chords come near ``2 sqrt(R^2 - d^2)``, to a voxel per surface crossed."""
    n = 21
    grid = Grid((n, n, n), 1.0)
    z, y, x = np.meshgrid(*[np.arange(n) - (n - 1) / 2] * 3, indexing="ij")
    radius = 0.4 * n
    ball = (x**2 + y**2 + z**2 < radius**2).astype(np.float64)[None]
    views = turntable_views(grid, [20.0, 65.0], elevation_deg=elevation_deg)
    pictures = project(Projector(grid, views), ball)[..., 0]
    expected = np.zeros_like(pictures)
    for index in np.ndindex(*pictures.shape):
        point, direction, _, _ = plain.beam_of_pixel(views, *index)
        distance = float(np.linalg.norm(point - np.dot(point, direction) * direction))
        expected[index] = 2 * math.sqrt(max(radius**2 - distance**2, 0))
    # near the rim a beam grazes many voxels: compare where it crosses the surface steeply
    steep = expected > radius
    assert np.max(np.abs(pictures - expected)[steep]) < 2.5
    assert abs(np.mean((pictures - expected)[steep])) < 0.3


def test_half_a_turn_is_the_mirror_only_at_elevation_0() -> None:
    grid = Grid((3, 5, 7))
    volume = np.random.default_rng(4).random((2, 3, 5, 7))
    for elevation_deg, mirrored in ((0.0, True), (20.0, False), (-35.0, False)):
        views = turntable_views(grid, [33.0, 213.0], elevation_deg=elevation_deg)
        front, back = project(Projector(grid, views), volume)
        assert np.allclose(front, back[:, ::-1], atol=1e-9) == mirrored


def test_raising_the_lamp_looks_along_the_same_columns_shifted() -> None:
    """A single slab seen from above moves on the screen by tan(elevation) times its distance from the axis."""
    grid = Grid((1, 1, 9))
    volume = np.zeros((1, 1, 1, 9))
    volume[..., 8] = 1
    views = turntable_views(grid, [0.0], elevation_deg=45.0)
    picture = project(Projector(grid, views), volume)[0, :, :, 0]
    row = int(np.argmax(picture.max(axis=1)))
    # light goes along +x and down: what stands 4 voxels downstream is met by beams that cross the axis 4 higher
    assert row - (views.picture_shape[0] - 1) / 2 == -4


@settings(max_examples=30)
@given(
    shape=st.tuples(*[st.integers(1, 4)] * 3),
    angle_deg=st.floats(-720, 720).filter(lambda a: abs((a + 45) % 90 - 45) > 1e-4 or a % 90 == 0),
    elevation_deg=st.floats(-80, 80).filter(lambda e: abs(e) > 1e-4 or e == 0),
    side=st.floats(0.01, 10),
)
def test_any_view_agrees_with_plain_boxes(
    shape: tuple[int, int, int], angle_deg: float, elevation_deg: float, side: float
) -> None:
    grid = Grid(shape, side)
    full = turntable_views(grid, [angle_deg], elevation_deg=elevation_deg)
    views = turntable_views(
        grid, [angle_deg], elevation_deg=elevation_deg, picture_shape=(min(3, full.picture_shape[0]), 2)
    )
    volume = np.random.default_rng(5).random((1, *shape))
    fast = project(Projector(grid, views), volume)
    assert np.allclose(fast, plain.absorbance_pictures(grid, views, volume), rtol=1e-6, atol=1e-6 * side)


@pytest.mark.parametrize("elevation_deg", [0.0, 0.3, -0.3])
@pytest.mark.parametrize("up", [0.0, 0.5, 1.0, -0.3])
def test_screens_moved_up_and_lamps_just_above_the_horizon_agree_with_plain_boxes(
    up: float, elevation_deg: float
) -> None:
    grid = Grid((3, 4, 5))
    views = turntable_views(grid, [20.0, 110.0], elevation_deg=elevation_deg, picture_shape=(3, 4))
    moved = Views(
        views.lamps, views.origins_mm + np.array([0, 0, up]), views.column_steps_mm, views.row_steps_mm, (3, 4)
    )
    volume = np.random.default_rng(11).random((2, 3, 4, 5))
    fast = project(Projector(grid, moved), volume)
    assert np.allclose(fast, plain.absorbance_pictures(grid, moved, volume), rtol=1e-9, atol=1e-9)


def test_many_columns_are_many_times_one_column() -> None:
    """More columns than one task takes: blocks must not leave a seam."""
    grid = Grid((1, 3, 4))
    projector = Projector(grid, turntable_views(grid, [10.0, 100.0]))
    x = np.random.default_rng(8).random((projector.shape[1], 301))
    dense = projector.to_sparse().toarray()
    assert np.allclose(projector.forward(x), dense @ x)
    assert np.allclose(projector.adjoint(dense @ x), dense.T @ (dense @ x))


def test_agrees_with_astra() -> None:
    astra = pytest.importorskip("astra", reason="ASTRA is an optional oracle: lightcube[oracle]")
    n, count = 9, 7
    grid = Grid((1, n, n))
    angles_deg = (np.arange(count) + 0.5) * 180 / count
    views = turntable_views(grid, angles_deg)
    width = views.picture_shape[1]
    geometry = astra.create_proj_geom("parallel", 1.0, width, np.radians(90 - angles_deg))
    projector = astra.create_projector("line", geometry, astra.create_vol_geom(n, n))
    image = np.random.default_rng(9).random((n, n)).astype(np.float32)
    identifier, sinogram = astra.create_sino(image[::-1], projector)
    ours = project(Projector(grid, views), image[None, None].astype(np.float64))[:, 0, :, 0]
    astra.data2d.delete(identifier)
    astra.projector.delete(projector)
    assert np.allclose(ours, sinogram[:, ::-1], rtol=1e-4, atol=1e-4)


def test_refuses_what_it_cannot_project() -> None:
    grid = Grid((3, 5, 7))
    projector = Projector(grid, turntable_views(grid, [0.0]))
    with pytest.raises(InputError, match="shape"):
        projector.forward(np.zeros((3, 3)))
    with pytest.raises(InputError, match="float32 or float64"):
        projector.forward(np.zeros((35, 3), int))
    with pytest.raises(InputError, match="row 99"):
        projector.row(99)
