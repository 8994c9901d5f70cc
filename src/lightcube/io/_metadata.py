"""What a cube's file says besides its arrays: one JSON document, checked when it is read."""

import math
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict, Field, ValidationError

from lightcube.errors import InputError, encodable
from lightcube.io import _older
from lightcube.io._blocks import BlockJson, block_to_json
from lightcube.io._rig import RigJson, rig_to_json
from lightcube.optics.arrays import locked
from lightcube.optics.cube import Cube, Status
from lightcube.optics.dyes import Dyes
from lightcube.optics.transfer import Transfer

#: Of the files that this version writes; earlier ones are told as this one when they are read (`lightcube.io._older`).
FORMAT_VERSION = 5

#: What to do with files of this package that are no cubes.
_NO_CUBES = {
    "shape": "let its name end with .shape.zarr",
    "relief": "lightcube play, score and info take it, lightcube.read_relief reads it",
}

_Number = Annotated[float, Field(allow_inf_nan=False)]
_Strict = ConfigDict(extra="forbid", strict=True)


class _CubeJson(BlockJson):
    """Everything of `lightcube.optics.cube.Cube` that is no large array."""

    model_config = _Strict

    format_version: Literal[5]
    written_by: str
    extinction_unit: Literal["1/mm"]
    rig: RigJson
    lamp_powers: list[list[Annotated[_Number, Field(gt=0)]]]
    names: list[str]
    transfer: Transfer
    status: Status
    hold_deg: Annotated[_Number, Field(ge=0, le=180)] = 0.0
    dyes: dict[str, Any] | None = None
    scores: dict[str, Any]
    provenance: dict[str, Any]


def to_json(cube: Cube) -> dict[str, Any]:
    """`cube` without its arrays as plain JSON values; every number comes back bit for bit."""
    return {
        "format_version": FORMAT_VERSION,
        "written_by": f"lightcube {version('lightcube')}",
        "extinction_unit": "1/mm",
        **block_to_json(cube.grid),
        "rig": rig_to_json(cube.rig),
        "lamp_powers": cube.powers.tolist(),
        "names": plain(cube.names),
        "transfer": cube.transfer,
        "status": cube.status,
        "hold_deg": float(cube.hold_deg),
        **({} if cube.dyes is None else {"dyes": cube.dyes.plain()}),
        "scores": plain(cube.scores),
        "provenance": plain(cube.provenance),
    }


def plain(value: Any) -> Any:
    """`value` in JSON's own types; NaN and infinities, which JSON has not, become null."""
    if isinstance(value, Mapping):
        return {encodable(str(key)): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, list | tuple | set):
        return [plain(item) for item in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value if value is None or isinstance(value, bool | int) else encodable(str(value))


def from_json(
    path: Path,
    document: object,
    extinction: NDArray[Any],
    targets: NDArray[Any] | None,
    amounts: NDArray[Any] | None = None,
) -> Cube:
    """Build the cube again; `InputError` naming `path` and the key where the document cannot be right.

    Arrays may be of wider types than they were written as: other programs rewrite them so.
    """
    said_of = check_version(path, document)
    if targets is not None:
        targets = _narrowed(path, "targets", targets, _older.targets_dtype(said_of))
    newest, targets = _newest(path, said_of, targets)
    try:
        said = _CubeJson.model_validate(newest)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise damaged(path, f"{key}: {first['msg'][0].lower()}{first['msg'][1:]}") from error
    if extinction.ndim != 4:
        raise damaged(path, f"extinction has {extinction.ndim} axes, not 4")
    extinction = _narrowed(path, "extinction", extinction, np.dtype(np.float32))
    if amounts is not None:
        amounts = _narrowed(path, "amounts", amounts, np.dtype(np.float32))
    try:
        return Cube(
            extinction,
            said.block(extinction.shape[1:]),
            said.rig.rig(),
            np.array(said.lamp_powers, dtype=np.float64),
            targets,
            tuple(said.names),
            said.transfer,
            said.scores,
            said.provenance,
            said.status,
            said.hold_deg,
            amounts,
            None if said.dyes is None else Dyes(**said.dyes),
        )
    except Exception as error:  # InputError among them, and whatever NumPy makes of numbers that no array holds
        raise damaged(path, str(error)) from error


def _narrowed(path: Path, name: str, array: NDArray[Any], dtype: np.dtype[Any]) -> NDArray[Any]:
    """An array as the `dtype` that it was written as; `InputError` where its numbers are none of those."""
    if array.dtype == dtype:
        return array
    alike = array.dtype.itemsize in (dtype.itemsize, 4, 8)  # levels of 8 bits do not pass for those of 16
    if alike and array.dtype.kind in ("f" if dtype.kind == "f" else "iu"):
        with np.errstate(over="ignore"):  # what overflows is no longer finite, and is told so
            same = array.astype(dtype)
        if dtype.kind == "f" or np.array_equal(same, array):
            return locked(same)
    raise damaged(path, f"{name} is an array of {array.dtype}, and its numbers are not those of {dtype}")


def _newest(
    path: Path, document: Mapping[str, Any], targets: NDArray[Any] | None
) -> tuple[dict[str, Any], NDArray[Any] | None]:
    """The document and the targets as the newest format has them; `InputError` where they are not as their own says."""
    try:
        return _older.newest(document, targets)
    except (LookupError, TypeError, ValueError, AttributeError) as error:
        detail = f"{type(error).__name__}: {' '.join(str(error).split())[:100]}"
        raise damaged(path, f"it is not as format {document['format_version']} was, {detail}") from error


def check_version(path: Path, document: object) -> Mapping[str, Any]:
    """Return `document`, or raise `InputError` unless it is a light cube's, in a format that this version reads."""
    if isinstance(document, Mapping) and (kind := document.get("kind", "cube")) != "cube":
        raise InputError(f"{path} is a {kind}, no cube: {_NO_CUBES.get(str(kind), 'give a cube')}")
    if not isinstance(document, Mapping) or "format_version" not in document:
        raise InputError(f"{path} is no light cube: it has no lightcube metadata, give a file that lightcube wrote")
    found = document["format_version"]
    if isinstance(found, int) and found > FORMAT_VERSION:
        raise InputError(
            f"{path} is in format {found} of a newer lightcube, and this one reads up to {FORMAT_VERSION}: "
            "update lightcube"
        )
    if isinstance(found, int) and found < _older.FIRST:
        raise InputError(f"{path} is in format {found}, which no lightcube wrote: get another copy or make it again")
    if _older.has_cut_pixels(document):
        raise InputError(
            f"{path} was solved for pixels that an earlier lightcube cut into parts, and this one averages light over "
            "each pixel by itself: make it again"
        )
    return document


def damaged(path: Path, what: str) -> InputError:
    """Return the exception for a file that is a light cube's but not whole."""
    return InputError(f"{path} is a damaged light cube ({what}): get another copy or make it again")
