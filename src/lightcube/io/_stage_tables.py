"""The tables of stage files, as pydantic checks them: what may be said of a room, its lamps, screens and pictures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from lightcube.errors import InputError
from lightcube.optics.glass import Bottom, Form
from lightcube.optics.transfer import decode
from lightcube.optics.views import spread_angles
from lightcube.pictures.fitting import Fit
from lightcube.scene.description import AtLeastZero, Count, Line, Number, Point, Positive, hex_colour
from lightcube.wording import counted


def _light(value: Any) -> Any:
    """An sRGB colour such as ``"#ffeedd"`` in linear light; anything else as it is, for the next check."""
    colour = hex_colour(value)
    return colour if colour is value else tuple(decode(np.array(colour)).tolist())


Name = Annotated[Line, Field(max_length=64)]
Flag = Annotated[bool, Field(strict=True)]
Light = Annotated[Point, BeforeValidator(_light)]


class Table(BaseModel):
    """A table: no other keys, and no number that becomes another."""

    model_config: ClassVar[ConfigDict] = ConfigDict(extra="forbid", frozen=True, defer_build=True)

    def said(self) -> dict[str, Any]:
        """The keys that the file gives; what it leaves out has the default of what is made of them."""
        return {key: getattr(self, key) for key in self.model_fields_set}


class CubeTable(Table):
    """The cube: `shape` in voxels ``(z, y, x)``, `size_mm` along its longest side, how tall its slices are.

    `clear` is what its clearest voxel takes of the light, 1/mm, one number or one of each colour; `veil` what part of a
    lamp's light it lays evenly over the screens.
    """

    shape: tuple[Count, Count, Count]
    size_mm: Positive = 100.0
    slices_tall: Count = 1
    turns: Flag = True
    clear: AtLeastZero | tuple[AtLeastZero, AtLeastZero, AtLeastZero] = 0.0
    veil: Number = 0.0


class TurntableTable(Table):
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


class GlassTable(Table):
    """What bends the light, as `lightcube.optics.glass.Glass`, which checks what its numbers may be."""

    ior: Number | tuple[Number, Number, Number] = 1.5
    form: Form = "block"
    bottom: Bottom = "open"
    bath_mm: Number | None = None


class LampTable(Table):
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


class ScreenTable(Table):
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


class WantedTable(Table):
    """A file of a picture or more, or a folder of them; what they are called, and how they are fitted."""

    file: Line
    name: Name | None = None
    fit: Fit = "crop"

    def names_of(self, read: tuple[str, ...]) -> Sequence[str]:
        """What pictures that were read with these names are called."""
        if self.name is None:
            return read
        return [self.name] if len(read) == 1 else [f"{self.name} {number + 1}" for number in range(len(read))]


class PictureTable(WantedTable):
    """One picture for the stop number `stop`, or several for it and the following ones, or one each for `stops`."""

    screen: Name
    lamps: tuple[Name, ...] | None = None
    stop: Count = 1
    stops: Annotated[tuple[Count, ...], Field(min_length=1)] | None = None

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


class StageFile(Table):
    """A whole stage file."""

    cube: CubeTable
    turntable: TurntableTable = TurntableTable()
    lamp: tuple[LampTable, ...] = ()
    screen: tuple[ScreenTable, ...] = ()
    picture: tuple[PictureTable, ...] = ()
    glass: GlassTable | None = None
