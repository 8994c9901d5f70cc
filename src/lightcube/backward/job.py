"""A job: all that decides the bits of a cube, and the pieces that its computation consists of."""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.backward.problem import is_level
from lightcube.backward.recipe import Recipe
from lightcube.backward.units import Part, halvings, most_units, split
from lightcube.backward.wishes import asked
from lightcube.optics.arrays import Images
from lightcube.optics.dyes import Dyes
from lightcube.optics.grid import Grid
from lightcube.optics.light import Light, finer
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.pictures.targets import Targets
from lightcube.projection.limits import ROOM
from lightcube.solvers.contract import Bounds

#: Passes at each of the coarser sizes at most; no more than of the cube itself.
COARSE_PASSES = 100

#: Light is averaged over few points at first, for so many passes at most and no more than this part of them: as good
#: pictures come of it, in two thirds of the time (measured).
FEW, FEW_PASSES, _FEW_PART = Light(3, 3), 40, 1 / 3

#: What a job is known by: plain numbers and words by name, and checksums of arrays.
Fingerprint = Mapping[str, str | int | float | None]


@dataclass(frozen=True)
class Phase:
    """So many passes by a recipe; None = as many as the method takes."""

    recipe: Recipe
    passes: int | None


@dataclass(frozen=True, eq=False)
class Job:
    """What `lightcube.solve` was asked for, checked and with nothing left open.

    Parameters
    ----------
    targets, grid
        The pictures and the cube.
    recipe
        How the cube is solved.
    units
        How many parts of the cube are solved one after the other. With more than one the lamp powers are those
        found at half the size.
    start
        What the cube itself starts from, ``(channel, z, y, x)``, 1/mm, or amounts ``(dye, z, y, x)``; None = from a
        smaller one, or clear.
    provenance
        What the cube shall remember of how it was made, beside all this; it decides no bit of the extinction.
    room
        Bytes that pieces of rays may take (`lightcube.projection.projector.Projector`): as little.
    """

    targets: Targets
    grid: Grid
    recipe: Recipe = field(default_factory=Recipe)
    units: int = 1
    start: Images | None = None
    provenance: Mapping[str, Any] = field(default_factory=dict)
    room: int = ROOM

    @property
    def channels(self) -> int:
        """Colours of the pictures."""
        return self.targets.pictures.shape[-1]

    @property
    def frozen(self) -> bool:
        """Whether lamp powers that are free are found at half the size and then kept."""
        return self.recipe.powers == "coarse" or (self.units > 1 and not self.targets.rig.lamps.are_fixed)

    @property
    def levels(self) -> int:
        """How often the cube is halved for its start; smaller cubes come first."""
        least = int(self.frozen)
        if not self.recipe.solver.coarse_to_fine or self.start is not None or isinstance(self.grid, Stack):
            return least
        return max(halvings(self.grid), least)

    @property
    def coarse_passes(self) -> int:
        """Passes at each of the coarser sizes."""
        return min(COARSE_PASSES, self.recipe.passes or COARSE_PASSES)

    @property
    def looks(self) -> bool:
        """Whether what is cast is looked at, and the passes end where it is good enough, or becomes no better."""
        can_be_enough = self.recipe.enough_db < math.inf or not self.recipe.beams.is_thin
        return can_be_enough and self.recipe.solver.residual == "display"

    def phases(self, name: str) -> list[Phase]:
        """How a piece is solved: the cube itself with few points a pixel first, unless it starts from another one."""
        recipe, light = self.recipe, self.recipe.beams
        if name not in self.unit_names:
            return [Phase(recipe, self.coarse_passes)]
        passes = recipe.passes or recipe.solver.passes
        first = 0 if passes is None else min(FEW_PASSES, int(_FEW_PART * passes))
        fewer = min(light.points, light.row_points) > max(FEW.points, FEW.row_points)
        if passes is None or not (first and fewer) or self.start is not None or isinstance(self.grid, Stack):
            return [Phase(recipe, passes)]
        return [Phase(replace(recipe, light=replace(FEW, grain=light.grain)), first), Phase(recipe, passes - first)]

    @property
    def lamp_bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Lower and upper bound of the lamp powers, each ``(lamps, channels)``."""
        rig = self.targets.rig
        lamps = np.arange(len(rig.lamps.names)) if self.recipe.powers == "shared" else rig.pairs[:, 1]
        low, high = (
            np.repeat(bound[lamps, None], self.channels, axis=1) for bound in (rig.lamps.least, rig.lamps.most)
        )
        return low, high

    @property
    def dyes(self) -> Dyes | None:
        """What voxels are mixed of, 1/mm, if anything; those of coarser cubes too."""
        dyes = self.recipe.dyes
        return None if dyes is None else dyes.in_block(self.grid)

    @property
    def kinds(self) -> int:
        """Of what each voxel is a number: colours, or dyes."""
        return self.channels if self.recipe.dyes is None else len(self.recipe.dyes.names)

    def kinds_of(self, part: Part) -> slice:
        """Which of these a part of the cube has: its colours, or all dyes."""
        return part.colours if self.recipe.dyes is None else slice(0, self.kinds)

    @property
    def most(self) -> NDArray[np.float32]:
        """The largest number that a voxel can be, ``(kind, 1, 1, 1)``: extinction, 1/mm, or an amount of a dye."""
        dyes = self.recipe.dyes
        most = np.full(self.channels, self.max_extinction) if dyes is None else dyes.limit
        return most.astype(np.float32)[:, None, None, None]

    @property
    def most_units(self) -> int:
        """Into how many units the cube can be split: colours that are mixed of the same dyes belong together."""
        colours = self.channels if self.recipe.dyes is None else 1
        return most_units(self.grid.shape, colours, level=self.level)

    @property
    def max_extinction(self) -> float:
        """The largest extinction, 1/mm; that of coarser cubes too."""
        return self.recipe.bounded_by.most(self.grid)

    def bounds(self, part: Part, columns: int) -> Bounds:
        """Of the extinction of a part of the cube, or of a coarser one, in so many columns, 1/mm."""
        least = self.recipe.bounded_by.least(self.grid, self.channels)[part.colours]
        same = bool(np.all(least == least[0]))
        return float(least[0]) if same else np.resize(least, columns), self.max_extinction

    @cached_property
    def level(self) -> bool:
        """Whether each slice of the cube casts one row of the pictures by itself, at all angles that are asked for."""
        own = self.targets.rig
        if own.glass is not None or not is_level(self.grid, own.views):
            return False
        return is_level(self.grid, asked(own, self.grid, self.recipe).rig.views)  # takes long

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
    levels = {level_name(level): 1 / 8**level for level in range(job.levels, 0, -1)}
    units = {name: part.columns / columns for name, part in zip(job.unit_names, job.parts, strict=True)}
    return {name: size * _work(job, name) for name, size in (levels | units).items()}


def _work(job: Job, name: str) -> float:
    """Passes of a piece, those with few points counting as little as they are."""
    return sum(phase_work(job, phase) for phase in job.phases(name))


def phase_work(job: Job, phase: Phase, passes: float | None = None) -> float:
    """Work of a phase, or of so many of its passes, in passes of the piece as the job's recipe has it."""
    count = (phase.passes or 1) if passes is None else passes
    few, all_of_them = (finer(each.beams, job.targets.rig, job.grid).points for each in (phase.recipe, job.recipe))
    return count * few / all_of_them


def fingerprint(job: Job) -> Fingerprint:
    """What a job is known by: two jobs with the same one come to the same cube, bit for bit."""
    targets, grid = job.targets, job.grid
    nz, ny, nx = grid.shape
    return {
        "lightcube": version("lightcube"),
        "pictures": _checksum(targets.pictures),
        "weights": _checksum(targets.weight),
        "names": hashlib.sha256("\0".join(targets.names).encode()).hexdigest(),
        "lamps and screens": _checksum(*_arrays(targets.rig)),
        "largest lamp power": float(targets.rig.lamps.most.max()),
        "black": float(targets.rig.screens.black.max()),
        "voxels": f"{nz} x {ny} x {nx}",
        "voxel side": grid.voxel_mm if grid.tall == 1 else f"{grid.voxel_mm!r} wide and {grid.slice_mm!r} tall",
        **({"films": f"{grid.heights_mm} mm in {grid.index!r}"} if isinstance(grid, Stack) else {}),
        **({} if targets.rig.glass is None else {"glass": repr(targets.rig.glass)}),
        "transfer": targets.transfer,
        **{_WORDS.get(name, name): value for name, value in job.recipe.plain().items()},
        "dyes": None if job.recipe.dyes is None else _digest(job.recipe.dyes.plain()),
        **_by_colour("least extinction", job.recipe.bounded_by.clear),
        "units": job.units,
        "voxels to start from": None if job.start is None else _checksum(job.start),
    }


def _by_colour(name: str, clear: float | Sequence[float]) -> Fingerprint:
    """A number, or a text of those of each colour."""
    return {name: clear if isinstance(clear, float) else ", ".join(f"{each:g}" for each in clear)}


def differences(old: Fingerprint, new: Fingerprint) -> list[str]:
    """Say in words what differs between two fingerprints: "hold was 1.5 and is 0", "the pictures differ"."""
    changed = [name for name in new if old.get(name) != new[name]]
    return [
        f"the {name} differ" if name in _CHECKSUMS else f"{name} was {_said(old.get(name))} and is {_said(new[name])}"
        for name in changed
    ]


#: Fields of a recipe, where people call them otherwise.
_WORDS = {
    "powers": "lamp powers",
    "hold_deg": "hold",
    "max_extinction": "largest extinction",
    "clear": "least extinction",
    "per": "what extinction is counted along",
    "enough_db": "PSNR that is enough",
    "dtype": "precision",
    "points": "points a pixel",
    "row_points": "points along a row",
    "grain": "weight of points",
    "mat_tone": "tone of the mat",
    "mat_weight": "weight of the mat",
    "mat_width": "width of the mat",
    "mat_beyond": "weight beyond the mat",
}
_CHECKSUMS = ("pictures", "weights", "names", "lamps and screens", "voxels to start from", "dyes")


def _said(value: str | float | None) -> str:
    return "none" if value is None else f"{value:.9g}" if isinstance(value, float) else str(value)


def _arrays(rig: Rig) -> list[NDArray[Any]]:
    """All of a rig but its glass as arrays."""
    parts = [getattr(rig, each.name) for each in fields(rig) if each.name != "glass"]
    return [np.asarray(getattr(part, each.name)) for part in parts for each in fields(part)]


def _digest(said: Mapping[str, Any]) -> str:
    """sha256 of plain numbers and words."""
    return hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()


def _checksum(*arrays: NDArray[Any]) -> str:
    """sha256 of shapes, dtypes and numbers."""
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(f"{array.shape} {array.dtype.str}".encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()
