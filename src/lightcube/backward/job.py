"""A job: all that decides the bits of a cube, and the pieces that its computation consists of."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.backward.problem import held_views, is_level
from lightcube.backward.recipe import Powers
from lightcube.backward.units import Part, halvings, split
from lightcube.optics.grid import Grid
from lightcube.optics.rig import LAMP_MIN, Lighting
from lightcube.optics.transfer import BLACK
from lightcube.pictures.frames import Frames
from lightcube.solvers.display import DISPLAY
from lightcube.solvers.method import Method

#: Passes at each of the coarser sizes at most; no more than of the cube itself.
COARSE_PASSES = 100

#: What a job is known by: plain numbers and words by name, and checksums of arrays.
Fingerprint = Mapping[str, str | int | float | None]


@dataclass(frozen=True, eq=False)
class Job:
    """What `lightcube.solve` was asked for, checked and with nothing left open.

    Parameters
    ----------
    frames, grid
        The pictures and the cube.
    method
        What solves.
    lamp, lamp_power
        Kind of the lamp, and its power where it is fixed, else the largest one.
    hold, black, max_extinction, enough_db
        As in `lightcube.solve`.
    iterations
        At most so many at full size; None = the method's own number.
    dtype
        Of the computation: ``"float32"`` or ``"float64"``.
    units
        How many parts of the cube are solved one after the other. With more than one the lamp powers are those
        found at half the size.
    provenance
        What the cube shall remember of how it was made, beside all this; it decides no bit of the extinction.
    """

    frames: Frames
    grid: Grid
    method: Method = DISPLAY
    lamp: Powers = "per-view"
    lamp_power: float = 16.0
    hold: float = 0.0
    black: float = BLACK
    max_extinction: float = np.inf
    iterations: int | None = None
    enough_db: float = np.inf
    dtype: str = "float32"
    units: int = 1
    provenance: Mapping[str, Any] = field(default_factory=dict)

    @property
    def channels(self) -> int:
        """Colours of the pictures."""
        return self.frames.pictures.shape[-1]

    @property
    def frozen(self) -> bool:
        """Whether lamp powers that are free are found at half the size and then kept."""
        return self.lamp == "coarse" or (self.lamp != "fixed" and self.units > 1)

    @property
    def levels(self) -> int:
        """How often the cube is halved for its start; smaller cubes come first."""
        return max(halvings(self.grid), int(self.frozen)) if self.method.coarse_to_fine else 0

    @property
    def coarse_passes(self) -> int:
        """Passes at each of the coarser sizes."""
        return min(COARSE_PASSES, self.iterations or COARSE_PASSES)

    @property
    def lamp_bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Lower and upper bound of the lamp powers, each ``(lamps, channels)``; a stage's lamps have their own."""
        lighting = self.frames.lighting
        if lighting is not None:
            lamps = np.arange(len(lighting.most)) if self.lamp == "global" else lighting.pairs[:, 1]
            low, high = (
                np.repeat(bound[lamps, None], self.channels, axis=1) for bound in (lighting.least, lighting.most)
            )
            return low, high
        high = np.full((1 if self.lamp == "global" else len(self.frames), self.channels), self.lamp_power)
        return (high if self.lamp == "fixed" else np.full_like(high, LAMP_MIN)), high

    @property
    def level(self) -> bool:
        """Whether each slice of the cube casts one row of the pictures by itself, at all angles that are asked for."""
        return is_level(self.grid, held_views(self.frames, self.hold, self.grid)[0])

    @property
    def parts(self) -> list[Part]:
        """What of the cube each unit solves."""
        return split(self.grid.shape, self.channels, self.units, level=self.level)

    @property
    def pieces(self) -> list[str]:
        """Names of all pieces, each of which may need those before it: ``level-2``, ``level-1``, ``unit-0``."""
        return [level_name(level) for level in range(self.levels, 0, -1)] + self.unit_names

    def pieces_of(self, unit: int) -> list[str]:
        """Names of the pieces that a unit, counted from 0, is made of."""
        return [name for name in self.pieces if name not in self.unit_names] + [unit_name(unit)]

    @property
    def unit_names(self) -> list[str]:
        """Names of the units, which do not need each other."""
        return [unit_name(unit) for unit in range(self.units)]


def level_name(level: int) -> str:
    """Name of the piece that solves a cube halved so often."""
    return f"level-{level}"


def unit_name(unit: int) -> str:
    """Name of the piece that solves a part of the cube, counted from 0."""
    return f"unit-{unit}"


def shares(job: Job) -> dict[str, float]:
    """Work of each piece in passes of the whole cube; a method that does not tell how many it needs counts as 1."""
    columns = sum(part.columns for part in job.parts)
    work = {level_name(level): job.coarse_passes / 8**level for level in range(job.levels, 0, -1)}
    for name, part in zip(job.unit_names, job.parts, strict=True):
        work[name] = (job.iterations or 1) * part.columns / columns
    return work


def fingerprint(job: Job) -> Fingerprint:
    """What a job is known by: two jobs with the same one come to the same cube, bit for bit."""
    frames, views = job.frames, job.frames.views
    geometry = (views.lamps, views.origins, views.column_steps, views.row_steps)
    nz, ny, nx = job.grid.shape
    return {
        "lightcube": version("lightcube"),
        "pictures": _checksum(frames.pictures),
        "weights": _checksum(frames.weight),
        "names": hashlib.sha256("\0".join(frames.names).encode()).hexdigest(),
        "angles and screens": _checksum(*geometry),
        "lamps": None if frames.lighting is None else _checksum(*_arrays(frames.lighting)),
        "voxels": f"{nz} x {ny} x {nx}",
        "voxel side": job.grid.voxel_mm,
        "transfer": frames.transfer,
        "method": job.method.name,
        "lamp": job.lamp,
        "lamp power": float(job.lamp_power),
        "hold": float(job.hold),
        "black": float(job.black),
        "largest extinction": None if np.isinf(job.max_extinction) else float(job.max_extinction),
        "passes": job.iterations,
        "PSNR that is enough": None if np.isinf(job.enough_db) else float(job.enough_db),
        "precision": job.dtype,
        "units": job.units,
    }


def differences(old: Fingerprint, new: Fingerprint) -> list[str]:
    """Say in words what differs between two fingerprints: "hold was 1.5 and is 0", "the pictures differ"."""
    changed = [name for name in new if old.get(name) != new[name]]
    return [
        f"the {name} differ" if name in _CHECKSUMS else f"{name} was {_said(old.get(name))} and is {_said(new[name])}"
        for name in changed
    ]


_CHECKSUMS = ("pictures", "weights", "names", "angles and screens", "lamps")


def _said(value: str | float | None) -> str:
    return "none" if value is None else f"{value:.9g}" if isinstance(value, float) else str(value)


def _arrays(lighting: Lighting) -> list[NDArray[Any]]:
    """All of a lighting as arrays."""
    return [np.asarray(getattr(lighting, each.name)) for each in fields(lighting)]


def _checksum(*arrays: NDArray[Any]) -> str:
    """sha256 of shapes, dtypes and numbers."""
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(f"{array.shape} {array.dtype.str}".encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()
