"""Plots: functions that return matplotlib figures."""

from typing import TYPE_CHECKING

import numpy as np

from lightcube.between import LOBE_DB, Curve
from lightcube.errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _figure(width: float, height: float) -> "Figure":
    """Return an empty figure of that size in inches, or raise `InputError` where matplotlib is missing."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise InputError("drawing a plot needs one more package: pip install 'lightcube[plot]'") from None
    return Figure(figsize=(width, height), layout="constrained")


def between_plot(curves: dict[str, Curve]) -> "Figure":
    """PSNR against the turntable angle, the stops marked, one panel above the other.

    Parameters
    ----------
    curves
        By the title of their panel; a single one may have none (``""``).
    """
    figure = _figure(9.0, 1.2 + 2.0 * len(curves))
    panels = np.atleast_1d(figure.subplots(len(curves), 1, sharey=True))
    for axes, (title, curve) in zip(panels, curves.items(), strict=True):
        low, high = float(curve.angles[0]), float(curve.angles[0]) + curve.period
        starts = np.flatnonzero(np.diff(curve.nearest)) + 1
        for number, part in enumerate(np.split(np.arange(len(curve.angles)), starts)):
            axes.plot(curve.angles[part], curve.psnr[part], color=("#20639b", "#3caea3")[number % 2], linewidth=1.2)
        stops = curve.offsets == 0
        axes.plot(curve.angles[stops], curve.psnr[stops], "o", color="#173f5f", markersize=3.5)
        axes.axhline(LOBE_DB, color="#999", linewidth=0.8, linestyle="--")
        axes.set(xlim=(low, high), ylabel="PSNR, dB", title=title)
        axes.spines[["top", "right"]].set_visible(False)
        if curve.period == 360:
            axes.set_xticks(np.arange(45 * np.ceil(low / 45), high + 1e-9, 45))
    panels[-1].set_xlabel("turntable angle, degrees")
    return figure
