"""What may be said of a cube before it is solved."""

from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

import numpy as np

from lightcube.backward.mat import TONES, Mat
from lightcube.backward.recipe import Powers, Quality, Recipe
from lightcube.errors import InputError
from lightcube.optics.attenuator import Films
from lightcube.optics.dyes import Dyes
from lightcube.optics.glass import Bottom, Form, Glass
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
#: The longest side of a cube, mm, unless something else is said.
SIZE_MM = 100.0
#: Pictures that are taken of a film, at most, unless something else is said.
FILM_MOST = 32


#: What is said of cubes, and not of films.
_NOT_OF_FILMS = (
    *("shape", "slices_tall", "picture_width", "hold_deg", "order", "shift", "mat", "elevation_deg", "span_deg"),
    *("angles_deg", "paper", "lamp_deg", "screen_mm", "grain", "ior", "form", "bottom", "bath_mm", "clear", "veil"),
)

#: What options are about, in the order in which people are told of them.
Group = Literal["Pictures", "Geometry", "Lamp", "Material", "Quality"]


@dataclass(frozen=True)
class Option:
    """What an option is about, what people are told of it, with its unit, and the least number that it takes."""

    group: Group
    help: str
    least: int | None = None


@dataclass(frozen=True)
class Options:
    """What is said of the cube, None where nothing is; of each group what is used most stands first."""

    fit: Annotated[
        Fit,
        Option(
            "Pictures",
            "Pictures of another shape than the first: crop their edges, pad (leave the rest free), or stretch.",
        ),
    ] = "crop"
    focus: Annotated[
        tuple[float, float] | None,
        Option(
            "Pictures",
            "X,Y that stays in the middle where pictures are cropped, as parts of their width and height from the "
            "upper left, 0 to 1.  [default: 0.5,0.5]",
        ),
    ] = None
    most: Annotated[
        int | None,
        Option(
            "Pictures",
            "Take at most so many pictures of a video or animation, evenly spread.  [default: 32, with --every all]",
            1,
        ),
    ] = None
    every: Annotated[int | None, Option("Pictures", "Take one of so many pictures of a video or animation.", 1)] = None
    from_s: Annotated[float | None, Option("Pictures", "Where to begin in a video, in seconds.  [default: 0]")] = None
    to_s: Annotated[float | None, Option("Pictures", "Where to end in a video, in seconds.  [default: its end]")] = None
    picture_width: Annotated[
        float | None,
        Option(
            "Pictures",
            "Width of the pictures as a part of the cube's width: 0.5 is half.  [default: as wide as 40 dB, hard to "
            "tell from what is wanted, are expected]",
        ),
    ] = None
    hold_deg: Annotated[
        float | None,
        Option(
            "Pictures",
            "How far each picture shall stand to either side of its stop, in degrees of the turntable.  "
            "[default: 16 / voxels across, degrees]",
        ),
    ] = None
    order: Annotated[
        Arrangement, Option("Pictures", "Whether pictures stand as given, or in the order that gives the best ones.")
    ] = "given"
    shift: Annotated[
        int, Option("Pictures", "Let pictures stand up to so many pixels higher, lower or aside, in turn.", 0)
    ] = 0
    mat: Annotated[
        Surround | None, Option("Pictures", "Calm surround of each picture.  [default: dark; thin beams: none]")
    ] = None
    transfer: Annotated[
        Transfer,
        Option("Pictures", "What values of pictures mean: srgb, as screens and cameras do, or linear light itself."),
    ] = "srgb"
    n: Annotated[int | None, Option("Geometry", "Voxels along the cube's longest side.  [default: 128]")] = None
    size_mm: Annotated[
        float | None,
        Option("Geometry", "Longest side of the cube, or of pictures of films, in mm.  [default: 100, films 160]"),
    ] = None
    films: Annotated[
        int | None,
        Option("Geometry", "A stack of so many printed films instead of a cube; --n counts cells along a picture.", 1),
    ] = None
    gap_mm: Annotated[
        float | None, Option("Geometry", "With --films: mm from one film to the next.  [default: 12]")
    ] = None
    elevation_deg: Annotated[
        float | None,
        Option("Geometry", "How high the lamp stands over the horizon, in degrees; 0 is level.  [default: 35]"),
    ] = None
    span_deg: Annotated[
        float | None,
        Option("Geometry", "Degrees of the turntable over which the stops spread evenly.  [default: 360, level 180]"),
    ] = None
    angles_deg: Annotated[
        tuple[float, ...] | None,
        Option("Geometry", "The stops themselves, A,B,C, one per picture, in degrees of the turntable."),
    ] = None
    shape: Annotated[
        tuple[int, int, int] | None,
        Option("Geometry", "Voxels upwards, in depth and across, NZ,NY,NX, instead of --n."),
    ] = None
    pixel: Annotated[int, Option("Geometry", "Voxels along a side of each pixel of the pictures.", 1)] = 1
    slices_tall: Annotated[
        int, Option("Geometry", "Height of a slice of the cube in widths of a voxel; --n counts widths.", 1)
    ] = 1
    paper: Annotated[
        bool,
        Option("Geometry", "The paper's set-up: level lamp of power 1, half a turn, pictures of full width."),
    ] = False
    assembly_mm: Annotated[
        float | None,
        Option("Geometry", "With --films: mm by which films may lie off, so that pictures stand it.  [default: 0]"),
    ] = None
    seed: Annotated[int, Option("Quality", "With --films: number of the random films that passes start from.", 0)] = 0
    lamp_max: Annotated[
        float | None,
        Option(
            "Lamp",
            "Largest power of the lamp: 1 makes the bare wall white, 16 is 4 stops of a camera more (+4 EV).  "
            "[default: 16]",
        ),
    ] = None
    lamp_power: Annotated[
        float | None,
        Option("Lamp", "Power of a lamp that stays the same: 1 makes the bare wall white, 2 is 1 stop more (+1 EV)."),
    ] = None
    powers: Annotated[
        Powers | None,
        Option(
            "Lamp", "One lamp power per picture and colour (coarse: found at half size), or one per colour for all."
        ),
    ] = None
    lamp_deg: Annotated[
        float | None,
        Option(
            "Lamp",
            "Width of the lamp's disc as the cube sees it, in degrees: the sun's is 0.5.  [default: 0, a point]",
        ),
    ] = None
    screen_mm: Annotated[
        float | None,
        Option(
            "Lamp",
            "With --lamp-deg or --ior: mm from the turning cube's reach to the wall.  [default: the cube's width; "
            "behind glass further]",
        ),
    ] = None
    black: Annotated[
        float | None,
        Option("Lamp", "What the wall cannot be darker than, as a part of white in display values, 0.002 to 1."),
    ] = None
    max_extinction: Annotated[
        float | None,
        Option(
            "Material",
            "How quickly light may fade in the darkest glass, per mm (1/mm): 0.1 leaves 37 % after 10 mm.  "
            "[default: to 5 % along one voxel; thin beams: any]",
        ),
    ] = None
    clear: Annotated[
        tuple[float, ...] | None,
        Option(
            "Material",
            "What the clearest glass takes of the light, absorbed or thrown aside by haze, per mm: 0.01 leaves 37 % "
            "after 100 mm.  One number, or one of red, green, blue as 0.01,0.01,0.02.  [default: 0]",
        ),
    ] = None
    veil: Annotated[
        float | None,
        Option(
            "Lamp",
            "Light that lies evenly over the wall whatever the cube, thrown aside by haze or by the room, as a part of "
            "what the lamp brings to the bare wall: 0.001 is a thousandth.  [default: 0]",
        ),
    ] = None
    material: Annotated[
        Dyes | None,
        Option(
            "Material",
            "Solve for amounts of dyes, within what they can make: a material's file (TOML), or the name of one, as "
            "lightcube materials lists them.  [default: any colours]",
        ),
    ] = None
    ior: Annotated[
        tuple[float, ...] | None,
        Option(
            "Material",
            "Index of refraction of clear glass or resin around the voxels, 1 to 4, or R,G,B: light bends.  "
            "[default: none; with --form 1.5]",
        ),
    ] = None
    form: Annotated[
        Form | None,
        Option(
            "Material",
            "What the light enters: the block, a cylinder or sphere cut of it, or a bath around it, square or round.  "
            "[default: block]",
        ),
    ] = None
    bottom: Annotated[
        Bottom | None,
        Option("Material", "Whether light may leave a block of glass through its bottom.  [default: open]"),
    ] = None
    bath_mm: Annotated[
        float | None,
        Option("Material", "From side to side of a bath, in mm.  [default: 1.1 times what the cube sweeps]"),
    ] = None
    quality: Annotated[
        Quality | None, Option("Quality", "At most 30, 200 or 400 passes over all pictures.  [default: normal]")
    ] = None
    iterations: Annotated[
        int | None, Option("Quality", "At most so many passes over all pictures, instead of --quality.")
    ] = None
    grain: Annotated[
        float | None,
        Option(
            "Quality",
            "Weight, 0 to 2, of a pixel's points beside its mean: the more, the smoother from near by.  "
            "[default: auto, 0.01 where 38 dB are expected]",
        ),
    ] = None
    points: Annotated[
        int | None,
        Option(
            "Quality",
            "Average over so many points of each pixel, with --lamp-deg thrice; of larger ones over up to 34.  "
            "[default: 13, level 7; best: 34, 15]",
            1,
        ),
    ] = None
    light: Annotated[
        Beams | None,
        Option("Quality", "Light as a wall shows it, averaged over areas, or the paper's thin beams.  [default: area]"),
    ] = None
    method: Annotated[str, Option("Quality", f"How the cube is computed: one of {', '.join(METHODS)}.")] = "display"

    @property
    def voxels(self) -> tuple[int, int, int]:
        """``(nz, ny, nx)`` that `n` or `shape` say, a cube where that is `n`; `InputError` where they cannot be."""
        if self.n is not None and self.shape is not None:
            raise InputError("--n and --shape both say how many voxels: leave one of them out")
        nz, ny, nx = self.shape or (DEFAULT_N if self.n is None else self.n,) * 3
        if min(nz, ny, nx) < 1:
            raise InputError(f"--n {self.n}: a cube needs at least 1 voxel a side")
        self._check_size()
        return nz, ny, nx

    @property
    def longest_mm(self) -> float:
        """Longest side of a cube, mm."""
        return SIZE_MM if self.size_mm is None else self.size_mm

    def _check_size(self) -> None:
        """Raise `InputError` where a size is none."""
        if self.size_mm is not None and not (np.isfinite(self.size_mm) and self.size_mm > 0):
            raise InputError(f"--size-mm {self.size_mm}: give a positive number of millimetres")

    @property
    def stack(self) -> Films | None:
        """The films that are asked for, if any; `InputError` where options contradict them."""
        if self.films is None:
            if self.gap_mm is not None:
                raise InputError("--gap-mm is for a stack of films: say how many with --films")
            return None
        nothing = Options()
        for name in _NOT_OF_FILMS:
            if getattr(self, name) != getattr(nothing, name):
                raise InputError(f"--{name.replace('_', '-')} is for cubes, not for --films: leave one of the two out")
        self._check_size()
        cells, pixel = 64 if self.n is None else self.n, 2 if self.pixel == 1 else self.pixel
        if cells < pixel or cells % pixel:
            raise InputError(f"--n {cells} cells do not make whole pixels of {pixel}: give a multiple of that")
        said = {"gap_mm": self.gap_mm, "size_mm": self.size_mm}
        given = {name: value for name, value in said.items() if value is not None}
        return Films(self.films, pixels=cells // pixel, cells_a_pixel=pixel, **given)  # type: ignore[arg-type]

    @property
    def glass(self) -> Glass | None:
        """What bends the light, where that is said."""
        said = {"ior": self.ior, "form": self.form, "bottom": self.bottom, "bath_mm": self.bath_mm}
        given: dict[str, Any] = {name: value for name, value in said.items() if value is not None}
        return Glass(**given) if given else None

    @property
    def middle(self) -> tuple[float, float]:
        """What stays in the middle of cropped pictures; `InputError` where nothing is cropped, or it cannot be."""
        if self.focus is not None and self.fit != "crop":
            raise InputError(
                f"--focus is for pictures that are cropped, not for --fit {self.fit}: leave out one of the two"
            )
        if self.focus is not None and not all(0 <= part <= 1 for part in self.focus):
            x, y = self.focus
            raise InputError(
                f"--focus {x:g},{y:g} is outside the picture: give two numbers from 0 to 1, such as 0.5,0.3"
            )
        return self.focus or (0.5, 0.5)

    @property
    def film(self) -> dict[str, Any]:
        """What is taken of a film, as `lightcube.read_pictures` takes it; what is all of it is left out."""
        most = FILM_MOST if self.most is None and self.every is None else self.most
        said = {"from_s": self.from_s, "to_s": self.to_s, "every": self.every, "most": most}
        return {name: value for name, value in said.items() if value is not None}

    @property
    def is_of_a_film(self) -> bool:
        """Whether something is said that only films have."""
        return (self.most, self.every, self.from_s, self.to_s) != (None, None, None, None)

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
        said: dict[str, Any] = {
            "angles_deg": self.angles_deg,
            "power": power,
            "power_max": self.lamp_max,
            "black": self.black,
        }
        said |= {"span_deg": self.span_deg, "elevation_deg": self.elevation_deg}
        said |= {"lamp_deg": self.lamp_deg, "screen_mm": self.screen_mm, "pixel": self.pixel, "glass": self.glass}
        said["veil"] = self.veil
        return Turntable(**{name: value for name, value in said.items() if value is not None})

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
            "--ior": self.ior,
            "--form": self.form,
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
        if self.material is not None and self.max_extinction is not None:
            raise InputError("--material says how dark it can be: leave --max-extinction out")
        if self.material is not None and self.clear is not None:
            raise InputError("--material says what its clear part takes (base, haze): leave --clear out")
        said: dict[str, Any] = {
            "method": self.method,
            "powers": self.powers,
            "hold_deg": self.hold_deg,
            "material": self._bound,
            "light": self._beams,
            "mat": Mat(TONES[self.mat]) if self.mat in TONES else None,
            "passes": self.iterations,
            "seed": self.seed,
            "assembly_mm": self.assembly_mm,
        }
        said = {name: value for name, value in said.items() if value is not None}
        fast = self.iterations is None and self.method == "display"
        recipe = Recipe.of_quality(self.quality or "normal", **said) if fast else Recipe(**said)
        recipe = recipe if self.clear is None else recipe.in_clear(self.clear)
        return recipe if self.grain is None else self._with_grain(recipe, self.grain)

    def _with_grain(self, recipe: Recipe, grain: float) -> Recipe:
        """How much the points of a pixel weigh beside its mean, where that is said."""
        if recipe.beams.is_thin and grain:
            raise InputError(f"--grain {grain:g} is for light on areas: leave out --light thin, or use method display")
        return replace(recipe, light=replace(recipe.beams, grain=grain))

    @property
    def _bound(self) -> Material | None:
        """What voxels can be, where that is said."""
        if self.material is not None:
            return Material(dyes=self.material)
        return None if self.max_extinction is None else Material(self.max_extinction)

    @property
    def _beams(self) -> Light | None:
        """How fine light is, where that is said."""
        if self.light == "thin" and self.points is not None:
            raise InputError(f"--light thin is one beam a pixel, not --points {self.points}: leave out one of the two")
        if self.light == "thin":
            return Light.thin()
        return None if self.points is None else Light(self.points, self.points)
