"""What a printer is sent for films, and what comes of it: levels of 8 bits, and the absorbance of what they print.

With inks a level is how much of a place is covered, their dot gain allowed for; even steps of coverage lose least.
Without, pages show the light itself, as screens do, and the printer's driver makes inks of it as it likes.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.fabrication.resins import ConvertedCube
from lightcube.optics.arrays import Reals, Volume
from lightcube.optics.cube import Cube
from lightcube.optics.dyes import Dyes
from lightcube.optics.gamut import OutOfReach, nearest, out_of_reach
from lightcube.optics.transfer import decode, encode

#: What pages are in.
Space = Literal["grey", "rgb", "cmyk"]
#: Where inks stand in pages of four.
_PLACES = {"cyan": 0, "magenta": 1, "yellow": 2, "black": 3}
#: No printer is darker, where nothing is known of its inks.
_DARKEST = 3.0
#: What lets nothing through lets this through, as a level: half of one.
_FLOOR = 0.5


@dataclass(frozen=True, eq=False)
class Printed:
    """What levels on a page stand for.

    Parameters
    ----------
    space
        Of the page.
    dyes
        The inks; None where levels are light.
    """

    space: Space
    dyes: Dyes | None

    def sent(self, given: Volume) -> NDArray[np.uint8]:
        """Levels ``(film, y, x, colour)`` for amounts ``(ink, film, y, x)``, or for light by channel."""
        if self.dyes is None:
            shown = encode(given, "srgb")
            return np.rint(255 * np.moveaxis(shown, 0, -1)).astype(np.uint8)
        covered = np.rint(255 * self.dyes.coverage(given)).astype(np.uint8)
        if self.space == "grey":
            return 255 - covered[0, ..., None]
        levels = np.zeros((*covered.shape[1:], 4), np.uint8)
        levels[..., self._places] = np.moveaxis(covered, 0, -1)
        return levels

    def absorbance(self, levels: Reals) -> Reals:
        """``(channel, ...)`` of levels ``(..., colour)``, which may be means of several."""
        if self.dyes is None:
            light = decode(np.maximum(levels, _FLOOR).astype(np.float32) / 255, "srgb")
            return -np.log(np.moveaxis(light.astype(np.float64), -1, 0))
        covered = (255 - levels) if self.space == "grey" else levels[..., self._places]
        amounts = self.dyes.amount(np.moveaxis(covered, -1, 0) / 255)
        full = np.tensordot(self.dyes.extinction, amounts, axes=(0, 0))
        return full + self.dyes.base.reshape(-1, *[1] * (levels.ndim - 1))

    @property
    def _places(self) -> list[int]:
        """Where each ink stands on a page of four."""
        assert self.dyes is not None  # noqa: S101 - asked of inks only
        return [_PLACES[name] for name in self.dyes.names]


def printed(dyes: Dyes | None, channels: int) -> Printed:
    """What pages are in: grey for one ink or colour, four inks, or light of three colours; `InputError` for others."""
    if dyes is None:
        if channels not in (1, 3):
            raise InputError(f"pages show 1 or 3 colours, and the films have {channels}: name inks for them (--inks)")
        return Printed("grey" if channels == 1 else "rgb", None)
    if dyes.kind != "ink":
        raise InputError(f"films are printed with inks, and these are {dyes.kind}s: name inks, as --inks cmyk-film")
    if dyes.channels != channels:
        raise InputError(f"inks of {dyes.channels} colours do not print films of {channels}: name others (--inks)")
    if len(dyes.names) == 1:
        return Printed("grey", dyes)
    strange = [name for name in dyes.names if name not in _PLACES]
    if strange:
        raise InputError(
            f"pages hold {', '.join(_PLACES)}, or one ink alone, and there is {strange[0]!r}: name inks of these"
        )
    return Printed("cmyk", dyes)


def levels_of(stack: Cube, dyes: Dyes | None) -> tuple[NDArray[np.uint8], Printed, dict[str, Any]]:
    """Levels ``(film, y, x, colour)`` for a stack, what they stand for, and what was lost on the way.

    Parameters
    ----------
    dyes
        None = those that the stack was solved in, if any.

    Warns
    -----
    ConvertedCube
        Where it was not solved in these inks.

    Raises
    ------
    InputError
        Where films are darker than they can be printed, or inks are not of a kind that pages hold.
    """
    dyes = stack.dyes if dyes is None else dyes
    made = printed(dyes, len(stack.extinction))
    absorbance = stack.extinction.astype(np.float64) * stack.grid.voxel_mm
    if dyes is None:
        _check_dark(absorbance, np.full(len(absorbance), _DARKEST * math.log(10)), stack, "printers")
        return made.sent(np.exp(-absorbance).astype(np.float32)), made, {}
    if stack.amounts is not None and stack.dyes == dyes:
        return made.sent(stack.amounts), made, {}
    _check_dark(absorbance, dyes.base + dyes.limit @ dyes.extinction, stack, "these inks")
    wanted = absorbance.astype(np.float32)
    lost = out_of_reach(wanted, dyes)
    warnings.warn(_lost(lost), ConvertedCube, stacklevel=2)
    facts = {"out_of_reach_extinction": lost.extinction, "out_of_reach_worst": lost.worst or None}
    return made.sent(nearest(wanted, dyes)), made, facts


def _check_dark(absorbance: Reals, most: Reals, stack: Cube, who: str) -> None:
    """Raise `InputError` where films are darker than they can be."""
    over = absorbance / most.reshape(-1, 1, 1, 1)
    if not np.any(over > 1 + 1e-6):
        return
    channel, film = np.unravel_index(int(np.argmax(over.max(axis=(2, 3)))), over.shape[:2])
    darkest, reach = (float(each) / math.log(10) for each in (absorbance[channel, film].max(), most[channel]))
    bound = math.floor(1000 * most.min() / stack.grid.voxel_mm) / 1000
    raise InputError(
        f"film {film + 1} is as dark as density {darkest:.2f}, and {who} reach {reach:.2f}: solve it for that, with "
        f"--max-extinction {bound:g} or max_density = {math.floor(100 * most.min() / math.log(10)) / 100:g} in its file"
    )


def _lost(lost: OutOfReach) -> str:
    """What a conversion costs, in a sentence."""
    return (
        "the films were not solved in these inks, so each cell is mixed as near to its colours as they can: "
        f"{lost.extinction:.1%} of all absorbance is out of their reach; solve in them for far better pictures "
        "(solve --material)"
    )
