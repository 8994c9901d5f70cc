"""Saving and loading cubes, by suffix."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from lightcube.errors import InputError
from lightcube.io._files import PARTIAL_SUFFIX, check_free, suffix_entry, system_errors, written_whole
from lightcube.io._places import Place, child, fetched, name_of, place, read_bytes
from lightcube.optics.cube import Cube

Given = TypeVar("Given", bound=str | Path)
Format = tuple[Callable[[Path], Cube], Callable[[Path, Cube], None]]

#: What the name of a cube may end with.
_SUFFIXES = (".zarr", ".zarr.zip", ".npz")


def bare_name(path: str | Path) -> str:
    """Name of a cube's file without its suffix; `InputError` where there is none."""
    name = name_of(place(path))
    if not name:
        raise InputError(f"{str(path)!r} names no cube: give a file or folder that ends with {', '.join(_SUFFIXES)}")
    found = [suffix for suffix in (*_SUFFIXES, PARTIAL_SUFFIX) if name.lower().endswith(suffix)]
    return bare_name(name[: -len(max(found, key=len))]) if found and name.lower() not in found else name


def check_cube_target(path: str | Path, *, overwrite: bool = False) -> None:
    """Raise `InputError` unless `save` could write to `path`: ask before long work."""
    at = place(path)
    _suffix(at)
    check_free(at, overwrite=overwrite, replaceable=_is_cube_folder)


def save(cube: Cube, path: Given, *, overwrite: bool = False) -> Given:
    """Save a cube by the suffix of `path`; the file appears when it is whole.

    Parameters
    ----------
    path
        ``.zarr`` (a folder, OME-Zarr 0.5: napari and others open it as it is), ``.zarr.zip`` (the same in one
        file), or ``.npz`` (NumPy's own: `extinction`, `targets`, and the rest as JSON in `lightcube`). It may be a
        URL such as ``s3://bucket/cube.zarr``.
    overwrite
        Whether an existing file, or an existing folder with a cube in it, is replaced.

    Returns
    -------
    `path`.

    Raises
    ------
    InputError
        Where the suffix is unknown, the target exists, or the disk is full. Nothing is left behind.

    Notes
    -----
    All arrays and numbers come back bit for bit. `scores` and `provenance` come back as JSON's types: tuples as
    lists, NaN and infinities as None, anything that JSON does not know as its text.
    """
    at = place(path)
    _, write = _format(_suffix(at))
    with written_whole(at, overwrite=overwrite, replaceable=_is_cube_folder) as fresh:
        write(fresh, cube)
    return path


def read_cube(path: str | Path) -> Cube:
    """The cube of a file that `save` wrote.

    Raises
    ------
    InputError
        Where there is no such file, it is no light cube, it is damaged, or a newer version wrote it.
    """
    at = place(path)
    _suffix(at)
    with fetched(at) as local:
        return _read(local)


def _read(path: Path) -> Cube:
    """The cube of a file or folder on this disk."""
    suffix = _suffix(path)
    with system_errors(path, "reading"):
        there, is_folder = path.exists(), path.is_dir()
    if not there:
        raise InputError(f"there is no {path}: give the file of a light cube")
    if is_folder != (suffix == ".zarr"):
        raise InputError(f"{path} is a {'folder' if is_folder else 'file'}, and no cube of that suffix is one")
    read, _ = _format(suffix)
    return read(path)


def _is_cube_folder(path: Place) -> bool:
    """Whether a folder holds a light cube, and may therefore be replaced by another one."""
    try:
        document = json.loads(read_bytes(child(path, "zarr.json")) or b"")
        return "lightcube" in document["attributes"]
    except (OSError, ValueError, KeyError, TypeError):
        return False


def _suffix(at: Place) -> str:
    """The suffix of a cube's name, or `InputError`."""
    return suffix_entry(at, {suffix: suffix for suffix in _SUFFIXES}, "a cube")


def _format(suffix: str) -> Format:
    """How cubes of a suffix are read and written; what does so loads with the first of them."""
    if suffix == ".npz":
        from lightcube.io._npz import read_npz, write_npz

        return read_npz, write_npz
    from lightcube.io import _zarr

    if suffix == ".zarr":
        return _zarr.read_zarr, _zarr.write_zarr
    return _zarr.read_zarr_zip, _zarr.write_zarr_zip
