"""What the texts and numbers of the command line mean."""

import re
from pathlib import PurePath
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.forward import turning
from lightcube.optics.cube import Cube
from lightcube.optics.views import check_angles, doubt_angles


def numbers(text: str, option: str) -> tuple[float, ...]:
    """Numbers separated by commas."""
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise InputError(f"{option} {text}: give numbers separated by commas, such as 0,12.5,90") from None


def two_numbers(text: str, option: str) -> tuple[float, float]:
    """Two numbers with a comma between them."""
    said = numbers(text, option)
    if len(said) != 2:
        raise InputError(f"{option} {text}: give two numbers with a comma between them, such as 0.5,0.3")
    return said[0], said[1]


def colours(text: str, option: str) -> tuple[float, ...]:
    """One number, or one of each of three colours."""
    said = numbers(text, option)
    if len(said) not in (1, 3):
        raise InputError(f"{option} {text}: give one number, or one of red, green and blue, such as 0.01,0.01,0.02")
    return said


def number_or_auto(text: str, option: str) -> float | None:
    """A number, or None where it is to be chosen: auto."""
    try:
        return None if text.strip() == "auto" else float(text)
    except ValueError:
        raise InputError(f"{option} {text}: give a number, or auto") from None


def base_mm(text: str) -> float | Literal["auto", "none"]:
    """How thick a base is, or that there is none, or one where it is needed."""
    said = text.strip()
    if said in ("auto", "none"):
        return said  # type: ignore[return-value]
    thick_mm = number_or_auto(text, "--base")
    if thick_mm is None or not 0 < thick_mm < 1e6:
        raise InputError(f"--base {text}: give how thick it is in mm, auto or none")
    return thick_mm


def whole_numbers(text: str, separator: str, option: str, count: int) -> tuple[int, ...]:
    """As many whole numbers of at least 1 as `count` says."""
    parts = text.split(separator)
    if len(parts) != count or not all(
        part.strip().isascii() and part.strip().isdigit() and int(part) for part in parts
    ):
        example = separator.join(["64", "48", "32"][:count])
        raise InputError(f"{option} {text}: give {count} whole numbers of at least 1, such as {example}")
    return tuple(int(part) for part in parts)


def memory(text: str) -> int:
    """Bytes that a text such as 2GB, 512MB or 1.5GiB means."""
    match = re.fullmatch(r"([0-9]+(?:\.[0-9]*)?)\s*([KMGT]?)(i?)B?", text.strip(), re.IGNORECASE)
    size = float(match[1]) * (1024 if match[3] else 1000) ** " KMGT".index(match[2].upper() or " ") if match else 0
    if not 1 <= size < 1e18:
        raise InputError(f"--memory {text}: give a number with its unit, such as 2GB, 512MB or 1.5GiB")
    return int(size)


def threads(text: str) -> int:
    """Number of threads that a text means."""
    if not (text.strip().isascii() and text.strip().isdigit() and int(text)):
        raise InputError(f"--threads {text}: give a whole number of at least 1")
    return int(text)


def unit(text: str) -> tuple[int, int]:
    """``(I, N)`` of a text I/N with 1 <= I <= N."""
    which, of = whole_numbers(text, "/", "--unit", 2)
    if which > of:
        raise InputError(f"--unit {text}: give the number of a unit and how many there are, such as 1/{of}")
    return which, of


def play_angles(
    cube: Cube, angles_deg: str | None, start: float | None, end: float | None, count: int | None, *, stops: bool
) -> NDArray[np.float64]:
    """Stops, given angles, or a turn in which each stop is met exactly."""
    turn = [start, end, count] != [None] * 3
    if stops + (angles_deg is not None) + turn > 1:
        raise InputError(
            "--stops, --angles-deg, and --from-deg, --to-deg and --count are three ways to say the same: use one"
        )
    if stops:
        return cube.angles_deg
    if angles_deg is not None:
        said = check_angles(numbers(angles_deg, "--angles-deg"))
        doubt_angles(said, "--angles-deg", stacklevel=1)
        return said
    first, last = start or 0.0, 360.0 if end is None else end
    if count is not None and count < 1:
        raise InputError(f"--count {count}: give at least 1 picture")
    if not (np.isfinite([first, last]).all() and first != last):
        raise InputError(f"--from-deg {first} --to-deg {last}: give two different finite numbers of degrees")
    return turning.turn(cube, count, first, last)


def is_movie(output: str) -> bool:
    """Whether what is written is looked at as it moves: no single pictures, no numbers."""
    return PurePath(output).suffix.lower() not in ("", ".npy", ".png")


def movie_scale(output: str, rows: int) -> int:
    """An even scale that makes a movie at least 256 pixels high; single pictures and numbers stay as they are."""
    return 2 * -(-128 // rows) if is_movie(output) and rows < 256 else 1


def short(value: object) -> str:
    """Numbers with six digits, nothing as a dash."""
    if isinstance(value, list):
        return ", ".join(short(item) for item in value)
    return "-" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)
