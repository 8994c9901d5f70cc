"""Meshes: volume, closedness, standing, and what is no mesh."""

import itertools
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.solids.mesh import Mesh

CORNERS = np.array(list(itertools.product((0.0, 2.0), (0.0, 3.0), (-1.0, 4.0))))
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
FACES = np.array([(q[0], q[i], q[i + 1]) for q in QUADS for i in (1, 2)])


def test_a_box_is_closed_and_holds_what_it_should() -> None:
    box = Mesh(CORNERS, FACES)
    assert box.is_watertight
    assert box.volume_mm3 == pytest.approx(30)
    assert box.size_mm == pytest.approx((2, 3, 5))
    assert Mesh(CORNERS + 1e4, FACES).volume_mm3 == pytest.approx(30)
    assert Mesh(CORNERS, FACES[:, ::-1]).volume_mm3 == pytest.approx(-30)


def test_it_stands_on_zero() -> None:
    standing = Mesh(CORNERS, FACES).standing()
    assert standing.vertices_mm[:, 2].min() == 0
    np.testing.assert_array_equal(standing.vertices_mm[:, :2], CORNERS[:, :2])
    assert standing.size_mm == pytest.approx((2, 3, 5))


@pytest.mark.parametrize(
    ("faces", "bad"),
    [
        (FACES[1:], 3),  # a hole
        (np.concatenate([FACES[:1, ::-1], FACES[1:]]), 3),  # a face that is turned round
        (np.concatenate([FACES, FACES]), 18),  # everything twice
    ],
)
def test_edges_that_are_not_run_through_once_each_way_are_counted(faces: NDArray[Any], bad: int) -> None:
    mesh = Mesh(CORNERS, faces)
    assert mesh.bad_edges == bad
    assert not mesh.is_watertight


def test_two_boxes_that_touch_along_an_edge_are_not_one_closed_mesh() -> None:
    """Where their vertices are the same; as two bodies they are."""
    apart = Mesh(np.concatenate([CORNERS, CORNERS + np.array([2.0, 3.0, 0.0])]), np.concatenate([FACES, FACES + 8]))
    assert apart.is_watertight
    assert Mesh.of_triangles(apart.triangles).bad_edges == 1


def test_triangles_become_a_mesh_again() -> None:
    box = Mesh(CORNERS, FACES)
    again = Mesh.of_triangles(box.triangles)
    assert len(again.vertices_mm) == 8
    np.testing.assert_array_equal(again.triangles, box.triangles)


@pytest.mark.parametrize(
    ("vertices", "faces", "said"),
    [
        (CORNERS, np.zeros((0, 3), int), r"faces of a mesh must be numbers of shape \(count, 3\), not \(0, 3\)"),
        (CORNERS[:, :2], FACES, "vertices_mm of a mesh must be"),
        (CORNERS * np.nan, FACES, "not finite"),
        (CORNERS, FACES + 1, "not among its 8"),
        (CORNERS, FACES - 1, "not among its 8"),
        (CORNERS, [[0, 1, 1]], "names a vertex twice"),
    ],
)
def test_what_is_no_mesh_is_refused(vertices: Any, faces: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        Mesh(vertices, faces)
