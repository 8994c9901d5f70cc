"""Whether bodies can be printed and stand: walls of known thickness, weight over a foot or beside it."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import ndimage

from lightcube.optics.arrays import locked
from lightcube.optics.grid import Grid
from lightcube.solids.mesh import Mesh
from lightcube.solids.printing import stands, thickest_wall_mm, thin_places
from lightcube.solids.shape import Shape, hull
from lightcube.solids.walls import walls
from tests.helpers.solid import of_pixels, seen
from tests.solids.test_carving import block


def box(*sides: float) -> Mesh:
    """A box that stands in the corner of the axes."""
    corners = np.array([[i, j, k] for k in (0.0, 1.0) for j in (0.0, 1.0) for i in (0.0, 1.0)]) * sides
    faces = [[0, 3, 1], [0, 2, 3], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 7, 3], [2, 6, 7]]
    return Mesh(locked(corners), locked(np.array([*faces, [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]])))


def rounded(core: NDArray[np.bool_], radius: float) -> Shape:
    """All that is so near to a core, in mm: a ball of that radius reaches all of it. Only where it is its own hull."""
    grid = Grid(core.shape, 1.0)
    body = np.asarray(ndimage.distance_transform_edt(~core) <= radius)
    shape = hull(of_pixels(walls(grid).rig(), *seen(body)), grid)
    assert np.mean(shape.inside != body) < 0.02
    return shape


@pytest.mark.parametrize("radius", [2.0, 3.0, 5.0])
def test_a_wall_is_as_thick_as_it_is(radius: float) -> None:
    """A rod around a line of single voxels: thicker than that no ball fits in, thinner ones reach all."""
    core = np.zeros((16, 15, 40), bool)
    core[8, 7, 8:32] = True
    assert thickest_wall_mm(rounded(core, radius), lost=0.05) == pytest.approx(2 * radius, abs=1.26)


def test_a_thin_bridge_counts_as_what_it_joins_is_needed() -> None:
    """Two balls that a rod joins: thicker than the rod there are two pieces, and one casts half."""
    balls, rod = np.zeros((2, 19, 19, 44), bool)
    balls[9, 9, [9, 34]] = True
    rod[9, 9, 9:35] = True
    grid = Grid(rod.shape, 1.0)
    fat, thin = (np.asarray(ndimage.distance_transform_edt(~core) <= r) for core, r in ((balls, 7.0), (rod, 2.0)))
    joined, apart = (hull(of_pixels(walls(grid).rig(), *seen(each)), grid) for each in (fat | thin, fat))
    assert thickest_wall_mm(joined, lost=0.05) == pytest.approx(4, abs=1.26)
    assert thickest_wall_mm(apart, lost=0.05) == 0  # one of two alone never casts all


def dumbbell() -> Shape:
    """Two balls of 7 mm that a rod of 2 mm joins, around the middle of 19 x 19 x 44 voxels of 1 mm."""
    balls, rod = np.zeros((2, 19, 19, 44), bool)
    balls[9, 9, [9, 34]] = True
    rod[9, 9, 9:35] = True
    fat, slim = (np.asarray(ndimage.distance_transform_edt(~core) <= r) for core, r in ((balls, 7.0), (rod, 2.0)))
    grid = Grid(rod.shape, 1.0)
    return hull(of_pixels(walls(grid).rig(), *seen(fat | slim)), grid)


def test_a_thin_place_is_found_with_its_volume() -> None:
    shape = dumbbell()
    for wall_mm in (1.0, 3.0):
        assert thin_places(shape, wall_mm).share < 0.005
    found = thin_places(shape, 8.0)
    (place, volume), *others = found.places_mm
    assert np.linalg.norm(place) < 1.5  # half a voxel beside the middle, in the rod
    rod = shape.inside[:, :, 18:26].sum()  # between the balls
    assert 0.7 * rod < volume < 1.7 * rod
    assert all(other < volume / 4 for _, other in others)
    assert found.share == pytest.approx(volume / shape.inside.sum(), abs=0.02)
    assert thin_places(shape, 50.0).share == 1


def test_every_point_is_in_a_ball_or_counted() -> None:
    """What is left out of the share lies in the union of all balls inside, tried one by one, a voxel around."""
    shape, wall_mm = dumbbell(), 6.0
    points = np.argwhere(shape.inside)
    outside = np.argwhere(~shape.inside)
    reached = np.zeros(shape.inside.shape, bool)
    for middle in points:
        if np.linalg.norm(outside - middle, axis=1).min() >= wall_mm / 2 + 0.5:
            reached[tuple(points[np.linalg.norm(points - middle, axis=1) <= wall_mm / 2 + 1.5].T)] = True
    share = np.count_nonzero(shape.inside & ~reached) / len(points)
    assert thin_places(shape, wall_mm).share == pytest.approx(share, abs=0.03)


def test_what_stands_has_its_weight_over_its_foot() -> None:
    assert stands(block().mesh)
    assert stands(box(4.0, 5.0, 6.0))
    leaning = box(4.0, 5.0, 6.0)
    for lean, wanted in (
        (0.4, True),
        (0.6, True),
        (0.7, False),
        (2.0, False),
    ):  # its middle moves by three
        corners = leaning.vertices_mm.copy()
        corners[:, 0] += lean * corners[:, 2]
        assert stands(Mesh(locked(corners), leaning.faces)) is wanted
    corners = np.array([[0, 0, 0], [1, 0, 5], [-1, 0.5, 5], [0, -1, 5.0]])
    needle = Mesh(locked(corners), locked(np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])))
    assert not stands(needle)
