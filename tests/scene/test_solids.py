"""Analytic shapes against signed distances sampled densely along lines, and chords against formulas."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import config
from numpy.typing import NDArray

from lightcube.scene.kernels import solids

Array = NDArray[np.float64]
JIT_OFF = bool(getattr(config, "DISABLE_JIT", 0))
LINES = 40 if JIT_OFF else 600


def distance_sphere(p: Array, s: Array) -> Array:
    return np.linalg.norm(p, axis=-1) - s[0]


def distance_box(p: Array, s: Array) -> Array:
    q = np.abs(p) - s
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(axis=-1), 0)


def distance_cone(p: Array, s: Array) -> Array:
    """Greater of the distances to the sides' cone and to the caps: right in sign, and near the faces."""
    slope = (s[0] - s[1]) / (2 * s[2])
    side = (np.hypot(p[..., 0], p[..., 1]) - ((s[0] + s[1]) / 2 - slope * p[..., 2])) / math.hypot(1, slope)
    return np.maximum(side, np.abs(p[..., 2]) - s[2])


def distance_capsule(p: Array, s: Array) -> Array:
    q = p.copy()
    q[..., 2] -= np.clip(q[..., 2], -s[1], s[1])
    return np.linalg.norm(q, axis=-1) - s[0]


def distance_torus(p: Array, s: Array) -> Array:
    return np.hypot(np.hypot(p[..., 0], p[..., 1]) - s[0], p[..., 2]) - s[1]


SHAPES: list[tuple[str, int, list[float], Callable[[Array, Array], Array]]] = [
    ("sphere", solids.SPHERE, [0.7, 0, 0], distance_sphere),
    ("box", solids.BOX, [0.3, 0.5, 0.7], distance_box),
    ("cylinder", solids.CONE, [0.5, 0.5, 0.7], distance_cone),
    ("cone", solids.CONE, [0.7, 0.0, 0.5], distance_cone),
    ("frustum", solids.CONE, [0.3, 0.7, 0.5], distance_cone),
    ("capsule", solids.CAPSULE, [0.3, 0.5, 0], distance_capsule),
    ("torus", solids.TORUS, [0.7, 0.2, 0], distance_torus),
    ("fat torus", solids.TORUS, [0.5, 0.45, 0], distance_torus),
]
each_shape = pytest.mark.parametrize(("kind", "size", "distance"), [s[1:] for s in SHAPES], ids=[s[0] for s in SHAPES])


def lines(count: int, seed: int = 0) -> tuple[Array, Array]:
    """Lines through points near the origin; some along axes, some in planes, directions of any length."""
    rng = np.random.default_rng(seed)
    o, d = rng.uniform(-0.8, 0.8, (count, 3)), rng.normal(size=(count, 3))
    d[::5, 0] = 0
    d[1::7, 2] = 0
    d[2::11, :2] = 0
    d[3::11, 1:] = 0
    d[np.all(d == 0, axis=1)] = (0.3, -0.4, 0.5)
    d[::2] /= np.linalg.norm(d[::2], axis=1)[:, None]
    return o - d * rng.uniform(-3, 3, count)[:, None], d


def crossed(kind: int, size: Array, o: Array, d: Array) -> Array:
    out = np.empty(4)
    return out[: solids.crossings(kind, tuple(size), *o, *d, out)].copy()  # type: ignore[call-arg]


@each_shape
def test_crossings_separate_inside_from_outside(
    kind: int, size: list[float], distance: Callable[[Array, Array], Array]
) -> None:
    s = np.array(size)
    hits = 0
    for o, d in zip(*lines(LINES), strict=True):
        t = crossed(kind, s, o, d)
        hits += len(t)
        assert len(t) % 2 == 0
        assert np.all(np.diff(t) >= 0)
        np.testing.assert_allclose(distance(o + t[:, None] * d, s), 0, atol=1e-9)
        middle = -(o @ d) / (d @ d)
        samples = middle + np.linspace(-1.5, 1.5, 301) / np.linalg.norm(d)
        depth = distance(o + samples[:, None] * d, s)
        clear = np.abs(depth) > 1e-7
        inside = np.searchsorted(t, samples) % 2 == 1
        assert np.array_equal(inside[clear], depth[clear] < 0)
    assert hits > LINES / 4


@each_shape
def test_normals_point_along_the_gradient_of_the_distance(
    kind: int, size: list[float], distance: Callable[[Array, Array], Array]
) -> None:
    s = np.array(size)
    checked = 0
    for o, d in zip(*lines(LINES, seed=1), strict=True):
        for t in crossed(kind, s, o, d):
            p = o + t * d
            step = 1e-5 * np.eye(3)
            gradient = (distance(p + step, s) - distance(p - step, s)) / 2e-5
            if abs(np.linalg.norm(gradient) - 1) > 1e-3:
                continue  # an edge, where there is no one normal
            n = np.array(solids.normal(kind, tuple(s), *p))
            np.testing.assert_allclose(n / np.linalg.norm(n), gradient, atol=2e-3)
            checked += 1
    assert checked > LINES / 2


@each_shape
@given(scale=st.floats(1e-3, 1e3), away=st.floats(-50, 50))
@settings(max_examples=15)
def test_crossings_do_not_depend_on_where_the_line_starts_nor_on_its_speed(
    kind: int, size: list[float], distance: Callable[[Array, Array], Array], scale: float, away: float
) -> None:
    s = np.array(size)
    o, d = np.array([0.11, -0.07, 0.13]), np.array([0.6, -0.48, 0.64])
    near, far = crossed(kind, s, o, d), crossed(kind, s, o - away * d, scale * d)
    assert len(near) == len(far)
    np.testing.assert_allclose(far * scale - away, near, atol=1e-9)


def test_chords_agree_with_formulas() -> None:
    def chord(kind: int, size: list[float], o: list[float], d: list[float]) -> float:
        t = crossed(kind, np.array(size), np.array(o), np.array(d))
        return float(np.sum(t[1::2] - t[::2]))

    assert chord(solids.SPHERE, [1.3, 0, 0], [0.5, -9, 0], [0, 1, 0]) == pytest.approx(2 * math.sqrt(1.69 - 0.25))
    assert chord(solids.BOX, [1, 2, 3], [-5, -5, 0], [math.sqrt(0.5), math.sqrt(0.5), 0]) == pytest.approx(math.sqrt(8))
    assert chord(solids.CONE, [1, 1, 2], [0, 0.6, 9], [0, 0, -1]) == pytest.approx(4)
    assert chord(solids.CONE, [1, 1, 2], [9, 0.6, 1], [-1, 0, 0]) == pytest.approx(1.6)
    assert chord(solids.CONE, [1, 0, 1], [9, 0, 0], [-1, 0, 0]) == pytest.approx(1)
    assert chord(solids.CONE, [1, 0, 1], [0.25, 0, 9], [0, 0, -1]) == pytest.approx(1.5)
    assert chord(solids.CAPSULE, [0.5, 1, 0], [0, 0, 9], [0, 0, -1]) == pytest.approx(3)
    assert chord(solids.TORUS, [1, 0.25, 0], [9, 0, 0], [-1, 0, 0]) == pytest.approx(1)
    assert chord(solids.TORUS, [1, 0.25, 0], [1, 0, 9], [0, 0, -1]) == pytest.approx(0.5)


def test_a_torus_is_entered_twice_along_a_line_through_its_hole() -> None:
    t = crossed(solids.TORUS, np.array([1, 0.25, 0]), np.array([-9.0, 0, 0]), np.array([1.0, 0, 0]))
    np.testing.assert_allclose(t, [7.75, 8.25, 9.75, 10.25])


def test_a_plane_is_crossed_once_or_never() -> None:
    size = np.zeros(3)
    assert crossed(solids.PLANE, size, np.array([1.0, 2, 3]), np.array([0.0, 1, -2])).tolist() == [1.5]
    assert len(crossed(solids.PLANE, size, np.array([1.0, 2, 3]), np.array([1.0, 1, 0]))) == 0
