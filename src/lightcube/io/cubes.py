"""Writers and readers of cubes, by suffix."""

import json
import shlex
from collections.abc import Callable
from pathlib import Path

from lightcube.errors import InputError, encodable
from lightcube.io._bounds import check_file
from lightcube.io._files import (
    PARTIAL_SUFFIX,
    RELIEF_SUFFIX,
    SHAPE_SUFFIX,
    ZIP_SUFFIX,
    Writer,
    suffix_entry,
    system_errors,
)
from lightcube.io._places import Place, child, fetched, name_of, names_in, place, read_bytes
from lightcube.optics.cube import Cube

Format = tuple[Callable[[Path], Cube], Callable[[Path, Cube], None]]

#: What the name of a cube may end with.
_SUFFIXES = (".zarr", ".zarr.zip", ".npz")
#: And that of a mesh, of which no cube can be made.
_MESHES = (".stl", ".3mf", ".obj", ".ply")


def bare_name(path: str | Path) -> str:
    """Name of a cube's file, a shape's or a relief's, without its suffix; `InputError` where there is none."""
    name = name_of(place(path))
    if not name:
        raise InputError(f"{str(path)!r} names no cube: give a file or folder that ends with {', '.join(_SUFFIXES)}")
    kept = (SHAPE_SUFFIX, RELIEF_SUFFIX)
    known = (*_SUFFIXES, *kept, *(suffix + ZIP_SUFFIX for suffix in kept), PARTIAL_SUFFIX)
    found = [suffix for suffix in known if name.lower().endswith(suffix)]
    return bare_name(name[: -len(max(found, key=len))]) if found and name.lower() not in found else encodable(name)


def read_cube(path: str | Path) -> Cube:
    """The cube of a file that `lightcube.io.save` wrote.

    Raises
    ------
    InputError
        Where there is no such file, it is no light cube, it is damaged, or a newer version wrote it.
    """
    at = place(path)
    try:
        _suffix(at)
    except InputError:
        _refuse_other(at)
        raise
    with fetched(at) as local:
        return _read(local)


def _refuse_other(at: Place) -> None:
    """Raise `InputError` where what is given as a cube holds some, is what they are made from, or is a solid's mesh."""
    with system_errors(at, "reading"):
        cubes = _cubes_in(at)
        if cubes:
            raise InputError(f"{at} is a folder, no cube: give a cube that is in it, such as {shlex.quote(cubes[0])}")
        _refuse_pictures(at)
    name = name_of(at)
    if name.lower().endswith(".toml"):
        raise InputError(
            f"{at} is a stage's or a scene's file, no cube: make one first, by lightcube solve, of a scene after trace"
        )
    stem, dot, suffix = name.rpartition(".")
    if dot + suffix.lower() in _MESHES:
        kept = shlex.quote(f"{stem}{SHAPE_SUFFIX}")
        raise InputError(
            f"{at} is a mesh, which holds no lamps and screens: lightcube hull ... -o {kept} keeps them, view that"
        )


def _cubes_in(folder: Place) -> list[str]:
    """Cubes that lie in a folder on this disk, and after them shapes, which stand for cubes."""
    if not (isinstance(folder, Path) and folder.is_dir()):
        return []
    found = [name for name in names_in(folder) if name.lower().endswith(_SUFFIXES)]
    kept = [name for name in found if not name.lower().removesuffix(ZIP_SUFFIX).endswith(RELIEF_SUFFIX)]
    kept.sort(key=lambda name: name.lower().removesuffix(ZIP_SUFFIX).endswith(SHAPE_SUFFIX))
    return [str(folder / name) for name in kept]


def _refuse_pictures(at: Place) -> None:
    """Raise `InputError` where what is given as a cube is pictures: which command makes one, of them if it can."""
    from lightcube.io.pictures import is_pictures, is_several  # here: who reads a cube waits for no reader of pictures

    if not is_pictures(at):
        return
    if is_several(at):
        asked = f"lightcube solve {shlex.quote(str(at))} -o cube.zarr"
        raise InputError(f"{at} is pictures, no cube: make one of them first, as in {asked}")
    raise InputError(
        f"{at} is one picture by its name, no cube: make one of two or more, in a folder of their own, "
        "as in lightcube solve photos -o cube.zarr"
    )


def _read(path: Path) -> Cube:
    """The cube of a file or folder on this disk."""
    suffix = _suffix(path)
    with system_errors(path, "reading"):
        there, is_folder = check_file(path).exists(), path.is_dir()
    if not there:
        raise InputError(f"there is no {path}: give the file of a light cube")
    if is_folder != (suffix == ".zarr"):
        raise InputError(
            f"{path} is a {'folder' if is_folder else 'file'}, and no cube of that suffix is one: get another copy"
        )
    read, _ = _format(suffix)
    return read(path)


def is_cube_folder(path: Place) -> bool:
    """Whether a folder holds a light cube, and may therefore be replaced by another one."""
    try:
        document = json.loads(read_bytes(child(path, "zarr.json")) or b"")
        return "kind" not in document["attributes"]["lightcube"]
    except (OSError, ValueError, KeyError, TypeError):
        return False


def _suffix(at: Place) -> str:
    """The suffix of a cube's name, or `InputError`."""
    return suffix_entry(at, {suffix: suffix for suffix in _SUFFIXES}, "a cube")


def _format(suffix: str) -> Format:
    """How cubes of a suffix are read and written; what does so loads with the first of them."""
    if suffix == ".npz":
        from lightcube.io import _npz

        return _npz.read_npz, _npz.write_npz
    from lightcube.io import _zarr

    return {
        ".zarr": (_zarr.read_zarr, _zarr.write_zarr),
        ".zarr.zip": (_zarr.read_zarr_zip, _zarr.zipped(_zarr.write_zarr)),
    }[suffix]


def _writer(suffix: str) -> Writer:
    """The writer of cubes of a suffix, which loads when there is one to be written."""

    def write(path: Path, cube: Cube) -> None:
        _format(suffix)[1](path, cube)

    return write


WRITERS = {suffix: _writer(suffix) for suffix in _SUFFIXES}
