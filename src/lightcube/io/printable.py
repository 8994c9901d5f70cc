"""Meshes as files that are printed: written by suffix, and read back before they get their names."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.io._3mf import read_3mf, write_3mf
from lightcube.io._files import Writer
from lightcube.io._obj import read_obj, write_obj
from lightcube.io._ply import read_ply, write_ply
from lightcube.io._stl import read_stl, write_stl
from lightcube.solids.mesh import Mesh

#: How much of its volume a mesh may lose to a file's digits.
_SAME_VOLUME = 1e-6
#: By suffix what makes bytes of a mesh, and faces of such bytes.
_FORMATS: dict[str, tuple[Callable[[Mesh], bytes], Callable[[bytes], tuple[list[NDArray[np.float64]], str]]]] = {
    ".stl": (write_stl, read_stl),
    ".3mf": (write_3mf, read_3mf),
    ".obj": (write_obj, read_obj),
    ".ply": (write_ply, read_ply),
}


def read_written(path: Path) -> Mesh:
    """The mesh of a file that this package wrote, vertices at the very same place being one."""
    (triangles,), _ = _FORMATS[path.suffix.lower()][1](path.read_bytes())
    return Mesh.of_triangles(triangles.astype(np.float32).astype(np.float64))  # of a text's digits no more are meant


def _writer(suffix: str) -> Writer:
    """The writer of meshes of a suffix; what it wrote is read back, and is the mesh."""

    def write(path: Path, mesh: Mesh) -> None:
        path.write_bytes(_FORMATS[suffix][0](mesh))
        _check_same(path, mesh)

    return write


def _check_same(path: Path, mesh: Mesh) -> None:
    """Raise `InputError` where a file lost what matters of a mesh: its volume, or that it is closed."""
    try:
        read = read_written(path)
        same = abs(read.volume_mm3 - mesh.volume_mm3) <= _SAME_VOLUME * abs(mesh.volume_mm3)
        same = same and len(read) == len(mesh) and (read.is_watertight or not mesh.is_watertight)
    except (ValueError, IndexError):  # two vertices of a face are one
        same = False
    if not same:
        raise InputError(
            f"{path.name} cannot hold this mesh: files count with seven digits, and its finest faces need more: "
            "make it coarser, or move it nearer to the origin"
        )


WRITERS = {suffix: _writer(suffix) for suffix in _FORMATS}
