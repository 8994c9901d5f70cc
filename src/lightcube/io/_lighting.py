"""The lighting of a stage as plain JSON, in cubes and in what is kept of an unfinished one."""

import math
from dataclasses import fields
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from lightcube.optics.rig import Lighting

_Number = Annotated[float, Field(allow_inf_nan=False)]
_Pair = Annotated[list[_Number | None], Field(min_length=2, max_length=2)]
_Count = Annotated[int, Field(ge=0)]


class LightingJson(BaseModel):
    """`lightcube.optics.rig.Lighting`, one list per array; infinity, which JSON has not, is null."""

    model_config = ConfigDict(extra="forbid", strict=True)

    picture: list[_Count]
    lamp: list[_Count]
    share: list[list[Annotated[_Number, Field(ge=0)]]]
    reach_mm: list[_Pair]
    falloff_mm: list[_Pair]
    full_at_mm: list[_Number | None]
    disc_deg: list[_Number]
    cosine: list[bool]
    turning: list[Annotated[list[bool], Field(min_length=2, max_length=2)]]
    way: list[_Pair]
    axis: Annotated[list[_Number], Field(min_length=3, max_length=3)]
    angle: list[_Number]
    screen: list[_Count]
    window: list[Annotated[list[_Count], Field(min_length=2, max_length=2)]]
    least: list[_Number]
    most: list[_Number]
    lamp_names: list[str]
    screen_names: list[str]

    def lighting(self) -> Lighting:
        """Return the same as arrays; `InputError` where they do not fit each other."""
        return Lighting(**{name: _infinite(value) for name, value in self.model_dump().items()})


def lighting_to_json(lighting: Lighting | None) -> dict[str, Any] | None:
    """`lighting` as plain JSON values; every number comes back bit for bit."""
    if lighting is None:
        return None
    return {each.name: _finite(np.asarray(getattr(lighting, each.name)).tolist()) for each in fields(lighting)}


def _finite(value: Any) -> Any:
    if isinstance(value, list):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and math.isinf(value) else value


def _infinite(value: Any) -> Any:
    if isinstance(value, list):
        return [_infinite(item) for item in value]
    return math.inf if value is None else value
