"""From a field to a closed surface: marching cubes where it is 0."""

import numpy as np

from lightcube.optics.arrays import Volume, locked
from lightcube.optics.grid import Grid
from lightcube.solids.mesh import Mesh


def surface(field: Volume, grid: Grid) -> Mesh:
    """The surface around where a field ``(z, y, x)`` is below 0, closed at the block's faces, in mm around its middle.

    Vertices are numbers that float32 holds, as the files of meshes do. Of a field that is never nearer to 0 than 1/256
    all faces have a size.
    """
    from skimage.measure import marching_cubes  # here: scipy comes with it

    padded = np.pad(field, 1, constant_values=0.5)  # so that what stands at a face ends on it
    corners, faces, _, _ = marching_cubes(padded, 0.0)
    middle = 1 + (np.array(grid.shape) - 1) / 2
    vertices = ((corners - middle)[:, ::-1] * grid.sides_mm).astype(np.float32).astype(np.float64)
    mesh = Mesh(locked(vertices), locked(faces.astype(np.int64)))
    return mesh if mesh.volume_mm3 > 0 else Mesh(mesh.vertices_mm, locked(mesh.faces[:, ::-1].copy()))
