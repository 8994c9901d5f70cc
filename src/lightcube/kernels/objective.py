"""Light of several groups of views that adds up on the screen, and the two-sided residual of the sum.

Groups of views under one lamp each, and their joint absorbance, are those of `lightcube.kernels.joint`; picture p is
made by groups ``starts[p]`` to before ``starts[p + 1]``, of `powers` ``(groups, channels)``, and shows ``e^u``, the sum
of ``P e^-E``. So ``du/dE = -s`` with s the part of all light that a group makes up, and the same by the absorbance of
a view, with s the part that comes through the cube along it. The second derivatives of u are ``diag(s) - s s'``. A
convex function f of u has then, by absorbance, a second derivative of at most ``diag(s (f'' sum(s) + max(f', 0)))``,
and where f' pulls, ``min(s, 2 s (1 - s))`` takes the place of s (sums of rows of the matrix). Results do not depend on
the number of threads.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import tasks
from lightcube.kernels.compiled import compiled
from lightcube.kernels.descent import added
from lightcube.kernels.display import Curve, curvature, pull, residual
from lightcube.kernels.exponential import exp, log
from lightcube.kernels.joint import TINY, alike, run_length, through
from lightcube.kernels.light import Mixture, divide, falling, of_pixels

Array = NDArray[Any]

#: Parts that the entries of a picture are divided into at most.
PARTS = 16
#: The least part of all light that a view counts as in bounds on curvature, relative to its part without a cube.
_LEAST_PART = 0.2


@compiled
def _parts(starts: Array, entries: int, columns: int) -> int:
    """Parts of a picture."""
    run = run_length(starts, entries, columns)
    return min(PARTS, (entries + run - 1) // run)


@compiled
def _stretches(first: int, last: int, starts: Array, entries: int, columns: int) -> list[tuple[int, int, int, int]]:
    """What tasks `first` to before `last` walk: the task, its picture, a run's first entry, and one after its last.

    Runs are whole rows.
    """
    run, parts = run_length(starts, entries, columns), _parts(starts, entries, columns)
    rows, found = entries // columns, []
    for task in range(first, last):
        part = task % parts
        begin, stop = part * rows // parts * columns, (part + 1) * rows // parts * columns
        for start in range(begin, stop, run):
            found.append((task, task // parts, start, min(start + run, stop)))  # noqa: PERF401 - numba compiles it
    return found


@compiled
def _shine(powers: Array, first: int, last: int, joint: Array, start: int, end: int, lit: Array, u: Array) -> None:
    """Write which part of all light groups `first` to before `last` make up (`lit`), and ln light (`u`)."""
    channels = powers.shape[1]
    count = end - start
    least, whole = np.empty(count, joint.dtype), np.zeros(count, joint.dtype)
    least[:] = joint[first, start:end]
    for g in range(first + 1, last):
        least = np.minimum(least, joint[g, start:end])
    for g in range(first, last):
        for i in range(count):
            lit[g - first, i] = powers[g, i % channels] * exp(least[i] - joint[g, start + i])
            whole[i] += lit[g - first, i]
    tiny = joint.dtype.type(TINY)
    for i in range(count):
        whole[i] = max(whole[i], tiny)
        u[i] = log(whole[i]) - least[i]
    for g in range(last - first):
        lit[g, :count] /= whole


@compiled
def _room(starts: Array, run: int, wanted: Array) -> tuple[Array, Array]:
    """Room for so many entries of what `starts` counts of a picture, and of one of it."""
    most = 1
    for picture in range(len(starts) - 1):
        most = max(most, starts[picture + 1] - starts[picture])
    return np.empty((most, run), wanted.dtype), np.empty(run, wanted.dtype)


def _run(kernel: Any, starts: Array, shape: tuple[int, ...], columns: int, *arguments: Any) -> None:
    """Run a loop whose tasks are the parts of all pictures; `shape` is ``(pictures, entries)``."""
    pictures, entries = shape
    tasks.run(kernel, pictures * _parts(starts, entries, columns), 8 * starts[-1] * entries, starts, *arguments)


def descend(
    starts: Array, powers: Array, joint: Array, columns: int, wanted: Array, weights: Array, curve: Curve, slopes: Array
) -> None:
    """Write the derivative of the objective by the joint absorbance to `slopes`, which may be `joint` itself."""
    _run(_descend, starts, wanted.shape, columns, powers, joint, columns, wanted, weights, curve, slopes)


@compiled
def _descend(
    first_task: int,
    last_task: int,
    starts: Array,
    powers: Array,
    joint: Array,
    columns: int,
    wanted: Array,
    weights: Array,
    curve: Curve,
    slopes: Array,
) -> None:
    lit, u = _room(starts, run_length(starts, wanted.shape[1], columns), wanted)
    for _, p, start, end in _stretches(first_task, last_task, starts, wanted.shape[1], columns):
        first, last = starts[p], starts[p + 1]
        _shine(powers, first, last, joint, start, end, lit, u)
        for i in range(end - start):
            value, slope = residual(u[i], wanted[p, start + i], curve)
            u[i] = weights[p, start + i] * value * slope
        for g in range(first, last):
            for i in range(end - start):
                slopes[g, start + i] = -u[i] * lit[g - first, i]


def arrive(
    starts: Array, powers: Array, joint: Array, columns: int, wanted: Array, weights: Array, curve: Curve
) -> Array:
    """The objective of each column."""
    pictures, entries = wanted.shape
    sums = np.zeros((pictures * _parts(starts, entries, columns), columns))
    _run(_arrive, starts, wanted.shape, columns, powers, joint, wanted, weights, curve, sums)
    return 0.5 * added(sums)


@compiled
def _arrive(
    first_task: int,
    last_task: int,
    starts: Array,
    powers: Array,
    joint: Array,
    wanted: Array,
    weights: Array,
    curve: Curve,
    sums: Array,
) -> None:
    columns = sums.shape[1]
    lit, u = _room(starts, run_length(starts, wanted.shape[1], columns), wanted)
    for task, p, start, end in _stretches(first_task, last_task, starts, wanted.shape[1], columns):
        _shine(powers, starts[p], starts[p + 1], joint, start, end, lit, u)
        for i in range(end - start):
            value, _ = residual(u[i], wanted[p, start + i], curve)
            sums[task, i % columns] += weights[p, start + i] * value * value


def pulls(
    starts: Array, powers: Array, joint: Array, columns: int, wanted: Array, weights: Array, curve: Curve
) -> tuple[Array, Array]:
    """Derivatives by ln P of each group, and bounds on the second ones, each ``(groups, channels)``."""
    sums = np.zeros((2, PARTS, *powers.shape))
    _run(_pulls, starts, wanted.shape, columns, powers, joint, columns, wanted, weights, curve, sums)
    first, second = sums.sum(axis=1)
    return first, second


@compiled
def _pulls(
    first_task: int,
    last_task: int,
    starts: Array,
    powers: Array,
    joint: Array,
    columns: int,
    wanted: Array,
    weights: Array,
    curve: Curve,
    sums: Array,
) -> None:
    channels, parts = powers.shape[1], _parts(starts, wanted.shape[1], columns)
    lit, u = _room(starts, run_length(starts, wanted.shape[1], columns), wanted)
    bends = np.empty_like(u)
    for task, p, start, end in _stretches(first_task, last_task, starts, wanted.shape[1], columns):
        _shine(powers, starts[p], starts[p + 1], joint, start, end, lit, u)
        for i in range(end - start):
            first, second = pull(u[i], wanted[p, start + i], curve)
            u[i], bends[i] = weights[p, start + i] * first, weights[p, start + i] * second
        for g in range(starts[p], starts[p + 1]):
            for i in range(end - start):
                s, c, part = min(lit[g - starts[p], i], 1), i % channels, task % parts
                sums[0, part, g, c] += s * u[i]
                sums[1, part, g, c] += s * bends[i] + min(s, 2 * s * (1 - s)) * max(u[i], 0)


def curvatures(
    starts: Array,
    powers: Array,
    joint: Array,
    columns: int,
    wanted: Array,
    weights: Array,
    curve: Curve,
    room: Any,
    views: Mixture,
    absorbance: Array,
    values: Array,
) -> None:
    """Multiply `values` by bounds on the weighted second derivatives while ln light rises by no more than `room`.

    They are by the absorbance of each of the `views` that make the groups. The part of a view that absorbs nearly all
    counts as `_LEAST_PART` of what it is without a cube: where a beam has grown dark among brighter ones, it would
    have no bound on its way back.
    """
    seen = views.starts[starts]  # the views of a picture
    data = starts, powers, joint, columns, wanted, weights, curve, room, views, absorbance, values
    _run(_curvatures, seen, wanted.shape, columns, *data)


@compiled
def _bare(powers: Array, views: Mixture, first: int, last: int, start: int, end: int, inverse: Array) -> None:
    """Write 1 over the light of groups `first` to before `last` without a cube."""
    channels = powers.shape[1]
    inverse[:] = 0
    for g in range(first, last):
        for v in range(views.starts[g], views.starts[g + 1]):
            light = of_pixels(views.light[v], start // channels, (end - start) // channels)
            for i in range(end - start):
                inverse[i] += powers[g, i % channels] * falling(views.powers[v, i % channels], light[i // channels])
    for i in range(end - start):
        inverse[i] = 1 / max(inverse[i], inverse.dtype.type(TINY))


@compiled
def _curvatures(
    first_task: int,
    last_task: int,
    seen: Array,
    starts: Array,
    powers: Array,
    joint: Array,
    columns: int,
    wanted: Array,
    weights: Array,
    curve: Curve,
    room: Any,
    views: Mixture,
    absorbance: Array,
    values: Array,
) -> None:
    floor, channels = wanted.dtype.type(_LEAST_PART), powers.shape[1]
    run = run_length(seen, wanted.shape[1], columns)
    lit, u = _room(starts, run, wanted)
    parts, bare = _room(seen, run, wanted)
    bend, clear, dark = np.empty_like(u), np.empty_like(u), np.empty_like(u)
    for _, p, start, end in _stretches(first_task, last_task, seen, wanted.shape[1], columns):
        first, count = starts[p], end - start
        _shine(powers, first, starts[p + 1], joint, start, end, lit, u)
        _bare(powers, views, first, starts[p + 1], start, end, bare)
        bend[:] = 0
        for g in range(first, starts[p + 1]):
            for v in range(views.starts[g], views.starts[g + 1]):
                s = parts[v - seen[p], :count]
                if v == seen[p] or not alike(views, v):
                    divide(views, v, start, count, clear, dark)
                through(dark[:count], absorbance[v, start:end], joint[g, start:end], s)
                for i in range(count):
                    least = floor * (powers[g, i % channels] * dark[i] * bare[i])
                    s[i] = max(s[i] * lit[g - first, i], least)
                    bend[i] += s[i]
        for i in range(count):
            at, weight = wanted[p, start + i], weights[p, start + i]
            brighter = u[i] + room
            bend[i] *= weight * curvature(brighter, at, curve)
            u[i] = weight * max(pull(brighter, at, curve)[0], 0)
        for v in range(seen[p], seen[p + 1]):
            for i in range(count):
                part = parts[v - seen[p], i]
                values[v, start + i] *= part * bend[i] + min(part, abs(2 * part * (1 - part))) * u[i]
