"""Stage files: a room with lamps, screens and a turntable, and the pictures that are wanted on the screens."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import ErrorDetails, PydanticCustomError

from lightcube.errors import InputError
from lightcube.io._files import system_errors
from lightcube.io._toml import read_tables
from lightcube.io.pictures import read_pictures
from lightcube.optics.checks import checked
from lightcube.optics.grid import Grid
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.optics.transfer import Transfer, check_transfer, decode
from lightcube.optics.views import doubt_angles, spread_angles
from lightcube.pictures.fitting import Fit, fit
from lightcube.pictures.pictures import Pictures
from lightcube.pictures.targets import Targets
from lightcube.scene.description import Count, Line, Number, Point, Positive, hex_colour, sentence
from lightcube.wording import counted

_LISTS = ("lamp", "screen", "picture")


def _light(value: Any) -> Any:
    """An sRGB colour such as ``"#ffeedd"`` in linear light; anything else as it is, for the next check."""
    colour = hex_colour(value)
    return colour if colour is value else tuple(decode(np.array(colour)).tolist())


Name = Annotated[Line, Field(max_length=64)]
Flag = Annotated[bool, Field(strict=True)]
Light = Annotated[Point, BeforeValidator(_light)]


class _Table(BaseModel):
    model_config: ClassVar[ConfigDict] = ConfigDict(extra="forbid", frozen=True, defer_build=True)

    def said(self) -> dict[str, Any]:
        """The keys that the file gives; what it leaves out has the default of what is made of them."""
        return {key: getattr(self, key) for key in self.model_fields_set}


class CubeTable(_Table):
    """The cube: `shape` in voxels ``(z, y, x)``, `size_mm` along its longest side, how tall its slices are."""

    shape: tuple[Count, Count, Count]
    size_mm: Positive = 100.0
    slices_tall: Count = 1
    turns: Flag = True


class TurntableTable(_Table):
    """Where the table stops: at the angles `stops_deg`, or `count` times, spread evenly over the whole turn."""

    stops_deg: Annotated[tuple[Number, ...], Field(min_length=1)] = (0.0,)
    count: Count | None = None
    axis: Point = (0.0, 0.0, 1.0)

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        if {"stops_deg", "count"} <= self.model_fields_set:
            raise PydanticCustomError("stops_deg", "stops_deg and count are both given: use one of the two")
        return self

    @property
    def angles_deg(self) -> tuple[float, ...]:
        """Of the stops, degrees."""
        return self.stops_deg if self.count is None else tuple(spread_angles(self.count, 360.0).tolist())


class LampTable(_Table):
    """A lamp, as `lightcube.optics.stage.Lamp`, which checks what its numbers may be."""

    name: Name
    direction: Point | None = None
    position_mm: Point | None = None
    colour: Light | None = None
    power: Number | None = None
    power_max: Number | None = None
    turns: Flag | None = None
    size_deg: Number | None = None
    reach_mm: Number | None = None
    falloff_mm: Number | None = None
    full_at_mm: Number | None = None

    @model_validator(mode="after")
    def _fixed_or_free(self) -> Self:
        if {"power", "power_max"} <= self.model_fields_set:
            raise PydanticCustomError("power", "power and power_max are both given: use one of the two")
        return self


class ScreenTable(_Table):
    """A screen, as `lightcube.optics.stage.Screen`; `pitch_mm` is the cube's voxel side where it is left out."""

    name: Name
    centre_mm: Point
    size_mm: tuple[Number, Number]
    pitch_mm: Number | None = None
    normal: Point | None = None
    up: Point | None = None
    rear: Flag | None = None
    turns: Flag | None = None
    reach_mm: Number | None = None
    falloff_mm: Number | None = None
    cosine: Flag | None = None
    black: Number | None = None


class PictureTable(_Table):
    """One picture for the stop number `stop`, or several for it and the following ones, or one each for `stops`."""

    file: Line
    screen: Name
    lamps: tuple[Name, ...] | None = None
    stop: Count = 1
    stops: Annotated[tuple[Count, ...], Field(min_length=1)] | None = None
    fit: Fit = "crop"

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        if {"stop", "stops"} <= self.model_fields_set:
            raise PydanticCustomError("stops", "stop and stops are both given: use one of the two")
        return self

    def stops_of(self, count: int, last: int) -> Sequence[int]:
        """Numbers of the stops, from 1 to `last`, of so many pictures; `InputError` where they do not come out."""
        stops = range(self.stop, self.stop + count) if self.stops is None else self.stops
        if len(stops) != count:
            raise InputError(
                f"{self.file} holds {counted(count, 'picture')} for {counted(len(stops), 'stop')}: "
                "give one stop per picture"
            )
        if stops[-1] > last and self.stops is None:
            raise InputError(
                f"{self.file} holds {counted(count, 'picture')} for the stops from {self.stop} on, "
                f"and the last one is {last}: "
                "take out pictures, or add stops"
            )
        return stops


class StageFile(_Table):
    """A whole stage file."""

    cube: CubeTable
    turntable: TurntableTable = TurntableTable()
    lamp: tuple[LampTable, ...] = ()
    screen: tuple[ScreenTable, ...] = ()
    picture: tuple[PictureTable, ...] = ()


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
        shots += [replace(first, name=name, stop=stop - 1) for name, stop in zip(pictures.names, stops, strict=True)]
        images += pictures.images
        opacities += pictures.opacities
        fits += [table.fit] * len(pictures)
    shots = _told_apart(shots)
    named = Pictures(tuple(images), tuple(shot.name for shot in shots), transfer=transfer, opacities=tuple(opacities))
    return replace(stage, shots=tuple(shots)), named, tuple(fits)


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


def _parse(file: Path) -> StageFile:
    """Read and check the tables of a stage file."""
    try:
        return StageFile.model_validate(read_tables(file, file.name))
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
