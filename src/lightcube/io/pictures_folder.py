"""A folder of pictures: natural order, and `views.toml` with the angles they are to be seen at."""

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from lightcube.errors import InputError, encodable
from lightcube.io._files import system_errors
from lightcube.io._newer import SUFFIXES
from lightcube.io._toml import read_tables
from lightcube.optics.grid import check_elevation
from lightcube.optics.views import Views, distinct_angles, spread_angles
from lightcube.scene.description import sentence
from lightcube.wording import counted

VIEWS_FILE = "views.toml"
PICTURE_SUFFIXES = (".png", ".jpg", ".jpeg", ".webp", ".tif", ".tiff", *SUFFIXES)

#: What systems leave in folders that people look into, in small letters.
_LEFT_BY_SYSTEMS = (".ds_store", "thumbs.db", "desktop.ini", ".directory", ".localized", "__macosx", "@eadir")
#: So many files that are left out are named.
_NAMED = 3

_Finite = Annotated[float, Field(allow_inf_nan=False)]


class _ViewsToml(BaseModel):
    """The keys of `views.toml`; all are optional."""

    model_config = ConfigDict(extra="forbid", strict=True)

    angles_deg: list[_Finite] | None = None
    span_deg: _Finite | None = None
    elevation_deg: _Finite | None = None
    names: list[str] | None = None


@dataclass(frozen=True)
class FolderViews:
    """What `views.toml` says; None where it says nothing."""

    angles_deg: NDArray[np.float64] | None = None
    elevation_deg: float | None = None
    names: tuple[str, ...] | None = None


def natural_key(name: str) -> tuple[list[tuple[int, str]], str]:
    """Sort key of a file's name that puts ``"2"`` before ``"10"``, a name before longer ones, and ignores case."""
    parts = re.split(r"([0-9]+)", PurePath(name).stem.casefold())
    return [(int(part), "") if index % 2 else (0, part) for index, part in enumerate(parts)], name


def is_left_by_systems(name: str) -> bool:
    """Whether a file's name is one of those that systems leave in any folder."""
    return name.lower() in _LEFT_BY_SYSTEMS or name.startswith("._")


def is_picture(name: str) -> bool:
    """Whether a file of a folder is read as a picture, by its name."""
    return PurePath(name).suffix.lower() in PICTURE_SUFFIXES and not name.startswith(".")


def left_out(path: Path) -> str:
    """Say which files of a folder are not read, but for hidden ones and what systems leave; nothing where all are."""
    if not path.is_dir():
        return ""
    with system_errors(path, "reading"):
        names = (entry.name for entry in path.iterdir() if not is_picture(entry.name) or not entry.is_file())
        others = sorted(
            name for name in names if name[0] != "." and name != VIEWS_FILE and not is_left_by_systems(name)
        )
    if not others:
        return ""
    more = f" and {len(others) - _NAMED} more" if len(others) > _NAMED else ""
    return f"{len(others)} of what is there is no picture and was left out: {', '.join(others[:_NAMED])}{more}"


def picture_files(folder: Path) -> list[Path]:
    """Return the picture files of `folder` in natural order, hidden ones left out; `InputError` where there is none."""
    with system_errors(folder, "reading"):
        visible = [
            entry for entry in folder.iterdir() if not entry.name.startswith(".") and not is_left_by_systems(entry.name)
        ]
        found = [entry for entry in visible if is_picture(entry.name) and entry.is_file()]
    if not visible:
        raise InputError(f"the folder {folder} is empty: put at least two pictures into it")
    if not found and any(entry.name == "zarr.json" for entry in visible):
        raise InputError(f"{folder} holds arrays, such as a cube's, not pictures: give what the cube was made from")
    if not found:
        raise InputError(
            f"there are no pictures in the folder {folder}: put in files that end with {', '.join(PICTURE_SUFFIXES)}"
        )
    return sorted(found, key=lambda file: natural_key(file.name))


def read_views(folder: Path, count: int) -> FolderViews:
    """Read `views.toml` of `folder` for `count` pictures; all None where there is no such file.

    The file has the keys `angles_deg` (list of degrees, one per picture) or `span_deg` (degrees over which they are
    spread evenly), `elevation_deg` (degrees) and `names` (list of text), all optional.

    Raises
    ------
    InputError
        Naming the file and the key where something in it cannot be used.
    """
    file = folder / VIEWS_FILE
    if not file.exists():
        return FolderViews()
    said = _parse(file)
    for key, values in (("angles_deg", said.angles_deg), ("names", said.names)):
        if values is not None and len(values) != count:
            raise InputError(
                f"{file}: {key}: {len(values)} are listed for {counted(count, 'picture')}, give one per picture"
            )
    if said.angles_deg is not None and said.span_deg is not None:
        raise InputError(f"{file}: span_deg: angles_deg is given already: use one of the two")
    angles_deg = None
    key = "elevation_deg"
    try:
        elevation_deg = None if said.elevation_deg is None else check_elevation(said.elevation_deg)
        if said.angles_deg is not None:
            key = "angles_deg"
            angles_deg = distinct_angles(said.angles_deg)
        elif said.span_deg is not None:
            key = "span_deg"
            angles_deg = distinct_angles(spread_angles(count, said.span_deg, elevation_deg=elevation_deg or 0.0))
    except InputError as error:
        raise InputError(f"{file}: {key}: {error}") from error
    return FolderViews(angles_deg, elevation_deg, None if said.names is None else tuple(said.names))


def _parse(file: Path) -> _ViewsToml:
    """Read and check the keys of one `views.toml`."""
    try:
        return _ViewsToml.model_validate(read_tables(file, str(file)))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        known = f" (there are {', '.join(_ViewsToml.model_fields)})" if first["type"] == "extra_forbidden" else ""
        raise InputError(f"{file}: {sentence(first)}{known}") from error


def views_text(views: Views | None, names: Sequence[str] | None) -> str:
    """Return the text of a `views.toml`.

    Raises
    ------
    InputError
        Where `views` are not those of a turntable with one elevation: the file cannot say more.
    """
    lines = []
    if views is not None:
        parallel = not np.any(views.lamps[:, 3])
        elevations_deg = views.elevations_deg
        if not parallel or np.ptp(elevations_deg) > 1e-9:
            raise InputError(
                f"{VIEWS_FILE} can only hold a turntable's views with one elevation in parallel light: "
                "write the pictures without views"
            )
        lines.append(f"angles_deg = [{', '.join(repr(float(angle_deg)) for angle_deg in views.angles_deg)}]")
        lines.append(f"elevation_deg = {float(elevations_deg[0])!r}")
    if names is not None:
        lines.append(f"names = [{', '.join(_toml_text(name) for name in names)}]")
    return "".join(line + "\n" for line in lines)


def _toml_text(text: str) -> str:
    """`text` as a TOML basic string: JSON's escapes, and DEL, which only TOML wants escaped."""
    return json.dumps(encodable(text), ensure_ascii=False).replace("\x7f", "\\u007f")
