"""The whole screen: the picture in it as it is cast alone, and around it, at fewer points, the rest of the shadow."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lightcube.forward.casting import cast, play, player
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid, raster_shape
from lightcube.optics.light import AROUND, AROUND_ROW, Beams, lattice
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.optics.transfer import encode
from lightcube.optics.views import Views
from tests.helpers.areas import JUDGED, along_row, averaged

GRID = Grid((3, 5, 7), 0.5)
STOPS = [10.0, 100.0, 250.0]
#: At a stop, and nearest to 250 and 100, but where light is level to 10 and 250, mirrored half a turn on.
BETWEEN = [10.0, 191.0, 60.0]


def cube_of(elevation_deg: float = 35.0, picture_shape: tuple[int, int] = (3, 5), **more: Any) -> Cube:
    rig = turntable(GRID, STOPS, elevation_deg=elevation_deg, picture_shape=picture_shape, **more)
    random = np.random.default_rng(2)
    extinction = random.gamma(0.5, 1.5, (3, *GRID.shape)).astype(np.float32)
    return Cube(extinction, GRID, rig, random.uniform(0.5, 4, (3, 3)))


def moved(cube: Cube, offsets: Sequence[tuple[int, int]]) -> Cube:
    return replace(cube, rig=cube.rig.shifted(np.array(offsets)))


def sized(rig: Rig, shape: tuple[int, int]) -> Rig:
    """Pictures of so many rows and columns around the same middles."""
    stops = replace(rig.stops, window=np.tile(shape, (len(rig), 1)))
    return replace(rig, views=rig.views.with_pixels(1.0, shape), stops=stops)


def in_the_middle(screen: NDArray[np.float32], shape: tuple[int, int], right: int, down: int) -> NDArray[np.float32]:
    """A window of so many rows and columns, so far right and down of the middle, by counting pixels."""
    rows, columns = shape
    top, left = (screen.shape[0] - rows) // 2 + down, (screen.shape[1] - columns) // 2 + right
    return screen[top : top + rows, left : left + columns]


@pytest.mark.parametrize("light", ["area", "thin"])
@pytest.mark.parametrize("zoom", [1, 2])
@pytest.mark.parametrize("elevation_deg", [0.0, 35.0, -20.0])
def test_the_picture_on_the_whole_screen_is_the_picture_bit_for_bit(
    elevation_deg: float, zoom: int, light: Beams
) -> None:
    offsets = [(1, 0), (-2, 0), (0, 0)]
    cube = moved(cube_of(elevation_deg), offsets)
    whole, alone = (play(cube, picture_only=only, zoom=zoom, light=light) for only in (False, True))
    assert whole.shape[1:3] == tuple(zoom * np.array(raster_shape(GRID, elevation_deg)))
    np.testing.assert_array_equal(alone, np.stack(list(cast(cube, zoom=zoom, light=light))))
    for screen, picture, (right, down) in zip(whole, alone, offsets, strict=True):
        shape = picture.shape[0], picture.shape[1]
        np.testing.assert_array_equal(in_the_middle(screen, shape, zoom * right, zoom * down), picture)


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
@pytest.mark.parametrize("pixel", [2, 3])
def test_pixels_of_many_voxels_are_means_of_thin_beams(elevation_deg: float, pixel: int) -> None:
    """Those at the judge's points; and nearly the means of pixels as large as voxels in the same places."""
    raster = raster_shape(GRID, elevation_deg, pixel)
    rows, columns = (2 - count % 2 for count in raster)
    cube = cube_of(elevation_deg, (rows, columns), pixel=pixel)
    shown = play(cube, BETWEEN)
    assert shown.shape[1:3] == raster
    alone = play(cube, BETWEEN, picture_only=True)
    np.testing.assert_allclose(alone, averaged(cube, BETWEEN, JUDGED), rtol=2e-5, atol=1e-6)
    inside = in_the_middle(shown[0], (rows, columns), 0, 0)
    np.testing.assert_array_equal(inside, alone[0])
    fine = replace(cube, rig=cube.rig.with_pixels(1 / pixel, (pixel * rows, pixel * columns)))
    near = play(fine, BETWEEN, picture_only=True).reshape(3, rows, pixel, columns, pixel, 3).mean(axis=(2, 4))
    assert np.sqrt(np.mean((alone - near) ** 2)) < 0.03


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_so_it_is_at_other_angles(elevation_deg: float) -> None:
    """Level light shows the mirror image half a turn on, on the other side of the screen."""
    cube = moved(cube_of(elevation_deg), [(2, 0), (-1, 0), (1, 0)])
    aside = [2, -2, -1] if elevation_deg == 0 else [2, 1, -1]
    whole, alone = (play(cube, BETWEEN, picture_only=only) for only in (False, True))
    for screen, picture, right in zip(whole, alone, aside, strict=True):
        np.testing.assert_array_equal(in_the_middle(screen, (3, 5), right, 0), picture)
    show = player(cube)
    np.testing.assert_array_equal(np.concatenate([show(angle) for angle in BETWEEN]), whole)
    np.testing.assert_array_equal(show(None), play(cube))


@pytest.mark.parametrize(("elevation_deg", "count"), [(0.0, AROUND_ROW), (35.0, AROUND)])
def test_around_it_are_means_of_fewer_beams(elevation_deg: float, count: int) -> None:
    """As plainly averaged, and not far from the means of very many."""
    cube = cube_of(elevation_deg)
    points = [tuple(point) for point in lattice(count)] if elevation_deg else along_row(count)
    expected = averaged(cube, BETWEEN, points, whole=True)
    shown = play(cube, BETWEEN)
    outside = np.ones(shown.shape[1:3], bool)
    in_the_middle(outside, (3, 5), 0, 0)[...] = False
    assert np.any(outside)
    np.testing.assert_allclose(shown[:, outside], expected[:, outside], rtol=1e-5)
    assert not np.allclose(shown[:, ~outside], expected[:, ~outside], rtol=1e-3)
    many = averaged(cube, BETWEEN, [tuple(point) for point in lattice(233)], whole=True)
    assert np.sqrt(np.mean((encode(shown) - encode(many.astype(np.float32))) ** 2)) < 0.02
    np.testing.assert_allclose(shown[0, :, 0], np.tile(cube.powers[0], (len(shown[0]), 1)), rtol=1e-6)  # past the cube


def test_a_lamps_disc_blurs_what_is_around_too() -> None:
    cube = cube_of(30.0, lamp_deg=9.0, screen_mm=4.0)
    whole, alone, sharp = play(cube), play(cube, picture_only=True), play(cube, light="thin")
    assert np.all(np.array(whole.shape[1:3]) > raster_shape(GRID, 30.0))
    np.testing.assert_array_equal(in_the_middle(whole[0], (3, 5), 0, 0), alone[0])
    assert np.max(np.abs(np.diff(whole, axis=2))) < np.max(np.abs(np.diff(sharp, axis=2)))


@pytest.mark.parametrize("picture_shape", [(3, 4), (2, 5), (4, 4), (12, 5), (3, 14), (30, 31)])
@pytest.mark.parametrize("offset", [(0, 0), (3, -1)])
def test_a_picture_of_any_size_lies_on_the_pixels_of_the_whole_screen(
    picture_shape: tuple[int, int], offset: tuple[int, int]
) -> None:
    """Of another parity than the raster, larger than the shadow, standing out of it: and all the shadow is there."""
    cube = cube_of(35.0)
    cube = moved(replace(cube, rig=sized(cube.rig, picture_shape)), [offset, (0, 0), (-1, 1)])
    whole, alone = play(cube), play(cube, picture_only=True)
    for screen, picture, (right, down) in zip(whole, alone, [offset, (0, 0), (-1, 1)], strict=True):
        np.testing.assert_array_equal(in_the_middle(screen, picture_shape, right, down), picture)
    assert np.all(np.array(whole.shape[1:3]) >= raster_shape(GRID, 35.0))
    rows, columns = whole.shape[1] + 4, whole.shape[2] + 4
    for picture, power in zip(cast(cube, sized(cube.rig.whole(GRID), (rows, columns))), cube.powers, strict=True):
        edge = np.ones((rows, columns), bool)
        edge[2:-2, 2:-2] = False
        np.testing.assert_allclose(picture[edge], np.broadcast_to(power, (edge.sum(), 3)), rtol=1e-6)


@pytest.mark.parametrize(("across", "down"), [(0.2, 0.2), (1.1, 0.5), (0.35, 0.9)])
@pytest.mark.parametrize(("right", "below"), [(0.0, 0.0), (0.3, -1.4), (-2.45, 0.5)])
def test_pixels_of_another_size_than_voxels_and_anywhere_hold_the_shadow_too(
    across: float, down: float, right: float, below: float
) -> None:
    """Of views that are no turntable's, whose middles are parts of a pixel off the shadow's."""
    lamps, steps = np.array([[1.0, 0.2, -0.3, 0.0]]), (np.array([[0.0, -across, 0.0]]), np.array([[0.0, 0.0, -down]]))
    views = Views(lamps, right * steps[0] + below * steps[1], *steps, (2, 3))
    cube = Cube(np.full((1, *GRID.shape), 2, np.float32), GRID, Rig.of(views))
    screen, picture = (play(cube, picture_only=only, light="thin")[0, ..., 0] for only in (False, True))
    beyond = sized(cube.rig.whole(GRID), (screen.shape[0] + 2, screen.shape[1] + 2))
    around = next(cast(cube, beyond, light="thin"))[..., 0]
    np.testing.assert_allclose(around[1:-1, 1:-1], screen, rtol=1e-5)
    assert np.min(screen) < 0.1
    np.testing.assert_array_equal(np.concatenate([around[0], around[-1], around[:, 0], around[:, -1]]), 1)
    found = [
        (top, left)
        for top in range(screen.shape[0] - 1)
        for left in range(screen.shape[1] - 2)
        if np.array_equal(screen[top : top + 2, left : left + 3], picture)
    ]
    assert found
    middles = [(left - (screen.shape[1] - 3) / 2, top - (screen.shape[0] - 2) / 2) for top, left in found]
    assert np.min(np.linalg.norm(np.array(middles) - (right, below), axis=1)) < 0.75


@pytest.mark.parametrize("right", [0.5, -0.3, 0.0])
def test_a_shadow_that_fills_its_raster_is_whole_on_pixels_that_lie_aside(right: float) -> None:
    """A block of 4 x 3 seen across its diagonal is exactly 5 wide."""
    grid = Grid((2, 3, 4))
    along, across = np.array([0.6, 0.8, 0.0]), np.array([0.8, -0.6, 0.0])
    views = Views(np.append(along, 0)[None], right * across[None], across[None], np.array([[0.0, 0.0, -1.0]]), (2, 3))
    cube = Cube(np.full((1, *grid.shape), 3, np.float32), grid, Rig.of(views))
    whole = cube.rig.whole(grid)
    assert whole.picture_shape == (2, 5 if right == 0 else 7)
    wider = next(cast(cube, sized(whole, (2, whole.picture_shape[1] + 2))))
    np.testing.assert_array_equal(wider[:, [0, -1]], 1)


def test_where_pictures_are_the_whole_screen_nothing_is_around() -> None:
    cube = cube_of(0.0, raster_shape(GRID))
    np.testing.assert_array_equal(play(cube), play(cube, picture_only=True))
