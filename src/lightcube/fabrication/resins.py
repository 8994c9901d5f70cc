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

#: How often each dye is chosen anew: by then the rest stays within a thousandth of what it can be.
_SWEEPS = 200
#: A voxel is off its colour where it differs by more than this part of it.
_OFF = 0.05


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
        amounts, facts = nearest(cube.extinction, dyes)
        warnings.warn(_lost(facts), ConvertedCube, stacklevel=2)
    total = amounts.sum(axis=0)
    over = total > 1
    if np.any(over):
        amounts = locked(amounts / np.maximum(total, 1))
        facts = {**facts, "overfull": float(np.mean(over))}
    return Mixed(dyes, amounts, facts)


def nearest(extinction: Volume, dyes: Dyes) -> tuple[Volume, dict[str, Any]]:
    """Amounts ``(dye, z, y, x)`` whose mixtures come nearest to an extinction, in squares, and how far they are off.

    Each dye is chosen anew as is best beside the others, the lightest first, so that what two ways of mixing can do is
    done by light ones: their droplets are seen less.
    """
    has_matter = np.any(extinction > dyes.base.reshape(-1, 1, 1, 1), axis=0)
    wanted = extinction[:, has_matter].astype(np.float64)
    rest = wanted - dyes.base[:, None]
    amounts = np.zeros((len(dyes.names), wanted.shape[1]))
    order = np.argsort(dyes.extinction.sum(axis=1), kind="stable")
    for _ in range(_SWEEPS):
        for dye in order:
            full = dyes.extinction[dye]
            better = np.clip(amounts[dye] + full @ rest / (full @ full), 0, dyes.limit[dye])
            rest -= full[:, None] * (better - amounts[dye])
            amounts[dye] = better
    volume = np.zeros((len(amounts), *has_matter.shape), np.float32)
    volume[:, has_matter] = amounts
    return locked(volume), _facts(wanted, rest)


def _facts(wanted: Reals, rest: Reals) -> dict[str, Any]:
    """How much of a cube is out of the dyes' reach: of all extinction, of voxels, and the voxel that is off most."""
    if not wanted.size or not wanted.max() > 0:
        return {"out_of_gamut": 0.0, "voxels_off": 0.0}
    worst = int(np.argmax(np.abs(rest).max(axis=0)))
    return {
        "out_of_gamut": float(np.abs(rest).sum() / wanted.sum()),
        "voxels_off": float(np.mean(np.abs(rest).max(axis=0) > _OFF * wanted.max(axis=0))),
        "worst_wanted": wanted[:, worst].tolist(),
        "worst_nearest": (wanted - rest)[:, worst].tolist(),
    }


def _lost(facts: Mapping[str, Any]) -> str:
    """What a conversion costs, in a sentence."""
    told = (
        "the cube was not solved in these dyes, so each voxel is mixed as near to its colours as they can: "
        f"{facts['out_of_gamut']:.1%} of all extinction is out of their reach, {facts['voxels_off']:.0%} of the voxels "
        f"that hold any are off by more than {_OFF:.0%}"
    )
    if "worst_wanted" in facts:
        wanted, found = (" ".join(f"{each:.2g}" for each in facts[f"worst_{name}"]) for name in ("wanted", "nearest"))
        told += f", the worst wants {wanted} per mm and gets {found}"
    return f"{told}; solve it in them (lightcube solve --dyes) for a better one"
