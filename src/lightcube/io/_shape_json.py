"""What a shape's file says besides its two arrays: one JSON document, checked when it is read."""

from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from lightcube.errors import InputError
from lightcube.io._metadata import plain
from lightcube.io._rig import RigJson, rig_to_json
from lightcube.optics.arrays import locked
from lightcube.optics.grid import Grid
from lightcube.solids.shape import Shape
from lightcube.solids.silhouettes import Silhouettes

#: Of the files that this version writes and reads.
FORMAT_VERSION = 1

_Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class _ShapeJson(BaseModel):
    """Everything of `lightcube.solids.shape.Shape` that is no large array."""

    model_config = ConfigDict(extra="forbid", strict=True)

    format_version: Literal[1]
    kind: Literal["shape"]
    written_by: str
    voxel_mm: _Positive
    tall: _Positive = 1.0
    rig: RigJson
    names: list[str]
    provenance: dict[str, Any]


def to_json(shape: Shape) -> dict[str, Any]:
    """`shape` without its arrays as plain JSON values; every number comes back bit for bit."""
    return {
        "format_version": FORMAT_VERSION,
        "kind": "shape",
        "written_by": f"lightcube {version('lightcube')}",
        "voxel_mm": shape.grid.voxel_mm,
        "tall": shape.grid.tall,
        "rig": rig_to_json(shape.rig),
        "names": plain(shape.names),
        "provenance": plain(shape.provenance),
    }


def check_version(path: Path, document: object) -> Mapping[str, Any]:
    """Return `document`, or raise `InputError` unless it is a shape's, in a format that this version reads."""
    if not isinstance(document, Mapping) or document.get("kind") != "shape":
        raise InputError(f"{path} is no shape: give a folder that lightcube hull wrote")
    found = document.get("format_version")
    if isinstance(found, int) and found > FORMAT_VERSION:
        raise InputError(
            f"{path} is in format {found} of a newer lightcube, and this one reads up to {FORMAT_VERSION}: "
            "update lightcube"
        )
    return document


def from_json(path: Path, document: object, field: NDArray[Any], given: NDArray[Any] | None) -> Shape:
    """Build the shape again; `InputError` naming `path` and the key where the document cannot be right."""
    try:
        said = _ShapeJson.model_validate(check_version(path, document))
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise damaged(path, f"{key}: {first['msg'][0].lower()}{first['msg'][1:]}") from error
    if field.dtype != np.float32 or len(field) != 1:
        raise damaged(path, f"its field is {field.dtype} of shape {field.shape}, not float32 of one channel")
    if given is None or given.dtype != np.uint8 or given.shape[3] != 1 or given.max() > 1:
        raise damaged(path, "its silhouettes are missing, or not zeros and ones of uint8")
    try:
        _, nz, ny, nx = field.shape
        grid = Grid((nz, ny, nx), said.voxel_mm, said.tall)
        silhouettes = Silhouettes(locked(given[..., 0].astype(np.bool_)), said.rig.rig(), tuple(said.names))
        return Shape(locked(field[0]), grid, silhouettes, said.provenance)
    except Exception as error:  # InputError among them, and whatever NumPy makes of numbers that no array holds
        raise damaged(path, str(error)) from error


def damaged(path: Path, what: str) -> InputError:
    """Return the exception for a file that is a shape's but not whole."""
    return InputError(f"{path} is a damaged shape ({what}): get another copy or make it again")
