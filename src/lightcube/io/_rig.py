"""A rig as plain JSON, in cubes and in what is kept of an unfinished one."""

import math
from dataclasses import fields
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from lightcube.optics.glass import Glass
from lightcube.optics.rig import Rig
from lightcube.optics.tables import Fading, Lamps, Screens, Stops, Sums, Turning
from lightcube.optics.views import Views

_Number = Annotated[float, Field(allow_inf_nan=False)]
_Pair = Annotated[list[_Number | None], Field(min_length=2, max_length=2)]
_Three = Annotated[list[_Number], Field(min_length=3, max_length=3)]
_Count = Annotated[int, Field(ge=0)]
_STRICT = ConfigDict(extra="forbid", strict=True)


class _ViewsJson(BaseModel):
    """`lightcube.optics.views.Views`, one list per view."""

    model_config = _STRICT

    lamps: list[Annotated[list[_Number], Field(min_length=4, max_length=4)]]
    origins_mm: list[_Three]
    column_steps_mm: list[_Three]
    row_steps_mm: list[_Three]
    picture_shape: Annotated[list[Annotated[int, Field(ge=1)]], Field(min_length=2, max_length=2)]


class _SumsJson(BaseModel):
    model_config = _STRICT

    picture: list[_Count]
    lamp: list[_Count]
    share: list[list[Annotated[_Number, Field(ge=0)]]]
    disc_deg: list[_Number]


class _FadingJson(BaseModel):
    model_config = _STRICT

    reach_mm: list[_Pair]
    falloff_mm: list[_Pair]
    full_at_mm: list[_Number | None]
    cosine: list[bool]
    veil: list[_Number] = []


class _TurningJson(BaseModel):
    model_config = _STRICT

    turns: list[Annotated[list[bool], Field(min_length=2, max_length=2)]]
    way: list[_Pair]
    axis: _Three


class _StopsJson(BaseModel):
    model_config = _STRICT

    angle_deg: list[_Number]
    screen: list[_Count]
    window: list[Annotated[list[_Count], Field(min_length=2, max_length=2)]]
    films: list[list[Annotated[list[_Number], Field(min_length=7, max_length=7)]]] = []


class _LampsJson(BaseModel):
    model_config = _STRICT

    names: list[str]
    least: list[_Number]
    most: list[_Number]


class _ScreensJson(BaseModel):
    model_config = _STRICT

    names: list[str]
    black: list[_Number]
    endless: list[bool]


class _GlassJson(BaseModel):
    model_config = _STRICT

    ior: Annotated[list[_Number], Field(min_length=1, max_length=3)]
    form: Literal["block", "cylinder", "sphere", "bath", "round-bath"]
    bottom: Literal["open", "blocked"]
    bath_mm: _Number | None
    size_mm: Annotated[list[_Number | None], Field(min_length=3, max_length=3)]


class RigJson(BaseModel):
    """`lightcube.optics.rig.Rig`, one list per array; infinity, which JSON has not, is null."""

    model_config = _STRICT

    views: _ViewsJson
    sums: _SumsJson
    fading: _FadingJson
    turning: _TurningJson
    stops: _StopsJson
    lamps: _LampsJson
    screens: _ScreensJson
    glass: _GlassJson | None = None

    def rig(self) -> Rig:
        """Return the same as arrays; `InputError` where they do not fit each other."""
        said = {name: _infinite(part) for name, part in self.model_dump(exclude={"glass"}).items()}
        views = said["views"]
        made = Views(**{**views, "picture_shape": tuple(views["picture_shape"])})
        return Rig(
            made,
            Sums(**said["sums"]),
            Fading(**{**said["fading"], "veil": np.array(said["fading"]["veil"], np.float64)}),
            Turning(**said["turning"]),
            Stops(**{**said["stops"], "films": np.array(said["stops"]["films"], np.float64)}),
            Lamps(**said["lamps"]),
            Screens(**said["screens"]),
            None if self.glass is None else _glass(self.glass),
        )


def rig_to_json(rig: Rig) -> dict[str, Any]:
    """`rig` as plain JSON values; every number comes back bit for bit."""
    tables = (each.name for each in fields(rig) if each.name != "glass")
    said = {name: _plain(getattr(rig, name)) for name in tables}
    return said if rig.glass is None else said | {"glass": _finite_glass(rig.glass)}


def _finite_glass(glass: Glass) -> dict[str, Any]:
    """A glass that is around a grid as plain JSON."""
    return {each.name: _finite(_listed(getattr(glass, each.name))) for each in fields(glass)}


def _listed(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def _glass(said: _GlassJson) -> Glass:
    """The same as a value."""
    x, y, z = (math.inf if side is None else side for side in said.size_mm)
    return Glass(tuple(said.ior), said.form, said.bottom, said.bath_mm, (x, y, z))


def _plain(part: Any) -> dict[str, Any]:
    arrays = {each.name: np.asarray(getattr(part, each.name)) for each in fields(part)}
    return {name: _finite(array.tolist()) for name, array in arrays.items() if not _is_usual(name, array)}


def _is_usual(name: str, array: NDArray[Any]) -> bool:
    """Whether an array says nothing: squares are never kept, films where they lie as usual, and veils of nothing."""
    return name == "square" or (name == "films" and array.size == 0) or (name == "veil" and not array.any())


def _finite(value: Any) -> Any:
    if isinstance(value, list):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and math.isinf(value) else value


def _infinite(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _infinite(item) for name, item in value.items()}
    if isinstance(value, list):
        return [_infinite(item) for item in value]
    return math.inf if value is None else value
