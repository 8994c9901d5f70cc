"""The command `lightcube report`."""

import hashlib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from lightcube import io, staging
from lightcube.cli_options import JSON, OVERWRITE
from lightcube.console import done, progress
from lightcube.cube import Cube
from lightcube.errors import InputError
from lightcube.fitting import check_fit, fit_to_views, frames_from_targets
from lightcube.frames import Frames
from lightcube.report.command import reproducing
from lightcube.report.measuring import Findings, measure
from lightcube.report.page import Origin, page


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
    io.check_page_target(target, overwrite=overwrite)
    loaded = io.load(cube)
    wanted = frames_from_targets(loaded) if frames is None else refitted(loaded, frames)
    stage = io.read_stage(frames, transfer=loaded.transfer)[0] if frames is not None and io.is_stage(frames) else None
    with progress("measuring", as_json=as_json) as advance:
        found = measure(loaded, wanted, stage, advance)
    made = Path(cube.removesuffix(".partial")).name
    text = page(
        found, title, _compared(found, frames), reproducing(loaded, wanted, frames, made), [*_origins(cube, frames)]
    )
    io.write_page(target, text, overwrite=overwrite)
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


def _origins(cube: str, frames: str | None) -> Iterator[Origin]:
    """The files on this disk that were read."""
    read = [("cube", Path(cube))]
    if frames is not None and io.is_stage(frames):
        read += [("stage", Path(frames)), *(("pictures", path) for path in io.stage_pictures(frames))]
    elif frames is not None:
        read.append(("pictures", Path(frames)))
    for role, path in read:
        if path.exists():
            yield _origin(role, path)


def _origin(role: str, path: Path) -> Origin:
    """Size and checksum of a file, or of all files of a folder that are not hidden."""
    if not path.is_dir():
        return Origin(role, path.name, 1, path.stat().st_size, _checksum(path))
    inside = {f"./{each.relative_to(path).as_posix()}": each for each in path.rglob("[!.]*") if each.is_file()}
    shown = {
        name: inside[name]
        for name in sorted(inside, key=lambda name: name.encode("utf-8", "surrogateescape"))
        if "/." not in name
    }
    listed = "".join(f"{_checksum(each)}  {name}\n" for name, each in shown.items())
    size = sum(each.stat().st_size for each in shown.values())
    digest = hashlib.sha256(listed.encode("utf-8", "surrogateescape")).hexdigest()
    return Origin(role, path.resolve().name, len(shown), size, digest)


def _checksum(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def refitted(cube: Cube, frames: str) -> Frames:
    """Pictures as `solve` fitted them to the cube, in its order; `InputError` where they cannot be those it is for."""
    if io.is_stage(frames):
        return staging.wanted(frames, cube)
    if cube.lighting is not None:
        raise InputError(f"the cube was made on a stage: give its file instead of {frames}, or nothing")
    pictures = io.read_pictures(frames, transfer=cube.transfer)
    order = cube.provenance.get("order", range(len(pictures)))
    if len(order) == len(pictures):
        images, names = (tuple(each[picture] for picture in order) for each in (pictures.images, pictures.names))
        pictures = replace(pictures, images=images, names=names)
    if pictures.angles is not None and len(pictures) == len(cube.views):
        apart = np.abs(np.remainder(pictures.angles - cube.views.angles + 180, 360) - 180)
        if np.max(apart) > 1e-6:
            raise InputError(
                f"{frames} says other angles than the cube was made for: give the pictures it was made from"
            )
    return fit_to_views(pictures, cube.views, check_fit(cube.provenance.get("fit", "crop")))
