"""Light of several views that adds up on the screen, and the two-sided residual of the sum.

Views, their entries, and the light ``P g (1 - a + a e^-absorbance)`` that each of them shows are as in
`lightcube.kernels.light`; the screen shows ``e^u``, the sum. So ``du/d absorbance = -s`` with
``s`` the part of all light that P g a e^-absorbance makes up, and the second derivatives of u are ``diag(s) - s s'``. A
convex function f of u has then, by absorbance, a second derivative of at most ``diag(s (f'' sum(s) + max(f', 0)))``,
and where f' pulls, ``min(s, 2 s (1 - s))`` takes the place of s (sums of rows of the matrix). Results do not depend on
the number of threads.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import tasks
from lightcube.kernels.compiled import compiled
from lightcube.kernels.descent import added
from lightcube.kernels.display import Curve, curvature, pull, residual
from lightcube.kernels.exponential import exp
from lightcube.kernels.light import Mixture, divide, falling, of_pixels

Array = NDArray[Any]

#: Numbers that a task keeps of its run's views, and parts that the entries of a picture are divided into at most.
_KEPT, PARTS = 16384, 16
#: Light is scaled by at most e to this, so that neither it nor its inverse leaves the range of float32.
_MOST = 60.0
#: The least part of all light that a view counts as in bounds on curvature, relative to its part without a cube.
_LEAST_PART = 0.2


@compiled
def _runs(mixture: Mixture, entries: int, columns: int) -> tuple[int, int, int]:
    """Most views of a picture, entries of a run (whole rows), and parts of a picture."""
    most = 1
    for picture in range(len(mixture.starts) - 1):
        most = max(most, mixture.starts[picture + 1] - mixture.starts[picture])
    rows = entries // columns
    run = max(1, min(_KEPT // (most * columns), rows))
    return most, run * columns, min(PARTS, (rows + run - 1) // run)


@compiled
def _stretches(first: int, last: int, mixture: Mixture, entries: int, columns: int) -> list[tuple[int, int, int, int]]:
    """What tasks `first` to before `last` walk: the task, its picture, a run's first entry, and one after its last."""
    _, run, parts = _runs(mixture, entries, columns)
    rows, found = entries // columns, []
    for task in range(first, last):
        part = task % parts
        begin, stop = part * rows // parts * columns, (part + 1) * rows // parts * columns
        for start in range(begin, stop, run):
            found.append((task, task // parts, start, min(start + run, stop)))  # noqa: PERF401 - numba compiles it
    return found


@compiled
def _room(mixture: Mixture, wanted: Array, columns: int) -> tuple[Array, Array, Array]:
    """Room for `lit`, `through` and `u` of `_shine`, of the longest run."""
    most, run, _ = _runs(mixture, wanted.shape[1], columns)
    lit, through = np.empty((most, run), wanted.dtype), np.empty((most, run), wanted.dtype)
    return lit, through, np.empty(run, wanted.dtype)


@compiled
def _shine(
    mixture: Mixture, picture: int, absorbance: Array, start: int, end: int, lit: Array, through: Array, u: Array
) -> None:
    """Write what each view makes of all light (`lit`), what of that came `through` the cube, and ln light (`u`).

    Both are parts of the whole: those `lit` add up to 1, and `through` is what changes with the absorbance.
    """
    first, last = mixture.starts[picture], mixture.starts[picture + 1]
    count = end - start
    least = np.full(count, absorbance.dtype.type(np.inf))
    whole = np.zeros(count, absorbance.dtype)
    for v in range(first, last):
        for i in range(count):
            least[i] = min(least[i], absorbance[v, start + i])
    for v in range(first, last):
        clear = lit[v - first]
        divide(mixture, v, start, count, clear, through[v - first])
        for i in range(count):
            whole[i] += clear[i]
    most = absorbance.dtype.type(_MOST)
    for i in range(count):  # where some light is not absorbed, the sum cannot fall to nothing
        least[i] = min(least[i], most) if whole[i] > 0 else least[i]
        whole[i] = 0
    for v in range(first, last):
        clear, dark = lit[v - first], through[v - first]
        for i in range(count):
            dark[i] *= exp(least[i] - absorbance[v, start + i])
            clear[i] = clear[i] * exp(min(least[i], most)) + dark[i]
            whole[i] += clear[i]
    tiny = absorbance.dtype.type(1e-30)
    for i in range(count):
        whole[i] = max(whole[i], tiny)
        u[i] = math.log(whole[i]) - least[i]
        whole[i] = 1 / whole[i]
    for j in range(last - first):
        for i in range(count):
            lit[j, i] *= whole[i]
            through[j, i] *= whole[i]


@compiled
def _bare(mixture: Mixture, picture: int, start: int, end: int, inverse: Array) -> None:
    """Write 1 over the light without a cube."""
    channels = mixture.powers.shape[1]
    inverse[:] = 0
    for v in range(mixture.starts[picture], mixture.starts[picture + 1]):
        light = of_pixels(mixture.light[v], start // channels, (end - start) // channels)
        for i in range(end - start):
            inverse[i] += falling(mixture.powers[v, i % channels], light[i // channels])
    for i in range(end - start):
        inverse[i] = 1 / max(inverse[i], inverse.dtype.type(1e-30))


def _run(kernel: Any, mixture: Mixture, shape: tuple[int, ...], columns: int, *arguments: Any) -> None:
    """Run a loop whose tasks are the parts of all pictures; `shape` is ``(pictures, entries)``."""
    pictures, entries = shape
    parts = _runs(mixture, entries, columns)[2]
    tasks.run(kernel, pictures * parts, 8 * len(mixture.light) * entries, *arguments)


def descend(
    mixture: Mixture, absorbance: Array, columns: int, wanted: Array, weights: Array, curve: Curve, slopes: Array
) -> None:
    """Write the derivative of the objective by the absorbance to `slopes`, which may be `absorbance` itself."""
    data = mixture, absorbance, columns, wanted, weights, curve, slopes
    _run(_descend, mixture, wanted.shape, columns, *data)


@compiled
def _descend(
    first_task: int,
    last_task: int,
    mixture: Mixture,
    absorbance: Array,
    columns: int,
    wanted: Array,
    weights: Array,
    curve: Curve,
    slopes: Array,
) -> None:
    lit, through, u = _room(mixture, wanted, columns)
    for _, p, start, end in _stretches(first_task, last_task, mixture, wanted.shape[1], columns):
        _shine(mixture, p, absorbance, start, end, lit, through, u)
        for i in range(end - start):
            value, slope = residual(u[i], wanted[p, start + i], curve)
            u[i] = weights[p, start + i] * value * slope
        for v in range(mixture.starts[p], mixture.starts[p + 1]):
            for i in range(end - start):
                slopes[v, start + i] = -u[i] * through[v - mixture.starts[p], i]


def arrive(
    mixture: Mixture, last: Array, now: Array, columns: int, wanted: Array, weights: Array, curve: Curve
) -> tuple[Array, Array]:
    """Of each column, the objective at absorbance `now`, and the least absorbance if it changed as much once more."""
    pictures, entries = wanted.shape
    room = pictures * _runs(mixture, entries, columns)[2], columns
    sums, least = np.zeros(room), np.full(room, np.inf)
    data = mixture, last, now, columns, wanted, weights, curve, sums, least
    _run(_arrive, mixture, wanted.shape, columns, *data)
    return 0.5 * added(sums), least.min(axis=0)


@compiled
def _arrive(
    first_task: int,
    last_task: int,
    mixture: Mixture,
    last: Array,
    now: Array,
    columns: int,
    wanted: Array,
    weights: Array,
    curve: Curve,
    sums: Array,
    least: Array,
) -> None:
    lit, through, u = _room(mixture, wanted, columns)
    for task, p, start, end in _stretches(first_task, last_task, mixture, wanted.shape[1], columns):
        _shine(mixture, p, now, start, end, lit, through, u)
        for i in range(end - start):
            value, _ = residual(u[i], wanted[p, start + i], curve)
            sums[task, i % columns] += weights[p, start + i] * value * value
        for v in range(mixture.starts[p], mixture.starts[p + 1]):
            for i in range(end - start):
                ahead = now[v, start + i] + (now[v, start + i] - last[v, start + i])
                least[task, i % columns] = min(least[task, i % columns], float(ahead))


def curvatures(
    mixture: Mixture,
    absorbance: Array,
    columns: int,
    wanted: Array,
    weights: Array,
    curve: Curve,
    room: Any,
    values: Array,
) -> None:
    """Multiply `values` by bounds on the weighted second derivatives while ln light rises by no more than `room`.

    The part of a view that absorbs nearly all counts as `_LEAST_PART` of what it is without a cube: where a beam has
    grown dark among brighter ones, it would have no bound on its way back.
    """
    data = mixture, absorbance, columns, wanted, weights, curve, room, values
    _run(_curvatures, mixture, wanted.shape, columns, *data)


@compiled
def _curvatures(
    first_task: int,
    last_task: int,
    mixture: Mixture,
    absorbance: Array,
    columns: int,
    wanted: Array,
    weights: Array,
    curve: Curve,
    room: Any,
    values: Array,
) -> None:
    floor = wanted.dtype.type(_LEAST_PART)
    lit, through, u = _room(mixture, wanted, columns)
    bare, bend, clear, dark = np.empty_like(u), np.empty_like(u), np.empty_like(u), np.empty_like(u)
    for _, p, start, end in _stretches(first_task, last_task, mixture, wanted.shape[1], columns):
        _shine(mixture, p, absorbance, start, end, lit, through, u)
        _bare(mixture, p, start, end, bare)
        bend[:] = 0
        for v in range(mixture.starts[p], mixture.starts[p + 1]):
            s = through[v - mixture.starts[p]]
            divide(mixture, v, start, end - start, clear, dark)
            for i in range(end - start):
                s[i] = max(s[i], floor * (dark[i] * bare[i]))
                bend[i] += s[i]
        for i in range(end - start):
            at, weight = wanted[p, start + i], weights[p, start + i]
            brighter = u[i] + room
            bend[i] *= weight * curvature(brighter, at, curve)
            u[i] = weight * max(pull(brighter, at, curve)[0], 0)
        for v in range(mixture.starts[p], mixture.starts[p + 1]):
            for i in range(end - start):
                s_i = through[v - mixture.starts[p], i]
                values[v, start + i] *= s_i * bend[i] + min(s_i, abs(2 * s_i * (1 - s_i))) * u[i]


def pulls(
    mixture: Mixture,
    groups: Array,
    absorbance: Array,
    columns: int,
    wanted: Array,
    weights: Array,
    curve: Curve,
    sums: Array,
) -> None:
    """Add the derivatives by ln P of each group of views, and bounds on the second ones, to ``sums[0]``, ``sums[1]``.

    ``groups[v]`` is the group of view v: views of a picture and a lamp follow each other. `sums` is
    ``(2, PARTS, groups, channels)``, to be summed.
    """
    data = mixture, groups, absorbance, columns, wanted, weights, curve, sums
    _run(_pulls, mixture, wanted.shape, columns, *data)


@compiled
def _pulls(
    first_task: int,
    last_task: int,
    mixture: Mixture,
    groups: Array,
    absorbance: Array,
    columns: int,
    wanted: Array,
    weights: Array,
    curve: Curve,
    sums: Array,
) -> None:
    channels, parts = mixture.powers.shape[1], _runs(mixture, wanted.shape[1], columns)[2]
    lit, through, u = _room(mixture, wanted, columns)
    bends, share = np.empty_like(u), np.empty_like(u)
    for task, p, start, end in _stretches(first_task, last_task, mixture, wanted.shape[1], columns):
        _shine(mixture, p, absorbance, start, end, lit, through, u)
        for i in range(end - start):
            first, second = pull(u[i], wanted[p, start + i], curve)
            u[i], bends[i] = weights[p, start + i] * first, weights[p, start + i] * second
        share[:] = 0
        for v in range(mixture.starts[p], mixture.starts[p + 1]):
            share += lit[v - mixture.starts[p]]
            if v + 1 < mixture.starts[p + 1] and groups[v + 1] == groups[v]:
                continue
            for i in range(end - start):
                s, c, part = min(share[i], 1), i % channels, task % parts
                sums[0, part, groups[v], c] += s * u[i]
                sums[1, part, groups[v], c] += s * bends[i] + min(s, 2 * s * (1 - s)) * max(u[i], 0)
            share[:] = 0
