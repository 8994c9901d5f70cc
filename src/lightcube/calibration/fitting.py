"""From what patches let through to inks: density in every colour, dot gain, and where inks do not add up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lightcube.calibration.finding import Readings
from lightcube.calibration.wedge import PROCESS, Patch
from lightcube.errors import InputError
from lightcube.optics.arrays import Bytes, Reals
from lightcube.optics.dyes import Dyes, monotone
from lightcube.optics.gamut import colours

#: Two copies of a patch that differ by more than this part of the light of bare film are not both clean.
_APART = 0.06
#: So many patches of an ink may be dirty.
_FEW = 4
#: Inks over each other do not add up where the density is off by so much, and by so large a part.
_OFF, _PART = 0.1, 0.1
#: Darker places a photograph does not tell apart, by density.
_TOLD = 1.7
#: What the least step of a dot gain is: it rises everywhere.
_RISE = 1e-5
_LEAST = 1e-6


@dataclass(frozen=True, eq=False)
class Fitted:
    """Inks as they were fitted.

    Parameters
    ----------
    dyes
        The inks.
    residual
        Root mean square of what single patches let through beside what the fitted inks do, as a part of bare film's.
    said
        What is to be known: patches that were left out, inks that do not add up.
    """

    dyes: Dyes
    residual: float
    said: list[str]


def fit_inks(readings: Readings) -> Fitted:
    """Fit density and dot gain of each ink by what Murray and Davies say of covered parts.

    Raises
    ------
    InputError
        Where an ink's full patch is missing, or absorbs nothing.
    """
    inks, said = readings.wedge.inks, list(readings.said)
    solids, curves, off = [], [], []
    for ink in range(len(inks)):
        coverages, light, left_out = _single(readings, ink)
        said += left_out
        covered = 1 - light[-1]
        if not len(light) or coverages[-1] < 1 or covered.max() < 0.05:
            raise InputError(f"full {inks[ink]} absorbs nothing in what was read: is the page that of --inks?")
        if len(left_out) > _FEW:
            raise InputError(
                f"{len(left_out)} patches of {inks[ink]} are unlike their copies: is the page that of --inks and "
                "--steps?"
            )
        shares = (1 - light) @ covered / (covered @ covered)
        curve = _rising(coverages, shares)
        printed = np.interp(coverages, *monotone(curve))
        off.append((1 - printed[:, None] * covered - light).ravel())
        solids.append(-np.log(np.maximum(light[-1], _LEAST)))
        curves.append(curve)
    if readings.base is None:
        said.append("no window was cut into the film: what bare film absorbs is taken as nothing")
    base = np.zeros(len(solids[0])) if readings.base is None else readings.base
    dyes = Dyes(
        inks,
        np.maximum(np.array(solids), 0),
        base=base,
        calibration="measured",
        kind="ink",
        gain=tuple(curves),
        label=_labels(inks),
    )
    said += _additivity(readings, dyes)
    return Fitted(dyes, float(np.sqrt(np.mean(np.concatenate(off) ** 2))), said)


def _labels(inks: tuple[str, ...]) -> Bytes:
    """What inks look like; nothing where one is not known by its name."""
    if any(ink not in PROCESS for ink in inks):
        return np.empty(0, np.uint8)
    return np.array([[255 * part for part in PROCESS[ink]] for ink in inks], np.uint8)


def _single(readings: Readings, ink: int) -> tuple[Reals, Reals, list[str]]:
    """Coverages of an ink alone and the light of each, ``(coverage, channel)``, and which patches were left out."""
    by_coverage: dict[float, list[tuple[Patch, Reals]]] = {}
    for patch, light in zip(readings.patches, readings.light, strict=True):
        if sum(patch.coverages) == patch.coverages[ink]:
            by_coverage.setdefault(patch.coverages[ink], []).append((patch, light))
    by_coverage[0.0] = []
    coverages = sorted(by_coverage)
    bare = [np.ones(readings.light.shape[1])]
    usual = [np.median([light for _, light in by_coverage[each]] or bare, axis=0) for each in coverages]
    kept, said = [usual[0]], []
    for number, coverage in enumerate(coverages[1:], 1):
        beside = (usual[number - 1] + usual[min(number + 1, len(usual) - 1)]) / 2
        copies = by_coverage[coverage]
        apart = np.ptp([light for _, light in copies], axis=0).max()
        if apart > _APART:
            worst = max(copies, key=lambda each: float(np.abs(each[1] - beside).max()))
            said.append(f"{readings.wedge.called(worst[0])} is unlike its copy and was left out: it may be dirty")
            copies = [each for each in copies if each is not worst]
        kept.append(np.mean([light for _, light in copies], axis=0))
    return np.array(coverages), np.array(kept), said


def _rising(coverages: Reals, shares: Reals) -> Reals:
    """A dot gain through what was printed of each coverage that rises everywhere, from (0, 0) to (1, 1)."""
    from scipy.optimize import isotonic_regression  # here: it takes long to load

    rising = np.clip(isotonic_regression(shares[1:-1]).x, 0, 1)
    steps = np.arange(1, len(rising) + 1) / (len(rising) + 1)
    inner = np.clip(rising, _RISE, 1 - 2 * _RISE) * (1 - 2 * _RISE) + _RISE * steps
    return np.concatenate([[[0, 0]], np.stack([coverages[1:-1], inner], axis=1), [[1, 1]]])


def _additivity(readings: Readings, dyes: Dyes) -> list[str]:
    """Where inks over each other are not as dark, or are darker, than they are together: the worst of each set."""
    names, worst = colours(dyes.channels), dict[str, tuple[float, str]]()
    for patch, light in zip(readings.patches, readings.light, strict=True):
        inks = " over ".join(name for name, part in zip(dyes.names, patch.coverages, strict=True) if part)
        if " over " not in inks:
            continue
        seen, added = -np.log10(np.maximum(light, _LEAST)), _together(dyes, patch.coverages)
        differs = np.where(np.minimum(seen, added) < _TOLD, np.abs(seen - added), 0)
        channel = int(np.argmax(differs))
        off = float(differs[channel])
        if off > max(_OFF, _PART * added[channel], worst.get(inks, (0.0, ""))[0]):
            sum_ = (
                f"{inks} has density {seen[channel]:.2f} in {names[channel]}, where their sum is {added[channel]:.2f}"
            )
            worst[inks] = off, sum_
    return [f"densities do not add up: {text}" for _, text in worst.values()]


def _together(dyes: Dyes, coverages: tuple[float, ...]) -> Reals:
    """Density of inks over each other, each a screen of its own, in every colour."""
    printed = [
        part if curve is None else float(np.interp(part, *monotone(curve)))
        for part, curve in zip(coverages, dyes.gain, strict=True)
    ]
    through = 1 + np.array(printed)[:, None] * np.expm1(-dyes.extinction)
    return -np.log10(np.prod(through, axis=0))
