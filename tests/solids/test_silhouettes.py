"""Pictures cut out and put onto a rig: what is shape, how far its edges are, and what is said of doubtful pictures."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import lightcube as lc
from lightcube.errors import InputError
from lightcube.kernels.hull import MARGIN
from lightcube.optics.grid import Grid
from lightcube.optics.transfer import decode
from lightcube.solids.cutting import Cut, cut, plain_ground
from lightcube.solids.silhouettes import FINE, Silhouettes
from lightcube.solids.standing import silhouettes
from lightcube.solids.walls import block, walls
from tests.helpers.solid import around, blobs, plain_distances

Array = NDArray[Any]


def drawn(grey: Array, opacity: Array | None = None, name: str = "a") -> lc.Pictures:
    """A picture of display greys."""
    light = decode(np.repeat(np.asarray(grey, np.float32)[..., None], 3, axis=2))
    return lc.Pictures((light,), (name,), opacities=() if opacity is None else (np.asarray(opacity, np.float32),))


def disc(size: int, radius: float, at: tuple[float, float] = (0.0, 0.0), times: int = 8) -> Array:
    """A disc's coverage of pixels."""
    places = (np.arange(size * times) + 0.5) / times - size / 2
    inside = np.hypot(places[:, None] - at[0], places - at[1]) < radius
    return inside.reshape(size, times, size, times).mean(axis=(1, 3))


@pytest.mark.parametrize(("shape", "ground", "by"), [(0.1, 0.9, "dark"), (0.8, 0.2, "light"), (0.45, 0.55, "dark")])
def test_shape_and_ground_are_told_by_the_border(shape: float, ground: float, by: str) -> None:
    covered = disc(31, 9)
    (one,) = cut(drawn(ground + (shape - ground) * covered))
    assert one.by == by
    assert one.threshold == pytest.approx((shape + ground) / 2, abs=0.02)
    np.testing.assert_allclose(one.coverage, covered, atol=0.06)
    assert (one.specks, one.border) == (0, 0)
    assert plain_ground(one)
    (other,) = cut(drawn(ground + (shape - ground) * covered), invert=by == "dark")
    np.testing.assert_allclose(other.coverage, 1 - one.coverage, atol=1e-6)
    assert not plain_ground(other)


def test_opacity_is_the_shape_whatever_its_colours() -> None:
    covered = disc(25, 7)
    grey = np.random.default_rng(0).random((25, 25))
    (one,) = cut(drawn(grey, covered))
    assert one.by == "opacity"
    np.testing.assert_allclose(one.coverage, covered, atol=1e-6)
    (stricter,) = cut(drawn(grey, covered), threshold=0.9)
    assert stricter.threshold == pytest.approx(0.9)
    np.testing.assert_array_equal(stricter.inside, covered > 0.9)
    (hole,) = cut(drawn(grey, covered), invert=True)
    np.testing.assert_array_equal(hole.inside, covered < 0.5)


def test_a_picture_that_is_hardly_transparent_is_cut_by_its_greys() -> None:
    opacity = np.ones((25, 25))
    opacity[0, 0] = 0
    (one,) = cut(drawn(1 - disc(25, 7), opacity))
    assert one.by == "dark"


def test_a_threshold_moves_the_edge() -> None:
    ramp = np.tile(np.linspace(0, 1, 101), (9, 1))
    for at in (0.25, 0.6):
        (one,) = cut(drawn(ramp), threshold=at, invert=False)
        assert np.count_nonzero(one.inside[0]) == pytest.approx(101 * at, abs=1)
    with pytest.raises(InputError, match="between 0 and 1, not"):
        cut(drawn(ramp), threshold=1.5)


def test_soft_edges_and_noise_are_told() -> None:
    (crisp,) = cut(drawn(1 - (disc(41, 12) > 0.5)))
    (soft,) = cut(drawn(np.tile(np.clip(np.linspace(-1, 2, 60), 0, 1), (40, 1))))
    assert crisp.near == 0
    assert 0.04 < soft.near < 0.1


def test_specks_and_pinholes_are_dirt_and_strokes_are_not() -> None:
    grey = 1 - (disc(101, 40) > 0.5).astype(float)
    grey[3, 3] = grey[97, 5:8] = 0
    grey[50, 50] = 1
    grey[10, 70:90] = 0  # a stroke of twenty pixels
    (one,) = cut(drawn(grey))
    assert one.specks == 3
    assert not one.inside[3, 3]
    assert one.inside[50, 50]
    assert np.all(one.inside[10, 70:90])


def test_a_shape_that_touches_its_border_is_told() -> None:
    grey = np.ones((20, 20))
    grey[8:, 5:12] = 0
    (one,) = cut(drawn(grey))
    assert one.border == pytest.approx(7 / 76)
    assert plain_ground(one)


@pytest.mark.parametrize(
    ("grey", "options", "said"),
    [
        (np.full((9, 9), np.nan), {}, "picture a holds NaN"),
        (np.full((9, 9), 0.5), {}, "picture a is of one grey, and shows no shape"),
        (1 - 0.9 * disc(9, 3), {"threshold": 0.001, "invert": False}, "picture a is all ground at a threshold of 0.00"),
        (0.2 + 0.5 * disc(9, 3), {"threshold": 0.99, "invert": False}, "picture a is all shape"),
    ],
)
def test_a_picture_of_nothing_is_refused(grey: Array, options: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        cut(drawn(grey), **options)


def test_distances_are_those_of_a_plain_transform() -> None:
    given = blobs(around(Grid((5, 6, 7)), 3), 2)
    for found, inside in zip(given.distances, given.inside, strict=True):
        np.testing.assert_allclose(found, plain_distances(inside), atol=1e-5)
    np.testing.assert_array_equal(given.pixels(), given.distances[:, MARGIN:-MARGIN, MARGIN:-MARGIN] < 0)


def test_edges_are_kept_finer_than_pixels() -> None:
    """A disc's grey edge: distances are those to a circle to a tenth of a pixel, of pixels as large as its own."""
    grid = Grid((40, 40, 40))
    rig = lc.turntable(grid, [0.0], picture_shape=(40, 40))
    (one,) = cut(drawn(1 - disc(40, 12.3, (0.4, -0.2))))
    found = silhouettes([one], rig).distances[0, MARGIN:-MARGIN, MARGIN:-MARGIN]
    places = np.arange(40) + 0.5 - 20
    wanted = np.hypot(places[:, None] - 0.4, places + 0.2) - 12.3
    near = np.abs(wanted) < 3
    np.testing.assert_allclose(found[near], wanted[near], atol=0.2)
    assert float(np.mean(np.abs(found - wanted)[near])) < 0.1


def test_pictures_of_other_aspects_stand_in_the_middle_with_ground_around() -> None:
    rig = lc.turntable(Grid((8, 16, 16)), [10.0, 100.0], picture_shape=(8, 16))
    square = Cut("a", np.ones((20, 20), np.float32), "dark", 0.5, 0.0, 0, 1.0)
    padded, stretched = (silhouettes([square, square], rig, way).inside[0] for way in ("pad", "stretch"))
    wanted = np.zeros((8 * FINE, 16 * FINE), bool)
    wanted[:, 4 * FINE : 12 * FINE] = True
    np.testing.assert_array_equal(padded, wanted)
    assert np.all(stretched)
    with pytest.raises(InputError, match="1 shape for 2 pictures of a rig: give one each"):
        silhouettes([square], rig)


def test_some_of_them_are_taken_with_their_views() -> None:
    given = blobs(around(Grid((5, 6, 7)), 4), 3)
    some = given.take([2, 0])
    assert some.names == ("2", "0")
    np.testing.assert_array_equal(some.inside, given.inside[[2, 0]])
    np.testing.assert_array_equal(some.rig.views.lamps, given.rig.views.lamps[[2, 0]])


def test_silhouettes_are_checked_when_they_are_made() -> None:
    given = blobs(around(Grid((5, 6, 7)), 2), 3)
    with pytest.raises(InputError, match="silhouettes of <rig"):
        Silhouettes(given.inside[:1], given.rig, given.names)
    with pytest.raises(InputError, match="2 silhouettes with 1 names"):
        Silhouettes(given.inside, given.rig, ("a",))


def rectangle(rows: int, columns: int) -> Cut:
    return Cut("a", np.pad(np.ones((rows, columns), np.float32), 5), "dark", 0.5, 0.0, 0, 0.0)


def test_three_shapes_that_agree_say_their_block_and_are_not_stretched() -> None:
    """A body of 3 x 4 x 5 (x, y, z): its front is 3 wide and 5 high, its side 4 and 5, its top 3 and 4."""
    grid, stretched = block([rectangle(50, 30), rectangle(50, 40), rectangle(40, 30)], 50, 100.0)
    assert grid.shape == (50, 40, 30)
    assert grid.size_mm == pytest.approx((100, 80, 60))
    assert stretched == pytest.approx(0, abs=1e-9)


def test_three_shapes_that_do_not_are_all_stretched_alike() -> None:
    """Of squares but the top, twice as wide as deep, none by more than the cube root of 2."""
    grid, stretched = block([rectangle(40, 40), rectangle(40, 40), rectangle(20, 40)], 100, 100.0)
    assert stretched == pytest.approx(2 ** (1 / 3) - 1)
    nz, ny, nx = grid.shape
    factors = [nx / nz, nz / ny, 2 / (nx / ny)]
    assert factors == pytest.approx([2 ** (1 / 3)] * 3, rel=0.02)
    with pytest.raises(InputError, match="three walls take three pictures, front, side and top, not 2"):
        block([rectangle(9, 9)] * 2, 10, 1.0)


def test_walls_are_of_cubes() -> None:
    with pytest.raises(InputError, match="not 2 times as tall"):
        walls(Grid((4, 4, 4), tall=2))
