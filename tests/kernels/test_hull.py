"""Triangles that are drawn for small pictures of meshes."""

import itertools

import numpy as np
import pytest

from lightcube.kernels.hull import shade_triangles

SHAPE = (5, 7)


def drawn(corners: np.ndarray, bright: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    depth, out = np.full(SHAPE, -np.inf), np.zeros(SHAPE)
    shade_triangles(corners, bright, faces, depth, out)
    return depth, out


@pytest.mark.parametrize("seed", range(5))
def test_what_is_drawn_is_linear_between_corners_and_the_nearest_in_front(seed: int) -> None:
    """Each pixel by itself, from the triangles that it lies in, in whatever order and sense they are given."""
    random = np.random.default_rng(seed)
    corners = random.uniform((-2, -2, 0), (8, 6, 1), (6, 3))
    bright, faces = random.random(6), np.array(list(itertools.combinations(range(6), 3))[::3])
    depth, out = drawn(corners, bright, faces)
    for row, column in np.ndindex(SHAPE):
        met = [(-np.inf, 0.0)]
        for face in faces:
            system = np.vstack([corners[face, :2].T, np.ones(3)])
            parts = np.linalg.solve(system, [column, row, 1.0])
            if np.all(parts >= 0):
                met.append((parts @ corners[face, 2], parts @ bright[face]))
        assert (depth[row, column], out[row, column]) == pytest.approx(max(met), abs=1e-9)
    assert 0 < np.mean(np.isfinite(depth)) < 1
    again = drawn(corners, bright, random.permutation(faces)[:, [2, 1, 0]])
    np.testing.assert_allclose(again, (depth, out), atol=1e-12)


def test_a_triangle_that_is_a_line_is_not_drawn() -> None:
    corners = np.array([[0.0, 0, 1], [6, 4, 1], [3, 2, 1]])
    depth, out = drawn(corners, np.ones(3), np.array([[0, 1, 2]]))
    assert not np.any(np.isfinite(depth))
    assert not np.any(out)
