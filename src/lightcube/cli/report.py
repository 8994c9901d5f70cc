"""The command `lightcube report`."""

from pathlib import Path
from typing import Annotated

import typer

from lightcube import io
from lightcube.cli.console import done, progress
from lightcube.cli.options import JSON, OVERWRITE
from lightcube.jobs.cubes import load
from lightcube.pictures.fitting import frames_from_targets
from lightcube.report.measuring import Findings, measure
from lightcube.report.page import page
from lightcube.verbs.reproducing import origins, reproducing
from lightcube.verbs.wanted import refitted


def report(
    cube: Annotated[str, typer.Argument(help="A cube.")],
    frames: Annotated[
        str | None, typer.Argument(help="The pictures it was made from; default its own targets.")
    ] = None,
    output: Annotated[
        str | None,
        typer.Option("-o", "--out", help="The page to write.  [default: the cube's name, -report.html, here]"),
    ] = None,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Write all that is known of a cube into one HTML file, to keep and to print: pictures, curves, how it was made."""
    title = io.bare_name(cube)
    target = f"{title}-report.html" if output is None else output
    page_file = io.Output(target, "page", overwrite)
    page_file.check()
    loaded = load(cube)
    wanted = frames_from_targets(loaded) if frames is None else refitted(loaded, frames)
    stage = io.read_stage(frames, transfer=loaded.transfer)[0] if frames is not None and io.is_stage(frames) else None
    with progress("measuring", as_json=as_json) as advance:
        found = measure(loaded, wanted, stage, advance)
    made = Path(cube.removesuffix(".partial")).name
    text = page(
        found, title, _compared(found, frames), reproducing(loaded, wanted, frames, made), [*origins(cube, frames)]
    )
    page_file.write(text)
    size, scores = len(text.encode()), found.scores
    done(
        as_json,
        f"{target}, {size / 1e6:.1f} MB: mean PSNR {scores['psnr_mean']:.2f} dB (worst {scores['psnr_min']:.2f})",
        out=target,
        bytes=size,
        **{name: value for name, value in scores.items() if name != "views"},
    )


def _compared(found: Findings, frames: str | None) -> str:
    """What the cube was compared with, in a sentence."""
    if frames is None:
        return (
            "Compared with the 8-bit pictures that the cube keeps, which cap PSNR at about 59 dB where they were "
            "resampled."
        )
    if found.apart == 0:
        return f"Compared with the pictures in {Path(frames).name}, which are those that the cube was made from."
    off = "" if found.apart is None else f": they differ from these by up to {found.apart} levels of 255"
    about = "which are not known to be those that it was made from"
    return f"Compared with the pictures in {Path(frames).name}, {about}{off}."
