"""Any method, asked for amounts of dyes instead of extinction: colours become further pictures of one column.

A method sees nothing of dyes: its matrix is that of `lightcube.projection.inked`, its unknowns are parts of each dye's
limit, between 0 and 1, and each lamp is one for every colour.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from lightcube.optics.arrays import Floats, Integers, Reals
from lightcube.optics.dyes import Dyes
from lightcube.optics.law import Mixture
from lightcube.projection.inked import Inked
from lightcube.solvers.contract import Callback, Lighting, Operator, Progress, Result, Wanted
from lightcube.solvers.method import Method


def solve_amounts(
    method: Method, matrix: Operator, wanted: Wanted, dyes: Dyes, *, callback: Callback | None = None, **options: Any
) -> Result:
    """Solve for parts of each dye's limit, ``(dyes * unknowns, columns / colours)``.

    Parameters
    ----------
    method
        How it is solved.
    matrix, wanted, callback, options
        As in `lightcube.solvers.contract.Solver`, of colours: powers of lamps, and pixels that are rejected, are told
        as it has them.
    dyes
        Their extinction, 1/mm, and the clear material's, which is there whatever is solved.
    """

    def told(progress: Progress) -> bool:
        powers = _together(progress.lamp_powers, wanted.channels)
        return callback is not None and bool(callback(replace(progress, lamp_powers=powers)))

    inked, asked = Inked(matrix, dyes.extinction * dyes.limit[:, None]), _apart(wanted)
    if np.any(dyes.base):
        asked = _behind(_clear(matrix, asked, dyes.base), asked, method)
    result = method.solve(inked, asked, bounds=(0.0, 1.0), callback=told, **options)
    powers = _together(result.lamp_powers, wanted.channels)
    return replace(result, lamp_powers=powers, rejected=_of_colours(result.rejected, matrix.shape[0], wanted.channels))


def _apart(wanted: Wanted) -> Wanted:
    """The same, where each picture of each colour is a picture of its own, under lamps of its own: colour by colour."""
    colours, lighting = wanted.channels, wanted.lighting
    low, high = (np.ascontiguousarray(bound.T).reshape(-1, 1) for bound in wanted.lamp_bounds)
    lamps = len(low) // colours
    lamp = np.concatenate([lighting.lamp + colour * lamps for colour in range(colours)])
    mixture = lighting.mixture
    if mixture is not None:
        views, starts = len(mixture.light), mixture.starts
        mixture = Mixture(
            np.append(np.concatenate([starts[:-1] + colour * views for colour in range(colours)]), colours * views),
            np.ascontiguousarray(mixture.share.T).reshape(-1, 1),
            np.tile(mixture.light, (colours, 1)),
            np.tile(mixture.shadow, (colours, 1)),
        )
    light, weights = (_by_colour(each, colours) for each in (wanted.light, wanted.weights))
    return Wanted(light, weights, Lighting(lamp, mixture), (low, high), wanted.transfer)


def _by_colour(block: Floats, colours: int) -> Floats:
    """``(colours * rows, columns)`` of ``(rows, columns * colours)``."""
    rows = block.reshape(len(block), -1, colours)
    return np.ascontiguousarray(rows.transpose(2, 0, 1)).reshape(colours * len(block), -1)


def _clear(matrix: Operator, apart: Wanted, base: Reals) -> Floats:
    """``(views, pixels)``: what part of each beam, colour by colour, a clear block lets through."""
    light = apart.light
    chord = matrix.forward(np.ones((matrix.shape[1], len(base)), light.dtype))[:, :1]
    through = np.exp(-base.astype(light.dtype)[:, None, None] * chord)
    return np.repeat(through, light.shape[1], axis=2).reshape(len(apart.lighting.lamp), -1)


def _behind(clear: Floats, wanted: Wanted, method: Method) -> Wanted:
    """The same, wanted of what is put into a clear block that lets such parts of light through.

    With ``T`` what the dyes let through, the law's ``g (1 - a (1 - B T))`` is ``g' (1 - a' (1 - T))``. Methods that
    know no sums take logarithms, and there more light is wanted instead.
    """
    lighting, mixture = wanted.lighting, wanted.lighting.mixture
    if mixture is None and not method.takes_sums:
        light = wanted.light / clear.reshape(wanted.light.shape)
        return Wanted(light, wanted.weights, lighting, wanted.lamp_bounds, wanted.transfer)
    sums = mixture or Mixture.of_whole_views(len(clear), 1)
    reaches = 1 - sums.shadow * (1 - clear)
    shadow = np.minimum(sums.shadow * clear / reaches, 1)  # rounding may leave more
    behind = Mixture(sums.starts, sums.share, sums.light * reaches, shadow)
    return Wanted(wanted.light, wanted.weights, Lighting(lighting.lamp, behind), wanted.lamp_bounds, wanted.transfer)


def _together(powers: Floats, colours: int) -> Reals:
    """Powers ``(lamps, colours)`` of those that stand colour by colour."""
    return np.array(powers.reshape(colours, -1).T, np.float64)


def _of_colours(rejected: Integers, equations: int, colours: int) -> Integers:
    """Pairs of (equation, column) of those whose equations stand colour by colour."""
    colour, equation = np.divmod(rejected[:, 0], equations)
    return np.stack([equation, rejected[:, 1] * colours + colour], axis=1)
