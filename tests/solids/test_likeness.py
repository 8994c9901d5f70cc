"""Pictures along the same lines: what one shows is what the other must, mirrored from the other side."""

import numpy as np
import pytest

from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.solids.likeness import Pair, is_along_one_axis, pairs
from lightcube.solids.silhouettes import Silhouettes
from lightcube.solids.walls import walls
from tests.helpers.solid import blobs, of_pixels


def turned(*angles_deg: float, mirrored: int = -1) -> tuple[Silhouettes, Grid]:
    """The same blob on all pictures of a level turntable, one of them mirrored."""
    grid = Grid((11, 13, 15))
    rig = turntable(grid, np.array(angles_deg), elevation_deg=0)
    inside = np.repeat(blobs(rig, 3).inside[:1], len(angles_deg), axis=0)
    if mirrored >= 0:
        inside[mirrored] = inside[mirrored, :, ::-1]
    return Silhouettes(inside, rig, tuple(map(str, angles_deg))), grid


def test_from_opposite_sides_mirror_images_are_the_same() -> None:
    for mirrored, least, most in ((-1, 0.0, 0.8), (1, 0.93, 1.0), (0, 0.93, 1.0)):
        (pair,) = pairs(*turned(20, 200, mirrored=mirrored))
        assert (pair.first, pair.second, pair.is_opposite) == (0, 1, True)
        assert least <= pair.overlap <= most


def test_from_the_same_side_pictures_must_be_alike() -> None:
    found = pairs(*turned(33, 70, 33))
    assert found == [Pair(0, 2, False, 1.0)]
    (pair,) = pairs(*turned(33, 70, 33, mirrored=2))
    assert pair.overlap < 0.8
    assert pairs(*turned(0, 40, 80)) == []


def test_lamps_at_one_place_are_alike_whatever_their_screens() -> None:
    """The second screen is twice as far away, and twice as large."""
    grid = Grid((12, 12, 12))
    lamp = (-60.0, 5.0, 3.0)
    lamps = tuple(Lamp(name, position_mm=lamp) for name in "ab")
    near, far = ((d, -5 * (d / 60), -3 * (d / 60)) for d in (20.0, 100.0))
    screens = (Screen("a", near, (40.0, 40.0), 1.0), Screen("b", far, (80.0, 80.0), 2.0))
    rig = Stage(grid, lamps, screens, tuple(Shot(name, name, (name,)) for name in "ab")).rig()
    rows, columns = np.indices((40, 40))
    disc = np.hypot(rows - 15, columns - 22) < 9
    (pair,) = pairs(of_pixels(rig, disc, disc), grid)
    assert pair.overlap == pytest.approx(1)
    (pair,) = pairs(of_pixels(rig, disc, disc[::-1]), grid)
    assert pair.overlap < 0.7


def test_pictures_along_one_line_say_nothing_of_depth() -> None:
    assert is_along_one_axis(turned(20, 200, 20)[0])
    assert not is_along_one_axis(turned(20, 110)[0])
    grid = Grid((8, 8, 8))
    assert not is_along_one_axis(of_pixels(walls(grid).rig(), *[np.ones((8, 8), bool)] * 3))
