"""What arrays stand in the folders that lightcube writes: found in small ones, which are written to be looked at."""

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import zarr
from marked import table

import lightcube as lc
from lightcube.solids.silhouettes import FINE

#: Voxels ``(z, y, x)`` of the small ones, and how many pictures they have.
_SHAPE, _PICTURES = (2, 3, 4), 2


def _room() -> tuple[lc.Grid, lc.Rig, tuple[str, ...]]:
    grid = lc.Grid(_SHAPE)
    return grid, lc.turntable(grid, lc.spread_angles(_PICTURES)), tuple("ab")


def _cube() -> lc.Cube:
    grid, rig, names = _room()
    dyes = lc.read_dyes("polyjet")
    amounts = np.zeros((len(dyes.names), *_SHAPE), np.float32)
    return lc.Cube(
        dyes.mixed(amounts),
        grid,
        rig,
        targets=np.zeros((_PICTURES, *rig.picture_shape, 4), np.uint16),
        names=names,
        amounts=amounts,
        dyes=dyes,
    )


def _shape() -> lc.Shape:
    grid, rig, names = _room()
    rows, columns = (FINE * each for each in rig.picture_shape)
    given = lc.Silhouettes(np.ones((_PICTURES, rows, columns), np.bool_), rig, names)
    return lc.Shape(-np.ones(_SHAPE, np.float32), grid, given)


def _relief() -> lc.Relief:
    recipe = lc.ReliefRecipe(side=8)
    flat = np.zeros((8, 8))
    return lc.Relief(flat, np.full((_PICTURES, 8, 8), 0.5), recipe, tuple("ab"))


_WRITTEN: dict[str, tuple[str, Callable[[], Any]]] = {
    "cube": ("a.zarr", _cube),
    "shape": ("a.shape.zarr", _shape),
    "relief": ("a.relief.zarr", _relief),
}


def arrays(kind: str) -> list[str]:
    """The section on the arrays of a kind of file; of what has none, nothing."""
    if kind not in _WRITTEN:
        return []
    name, make = _WRITTEN[kind]
    with TemporaryDirectory() as folder:
        place = Path(folder, name)
        lc.save(make(), place)
        group = zarr.open_group(place, mode="r")
        rows = [(f"`{key}`", _axes(array), f"`{array.dtype}`") for key, array in sorted(group.arrays())]
        said: Any = group.attrs["lightcube"]
    keys = ", ".join(f"`{key}`" for key in said)
    return ["## Arrays", table(("array", "axes", "numbers"), rows), f"The attribute `lightcube` has the keys {keys}."]


def _axes(array: Any) -> str:
    """What the axes of an array are called."""
    return f"`({', '.join(array.metadata.dimension_names)})`"
