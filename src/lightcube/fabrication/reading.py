"""Exported files read back: what such a file holds, as a cube that casts and is scored like any other."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from lightcube.errors import InputError
from lightcube.fabrication import sidecar
from lightcube.fabrication.film_file import laid, stack_of
from lightcube.fabrication.polyjet import held_of
from lightcube.fabrication.sidecar import Sidecar
from lightcube.fabrication.volumes import FORMATS
from lightcube.io._bounds import check_file
from lightcube.io._files import suffix_entry, system_errors
from lightcube.io._places import Place, beside, exists, fetched, is_folder, name_of, place
from lightcube.optics.arrays import Volume
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid

#: What exported files that cast nothing end with.
_SILENT = {".3mf": "shells", ".ply": "shells or points", ".stl": "a shell", ".csv": "a schedule"}


#: What the name of printed films ends with.
_FILMS = ".pdf"


def is_exported(path: str | Path) -> bool:
    """Whether a place is named as exported volumes and films are, or holds slices, or another thing was exported."""
    at = place(path)
    suffix = _suffix(at)
    if suffix in FORMATS or suffix == _FILMS:
        return True
    if suffix in _SILENT:
        return _is_known(at)
    return isinstance(at, Path) and (at / sidecar.INSIDE).is_file()


def is_film(path: str | Path) -> bool:
    """Whether a place is named as pages of films are."""
    return _suffix(place(path)) == _FILMS


@checked
def read_export(path: str | Path, *, like: Cube | None = None, force: bool = False) -> Cube:
    """Read what an exported volume, a folder of slices or pages of films hold as a cube, without targets.

    Lamps and screens are those that the sidecar says, ``FILE.json`` beside a file and ``slices.json`` in a folder.

    Parameters
    ----------
    like
        The cube that it was made from: where there is no sidecar, its lamps and screens are taken, and it is said how
        large voxels are in a file that does not.
    force
        Take files that were changed since, or are missing, for what they are now.

    Raises
    ------
    InputError
        Where there is no such file, it is another program's, was changed, or holds nothing that casts.
    """
    at = place(path)
    folder, said = is_folder(at), _sidecar_of(at)
    if said is not None and (said.cube is None or said.kind not in ("volume", "polyjet", "film")):
        what = {"shell": "shells cast", "points": "points scatter light and cast"}.get(said.kind, "a schedule casts")
        raise InputError(f"{at}: {what} no picture of the cube, so there is nothing to score or to play: give the cube")
    with fetched(at) as local, system_errors(local, "reading"):
        if said is not None and not force:
            names = local if folder else local.parent
            sidecar.check_files(sidecar.place_of(at, is_folder=folder), said, names)
        if folder:
            return _slices(local, said, force=force)
        return _films(local, at, said) if is_film(path) else _volume(local, at, said, like)


def _slices(folder: Path, said: Sidecar | None, *, force: bool) -> Cube:
    """The cube of a folder of slices."""
    if said is None or said.cube is None:
        raise InputError(
            f"{folder} has no {sidecar.INSIDE}, which says what its colours are of: export the slices again"
        )
    volume, grid = held_of(folder, said).volume(forced=force)
    return sidecar.cube_of(folder, said.cube, volume, grid)


def _films(file: Path, at: Place, said: Sidecar | None) -> Cube:
    """The stack of films that pages hold."""
    if not check_file(file).is_file():
        raise InputError(f"there is no {at}: give a file that lightcube export wrote")
    if said is None or said.cube is None or said.film is None:
        raise InputError(
            f"{at} does not say how high its films lie and which lamps are for them, and there is no "
            f"{name_of(sidecar.place_of(at, is_folder=False))} beside it that does: keep both together, or export again"
        )
    films = said.cube["films"]
    volume, stack, off_mm = stack_of(file, said.film, tuple(films["heights_mm"]), films["index"])
    return laid(sidecar.cube_of(at, said.cube, volume, stack), off_mm)


def _volume(file: Path, at: Place, said: Sidecar | None, like: Cube | None) -> Cube:
    """The cube of a file that holds a volume."""
    _, read = suffix_entry(at, FORMATS, "an exported volume")
    if not check_file(file).is_file():
        raise InputError(f"there is no {at}: give a file that lightcube export wrote")
    volume, grid = read(file)
    if said is not None and said.cube is not None:
        document = said.cube
    elif like is not None:
        document = sidecar.of_cube(like)
    else:
        missing = name_of(sidecar.place_of(at, is_folder=False))
        raise InputError(
            f"{at} does not say which lamps and screens it is for, and there is no {missing} beside it: name the cube "
            "that it was made from too"
        )
    return sidecar.cube_of(at, document, volume, grid or _grid_of(document, volume))


def _grid_of(document: Mapping[str, Any], volume: Volume) -> Grid:
    """The grid of a volume whose file does not say how large voxels are."""
    _, nz, ny, nx = volume.shape
    return Grid((nz, ny, nx), document["voxel_mm"], document.get("tall", 1.0))


def _suffix(at: Place) -> str:
    """The suffix of a name, in small letters."""
    _, dot, suffix = name_of(at).rpartition(".")
    return dot + suffix.lower()


def _sidecar_of(at: Place) -> Sidecar | None:
    """The sidecar of a folder of slices, or of a file that it knows; None where there is none."""
    if is_folder(at):
        return sidecar.read(sidecar.place_of(at, is_folder=True))
    said = sidecar.read(sidecar.place_of(at, is_folder=False))
    return said if said is not None and name_of(at) in said.files else None


def _is_known(at: Place) -> bool:
    """Whether a file is one that a sidecar knows."""
    try:
        return _sidecar_of(at) is not None
    except InputError:
        return False


def predicted(path: str | Path) -> float | None:
    """The mean PSNR that a file was to have when it was exported, if it was scored then."""
    said = _sidecar_of(place(path))
    return None if said is None or said.predicted is None else said.predicted.get("psnr_mean")


def original(path: str | Path) -> tuple[Place, str] | None:
    """Where the cube is that something was made from, and the digest of its extinction then; None where it is gone."""
    at = place(path)
    said = _sidecar_of(at)
    if said is None or said.made_from is None:
        return None
    found = beside(at, said.made_from)
    return (found, said.made_from_sha256) if exists(found) else None
