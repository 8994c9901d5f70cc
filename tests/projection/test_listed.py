"""Rays whose pieces are kept: the bits of those that are traced anew, and nothing is kept where it would not fit."""

import numpy as np
import pytest

from lightcube.kernels.rays import BRICK
from lightcube.optics.glass import Glass
from lightcube.optics.grid import Grid
from lightcube.optics.refraction import bent
from lightcube.optics.setups import turntable
from lightcube.projection import limits
from lightcube.projection.projector import Projector
from lightcube.projection.rays import Rays
from tests.helpers import plain
from tests.optics.test_rig import GRID, ROOM

LONG = Grid((BRICK + 3, 5, 7), 0.7)


def some_rays(kind: str, room: int = limits.ROOM) -> Rays:
    """Of lamps of several kinds, of a sphere, along faces, and where only some pixels are heard."""
    if kind == "sphere":
        rig = turntable(Grid((4, 6, 5), 2.0), [0.0, 33.0], elevation_deg=20.0, glass=Glass(1.5, "sphere"))
        return Rays(Grid((4, 6, 5), 2.0), rig.views, None, bent(rig), room=room)
    if kind == "bricks, along faces":
        rig = turntable(LONG, [0.0, 90.0, 45.0], elevation_deg=50.0, picture_shape=(9, 6))
        return Rays(LONG, rig.views, room=room)
    views = ROOM.rig().views
    heard = np.random.default_rng(5).random((len(views), *views.picture_shape)) < 0.7
    return Rays(GRID, views, heard if kind == "some are heard" else None, room=room)


KINDS = ["room", "some are heard", "sphere", "bricks, along faces"]


@pytest.mark.parametrize("columns", [1, 2, 3, 5])
@pytest.mark.parametrize("kind", KINDS)
def test_products_are_those_of_rays_that_are_traced_anew(kind: str, columns: int) -> None:
    room = limits.PIECE * some_rays(kind).pieces
    kept, anew = some_rays(kind, room), some_rays(kind, room - 1)
    random = np.random.default_rng(1)
    x, b = (random.random((count, columns), np.float32) for count in kept.shape[::-1])
    before = kept.forward(x)
    thrown_back = kept.adjoint(b)
    assert kept._lists
    np.testing.assert_array_equal(kept.forward(x), before)
    np.testing.assert_array_equal(anew.adjoint(b), thrown_back)
    assert anew._lists == ()
    np.testing.assert_array_equal(anew.forward(x), before)


@pytest.mark.parametrize("kind", KINDS)
def test_numbers_of_64_bits_are_exact_whatever_is_kept(kind: str) -> None:
    rays = some_rays(kind)
    random = np.random.default_rng(1)
    x, b = (random.random((count, 3)) for count in rays.shape[::-1])
    rays.adjoint(b.astype(np.float32))
    A = rays.to_sparse()
    np.testing.assert_allclose(rays.forward(x), A @ x, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(rays.adjoint(b), A.T @ b, rtol=1e-12, atol=1e-12)


def test_pieces_are_the_voxels_of_every_ray() -> None:
    """As a plain walk finds them; beams that go together have none."""
    rays = some_rays("room")
    rig = ROOM.rig()
    rows, columns = rig.picture_shape
    walked = sum(
        np.count_nonzero(plain.lengths_of_beam(GRID, *plain.beam_of_pixel(rig.views, view, row, column)) > 1e-9)
        for view in range(len(rig.views))
        for row in range(rows)
        for column in range(columns)
    )
    assert rays.pieces == walked == Projector(GRID, rig).pieces
    assert Projector(GRID, turntable(GRID, [20.0], elevation_deg=30.0)).pieces == 0
