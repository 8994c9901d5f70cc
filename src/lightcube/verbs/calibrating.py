"""From a photograph of a printed wedge, or from densities, to inks."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from lightcube import io
from lightcube.calibration.finding import Readings, read_wedge
from lightcube.calibration.fitting import Fitted, fit_inks
from lightcube.calibration.wedge import Patch, Wedge
from lightcube.errors import InputError
from lightcube.io.densities import FILM, Density, read_densities
from lightcube.io.materials import LN10
from lightcube.optics.transfer import Transfer


def fitted(source: str, inks: tuple[str, ...], steps: int, transfer: Transfer) -> Fitted:
    """Inks by a photograph of the wedge that was printed of them, or by a table of densities (.csv).

    Raises
    ------
    InputError
        Where either cannot be read, or is not of these inks.
    """
    if Path(source).suffix.lower() == ".csv":
        return fit_inks(_typed(read_densities(source), source))
    (photo,) = io.read_pictures(source, transfer=transfer, least=1).images[:1]
    return fit_inks(read_wedge(photo, Wedge(inks, steps)))


def _typed(lines: list[Density], source: str) -> Readings:
    """Densities as they would be read of a photograph: beside those of bare film."""
    film = [line.densities for line in lines if line.inks == (FILM,)]
    if not film:
        raise InputError(f"{source} says no density of bare film: add a line {FILM},0 and its three densities")
    bare = np.mean(film, axis=0)
    inks = tuple(dict.fromkeys(ink for line in lines for ink in line.inks if ink != FILM))
    wedge, patches, light = Wedge(inks), [], []
    for line in lines:
        if line.inks != (FILM,):
            patches.append(Patch(tuple(line.coverage * (ink in line.inks) for ink in inks), line.line, 1))
            light.append(10 ** -(np.array(line.densities) - bare))
    return Readings(wedge, patches, np.array(light), bare * LN10, [])


def in_words(found: Fitted) -> list[str]:
    """What was found of inks: how dark each is, how much it spreads, and how well that fits."""
    dyes, lines = found.dyes, []
    for name, row, curve in zip(dyes.names, dyes.extinction, dyes.gain, strict=True):
        dense = ", ".join(f"{density:.2f}" for density in row / LN10)
        half = 0.0 if curve is None else float(np.interp(0.5, *curve.T)) - 0.5
        lines.append(f"{name}: density {dense} in red, green, blue; half of it covers {half:+.1%} more than was sent")
    lines.append(f"film: density {', '.join(f'{density:.2f}' for density in dyes.base / LN10)}")
    lines.append(f"what patches let through is off by {found.residual:.2%} of the light (root mean square)")
    return [*lines, *(f"doubtful: {sentence}" for sentence in [*found.said, *dyes.doubts])]
