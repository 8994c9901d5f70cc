"""Reading triangle meshes of any program, by suffix; `lightcube.io.printable` writes meshes."""

import warnings
from collections.abc import Callable
from pathlib import Path, PurePath

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.io._3mf import read_3mf
from lightcube.io._files import system_errors
from lightcube.io._obj import read_obj
from lightcube.io._places import fetched, place
from lightcube.io._ply import read_ply
from lightcube.io._stl import read_stl
from lightcube.optics.arrays import locked
from lightcube.scene.meshes import DoubtfulMesh, is_closed, outward, tidy
from lightcube.scene.polygons import cut_faces
from lightcube.solids.mesh import Mesh

#: Of a file: five million triangles.
_MOST_BYTES = 256 << 20
#: By suffix what makes faces of a file's bytes: ``(faces, corners, 3)`` for each number of corners, and what was left
#: out, if anything. `ValueError` says what is wrong.
_READERS: dict[str, Callable[[bytes], tuple[list[NDArray[np.float64]], str]]] = {
    ".stl": read_stl,
    ".obj": read_obj,
    ".ply": read_ply,
    ".3mf": read_3mf,
}


def is_mesh(path: str | Path) -> bool:
    """Whether a place is named as meshes are."""
    return PurePath(str(path)).suffix.lower() in _READERS


def read_solid(path: str | Path) -> Mesh:
    """The mesh of a file of any program, its numbers taken as mm; corners that nearly coincide are one.

    Raises
    ------
    InputError
        As `read_mesh` does.
    """
    with fetched(place(path)) as local:
        triangles = tidy(read_mesh(local, str(path)), str(path))
    return Mesh.of_triangles(locked(outward(triangles) if is_closed(triangles) else triangles))


def read_mesh(path: Path, where: str) -> NDArray[np.float64]:
    """Triangles ``(n, 3, 3)`` of a mesh file, those of its faces that have more corners cut; `where` says who asked.

    Warns
    -----
    DoubtfulMesh
        Where something in the file is no triangle and was left out.

    Raises
    ------
    InputError
        Where there is no such file, or it is not what its suffix says, or it holds no triangle.
    """
    read = _READERS.get(path.suffix.lower())
    if read is None:
        raise InputError(f"{where}: {path.name} is no mesh: use a file ending in {', '.join(_READERS)}")
    if not path.is_file():
        raise InputError(f"{where}: there is no file {path}: check its name")
    try:
        with system_errors(path, "reading"):
            if path.stat().st_size > _MOST_BYTES:
                raise InputError(f"{where}: {path.name} is larger than {_MOST_BYTES >> 20} MiB: make the mesh coarser")
            faces, left_out = read(path.read_bytes())
        triangles = np.concatenate([cut_faces(each) for each in faces]) if faces else np.zeros((0, 3, 3))
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{where}: {path.name} cannot be read as a mesh ({error}): export it again") from error
    except MemoryError as error:
        raise InputError(f"{where}: {path.name} does not fit into this machine's memory: make it smaller") from error
    if not len(triangles):
        raise InputError(f"{where}: {path.name} holds no triangles: give a mesh of at least one")
    if left_out:
        warnings.warn(f"{where}: {path.name} holds {left_out}, which were left out", DoubtfulMesh, stacklevel=4)
    return triangles
