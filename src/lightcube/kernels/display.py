"""The two-sided residual in display values, entry by entry (see `lightcube.solvers.display`)."""

import math
from typing import Any

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

Array = NDArray[Any]

#: Slope that a beam too dark is pulled back with at least, per unit of ln light.
SLOPE_FLOOR = 0.03
#: sRGB (IEC 61966-2-1): where the straight toe ends in linear light, its slope; offset and gamma of the power above.
_TOE, _TOE_SLOPE, _OFFSET, _GAMMA = 0.0031308, 12.92, 0.055, 2.4


@njit(cache=True)
def display_of_log(u: float, srgb: bool) -> tuple[float, float, float]:
    """Return g, g' and g'' at `u` = ln(linear light), with g the display value: sRGB, or linear light itself."""
    if not srgb:
        value = math.exp(u)
        return value, value, value
    if u <= math.log(_TOE):
        value = _TOE_SLOPE * math.exp(u)
        return value, value, value
    power = (1 + _OFFSET) * math.exp(u / _GAMMA)
    return power - _OFFSET, power / _GAMMA, power / (_GAMMA * _GAMMA)


@njit(cache=True)
def residual(u: float, wanted: float, srgb: bool) -> tuple[float, float]:
    """Return the two-sided residual and its slope in `u`; both arguments are ln(linear light)."""
    target, slope, _ = display_of_log(wanted, srgb)
    if u > wanted:
        value, steepness, _ = display_of_log(u, srgb)
        return value - target, steepness
    slope = max(slope, SLOPE_FLOOR)
    return slope * (u - wanted), slope


@njit(cache=True)
def curvature(u: float, wanted: float, srgb: bool) -> float:
    """Return the largest second derivative of half the squared residual for any light up to `u` or the wanted one."""
    target, slope, _ = display_of_log(wanted, srgb)
    value, steepness, bend = display_of_log(max(u, wanted), srgb)
    dark = max(slope, SLOPE_FLOOR)
    return max(steepness * steepness + (value - target) * bend, dark * dark)


@njit(cache=True, parallel=True)
def descend(
    absorbance: Array, lamp: Array, view_of_row: Array, wanted: Array, weights: Array, srgb: bool, slopes: Array
) -> None:
    """Write the derivative of the objective by the absorbance to `slopes`, which may be `absorbance` itself.

    ``lamp[view, channel]`` is ln P; the objective is half the weighted sum of squared residuals.
    """
    rows, columns = absorbance.shape
    for row in prange(rows):
        powers = lamp[view_of_row[row]]
        for column in range(columns):
            u = powers[column % len(powers)] - absorbance[row, column]
            value, slope = residual(u, wanted[row, column], srgb)
            slopes[row, column] = -weights[row, column] * value * slope


@njit(cache=True)
def _pull(u: float, wanted: float, srgb: bool) -> tuple[float, float]:
    """Return the first and second derivative by `u` of half the squared residual."""
    target, slope, _ = display_of_log(wanted, srgb)
    if u > wanted:
        value, steepness, bend = display_of_log(u, srgb)
        return (value - target) * steepness, steepness * steepness + (value - target) * bend
    slope = max(slope, SLOPE_FLOOR)
    return slope * slope * (u - wanted), slope * slope


@njit(cache=True)
def conjugate(slope: float, wanted: float, srgb: bool) -> float:
    """Return the largest ``slope u - f(u)`` over all `u`, with f half the squared residual (its convex conjugate)."""
    _, least, _ = display_of_log(wanted, srgb)
    least = max(least, SLOPE_FLOOR)
    if slope <= 0:
        return slope * wanted + 0.5 * slope * slope / (least * least)
    below, above = wanted, wanted + 1.0
    while _pull(above, wanted, srgb)[0] < slope:
        below, above = above, 2 * above - wanted
    u = above
    for _ in range(60):
        first, second = _pull(u, wanted, srgb)
        if first < slope:
            below = u
        else:
            above = u
        following = u - (first - slope) / second
        if not below < following < above:
            following = 0.5 * (below + above)
        moved = abs(following - u)
        u = following
        if moved < 1e-9:
            break
    value, _ = residual(u, wanted, srgb)
    return slope * u - 0.5 * value * value


@njit(cache=True, parallel=True)
def conjugates(slopes: Array, wanted: Array, weights: Array, srgb: bool) -> Array:
    """Sum of the weighted terms' convex conjugates at `slopes`, one number per row; slopes are 0 where weights are."""
    rows, columns = slopes.shape
    sums = np.zeros(rows)
    for row in prange(rows):
        for column in range(columns):
            weight = weights[row, column]
            if weight > 0:
                sums[row] += weight * conjugate(slopes[row, column] / weight, wanted[row, column], srgb)
    return sums


@njit(cache=True, parallel=True)
def fit_lamp(
    absorbance: Array,
    rows: Array,
    starts: Array,
    wanted: Array,
    weights: Array,
    srgb: bool,
    low: Array,
    high: Array,
    lamp: Array,
) -> None:
    """Replace ``lamp[view, channel]`` = ln P, where to start, by the best one between `low` and `high`.

    The rows of view v are ``rows[starts[v]:starts[v + 1]]``. Newton's method on a convex function of one number,
    kept inside a shrinking bracket by bisection.
    """
    views, channels = lamp.shape
    for task in prange(views * channels):
        view, channel = task // channels, task % channels
        below, above = low[view, channel], high[view, channel]
        u = min(max(lamp[view, channel], below), above)
        tried_low, tried_high = u == below, u == above
        for _ in range(40):
            slope, bend = 0.0, 1e-30
            for k in range(starts[view], starts[view + 1]):
                row = rows[k]
                for column in range(channel, absorbance.shape[1], channels):
                    first, second = _pull(u - absorbance[row, column], wanted[row, column], srgb)
                    slope += weights[row, column] * first
                    bend += weights[row, column] * second
            if slope == 0:
                break
            if slope > 0:
                above, tried_high = u, True
            else:
                below, tried_low = u, True
            following = u - slope / bend
            if following >= above:
                following = 0.5 * (below + above) if tried_high else high[view, channel]
                tried_high = True
            elif following <= below:
                following = 0.5 * (below + above) if tried_low else low[view, channel]
                tried_low = True
            moved = abs(following - u)
            u = following
            if moved < 1e-6:
                break
        lamp[view, channel] = u


@njit(cache=True, parallel=True)
def curvatures(
    absorbance: Array,
    lamp: Array,
    view_of_row: Array,
    wanted: Array,
    weights: Array,
    srgb: bool,
    room: float,
    values: Array,
) -> None:
    """Multiply `values` by the weighted `curvature` that holds while ln light rises by no more than `room`."""
    rows, columns = absorbance.shape
    for row in prange(rows):
        powers = lamp[view_of_row[row]]
        for column in range(columns):
            brightest = powers[column % len(powers)]
            now = brightest - absorbance[row, column]
            u = max(now, min(now + room, brightest))
            values[row, column] *= weights[row, column] * curvature(u, wanted[row, column], srgb)
