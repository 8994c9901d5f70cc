"""Carving: no shadow changes, nothing falls apart, what is taken out was inside; shells have drains."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import ndimage
from scipy.spatial import ConvexHull

from lightcube.errors import InputError
from lightcube.kernels import carving as kernels
from lightcube.optics.arrays import locked
from lightcube.optics.grid import Grid
from lightcube.solids import carving, projections
from lightcube.solids.carving import carve
from lightcube.solids.certificate import certify
from lightcube.solids.filling import held_by
from lightcube.solids.mesh import Mesh
from lightcube.solids.shape import Shape, hull
from lightcube.solids.silhouettes import FINE, Silhouettes
from lightcube.solids.walls import walls
from tests.helpers.solid import around, blobs, compiled_only, seen
from tests.solids.test_warp import letters

FACES = ndimage.generate_binary_structure(3, 1)


def block() -> Shape:
    """A solid block of 10 x 14 x 18 voxels, two from its faces, in 14 x 18 x 22."""
    grid = Grid((14, 18, 22), 1.5)
    rig = walls(grid).rig()
    rows, columns = rig.picture_shape
    inside = np.zeros((3, FINE * rows, FINE * columns), bool)
    for picture, (high, wide) in zip(inside, rig.stops.window, strict=True):
        picture[8 : FINE * int(high) - 8, 8 : FINE * int(wide) - 8] = True
    return hull(Silhouettes(inside, rig, tuple("FST")), grid)


def pieces(inside: NDArray[np.bool_]) -> int:
    return int(ndimage.label(inside, FACES)[1])


@compiled_only
@pytest.mark.parametrize("deep", [1, 3])
def test_a_lace_casts_all_and_hangs_together(deep: int) -> None:
    silhouettes, grid = letters("OHO", 24)
    whole = hull(silhouettes, grid)
    made = carve(whole, "lace", deep=deep)
    assert not np.any(made.inside & ~whole.inside)
    assert made.inside.sum() < (0.5 if deep == 1 else 0.75) * whole.inside.sum()
    for one, other in zip(seen(made.inside), seen(whole.inside), strict=True):
        assert np.array_equal(one, other)
    assert pieces(made.inside) == pieces(whole.inside) == 1
    assert made.mesh.is_watertight
    assert certify(made.mesh, silhouettes).beyond.max() <= certify(whole.mesh, silhouettes).beyond.max() + 1e-9
    for axis in range(3):  # each ray keeps as many as asked for, or all that it had
        kept, had = made.inside.sum(axis=axis), whole.inside.sum(axis=axis)
        assert np.all(kept >= np.minimum(had, deep))


@compiled_only
def test_a_lace_of_any_views_casts_all() -> None:
    grid = Grid((15, 17, 13), 1.0)
    silhouettes = blobs(around(grid, 4), 3, full=0.7)
    whole = hull(silhouettes, grid)
    made = carve(whole, "lace", deep=1)
    assert made.inside.sum() < 0.6 * whole.inside.sum()
    onto = projections.of_voxels(projections.matrices(silhouettes.rig), grid)
    for matrix in onto:
        shadows = []
        for body in (whole.inside, made.inside):
            across, down, w = matrix @ np.vstack([np.argwhere(body).T, np.ones(int(body.sum()))])
            shadows.append({*zip(np.floor(down / w + 0.5), np.floor(across / w + 0.5), strict=True)})
        assert shadows[0] == shadows[1]
    assert pieces(made.inside) == pieces(whole.inside)


@compiled_only
def test_the_same_seed_makes_the_same_lace() -> None:
    silhouettes, grid = letters("HHH", 16)
    whole = hull(silhouettes, grid)
    one, again, other = (carve(whole, "lace", deep=1, seed=seed).inside for seed in (0, 0, 1))
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)


def test_what_hangs_together_is_told_by_all_ways_through_it() -> None:
    """Beside taking the voxel out of its 18 neighbours and labelling them anew."""
    random, near, stack = np.random.default_rng(4), np.zeros((5, 5, 5), np.uint8), np.empty((32, 3), np.int64)
    told = []
    for part in np.linspace(0.2, 0.9, 300):
        around_it = np.pad(random.uniform(size=(3, 3, 3)) < part, 1)
        around_it[2, 2, 2] = True
        corners = around_it.copy()
        for corner in np.ndindex(2, 2, 2):
            corners[tuple(1 + 2 * each for each in corner)] = False
        corners[2, 2, 2] = False
        labels = ndimage.label(corners, FACES)[0]
        sides = [labels[place] for place in ((1, 2, 2), (3, 2, 2), (2, 1, 2), (2, 3, 2), (2, 2, 1), (2, 2, 3))]
        wanted = len({each for each in sides if each}) == 1
        assert kernels.hangs_together(around_it, 2, 2, 2, near, stack) == wanted
        told.append(wanted)
    assert 0.2 < np.mean(told) < 0.9


def test_a_shell_is_as_thick_as_asked_for() -> None:
    whole = block()
    made = carve(whole, "shell", wall_mm=3.0, drain_mm=0)
    eaten = ndimage.binary_erosion(whole.inside, np.ones((3, 3, 3), bool), iterations=2)
    assert np.array_equal(made.inside, whole.inside & ~eaten)
    assert made.mesh.is_watertight
    assert np.allclose(certify(made.mesh, whole.silhouettes).overlap, certify(whole.mesh, whole.silhouettes).overlap)
    hole = whole.mesh.volume_mm3 - made.mesh.volume_mm3
    x, y, z = (side - 6.0 for side in whole.mesh.size_mm)
    assert hole == pytest.approx(x * y * z, rel=0.03)


def test_a_shell_has_drains_that_no_shadow_shows() -> None:
    whole = block()
    closed, drained = (carve(whole, "shell", wall_mm=3.0, drain_mm=drain) for drain in (0.0, 4.0))
    assert pieces(~closed.inside) == 2
    assert pieces(~drained.inside) == 1
    for one, other in zip(seen(drained.inside), seen(whole.inside), strict=True):
        assert np.array_equal(one, other)
    taken = closed.inside & ~drained.inside
    heights = np.flatnonzero(taken.any(axis=(1, 2)))
    assert heights.min() == np.flatnonzero(whole.inside.any(axis=(1, 2))).min()  # through the floor
    assert heights.max() == np.flatnonzero(whole.inside.any(axis=(1, 2))).max()  # and the ceiling
    area = taken[heights.min()].sum() * 1.5**2
    assert area == pytest.approx(np.pi * 4.0**2 / 4, rel=0.4)
    assert drained.mesh.is_watertight


def test_a_drain_that_would_show_is_not_made() -> None:
    """A shell whose floor a lamp above sees as the only thing in its way has none there."""
    whole = block()
    field = carve(whole, "shell", wall_mm=3.0, drain_mm=0).field.copy()
    top = int(np.flatnonzero((field < 0).any(axis=(1, 2))).max())
    field[top - 1 :] = np.abs(field[top - 1 :])  # its ceiling is off: the cavity is open, and gets nothing
    open_above, free = replace(whole, field=locked(field)), np.ones(field.shape, np.bool_)
    assert np.array_equal(carving._drained(open_above.field, open_above, 1.5, free), field)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"how": "shell", "wall_mm": 0.0}, "a wall is thicker than 0 mm"),
        ({"how": "shell", "drain_mm": -1.0}, "a drain 0 mm or more"),
        ({"how": "lace", "deep": 0}, "at least one voxel"),
    ],
)
def test_what_cannot_be_carved_is_said(given: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        carve(block(), **given)  # type: ignore[arg-type]


def same_shadows(one: Shape, other: Shape) -> bool:
    return all(map(np.array_equal, seen(one.inside), seen(other.inside)))


@compiled_only
@pytest.mark.parametrize("how", ["shell", "lace"])
def test_only_what_is_under_the_brush_is_taken(how: carving.Carving) -> None:
    whole = block()
    brush = np.zeros(whole.grid.shape, np.bool_)
    brush[:, :, :11] = True
    made = carve(whole, how, deep=1, wall_mm=3.0, where=brush)
    taken = whole.inside & ~made.inside
    assert np.any(taken)
    assert not np.any(taken & ~brush)
    assert same_shadows(made, whole)
    assert pieces(made.inside) == 1
    assert made.mesh.is_watertight
    assert not np.any(taken & ~carve(whole, how, deep=1, wall_mm=3.0).inside & made.inside)


def test_a_brush_around_a_core_is_refused() -> None:
    whole = block()
    brush = whole.inside.copy()
    brush[6:8, 8:10, 9:13] = False
    with pytest.raises(InputError, match="the brush would leave something loose in a cavity"):
        carve(whole, "shell", wall_mm=1.5, drain_mm=0, where=brush)


@compiled_only
def test_a_ray_gives_what_it_does_not_need_and_no_other_does() -> None:
    whole = block()
    rays = [(0, 6, 8), (2, 9, 11)]
    made = carve(whole, "none", deep=2, rays=rays)
    taken = whole.inside & ~made.inside
    front, top = np.zeros((2, *whole.grid.shape), np.bool_)
    front[whole.grid.shape[0] - 1 - 6, :, 8] = True  # rows from above
    top[:, whole.grid.shape[1] - 1 - 9, 11] = True
    assert not np.any(taken & ~(front | top))
    assert (made.inside & front).sum() == 2
    assert same_shadows(made, whole)
    assert pieces(made.inside) == 1


@compiled_only
def test_what_was_taken_can_be_given_back() -> None:
    whole = block()
    lace = carve(whole, "lace", deep=1)
    again = carve(lace, "none", anew=True)
    assert np.array_equal(again.inside, whole.inside)
    assert np.array_equal(carve(lace, "lace", deep=3, anew=True).inside, carve(whole, "lace", deep=3).inside)


@compiled_only
def test_what_stands_outside_of_the_hull_stays() -> None:
    """A base that no silhouette knows of: no lace takes of it, and giving back keeps it."""
    whole = block()
    field = whole.field.copy()
    field[:3, 4:14, 4:18] = np.where(field[:3, 4:14, 4:18] < 0, field[:3, 4:14, 4:18], np.float32(-0.5))
    standing = replace(whole, field=locked(field))
    base = standing.inside & ~whole.inside
    assert np.any(base)
    lace = carve(standing, "lace", deep=1)
    assert np.all(lace.inside[base])
    assert np.array_equal(carve(lace, "none", anew=True).inside, standing.inside)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"how": "none"}, "nothing is to be taken out"),
        ({"how": "lace", "where": np.ones((2, 3, 4), bool)}, "a brush has shape"),
        ({"how": "none", "rays": [(3, 0, 0)]}, "there is no picture 3 among 3"),
        ({"how": "none", "rays": [(-1, 0, 0)]}, "there is no picture -1 among 3"),
        ({"how": "none", "rays": [(1, 14, 0)]}, "picture S has 14 x 18 pixels, counted from 0, and none in row 14"),
    ],
)
def test_what_a_brush_or_a_ray_cannot_be_is_said(given: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        carve(block(), **given)  # type: ignore[arg-type]


def ball(radius: float, middle: tuple[float, float, float]) -> Mesh:
    """A sphere of triangles."""
    icosahedron = np.array([(0, 1, 1.618), (0, -1, 1.618), (0, 1, -1.618), (0, -1, -1.618)])
    corners = np.concatenate([np.roll(icosahedron, shift, axis=1) for shift in range(3)])
    convex = ConvexHull(corners)
    faces = convex.simplices.copy()
    a, b, c = corners[faces.T]
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), convex.equations[:, :3]) < 0
    faces[inward] = faces[inward][:, ::-1]
    return Mesh(locked(radius * corners / np.linalg.norm(corners[0]) + middle), locked(faces.astype(np.int64)))


def test_voxels_in_a_mesh_are_those_whose_middles_it_holds() -> None:
    grid, mesh = Grid((15, 17, 21), 2.0), ball(11.0, (3.0, -2.0, 1.5))
    places = [(np.arange(count) - (count - 1) / 2) * 2.0 for count in grid.shape]
    points = np.stack(np.meshgrid(*places, indexing="ij"), axis=-1)[..., ::-1]
    sides = ConvexHull(mesh.vertices_mm).equations
    wanted = np.all(points @ sides[:, :3].T + sides[:, 3] < 0, axis=-1)
    assert np.array_equal(held_by(mesh, grid), wanted)
    assert held_by(mesh, grid).sum() * 8 == pytest.approx(mesh.volume_mm3, rel=0.05)
    turned = Mesh(mesh.vertices_mm, locked(mesh.faces[:, ::-1].copy()))
    assert np.array_equal(held_by(turned, grid), wanted)
    with pytest.raises(InputError, match="a mesh with 3 open or doubled edges holds nothing"):
        held_by(Mesh(mesh.vertices_mm, locked(mesh.faces[1:].copy())), grid)
