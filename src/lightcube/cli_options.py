"""The options that `check` and `solve` have in common."""

from pathlib import Path
from typing import Annotated

import typer

from lightcube.fitting import Fit
from lightcube.problem import Lamp
from lightcube.solving import Arrangement
from lightcube.transfer import Transfer

FRAMES = Annotated[Path, typer.Argument(help="A folder of pictures, an animated image or a video.")]
N = Annotated[int | None, typer.Option("--n", help="Voxels along the cube's longest side.  [default: 128]")]
SHAPE = Annotated[str | None, typer.Option(help="Voxels along each axis, NZ,NY,NX, instead of --n.")]
FRAME_WIDTH = Annotated[
    float | None,
    typer.Option(help="Width of the pictures as a part of the cube's; default as wide as 40 dB are expected."),
]
FIT = Annotated[
    Fit,
    typer.Option(
        "--fit", help="Pictures of another aspect than the first: cut their edges, leave the rest free, or distort."
    ),
]
ANGLES = Annotated[str | None, typer.Option(help="Turntable angles in degrees, A,B,C, one per picture.")]
SPAN = Annotated[
    float | None, typer.Option(help="Degrees to spread the views over, evenly.  [default: 360, level 180]")
]
ELEVATION = Annotated[float | None, typer.Option(help="Elevation of the lamp in degrees; 0 is level.  [default: 35]")]
PAPER = Annotated[
    bool,
    typer.Option("--paper", help="The paper's set-up: level lamp of power 1, half a turn, full width."),
]
ORDER = Annotated[
    Arrangement, typer.Option(help="Whether pictures stand as given, or in the order that gives the best ones.")
]
LAMP = Annotated[
    Lamp | None,
    typer.Option(help="One power per picture and colour (coarse: found at half size), or one per colour, or fixed."),
]
LAMP_POWER = Annotated[float | None, typer.Option(help="Power of a fixed lamp, linear light; 1 is white.")]
LAMP_MAX = Annotated[float | None, typer.Option(help="Largest power of the lamp, at least 1.  [default: 16]")]
HOLD = Annotated[
    float | None,
    typer.Option(help="Degrees around its stop over which each picture shall stand; default what costs below 1 dB."),
]
TRANSFER = Annotated[Transfer, typer.Option(help="How picture values become linear light.")]
SHIFT = Annotated[
    int,
    typer.Option(help="Let pictures stand up to so many pixels higher, lower or aside, in turn.", min=0),
]
BLACK_LEVEL = Annotated[
    float | None, typer.Option("--black", help="Display value, 0.002 to 1, that the screen cannot be darker than.")
]
MAX_EXTINCTION = Annotated[float | None, typer.Option(help="Largest extinction of the material, 1/mm; default none.")]
