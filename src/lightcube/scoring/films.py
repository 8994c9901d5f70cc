"""What is left of a stack's pictures where films lie off, lamps stand off, ink is weak, dots grow or light goes astray.

Whoever photographs or shows a stack finds an exposure for each picture and colour anew: beside what is seen under the
lamps as they were solved stands what is seen **relit** so.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from lightcube.backward.recipe import recipe_of
from lightcube.forward.casting import cast
from lightcube.optics.arrays import Floats, Images, Reals
from lightcube.optics.cube import Cube
from lightcube.optics.disturbance import FILMS_OFF, FilmsOff
from lightcube.optics.moves import misplaced, places_of
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.optics.transfer import encode
from lightcube.optics.views import Views
from lightcube.pictures.targets import Targets
from lightcube.scoring.metrics import psnr

#: What is random is tried so many times.
DRAWS = 4
#: Exposures that are tried for a picture and a colour, from half to twice as bright.
_EXPOSURES = np.exp(np.linspace(math.log(0.5), math.log(2.0), 41))
#: Films are taken to be printed by ink of at least this density, where the stack does not say how dark they can be.
_LEAST_DENSITY = 1.0


def robust(cube: Cube, targets: Targets, callback: Callable[[int, int], None] | None = None) -> dict[str, Any]:
    """What is left of a stack's pictures, by disturbance: ``psnr_mean``, ``psnr_min`` and ``relit_mean``.

    They are those of `lightcube.optics.disturbance.FILMS_OFF`; means over four draws of what is random.
    """
    of = sum(_draws(off) for off in FILMS_OFF.values())
    done, figures = 0, {}
    for name, off in FILMS_OFF.items():
        each, relit = [], []
        for seed in range(_draws(off)):
            shown = list(disturbed(cube, off, seed))
            each.append(_psnr(shown, targets))
            relit.append(_psnr(exposed(shown, targets), targets))
            done += 1
            if callback is not None:
                callback(done, of)
        figures[name] = {
            "psnr_mean": float(np.mean(each)),
            "psnr_min": float(np.min(np.mean(each, axis=0))),
            "relit_mean": float(np.mean(relit)),
        }
    return figures


def disturbed(cube: Cube, off: FilmsOff, seed: int = 0) -> Iterator[Images]:
    """Yield what the screen shows in each picture of films that are off, ``(row, column, channel)``, linear light.

    Parameters
    ----------
    cube
        A stack.
    off
        What is wrong with it.
    seed
        Of what is random.
    """
    random = np.random.default_rng(seed)
    rig = _assembled(cube, off, random)
    wrong = replace(cube, extinction=_printed(cube, off, random), amounts=None, dyes=None)
    for picture in cast(wrong, rig):
        yield picture + np.float32(off.ghosts) * picture.mean(axis=(0, 1))


def _draws(off: FilmsOff) -> int:
    return DRAWS if off.is_random else 1


def _assembled(cube: Cube, off: FilmsOff, random: np.random.Generator) -> Rig:
    """The rig of films that lie off, under lamps that stand off."""
    stack, films = cube.grid, cube.grid.shape[0]
    assert isinstance(stack, Stack)  # noqa: S101 - nobody asks of anything else
    off_mm = random.standard_normal((films, 3)) * (off.shift_mm, off.shift_mm, off.height_mm)
    rig = misplaced(cube.rig, stack, off_mm) if np.any(off_mm) else cube.rig
    if off.stretch:
        places = places_of(stack, rig).copy()
        places[..., :6] /= (1 + off.stretch * random.standard_normal(films))[:, None]
        rig = replace(rig, stops=replace(rig.stops, films=places))
    if off.lamp_deg:
        rig = replace(rig, views=_off(rig.views, math.tan(math.radians(off.lamp_deg))))
    if off.disc_deg:
        rig = replace(rig, sums=replace(rig.sums, disc_deg=np.maximum(rig.sums.disc_deg, off.disc_deg)))
    return rig


def _off(views: Views, slope: float) -> Views:
    """Views whose lamps stand off along x by a slope, as seen from the middle of their pictures."""
    lamps = views.lamps.copy()
    away = np.where(lamps[:, 3] == 1, views.origins_mm[:, 2] - lamps[:, 2], lamps[:, 2])
    lamps[:, 0] += slope * np.abs(away)
    return replace(views, lamps=lamps)


def _printed(cube: Cube, off: FilmsOff, random: np.random.Generator) -> Images:
    """Extinction of films whose ink is off."""
    channels, films = cube.extinction.shape[:2]
    strength = 1 + off.ink + off.ink_each * random.standard_normal((channels, films, 1, 1))
    extinction = cube.extinction * np.maximum(strength, 0)
    if not (off.gain or off.levels):
        return extinction.astype(np.float32)
    solid = _solid(cube)
    covered = coverage(extinction * cube.grid.voxel_mm, solid)
    covered = covered + 4 * off.gain * covered * (1 - covered)
    covered = np.rint(covered * off.levels) / off.levels if off.levels else covered
    return (absorbance(covered, solid) / cube.grid.voxel_mm).astype(np.float32)


def _solid(cube: Cube) -> float:
    """Absorbance of a film that is all covered: the darkest that was allowed, or that there is."""
    allowed = recipe_of(cube).bounded_by.most(cube.grid) * cube.grid.voxel_mm
    darkest = float(cube.extinction.max()) * cube.grid.voxel_mm
    return max(allowed if math.isfinite(allowed) else darkest, darkest, _LEAST_DENSITY * math.log(10))


def coverage(absorbed: Floats, solid: float) -> Reals:
    """The part of a cell that ink covers, of its absorbance; light goes through the rest (Murray and Davies, 1936)."""
    return np.asarray(np.clip((1 - np.exp(-absorbed)) / (1 - math.exp(-solid)), 0, 1))


def absorbance(covered: Floats, solid: float) -> Reals:
    """The inverse of `coverage`."""
    return np.asarray(-np.log1p(-np.clip(covered, 0, 1) * (1 - math.exp(-solid))))


def _wanted(targets: Targets) -> Iterator[tuple[Images, Images, str]]:
    """Display values, weights and transfer of each picture."""
    wanted = encode(targets.pictures, targets.transfer)
    return ((*pair, targets.transfer) for pair in zip(wanted, targets.weight, strict=True))


def exposed(shown: list[Images], targets: Targets) -> list[Images]:
    """Pictures in linear light, each colour of each under the exposure that brings it nearest to what is wanted."""
    return [_exposed(*pair) for pair in zip(shown, _wanted(targets), strict=True)]


def _exposed(shown: Images, picture: tuple[Images, Images, Any]) -> Images:
    """A picture under the exposure of each colour that brings it nearest to what is wanted."""
    wanted, weight, transfer = picture
    best = shown.copy()
    for channel in range(shown.shape[-1]):
        errors = [
            float(np.sum(weight * (encode(shown[..., channel] * exposure, transfer) - wanted[..., channel]) ** 2))
            for exposure in _EXPOSURES
        ]
        best[..., channel] *= _EXPOSURES[int(np.argmin(errors))]
    return best


def _psnr(shown: list[Images], targets: Targets) -> list[float]:
    return [
        psnr(encode(picture, transfer), wanted, weight)  # type: ignore[arg-type]
        for picture, (wanted, weight, transfer) in zip(shown, _wanted(targets), strict=True)
    ]
