"""Densities as they were typed or a densitometer wrote them: a table (CSV) of inks, coverages and densities."""

import csv
from pathlib import Path
from typing import NamedTuple

from lightcube.errors import InputError
from lightcube.io._bounds import check_file
from lightcube.io._files import system_errors

#: What the first line of a table says, and what bare film is called.
COLUMNS, FILM = ("ink", "coverage", "red", "green", "blue"), "film"
#: More than anybody types, and denser than anything.
_MOST_BYTES, _MOST_DENSITY = 1 << 20, 10.0


class Density(NamedTuple):
    """A line of a table: its number, inks over each other, how much each covers, and density of red, green, blue."""

    line: int
    inks: tuple[str, ...]
    coverage: float
    densities: tuple[float, ...]


def read_densities(path: str | Path) -> list[Density]:
    """Read a table whose lines are ``cyan,0.5,0.31,0.12,0.05``, or ``cyan+magenta,1,...``, or ``film,0,...``.

    Raises
    ------
    InputError
        Where the file cannot be read, or a line is none of these.
    """
    file = Path(path)
    with system_errors(file, "reading"), check_file(file).open("rb") as opened:
        data = opened.read(_MOST_BYTES + 1)
    if len(data) > _MOST_BYTES:
        raise InputError(f"{file.name} is larger than 1 MiB: make it shorter")
    try:
        lines = list(csv.reader(data.decode("utf-8-sig").splitlines()))
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{file.name} is no table in UTF-8: save it as CSV ({str(error)[:60]})") from None
    if not lines or tuple(name.strip().lower() for name in lines[0]) != COLUMNS:
        raise InputError(f"{file.name} must begin with the line {','.join(COLUMNS)}")
    found = [_line(file.name, number, line) for number, line in enumerate(lines[1:], 2) if any(map(str.strip, line))]
    if not found:
        raise InputError(f"{file.name} has no densities: write a line for each patch")
    return found


def _line(name: str, number: int, parts: list[str]) -> Density:
    """One line, or `InputError`."""
    inks = tuple(ink.strip() for ink in parts[0].split("+"))
    try:
        coverage, *densities = map(float, parts[1:])
    except ValueError:
        coverage, densities = -1.0, []
    is_fine = len(densities) == len(COLUMNS) - 2 and all(0 <= density <= _MOST_DENSITY for density in densities)
    if not all(inks) or not 0 <= coverage <= 1 or not is_fine:
        raise InputError(
            f"{name}, line {number} says {','.join(parts)[:60]!r}: give ink, coverage from 0 to 1, and three densities "
            f"from 0 to {_MOST_DENSITY:g}"
        )
    return Density(number, inks, coverage, tuple(densities))
