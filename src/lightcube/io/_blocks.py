"""What a block is made of, as plain JSON, in cubes and in what is kept of an unfinished one."""

from collections.abc import Sequence
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from lightcube.optics.grid import Grid
from lightcube.optics.stack import Stack

_Number = Annotated[float, Field(allow_inf_nan=False)]
_STRICT = ConfigDict(extra="forbid", strict=True)


class _FilmsJson(BaseModel):
    """What `lightcube.optics.stack.Stack` has beside a grid."""

    model_config = _STRICT

    heights_mm: list[_Number]
    index: _Number


class BlockJson(BaseModel):
    """Sides of voxels, or width of cells and heights of films; the shape stands elsewhere."""

    model_config = _STRICT

    voxel_mm: Annotated[_Number, Field(gt=0)]
    tall: Annotated[_Number, Field(gt=0)] = 1.0
    films: _FilmsJson | None = None

    def block(self, shape: Sequence[int]) -> Grid:
        """The block of a shape ``(nz, ny, nx)``; `InputError` where it cannot be."""
        nz, ny, nx = shape
        if self.films is None:
            return Grid((nz, ny, nx), self.voxel_mm, self.tall)
        return Stack((nz, ny, nx), self.voxel_mm, heights_mm=tuple(self.films.heights_mm), index=self.films.index)


def block_to_json(grid: Grid) -> dict[str, Any]:
    """A block as plain JSON values; every number comes back bit for bit."""
    if isinstance(grid, Stack):
        films = {"heights_mm": list(grid.heights_mm), "index": grid.index}
        return {"voxel_mm": grid.voxel_mm, "films": films}
    return {"voxel_mm": grid.voxel_mm, **({} if grid.tall == 1 else {"tall": grid.tall})}
