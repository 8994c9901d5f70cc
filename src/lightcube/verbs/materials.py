"""What is said of dyes: what they are, which colours they can make, and what a cube holds of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from lightcube import io
from lightcube.optics.cube import Cube
from lightcube.optics.dyes import Dyes
from lightcube.optics.gamut import alone, colours, out_of_reach
from lightcube.optics.grid import Grid
from lightcube.optics.haze import FORWARD, phase_of, veil_part
from lightcube.optics.material import Material
from lightcube.optics.stack import Stack

#: Clear material that takes a smaller part than this is not told; from such parts of veil on, what pictures become.
_FAINT = 0.005
_VEILS = ((0.6, "they drown"), (0.1, "they get pale"), (0.015, "a little of their depth goes"), (0.0, "hardly seen"))
#: A voxel is as full of a dye as it can be from this part of its limit on.
_FULL = 0.999
#: A dye that takes less than this part of another colour with it makes its own colour alone.
_PURE = 0.2


def listed() -> list[str]:
    """A line for each material that ships with the package."""
    known = {name: io.read_dyes(name) for name in io.material_names()}
    return [f"{name}: {', '.join(dyes.names)} ({dyes.kind}s, {dyes.calibration})" for name, dyes in known.items()]


def facts(dyes: Dyes) -> dict[str, Any]:
    """All that is known of dyes, by name, for people and JSON; densities of inks to the base of 10."""
    unit = math.log(10) if dyes.kind == "ink" else 1.0
    called = "density" if dyes.kind == "ink" else "extinction_per_mm"
    known: dict[str, Any] = {
        "kind": dyes.kind,
        "calibration": dyes.calibration,
        "colours": list(colours(dyes.channels)),
    }
    for name, row, limit, curve in zip(dyes.names, dyes.extinction, dyes.limit, dyes.gain, strict=True):
        known[f"{name}_{called}"] = np.round(row / unit, 6).tolist()
        known |= {} if limit == 1 else {f"{name}_limit": float(limit)}
        known |= {} if curve is None else {f"{name}_dot_gain_at_half": float(np.interp(0.5, *curve.T) - 0.5)}
    known[f"base_{called}"] = np.round(dyes.base / unit, 6).tolist()
    known |= {"haze_per_mm": dyes.haze, "haze_g": dyes.g} if dyes.haze else {}
    return known


def in_words(dyes: Dyes) -> list[str]:
    """Which colours dyes can make, and what is to be known before they are used."""
    said = []
    for colour, dye, part, other in alone(dyes):
        if part > _PURE:
            said.append(f"{colour} (nearest is {dye}, which takes {part:.0%} as much {other} with it)")
    reach = f"no mixture absorbs alone: {'; '.join(said)}" if said else "each colour can be absorbed almost alone"
    return [f"material: {', '.join(dyes.names)}; {reach}", *(f"doubtful: {sentence}" for sentence in dyes.doubts)]


def clearest(material: Material, grid: Grid) -> list[str]:
    """What the clear material takes of the light, and what its haze will do, by an estimate."""
    dyes, side_mm = material.dyes, max(grid.size_mm)
    most = float(np.max(material.clear if dyes is None else dyes.in_block(grid).base))
    if most * side_mm < _FAINT or isinstance(grid, Stack):
        return []
    line = f"clear material takes up to {-math.expm1(-most * side_mm):.0%} of the light along {side_mm:.3g} mm"
    if dyes is None:
        parts = [f"{veil_part(most * side_mm, phase):.1%} of all light" for phase in ("isotropic", "forward")]
        return [f"{line}; were all that haze, a veil of about {parts[0]} if thrown to all sides, {parts[1]} if ahead"]
    if not dyes.haze:
        return [line]
    part, ahead = veil_part(dyes.haze * side_mm, phase_of(dyes.g)), dyes.g >= FORWARD
    seen = next(words for least, words in _VEILS if part >= least)
    thrown = f"{-math.expm1(-dyes.haze * side_mm):.0%} aside, {'mostly ahead' if ahead else 'to all sides'}"
    veil = f"haze throws {thrown}, and lays a veil over the pictures, by an estimate {part:.1%} of all light: {seen}"
    return [line, veil]


def amounts(cube: Cube) -> dict[str, Any]:
    """What a cube holds of its dyes, by name; nothing where it is of none."""
    if cube.amounts is None or cube.dyes is None:
        return {}
    full = np.any(cube.amounts >= _FULL * cube.dyes.limit[:, None, None, None], axis=0)
    return {
        "dyes": list(cube.dyes.names),
        "dyes_calibration": cube.dyes.calibration,
        "amount_mean": cube.amounts.mean(axis=(1, 2, 3), dtype=np.float64).tolist(),
        "amount_max": cube.amounts.max(axis=(1, 2, 3)).tolist(),
        "full_voxels": float(full.mean()),
        # inks lie over each other, what fills a place does not
        "overfull_voxels": float(np.mean(cube.amounts.sum(axis=0) > 1)) if cube.dyes.kind != "ink" else 0.0,
    }


def held(cube: Cube) -> list[str]:
    """The same in a sentence."""
    known = amounts(cube)
    if not known:
        return []
    each = (f"{mean:.1%} {name}" for name, mean in zip(known["dyes"], known["amount_mean"], strict=True))
    full, over = known["full_voxels"], known["overfull_voxels"]
    more = f"; {full:.1%} of the voxels are as full of one as they can be" if full else ""
    much = f", and {over:.1%} hold more than a voxel takes" if over else ""
    return [f"dyes: {', '.join(each)} of the block{more}{much}"]


def reach(cube: Cube, dyes: Dyes) -> dict[str, Any]:
    """How much of a cube other dyes cannot make, by name."""
    found = out_of_reach(cube.extinction, dyes.in_block(cube.grid))
    return {
        "out_of_reach_voxels": found.voxels,
        "out_of_reach_extinction": found.extinction,
        "out_of_reach_worst": found.worst or None,
    }


def reach_in_words(known: dict[str, Any], names: Sequence[str]) -> str:
    """The same in a sentence."""
    if not known["out_of_reach_worst"]:
        return f"{', '.join(names)} can make all of it, to within a twentieth"
    return (
        f"{known['out_of_reach_voxels']:.1%} of the voxels that are not clear ask for what {', '.join(names)} cannot "
        f"make, {known['out_of_reach_extinction']:.1%} of all extinction, most of it where they are to absorb "
        f"{known['out_of_reach_worst']}: solve for these dyes by --material"
    )
