"""Snell and Fresnel, deliberately plain: one beam at a time, from the lamp forward through a convex glass body.

A second opinion with no code of the package. Everything is in the axes of the body, with its middle at 0 and lengths in
mm, as `docs/conventions.md` has the cube's; a turntable's angle turns the light that is put in. Outside the body is air
of index 1. A block in a bath of its own index is traced as the bath, and what lies in the block is cut out of the way
(`within`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

Vector = NDArray[np.float64]
#: Where a line comes in and goes out, in lengths of its way, each with the outward normal there.
Crossing = tuple[float, Vector, float, Vector]

#: A way inside that is shorter, in mm, is that through an edge.
ON_FACE_MM = 1e-12


class Body(Protocol):
    """What a line can go into and out of, once."""

    def crossing(self, point: Vector, way: Vector) -> Crossing | None:
        """Of a line; None where it misses."""


@dataclass(frozen=True)
class Block:
    """Six flat faces, square to the axes."""

    size_mm: tuple[float, float, float]

    def crossing(self, point: Vector, way: Vector) -> Crossing | None:
        pairs = [_slab(point, way, axis, self.size_mm[axis] / 2) for axis in range(3)]
        return _common(pairs)


@dataclass(frozen=True)
class Cylinder:
    """About the z axis, with flat ends unless it is endless."""

    radius_mm: float
    height_mm: float = math.inf

    def crossing(self, point: Vector, way: Vector) -> Crossing | None:
        level = np.array([1.0, 1.0, 0.0])
        side = _round(point * level, way * level, self.radius_mm)
        if math.isinf(self.height_mm):
            return side
        return _common([side, _slab(point, way, 2, self.height_mm / 2)])


@dataclass(frozen=True)
class Sphere:
    """About the middle."""

    radius_mm: float

    def crossing(self, point: Vector, way: Vector) -> Crossing | None:
        return _round(point, way, self.radius_mm)


def _slab(point: Vector, way: Vector, axis: int, half_mm: float) -> Crossing | None:
    normal = np.zeros(3)
    if way[axis] == 0:
        return (-math.inf, normal, math.inf, normal) if abs(point[axis]) < half_mm else None
    normal[axis] = math.copysign(1, way[axis])
    there = math.copysign(half_mm, way[axis])
    return (-there - point[axis]) / way[axis], -normal, (there - point[axis]) / way[axis], normal


def _round(point: Vector, way: Vector, radius_mm: float) -> Crossing | None:
    """A sphere, or a cylinder where both vectors are level."""
    square = way @ way
    if square == 0:
        return (-math.inf, np.zeros(3), math.inf, np.zeros(3)) if point @ point < radius_mm**2 else None
    nearest = -float(point @ way / square)
    miss = point + nearest * way
    left = radius_mm**2 - miss @ miss
    if left <= 0:
        return None
    half = math.sqrt(float(left / square))
    return nearest - half, (miss - half * way) / radius_mm, nearest + half, (miss + half * way) / radius_mm


def _common(pairs: list[Crossing | None]) -> Crossing | None:
    """What lies in all of several bodies."""
    if any(pair is None for pair in pairs):
        return None
    crossings = [pair for pair in pairs if pair is not None]
    first = max(crossings, key=lambda pair: pair[0])
    last = min(crossings, key=lambda pair: pair[2])
    return (first[0], first[1], last[2], last[3]) if first[0] < last[2] else None


def refracted(way: Vector, normal: Vector, ratio: float) -> Vector | None:
    """Unit direction behind a face by Snell's law; None where all is reflected.

    ``normal`` points against the light, ``ratio`` is the index before the face over that behind it.
    """
    cosine = -(way @ normal)
    along = ratio * (way + cosine * normal)
    left = 1 - along @ along
    return None if left < 0 else along - math.sqrt(left) * normal


def mirrored(way: Vector, normal: Vector) -> Vector:
    return way - 2 * (way @ normal) * normal


def fresnel(cosine: float, before: float, behind: float) -> tuple[float, float]:
    """Shares of light that a face throws back, polarised square to the plane of incidence (s) and in it (p)."""
    sine = math.sqrt(max(1 - cosine**2, 0.0)) * before / behind
    if sine >= 1:
        return 1.0, 1.0
    other = math.sqrt(1 - sine**2)
    s = (before * cosine - behind * other) / (before * cosine + behind * other)
    p = (before * other - behind * cosine) / (before * other + behind * cosine)
    return s**2, p**2


@dataclass(frozen=True)
class Traced:
    """A beam's way through a body; light that is thrown back inside at its exit is not followed further.

    The shares are of unpolarised light: the mean over s and p of the product over both faces, as if both had one plane
    of incidence (they have, but where a beam runs askew between round faces, turns by total reflection, or enters and
    leaves by faces that are neighbours).
    """

    points: list[Vector]  # entry, every total reflection, exit
    inner: Vector  # direction behind the entry
    outgoing: Vector
    transmitted: float
    reflected: float  # at the entry
    kept_inside: float  # thrown back at the exit

    @property
    def entry(self) -> Vector:
        return self.points[0]

    @property
    def exit(self) -> Vector:
        return self.points[-1]

    @property
    def is_direct(self) -> bool:
        """Whether no total reflection is on the way."""
        return len(self.points) == 2

    def lands(self, origin: ArrayLike, normal: ArrayLike) -> Vector:
        """Where the outgoing beam meets the plane through ``origin`` with a normal."""
        square = np.asarray(normal, float)
        return self.exit + (np.asarray(origin, float) - self.exit) @ square / (self.outgoing @ square) * self.outgoing


def traced(body: Body, point: ArrayLike, way: ArrayLike, ior: float, reflections: int = 20) -> Traced | None:
    """Light along ``way`` through ``point`` on its way through a body; None where it misses, or never gets out."""
    start, direction = np.asarray(point, float), np.asarray(way, float)
    direction = direction / np.linalg.norm(direction)
    crossing = body.crossing(start, direction)
    if crossing is None:
        return None
    place, normal = start + crossing[0] * direction, crossing[1]
    before = fresnel(float(-direction @ normal), 1.0, ior)
    inner = refracted(direction, normal, 1 / ior)
    assert inner is not None, "into denser glass every beam comes"
    points, inside = [place], inner
    for _ in range(reflections + 1):
        crossing = body.crossing(points[-1], inside)
        if crossing is None or crossing[2] <= ON_FACE_MM:
            return None  # through an edge
        points.append(points[-1] + crossing[2] * inside)
        outward = crossing[3]
        outgoing = refracted(inside, -outward, ior)
        if outgoing is not None:
            behind = fresnel(float(inside @ outward), ior, 1.0)
            shares = [(r, (1 - r) * q, (1 - r) * (1 - q)) for r, q in zip(before, behind, strict=True)]
            reflected, kept, through = np.mean(shares, axis=0).tolist()
            return Traced(points, inner, outgoing, through, reflected, kept)
        inside = mirrored(inside, outward)
    return None


def irradiance(body: Body, point: ArrayLike, way: ArrayLike, ior: float, origin: ArrayLike, normal: ArrayLike) -> float:
    """Light on a plane where a beam lands, over that without the body: shares, and how a thin pencil spreads.

    By differences: two beams beside it, a millionth of a mm to both sides, along two ways square to the light.
    """
    direction, square = (np.asarray(v, float) / np.linalg.norm(v) for v in (way, normal))
    aside = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
    aside /= np.linalg.norm(aside)
    beam = traced(body, point, direction, ior)
    if beam is None:
        return 0.0
    step, spread = 1e-6, []
    for unit in (aside, np.cross(direction, aside)):
        ends = [traced(body, np.asarray(point) + sign * step * unit, direction, ior) for sign in (-1, 1)]
        places = [end.lands(origin, normal) for end in ends if end is not None]
        spread.append((places[1] - places[0]) / (2 * step))
    area = float(np.linalg.norm(np.cross(spread[0], spread[1])))
    return beam.transmitted / (abs(float(direction @ square)) * area)


def within(body: Body, points: list[Vector]) -> list[tuple[Vector, Vector]]:
    """Pieces of a way that lie in a body: of a block in a bath of its own index, what goes through its voxels."""
    pieces = []
    for first, last in pairwise(points):
        crossing = body.crossing(first, last - first)
        if crossing is not None and max(crossing[0], 0.0) < min(crossing[2], 1.0):
            at = max(crossing[0], 0.0), min(crossing[2], 1.0)
            pieces.append((first + at[0] * (last - first), first + at[1] * (last - first)))
    return pieces


def absorbance(points: list[Vector], extinction: NDArray[Any], pitch_mm: tuple[float, float, float]) -> float:
    """Sum over the voxels ``(z, y, x)`` of a block about the middle, with a pitch along (x, y, z), from face to face.

    Every piece of the way is cut at all planes between voxels, and each cut's middle says whose length it is.
    """
    counts = np.array(extinction.shape[::-1])
    total = 0.0
    x_mm, y_mm, z_mm = (counts * pitch_mm).tolist()
    for first, last in within(Block((x_mm, y_mm, z_mm)), points):
        start, end = first / pitch_mm + counts / 2, last / pitch_mm + counts / 2
        changing = [axis for axis in range(3) if start[axis] != end[axis]]
        cuts = [(np.arange(counts[k] + 1) - start[k]) / (end[k] - start[k]) for k in changing]
        at = np.unique(np.clip(np.concatenate([[0.0, 1.0], *cuts]), 0, 1))
        middles = start + ((at[1:] + at[:-1]) / 2)[:, None] * (end - start)
        x, y, z = np.clip(np.floor(middles).astype(int), 0, counts - 1).T
        total += float(np.diff(at) @ extinction[z, y, x]) * float(np.linalg.norm(last - first))
    return total
