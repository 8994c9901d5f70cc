"""Stage files of films: a stack instead of a cube, lamps or moves, and the pictures that are wanted."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from lightcube.errors import InputError
from lightcube.io._stage_tables import Flag, LampTable, Name, Table, WantedTable
from lightcube.optics.attenuator import Films, attenuator, snapped
from lightcube.optics.material import Material
from lightcube.optics.moves import Move
from lightcube.optics.stage import Lamp, Stage
from lightcube.optics.sun import sunlight
from lightcube.pictures.pictures import Pictures
from lightcube.scene.description import Count, Line, Number, Positive

#: Indices of refraction of what is often between films.
_MEDIA = {"air": 1.0, "acrylic": 1.49, "glass": 1.52}


def _as_index(value: Any) -> Any:
    """The index of refraction of what is known by name; anything else as it is, for the next check."""
    return _MEDIA.get(value, value) if isinstance(value, str) else value


def _as_list(value: Any) -> Any:
    """A number as a list of one; anything else as it is."""
    return [value] if isinstance(value, int | float) else value


def _as_pairs(value: Any) -> Any:
    """A pair of numbers as a list of one; anything else as it is."""
    is_pair = isinstance(value, list) and value and all(isinstance(each, int | float) for each in value)
    return [value] if is_pair else value


class StackTable(Table):
    """The films: how many and how far apart or where, how large and fine the pictures, what is between, how dark."""

    films: Count | None = None
    gap_mm: Annotated[Number, Field(ge=0)] | None = None
    heights_mm: Annotated[tuple[Number, ...], Field(min_length=1)] | None = None
    size_mm: Positive = 160.0
    pixels: Count = 32
    cells_per_pixel: Count = 2
    medium: Annotated[Number, Field(ge=1, le=3), BeforeValidator(_as_index)] = 1.0
    screen_mm: Annotated[Number, Field(ge=0)] | None = None
    max_density: Positive | None = None
    faces_deg: Number = 180.0
    tilt_deg: Number = 0.0
    snap: Flag = False

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        if self.heights_mm is not None and (self.films is not None or self.gap_mm is not None):
            raise PydanticCustomError("heights_mm", "heights_mm says what films and gap_mm say: use one of the two")
        return self

    def stack(self) -> Films:
        """The same as a value; `InputError` where a number is out of its range."""
        said: dict[str, Any] = {"count": self.films, "gap_mm": self.gap_mm, "heights_mm": self.heights_mm}
        return Films(
            size_mm=self.size_mm,
            pixels=self.pixels,
            cells_a_pixel=self.cells_per_pixel,
            index=self.medium,
            screen_mm=self.screen_mm,
            **{name: value for name, value in said.items() if value is not None},
        )


class SunTable(Table):
    """The sun at a place and time, as `lightcube.optics.sun.sunlight` takes it."""

    latitude_deg: Number
    day: Line
    hour: Number


class FilmLampTable(LampTable):
    """A lamp, which may be the sun."""

    sun: SunTable | None = None

    def lamp(self, stack: StackTable) -> Lamp:
        """The same as a value."""
        said = self.said()
        sun = said.pop("sun", None)
        if sun is None:
            return Lamp(**said)
        if "direction" in said or "position_mm" in said:
            raise InputError(f"lamp {self.name!r}: sun says where its light comes from: leave direction out")
        way = sunlight(sun.latitude_deg, sun.day, sun.hour, stack.faces_deg, stack.tilt_deg)
        return Lamp(**said, direction=(float(way[0]), float(way[1]), float(way[2])))


class MoveTable(Table):
    """How films lie for pictures that name it, as `lightcube.optics.moves.Move`; or how one of them does."""

    name: Name
    film: Count | None = None
    order: tuple[Count, ...] = ()
    shift_mm: Annotated[tuple[tuple[Number, Number], ...], BeforeValidator(_as_pairs)] = ()
    turn_deg: Annotated[tuple[Number, ...], BeforeValidator(_as_list)] = ()

    def move(self, count: int) -> Move:
        """The same as a value, of so many films."""
        if self.film is None:
            for key, values in (("order", self.order), ("shift_mm", self.shift_mm), ("turn_deg", self.turn_deg)):
                if values and len(values) != count:
                    raise InputError(f"move {self.name!r}: {key} is of {len(values)} films, and the stack has {count}")
            return Move(self.name, self.order, self.shift_mm, self.turn_deg)
        if not 1 <= self.film <= count:
            raise InputError(f"move {self.name!r}: there is no film {self.film}: the stack has {count}")
        if max(len(self.shift_mm), len(self.turn_deg)) > 1:
            raise InputError(f"move {self.name!r}: shift_mm and turn_deg are of film {self.film} alone: give one each")
        shifts, turns = [(0.0, 0.0)] * count, [0.0] * count
        shifts[self.film - 1] = (*self.shift_mm, (0.0, 0.0))[0]
        turns[self.film - 1] = (*self.turn_deg, 0.0)[0]
        return Move(self.name, self.order, tuple(shifts), tuple(turns))


class FilmPictureTable(WantedTable):
    """A picture, or a folder of them; its lamp or lamps, and its move, where they are said."""

    lamp: Name | None = None
    lamps: tuple[Name, ...] | None = None
    move: Name | None = None

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        if self.lamp is not None and self.lamps is not None:
            raise PydanticCustomError("lamp", "lamp and lamps are both given: use one of the two")
        return self

    @property
    def lit(self) -> tuple[str, ...] | None:
        """Names of the lamps, None where nothing is said."""
        return self.lamps if self.lamp is None else (self.lamp,)


class AttenuatorFile(Table):
    """A whole stage file of films."""

    stack: StackTable
    lamp: tuple[FilmLampTable, ...] = ()
    move: tuple[MoveTable, ...] = ()
    picture: tuple[FilmPictureTable, ...] = ()


def attenuator_of(said: AttenuatorFile, tables: Sequence[FilmPictureTable], pictures: Pictures) -> Stage:
    """The room of a stack, for pictures of which each is of one of the `tables`."""
    films = said.stack.stack()
    lamps = tuple(table.lamp(said.stack) for table in said.lamp)
    lamps = snapped(lamps, films) if said.stack.snap else lamps
    moves = {table.name: table.move(len(films.heights)) for table in said.move}
    if len(moves) < len(said.move):
        raise InputError("two moves have the same name: give each a name of its own")
    for number, table in enumerate(tables, 1):
        if table.move is not None and table.move not in moves:
            known = ", ".join(moves) or "none"
            raise InputError(f"picture {number}: there is no move {table.move!r}: the file has {known}")
    lit = [table.lit for table in tables]
    if any(each is None for each in lit) and any(each is not None for each in lit):
        raise InputError(f"picture {lit.index(None) + 1}: lamp is missing: say it of all pictures, or of none")
    rows, columns = pictures.images[0].shape[:2]
    stage = attenuator(
        pictures.names,
        films,
        columns / rows,
        lamps=lamps,
        lit=[each for each in lit if each is not None],
        moves=[None if table.move is None else moves[table.move] for table in tables] if moves else [],
    )
    density = said.stack.max_density
    return stage if density is None else replace(stage, material=Material(density * math.log(10), "voxel"))
