"""Stage files: a room with lamps, screens and a turntable, and the pictures that are wanted on the screens."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError
from pydantic_core import ErrorDetails

from lightcube.errors import InputError
from lightcube.io._attenuators import AttenuatorFile, FilmPictureTable, attenuator_of
from lightcube.io._files import system_errors
from lightcube.io._stage_tables import StageFile
from lightcube.io._toml import read_tables
from lightcube.io.pictures import read_pictures
from lightcube.optics.checks import checked
from lightcube.optics.glass import Glass
from lightcube.optics.grid import Grid
from lightcube.optics.material import Material
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.optics.transfer import Transfer, check_transfer
from lightcube.optics.views import doubt_angles
from lightcube.pictures.fitting import Fit, fit
from lightcube.pictures.pictures import Pictures
from lightcube.pictures.targets import Targets
from lightcube.scene.description import sentence

_LISTS = ("lamp", "screen", "picture", "move")


def is_stage(path: str | Path) -> bool:
    """Whether `path` names a stage file rather than pictures: a file, not a folder, that ends in ``.toml``."""
    file = Path(path)
    with system_errors(file, "reading"):
        return file.suffix.lower() == ".toml" and file.is_file()


@checked
def read_stage(path: str | Path, *, transfer: Transfer = "srgb") -> tuple[Stage, Pictures, tuple[Fit, ...]]:
    """Read a stage file (TOML) and the pictures that it names.

    Parameters
    ----------
    path
        The file. Pictures are looked up relative to it.
    transfer
        How display values of pictures become linear light.

    Returns
    -------
    The stage, the pictures in the order of its shots and with their names, and how each is to be fitted.
    Where pictures have the same name, their screen is added to it, and then their stop.

    Raises
    ------
    InputError
        Where the file or a picture cannot be read, or something in it cannot be: ``name: where: what is wrong``.
    """
    file, transfer = Path(path), check_transfer(transfer)
    said = _parse(file)
    if isinstance(said, AttenuatorFile):
        return _read_attenuator(file, said, transfer)
    with _about(file.name):
        stage = _stage(said)
    doubt_angles(stage.stops_deg, f"{file.name}: turntable: stops_deg", stacklevel=3)
    shots: list[Shot] = []
    images: list[NDArray[np.float32]] = []
    opacities: list[NDArray[np.float32] | None] = []
    fits: list[Fit] = []
    for number, (table, first) in enumerate(zip(said.picture, stage.shots, strict=True), start=1):
        with _about(f"{file.name}: picture {number}"):
            pictures = read_pictures(file.parent / table.file, transfer=transfer, least=1)
            stops = table.stops_of(len(pictures), len(stage.stops_deg))
        named = zip(table.names_of(pictures.names), stops, strict=True)
        shots += [replace(first, name=name, stop=stop - 1) for name, stop in named]
        images += pictures.images
        opacities += pictures.opacities
        fits += [table.fit] * len(pictures)
    shots = _told_apart(shots)
    names = tuple(shot.name for shot in shots)
    given = Pictures(tuple(images), names, transfer=transfer, opacities=tuple(opacities))
    return replace(stage, shots=tuple(shots)), given, tuple(fits)


def _read_attenuator(file: Path, said: AttenuatorFile, transfer: Transfer) -> tuple[Stage, Pictures, tuple[Fit, ...]]:
    """Read the pictures of a stage file of films, which are as wide and high as the first one."""
    read: list[Pictures] = []
    tables: list[FilmPictureTable] = []
    names: list[str] = []
    for number, table in enumerate(said.picture, start=1):
        with _about(f"{file.name}: picture {number}"):
            read.append(read_pictures(file.parent / table.file, transfer=transfer, least=1))
        tables += [table] * len(read[-1])
        names += table.names_of(read[-1].names)
    if not read:
        raise InputError(f"{file.name}: no picture is wanted of these films: name some, [[picture]] file = ...")
    named = Pictures(
        tuple(image for pictures in read for image in pictures.images),
        _numbered(names),
        transfer=transfer,
        opacities=tuple(opacity for pictures in read for opacity in pictures.opacities),
    )
    with _about(file.name):
        return attenuator_of(said, tables, named), named, tuple(table.fit for table in tables)


def _numbered(names: Sequence[str]) -> tuple[str, ...]:
    """Names of which none is used twice."""
    count = Counter(names)
    return tuple(f"{name} ({number})" if count[name] > 1 else name for number, name in enumerate(names, 1))


def stage_pictures(path: str | Path) -> list[Path]:
    """The files and folders of pictures that a stage file names, each once; `InputError` as from `read_stage`."""
    file = Path(path)
    return list(dict.fromkeys(file.parent / table.file for table in _parse(file).picture))


@checked
def read_stage_targets(path: str | Path, *, transfer: Transfer = "srgb") -> tuple[Stage, Targets]:
    """Read a stage file, and raise as `read_stage` does, and fit its pictures to their screens."""
    stage, pictures, fits = read_stage(path, transfer=transfer)
    return stage, fit(pictures, stage.rig(), fits)


@contextmanager
def _about(where: str) -> Iterator[None]:
    """Put `where` in front of what an `InputError` says."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{where}: {error}") from error


def _parse(file: Path) -> StageFile | AttenuatorFile:
    """Read and check the tables of a stage file, of a cube or of films."""
    tables = read_tables(file, file.name)
    try:
        return (AttenuatorFile if "stack" in tables else StageFile).model_validate(tables)
    except ValidationError as error:
        raise InputError(f"{file.name}: {_sentence(error.errors(include_url=False)[0])}") from None


def _sentence(problem: ErrorDetails) -> str:
    """One of pydantic's findings as scene files word it: which table, counted from 1, which key, and its value."""
    place, value, about = problem["loc"], problem["input"], ""
    if place[0] in _LISTS and problem["type"] == "tuple_type" and len(place) == 1:
        return f"{place[0]}: must be a list of tables: begin each with [[{place[0]}]]"
    if place[0] in _LISTS and len(place) > 1:
        about, place = f"{place[0]} {int(place[1]) + 1}: ", place[2:]
    said = about + sentence({**problem, "loc": place})
    small = isinstance(value, str | float) or (isinstance(value, int) and abs(value) < 10**15)
    if problem["type"] == "extra_forbidden" or not small or len(repr(value)) > 60:
        return said
    return f"{said}, not {value!r}"


def _stage(said: StageFile) -> Stage:
    """The stage, with one shot for each table of pictures: whatever can be wrong before they are read."""
    with _about("cube"):
        one_mm = Grid(said.cube.shape, tall=said.cube.slices_tall)
        grid = replace(one_mm, voxel_mm=said.cube.size_mm / one_mm.longest)
    lamps = tuple(Lamp(**table.said()) for table in said.lamp)
    names = tuple(lamp.name for lamp in lamps)
    stage = Stage(
        grid,
        lamps,
        tuple(Screen(**{"pitch_mm": grid.voxel_mm} | table.said()) for table in said.screen),
        tuple(
            Shot(
                table.file,
                table.screen,
                names if table.lamps is None else table.lamps,
                max(table.stops or [table.stop]) - 1,
            )
            for table in said.picture
        ),
        said.turntable.angles_deg,
        said.turntable.axis,
        said.cube.turns,
        Material(clear=said.cube.clear) if said.cube.clear else None,
        None if said.glass is None else Glass(**said.glass.said()),
        said.cube.veil,
    )
    for number, table in enumerate(said.picture, start=1):
        if table.lamps is None and len(names) > 1:
            raise InputError(f"picture {number}: lamps: is missing: say which of {', '.join(names)} are lit")
    return stage


def _told_apart(shots: Sequence[Shot]) -> list[Shot]:
    """Shots whose names differ as far as their screens and stops do."""
    parts: tuple[Callable[[Shot], str], ...] = (
        lambda shot: f"{shot.name} on {shot.screen}",
        lambda shot: f"{shot.name} at stop {shot.stop + 1}",
    )
    told = list(shots)
    for longer in parts:
        count = Counter(shot.name for shot in told)
        told = [replace(shot, name=longer(shot)) if count[shot.name] > 1 else shot for shot in told]
    return told
