"""Pixels in parts: each the mean over its own area, which together are the pixel."""

import functools
import itertools
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.forward.casting import cast, play, player
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.light import MOST_ZOOM, Beams, lattice
from lightcube.optics.setups import turntable
from lightcube.optics.transfer import encode
from tests.helpers.areas import THIN, Points, along_row, averaged, over_square
from tests.optics.test_rig import ROOM

GRID = Grid((3, 5, 7), 0.5)
STOPS = [10.0, 100.0]


def cube_of(elevation_deg: float, **more: Any) -> Cube:
    rig = turntable(GRID, STOPS, elevation_deg=elevation_deg, picture_shape=(3, 5), **more)
    random = np.random.default_rng(3)
    return Cube(random.gamma(0.5, 1.5, (3, *GRID.shape)).astype(np.float32), GRID, rig, random.uniform(0.5, 3, (2, 3)))


def staged() -> Cube:
    """Under three lamps on two screens with edges, of which shadows and light fade."""
    random = np.random.default_rng(4)
    extinction = random.gamma(0.5, 0.4, (3, *ROOM.grid.shape)).astype(np.float32)
    return Cube(extinction, ROOM.grid, ROOM.rig(), random.uniform(0.5, 3, (len(ROOM.rig().pairs), 3)))


def means(shown: NDArray[np.float32], zoom: int) -> NDArray[Any]:
    """Of the parts of each pixel."""
    count, rows, columns, channels = shown.shape
    parts = shown.reshape(count, rows // zoom, zoom, columns // zoom, zoom, channels)
    return parts.astype(np.float64).mean(axis=(2, 4))


def points_of(zoom: int, *, level: bool) -> Points:
    """Those of a part: as many a pixel as the judge has, at least 4 a part."""
    if level:
        return along_row(max(4, -(-16 // zoom)))
    count = max(4, -(-55 // zoom**2))
    return over_square(55, 34) if zoom == 1 else [(float(x), float(y)) for x, y in lattice(count)]


@pytest.mark.parametrize("zoom", [1, 2, 3, 5])
@pytest.mark.parametrize("elevation_deg", [0.0, 35.0, -20.0])
def test_parts_are_what_is_plainly_averaged(elevation_deg: float, zoom: int) -> None:
    cube, angles_deg = cube_of(elevation_deg), [10.0, 47.0]
    points = points_of(zoom, level=elevation_deg == 0)
    shown = play(cube, angles_deg, picture_only=True, zoom=zoom)
    assert shown.shape == (2, 3 * zoom, 5 * zoom, 3)
    np.testing.assert_allclose(shown, averaged(cube, angles_deg, points, parts=zoom), rtol=1e-5)
    thin = play(cube, angles_deg, picture_only=True, zoom=zoom, light="thin")
    np.testing.assert_allclose(thin, averaged(cube, angles_deg, THIN, parts=zoom), rtol=1e-5)
    assert zoom == 1 or np.std(means(shown, zoom).repeat(zoom, 1).repeat(zoom, 2) - shown) > 0.01


@functools.cache
def finely(elevation_deg: float) -> NDArray[Any]:
    """At very many points: of each elevation once, because it takes long."""
    many: Points = along_row(256) if elevation_deg == 0 else [(float(x), float(y)) for x, y in lattice(610)]
    return averaged(cube_of(elevation_deg), STOPS, many)


@pytest.mark.parametrize(("elevation_deg", "screen"), [(0.0, 0.02), (35.0, 0.01)])
@pytest.mark.parametrize("zoom", [2, 3, 4, 7, MOST_ZOOM])
def test_the_mean_of_parts_is_the_pixel(elevation_deg: float, screen: float, zoom: int) -> None:
    """But for what the points of either miss, beside very many points."""
    cube = cube_of(elevation_deg)
    pixels, parts = play(cube, picture_only=True), means(play(cube, picture_only=True, zoom=zoom), zoom)
    exact = finely(elevation_deg)

    def off(shown: NDArray[Any], wanted: NDArray[Any]) -> float:
        return float(np.sqrt(np.mean((encode(shown.astype(np.float64)) - encode(wanted.astype(np.float64))) ** 2)))

    assert off(pixels, parts) < screen
    assert off(parts, exact) < max(off(pixels, exact), 0.005)


@pytest.mark.parametrize("light", ["area", "thin"])
def test_on_a_stage_a_part_is_a_smaller_pixel(light: Beams) -> None:
    """By a rig of smaller pixels, with the light that falls on each, and the screens' edges."""
    cube = staged()
    rows, columns = cube.rig.picture_shape
    for zoom in (2, 3):
        small = cube.rig.with_pixels(1 / zoom, (zoom * rows, zoom * columns))
        shown = np.stack(list(cast(cube, zoom=zoom, light=light)))
        expected = np.stack(list(cast(cube, small, light=light)))
        np.testing.assert_array_equal(shown == 0, expected == 0)
        rtol, atol = (2e-4, 1e-6) if light == "thin" else (0.05, 0.01)
        np.testing.assert_allclose(shown, expected, rtol=rtol, atol=atol)
    np.testing.assert_array_equal(play(cube, zoom=2), play(cube, zoom=2, picture_only=True))


def test_a_lamps_disc_is_averaged_over_in_every_part() -> None:
    cube = cube_of(35.0, lamp_deg=8.0)
    small = cube.rig.with_pixels(1 / 2, (6, 10))
    parts, smaller = (np.stack(list(each)) for each in (cast(cube, zoom=2), cast(cube, small)))
    np.testing.assert_allclose(parts, smaller, rtol=0.02, atol=0.005)
    thin = np.stack(list(cast(cube, zoom=2, light="thin")))
    np.testing.assert_allclose(thin, np.stack(list(cast(cube, small, light="thin"))), rtol=1e-5)


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
@pytest.mark.parametrize("light", ["area", "thin"])
def test_a_zoom_of_1_is_none_bit_for_bit(elevation_deg: float, light: Beams) -> None:
    cube = cube_of(elevation_deg)
    for picture_only, angles_deg in itertools.product((False, True), (None, [33.0])):
        said, unsaid = (
            play(cube, angles_deg, picture_only=picture_only, light=light, **more) for more in ({"zoom": 1}, {})
        )
        np.testing.assert_array_equal(said, unsaid)


def test_a_level_pixel_is_the_same_from_its_bottom_to_its_top() -> None:
    shown = play(cube_of(0.0), zoom=3)
    np.testing.assert_array_equal(shown[:, ::3], shown[:, 1::3])
    np.testing.assert_array_equal(shown[:, ::3], shown[:, 2::3])
    raised = play(cube_of(35.0), zoom=3)
    assert not np.allclose(raised[:, ::3], raised[:, 1::3], rtol=0.05)


@pytest.mark.parametrize("zoom", [0, -1, MOST_ZOOM + 1])
def test_other_zooms_are_refused_at_once(zoom: int) -> None:
    cube = cube_of(35.0)
    for function in (cast, play, player):
        with pytest.raises(InputError, match=f"whole number from 1 to 16, of parts a side of each pixel, not {zoom}"):
            function(cube, zoom=zoom)
