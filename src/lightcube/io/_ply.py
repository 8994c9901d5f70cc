"""Meshes as binary PLY."""

import re

import numpy as np
from numpy.typing import NDArray

from lightcube.solids.mesh import Mesh

_FACE = np.dtype([("count", "u1"), ("corners", "<i4", 3)])
_HEAD = """ply
format binary_little_endian 1.0
comment lengths are millimetres, z is up
element vertex {vertices}
property float x
property float y
property float z
element face {faces}
property list uchar int vertex_indices
end_header
"""


def write_ply(mesh: Mesh) -> bytes:
    """A mesh as the bytes of a PLY file, coordinates as float32."""
    faces = np.empty(len(mesh.faces), _FACE)
    faces["count"], faces["corners"] = 3, mesh.faces
    head = _HEAD.format(vertices=len(mesh.vertices_mm), faces=len(faces))
    return head.encode() + mesh.vertices_mm.astype("<f4").tobytes() + faces.tobytes()


def read_ply(data: bytes) -> NDArray[np.float64]:
    """Triangles ``(faces, 3, 3)`` of a PLY file that `write_ply` made."""
    head, body = data.split(b"end_header\n", 1)
    count, faces = (int(number) for number in re.findall(rb"element \w+ (\d+)", head))
    corners = np.frombuffer(body, "<f4", 3 * count).reshape(-1, 3).astype(np.float64)
    return np.asarray(corners[np.frombuffer(body, _FACE, faces, offset=12 * count)["corners"]])
