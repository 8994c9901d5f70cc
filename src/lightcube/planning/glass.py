"""What glass does to wanted pictures, before they are solved for: what it cannot light, and what it lights too much."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Flags, Reals
from lightcube.optics.glare import SEEN, ghosts
from lightcube.optics.grid import Grid
from lightcube.optics.refraction import bent, known
from lightcube.optics.rig import Rig
from lightcube.pictures.targets import Targets

#: Smaller parts of a picture are not worth a sentence; so much of one may be lost at most.
_WORTH_SAYING, _MOST = 0.005, 0.5
#: What is said of light through the bottom.
_BOTTOM = {
    "open": "is lit through the bottom of the block: stand it on a ring or a sheet of glass that lets light through",
    "blocked": "stays black, because its light comes through the bottom of the block, which is blocked: open it",
}
#: Pixels along a side of the window that is looked for.
_FINE = 48


@dataclass(frozen=True, eq=False)
class Lit:
    """Parts of each picture, ``(pictures,)``: not lit, lit through the bottom of a block, were that open, or by ghosts.

    Ghosts are light that a block throws back inside (`lightcube.optics.glare`).
    """

    dark: Reals
    bottom: Reals
    ghosts: Reals


def lit(targets: Targets) -> Lit:
    """What of the wanted pictures glass lights, by the beams through the middles of pixels."""
    rig = targets.rig
    glass, wanted = replace(known(rig), bottom="open"), targets.weight[rig.sums.picture] > 0
    found = bent(replace(rig, glass=glass))
    below = np.zeros_like(wanted)
    if glass.form == "block" and glass.size_mm is not None:
        at = found.leaves_mm[..., 2] * np.sign(rig.views.lamps[:, 2])[:, None, None]
        below = (found.through > 0) & (at > glass.size_mm[2] / 2 * (1 - 1e-9))
    return Lit(*(_part(rig, each, wanted) for each in (found.through == 0, below, ghosts(rig) > SEEN)))


def _part(rig: Rig, where: Flags, wanted: Flags) -> Reals:
    """The part of each picture's wanted pixels that is so in any of its views."""
    counts = np.maximum(np.sum(wanted, axis=(1, 2)), 1)
    each = np.sum(where & wanted, axis=(1, 2)) / counts
    return np.asarray(np.maximum.reduceat(each, rig.starts[:-1]))


def window(rig: Rig, grid: Grid) -> float:
    """The largest part of the pictures' own size, at most 1, at which all of each is lit by every view."""
    rows, columns = rig.picture_shape
    most = max(rows, columns, _FINE)
    fine = rig.with_pixels(max(rows, columns) / most, (most, most))
    dark = np.any(bent(replace(fine, glass=replace(known(rig), bottom="open"))).through == 0, axis=0)
    away = np.abs(np.arange(most) - (most - 1) / 2) * 2 + 1
    off = np.maximum(away[:, None] / rows, away / columns) * max(rows, columns) / most
    return float(min(1.0, off[dark].min() - 1 / most)) if np.any(dark) else 1.0


def check_lit(targets: Targets, grid: Grid) -> None:
    """Raise `InputError` where glass leaves a part of a picture dark."""
    rig = targets.rig
    if rig.glass is None:
        return
    parts = lit(targets)
    width = rig.picture_shape[1] * rig.views.pixel_in(grid)[1] / grid.shape[1]
    worst = int(np.argmax(parts.dark))
    if parts.dark[worst] > _WORTH_SAYING:
        least = max(0.01, np.floor(100 * width * window(rig, grid)) / 100)
        raise InputError(
            f"picture {targets.names[worst]!r}: {parts.dark[worst]:.0%} of it would stay black, because no light "
            f"comes there through the {rig.glass.form}: make pictures at most {least:.2f} of the cube's width"
        )
    worst = int(np.argmax(parts.bottom))
    if rig.glass.bottom == "blocked" and parts.bottom[worst] > _MOST:
        raise InputError(
            f"picture {targets.names[worst]!r}: {parts.bottom[worst]:.0%} of it is lit through the bottom of the "
            "block, which is blocked: open it, or lower the lamp"
        )


def sentences(targets: Targets) -> list[str]:
    """A sentence for each thing that glass does to the pictures and that one may not want."""
    rig = targets.rig
    if rig.glass is None:
        return []
    parts = lit(targets)
    return [
        *_said(targets, parts.dark, "stays black, because no light comes there through the glass: make it smaller"),
        *_said(targets, parts.bottom, _BOTTOM[rig.glass.bottom]),
        *_said(
            targets,
            parts.ghosts,
            "is lit again by light that the block throws back inside: stand the screen further away, or its stop at "
            "least 10 degrees off the faces' normals",
        ),
    ]


def _said(targets: Targets, parts: Reals, what: str) -> list[str]:
    """One sentence for the picture that has most of it, and how many others have some."""
    some = int(np.sum(parts > _WORTH_SAYING))
    if not some:
        return []
    worst = int(np.argmax(parts))
    more = f" (and of {some - 1} more pictures some)" if some > 1 else ""
    return [f"{parts[worst]:.0%} of picture {targets.names[worst]!r}{more} {what}"]
