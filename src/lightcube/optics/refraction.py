"""How the light of a rig goes through glass: the piece of each pixel's beam inside it, and how bright it is.

The laws are W. Snellius' and A. Fresnel's, in closed form (`lightcube.kernels.glass`): no beam is followed at random.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Reals
from lightcube.optics.glass import Glass
from lightcube.optics.rig import Rig


@dataclass(frozen=True, eq=False)
class Bent:
    """Where the beams of pixels go inside the glass, and how bright they are.

    Parameters
    ----------
    lines_mm
        ``(views, rows, columns, 6)``: where the beam of a pixel enters the glass, and where it leaves it; 0 where none
        does.
    beside
        ``(views, rows, columns)``: light of a lamp of power 1 that reaches the pixel past the glass.
    through
        The same through the glass, were its voxels clear.
    """

    lines_mm: Reals
    beside: Reals
    through: Reals

    @property
    def enters_mm(self) -> Reals:
        """``(views, rows, columns, 3)``: where beams enter the glass."""
        return self.lines_mm[..., :3]

    @property
    def leaves_mm(self) -> Reals:
        """``(views, rows, columns, 3)``: where beams leave the glass."""
        return self.lines_mm[..., 3:]


#: What was found of rigs that are still in use: the matrix and the law of light ask one after the other.
_found: WeakKeyDictionary[Rig, Bent] = WeakKeyDictionary()


def bent(rig: Rig, chosen: Sequence[int] | None = None) -> Bent:
    """The beams of all views of a rig in glass, or of those that are `chosen`."""
    if chosen is not None and len(chosen) < len(rig.views):
        return _bent(rig, chosen)
    if rig not in _found:
        _found[rig] = _bent(rig, range(len(rig.views)))
    return _found[rig]


def _bent(rig: Rig, chosen: Sequence[int]) -> Bent:
    """The beams of those views, computed."""
    from lightcube.kernels import glass as kernels  # here: the compiler comes with it

    glass = known(rig)
    numbers = np.asarray(chosen, np.intp)
    views = rig.views.take(numbers)
    rows, columns = views.picture_shape
    first = views.origins_mm - (columns - 1) / 2 * views.column_steps_mm - (rows - 1) / 2 * views.row_steps_mm
    lights = views.lamps[:, :3] / np.linalg.norm(views.lamps[:, :3], axis=1, keepdims=True)
    forms = {
        "block": kernels.BLOCK,
        "bath": kernels.BATH,
        "cylinder": kernels.CYLINDER,
        "round-bath": kernels.CYLINDER,
        "sphere": kernels.SPHERE,
    }
    light, lines = np.empty((len(views), rows, columns, 2)), np.empty((len(views), rows, columns, 6))
    kernels.beams(
        forms[glass.form],
        np.array(glass.size_mm) / 2,
        glass.bottom == "blocked",
        iors(rig)[numbers],
        lights,
        np.stack([first, views.column_steps_mm, views.row_steps_mm], axis=1),
        light,
        lines,
    )
    return Bent(lines, light[..., 0], light[..., 1])


def known(rig: Rig) -> Glass:
    """The glass of a rig that has one."""
    if rig.glass is None:
        raise InputError("there is no glass on this rig: nothing bends its light")
    return rig.glass


def iors(rig: Rig) -> Reals:
    """``(views,)``: the index of refraction that each view's light meets: its colour's where there are three."""
    found = np.array(known(rig).iors)
    return found[np.argmax(rig.sums.share, axis=1)] if len(found) > 1 else np.full(len(rig.views), found[0])
