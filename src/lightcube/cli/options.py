"""The options that commands have in common."""

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Annotated, Any

import typer

from lightcube import cores
from lightcube.cli import arguments

PICTURES = Annotated[str, typer.Argument(help="A folder of pictures, an animated image, a video, or a stage (TOML).")]

OUT = typer.Option("-o", "--out", help="Where to write; the suffix says what.", rich_help_panel="Output")
OVERWRITE = typer.Option("--overwrite", help="Replace the target if it exists.", rich_help_panel="Output")
VERBOSE = typer.Option("--verbose", help="Print all numbers too.", rich_help_panel="Output")
JSON = typer.Option("--json", help="Print JSON for machines.", rich_help_panel="Output")
TITLE = typer.Option("--title", help="What it is called.  [default: the cube's name]")
BY = typer.Option("--by", help="Who made it.", show_default=False)
NOTE = typer.Option("--note", help="A dedication, or a word on it.", show_default=False)
FPS = typer.Option("--fps", help="Pictures per second of a movie.", rich_help_panel="Output")
THREADS = Annotated[
    str | None,
    typer.Option(
        help="Compute with so many threads; results are the same.  [default: the cores that are free]",
        rich_help_panel="Machine",
    ),
]


def threaded(command: Callable[..., None]) -> Callable[..., None]:
    """Let the command line say with how many threads a command computes."""

    @wraps(command)
    def told(*, threads: str | None, **given: Any) -> None:
        if threads is None:
            cores.default()  # refuses what the environment says, where that is no number
        else:
            cores.threads(arguments.threads(threads))
        command(**given)

    signature, by_name = inspect.signature(command), inspect.Parameter.KEYWORD_ONLY
    parameters = [parameter.replace(kind=by_name) for parameter in signature.parameters.values()]
    said = inspect.Parameter("threads", by_name, default=None, annotation=THREADS)
    told.__signature__ = signature.replace(parameters=[*parameters, said])  # type: ignore[attr-defined]
    return told
