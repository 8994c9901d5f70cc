"""The voxels that a closed mesh holds."""

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Flags
from lightcube.optics.grid import Grid
from lightcube.solids.mesh import Mesh


def held_by(mesh: Mesh, grid: Grid) -> Flags:
    """``(z, y, x)``: the voxels whose middles a closed mesh holds, in mm around the block's middle.

    Raises
    ------
    InputError
        Where the mesh is open.
    """
    from lightcube.kernels import carving  # here: the compiler comes with it

    if not mesh.is_watertight:
        raise InputError(f"a mesh with {mesh.bad_edges} open or doubled edges holds nothing: close it first")
    halves = (np.array(grid.shape) - 1) / 2
    corners = mesh.triangles[:, :, ::-1] / grid.sides_mm[::-1] + halves
    crossed = np.zeros((grid.shape[0] + 1, *grid.shape[1:]), np.bool_)
    carving.cross(np.ascontiguousarray(corners), crossed)
    return np.asarray(np.logical_xor.accumulate(crossed, axis=0)[:-1])
