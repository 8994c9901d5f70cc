"""Where the sun stands, by the textbook formulas for a day without weather: to half a degree, as good as its disc.

The sun's declination is Spencer's series (J. W. Spencer, Fourier series representation of the position of the sun,
Search 2 (1971) 172); hours are solar time, of which noon is when the sun stands highest.
"""

from __future__ import annotations

import math

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Reals

#: Days of the months of a year that is no leap year.
_MONTHS = (31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31)
#: Degrees that the sun goes on in an hour.
_HOUR_DEG = 15.0


def sunlight(latitude_deg: float, day: str, hour: float, faces_deg: float = 180.0, tilt_deg: float = 0.0) -> Reals:
    """The way of the sun's light in the axes of films that face somewhere: x right, y up in them, z towards the viewer.

    Parameters
    ----------
    latitude_deg
        North of the equator, -90 to 90.
    day
        Month and day, ``"06-21"``.
    hour
        0 to 24, solar time: 12 is noon.
    faces_deg
        Where films look, degrees clockwise from north: 180 = south. Of films that lie flat, where their lower edge is.
    tilt_deg
        How far they stand up: 0 = they lie flat, 90 = they stand in a window.

    Returns
    -------
    A unit vector ``(3,)``.

    Raises
    ------
    InputError
        Where a number is out of its range, or the sun is below the horizon or behind the films then.
    """
    bounds = {"latitude_deg": (latitude_deg, 90), "faces_deg": (faces_deg, 360), "tilt_deg": (tilt_deg, 90)}
    for name, (value, most) in bounds.items():
        if not abs(value) <= most:
            raise InputError(f"sun: {name} lies between {-most} and {most}, not {value:g}")
    if not 0 <= hour <= 24:
        raise InputError(f"sun: hour lies between 0 and 24, of which 12 is noon, not {hour:g}")
    towards = _towards(latitude_deg, _declination(_day_of_year(day)), hour)  # east, north, up
    if towards[2] <= 0:
        raise InputError(
            f"sun: it is below the horizon on {day} at {hour:g} h, at {latitude_deg:g} degrees of latitude: "
            "choose another hour or day"
        )
    faces, tilt = math.radians(faces_deg), math.radians(tilt_deg)
    level = np.array([math.sin(faces), math.cos(faces), 0.0])
    normal = math.sin(tilt) * level + np.array([0.0, 0.0, math.cos(tilt)])
    up = math.sin(tilt) * np.array([0.0, 0.0, 1.0]) - math.cos(tilt) * level
    way = -np.array([towards @ np.cross(up, normal), towards @ up, towards @ normal])
    if way[2] >= 0:
        raise InputError(f"sun: it shines on the back of the films on {day} at {hour:g} h: let them face it")
    return way


def _towards(latitude_deg: float, declination: float, hour: float) -> Reals:
    """Unit vector to the sun: east, north, up."""
    latitude, angle = math.radians(latitude_deg), math.radians(_HOUR_DEG * (hour - 12))
    return np.array(
        [
            -math.cos(declination) * math.sin(angle),
            math.cos(latitude) * math.sin(declination) - math.sin(latitude) * math.cos(declination) * math.cos(angle),
            math.sin(latitude) * math.sin(declination) + math.cos(latitude) * math.cos(declination) * math.cos(angle),
        ]
    )


def _declination(day: int) -> float:
    """Of the sun on a day of the year, counted from 1, radians."""
    turn = math.tau * (day - 1) / 365
    series = ((0.006918, 0.0), (-0.399912, 0.070257), (-0.006758, 0.000907), (-0.002697, 0.00148))
    return sum(c * math.cos(n * turn) + s * math.sin(n * turn) for n, (c, s) in enumerate(series))


def _day_of_year(day: str) -> int:
    """Number, from 1 on, of a month and a day."""
    try:
        month, number = (int(part) for part in day.split("-"))
        if not (1 <= month <= 12 and 1 <= number <= _MONTHS[month - 1] + (month == 2)):
            raise ValueError
    except ValueError:
        raise InputError(f'sun: a day is a month and a day such as "06-21", not {day!r}') from None
    return min(sum(_MONTHS[: month - 1]) + number, 365)
