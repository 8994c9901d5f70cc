"""What tells the pictures of a stack apart, in words: the lamps that they have, and how the films lie for them."""

from __future__ import annotations

import math

import numpy as np

from lightcube.optics.arrays import Reals
from lightcube.optics.rig import Rig

#: Shifts smaller than this, mm, and turns smaller than this, degrees, are none.
_LEAST = 1e-6
#: More films than this that are moved are not named one by one.
_NAMED = 2


def is_dial(rig: Rig) -> bool:
    """Whether stops are only a dial that tells pictures apart: nothing turns."""
    return not np.any(rig.turning.turns) and bool(np.ptp(rig.stops.angle_deg) > 0)


def told_apart(rig: Rig) -> list[str]:
    """What tells each picture from the others: ``"under lamp 1"``, ``"film 2 slid 5 mm right"``, or ``"22.5°"``.

    The turntable's angle where anything turns.
    """
    if np.any(rig.turning.turns):
        return [f"{round(angle_deg, 2):g}°" for angle_deg in rig.stops.angle_deg.tolist()]
    lamps, moves = lamps_of(rig), moves_of(rig)
    lit = [f"under {own}" for own in lamps] if len(set(lamps)) > 1 or not any(moves) else [""] * len(lamps)
    lie = [own or "films as they are" for own in moves] if any(moves) else moves
    return [", ".join(part for part in both if part) for both in zip(lit, lie, strict=True)]


def lamps_of(rig: Rig) -> list[str]:
    """The names of each picture's lamps."""
    return [
        " + ".join(rig.lamps.names[lamp] for lamp in dict.fromkeys(rig.sums.lamp[rig.sums.picture == picture].tolist()))
        for picture in range(len(rig))
    ]


def moves_of(rig: Rig) -> list[str]:
    """How films are moved for each picture: order, slides, turns; nothing where they lie as their stack has them."""
    return [_moved(places) for places in rig.stops.films]


def shifts_of(places: Reals) -> tuple[Reals, Reals]:
    """``(…, 2)``: how far films are shifted to the right and up, mm, and ``(…)`` turned counter-clockwise, degrees.

    Parameters
    ----------
    places
        ``(…, 7)``, as in `lightcube.optics.tables.Stops`.
    """
    turns = places[..., :4].reshape(*places.shape[:-1], 2, 2)
    shifts = -np.linalg.solve(turns, places[..., 4:6, None])[..., 0]
    return np.asarray(shifts), np.asarray(np.degrees(np.arctan2(places[..., 1], places[..., 0])))


def _moved(places: Reals) -> str:
    """How the films lie for one picture."""
    shifts, turns = shifts_of(places)
    order = (np.argsort(places[:, 6], kind="stable") + 1).tolist()
    said = []
    if order != sorted(order):
        said.append(f"films {', '.join(map(str, order))} from below")
    slid = np.flatnonzero(np.abs(shifts).max(axis=-1) > _LEAST)
    if len(slid) > _NAMED:
        said.append("films slid")
    else:
        said += [f"film {film + 1} slid {_way(*shifts[film])}" for film in slid]
    turned = np.flatnonzero(np.abs(turns) > _LEAST)
    if len(turned) > _NAMED:
        said.append("films turned")
    else:
        said += [f"film {film + 1} turned {turns[film]:.4g}°" for film in turned]
    return ", ".join(said)


def _way(right: float, up: float) -> str:
    """A shift in words."""
    parts = ((right, "right", "left"), (up, "up", "down"))
    said = [f"{abs(mm):.4g} mm {more if mm > 0 else less}" for mm, more, less in parts if abs(mm) > _LEAST]
    return " and ".join(said)


def off_upright_deg(ways: Reals) -> Reals:
    """Degrees between upright and the ways of light ``(…, 3)``."""
    return np.asarray(np.degrees(np.arctan2(np.linalg.norm(ways[..., :2], axis=-1), np.abs(ways[..., 2]))))


def clock(x: float, y: float) -> str:
    """Where something lies seen from above, y upwards, as the hand of a clock: ``"1:30"``; nothing in the middle."""
    if math.hypot(x, y) < 1e-9:
        return ""
    minutes = round(math.degrees(math.atan2(x, y)) % 360 * 2 / 5) * 5 % 720
    return f"{minutes // 60 or 12}:{minutes % 60:02d}"
