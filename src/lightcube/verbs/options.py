"""What may be said of a cube before it is solved."""

from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

import numpy as np

from lightcube.backward.mat import TONES, Mat
from lightcube.backward.recipe import Powers, Quality, Recipe
from lightcube.errors import InputError
from lightcube.optics.light import Beams, Light
from lightcube.optics.material import Material
from lightcube.optics.tables import power_bounds
from lightcube.optics.transfer import Transfer
from lightcube.pictures.fitting import Fit
from lightcube.pictures.turntable import Turntable
from lightcube.planning.plan import Arrangement
from lightcube.solvers import METHODS

#: What surrounds the pictures: a mat of a tone, or whatever suits them best.
Surround = Literal["dark", "grey", "light", "none"]
#: Voxels along the longest side of a cube, unless something else is said.
DEFAULT_N = 128


@dataclass(frozen=True)
class Option:
    """What people are told of an option, and the least number that it takes."""

    help: str
    least: int | None = None


@dataclass(frozen=True)
class Options:
    """What is said of the cube, None where nothing is."""

    n: Annotated[int | None, Option("Voxels along the cube's longest side.  [default: 128]")] = None
    shape: Annotated[tuple[int, int, int] | None, Option("Voxels along each axis, NZ,NY,NX, instead of --n.")] = None
    size_mm: Annotated[float, Option("Longest side of the cube in mm.")] = 100.0
    picture_width: Annotated[
        float | None, Option("Width of the pictures as a part of the cube's; default as wide as 40 dB are expected.")
    ] = None
    slices_tall: Annotated[int, Option("Height of a slice of the cube in widths of a voxel; --n counts widths.", 1)] = 1
    pixel: Annotated[int, Option("Voxels along a side of each pixel of the pictures.", 1)] = 1
    fit: Annotated[
        Fit, Option("Pictures of another aspect than the first: cut their edges, leave the rest free, or distort.")
    ] = "crop"
    angles_deg: Annotated[tuple[float, ...] | None, Option("Turntable angles in degrees, A,B,C, one per picture.")] = (
        None
    )
    span_deg: Annotated[
        float | None, Option("Degrees to spread the views over, evenly.  [default: 360, level 180]")
    ] = None
    elevation_deg: Annotated[float | None, Option("Elevation of the lamp in degrees; 0 is level.  [default: 35]")] = (
        None
    )
    paper: Annotated[bool, Option("The paper's set-up: level lamp of power 1, half a turn, full width.")] = False
    order: Annotated[
        Arrangement, Option("Whether pictures stand as given, or in the order that gives the best ones.")
    ] = "given"
    shift: Annotated[int, Option("Let pictures stand up to so many pixels higher, lower or aside, in turn.", 0)] = 0
    quality: Annotated[Quality | None, Option("At most 30, 200 or 400 passes.  [default: normal]")] = None
    method: Annotated[str, Option(f"One of {', '.join(METHODS)}.")] = "display"
    iterations: Annotated[int | None, Option("At most so many passes, instead of --quality.")] = None
    powers: Annotated[
        Powers | None,
        Option("One lamp power per picture and colour (coarse: found at half size), or one per colour for all."),
    ] = None
    lamp_power: Annotated[float | None, Option("Power of a fixed lamp, linear light; 1 is white.")] = None
    lamp_max: Annotated[float | None, Option("Largest power of the lamp, at least 1.  [default: 16]")] = None
    lamp_deg: Annotated[
        float | None, Option("Angular diameter of the lamp's disc in degrees: the sun's is 0.5.  [default: 0, none]")
    ] = None
    screen_mm: Annotated[
        float | None,
        Option("With --lamp-deg: mm from the turning cube's reach to the screen; default the cube's width."),
    ] = None
    hold_deg: Annotated[
        float | None,
        Option("Degrees around its stop over which each picture shall stand.  [default: 16 / voxels across]"),
    ] = None
    black: Annotated[float | None, Option("Display value, 0.002 to 1, that the screen cannot be darker than.")] = None
    max_extinction: Annotated[
        float | None,
        Option("Largest extinction of the material, 1/mm; default an absorbance of 3 along a voxel, thin beams: none."),
    ] = None
    mat: Annotated[Surround | None, Option("Calm surround of each picture.  [default: dark; thin beams: none]")] = None
    transfer: Annotated[Transfer, Option("How picture values become linear light.")] = "srgb"
    light: Annotated[
        Beams | None, Option("Whether light is averaged over pixels or, as in the paper, thin beams.  [default: area]")
    ] = None
    points: Annotated[
        int | None,
        Option(
            "Average over so many points of each pixel, with --lamp-deg thrice; of larger ones over up to 34.  "
            "[default: 13, level 7; best: 34, 15]",
            1,
        ),
    ] = None

    grain: Annotated[
        float | None,
        Option(
            "Weight, 0 to 2, of a pixel's points beside its mean: the more, the smoother from near by.  "
            "[default: auto, 0.01 where 38 dB are expected]"
        ),
    ] = None

    @property
    def voxels(self) -> tuple[int, int, int]:
        """``(nz, ny, nx)`` that `n` or `shape` say, a cube where that is `n`; `InputError` where they cannot be."""
        if self.n is not None and self.shape is not None:
            raise InputError("--n and --shape both say how many voxels: leave one of them out")
        nz, ny, nx = self.shape or (DEFAULT_N if self.n is None else self.n,) * 3
        if min(nz, ny, nx) < 1:
            raise InputError(f"--n {self.n}: a cube needs at least 1 voxel a side")
        if not (np.isfinite(self.size_mm) and self.size_mm > 0):
            raise InputError(f"--size-mm {self.size_mm}: give a positive number of millimetres")
        return nz, ny, nx

    @property
    def turntable(self) -> Turntable:
        """The turntable as far as it is said; `InputError` where options contradict each other.

        The lamp of methods that cannot choose powers has 1 where nothing is said.
        """
        if self.lamp_power is not None and self.lamp_max is not None:
            raise InputError("a lamp of one given power has no largest one: leave --lamp-power or --lamp-max out")
        if self.lamp_power is not None and self.powers not in (None, "per-picture"):
            raise InputError(f"a lamp of one given power has none that are {self.powers}: leave out one of the two")
        chooses = self.recipe.solver.chooses_lamps
        if not chooses and self.lamp_max is not None:
            raise InputError(
                f"method {self.method} cannot choose lamp powers: give --lamp-power, or use method display"
            )
        power_bounds(self.lamp_power, self.lamp_max)
        power = self.lamp_power if chooses or self.lamp_power is not None else 1.0
        said = {"angles_deg": self.angles_deg, "power": power, "power_max": self.lamp_max, "black": self.black}
        said |= {"span_deg": self.span_deg, "elevation_deg": self.elevation_deg}
        said |= {"lamp_deg": self.lamp_deg, "screen_mm": self.screen_mm, "pixel": self.pixel}
        return Turntable(**{name: value for name, value in said.items() if value is not None})  # type: ignore[arg-type]

    def as_in_the_paper(self) -> "Options":
        """The paper's own set-up; `InputError` where options contradict it."""
        said = {
            "--picture-width": self.picture_width,
            "--slices-tall": None if self.slices_tall == 1 else self.slices_tall,
            "--pixel": None if self.pixel == 1 else self.pixel,
            "--angles-deg": self.angles_deg,
            "--span-deg": self.span_deg,
            "--elevation-deg": self.elevation_deg,
            "--powers": self.powers,
            "--lamp-power": self.lamp_power,
            "--lamp-max": self.lamp_max,
            "--lamp-deg": self.lamp_deg or None,
            "--screen-mm": self.screen_mm,
            "--hold-deg": self.hold_deg,
            "--shift": self.shift or None,
            "--light": None if self.light == "thin" else self.light,
            "--points": self.points,
            "--grain": self.grain or None,
            "--mat": None if self.mat == "none" else self.mat,
        }
        contradiction = [name for name, value in said.items() if value is not None]
        if contradiction:
            raise InputError(
                f"--paper says what {contradiction[0]} says too (lamp level and of power 1, half a turn, pictures as "
                "wide as the cube and as fine, no hold, thin beams): leave out one of the two"
            )
        level = replace(self, elevation_deg=0.0, span_deg=180.0, hold_deg=0.0, lamp_power=1.0, picture_width=1.0)
        level = replace(level, light="thin")
        return replace(level, shape=self.voxels, n=None)

    @property
    def recipe(self) -> Recipe:
        """How the cube is solved, held where that is said; `InputError` where options contradict each other."""
        if self.quality is not None and self.iterations is not None:
            raise InputError("--quality and --iterations both say how many passes: leave one of them out")
        if self.quality is not None and self.method != "display":
            raise InputError(f"--quality is for method display: use --iterations with method {self.method}")
        said: dict[str, Any] = {
            "method": self.method,
            "powers": self.powers,
            "hold_deg": self.hold_deg,
            "material": None if self.max_extinction is None else Material(self.max_extinction),
            "light": self._beams,
            "mat": Mat(TONES[self.mat]) if self.mat in TONES else None,
            "passes": self.iterations,
        }
        said = {name: value for name, value in said.items() if value is not None}
        fast = self.iterations is None and self.method == "display"
        recipe = Recipe.of_quality(self.quality or "normal", **said) if fast else Recipe(**said)
        return recipe if self.grain is None else self._with_grain(recipe, self.grain)

    def _with_grain(self, recipe: Recipe, grain: float) -> Recipe:
        """How much the points of a pixel weigh beside its mean, where that is said."""
        if recipe.beams.is_thin and grain:
            raise InputError(f"--grain {grain:g} is for light on areas: leave out --light thin, or use method display")
        return replace(recipe, light=replace(recipe.beams, grain=grain))

    @property
    def _beams(self) -> Light | None:
        """How fine light is, where that is said."""
        if self.light == "thin" and self.points is not None:
            raise InputError(f"--light thin is one beam a pixel, not --points {self.points}: leave out one of the two")
        if self.light == "thin":
            return Light.thin()
        return None if self.points is None else Light(self.points, self.points)
