"""The two-sided residual in display values, of one entry (see `lightcube.solvers.display`).

All is written without branches, so that the compiler can do many entries at once; numbers are float32 or float64
throughout, as the light and the curve are.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import tasks
from lightcube.kernels.compiled import compiled
from lightcube.kernels.exponential import exp

Array = NDArray[Any]


class Curve(NamedTuple):
    """How display values g follow from u = ln(linear light): ``toe_slope e^u`` up to u = `toe`, a power beyond.

    The power is ``scale e^(u / gamma) - offset``. `floor` is the slope that a beam too dark is pulled back with at
    least, per unit of u.
    """

    toe: Any
    toe_slope: Any
    scale: Any
    offset: Any
    inverse_gamma: Any
    floor: Any


def curve(srgb: bool, dtype: type[np.floating[Any]]) -> Curve:
    """Return the curve of sRGB (IEC 61966-2-1), or of linear light itself, in numbers of `dtype`."""
    toe, toe_slope = (np.log(0.0031308), 12.92) if srgb else (np.inf, 1.0)
    return Curve(*(np.dtype(dtype).type(number) for number in (toe, toe_slope, 1.055, 0.055, 1 / 2.4, 0.03)))


@compiled(inline="always")
def display_of_log(u: Any, curve: Curve) -> tuple[Any, Any, Any]:
    """Return g, g' and g'' at `u` = ln(linear light)."""
    in_toe = u <= curve.toe
    power = exp(u if in_toe else u * curve.inverse_gamma)
    value = (curve.toe_slope if in_toe else curve.scale) * power
    slope = value if in_toe else value * curve.inverse_gamma
    bend = slope if in_toe else slope * curve.inverse_gamma
    return value if in_toe else value - curve.offset, slope, bend


@compiled(inline="always")
def residual(u: Any, wanted: Any, curve: Curve) -> tuple[Any, Any]:
    """Return the two-sided residual and its slope in `u`; both arguments are ln(linear light)."""
    target, slope, _ = display_of_log(wanted, curve)
    value, steepness, _ = display_of_log(u, curve)
    slope = max(slope, curve.floor)
    return (value - target if u > wanted else slope * (u - wanted)), (steepness if u > wanted else slope)


@compiled(inline="always")
def pull(u: Any, wanted: Any, curve: Curve) -> tuple[Any, Any]:
    """Return the first and second derivative by `u` of half the squared residual."""
    target, slope, _ = display_of_log(wanted, curve)
    value, steepness, bend = display_of_log(u, curve)
    slope = max(slope, curve.floor)
    off = value - target
    first = off * steepness if u > wanted else slope * slope * (u - wanted)
    return first, (steepness * steepness + off * bend if u > wanted else slope * slope)


@compiled(inline="always")
def curvature(u: Any, wanted: Any, curve: Curve) -> Any:
    """Return the largest second derivative of half the squared residual for any light up to `u` or the wanted one."""
    target, slope, _ = display_of_log(wanted, curve)
    value, steepness, bend = display_of_log(max(u, wanted), curve)
    dark = max(slope, curve.floor)
    return max(steepness * steepness + (value - target) * bend, dark * dark)


@compiled
def conjugate(slope: float, wanted: float, curve: Curve) -> float:
    """Return the largest ``slope u - f(u)`` over all `u`, with f half the squared residual (its convex conjugate)."""
    _, least, _ = display_of_log(wanted, curve)
    least = max(least, curve.floor)
    if slope <= 0:
        return slope * wanted + 0.5 * slope * slope / (least * least)
    below, above = wanted, wanted + 1.0
    while pull(above, wanted, curve)[0] < slope:
        below, above = above, 2 * above - wanted
    u = above
    for _ in range(60):
        first, second = pull(u, wanted, curve)
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
    value, _ = residual(u, wanted, curve)
    return slope * u - 0.5 * value * value


def conjugates(slopes: Array, wanted: Array, weights: Array, curve: Curve) -> Array:
    """Sum of the weighted terms' convex conjugates at `slopes`, one number per row; slopes are 0 where weights are."""
    sums = np.zeros(len(slopes))
    tasks.run(_conjugates, len(slopes), 50 * slopes.size, slopes, wanted, weights, curve, sums)
    return sums


@compiled
def _conjugates(first: int, last: int, slopes: Array, wanted: Array, weights: Array, curve: Curve, sums: Array) -> None:
    for row in range(first, last):
        for column in range(slopes.shape[1]):
            weight = weights[row, column]
            if weight > 0:
                sums[row] += weight * conjugate(slopes[row, column] / weight, wanted[row, column], curve)
