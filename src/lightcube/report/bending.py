"""What is said of a cube whose light is bent by glass: facts for `info`, and a sentence for each in the report."""

from typing import Any

import numpy as np

from lightcube.optics.rig import Rig
from lightcube.optics.views import unit

#: How the body is called, before "of index 1.5".
_BODIES = {
    "block": "the block itself, glass in air,",
    "cylinder": "a cylinder of glass in air, cut of the block,",
    "sphere": "a sphere of glass in air, cut of the block,",
    "bath": "a bath whose flat sides stand square to the light, in which the block turns,",
    "round-bath": "a round bath, in which the block turns,",
}


def facts(rig: Rig) -> dict[str, Any]:
    """What bends the light of a rig, how it goes inside, and how much of the pictures it lights; {} without glass."""
    glass = rig.glass
    if glass is None:
        return {}
    from lightcube.optics.refraction import bent, iors  # here: a compiler comes with it

    inside = np.degrees(np.arcsin(np.sin(np.radians(rig.views.elevations_deg)) / iors(rig)))
    lit = (bent(rig).through > 0)[_shown(rig)]
    known: dict[str, Any] = {
        "glass": glass.form,
        "ior": list(glass.iors),
        "screen_behind_mm": [float(np.min(rig.behind_mm)), float(np.max(rig.behind_mm))],
        "lit_part": float(np.mean(lit)),
    }
    if glass.form != "sphere":  # of light that enters an upright side
        known["elevation_inside_deg"] = [float(np.min(inside)), float(np.max(inside))]
    if glass.form == "block":
        known["bottom"] = glass.bottom
    if glass.is_round and glass.bends:
        focus_mm = glass.focus_mm(unit(rig.views.lamps[:, :3]))
        known["focus_mm"] = float(np.max(focus_mm))
    return known


def _shown(rig: Rig) -> Any:
    """``(views, rows, columns)``: pixels of each view that lie on its screen."""
    return rig.inside[rig.sums.picture]


def sentences(rig: Rig) -> list[str]:
    """One for each of the `facts`."""
    known = facts(rig)
    if not known:
        return []
    ior = ", ".join(f"{each:g}" for each in known["ior"])
    said = [f"Its light is bent by {_BODIES[known['glass']]} of index {ior}."]
    if known["glass"] != "sphere":
        raised = _span(*known["elevation_inside_deg"])
        said.append(f"Light that enters its upright sides goes on at {raised}° to the level.")
    if known.get("bottom") == "blocked":
        said.append("No light comes out of its bottom.")
    said.append(f"Screens stand {_span(*known['screen_behind_mm'])} mm behind the axis.")
    if "focus_mm" in known:
        focus = f"{known['focus_mm']:.4g} mm"
        said.append(f"It is a lens, which brings light together {focus} behind the axis, before them.")
    part = known["lit_part"]
    said.append(
        "Every pixel of the pictures is lit through the glass."
        if part == 1
        else f"{part:.0%} of the pictures' pixels are lit through the glass; no voxel reaches the others."
    )
    return said


def _span(least: float, most: float) -> str:
    """One number, or two where they differ."""
    low, high = f"{least:.4g}", f"{most:.4g}"
    return low if low == high else f"{low} to {high}"
