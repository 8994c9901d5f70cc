"""The commands of `lightcube stage`."""

from pathlib import Path
from typing import Annotated

import typer

from lightcube import io
from lightcube.cli.console import err, json_document, out
from lightcube.drawing.stage import drawing
from lightcube.optics.stage import Stage
from lightcube.pictures.frames import Frames
from lightcube.planning.placement import doubtful, facts, impossible
from lightcube.planning.reachable import sentences
from lightcube.verbs import staging

app = typer.Typer(
    no_args_is_help=True, rich_markup_mode=None, help="Look at a stage, a room with lamps and screens, before solving."
)

STAGE = Annotated[str, typer.Argument(help="A stage file (TOML).")]


@app.command()
def check(
    stage: STAGE, as_json: Annotated[bool, typer.Option("--json", help="Print JSON for machines.")] = False
) -> None:
    """Say what is impossible on a stage, or probably not meant; exit code 2 where anything is impossible."""
    checked(*io.read_stage_frames(stage), as_json=as_json)


@app.command()
def draw(
    stage: STAGE,
    output: Annotated[str, typer.Option("-o", "--out", help="Where to write the drawing (SVG).")],
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the target if it exists.")] = False,
) -> None:
    """Draw the room from above and from the side, with the beams."""
    plan = io.Output(output, "drawing", overwrite)
    plan.check()
    plan.write(drawing(io.read_stage(stage)[0]))
    out.print(f"{Path(output)}")


def checked(stage: Stage, frames: Frames, *, as_json: bool) -> None:
    """Print what is known of a stage and its pictures; exit code 2 where something on it is impossible."""
    wrong, odd = impossible(stage), [*doubtful(stage), *sentences(frames)]
    if as_json:
        json_document({**facts(stage), "impossible": wrong, "doubtful": odd})
    else:
        for line in [*staging.table(stage), "", *odd]:
            out.print(line)
        for sentence in wrong:
            err.print(f"impossible: {sentence}")
        if not wrong:
            out.print("nothing here is impossible")
    if wrong:
        raise typer.Exit(2)
