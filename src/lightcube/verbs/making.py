"""What `hull` makes of silhouettes: bent, trimmed or added to where they contradict each other, then carved."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from lightcube.errors import InputError
from lightcube.solids import projections
from lightcube.solids.base import with_base
from lightcube.solids.carving import Carving, carve
from lightcube.solids.printing import stands
from lightcube.solids.repair import MOST_BENT, Repaired, Way, repair
from lightcube.solids.shape import Shape
from lightcube.solids.walls import WALLS
from lightcube.verbs.hulls import Wanted
from lightcube.wording import counted

#: What is left out of silhouettes is worth a word above this part of one, and advice above that.
_SOME, _MUCH = 0.005, 0.05
#: How thick a base is where nobody says so, in longest sides of the block.
_BASE = 0.03

#: How thick a base is, in mm, or whether there is none, or one where a solid would tip over.
Base = float | Literal["auto", "none"]


@dataclass(frozen=True)
class Making:
    """How a solid is made of silhouettes.

    Parameters
    ----------
    way
        How they are made to agree.
    wall_mm
        How thick walls are to be.
    carving, deep, drain_mm
        What is taken out, as `lightcube.carve` takes it.
    base_mm
        How thick a base is on which it stands; "auto" where it would tip over.
    """

    way: Way = "auto"
    wall_mm: float = 1.2
    carving: Carving = "none"
    deep: int = 3
    drain_mm: float = 3.0
    base_mm: Base = "auto"


def make(wanted: Wanted, how: Making, told: Callable[[int, int], None] | None = None) -> Repaired:
    """The solid that casts what is wanted, or what that had to become."""
    if not how.wall_mm >= 0:
        raise InputError(f"--wall is how thick walls are, 0 mm or more, not {how.wall_mm:g}")
    wall_px = _wall_px(wanted, how.wall_mm)
    found = repair(wanted.silhouettes, wanted.grid, how.way, wall_px=wall_px, held=wanted.held, told=told)
    shape = found.shape
    if how.carving != "none":
        shape = carve(shape, how.carving, wall_mm=how.wall_mm, drain_mm=how.drain_mm, deep=how.deep)
    shape, base_mm = _standing(shape, how.base_mm)
    cuts = {name: fact for name, fact in wanted.facts.items() if name in ("pictures", "stretched")}
    made = {"command": "hull", **cuts, "repair": facts(found), "carving": how.carving, "base_mm": base_mm}
    made["wall_mm"] = how.wall_mm
    return replace(found, shape=replace(shape, provenance=made))


def _standing(shape: Shape, base_mm: Base) -> tuple[Shape, float]:
    """A solid with a base, where one is asked for or it would tip over and one helps, and how thick that is."""
    if base_mm == "none":
        return shape, 0.0
    if base_mm != "auto":
        return with_base(shape, base_mm), base_mm
    if stands(shape.mesh):
        return shape, 0.0
    thick_mm = max(_BASE * shape.grid.longest * shape.grid.voxel_mm, 2 * float(shape.grid.sides_mm[2]))
    try:
        return with_base(shape, thick_mm), thick_mm
    except InputError:  # what stands on nothing that is hidden is left as it is, and told to tip over
        return shape, 0.0


def _wall_px(wanted: Wanted, wall_mm: float) -> float:
    """By how much silhouettes go back so that walls between them are thick enough: half of it, and half a pixel."""
    if wall_mm == 0:
        return 0.0
    pixel_mm = wanted.grid.voxel_mm * float(np.mean(projections.voxels_a_pixel(wanted.silhouettes.rig, wanted.grid)))
    return wall_mm / 2 / pixel_mm + 0.5


def facts(found: Repaired) -> dict[str, Any]:
    """What was done, for JSON."""
    warped = found.warped
    bent = {} if warped is None else {"least_area": warped.least_area, "weight": warped.weight}
    return {
        "way": found.way,
        "overlap": found.overlaps.tolist(),
        "outlines_moved_px": found.moved_px,
        "forms_kept": list(found.kept_forms),
        **bent,
    }


def in_words(found: Repaired, *, is_placed: bool) -> list[str]:
    """What was done to the silhouettes, for people; nothing where nothing was. Placed ones stand best already."""
    names, overlaps = found.given.names, found.overlaps
    worst = float(overlaps.min())
    changed = [name for name, kept in zip(names, found.kept_forms, strict=True) if not kept]
    each = ", ".join(f"{name} {overlap:.0%}" for name, overlap in zip(names, overlaps, strict=True))
    better = (
        ", and --placement best may ask for less" if found.given.rig.screens.names == WALLS and not is_placed else ""
    )
    said = []
    if found.way == "warp":
        moved = f"{found.moved_px:.1f} pixels on average"
        said.append(f"the pictures contradict each other, and were bent by {moved} until one object casts them")
        said.append(f"of what was drawn it casts {each}; --overlay draws what has changed{better}")
    elif found.way == "grow":
        said.append(f"what was in the way of others was added: of what it casts was drawn {each}")
    elif found.way == "trim" and 1 - worst > _SOME:
        said.append(f"what no object casts is left out: of what was drawn it casts {each}")
    if said and changed:
        said.append(f"as drawn, {', '.join(changed)} had other parts or holes: look at it (--overlay)")
    if thick_mm := found.shape.provenance.get("base_mm"):
        said.append(f"it stands on a base of {thick_mm:.2g} mm, below its pictures' lowest row and in none of them")
    if found.way == "trim" and 1 - worst > _MUCH and len(names) > MOST_BENT:
        many = counted(len(names), "picture")
        said.append(
            f"{many} that have nothing to do with each other are too many for an opaque object: "
            f"take {MOST_BENT} at most, or coloured glass, which holds many more (lightcube solve)"
        )
    return said
