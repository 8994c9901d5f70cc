"""All that decides the bits of a cube beside pictures, grid and views."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from typing import Any, Literal, NamedTuple

import numpy as np

from lightcube.backward.mat import Mat
from lightcube.errors import InputError
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.cube import Cube
from lightcube.optics.dyes import Dyes
from lightcube.optics.grid import Grid
from lightcube.optics.light import Light
from lightcube.optics.material import Material
from lightcube.optics.told import remembered
from lightcube.solvers import METHODS, find_method
from lightcube.solvers.contract import Solver
from lightcube.solvers.method import Method

#: Each picture and colour has a power of its own, all pictures share one of each colour, or each has its own as it was
#: found at half the size.
Powers = Literal["per-picture", "shared", "coarse"]
#: For a look, for use, and for the last tenth of a dB.
Quality = Literal["draft", "normal", "best"]


class Effort(NamedTuple):
    """At most so many passes of method display, and by thin beams; the PSNR of all pixels that is enough, dB; light."""

    passes: int
    thin_passes: int
    enough_db: float
    light: Light


#: What the qualities mean.
QUALITIES: Mapping[Quality, Effort] = {
    "draft": Effort(30, 30, 36.0, Light(5, 4)),
    "normal": Effort(120, 200, 42.0, Light()),
    "best": Effort(400, 400, math.inf, Light(34, 15)),
}


#: What a printer can lay down: a voxel lets a twentieth through at least. Where light is averaged it costs nothing; a
#: bound of 1 costs 2 dB where level pictures are half as wide as the cube, and 0.2 dB under raised lamps (measured).
BUILDABLE = Material(3.0, "voxel")


@dataclass(frozen=True)
class Recipe:
    """How a cube is solved: two cubes of the same recipe, pictures, grid and rig are the same, bit for bit.

    Parameters
    ----------
    method
        A name in `lightcube.METHODS`, or a function (docs/your-own-method.md); as `lightcube.solvers.find_method`
        takes it.
    powers
        ``"per-picture"``: each picture and colour has the lamp power that suits it best; ``"shared"``: each colour has
        one for all pictures; ``"coarse"``: as per-picture, but found at half the size and then kept.
    hold_deg
        Degrees on either side of its stop over which each picture shall stand, at most half the way to the next one:
        it is asked for at several angles, under one lamp power.
    material
        What bounds the extinction, or the dyes that voxels are mixed of; None = as usual: an absorbance of 3 along a
        voxel's side, or nothing by thin beams.
    light
        Over how many points of a pixel its light is averaged; None = as usual, ``Light()``, or ``Light.thin()`` by
        methods that know no light that adds up.
    mat
        What surrounds the pictures on screens without edges; None = whatever suits them best.
    passes
        At most so many at full size; None = the method's own number.
    enough_db
        Method display stops as soon as the mean squared difference of all weighted pixels, as they are cast, is as
        small as at this PSNR, dB, and half a decibel more.
    dtype
        Of the computation: ``"float32"`` or ``"float64"``.
    seed
        At least 0: of the random films that a stack starts from; cubes have no use for it.
    assembly_mm
        How far films lie off when they are put together, root of the mean square of each side, mm: pictures are asked
        for at `MISPLACED` places of them at once; 0 = as designed. For stacks only.

    Raises
    ------
    InputError
        For what cannot be: an unknown method, numbers out of their range, a method that cannot do what is asked for.

    Examples
    --------
    >>> import lightcube as lc
    >>> recipe = lc.Recipe.of_quality("draft", material=lc.Material(0.12))
    >>> recipe.method, recipe.passes, recipe.material.max_extinction
    ('display', 30, 0.12)
    """

    method: str | Solver | Method = "display"
    powers: Powers = "per-picture"
    hold_deg: float = 0.0
    material: Material | None = None
    light: Light | None = None
    mat: Mat | None = None
    passes: int | None = None
    enough_db: float = math.inf
    dtype: str = "float32"
    seed: int = 0
    assembly_mm: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "dtype", _precision(self.dtype))
        check_fields(self)
        solver = self.solver
        if not solver.chooses_lamps and self.powers != "per-picture":
            raise InputError(f"method {solver.name} cannot choose lamp powers: use method display")
        if not solver.takes_sums and not self.beams.is_thin:
            raise InputError(
                f"method {solver.name} cannot do with light that adds up over a pixel's area: give it Light.thin(), or "
                "use method display"
            )
        if self.mat is not None and not solver.chooses_lamps:
            raise InputError(f"method {solver.name} frames no pictures with a mat: use method display, or no mat")
        if not self.hold_deg >= 0:
            raise InputError(f"a hold must be a number of degrees of at least 0, not {self.hold_deg:g}")
        if math.isnan(self.enough_db):
            raise InputError("good enough must be a number of dB, or infinity for never, not nan")
        if not 0 <= self.assembly_mm <= 1e5:
            raise InputError(f"films lie 0 to 1e5 mm off, not {self.assembly_mm:g}")
        if self.seed < 0:
            raise InputError(f"a seed must be a whole number of at least 0, not {self.seed}")
        if self.passes is not None and self.passes < 1:
            raise InputError(f"a solver needs at least 1 pass, not {self.passes}")
        for name in ("hold_deg", "enough_db", "assembly_mm"):
            object.__setattr__(self, name, float(getattr(self, name)))

    @classmethod
    @checked
    def of_quality(cls, quality: Quality, **more: Any) -> Recipe:
        """So many passes, or fewer where the pictures are good enough before; `more` are the other fields."""
        effort = QUALITIES[quality]
        return cls(**{"enough_db": effort.enough_db, "light": effort.light, **more})._by(quality)

    def _by(self, quality: Quality) -> Recipe:
        """As many passes as a quality allows, unless that is said."""
        effort = QUALITIES[quality]
        passes = effort.thin_passes if self.beams.is_thin else effort.passes
        return self if self.passes is not None else replace(self, passes=passes)

    @property
    def with_passes(self) -> Recipe:
        """The same, with the passes of quality normal where method display was not told how many."""
        return self._by("normal") if self.solver.residual == "display" else self

    @property
    def beams(self) -> Light:
        """How fine light is, never None."""
        return self.light or (Light() if self.solver.takes_sums else Light.thin())

    @property
    def solver(self) -> Method:
        """The method that is meant, and what is to be known of it."""
        return find_method(self.method)

    @property
    def bounded_by(self) -> Material:
        """What bounds the extinction, never None."""
        return self.material or (Material() if self.beams.is_thin else BUILDABLE)

    @property
    def dyes(self) -> Dyes | None:
        """What voxels are mixed of, if anything."""
        return self.bounded_by.dyes

    def in_clear(self, clear: float | Sequence[float]) -> Recipe:
        """The same, where the clearest voxel takes so much, 1/mm."""
        return replace(self, material=replace(self.bounded_by, clear=clear))

    def for_any_size(self, grid: Grid) -> Recipe:
        """The same, bounded as in a grid of these voxels, for grids of others: what smaller cubes are solved by."""
        return replace(self, material=self.bounded_by.of_any_size(grid))

    def by_display(self, passes: int) -> Recipe:
        """The same powers, hold and material by so many passes of method display: what a rehearsal solves."""
        return replace(
            self, method="display", passes=passes, enough_db=math.inf, dtype=Recipe().dtype, light=self.beams
        )

    def plain(self) -> dict[str, Any]:
        """Every field by name, as JSON has it: infinity, which it has not, is None."""
        flat = {each.name: getattr(self, each.name) for each in fields(self)}
        del flat["material"], flat["light"], flat["mat"]
        material = {name: getattr(self.bounded_by, name) for name in _MATERIAL}
        material["clear"] = np.asarray(self.bounded_by.clear).tolist()
        flat |= {"method": self.solver.name, **material, **asdict(self.beams)}
        flat["dyes"] = None if self.dyes is None else self.dyes.plain()
        flat |= {f"mat_{each.name}": None if self.mat is None else getattr(self.mat, each.name) for each in fields(Mat)}
        return {name: None if value == math.inf else value for name, value in flat.items()}


def _precision(dtype: Any) -> str:
    """The name of a dtype that cubes are computed in."""
    try:
        name = np.dtype(dtype).name if dtype is not None else ""
    except (TypeError, ValueError):
        name = ""
    if name not in ("float32", "float64"):
        raise InputError(f"cubes are computed in float32 or float64, not in {dtype}: give one of the two")
    return name


_MATERIAL, _LIGHT, _MAT = (tuple(each.name for each in fields(part)) for part in (Material, Light, Mat))


def from_plain(said: Mapping[str, Any]) -> Recipe:
    """The recipe whose `Recipe.plain` this is; what is missing is as usual, and what is no field is left out.

    Raises
    ------
    InputError
        Where a value cannot be.
    """
    own = {each.name for each in fields(Recipe)} - {"material", "light", "mat"}
    given = {name: value for name, value in said.items() if value is not None}
    if "dyes" in given:
        given["dyes"] = Dyes(**given["dyes"])
    material = Material(**{name: given[name] for name in _MATERIAL if name in given}) if "per" in given else None
    light = Light(**{name: given[name] for name in _LIGHT if name in given}) if "points" in given else None
    mat = (
        Mat(**{name: given[f"mat_{name}"] for name in _MAT if f"mat_{name}" in given}) if "mat_tone" in given else None
    )
    return Recipe(material=material, light=light, mat=mat, **{name: given[name] for name in own if name in given})


def recipe_of(cube: Cube) -> Recipe:
    """How a cube was made, from what it remembers; as usual where that says nothing.

    A method that is not in `lightcube.METHODS` is known by its name only: the cube may be anybody's, and nothing is
    imported because it says so.
    """
    said = remembered(cube)
    if said.get("method", "display") not in METHODS:
        said["method"] = Method.named(said["method"])
    recipe = replace(from_plain(said), hold_deg=cube.hold_deg)
    return recipe if cube.dyes is None else replace(recipe, material=Material(dyes=cube.dyes))
