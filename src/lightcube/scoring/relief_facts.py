"""What is in a relief's file, for people and for JSON."""

from __future__ import annotations

from typing import Any

import numpy as np

from lightcube.solids.relief import Relief, side_of


def facts(relief: Relief) -> dict[str, Any]:
    """What is in a relief's file."""
    recipe, steps = relief.recipe, [np.abs(np.diff(relief.heights_px, axis=axis)) for axis in (0, 1)]
    wide, deep, high = relief.size_mm
    return {
        "kind": "relief",
        "pictures": list(relief.names),
        "lamps": [side_of(azimuth_deg) for azimuth_deg in relief.azimuths_deg],
        "colour": relief.is_colour,
        "columns": list(relief.heights_px.shape[::-1]),
        "columns_a_pixel": relief.cell,
        "size_mm": [wide, deep, high],
        "relief_mm": float(relief.heights_mm.max()),
        "relief_px": float(relief.heights_px.max()),
        "mean_step_px": float(np.mean(np.concatenate([each.ravel() for each in steps]))),
        "steepest_step_px": float(max(each.max() for each in steps)),
        "pitch_mm": recipe.pitch_mm,
        "layer_mm": recipe.layer_mm,
        "elevation_deg": recipe.elevation_deg,
        "tolerance_deg": recipe.tolerance_deg if recipe.method == "global" else 0.0,
        "black": recipe.black,
        "bounce": recipe.bounce,
        "method": recipe.method,
        **({"sweeps": recipe.sweeps, "seed": recipe.seed} if recipe.method == "global" else {}),
        **relief.provenance,
    }
