"""What `hull` does with silhouettes that contradict each other: which are bent, trimmed or added to, and in words."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Flags
from lightcube.solids import projections
from lightcube.solids.repair import MOST_BENT, Repaired, Way, repair
from lightcube.verbs.hulls import Wanted

#: What is left out of silhouettes is worth a word above this part of one, and advice above that.
_SOME, _MUCH = 0.0005, 0.05


@dataclass(frozen=True)
class Repairing:
    """How silhouettes are made to agree: the way, how thick walls are to be (mm), and the pictures that stay."""

    way: Way = "auto"
    wall_mm: float = 1.2
    keep: Sequence[str] = ()


def repaired(wanted: Wanted, how: Repairing, told: Callable[[int, int], None] | None = None) -> Repaired:
    """The object that casts what is wanted, or what that had to become."""
    if how.wall_mm < 0:
        raise InputError(f"--wall is how thick walls are, 0 mm or more, not {how.wall_mm:g}")
    held = _held(wanted, how.keep)
    found = repair(wanted.silhouettes, wanted.grid, how.way, wall_px=_wall_px(wanted, how), held=held, told=told)
    provenance = {**found.shape.provenance, **wanted.provenance, "repair": facts(found)}
    return replace(found, shape=replace(found.shape, provenance=provenance))


def _wall_px(wanted: Wanted, how: Repairing) -> float:
    """By how much silhouettes go back so that walls between them are thick enough: half of it, and half a pixel."""
    if how.wall_mm == 0:
        return 0.0
    pixel_mm = wanted.grid.voxel_mm * float(np.mean(projections.voxels_a_pixel(wanted.silhouettes.rig, wanted.grid)))
    return how.wall_mm / 2 / pixel_mm + 0.5


def _held(wanted: Wanted, keep: Sequence[str]) -> Flags | None:
    """The pictures that stay as they are."""
    names = wanted.silhouettes.names
    for name in keep:
        if name not in names:
            raise InputError(f"--keep {name}: there is no such picture: name one of {', '.join(names)}")
    if not keep:
        return None
    held = np.zeros((len(names), *wanted.silhouettes.rig.picture_shape), np.bool_)
    held[[name in keep for name in names]] = True
    return held


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


def in_words(found: Repaired) -> list[str]:
    """What was done to the silhouettes, for people; nothing where nothing was."""
    names, overlaps = found.given.names, found.overlaps
    worst = int(np.argmin(overlaps))
    changed = [name for name, kept in zip(names, found.kept_forms, strict=True) if not kept]
    said = []
    if found.way == "warp":
        said.append(
            f"the pictures contradict each other, and were bent until one object casts them: outlines moved by "
            f"{found.moved_px:.1f} pixels on average, {names[worst]} is {overlaps[worst]:.0%} of what it was"
        )
    elif found.way == "grow":
        said.append(f"what was in the way of others was added: {names[worst]} is {overlaps[worst]:.0%} of what it was")
    elif found.way == "trim" and 1 - overlaps[worst] > _SOME:
        said.append(f"what no object casts is left out: {names[worst]} is {overlaps[worst]:.1%} of what it was")
    if said and changed:
        said.append(f"as drawn, {', '.join(changed)} had other parts or holes: look at it (--overlay)")
    if found.way == "trim" and 1 - overlaps[worst] > _MUCH and len(names) > MOST_BENT:
        said.append(
            f"{len(names)} pictures that have nothing to do with each other are too many for an opaque object: "
            f"take {MOST_BENT} at most, or coloured glass, which holds many more (lightcube solve)"
        )
    return said
