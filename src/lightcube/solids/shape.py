"""A shape: an opaque object in a block, and the silhouettes that it is to cast."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from dataclasses import field as made_by
from functools import cached_property
from typing import Any

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Flags, Volume, copied, keep, locked
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.solids import projections
from lightcube.solids.field import check_stands, hull_field
from lightcube.solids.mesh import Mesh
from lightcube.solids.silhouettes import FINE, Silhouettes
from lightcube.solids.surface import surface


@dataclass(frozen=True, eq=False)
class Shape:
    """An opaque object in a block of voxels.

    Parameters
    ----------
    field
        ``(z, y, x)``: voxels from each one's middle to the surface, below 0 inside, never 0.
    grid
        The block.
    silhouettes
        What it was made for, on their rig.
    provenance
        How it was made.

    Raises
    ------
    InputError
        Where shapes disagree, a number is not finite or 0, or nothing is inside.
    """

    field: Volume
    grid: Grid
    silhouettes: Silhouettes
    provenance: Mapping[str, Any] = made_by(default_factory=dict)

    def __post_init__(self) -> None:
        check_fields(self)
        keep(self, field=np.float32)
        if self.field.shape != self.grid.shape:
            raise InputError(
                f"the field of a shape in {self.grid!r} has shape {self.field.shape}, not {self.grid.shape}"
            )
        if not np.all(np.isfinite(self.field)) or np.any(self.field == 0):
            raise InputError("the field of a shape holds zeros, NaN or infinities: every voxel is inside or outside")
        check_stands(self.field)
        projections.check_rig(self.rig, self.grid)
        object.__setattr__(self, "provenance", copied(self.provenance))

    def __repr__(self) -> str:
        nz, ny, nx = self.grid.shape
        return f"<shape in {nz} x {ny} x {nx} voxels for {len(self.silhouettes)} silhouettes>"

    @property
    def rig(self) -> Rig:
        """Lamps and screens of the silhouettes."""
        return self.silhouettes.rig

    @property
    def names(self) -> tuple[str, ...]:
        """Of the silhouettes."""
        return self.silhouettes.names

    @property
    def inside(self) -> Flags:
        """``(z, y, x)``: the voxels that it is made of."""
        return np.asarray(self.field < 0)

    @cached_property
    def mesh(self) -> Mesh:
        """Its surface, in mm around the block's middle."""
        return surface(self.field, self.grid)


@checked
def hull(silhouettes: Silhouettes, grid: Grid) -> Shape:
    """The visual hull: the largest object whose shadows stay within the silhouettes (A. Laurentini, 1994).

    A pixel of a silhouette that it does not cast, no object casts.

    Raises
    ------
    InputError
        Where the silhouettes leave nothing, or the block stands in a lamp's way.

    Examples
    --------
    >>> import numpy as np
    >>> import lightcube as lc
    >>> grid = lc.Grid((12, 12, 12))
    >>> square = np.pad(np.zeros((8, 8, 3)), ((2, 2), (2, 2), (0, 0)), constant_values=1)
    >>> three = lc.Pictures([square] * 3, ["front", "side", "top"])
    >>> cube = lc.hull(lc.silhouettes(lc.cut(three), lc.walls(grid).rig()), grid)
    >>> cube, int(cube.inside.sum())
    (<shape in 12 x 12 x 12 voxels for 3 silhouettes>, 512)
    >>> cube.mesh.is_watertight
    True
    """
    return Shape(hull_field(silhouettes, grid), grid, silhouettes)


@checked
def as_cube(shape: Shape, extinction: float = 10.0) -> Cube:
    """Black glass of a shape, for all that takes cubes: its voxels fade light by `extinction`, 1/mm, others not.

    What was wanted are its silhouettes, black on white.
    """
    if not 0 < extinction < 1e6:
        raise InputError(f"the extinction of black glass lies above 0 and below 1e6 per mm, not {extinction:g}")
    glass = np.zeros((3, *shape.grid.shape), np.float32)
    glass[:, shape.inside] = extinction
    rows, columns = shape.rig.picture_shape
    small = shape.silhouettes.inside.reshape(len(shape.silhouettes), rows, FINE, columns, FINE)
    wanted = np.full((len(small), rows, columns, 4), 65535, np.uint16)
    wanted[..., :3] = np.rint(65535 * (1 - small.mean(axis=(2, 4))))[..., None]
    wanted[..., 3] *= shape.rig.inside
    return Cube(
        locked(glass),
        shape.grid,
        shape.rig,
        targets=locked(wanted),
        names=shape.names,
        transfer="linear",
        provenance=shape.provenance,
    )
