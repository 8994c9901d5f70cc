"""Films that are moved between pictures: slid, put into another order, turned, or put where they should not be.

Only where each film lies for each picture counts: a film slid by s over another, g below it, casts what a lamp of slope
s / g does. Moved films need no second lamp, and where they touch it may be anywhere and of any size.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Reals
from lightcube.optics.checks import check_fields
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack

#: Films are moved by no more than this, mm, and turned by no more than this, degrees.
_MOST_MM, _MOST_DEG = 1e6, 1e6
#: A cosine or sine smaller than this is none: quarter turns are exact.
_NONE = 1e-12


@dataclass(frozen=True)
class Move:
    """How the films lie for a picture.

    Parameters
    ----------
    name
        What pictures call it.
    order
        Numbers of the films, from 1 on, as they lie from the lowest height to the highest; none = as they are numbered.
    shift_mm
        ``(right, up)`` of each film in the order of their numbers, mm; none = no film is shifted.
    turn_deg
        How far each film is turned counter-clockwise, seen from above; none = no film is turned.

    Raises
    ------
    InputError
        Where a number is out of its range.
    """

    name: str
    order: tuple[int, ...] = ()
    shift_mm: tuple[tuple[float, float], ...] = ()
    turn_deg: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        check_fields(self, f"move {self.name!r}")
        if not np.all(np.abs([*sum(self.shift_mm, ())]) <= _MOST_MM) or not np.all(np.abs(self.turn_deg) <= _MOST_DEG):
            raise InputError(f"move {self.name!r}: films are moved by at most {_MOST_MM:g} mm, and as many degrees")

    def places(self, stack: Stack) -> Reals:
        """``(films, 7)``, as in `lightcube.optics.tables.Stops`; `InputError` where it is of other films."""
        count = stack.shape[0]
        given = {"order": self.order, "shift_mm": self.shift_mm, "turn_deg": self.turn_deg}
        for key, values in given.items():
            if values and len(values) != count:
                raise InputError(f"move {self.name!r}: {key} is of {len(values)} films, and the stack has {count}")
        if self.order and sorted(self.order) != list(range(1, count + 1)):
            raise InputError(f"move {self.name!r}: order must name each film from 1 to {count} once, not {self.order}")
        turn = np.radians(self.turn_deg or np.zeros(count))
        cosine, sine = (np.where(np.abs(each) < _NONE, 0.0, each) for each in (np.cos(turn), np.sin(turn)))
        right, up = np.transpose(self.shift_mm or np.zeros((count, 2)))
        heights = np.empty(count)
        heights[np.array(self.order or range(1, count + 1)) - 1] = stack.heights_mm
        shift = -(cosine * right + sine * up), sine * right - cosine * up
        return np.column_stack([cosine, sine, -sine, cosine, *shift, heights])


def places_of(stack: Stack, rig: Rig) -> Reals:
    """``(pictures, films, 7)``: where each film lies for each picture, as in `lightcube.optics.tables.Stops`."""
    films = rig.stops.films
    if films.shape[1] == 0:
        usual = np.zeros((stack.shape[0], 7))
        usual[:, [0, 3]], usual[:, 6] = 1, stack.heights_mm
        return np.broadcast_to(usual, (len(rig), *usual.shape))
    if films.shape[1] != stack.shape[0]:
        raise InputError(f"places of {films.shape[1]} films do not fit a stack of {stack.shape[0]}: give one each")
    return films


def misplaced(rig: Rig, stack: Stack, off_mm: Reals) -> Rig:
    """Each film where it should not be: `off_mm` to the right, up and higher, ``(films, 3)`` or of each picture."""
    places = places_of(stack, rig).copy()
    right, up, higher = np.moveaxis(np.broadcast_to(off_mm, (*places.shape[:2], 3)), -1, 0)
    places[..., 4] -= places[..., 0] * right + places[..., 1] * up
    places[..., 5] -= places[..., 2] * right + places[..., 3] * up
    places[..., 6] += higher
    return replace(rig, stops=replace(rig.stops, films=places))


def moved(rig: Rig, stack: Stack, moves: Sequence[Move | None]) -> Rig:
    """The rig with films as each picture's move says; None = as they lie in the stack."""
    if not any(moves):
        return rig
    usual = Move("as it is")
    films = np.stack([(move or usual).places(stack) for move in moves])
    return replace(rig, stops=replace(rig.stops, films=films))
