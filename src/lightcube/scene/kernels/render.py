"""The two cameras: shaded pictures of a scene, and its shadows."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import tasks
from lightcube.kernels.compiled import compiled
from lightcube.scene.kernels.world import (
    Vector,
    World,
    blocked,
    colour_at,
    inner,
    nearest,
    normal_towards,
    transmission,
)

#: Nanoseconds that a beam takes, roughly.
_BEAM = 1000


class Sight(NamedTuple):
    """Camera, lights and background as flat arrays."""

    axes: NDArray[np.float64]  # (4, 3): position, right, up, forward; right and up span one picture height
    perspective: bool
    samples: int  # samples^2 beams a pixel
    lights: NDArray[np.float64]  # (lights, 7): x, y, z, w (0: light travels along xyz, 1: stands at xyz), r, g, b
    ambient: NDArray[np.float64]  # (3,)
    background: NDArray[np.float64]  # (2, 3): top, bottom


@inner
def _light_towards(lights: NDArray[np.float64], k: int, p: Vector) -> tuple[Vector, float]:
    """Unit direction from `p` to light `k`, and the distance to it."""
    x, y, z = lights[k, 0], lights[k, 1], lights[k, 2]
    parallel = lights[k, 3] == 0.0
    if parallel:
        x, y, z = -x, -y, -z
    else:
        x, y, z = x - p[0], y - p[1], z - p[2]
    length = max(math.sqrt(x * x + y * y + z * z), 1e-300)
    return (x / length, y / length, z / length), (math.inf if parallel else length)


@inner
def _lit(
    world: World,
    sight: Sight,
    f: int,
    shape: int,
    p: Vector,
    n: Vector,
    d: Vector,
    diffuse: Vector,
    out: NDArray[np.float64],
) -> Vector:
    """Lambert's law plus Blinn's highlight under all lights that reach `p` past opaque shapes and through glass."""
    r, g, b = 0.0, 0.0, 0.0
    strength, sharpness = world.highlights[shape, 0], world.highlights[shape, 1]
    lift = 1e-6 * (1.0 + abs(p[0]) + abs(p[1]) + abs(p[2]))
    start = (p[0] + lift * n[0], p[1] + lift * n[1], p[2] + lift * n[2])
    for k in range(len(sight.lights)):
        to, distance = _light_towards(sight.lights, k, p)
        cosine = n[0] * to[0] + n[1] * to[1] + n[2] * to[2]
        if cosine <= 0.0 or blocked(world, f, start, to, 0.0, distance, out):
            continue
        left = transmission(world, f, start, to, 0.0, distance, out)
        shine = 0.0
        if strength > 0.0:
            hx, hy, hz = to[0] - d[0], to[1] - d[1], to[2] - d[2]
            length = max(math.sqrt(hx * hx + hy * hy + hz * hz), 1e-300)
            shine = strength * max((n[0] * hx + n[1] * hy + n[2] * hz) / length, 0.0) ** sharpness
        r += sight.lights[k, 4] * left[0] * (diffuse[0] * cosine + shine)
        g += sight.lights[k, 5] * left[1] * (diffuse[1] * cosine + shine)
        b += sight.lights[k, 6] * left[2] * (diffuse[2] * cosine + shine)
    return (r, g, b)


@inner
def _seen(world: World, sight: Sight, f: int, o: Vector, d: Vector, height: float, out: NDArray[np.float64]) -> Vector:
    """Linear light along a beam: the first opaque surface or the background, through glass, plus glass highlights."""
    far = math.inf
    r = sight.background[0, 0] + height * (sight.background[1, 0] - sight.background[0, 0])
    g = sight.background[0, 1] + height * (sight.background[1, 1] - sight.background[0, 1])
    b = sight.background[0, 2] + height * (sight.background[1, 2] - sight.background[0, 2])
    # First what is opaque, then the highlight of the glass surface in front: those behind it are hardly seen.
    for glass in range(2 if world.shiny else 1):
        t, shape, triangle = nearest(world, f, glass == 1, o, d, 0.0, far, out)
        if shape >= 0 and (glass == 0 or world.highlights[shape, 0] > 0.0):
            p = (o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2])
            n = normal_towards(world, f, shape, triangle, p, d)
            own = colour_at(world, f, shape, p, n) if glass == 0 else (0.0, 0.0, 0.0)
            lit = _lit(world, sight, f, shape, p, n, d, own, out)
            if glass == 0:
                r, g, b, far = own[0] * sight.ambient[0], own[1] * sight.ambient[1], own[2] * sight.ambient[2], t
            r, g, b = r + lit[0], g + lit[1], b + lit[2]
        if glass == 0:
            left = transmission(world, f, o, d, 0.0, far, out)
            r, g, b = r * left[0], g * left[1], b * left[2]
    return (min(r, 1.0), min(g, 1.0), min(b, 1.0))


@inner
def _pixel(
    world: World, sight: Sight, f: int, row: int, column: int, rows: int, columns: int, out: NDArray[np.float64]
) -> Vector:
    """Mean of a regular grid of beams through a pixel."""
    r, g, b = 0.0, 0.0, 0.0
    samples = sight.samples
    axes = sight.axes
    position = (axes[0, 0], axes[0, 1], axes[0, 2])
    right = (axes[1, 0], axes[1, 1], axes[1, 2])
    up = (axes[2, 0], axes[2, 1], axes[2, 2])
    forward = (axes[3, 0], axes[3, 1], axes[3, 2])
    for sample in range(samples * samples):
        v = (row + (sample // samples + 0.5) / samples) / rows
        u = (column + (sample % samples + 0.5) / samples - 0.5 * columns) / rows
        x = u * right[0] + (0.5 - v) * up[0]
        y = u * right[1] + (0.5 - v) * up[1]
        z = u * right[2] + (0.5 - v) * up[2]
        if sight.perspective:
            o = position
            x, y, z = x + forward[0], y + forward[1], z + forward[2]
            length = math.sqrt(x * x + y * y + z * z)
            d = (x / length, y / length, z / length)
        else:
            o = (position[0] + x, position[1] + y, position[2] + z)
            d = forward
        light = _seen(world, sight, f, o, d, v, out)
        r, g, b = r + light[0], g + light[1], b + light[2]
    share = 1.0 / (samples * samples)
    return (r * share, g * share, b * share)


def shaded(world: World, sight: Sight, pictures: NDArray[np.float32]) -> None:
    """Fill `pictures` ``(f, row, column, 3)`` with what the camera sees at each instant of `world`."""
    beams = pictures.size // 3 * sight.samples**2
    tasks.run(_shaded, pictures.shape[0] * pictures.shape[1], _BEAM * beams, world, sight, pictures)


@compiled
def _shaded(first: int, last: int, world: World, sight: Sight, pictures: NDArray[np.float32]) -> None:
    _, rows, columns, _ = pictures.shape
    for line in range(first, last):
        f, row = line // rows, line % rows
        out = np.empty(4)
        for column in range(columns):
            light = _pixel(world, sight, f, row, column, rows, columns, out)
            pictures[f, row, column, 0] = light[0]
            pictures[f, row, column, 1] = light[1]
            pictures[f, row, column, 2] = light[2]


def shadowed(
    world: World,
    lamps: NDArray[np.float64],
    origins: NDArray[np.float64],
    column_steps: NDArray[np.float64],
    row_steps: NDArray[np.float64],
    pictures: NDArray[np.float32],
) -> None:
    """Fill `pictures` ``(f, row, column, 3)`` with the transmission of the beam that lands in each pixel's centre.

    View ``f`` sees instant ``f`` of `world`; lengths are in scene units, see `lightcube.optics.views.Views`.
    """
    work = _BEAM * (pictures.size // 3)
    data = world, lamps, origins, column_steps, row_steps, pictures
    tasks.run(_shadowed, pictures.shape[0] * pictures.shape[1], work, *data)


@compiled
def _shadowed(
    first: int,
    last: int,
    world: World,
    lamps: NDArray[np.float64],
    origins: NDArray[np.float64],
    column_steps: NDArray[np.float64],
    row_steps: NDArray[np.float64],
    pictures: NDArray[np.float32],
) -> None:
    _, rows, columns, _ = pictures.shape
    for line in range(first, last):
        f, row = line // rows, line % rows
        out = np.empty(4)
        down = row - 0.5 * (rows - 1)
        for column in range(columns):
            across = column - 0.5 * (columns - 1)
            x = origins[f, 0] + across * column_steps[f, 0] + down * row_steps[f, 0]
            y = origins[f, 1] + across * column_steps[f, 1] + down * row_steps[f, 1]
            z = origins[f, 2] + across * column_steps[f, 2] + down * row_steps[f, 2]
            # Parallel light casts the same shadow wherever the screen stands; a point lamp's beam starts at the lamp.
            w = lamps[f, 3]
            dx, dy, dz = lamps[f, 0], lamps[f, 1], lamps[f, 2]
            if w != 0.0:
                dx, dy, dz = x - dx, y - dy, z - dz
            length = math.sqrt(dx * dx + dy * dy + dz * dz)
            near = -math.inf if w == 0.0 else -length
            d = (dx / length, dy / length, dz / length)
            light = transmission(world, f, (x, y, z), d, near, math.inf, out)
            pictures[f, row, column, 0] = light[0]
            pictures[f, row, column, 1] = light[1]
            pictures[f, row, column, 2] = light[2]
