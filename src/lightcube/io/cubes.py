"""Writers and readers of cubes, by suffix."""

import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from lightcube.errors import InputError
from lightcube.io import _metadata
from lightcube.io._files import PARTIAL_SUFFIX, suffix_entry, system_errors
from lightcube.io._places import Place, child, fetched, name_of, place, read_bytes
from lightcube.io._zarr import read_zarr, read_zarr_zip, write_zarr, write_zarr_zip
from lightcube.optics.cube import Cube


def bare_name(path: str | Path) -> str:
    """Name of a cube's file without its suffix; `InputError` where there is none."""
    name = name_of(place(path))
    if not name:
        raise InputError(f"{str(path)!r} names no cube: give a file or folder that ends with {', '.join(_FORMATS)}")
    found = [suffix for suffix in (*_FORMATS, PARTIAL_SUFFIX) if name.lower().endswith(suffix)]
    return bare_name(name[: -len(max(found, key=len))]) if found and name.lower() not in found else name


def read_cube(path: str | Path) -> Cube:
    """The cube of a file that `lightcube.io.save` wrote.

    Raises
    ------
    InputError
        Where there is no such file, it is no light cube, it is damaged, or a newer version wrote it.
    """
    at = place(path)
    suffix_entry(at, _FORMATS, "a cube")
    with fetched(at) as local:
        return _read(local)


def _read(path: Path) -> Cube:
    """The cube of a file or folder on this disk."""
    read, _ = suffix_entry(path, _FORMATS, "a cube")
    with system_errors(path, "reading"):
        there, is_folder = path.exists(), path.is_dir()
    if not there:
        raise InputError(f"there is no {path}: give the file of a light cube")
    if is_folder != (read is read_zarr):
        raise InputError(f"{path} is a {'folder' if is_folder else 'file'}, and no cube of that suffix is one")
    return read(path)


def _write_npz(path: Path, cube: Cube) -> None:
    """Write NumPy's archive."""
    arrays: dict[str, Any] = {"extinction": cube.extinction, "lightcube": np.array(json.dumps(_metadata.to_json(cube)))}
    if cube.targets is not None:
        arrays["targets"] = cube.targets
    with path.open("wb") as file:
        np.savez(file, **arrays)


def _read_npz(path: Path) -> Cube:
    """Read NumPy's archive."""
    try:
        with (
            system_errors(path, "reading"),
            path.open("rb") as file,
            np.lib.npyio.NpzFile(file, allow_pickle=False) as arrays,
        ):
            document = json.loads(str(arrays["lightcube"])) if "lightcube" in arrays else None
            _metadata.check_version(path, document)
            if "extinction" not in arrays:
                raise _metadata.damaged(path, "its array 'extinction' is missing")
            extinction = arrays["extinction"]
            targets = arrays["targets"] if "targets" in arrays else None  # noqa: SIM401 - not a mapping with get
    except InputError:
        raise
    except MemoryError as error:
        raise InputError(f"{path} does not fit into this machine's memory: open it on a larger one") from error
    # NotImplementedError is what zipfile raises for a way of compression that it does not know
    except (ValueError, EOFError, zipfile.BadZipFile, KeyError, RecursionError, NotImplementedError) as error:
        raise _metadata.damaged(path, " ".join(str(error).split())[:100]) from error
    return _metadata.from_json(path, document, extinction, targets)


def is_cube_folder(path: Place) -> bool:
    """Whether a folder holds a light cube, and may therefore be replaced by another one."""
    try:
        document = json.loads(read_bytes(child(path, "zarr.json")) or b"")
        return "lightcube" in document["attributes"]
    except (OSError, ValueError, KeyError, TypeError):
        return False


_FORMATS: dict[str, tuple[Callable[[Path], Cube], Callable[[Path, Cube], None]]] = {
    ".zarr": (read_zarr, write_zarr),
    ".zarr.zip": (read_zarr_zip, write_zarr_zip),
    ".npz": (_read_npz, _write_npz),
}

WRITERS = {suffix: write for suffix, (_, write) in _FORMATS.items()}
