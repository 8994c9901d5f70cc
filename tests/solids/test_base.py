"""A base: what tipped over stands, no picture shows it, and where none helps that is said."""

import numpy as np
import pytest
from scipy import ndimage

from lightcube.errors import InputError
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.solids import projections
from lightcube.solids.base import with_base
from lightcube.solids.carving import carve
from lightcube.solids.certificate import cast_mesh, certify
from lightcube.solids.printing import stands
from lightcube.solids.shape import Shape, hull
from lightcube.solids.silhouettes import FINE, Silhouettes
from lightcube.solids.walls import walls
from tests.helpers.solid import of_pixels, seen


def leaning(room: int = 3) -> Shape:
    """A wide top on a thin leg at its corner, in 16 x 18 x 20 voxels with room around, 1.5 mm each."""
    body = np.zeros((16, 18, 20), bool)
    body[10 : 16 - room, room : 18 - room, room : 20 - room] = True
    body[room:10, room : room + 3, room : room + 4] = True
    grid = Grid(body.shape, 1.5)
    return hull(of_pixels(walls(grid).rig(), *seen(body)), grid)


@pytest.mark.parametrize("room", [0, 3])
@pytest.mark.parametrize("thick_mm", [1.5, 6.0])
def test_what_tips_over_stands_on_a_base_that_no_picture_shows(room: int, thick_mm: float) -> None:
    whole = leaning(room)
    assert not stands(whole.mesh)
    made = with_base(whole, thick_mm)
    assert stands(made.mesh)
    assert made.mesh.is_watertight
    assert ndimage.label(made.inside)[1] == ndimage.label(whole.inside)[1] == 1
    assert made.mesh.size_mm[2] - whole.mesh.size_mm[2] == pytest.approx(thick_mm, abs=0.3)
    before, after = cast_mesh(whole.mesh, whole.rig), cast_mesh(made.mesh, made.rig)
    assert np.array_equal(before[2], after[2])  # from above
    ends = FINE * (16 - room)
    for one, other in zip(before[:2], after[:2], strict=True):
        assert np.count_nonzero(one[:ends] != other[:ends]) <= 8  # where the leg meets it, half a pixel
        assert np.any(other[ends:]) or not room
    assert made.rig.stops.window[:, 0].tolist() == [16 - room, 16 - room, 18]
    found = certify(made.mesh, made.silhouettes)
    assert found.overlap.min() > 0.97
    assert found.missing.max() <= certify(whole.mesh, whole.silhouettes).missing.max() + 1e-9


def test_a_base_outlives_carving_and_its_undoing() -> None:
    made = with_base(leaning(), 3.0)
    lowest = int(np.flatnonzero(made.inside.any(axis=(1, 2)))[0])
    shell = carve(made, "shell", wall_mm=1.5, drain_mm=0)
    assert np.any(made.inside & ~shell.inside)
    assert np.array_equal(shell.inside[: lowest + 2], made.inside[: lowest + 2])
    assert np.array_equal(carve(shell, "none", anew=True).inside, made.inside)


@pytest.mark.parametrize("elevation_deg", [0, 30])
def test_on_a_turntable_a_base_is_where_none_of_its_lamps_shows_it(elevation_deg: float) -> None:
    """A leaning bar and four lamps: their pictures end below it, and nothing is added above."""
    grid = Grid((20, 21, 22), 1.0)
    rig = turntable(grid, np.array([10.0, 100.0, 190.0, 280.0]), elevation_deg=elevation_deg)
    body = np.zeros(grid.shape, bool)
    for z in range(3, 17):
        body[z, 8:13, z - 1 : z + 3] = True
    pictures = []
    for matrix in projections.of_voxels(projections.matrices(rig), grid):
        across, down, w = matrix @ np.vstack([np.argwhere(body).T, np.ones(int(body.sum()))])
        picture = np.zeros(rig.picture_shape, bool)
        picture[np.rint(down / w).astype(int), np.rint(across / w).astype(int)] = True
        pictures.append(ndimage.binary_closing(picture, np.ones((3, 3), bool)))
    whole = hull(of_pixels(rig, *pictures), grid)
    assert not stands(whole.mesh)
    made = with_base(whole, 3.0)
    assert stands(made.mesh)
    on = made.rig.inside.repeat(FINE, axis=1).repeat(FINE, axis=2)
    added = cast_mesh(made.mesh, made.rig) & on & ~cast_mesh(whole.mesh, whole.rig)
    assert added.sum(axis=(1, 2)).max() <= 16  # where the bar meets it, half a pixel on either side
    shown = cast_mesh(made.mesh, made.rig) & ~on
    assert np.all(np.any(shown, axis=(1, 2)))


def test_a_body_that_hangs_on_nothing_hidden_is_told() -> None:
    """From above two discs that do not meet, and the body is under one of them: the base stays there."""
    whole = leaning()
    top = whole.silhouettes.inside.copy()
    top[2, : FINE * 10] = False
    shape = Shape(whole.field, whole.grid, Silhouettes(top, whole.rig, whole.names))
    with pytest.raises(InputError, match="it does not stand on what is hidden from all its lamps"):
        with_base(shape, 3.0)


def test_where_no_picture_is_upright_a_base_is_refused() -> None:
    grid = Grid((10, 10, 10))
    lamps = (Lamp("a", direction=(0.0, 0.0, -1.0)), Lamp("b", direction=(0.1, 0.0, -1.0)))
    screens = tuple(
        Screen(lamp.name, (0, 0, -9.0 - n), (20, 20), 1, normal=(0, 0, 1), up=(0, 1, 0)) for n, lamp in enumerate(lamps)
    )
    rig = Stage(grid, lamps, screens, tuple(Shot(each, each, (each,)) for each in "ab"), cube_turns=False).rig()
    disc = np.hypot(*np.mgrid[-9.5:10, -9.5:10]) < 4
    with pytest.raises(InputError, match="no picture is upright, and a base would show in all of them"):
        with_base(hull(of_pixels(rig, disc, disc), grid), 2.0)


@pytest.mark.parametrize("thick_mm", [0.0, -1.0, 25.0])
def test_a_base_is_as_thick_as_one_can_be(thick_mm: float) -> None:
    with pytest.raises(InputError, match="a base is thicker than 0 mm and at most 24, as the block"):
        with_base(leaning(), thick_mm)
