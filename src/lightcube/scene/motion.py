"""Keyframes: where a shape is at any time of the animation.

A pose is ``position``, ``rotation_deg`` (degrees about the fixed x, then y, then z axis) and ``scale``, each three
numbers; a point of the shape goes to ``position + R_z R_y R_x (scale * point)`` in the parent's axes. Rotations
are interpolated angle by angle, so 0 to 360 is a whole turn.
"""

import math
from bisect import bisect_right
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from lightcube.scene.description import Group, Key, Motion, Placed

Triple = tuple[float, float, float]

_CHANNELS = ("position", "rotation_deg", "scale")


def eased(u: float, easing: str) -> float:
    """How far along a piece of motion is when the fraction `u` of its time has passed.

    ``linear`` is u, ``ease-in`` u^2, ``ease-out`` 1 - (1 - u)^2 (a thrown ball), ``ease-in-out`` u^2 (3 - 2 u),
    ``step`` 0 until the next key.
    """
    if easing == "ease-in":
        return u * u
    if easing == "ease-out":
        return 1 - (1 - u) ** 2
    if easing == "ease-in-out":
        return u * u * (3 - 2 * u)
    if easing == "step":
        return 0.0
    return u


def rotation_matrix(degrees: Triple) -> NDArray[np.float64]:
    """``R_z R_y R_x``, (3, 3): turns about the fixed x, then y, then z axis, counter-clockwise seen from its tip."""
    (cx, sx), (cy, sy), (cz, sz) = ((math.cos(a), math.sin(a)) for a in map(math.radians, degrees))
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return np.asarray(about_z @ about_y @ about_x, dtype=np.float64)


def pose(thing: Placed, time: float) -> tuple[Triple, Triple, Triple]:
    """``(position, rotation, scale)`` of a shape or group in its parent's axes at `time` in [0, 1].

    A channel that the motion's keys name replaces the resting one.
    """
    rest = (thing.position, thing.rotation_deg, thing.scale)
    if thing.motion is None:
        return rest
    position, rotation_deg, scale = (
        _channel(thing.motion, name, time) or still for name, still in zip(_CHANNELS, rest, strict=True)
    )
    # A smooth curve may swing a little below zero, where a size makes no sense.
    return position, rotation_deg, (max(scale[0], 0.0), max(scale[1], 0.0), max(scale[2], 0.0))


def placement(thing: Placed, groups: Mapping[str, Group], time: float) -> NDArray[np.float64]:
    """Affine map (3, 4) from the axes of a shape or group into the scene at `time`, parents included."""
    position, rotation_deg, scale = pose(thing, time)
    own = np.column_stack([rotation_matrix(rotation_deg) * scale, position])
    if thing.parent is None:
        return own
    outer = placement(groups[thing.parent], groups, time)
    own[:, :] = outer[:, :3] @ own
    own[:, 3] += outer[:, 3]
    return own


def _channel(motion: Motion, channel: str, time: float) -> Triple | None:
    """One channel of a motion at `time`, or None where no key names it."""
    keys = [key for key in motion.keys if getattr(key, channel) is not None]
    if not keys:
        return None
    times = [key.time for key in keys]
    values: list[Triple] = [getattr(key, channel) for key in keys]
    if motion.loop:
        time = (time + motion.phase) % 1.0
        _close(times, values, channel)
        if time < times[0]:
            time += 1.0
    if time <= times[0]:
        return values[0]
    if time >= times[-1]:
        return values[-1]
    i = bisect_right(times, time) - 1
    span = times[i + 1] - times[i]
    u = (time - times[i]) / span
    easing = _easing(keys[i % len(keys)], motion)
    if easing == "smooth":
        leaving, arriving = (_velocity(times, values, k, motion.loop) for k in (i, i + 1))
        return _hermite(values[i], values[i + 1], leaving, arriving, u, span)
    w = eased(u, easing)
    return _triple([a + w * (b - a) for a, b in zip(values[i], values[i + 1], strict=True)])


def _easing(key: Key, motion: Motion) -> str:
    return key.easing or motion.easing


def _close(times: list[float], values: list[Triple], channel: str) -> None:
    """Add the key that leads a loop back to its first one: for rotations the nearest whole turn, onward in a tie."""
    if times[-1] - times[0] >= 1.0:
        return
    first, last = values[0], values[-1]
    if channel == "rotation_deg":
        first = _triple([a + 360.0 * math.floor((b - a) / 360.0 + 0.5) for a, b in zip(first, last, strict=True)])
    times.append(times[0] + 1.0)
    values.append(first)


def _velocity(times: list[float], values: list[Triple], i: int, loop: bool) -> Triple:
    """Slope of a smooth motion at key `i`: from the key before to the key after (Catmull and Rom)."""
    last = len(times) - 1
    if 0 < i < last:
        rise = [b - a for a, b in zip(values[i - 1], values[i + 1], strict=True)]
        return _triple([r / (times[i + 1] - times[i - 1]) for r in rise])
    if not loop:
        return (0.0, 0.0, 0.0)
    rise = [(b - a) + (d - c) for a, b, c, d in zip(values[last - 1], values[last], values[0], values[1], strict=True)]
    return _triple([r / ((times[last] - times[last - 1]) + (times[1] - times[0])) for r in rise])


def _hermite(a: Triple, b: Triple, leaving: Triple, arriving: Triple, u: float, span: float) -> Triple:
    """Cubic from `a` to `b` with the given velocities at its ends."""
    from_a, from_b = (1 + 2 * u) * (1 - u) ** 2, u * u * (3 - 2 * u)
    out, back = u * (1 - u) ** 2 * span, -u * u * (1 - u) * span
    return _triple([from_a * a[k] + from_b * b[k] + out * leaving[k] + back * arriving[k] for k in range(3)])


def _triple(numbers: list[float]) -> Triple:
    return (numbers[0], numbers[1], numbers[2])
