"""The options that commands have in common."""

from typing import Annotated

import typer

FRAMES = Annotated[str, typer.Argument(help="A folder of pictures, an animated image, a video, or a stage (TOML).")]

OUT = typer.Option("-o", "--out", help="Where to write; the suffix says what.")
OVERWRITE = typer.Option("--overwrite", help="Replace the target if it exists.")
JSON = typer.Option("--json", help="Print JSON for machines.")
FPS = typer.Option("--fps", help="Pictures per second of a movie.")
