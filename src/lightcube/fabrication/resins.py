"""A cube in dyes: the amounts that it was solved in, or those that come nearest to its colours, voxel by voxel."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Reals, Volume, locked
from lightcube.optics.cube import Cube
from lightcube.optics.dyes import Dyes
from lightcube.optics.gamut import OutOfReach, nearest, out_of_reach


class ConvertedCube(UserWarning):
    """A cube was solved for free colours, and its voxels are mixed as near to them as dyes can."""


@dataclass(frozen=True, eq=False)
class Mixed:
    """A cube in dyes.

    Parameters
    ----------
    dyes
        What is mixed.
    amounts
        ``(dye, z, y, x)``, the part of each voxel, up to 1 together.
    facts
        What was lost, by name; empty where nothing was.
    """

    dyes: Dyes
    amounts: Volume
    facts: Mapping[str, Any]

    @property
    def droplets(self) -> Reals:
        """Extinction of a droplet of the clear material and of each dye, ``(1 + dye, channel)``, 1/mm."""
        clear = self.dyes.base
        return np.concatenate([clear[None], clear + self.dyes.extinction])

    @property
    def order(self) -> tuple[int, ...]:
        """Dyes from the darkest to the lightest."""
        return tuple(np.argsort(-self.dyes.extinction.sum(axis=1), kind="stable").tolist())


def mixed(cube: Cube, dyes: Dyes | None) -> Mixed:
    """A cube in dyes; None = those that it was solved in.

    Warns
    -----
    ConvertedCube
        Where it was not solved in these dyes.

    Raises
    ------
    InputError
        Where there are no dyes, or they are inks, or absorb other colours than the cube has.
    """
    dyes = cube.dyes if dyes is None else dyes
    if dyes is None:
        raise InputError("the cube was not solved in dyes: name the resins to print it with (--resins FILE.toml)")
    if dyes.kind == "ink":
        raise InputError("droplets are of resins, and these are inks for films: name resins (--resins FILE.toml)")
    if dyes.channels != len(cube.extinction):
        raise InputError(f"resins of {dyes.channels} colours do not mix a cube of {len(cube.extinction)}: name others")
    facts: dict[str, Any] = {}
    if cube.amounts is not None and cube.dyes == dyes:
        amounts = cube.amounts
    else:
        amounts, lost = nearest(cube.extinction, dyes), out_of_reach(cube.extinction, dyes)
        facts = {"out_of_reach_extinction": lost.extinction, "out_of_reach_voxels": lost.voxels}
        facts["out_of_reach_worst"] = lost.worst or None
        warnings.warn(_lost(lost), ConvertedCube, stacklevel=2)
    total = amounts.sum(axis=0)
    over = total > 1
    if np.any(over):
        amounts = locked(amounts / np.maximum(total, 1))
        facts = {**facts, "overfull": float(np.mean(over))}
    return Mixed(dyes, amounts, facts)


def _lost(lost: OutOfReach) -> str:
    """What a conversion costs, in a sentence."""
    worst = f", most of it where they are to absorb {lost.worst}" if lost.worst else ""
    return (
        "the cube was not solved in these dyes, so each voxel is mixed as near to its colours as they can: "
        f"{lost.extinction:.1%} of all extinction is out of their reach, and {lost.voxels:.0%} of the voxels that are "
        f"not clear are off by more than a twentieth{worst}; solve for these dyes by --material for a better one"
    )
