"""Cubes that are still being made: loading and publishing them."""

import warnings
from pathlib import Path

from lightcube.errors import InputError
from lightcube.io._files import PARTIAL_SUFFIX
from lightcube.io._places import Place, name_of, place
from lightcube.io.cubes import check_cube_target, read_cube, save
from lightcube.optics.cube import Cube


class UnfinishedCube(UserWarning):
    """A cube that was loaded is a partial one, or its solver was stopped early."""


def load(path: str | Path) -> Cube:
    """Load a cube from a file that `save` wrote, or from a ``.partial`` folder of one that is being made.

    Of the latter there is what is finished, the state of the unit that is being solved, and for the rest what it
    would start from.

    Warns
    -----
    UnfinishedCube
        Where the cube is a partial one, or its solver was stopped early.

    Raises
    ------
    InputError
        Where there is no such file, it is no light cube, it is damaged, or a newer version wrote it.
    """
    at = place(path)
    partial = name_of(at).lower().endswith(PARTIAL_SUFFIX)
    cube = _load_partial(at) if partial else read_cube(path)
    if partial or cube.status != "complete":
        why = "it is still being made" if partial else "its solver was stopped early"
        warnings.warn(f"the cube {path} is unfinished: {why}", UnfinishedCube, stacklevel=2)
    return cube


def _load_partial(at: Place) -> Cube:
    """The cube of what there is of an unfinished one; all that makes cubes loads with the first of them."""
    from lightcube.backward.solution import merged
    from lightcube.jobs.partial import DiskStore, load_job

    store = DiskStore(at)
    if store.is_empty():
        raise InputError(f"{at} has nothing of a cube in it yet: start again without it")
    return merged(load_job(at), store).cube


def publish(partial: str | Path, *, overwrite: bool = False) -> Place:
    """Turn ``NAME.zarr.partial`` (or ``NAME.zarr.zip.partial``, ``NAME.npz.partial``) into NAME, and return NAME.

    What there is of it, as `load` puts it together, is saved under its name, with the status ``"interrupted"`` unless
    all is finished; then the partial folder is removed.

    Raises
    ------
    InputError
        Where there is no such folder, nothing of a cube in it, or NAME exists and `overwrite` is not asked for;
        the partial folder is kept then.
    """
    from lightcube.jobs.partial import discard_partial, published_path

    out = published_path(partial)
    cube = _load_partial(place(partial))
    check_cube_target(out, overwrite=overwrite)
    save(cube, out, overwrite=overwrite)
    discard_partial(out)
    return out
