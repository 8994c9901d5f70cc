"""From the pieces of a job to a cube, finished or not."""

from __future__ import annotations

import math
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

import numpy as np

from lightcube.backward.job import Job, level_name
from lightcube.backward.kept import POWERS, VOXELS
from lightcube.backward.pieces import known, start_of
from lightcube.backward.problem import powers_of_pictures
from lightcube.backward.store import Arrays, Store
from lightcube.backward.units import Part, coarse_shape
from lightcube.backward.wishes import held
from lightcube.errors import InputError
from lightcube.kernels.layout import clear_volume
from lightcube.optics.arrays import Floats, Images, Integers, Reals, keep, locked
from lightcube.optics.checks import check_fields
from lightcube.optics.cube import Cube
from lightcube.pictures.fitting import as_levels
from lightcube.pictures.resampling import enlarged
from lightcube.wording import counted


@dataclass(frozen=True, eq=False)
class Solution:
    """A cube and how the solver arrived at it.

    Parameters
    ----------
    cube
        What was solved for.
    residuals
        One figure per iteration, in the norm of the method; of several units the sum, those that stopped early
        counting with their last figure. Empty where the cube itself was not begun.
    rejected
        ``(count, 4)`` whole numbers: (view, row, column, channel) of pixels thrown out as inconsistent.
    undetermined
        How many voxel colours no remaining equation determines; they are transparent.
    stop_reason
        One of ``"converged"``, ``"enough"``, ``"best"`` (what is cast would become worse), ``"iterations"``,
        ``"callback"``.
    lower_bound
        What no cube and no lamps (where these were found at half the size: no cube with these lamps) can bring the
        last residual below, or None where the method does not tell or was interrupted.
    """

    cube: Cube
    residuals: Reals
    rejected: Integers
    undetermined: int
    stop_reason: str
    lower_bound: float | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        keep(self, residuals=np.float64, rejected=np.int64)
        if self.residuals.ndim != 1 or self.rejected.shape[1:] != (4,):
            raise InputError(
                f"a solution has one residual per pass, and rejected pixels of shape (count, 4), not "
                f"{self.residuals.shape} and {self.rejected.shape}"
            )

    def __repr__(self) -> str:
        reached = f", {self.residuals[-1]:.4g} left" if len(self.residuals) else ""
        return f"<{self.cube!r} after {counted(len(self.residuals), 'pass')} ({self.stop_reason}){reached}>"

    @property
    def optimality(self) -> dict[str, float] | None:
        """The objective, what it cannot be below, and how many dB at most are left to gain on average, if known."""
        if self.lower_bound is None:
            return None
        reached = float(self.residuals[-1])
        most = 10 * math.log10(reached / self.lower_bound) if 0 < self.lower_bound < reached else None
        return {"objective": reached, "lower_bound": self.lower_bound} | ({} if most is None else {"left_db": most})


def merged(job: Job, store: Store) -> Solution:
    """Put together what a store has of a job: units, checkpoints of others, for the rest the start, enlarged."""
    voxels = clear_volume(job.grid.shape, job.kinds)
    powers = _coarse_powers(job, store)
    facts = []
    for name, part in zip(job.unit_names, job.parts, strict=True):
        facts.append(_place(job, store, name, part, voxels, powers))
    complete = all("stop_reason" in each for each in facts)
    stop_reason = _slowest([str(each["stop_reason"]) for each in facts]) if complete else "callback"
    residuals = _together(job, [each["history"] for each in facts if "history" in each])
    rejected = np.concatenate([each.get("rejected", np.empty((0, 4), np.int64)) for each in facts])
    bounds = [float(each["lower_bound"]) for each in facts if "lower_bound" in each]
    made = {"iterations": len(residuals), "stop_reason": stop_reason, "rejected": len(rejected)}
    cube = Cube(
        extinction=locked(voxels if job.dyes is None else job.dyes.mixed(voxels)),
        grid=job.grid,
        rig=job.targets.rig,
        lamp_powers=powers_of_pictures(job.targets, powers, job.recipe),
        targets=locked(as_levels(job.targets)),
        names=job.targets.names,
        transfer=job.targets.transfer,
        status="complete" if complete else "interrupted",
        hold_deg=job.recipe.hold_deg,
        provenance=_made_with(job) | made,
        amounts=None if job.dyes is None else locked(voxels),
        dyes=job.recipe.dyes,
    )
    undetermined = sum(int(each.get("undetermined", 0)) for each in facts)
    bound = sum(bounds) if complete and len(bounds) == len(facts) else None
    return Solution(cube, residuals, rejected, undetermined, stop_reason, bound)


def _place(job: Job, store: Store, name: str, part: Part, voxels: Images, powers: Reals) -> Arrays:
    """Write what there is of a unit into the cube and the lamp powers; returns what else is known of it."""
    found, own = known(job, store, name), voxels[job.kinds_of(part), part.slices]
    if found is None:
        newest = _newest_level(job, store)
        if job.start is not None:
            own[...] = start_of(job, store, 0, part)
        elif newest is not None:
            own[...] = _enlarged(job, *newest, part)
        return {}
    own[...] = found[VOXELS]
    powers[:, part.colours] = found[POWERS]
    return {key: found[key] for key in _FACTS if key in found}


#: What is remembered of a unit once its voxels stand in the cube.
_FACTS = ("history", "rejected", "undetermined", "stop_reason", "lower_bound")


def _newest_level(job: Job, store: Store) -> tuple[int, Arrays] | None:
    """The largest of the coarse cubes that there is anything of: how often it is halved, and what there is."""
    for level in range(1, job.levels + 1):
        found = known(job, store, level_name(level))
        if found is not None:
            return level, found
    return None


def _coarse_powers(job: Job, store: Store) -> Reals:
    """The lamp powers of the newest coarse cube, ``(lamps, channels)``; as strong as allowed where there is none."""
    newest = _newest_level(job, store)
    return np.array(job.lamp_bounds[1] if newest is None else newest[1][POWERS], np.float64)


def _enlarged(job: Job, level: int, found: Arrays, part: Part) -> Floats:
    """A coarse cube through all sizes up to the cube itself; this part of it."""
    volume = found[VOXELS][job.kinds_of(part)]
    for larger in range(level - 1, -1, -1):
        volume = enlarged(volume, coarse_shape(job.grid.shape, larger), part.slices if larger == 0 else None)
    return volume


def _together(job: Job, histories: list[Reals]) -> Reals:
    """One history of several: objectives add up, norms as their squares do."""
    if not histories:
        return np.empty(0)
    if len(histories) == 1:
        return histories[0]
    longest = max(map(len, histories))
    padded = np.array([np.pad(history, (0, longest - len(history)), "edge") for history in histories])
    return np.sqrt(np.sum(padded**2, axis=0)) if job.recipe.solver.residual == "norm" else np.sum(padded, axis=0)


def _slowest(reasons: list[str]) -> str:
    return next(reason for reason in ("iterations", "enough", "best", "converged") if reason in reasons)


def _made_with(job: Job) -> dict[str, Any]:
    """What the cube remembers of how it was made, beside its hold."""
    recipe = job.recipe.plain()
    del recipe["hold_deg"], recipe["dyes"]  # a cube has its own fields for them
    return {
        "lightcube": version("lightcube"),
        **recipe,
        "angles_per_picture": len(held(job.targets.rig, job.recipe, job.grid)) // len(job.targets),
        "units": job.units,
        **({} if job.start is None else {"started_from": "another cube"}),
        **job.provenance,
    }
