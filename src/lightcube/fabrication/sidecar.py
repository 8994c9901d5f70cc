"""What is said of an exported file, in JSON beside it: how large it is, which way it lies, what it is to cast.

A file holds extinction, or colours of materials; lamps, screens and all else that a cube knows stand here, so that
what is read back is a cube again.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from lightcube.errors import InputError
from lightcube.fabrication.film_file import FilmFacts
from lightcube.io import _metadata
from lightcube.io._places import Place, beside, child, name_of, read_bytes
from lightcube.optics.arrays import Volume
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid

#: What can be made of a cube.
Kind = Literal["volume", "shell", "points", "polyjet", "schedule", "film"]
#: In a folder of slices the sidecar stands among them: so it goes where they go.
INSIDE = "slices.json"
#: No sidecar of this package is longer: the beams of a large rig, and the names of ten thousand slices.
_LONGEST = 64 << 20
_FORMAT = "lightcube export 1"

_Number = Annotated[float, Field(allow_inf_nan=False)]
_Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
_Count = Annotated[int, Field(ge=1, le=100_000)]


class _Material(BaseModel):
    """One of the materials of slices."""

    model_config = ConfigDict(strict=True)

    name: str
    rgba: Annotated[list[Annotated[int, Field(ge=0, le=255)]], Field(min_length=4, max_length=4)]
    extinction: list[Annotated[float, Field(ge=0, allow_inf_nan=False)]]


class Sidecar(BaseModel):
    """What of a sidecar is used again; there is more in it for people.

    Parameters
    ----------
    files
        The digest (SHA-256) of each file, by name.
    cube
        All that its file says of a cube but its arrays; None where nothing is cast.
    palette
        The materials of slices.
    film
        Where films lie on their pages, and what they are printed with.
    droplets, pitch_mm
        Of slices: how many droplets there are along x, y and z, and their sides.
    made_from, made_from_sha256
        Where the cube was, from the folder that this lies in, and the digest of its extinction.
    """

    model_config = ConfigDict(strict=True)

    format: Literal["lightcube export 1"]
    kind: Kind
    files: dict[str, str]
    flips: str = ""
    prefix: str = ""
    dpi: tuple[_Count, _Count] | None = None
    droplets: dict[Literal["x", "y", "z"], _Count] | None = None
    pitch_mm: dict[Literal["x", "y", "z"], _Positive] | None = None
    palette: list[_Material] | None = None
    film: FilmFacts | None = None
    cube: dict[str, Any] | None = None
    made_from: str | None = None
    made_from_sha256: str = ""
    predicted: dict[str, _Number] | None = None


def place_of(at: Place, *, is_folder: bool) -> Place:
    """Where the sidecar of a file or a folder stands; what is JSON itself is its own."""
    if is_folder:
        return child(at, INSIDE)
    name = name_of(at)
    return at if name.lower().endswith(".json") else beside(at, f"{name}.json")


def read(at: Place) -> Sidecar | None:
    """The sidecar at a place; None where there is none, `InputError` where it is no such thing, or is damaged."""
    data = read_bytes(at)
    if data is None:
        return None
    try:
        if len(data) > _LONGEST:
            raise ValueError
        return Sidecar.model_validate_json(data)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = ".".join(str(part) for part in first["loc"])
        raise InputError(f"{at} is not what lightcube export wrote ({key}: {first['msg']}): export again") from error
    except ValueError as error:
        raise InputError(f"{at} is not what lightcube export wrote: export again") from error


def cube_of(at: Place, document: Mapping[str, Any], volume: Volume, grid: Grid) -> Cube:
    """A cube of what a file holds, and of what its sidecar says of lamps, screens and how it was made."""
    said = {**document, "voxel_mm": grid.voxel_mm, "tall": grid.tall}
    said.pop("dyes", None)
    return _metadata.from_json(Path(str(at)), said, volume, None)


def of_cube(cube: Cube) -> dict[str, Any]:
    """What is said of a cube beside its arrays."""
    return _metadata.to_json(cube)


def opening(kind: Kind) -> dict[str, Any]:
    """What every sidecar begins with."""
    return {"format": _FORMAT, "kind": kind, "written_by": f"lightcube {version('lightcube')}"}


def text(document: Mapping[str, Any]) -> bytes:
    """A sidecar as it is written, a line for each thing that it says."""
    lines = (f"{json.dumps(name)}: {json.dumps(value)}" for name, value in _metadata.plain(document).items())
    return ("{\n" + ",\n".join(lines) + "\n}\n").encode()


def digest(file: Path) -> str:
    """SHA-256 of a file."""
    with file.open("rb") as opened:
        return hashlib.file_digest(opened, "sha256").hexdigest()


def digest_of(cube: Cube) -> str:
    """SHA-256 of a cube's extinction: which cube something was made from."""
    summed = hashlib.sha256(repr(cube.extinction.shape).encode())
    for channel in cube.extinction:
        summed.update(channel.tobytes())
    return summed.hexdigest()


def check_files(at: Place, said: Sidecar, folder: Path) -> None:
    """Raise `InputError` where a file is missing, or is not the one that was written."""
    for name, wanted in said.files.items():
        file = folder / name
        if not file.is_file():
            raise InputError(f"{file} is missing: export again, or --force goes on without it")
        if digest(file) != wanted:
            raise InputError(
                f"{file} is not the file that was exported, its SHA-256 is another than {name_of(at)} says: it was "
                "changed, export again, or --force takes it as it is"
            )
