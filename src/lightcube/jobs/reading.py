"""Loading a cube, whole or still being made."""

from __future__ import annotations

import warnings
from pathlib import Path

from lightcube.io._files import PARTIAL_SUFFIX
from lightcube.io._places import Place, name_of, place
from lightcube.io.cubes import read_cube
from lightcube.io.shapes import is_shape, read_shape
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.solids.shape import as_cube


class UnfinishedCube(UserWarning):
    """A cube that was loaded is a partial one, or its solver was stopped early."""


@checked
def load(path: str | Path) -> Cube:
    """Load a cube from a file that `lightcube.io.save` wrote, or from a ``.partial`` folder of one that is being made.

    Of a shape, ``NAME.shape.zarr``, it is black glass that casts the same shadows. Of a partial cube there is what is
    finished, the state of the unit that is being solved, and for the rest what it would start from.

    Warns
    -----
    UnfinishedCube
        Where the cube is a partial one, or its solver was stopped early.

    Raises
    ------
    InputError
        Where there is no such file, it is no light cube, it is damaged, or a newer version wrote it.
    """
    if is_shape(path):
        return as_cube(read_shape(path))
    at = place(path)
    partial = name_of(at).lower().endswith(PARTIAL_SUFFIX)
    cube = _load_partial(at) if partial else read_cube(path)
    if partial or cube.status != "complete":
        why = "it is still being made" if partial else "its solver was stopped early"
        warnings.warn(f"the cube {path} is unfinished: {why}", UnfinishedCube, stacklevel=3)
    return cube


def _load_partial(at: Place) -> Cube:
    """The cube of what there is of an unfinished one."""
    from lightcube.backward.solution import merged  # here: who loads what is whole waits for none of it
    from lightcube.jobs.partial import begun_store, load_job

    store = begun_store(at)
    return merged(load_job(at), store).cube
