"""The options that `check` and `solve` have in common."""

import inspect
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import wraps
from typing import Annotated, Any, Literal

import numpy as np
import typer

from lightcube import arguments, backward, cores
from lightcube.fitting import Fit
from lightcube.problem import BLACK, Lamp
from lightcube.transfer import Transfer

Arrangement = Literal["given", "best"]

FRAMES = Annotated[str, typer.Argument(help="A folder of pictures, an animated image, a video, or a stage (TOML).")]

OUT = typer.Option("-o", "--out", help="Where to write; the suffix says what.")
OVERWRITE = typer.Option("--overwrite", help="Replace the target if it exists.")
JSON = typer.Option("--json", help="Print JSON for machines.")
LAMP_SAMPLES = typer.Option(help="Points at which a stage's lamps of a size are sampled, for soft shadows.", min=1)
PIXEL_SAMPLES = typer.Option(help="Points along a side that a stage's pixels are averaged over.", min=1)
FPS = typer.Option("--fps", help="Pictures per second of a movie.")
THREADS = Annotated[
    str | None,
    typer.Option(help="Compute with so many threads; results are the same.  [default: the cores that are free]"),
]


@dataclass(frozen=True)
class Options:
    """What the command line says of the cube, None where it says nothing."""

    n: Annotated[int | None, typer.Option("--n", help="Voxels along the cube's longest side.  [default: 128]")] = None
    shape: Annotated[str | None, typer.Option(help="Voxels along each axis, NZ,NY,NX, instead of --n.")] = None
    size_mm: Annotated[float, typer.Option(help="Longest side of the cube in mm.")] = 100.0
    frame_width: Annotated[
        float | None,
        typer.Option(help="Width of the pictures as a part of the cube's; default as wide as 40 dB are expected."),
    ] = None
    fit: Annotated[
        Fit,
        typer.Option(
            help="Pictures of another aspect than the first: cut their edges, leave the rest free, or distort."
        ),
    ] = "crop"
    angles: Annotated[str | None, typer.Option(help="Turntable angles in degrees, A,B,C, one per picture.")] = None
    span: Annotated[
        float | None, typer.Option(help="Degrees to spread the views over, evenly.  [default: 360, level 180]")
    ] = None
    elevation: Annotated[
        float | None, typer.Option(help="Elevation of the lamp in degrees; 0 is level.  [default: 35]")
    ] = None
    paper: Annotated[
        bool, typer.Option("--paper", help="The paper's set-up: level lamp of power 1, half a turn, full width.")
    ] = False
    order: Annotated[
        Arrangement, typer.Option(help="Whether pictures stand as given, or in the order that gives the best ones.")
    ] = "given"
    shift: Annotated[
        int, typer.Option(help="Let pictures stand up to so many pixels higher, lower or aside, in turn.", min=0)
    ] = 0
    quality: Annotated[
        backward.Quality | None, typer.Option(help="At most 30, 200 or 1000 passes.  [default: normal]")
    ] = None
    method: Annotated[str, typer.Option(help=f"One of {', '.join(backward.METHODS)}.")] = "display"
    iterations: Annotated[int | None, typer.Option(help="At most so many passes, instead of --quality.")] = None
    lamp: Annotated[
        Lamp | None,
        typer.Option(
            help="One power per picture and colour (coarse: found at half size), or one per colour, or fixed."
        ),
    ] = None
    lamp_power: Annotated[float | None, typer.Option(help="Power of a fixed lamp, linear light; 1 is white.")] = None
    lamp_max: Annotated[float | None, typer.Option(help="Largest power of the lamp, at least 1.  [default: 16]")] = None
    hold: Annotated[
        float | None,
        typer.Option(
            help="Degrees around its stop over which each picture shall stand; default what costs below 1 dB."
        ),
    ] = None
    black: Annotated[
        float | None, typer.Option(help="Display value, 0.002 to 1, that the screen cannot be darker than.")
    ] = None
    max_extinction: Annotated[
        float | None, typer.Option(help="Largest extinction of the material, 1/mm; default none.")
    ] = None
    transfer: Annotated[Transfer, typer.Option(help="How picture values become linear light.")] = "srgb"
    lamp_samples: Annotated[int, LAMP_SAMPLES] = 1
    pixel_samples: Annotated[int, PIXEL_SAMPLES] = 1

    @property
    def power(self) -> float:
        """Largest power of the lamp, linear light."""
        return self.lamp_power or self.lamp_max or (1.0 if self.lamp == "fixed" else backward.LAMP_MAX)

    @property
    def lamps(self) -> dict[str, Any]:
        """As `lightcube.backward.solve` and `lightcube.planning.plan` take them."""
        most = np.inf if self.max_extinction is None else self.max_extinction
        return {
            "lamp": self.lamp,
            "lamp_power": self.lamp_power,
            "lamp_max": self.lamp_max,
            "max_extinction": most,
            "black": BLACK if self.black is None else self.black,
        }


def threaded(command: Callable[..., None]) -> Callable[..., None]:
    """Let the command line say with how many threads a command computes."""

    @wraps(command)
    def told(*, threads: str | None, **given: Any) -> None:
        cores.threads(None if threads is None else arguments.threads(threads))
        command(**given)

    signature, by_name = inspect.signature(command), inspect.Parameter.KEYWORD_ONLY
    parameters = [parameter.replace(kind=by_name) for parameter in signature.parameters.values()]
    said = inspect.Parameter("threads", by_name, default=None, annotation=THREADS)
    told.__signature__ = signature.replace(parameters=[*parameters, said])  # type: ignore[attr-defined]
    return told


def one_by_one(command: Callable[..., None]) -> Callable[..., None]:
    """Let the command line give the fields of `Options` one by one, where a command has a parameter ``options``."""

    @wraps(command)
    def taking(**given: Any) -> None:
        command(options=Options(**{each.name: given.pop(each.name) for each in fields(Options)}), **given)

    signature, by_name = inspect.signature(command), inspect.Parameter.KEYWORD_ONLY
    said = [
        inspect.Parameter(each.name, by_name, default=each.default, annotation=each.type) for each in fields(Options)
    ]
    parameters = [
        one
        for name, parameter in signature.parameters.items()
        for one in (said if name == "options" else [parameter.replace(kind=by_name)])
    ]
    taking.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    return taking
