"""A small picture of a mesh, as lists of files show it."""

import numpy as np
from numpy.typing import NDArray

from lightcube.solids.mesh import Mesh

#: Towards the eye, from the right, the front and above, and towards the lamp, over the right shoulder.
_EYE, _LAMP = np.array([0.62, -0.72, 0.5]), np.array([0.45, -0.5, 0.74])
#: What is turned away from the lamp is so bright, and the colour of what faces it, display levels.
_DARKEST, _COLOUR = 0.3, np.array([242.0, 140.0, 51.0])
#: Pixels that are drawn for each along a side, and the part of a side that stays free.
_FINER, _FREE = 2, 0.06


def portrait(mesh: Mesh, side: int) -> NDArray[np.uint8]:
    """``(side, side, 4)``: display levels and opacity of a mesh, seen from the right, the front and above, far away."""
    from lightcube.kernels import hull  # here: the compiler comes with it

    eye = _EYE / np.linalg.norm(_EYE)
    right = np.cross((0.0, 0.0, 1.0), eye)
    right /= np.linalg.norm(right)
    seen = mesh.vertices_mm @ np.stack([right, -np.cross(eye, right), eye], axis=1)
    low, high = seen.min(axis=0), seen.max(axis=0)
    fine = _FINER * side
    scale = (1 - 2 * _FREE) * fine / max(float(np.max((high - low)[:2])), 1e-9)
    placed = (seen - (low + high) / 2) * scale + ((fine - 1) / 2, (fine - 1) / 2, 0)
    depth, bright = np.full((fine, fine), -np.inf), np.zeros((fine, fine))
    hull.shade_triangles(placed, _brightness(mesh), mesh.faces, depth, bright)
    levels = np.concatenate([bright[..., None] * _COLOUR, 255.0 * np.isfinite(depth)[..., None]], axis=2)
    mean = levels.reshape(side, _FINER, side, _FINER, 4).mean(axis=(1, 3))
    mean[..., :3] /= np.maximum(mean[..., 3:] / 255, 1e-9)  # colours of what is there alone
    return np.rint(np.clip(mean, 0, 255)).astype(np.uint8)


def _brightness(mesh: Mesh) -> NDArray[np.float64]:
    """``(vertices,)``: how much of the lamp each sees, by the faces around it, larger ones counting for more."""
    a, b, c = mesh.triangles.transpose(1, 0, 2)
    normals = np.zeros_like(mesh.vertices_mm)
    np.add.at(normals, mesh.faces, np.cross(b - a, c - a)[:, None])
    lengths = np.maximum(np.linalg.norm(normals, axis=1), 1e-30)
    lit = normals @ (_LAMP / np.linalg.norm(_LAMP)) / lengths
    return np.asarray(_DARKEST + (1 - _DARKEST) * np.clip(lit, 0, 1))
