"""What can be asked of exports: what would be written, what a file holds and how good that is, what is said of both."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from lightcube.errors import InputError
from lightcube.fabrication import reading, sidecar
from lightcube.forward.casting import cast
from lightcube.jobs.reading import load
from lightcube.optics.arrays import locked
from lightcube.optics.cube import Cube
from lightcube.pictures.targets import Targets
from lightcube.scoring import metrics
from lightcube.verbs.refitting import wanted_of
from lightcube.wording import counted

#: A file that casts worse than this, dB, may have been mirrored on its way; one that is better by so much the other
#: way round has been.
_POOR_DB, _BETTER_DB = 15.0, 6.0
#: What the name of a cube ends with.
_CUBES = (".zarr", ".zarr.zip", ".npz")
#: Which way a file may lie, as it is said.
_WAYS = {"x": "left and right", "y": "front and back", "z": "bottom and top"}


def opened(path: str, *, force: bool = False, like: Cube | None = None) -> Cube:
    """The cube of a file of its own, or of one that was exported, with the targets of the cube it was made from."""
    if not reading.is_exported(path):
        return load(path)
    cube = reading.read_export(path, like=like, force=force)
    made_from = like or _original(path)
    if made_from is None or made_from.targets is None or made_from.rig.picture_shape != cube.rig.picture_shape:
        return cube
    return replace(cube, targets=made_from.targets) if len(made_from.rig) == len(cube.rig) else cube


def _original(path: str) -> Cube | None:
    """The cube that something was made from, where that is still what it was."""
    found = reading.original(path)
    if found is None:
        return None
    at, digest = found
    try:
        cube = load(at)
    except InputError:
        return None
    return cube if sidecar.digest_of(cube) == digest else None


def measured(path: str, pictures: str | None, *, force: bool) -> tuple[Cube, Targets]:
    """What a file holds, and the pictures that it is compared with: of a cube, of a folder, or of its own cube."""
    is_cube = pictures is not None and pictures.rstrip("/").lower().endswith(_CUBES)
    if is_cube:
        like = load(str(pictures))
        return opened(path, force=force, like=like), wanted_of(like, None)
    cube = opened(path, force=force)
    if pictures is None and cube.targets is None:
        raise InputError(
            f"{path} does not hold what was wanted, and the cube it was made from is not where it was: name that, or "
            "the pictures, as in lightcube score FILE cube.zarr"
        )
    return cube, wanted_of(cube, pictures)


@dataclass(frozen=True)
class Turned:
    """A way round in which a file would be better.

    Parameters
    ----------
    axes
        Along which it is to be mirrored.
    psnr_mean
        What it would be then, dB.
    """

    axes: str
    psnr_mean: float


def turned(cube: Cube, targets: Targets, psnr_mean: float) -> Turned | None:
    """The best of the seven other ways round, where a file is poor and another one is better, or far better."""
    ways = ["".join(axes) for count in (1, 2, 3) for axes in combinations("xyz", count)]
    worth = {way: _thin(_mirrored(cube, way), targets) for way in ("", *ways)}
    best = max(ways, key=lambda way: worth[way])
    gain = worth[best] - worth[""]
    if gain <= 0 or (gain < _BETTER_DB and psnr_mean >= _POOR_DB):
        return None
    other = metrics.score(_mirrored(cube, best), targets)["psnr_mean"]
    return Turned(best, other) if other > psnr_mean else None


def _mirrored(cube: Cube, axes: str) -> Cube:
    """A cube that is mirrored along axes."""
    at = tuple(1 + "zyx".index(axis) for axis in axes)
    return replace(cube, extinction=locked(np.flip(cube.extinction, at).copy()), amounts=None, dyes=None)


def _thin(cube: Cube, targets: Targets) -> float:
    """Mean PSNR of thin beams: enough to tell which way round something lies, and quick."""
    return metrics.mean_psnr(np.stack(list(cast(cube, light="thin"))), targets)


def said_of_score(path: str, found: Turned | None, psnr_mean: float) -> list[str]:
    """How the score of a file compares with what it was to be, and whether it lies the other way round."""
    before = reading.predicted(path)
    lines = [] if before is None else [f"as it was exported: mean PSNR {before:.2f} dB"]
    if found is not None:
        ways = " and ".join(_WAYS[axis] for axis in found.axes)
        lines.append(
            f"the other way round, {ways} exchanged, it would be {found.psnr_mean:.2f} dB instead of {psnr_mean:.2f}: "
            f"the file is mirrored or reversed, {_remedy(path, found.axes)}"
        )
    return lines


def _remedy(path: str, axes: str) -> str:
    """What to do with a file that lies the other way round."""
    if not reading.is_film(path):
        return f"export with --flip {axes} or put it right"
    return "put its pages in the order of their numbers" if axes == "z" else "export it again, or with --mirror"


def made_from(cube: str, output: str) -> str | None:
    """Where a cube is as seen from the folder that something is written into; None where one is at a URL."""
    if "://" in cube or "://" in output:
        return None
    return os.path.relpath(cube, Path(output).absolute().parent)


def said_of_films(stack: Cube) -> list[str]:
    """What solving a cube anew for films gains."""
    found, slices = stack.scores["psnr_mean"], stack.provenance["psnr_of_slices"]
    films = counted(stack.grid.shape[0], "film")
    return [f"{films}, solved for themselves: mean PSNR {found:.1f} dB; the cube's slices as they are {slices:.1f}"]


def told(document: Mapping[str, Any]) -> list[str]:
    """What was written, in sentences."""
    lines = [] if "size_mm" not in document else [f"{_along(document['size_mm'])} mm (x, y, z){_how(document)}"]
    lines += [
        f"{each['part']}: {each['colour']}, holds {each['holds']:.0%} of all extinction, {each['faces']} faces"
        for each in document.get("shells", ())
    ]
    if "round_s" in document:
        lines.append(f"{counted(document['stops'], 'stop')}, once round takes {document['round_s']:.0f} s")
    lines += _cast(document.get("predicted") or {})
    blocks = document.get("cast_in", {})
    if "predicted" in document and any(count > 1 for count in blocks.values()):
        lines.append(f"cast in blocks of {_along(blocks)} droplets, for which the memory does: some 3 dB too good")
    white = document.get("one_white_lamp")
    if white:
        lines.append(f"one constant white lamp instead, of power {white['power']:.3g}: {_mean(white)}")
    return [*lines, *document.get("notes", ())]


def _cast(predicted: Mapping[str, float]) -> list[str]:
    """How good what a file casts is."""
    if not predicted:
        return []
    own = predicted.get("psnr_mean_of_cube")
    lines = [f"what the file casts: {_mean(predicted)}" + ("" if own is None else f"; the cube itself {own:.1f}")]
    before = predicted.get("psnr_mean_of_old_lamps")
    if before is not None:
        lines.append(f"under lamps found anew, which the sidecar has; under the cube's own it is {before:.1f} dB")
    return lines


def _mean(figures: Mapping[str, float]) -> str:
    return f"mean PSNR {figures['psnr_mean']:.1f} dB (worst {figures['psnr_min']:.1f})"


def _how(document: Mapping[str, Any]) -> str:
    """Of how many parts something is, and how large they are."""
    if "droplets" in document:
        um = {axis: 1000 * mm for axis, mm in document["pitch_mm"].items()}
        return f": {_along(document['droplets'])} droplets of {_along(um)} micrometres, seed {document['seed']}"
    if "films" in document:
        films, dots = counted(document["films"], "film"), counted(document["dots_a_cell"], "dot")
        return f": {films} on {document['paper']}, a cell is {dots} at {document['dpi'][0]} dpi"
    if "voxels" in document:
        return f": {_along(document['voxels'])} voxels of {_along(document['pitch_mm'])} mm"
    return f", about {document['about']} points" if "about" in document else ""


def _along(numbers: Mapping[str, float]) -> str:
    return " x ".join(f"{numbers[axis]:.6g}" for axis in "xyz")
