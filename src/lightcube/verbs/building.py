"""What `check --opaque` finds: whether silhouettes can be built, what is in the way, and which placement is best."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from lightcube.drawing.blame import COLOURS, blame_maps
from lightcube.solids.placement import Placement, best, placements
from lightcube.solids.printing import thickest_wall_mm
from lightcube.solids.reach import Reach, reach
from lightcube.solids.repair import MOST_BENT, Repaired, repair
from lightcube.solids.shape import hull
from lightcube.verbs import hulls, making
from lightcube.wording import counted

#: Of all that is given, more than this part out of reach is beyond repair; words of 34 % were repaired.
_HOPELESS = 0.4
#: So small a part of a picture is not worth a word beside larger ones.
_SMALL = 0.0005

Verdict = Literal["buildable", "repairable", "hopeless"]
#: What a program that calls the command is told; 2 is always a mistake in what was given.
EXIT: dict[Verdict, int] = {"buildable": 0, "repairable": 3, "hopeless": 4}


@dataclass(frozen=True)
class Building:
    """Whether silhouettes can be built.

    Parameters
    ----------
    wanted
        What is to be cast.
    found
        What can be.
    placed
        The placements of three pictures on three walls, the given one first; none elsewhere.
    wall_mm
        How thick the hull's walls can be; None where there is none.
    repaired
        What it would be when the silhouettes are bent; None where that is not needed, or beyond repair.
    """

    wanted: hulls.Wanted
    found: Reach
    placed: tuple[Placement, ...] = ()
    wall_mm: float | None = None
    repaired: Repaired | None = None

    @property
    def verdict(self) -> Verdict:
        """Whether it can be built as it is, in one piece, or after small changes, or not."""
        if self.found.is_valid and self.found.is_one_piece:
            return "buildable"
        return "hopeless" if _is_hopeless(self.found) else "repairable"

    @property
    def facts(self) -> dict[str, Any]:
        """All of it, for JSON."""
        found, names = self.found, self.wanted.silhouettes.names
        pictures = [
            {
                "name": name,
                "unreachable": float(found.shares[number]),
                "deepest": _deepest(found, number),
                "in_the_way": [
                    {"name": names[who] if who >= 0 else None, "part": part} for who, part in found.blamed(number)
                ],
            }
            for number, name in enumerate(names)
        ]
        return {
            "verdict": self.verdict,
            "valid": found.is_valid,
            "one_piece": found.is_one_piece,
            "unreachable": found.share,
            "pieces": found.pieces,
            "gap": found.gap,
            "parting": None if found.parting < 0 else names[found.parting],
            "wall_mm": self.wall_mm,
            "repaired": None if self.repaired is None else making.facts(self.repaired),
            "reach": pictures,
            "placements": [
                {
                    "order": [self.wanted.cuts[number].name for number in one.order],
                    "top_mirrored": one.is_mirrored,
                    "top_turned_deg": 90 * one.quarters,
                    "unreachable": one.share,
                    "one_piece": one.is_one_piece,
                }
                for one in self.placed
            ],
            **self.wanted.facts,
        }

    def maps(self) -> list[NDArray[np.uint8]]:
        """A map of blame for each picture, ``(row, column, 3)`` display levels."""
        return list(blame_maps(self.found))


def check(wanted: hulls.Wanted, *, is_walls: bool) -> Building:
    """Find out what can be built."""
    found = reach(wanted.silhouettes, wanted.grid)
    placed = tuple(placements(wanted.cuts)) if is_walls else ()
    wall_mm = thickest_wall_mm(hull(wanted.silhouettes, wanted.grid)) if found.pieces else None
    is_whole = found.is_valid and found.is_one_piece
    worth = not (is_whole or _is_hopeless(found) or len(wanted.silhouettes) > MOST_BENT)
    repaired = repair(wanted.silhouettes, wanted.grid, "warp") if worth else None
    return Building(wanted, found, placed, wall_mm, repaired)


def _is_hopeless(found: Reach) -> bool:
    """Whether silhouettes contradict each other too much."""
    return bool(np.any(found.shares == 1)) or found.share > _HOPELESS


def lines(building: Building) -> list[str]:
    """What is well, what is wrong and what to do, for people."""
    found, names = building.found, building.wanted.silhouettes.names
    said = []
    for number, name in enumerate(names):
        lost = float(found.shares[number])
        if not lost:
            said.append(f"{name}: all of it can be cast")
            continue
        ways = ", ".join(_way(names, who, part) for who, part in found.blamed(number) if part >= _SMALL)
        said.append(f"{name}: {lost:.1%} cannot be cast, up to {_deep(found, number)}; in the way: {ways}")
    return [*said, _pieces(found, names), *_walls(building), *_placed(building), _verdict(building)]


def _way(names: Sequence[str], who: int, part: float) -> str:
    """What is in the way of which part of a picture, and its colour on the map."""
    if who < 0:
        return f"the block's edge ({part:.1%})"
    return f"{names[who]} ({part:.1%}, {COLOURS[who % len(COLOURS)][0]})"


def _deepest(found: Reach, number: int) -> float | None:
    """By how many voxels others lack most on a picture's rays that meet the block; None where none of those is lost."""
    depth = found.depth[number]
    deep = depth[(depth > 0) & np.isfinite(depth)]
    return float(deep.max()) if deep.size else None


def _deep(found: Reach, number: int) -> str:
    """The same in words."""
    deepest = _deepest(found, number)
    return "all of the way" if deepest is None else f"{counted(max(1, math.ceil(deepest)), 'voxel')} deep"


def _pieces(found: Reach, names: Sequence[str]) -> str:
    """Whether it hangs together."""
    if found.pieces == 0:
        return "nothing is left that casts shadows in all of them"
    if found.is_one_piece:
        more = "" if found.pieces == 1 else f" of {counted(found.pieces, 'piece')}"
        return f"one piece{more} casts all that can be cast"
    far = (
        "none would if all silhouettes grew by 8 voxels"
        if found.gap is None
        else f"one would if all silhouettes grew by {found.gap:.1f} voxels"
    )
    who = "" if found.parting < 0 else f"; where they are nearest {names[found.parting]} keeps them apart: thicken it"
    return f"it falls into {counted(found.pieces, 'piece')}, of which none casts all; {far}{who}"


def _walls(building: Building) -> list[str]:
    """How thick it can be printed."""
    if building.wall_mm is None:
        return []
    if not building.wall_mm:
        return ["its walls are thinner than a voxel somewhere: look at it (lightcube hull, lightcube view)"]
    return [f"its walls can be {building.wall_mm:.2g} mm thick, and 99.5 % of its shadows stay"]


def _placed(building: Building) -> list[str]:
    """The best placement on three walls, where it is another one."""
    if not building.placed:
        return []
    given, top = building.placed[0], best(building.placed)
    if top == given:
        return ["of all 24 placements of three pictures on three walls the given one is the best"]
    cuts = building.wanted.cuts
    where = hulls.on_which_wall(top, cuts)
    pieces = "in one piece" if top.is_one_piece else "in pieces"
    better = f"{top.share:.1%} cannot be cast, {pieces}; as given {given.share:.1%}"
    return [f"best of 24 placements: {where}: {better}; lightcube hull --placement best takes it"]


def _verdict(building: Building) -> str:
    """What it comes to."""
    if building.verdict == "buildable":
        return "this can be built as it is"
    if building.verdict == "repairable":
        said = "this cannot be built as it is: shapes must give way where the map is coloured, or be joined"
        if building.repaired is None:
            return said
        worst = int(np.argmin(building.repaired.overlaps))
        name, overlap = building.wanted.silhouettes.names[worst], building.repaired.overlaps[worst]
        moved = f"outlines would move by {building.repaired.moved_px:.1f} pixels on average"
        return f"{said}; lightcube hull bends them: {moved}, {name} would be {overlap:.0%} of what it is"
    if building.placed and best(building.placed).share <= _HOPELESS:
        return "as they stand the silhouettes contradict each other too much: place them as above"
    return (
        "this is beyond repair: the silhouettes contradict each other too much; take fewer of them, or other ones, or "
        "coloured glass, which holds many pictures (lightcube solve)"
    )
