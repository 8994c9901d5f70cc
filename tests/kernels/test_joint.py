"""Several views as one: the joint absorbance of a group, and its derivatives."""

import numpy as np
import pytest

from lightcube.kernels import joint
from lightcube.kernels.light import Mixture
from tests.conftest import INTERPRETED

#: Views of each group, channels, and pixels: more than a run has, and not a whole number of runs.
LOADS = [((2, 1, 4), 2, 6), ((1, 13), 3, 7), ((5, 3), 1, 11)]
if not INTERPRETED:
    LOADS += [((21, 8), 3, 1777), ((1, 40), 1, 4099)]


def some_views(
    counts: tuple[int, ...], channels: int, pixels: int, dtype: str, kind: str
) -> tuple[Mixture, np.ndarray]:
    """A mixture whose pixels differ, but for the first, or whose views do, or whose views are alike; and absorbance."""
    random = np.random.default_rng(pixels)
    views = sum(counts)
    shares = random.uniform(0.05, 1, (views, channels))
    light, shadow = random.uniform(0.2, 1.5, (views, pixels)), random.uniform(0, 1, (views, pixels))
    if kind == "views":
        light, shadow = light[:, :1], shadow[:, :1]
    elif kind == "alike":
        light, shadow = light[:, :1], shadow[:, :1]
        shares[:], light[:], shadow[:] = 1 / 7, 1, 1
        shares[-1, -1] = light[-3] = shadow[1] = 0.5  # but for these
    else:
        shares[:], light[:, 0], shadow[:, 0] = shares[0], light[0, 0], shadow[0, 0]
    numbers = (np.ascontiguousarray(each, dtype) for each in (shares, light, shadow))
    absorbance = random.exponential(2.0, (views, pixels * channels)).astype(dtype)
    return Mixture(np.cumsum([0, *counts]), *numbers), absorbance


def all_of(mixture: Mixture, absorbance: np.ndarray) -> np.ndarray:
    """All entries of all groups, each of which makes a picture."""
    groups, channels = len(mixture.starts) - 1, mixture.powers.shape[1]
    counts = np.ones((groups, absorbance.shape[1] // channels), bool)
    return joint.runs_of(counts, np.arange(groups + 1), mixture.starts, channels)


def shown(mixture: Mixture, absorbance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What each view shows under a lamp of power 1, and what of that came through the cube, each by itself."""
    channels = mixture.powers.shape[1]
    pixels = absorbance.shape[1] // channels
    clear, dark = np.empty(absorbance.shape), np.empty(absorbance.shape)
    for v in range(len(absorbance)):
        for i in range(absorbance.shape[1]):
            k = i // channels if mixture.light.shape[1] == pixels else 0
            full = float(mixture.powers[v, i % channels]) * float(mixture.light[v, k])
            through = full * float(mixture.shadow[v, k]) * np.exp(-float(absorbance[v, i]))
            clear[v, i], dark[v, i] = full * (1 - float(mixture.shadow[v, k])) + through, through
    return clear, dark


@pytest.mark.parametrize("kind", ["pixels", "views", "alike"])
@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("load", LOADS)
def test_a_group_shows_what_its_views_show_together(
    load: tuple[tuple[int, ...], int, int], dtype: str, kind: str
) -> None:
    mixture, absorbance = some_views(*load, dtype, kind)
    found = np.empty((len(load[0]), absorbance.shape[1]), dtype)
    joint.join(all_of(mixture, absorbance), mixture, absorbance, found)
    full, through = shown(mixture, absorbance)
    total = np.add.reduceat(full, mixture.starts[:-1])
    tolerance = 2e-6 if dtype == "float32" else 1e-12
    np.testing.assert_allclose(np.exp(-found.astype(np.float64)), total, rtol=tolerance, atol=tolerance / 10)

    slopes = np.random.default_rng(0).normal(size=found.shape).astype(dtype)
    every = np.repeat(slopes / total, np.diff(mixture.starts), axis=0) * through
    own = absorbance.copy()
    joint.spread(all_of(mixture, absorbance), mixture, own, found, slopes, own)
    np.testing.assert_allclose(own, every, rtol=10 * tolerance, atol=tolerance)


@pytest.mark.parametrize("load", LOADS)
def test_where_nothing_counts_nothing_is_computed(load: tuple[tuple[int, ...], int, int]) -> None:
    """And elsewhere the same; the last two groups make one picture."""
    mixture, absorbance = some_views(*load, "float64", "pixels")
    views, channels, pixels = load
    groups = np.array([*range(len(views) - 1), len(views)])
    counts = np.random.default_rng(2).random((len(groups) - 1, pixels)) < 0.3
    counts[:, 5 : min(pixels, 70)] = False
    runs = joint.runs_of(counts, groups, mixture.starts, channels)
    heard = np.zeros((len(views), pixels * channels), int)
    for group, first, last, is_heard in runs.tolist():
        heard[group, first:last] += 1 + is_heard
    assert np.all(heard > 0)
    wanted = np.repeat(np.repeat(counts, channels, axis=1), np.diff(groups), axis=0)
    assert np.all(heard[wanted] == 2)
    assert np.all(heard[:, 8 * channels : min(pixels, 68) * channels] == 1)
    assert heard.max() <= 2

    found, whole = np.full((2, *heard.shape), np.nan)
    joint.join(runs, mixture, absorbance, found)
    joint.join(all_of(mixture, absorbance), mixture, absorbance, whole)
    np.testing.assert_array_equal(found, np.where(heard == 2, whole, 0))
    slopes = np.random.default_rng(0).normal(size=found.shape)
    own, every = absorbance.copy(), absorbance.copy()
    joint.spread(runs, mixture, own, found, slopes, own)
    joint.spread(all_of(mixture, absorbance), mixture, every, whole, slopes, every)
    np.testing.assert_array_equal(own, np.where(np.repeat(heard == 2, np.diff(mixture.starts), axis=0), every, 0))


def test_slopes_are_those_of_the_joint_absorbance() -> None:
    mixture, absorbance = some_views((2, 1, 4), 2, 6, "float64", "pixels")
    found, own, step = np.empty((3, 12)), np.empty_like(absorbance), 1e-5
    joint.join(all_of(mixture, absorbance), mixture, absorbance, found)
    joint.spread(all_of(mixture, absorbance), mixture, absorbance, found, np.ones_like(found), own)
    group = np.repeat(np.arange(3), np.diff(mixture.starts))
    for v, i in np.ndindex(*absorbance.shape):
        ends = []
        for sign in (-1, 1):
            moved, there = absorbance.copy(), np.empty_like(found)
            moved[v, i] += sign * step
            joint.join(all_of(mixture, absorbance), mixture, moved, there)
            ends.append(there)
        assert own[v, i] == pytest.approx((ends[1] - ends[0])[group[v], i] / (2 * step), rel=1e-5, abs=1e-9)


@pytest.mark.parametrize("depth", [-0.5, 60.0, 90.0, 3000.0])
def test_light_that_float32_has_no_number_for_has_an_absorbance(depth: float) -> None:
    mixture = Mixture(np.array([0, 3]), np.full((3, 1), np.float32(1 / 3)), *np.ones((2, 3, 1), np.float32))
    absorbance = (depth + np.array([[0.0], [1.0], [2.0]])).astype(np.float32)
    found, own = np.empty((1, 1), np.float32), np.empty_like(absorbance)
    joint.join(all_of(mixture, absorbance), mixture, absorbance, found)
    parts = np.exp(-np.arange(3.0))
    assert found[0, 0] == pytest.approx(depth - np.log(np.mean(parts)), rel=1e-6)
    joint.spread(all_of(mixture, absorbance), mixture, absorbance, found, np.ones_like(found), own)
    np.testing.assert_allclose(own[:, 0], parts / parts.sum(), rtol=1e-6 * max(1, depth))


def test_light_that_no_cube_absorbs_bounds_the_absorbance() -> None:
    mixture = Mixture(np.array([0, 2]), np.full((2, 1), 0.5), np.ones((2, 1)), np.array([[1.0], [0.75]]))
    found, own = np.empty((1, 1)), np.empty((2, 1))
    absorbance = np.array([[800.0], [900.0]])
    joint.join(all_of(mixture, absorbance), mixture, absorbance, found)
    assert found[0, 0] == pytest.approx(np.log(8))
    joint.spread(all_of(mixture, absorbance), mixture, absorbance, found, np.ones_like(found), own)
    assert np.all(own < 1e-300)


@pytest.mark.parametrize("shape", [(1, 1), (70, 3), (300, 3), (65, 2000), (1000, 40)])
def test_the_least_ahead_is_that_of_each_column(shape: tuple[int, int]) -> None:
    last, now = np.random.default_rng(1).normal(size=(2, *shape)).astype(np.float32)
    np.testing.assert_array_equal(joint.least_ahead(last, now), np.min(now + (now - last), axis=0))
