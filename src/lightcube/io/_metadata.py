"""What a cube's file says besides its two arrays: one JSON document, checked when it is read."""

import math
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from lightcube.errors import InputError
from lightcube.io._rig import RigJson, rig_to_json
from lightcube.optics.cube import Cube, Status
from lightcube.optics.grid import Grid
from lightcube.optics.transfer import Transfer

#: Of the files that this version writes; it reads no earlier ones, which were never released.
FORMAT_VERSION = 5

_Number = Annotated[float, Field(allow_inf_nan=False)]
_Strict = ConfigDict(extra="forbid", strict=True)


class _CubeJson(BaseModel):
    """Everything of `lightcube.optics.cube.Cube` that is no large array."""

    model_config = _Strict

    format_version: Literal[5]
    written_by: str
    extinction_unit: Literal["1/mm"]
    voxel_mm: Annotated[_Number, Field(gt=0)]
    rig: RigJson
    lamp_powers: list[list[Annotated[_Number, Field(gt=0)]]]
    names: list[str]
    transfer: Transfer
    status: Status
    hold_deg: Annotated[_Number, Field(ge=0, le=180)] = 0.0
    scores: dict[str, Any]
    provenance: dict[str, Any]


def to_json(cube: Cube) -> dict[str, Any]:
    """`cube` without its arrays as plain JSON values; every number comes back bit for bit."""
    return {
        "format_version": FORMAT_VERSION,
        "written_by": f"lightcube {version('lightcube')}",
        "extinction_unit": "1/mm",
        "voxel_mm": cube.grid.voxel_mm,
        "rig": rig_to_json(cube.rig),
        "lamp_powers": cube.powers.tolist(),
        "names": list(cube.names),
        "transfer": cube.transfer,
        "status": cube.status,
        "hold_deg": float(cube.hold_deg),
        "scores": plain(cube.scores),
        "provenance": plain(cube.provenance),
    }


def plain(value: Any) -> Any:
    """`value` in JSON's own types; NaN and infinities, which JSON has not, become null."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, list | tuple | set):
        return [plain(item) for item in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value if value is None or isinstance(value, bool | int | str) else str(value)


def from_json(
    path: Path, document: object, extinction: NDArray[np.float32], targets: NDArray[np.uint16] | None
) -> Cube:
    """Build the cube again; `InputError` naming `path` and the key where the document cannot be right."""
    check_version(path, document)
    try:
        said = _CubeJson.model_validate(document)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise damaged(path, f"{key}: {first['msg'][0].lower()}{first['msg'][1:]}") from error
    if extinction.dtype != np.float32 or extinction.ndim != 4:
        raise damaged(path, f"extinction is {extinction.dtype} with {extinction.ndim} axes, not float32 with 4")
    try:
        _, nz, ny, nx = extinction.shape
        return Cube(
            extinction,
            Grid((nz, ny, nx), said.voxel_mm),
            said.rig.rig(),
            np.array(said.lamp_powers, dtype=np.float64),
            targets,
            tuple(said.names),
            said.transfer,
            said.scores,
            said.provenance,
            said.status,
            said.hold_deg,
        )
    except ValueError as error:  # InputError among them
        raise damaged(path, str(error)) from error


def check_version(path: Path, document: object) -> None:
    """Raise `InputError` unless `document` is a light cube's, in a format that this version knows."""
    if not isinstance(document, Mapping) or "format_version" not in document:
        raise InputError(f"{path} is no light cube: it has no lightcube metadata, give a file that lightcube wrote")
    found = document["format_version"]
    if isinstance(found, int) and found < FORMAT_VERSION:
        raise InputError(f"{path} is in format {found} of a lightcube that was never released: make it again")
    if isinstance(found, int) and found > FORMAT_VERSION:
        raise InputError(
            f"{path} is in format {found} of a newer lightcube, and this one reads up to {FORMAT_VERSION}: "
            "update lightcube"
        )


def damaged(path: Path, what: str) -> InputError:
    """Return the exception for a file that is a light cube's but not whole."""
    return InputError(f"{path} is a damaged light cube ({what}): get another copy or make it again")
