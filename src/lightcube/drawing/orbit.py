"""An eye on its way round the cube, to where a lamp is: there noise becomes the picture."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from lightcube.drawing.camera import Camera, Reals
from lightcube.drawing.standing import PlacedLamp, PlacedScreen
from lightcube.optics.views import unit

#: From the lamp a picture fills so much of the sight, and what is far away is seen under so many degrees.
LAMPS_SIGHT, FAR_FIELD = 0.72, 0.8
#: Degrees above which up is no longer up.
_HIGHEST = 89.9


@dataclass(frozen=True)
class Orbit:
    """Where an eye is round what it looks at.

    Parameters
    ----------
    azimuth_deg, height_deg, distance
        Of the eye, seen from its target.
    target
        Where it looks, mm.
    field_deg
        What the picture's width spans.
    up
        What is up in it.
    """

    azimuth_deg: float
    height_deg: float
    distance: float
    target: Reals
    field_deg: float
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)

    @classmethod
    def of(cls, eye: Reals, target: Reals, field_deg: float) -> Orbit:
        """The orbit of an eye that looks at a target."""
        way = eye - target
        distance = float(np.linalg.norm(way))
        height = math.degrees(math.asin(np.clip(way[2] / distance, -1, 1)))
        azimuth = math.degrees(math.atan2(way[1], way[0]))
        return cls(azimuth, float(np.clip(height, -_HIGHEST, _HIGHEST)), distance, target, field_deg)

    def camera(self, size: tuple[int, int]) -> Camera:
        """Its camera, of a picture of so many rows and columns."""
        azimuth, height = math.radians(self.azimuth_deg), math.radians(self.height_deg)
        way = np.array([math.cos(height) * math.cos(azimuth), math.cos(height) * math.sin(azimuth), math.sin(height)])
        x, y, z = (float(each) for each in self.target + self.distance * way)
        ahead = float(self.target[0]), float(self.target[1]), float(self.target[2])
        return Camera((x, y, z), ahead, self.up, self.field_deg, size)


def orbit_of(camera: Camera) -> Orbit:
    """The orbit that a camera is on."""
    return Orbit.of(np.array(camera.eye), np.array(camera.target), camera.field_deg)


def lamps_orbit(screen: PlacedScreen, lamp: PlacedLamp, size: tuple[int, int]) -> Orbit:
    """The orbit of an eye that is where a lamp is: the picture that it throws on a screen fills its sight, upright."""
    x, y, z = (float(each) for each in -unit(screen.down))
    return replace(_upon(screen, lamp, size), up=(x, y, z))


def _upon(screen: PlacedScreen, lamp: PlacedLamp, size: tuple[int, int]) -> Orbit:
    """The same, however it is turned."""
    middle = screen.corners.mean(axis=0)
    sides = screen.pixels[0] * np.linalg.norm(screen.down), screen.pixels[1] * np.linalg.norm(screen.right)
    half = float(max(sides[0] * size[1] / size[0], sides[1])) / 2 / LAMPS_SIGHT  # of what the picture's width spans
    if not lamp.parallel:
        away = float(np.linalg.norm(lamp.place - middle))
        return Orbit.of(lamp.place, middle, 2 * math.degrees(math.atan(half / away)))
    distance = half / math.tan(math.radians(FAR_FIELD) / 2)
    ahead = -unit(lamp.place)
    target = middle - (middle @ ahead) * ahead  # where its light passes the cube's middle
    return Orbit.of(target - distance * ahead, target, FAR_FIELD)


def between(one: Orbit, other: Orbit, part: float) -> Orbit:
    """An orbit on the way that is shorter round the cube; what is seen of the target changes evenly."""

    def mixed(a: float, b: float) -> float:
        return a + (b - a) * part

    def sight(orbit: Orbit) -> float:
        return math.log(orbit.distance * math.tan(math.radians(orbit.field_deg) / 2))

    field = mixed(one.field_deg, other.field_deg)
    return Orbit(
        one.azimuth_deg + ((other.azimuth_deg - one.azimuth_deg + 180) % 360 - 180) * part,
        mixed(one.height_deg, other.height_deg),
        math.exp(mixed(sight(one), sight(other))) / math.tan(math.radians(field) / 2),
        one.target + (other.target - one.target) * part,
        field,
        (mixed(one.up[0], other.up[0]), mixed(one.up[1], other.up[1]), mixed(one.up[2], other.up[2])),
    )


def soft(part: float) -> float:
    """Begin and end softly, from 0 to 1."""
    return part * part * (3 - 2 * part)
