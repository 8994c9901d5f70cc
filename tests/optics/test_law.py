"""The law of light: what views add up to, however it is asked for, and what it refuses."""

from typing import Any

import numpy as np
import pytest

from lightcube.errors import InputError
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.law import Mixture, falling_light, shown_light
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.optics.tables import Fading
from tests.conftest import INTERPRETED
from tests.helpers import plain
from tests.helpers.areas import divided
from tests.helpers.thin import play
from tests.optics.test_rig import ROOM

GRID = Grid((3, 5, 7), 0.7)


def some_mixture(**changes: Any) -> Mixture:
    """Two pictures, of two views and of one, of 6 pixels in 2 channels."""
    given = {
        "starts": np.array([0, 2, 3]),
        "share": np.ones((3, 2)),
        "light": np.ones((3, 6)),
        "shadow": np.ones((3, 6)),
    }
    return Mixture(**{**given, **changes})


@pytest.mark.parametrize(
    ("match", "changes"),
    [
        ("are not of the same views", {"share": np.ones((2, 2))}),
        ("are not of the same views", {"shadow": np.ones((3, 5))}),
        ("must begin at views from 0 up to 3", {"starts": np.array([0, 2])}),
        ("must begin at views from 0 up to 3", {"starts": np.array([0, 2, 2, 3])}),
        ("share must be finite and at least 0", {"share": np.full((3, 2), -1.0)}),
        ("light must be finite and at least 0", {"light": np.full((3, 6), np.inf)}),
        ("shadow must be finite and from 0 to 1", {"shadow": np.full((3, 6), 1.5)}),
        ("shadow must be finite and from 0 to 1", {"shadow": np.full((3, 6), np.nan)}),
    ],
)
def test_views_that_cannot_add_up_are_refused(match: str, changes: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=match):
        some_mixture(**changes)


def random_mixture(channels: int, pixels: int, counts: tuple[int, ...]) -> tuple[Mixture, np.ndarray, np.ndarray]:
    """Pictures of so many views each, powers of their lamps, and absorbance from far below 0 to nearly all."""
    random, views = np.random.default_rng(1), sum(counts)
    light, shadow = random.uniform(0.2, 1.5, (views, pixels)), random.choice([0.0, 0.3, 0.99999, 1.0], (views, pixels))
    mixture = Mixture(np.cumsum([0, *counts]), random.uniform(0.1, 1, (views, channels)), light, shadow)
    powers = random.uniform(0.1, 9, (views, channels))
    return mixture, powers, random.choice([-0.5, 0.0, 0.3, 5.0, 15.0, 60.0], (views, pixels * channels))


def entries(light: np.ndarray) -> np.ndarray:
    """``(pictures, entries)`` of pictures: columns from the left, bottom-up in each."""
    return light[:, ::-1].transpose(0, 2, 1, 3).reshape(len(light), -1)


@pytest.mark.parametrize("channels", [1, 2, 3, 5])
@pytest.mark.parametrize(
    ("shape", "counts"),
    [((3, 5), (2, 1, 4)), ((7, 1), (1, 1, 1, 1)), ((1, 1), (3, 2)), ((5, 7) if INTERPRETED else (31, 43), (1, 19))],
)
def test_light_is_the_plain_sum_from_darkness_to_beyond_the_lamp(
    channels: int, shape: tuple[int, int], counts: tuple[int, ...]
) -> None:
    """To some units of the last place, dark pixels too."""
    mixture, powers, absorbance = random_mixture(channels, shape[0] * shape[1], counts)
    data = powers * mixture.share, mixture.light, mixture.shadow, absorbance
    expected = plain.shown_light(mixture.starts, *data)
    np.testing.assert_allclose(entries(shown_light(mixture, powers, absorbance, shape)), expected, rtol=1e-9)
    single = Mixture(mixture.starts, mixture.share, *(each.astype(np.float32) for each in (data[1], data[2])))
    absorbance = absorbance.astype(np.float32)
    shown = shown_light(single, powers, absorbance.reshape(-1, shape[0] * channels), shape)
    assert shown.dtype == np.float32
    assert shown.shape == (len(counts), *shape, channels)
    exact = plain.shown_light(single.starts, data[0], single.light, single.shadow, absorbance)
    np.testing.assert_allclose(entries(shown), exact, rtol=5e-7)


def test_some_pictures_are_those_of_all() -> None:
    mixture, powers, absorbance = random_mixture(3, 6, (2, 1, 4))
    whole = shown_light(mixture, powers, absorbance, (3, 2))
    assert np.array_equal(shown_light(mixture, powers, absorbance, (3, 2), np.array([2, 0])), whole[[2, 0]])


def test_pixels_that_are_alike_may_be_one() -> None:
    mixture, powers, absorbance = random_mixture(3, 6, (2, 1, 4))
    one = Mixture(mixture.starts, mixture.share, mixture.light[:, :1], mixture.shadow[:, :1])
    each = Mixture(mixture.starts, mixture.share, np.repeat(one.light, 6, axis=1), np.repeat(one.shadow, 6, axis=1))
    few, many = (shown_light(given, powers, absorbance, (3, 2)) for given in (one, each))
    assert np.array_equal(few, many)


def fading_nowhere_near(rig: Rig) -> Rig:
    """The same light, of a rig that is not thin: shadows fade far beyond the screen."""
    views = len(rig.views)
    nowhere = Fading(np.full((views, 2), 1e6), np.ones((views, 2)), np.full(views, np.inf), np.zeros(views, np.bool_))
    return Rig(rig.views, rig.sums, nowhere, rig.turning, rig.stops, rig.lamps, rig.screens)


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_sums_of_one_view_each_are_thin_pictures(elevation_deg: float) -> None:
    rig = turntable(GRID, [10.0, 77.0, 140.0], elevation_deg=elevation_deg)
    extinction = np.random.default_rng(0).random((3, *GRID.shape)).astype(np.float32)
    powers = np.random.default_rng(1).uniform(0.5, 3, (3, 3))
    summed = fading_nowhere_near(rig)
    assert rig.is_thin
    assert not summed.is_thin
    one, other = (play(Cube(extinction, GRID, each, powers)) for each in (rig, summed))
    assert np.array_equal(one, other)
    expected = powers[:, None, None] * np.exp(-plain.absorbance_pictures(GRID, rig.views, extinction))
    np.testing.assert_allclose(one, expected, rtol=1e-5)


def test_a_picture_of_more_views_than_are_cast_at_a_time_is_their_sum() -> None:
    rig = divided(turntable(GRID, [10.0, 77.0], elevation_deg=20.0, picture_shape=(3, 3)), pixel=5)
    assert len(rig.views) == 50
    extinction = np.random.default_rng(0).random((2, *GRID.shape)).astype(np.float32)
    powers = np.random.default_rng(1).uniform(0.5, 3, (2, 2))
    absorbance = plain.absorbance_pictures(GRID, rig.views, extinction)
    expected = powers[:, None, None] * np.exp(-absorbance).reshape(2, 25, 3, 3, 2).mean(axis=1)
    np.testing.assert_allclose(play(Cube(extinction, GRID, rig, powers)), expected, rtol=1e-5)
    summed = fading_nowhere_near(rig)
    np.testing.assert_allclose(play(Cube(extinction, GRID, summed, powers)), expected, rtol=1e-5)


def test_a_part_of_a_rig_makes_a_part_of_the_mixture() -> None:
    """Some views, which count their own pictures from 0; some colours; some rows, bottom-up in each column."""
    rig = divided(ROOM.rig(), pixel=2)
    light, shadow = falling_light(rig)
    for one, other in zip(falling_light(rig, range(3, 9)), (light, shadow), strict=True):
        assert np.array_equal(one, other[3:9])
    counts, starts = np.diff(rig.starts), rig.starts
    whole = Mixture.of(rig, 3)
    assert whole.starts.tolist() == starts.tolist()
    columns = whole.shadow.reshape(len(light), rig.picture_shape[1], rig.picture_shape[0])
    assert np.array_equal(columns, shadow[:, ::-1].transpose(0, 2, 1))
    assert len(np.unique(columns[5])) > 5
    some = Mixture.of(rig.of_views(slice(2, int(starts[2]) + 1)), 3, slice(1, 3), slice(1, 2))
    assert some.starts.tolist() == [0, counts[0] - 2, counts[0] + counts[1] - 2, counts[0] + counts[1] - 1]
    assert np.array_equal(some.share, rig.sums.share[2 : starts[2] + 1, 1:])
    assert np.array_equal(some.light, light[2 : starts[2] + 1, 1])
    assert np.array_equal(some.shadow, shadow[2 : starts[2] + 1, 1])
