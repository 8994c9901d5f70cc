"""Views under one lamp that add up, as one view: the absorbance that they have together.

Group g of a mixture is views ``starts[g]`` to before ``starts[g + 1]``, whose `powers` are their shares of the lamp's.
Under a lamp of power P it shows ``P e^-E`` with ``E = -ln sum_v share_v g_v (1 - a_v + a_v e^-A_v)``: the joint
absorbance E, ``(groups, entries)``, does not depend on the lamp, and ``dE/dA_v`` is the part of the group's light that
comes through the cube along view v, ``share_v g_v a_v e^(E - A_v)``. So lamps are found, and light is compared with
what is wanted, as if each group were one view. Results do not depend on the number of threads.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import tasks
from lightcube.kernels.compiled import compiled
from lightcube.kernels.exponential import exp, log
from lightcube.kernels.light import Mixture, divide

Array = NDArray[Any]

#: Numbers of a run's views that stay in the cache from one walk over them to the next, and entries of a run at most.
_KEPT, _RUN = 16384, 4096
#: Pixels that count together, or not.
_BLOCK = 4
#: Parts that the rows of a block are divided into, and numbers that are walked at a time there.
_PARTS, _LINES = 64, 1024
#: Light is scaled by at most e to this, so that neither it nor its inverse leaves the range of float32.
_MOST = 60.0
#: Less light than this is as good as none.
TINY = 1e-30


@compiled
def run_length(starts: Array, entries: int, whole: int) -> int:
    """Entries of a run: a multiple of `whole`, so few that what all views of a group have there is kept."""
    most = 1
    for group in range(len(starts) - 1):
        most = max(most, starts[group + 1] - starts[group])
    return max(1, min(min(_KEPT // most, _RUN), entries) // whole) * whole


@compiled
def alike(mixture: Mixture, view: int) -> bool:
    """Whether the view has the light of the one before it, at all pixels."""
    if mixture.light.shape[1] > 1 or mixture.shadow[view, 0] != mixture.shadow[view - 1, 0]:
        return False
    same = mixture.light[view, 0] == mixture.light[view - 1, 0]
    for channel in range(mixture.powers.shape[1]):
        same = same and mixture.powers[view, channel] == mixture.powers[view - 1, channel]
    return bool(same)


def runs_of(counts: NDArray[np.bool_], groups: Array, starts: Array, channels: int) -> NDArray[np.int64]:
    """``(runs, 4)``: a group, the first of some of its entries, one after the last, and whether any of them counts.

    ``counts[p]`` says it of the pixels of picture p, which groups ``groups[p]`` to before ``groups[p + 1]`` make; views
    ``starts[g]`` to before ``starts[g + 1]`` are those of group g. All entries of all groups are in one run.
    """
    pictures, pixels = counts.shape
    blocks = -(-pixels // _BLOCK)
    padded = np.pad(counts, ((0, 0), (0, blocks * _BLOCK - pixels)))
    heard = np.asarray(np.any(padded.reshape(pictures, blocks, _BLOCK), axis=2))
    begins = np.ones(heard.shape, np.bool_)
    begins[:, 1:] = heard[:, 1:] != heard[:, :-1]
    begins[:, :: max(1, run_length(starts, pixels * channels, channels) // (_BLOCK * channels))] = True
    picture, first = np.nonzero(begins)
    last = np.append(first[1:], blocks)
    last[np.diff(picture, append=-1) != 0] = blocks
    entries = np.minimum(np.stack([first, last]) * _BLOCK, pixels) * channels
    several = np.diff(groups)[picture]
    which = np.repeat(np.arange(len(picture)), several)
    group = groups[picture][which] + np.arange(len(which)) - np.repeat(np.cumsum(several) - several, several)
    return np.stack([group, *entries[:, which], heard[picture, first][which]], axis=1).astype(np.int64)


def join(runs: Array, mixture: Mixture, absorbance: Array, joint: Array) -> None:
    """Write the joint absorbance of each group, ``(groups, entries)``, and 0 where nothing counts.

    `absorbance` is ``(views, entries)``, `runs` what `runs_of` finds.
    """
    _run(_join, runs, mixture, absorbance, joint)


def spread(runs: Array, mixture: Mixture, absorbance: Array, joint: Array, slopes: Array, out: Array) -> None:
    """Write derivatives by the absorbance of each view from `slopes`, those by the joint one, and 0 where none counts.

    They may take the place of `absorbance`.
    """
    _run(_spread, runs, mixture, absorbance, joint, slopes, out)


def _run(kernel: Any, runs: Array, mixture: Mixture, absorbance: Array, *arguments: Any) -> None:
    """Run a loop whose tasks are the runs."""
    views = np.diff(mixture.starts)[runs[:, 0]]
    work = int(np.sum(views * runs[:, 3] * (runs[:, 2] - runs[:, 1])))
    tasks.run(kernel, len(runs), work, runs, mixture, absorbance, *arguments)


@compiled
def _join(first: int, last: int, runs: Array, mixture: Mixture, absorbance: Array, joint: Array) -> None:
    longest = np.max(runs[first:last, 2] - runs[first:last, 1])
    clear, dark = np.empty(longest, joint.dtype), np.empty(longest, joint.dtype)
    falls, comes = np.empty(longest, joint.dtype), np.empty(longest, joint.dtype)
    for task in range(first, last):
        group, start, count = runs[task, 0], runs[task, 1], runs[task, 2] - runs[task, 1]
        first_view, last_view, here = mixture.starts[group], mixture.starts[group + 1], slice(start, start + count)
        least = joint[group, here]
        if not runs[task, 3]:
            least[:] = 0
            continue
        least[:] = absorbance[first_view, here]
        for v in range(first_view + 1, last_view):
            _lower(absorbance[v, here], least)
        falls[:count] = 0
        comes[:count] = 0
        for v in range(first_view, last_view):
            if v == first_view or not alike(mixture, v):
                divide(mixture, v, start, count, clear, dark)
            _add_light(clear[:count], dark[:count], absorbance[v, here], least, falls, comes)
        _finish(falls, comes, least)


@compiled
def _lower(absorbance: Array, least: Array) -> None:
    for i in range(len(least)):
        least[i] = min(least[i], absorbance[i])


@compiled
def _add_light(clear: Array, dark: Array, absorbance: Array, least: Array, falls: Array, comes: Array) -> None:
    """Add up the light that no cube absorbs, and that which comes through one, e^least times as strong."""
    for i in range(len(absorbance)):
        falls[i] += clear[i]
        comes[i] += dark[i] * exp(least[i] - absorbance[i])


@compiled
def _finish(falls: Array, comes: Array, least: Array) -> None:
    """Replace the least absorbance by the joint one."""
    most, tiny = least.dtype.type(_MOST), least.dtype.type(TINY)
    for i in range(len(least)):
        # where some light is not absorbed, the sum cannot fall to nothing
        scale = min(least[i], most) if falls[i] > 0 else least[i]
        light = falls[i] * exp(min(scale, most)) + comes[i] * exp(scale - least[i])
        least[i] = scale - log(max(light, tiny))


@compiled
def _spread(
    first: int, last: int, runs: Array, mixture: Mixture, absorbance: Array, joint: Array, slopes: Array, out: Array
) -> None:
    longest = np.max(runs[first:last, 2] - runs[first:last, 1])
    clear, dark, part = np.empty(longest, joint.dtype), np.empty(longest, joint.dtype), np.empty(longest, joint.dtype)
    for task in range(first, last):
        group, start, count = runs[task, 0], runs[task, 1], runs[task, 2] - runs[task, 1]
        first_view, last_view, here = mixture.starts[group], mixture.starts[group + 1], slice(start, start + count)
        for v in range(first_view, last_view):
            if not runs[task, 3]:
                out[v, here] = 0
                continue
            if v == first_view or not alike(mixture, v):
                divide(mixture, v, start, count, clear, dark)
            through(dark[:count], absorbance[v, here], joint[group, here], part)
            _times(slopes[group, here], part, out[v, here])


@compiled
def through(dark: Array, absorbance: Array, joint: Array, part: Array) -> None:
    """Write the part of a group's light that comes through the cube along one view."""
    for i in range(len(absorbance)):
        part[i] = dark[i] * exp(joint[i] - absorbance[i])


@compiled
def _times(slopes: Array, part: Array, out: Array) -> None:
    for i in range(len(out)):
        out[i] = slopes[i] * part[i]


def least_ahead(last: Array, now: Array) -> Array:
    """The least number of each column if blocks ``(rows, columns)`` changed from `last` to `now` once more."""
    rows, columns = now.shape
    lines = max(1, min(_LINES // columns, rows // _PARTS))  # few columns: several rows are walked as one
    least = np.full((_PARTS, lines * columns), np.inf, now.dtype)
    tasks.run(_least_ahead, _PARTS, now.size, last.reshape(-1), now.reshape(-1), rows, lines, least)
    return least.min(axis=0).reshape(lines, columns).min(axis=0)


@compiled
def _least_ahead(first: int, end: int, last: Array, now: Array, rows: int, lines: int, least: Array) -> None:
    columns = least.shape[1] // lines
    for part in range(first, end):
        stop = (part + 1) * rows // _PARTS
        for row in range(part * rows // _PARTS, stop, lines):
            here = slice(row * columns, min(row + lines, stop) * columns)
            _lower_ahead(last[here], now[here], least[part])


@compiled
def _lower_ahead(last: Array, now: Array, least: Array) -> None:
    for i in range(len(now)):
        least[i] = min(least[i], now[i] + (now[i] - last[i]))
