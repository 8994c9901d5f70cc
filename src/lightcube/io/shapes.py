"""Shapes as files: a folder that keeps all of one, or the mesh that is printed of it."""

from __future__ import annotations

from pathlib import Path

from lightcube.errors import InputError
from lightcube.io import printable
from lightcube.io._bounds import check_file
from lightcube.io._files import SHAPE_SUFFIX, ZIP_SUFFIX, Writer, suffix_entry, system_errors
from lightcube.io._places import Place, fetched, holds, name_of, place
from lightcube.optics.checks import checked
from lightcube.solids.mesh import Mesh
from lightcube.solids.shape import Shape

_ZIP = SHAPE_SUFFIX + ZIP_SUFFIX


@checked
def read_shape(path: str | Path) -> Shape:
    """The shape of a folder ``NAME.shape.zarr``, or a file ``NAME.shape.zarr.zip``, that `lightcube.save` wrote.

    Raises
    ------
    InputError
        Where there is no such folder or file, it is no shape, it is damaged, or a newer version wrote it.
    """
    from lightcube.io import _zarr  # here: Zarr comes with it

    at = place(path)
    is_folder = suffix_entry(at, {SHAPE_SUFFIX: True, _ZIP: False}, "a shape")
    with fetched(at) as local:
        with system_errors(local, "reading"):
            there = check_file(local).is_dir() if is_folder else check_file(local).is_file()
        if not there:
            what = "folder" if is_folder else "file"
            raise InputError(f"there is no {what} {path}: give one that lightcube hull wrote")
        return _zarr.read_shape(local)


def written_mesh(path: str | Path) -> Mesh:
    """The mesh of a file that was just written: of a shape, or of the printable kind."""
    if is_shape(path):
        return read_shape(path).mesh
    with fetched(place(path)) as local:
        return printable.read_written(local)


def is_shape(path: str | Path) -> bool:
    """Whether a place is named as shapes are."""
    return name_of(place(path)).lower().endswith((SHAPE_SUFFIX, _ZIP))


def is_shape_folder(path: Place) -> bool:
    """Whether a folder holds a shape, and may therefore be replaced by another one."""
    return holds(path, "shape")


def _write(path: Path, shape: Shape) -> None:
    """Write all of a shape."""
    from lightcube.io import _zarr  # here: Zarr comes with it

    _zarr.write_shape(path, shape)


def _write_zip(path: Path, shape: Shape) -> None:
    """Write all of a shape into one file."""
    from lightcube.io import _zarr

    _zarr.zipped(_zarr.write_shape)(path, shape)


def _standing(suffix: str) -> Writer:
    """The writer of a shape's mesh, standing on z = 0."""

    def write(path: Path, shape: Shape) -> None:
        printable.WRITERS[suffix](path, shape.mesh.standing())

    return write


WRITERS = {SHAPE_SUFFIX: _write, _ZIP: _write_zip, **{suffix: _standing(suffix) for suffix in printable.WRITERS}}
