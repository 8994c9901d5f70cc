"""Making files of a cube that others read: what is written is read back, and scored as it stands in the file.

`save` keeps a cube bit for bit in one file that `load` reads. What is exported here is several files of a kind with a
sidecar, may hold less than the cube, and is asked for by what it is for: ``.ply`` may be shells or points. So it is
another word, and the readers of pictures and cubes know nothing of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import fields
from pathlib import Path
from typing import Any

from lightcube.errors import InputError
from lightcube.events import Tell, counting
from lightcube.fabrication import lamps, sidecar
from lightcube.fabrication.films import FilmPages
from lightcube.fabrication.planned import Advance, File, How, Planned
from lightcube.fabrication.points import PointCloud
from lightcube.fabrication.polyjet import PolyJet
from lightcube.fabrication.schedule import Schedule
from lightcube.fabrication.shells import Shells
from lightcube.fabrication.sidecar import Kind
from lightcube.fabrication.volumes import VolumeFile
from lightcube.forward.casting import cast
from lightcube.io._files import check_free, suffix_entry, written_whole
from lightcube.io._places import Place, place
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.pictures.fitting import targets_of
from lightcube.pictures.targets import Targets
from lightcube.scoring.metrics import score_pictures

#: What can be made of a cube, and how: the table.
KINDS: Mapping[Kind, type[How]] = {
    "volume": VolumeFile,
    "shell": Shells,
    "points": PointCloud,
    "polyjet": PolyJet,
    "schedule": Schedule,
    "film": FilmPages,
}


@checked
def export(
    cube: Cube,
    path: str | Path,
    kind: Kind,
    *,
    overwrite: bool = False,
    score: bool = True,
    made_from: str | None = None,
    tell: Tell | None = None,
    **options: Any,
) -> dict[str, Any]:
    """Write a cube as something that is made or shown by others, and ``FILE.json`` beside it, whole or not at all.

    Parameters
    ----------
    path
        Where; the suffix says what.
    kind
        * ``"volume"``: extinction as ``.vdb`` (OpenVDB: Blender), ``.nrrd``, ``.vti`` (ParaView) or ``.npy``.
        * ``"shell"``: surfaces around what is darkest, as ``.3mf`` (parts of one object, and an STL each) or ``.ply``.
        * ``"points"``: for a laser that marks glass inside, ``.ply``; an ornament.
        * ``"polyjet"``: a folder of PNG slices for a printer of coloured droplets.
        * ``"film"``: a ``.pdf`` with a page for each film of a stack.
        * ``"schedule"``: when the table turns and how bright lamps are, ``.csv`` or ``.json``.
    overwrite
        Whether what stands there may be replaced.
    score
        Whether what the file would cast is scored, where it casts anything and the cube has targets.
    made_from
        The cube's name, for the sidecar.
    tell
        Is told how much is written.
    **options
        Of a volume `unit`, of shells `levels`, of points `spacing_um` and `seed`, of polyjet `resins`, `mode`, `seed`,
        `flips` and `prefix`, of films `paper`, `dpi`, `inks`, `mirror`, `scale_x`, `scale_y` and `halftone`; as
        the class that `lightcube.fabrication.exporting.KINDS` has for the kind.

    Returns
    -------
    What the sidecar says.

    Raises
    ------
    InputError
        Where it cannot be right, before anything is written, or nothing can be written. Nothing is left behind.

    Examples
    --------
    >>> import lightcube as lc, numpy as np, tempfile, os
    >>> grid = lc.Grid((4, 6, 6))
    >>> cube = lc.Cube(np.ones((3, 4, 6, 6), np.float32), grid, lc.turntable(grid, [20, 80], picture_shape=(4, 4)))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     said = lc.export(cube, f"{folder}/a.vdb", "volume")
    ...     sorted(os.listdir(folder)), said["size_mm"]
    (['a.vdb', 'a.vdb.json'], {'x': 6.0, 'y': 6.0, 'z': 4.0})
    """
    at = place(path)
    check(at, kind, overwrite=overwrite)
    return write(cube, at, kind, plan(cube, at, kind, options), overwrite, tell, is_scored=score, made_from=made_from)


def plan(cube: Cube, at: Place, kind: Kind, options: Mapping[str, Any]) -> Planned:
    """What would be written; `InputError` where it cannot be right."""
    known = {each.name for each in fields(KINDS[kind])}  # type: ignore[arg-type] # all are dataclasses
    strange = sorted(set(options) - known)
    if strange:
        takes = f"takes {' and '.join(sorted(known))}" if known else "takes no options"
        raise InputError(f"{kind} {takes}, not {strange[0]}: leave it out")
    return KINDS[kind](**options).plan(cube, at)


def check(at: Place, kind: Kind, *, overwrite: bool) -> None:
    """Raise `InputError` unless something of a kind could be written: ask before long work."""
    how = KINDS[kind]
    suffix_entry(at, dict.fromkeys(how.suffixes), how.called)
    check_free(at, overwrite=overwrite, replaceable=how.replaceable)
    if how.replaceable is None:
        check_free(sidecar.place_of(at, is_folder=False), overwrite=overwrite, replaceable=None)


def write(
    cube: Cube,
    at: Place,
    kind: Kind,
    planned: Planned,
    overwrite: bool,
    tell: Tell | None,
    *,
    is_scored: bool,
    made_from: str | None = None,
) -> dict[str, Any]:
    """Write what was planned, and the sidecar; none gets its name before all are whole. Returns what it says."""
    for file in (*planned.files, *_sidecar(at, planned)):
        check_free(file.at, overwrite=overwrite, replaceable=file.replaceable)
    advance: Advance = counting(tell or _silent)
    with ExitStack() as stack:
        made = []
        for file in planned.files:
            fresh, name_it = stack.enter_context(
                written_whole(file.at, overwrite=overwrite, replaceable=file.replaceable)
            )
            file.write(fresh, advance)
            made.append((fresh, name_it))
        document = _document(cube, kind, planned, [fresh for fresh, _ in made], made_from, is_scored=is_scored)
        if not _sidecar(at, planned):
            (made[0][0] / sidecar.INSIDE).write_bytes(sidecar.text(document))
        for file in _sidecar(at, planned):
            fresh, name_it = stack.enter_context(written_whole(file.at, overwrite=overwrite, replaceable=None))
            fresh.write_bytes(sidecar.text(document))
            made.append((fresh, name_it))
        for _, name_it in made:
            name_it()
    return document


def _silent(_: object) -> None:
    """Say nothing."""


def _sidecar(at: Place, planned: Planned) -> tuple[File, ...]:
    """The sidecar, where it is a file of its own."""
    if planned.files and planned.files[0].replaceable is not None:
        return ()
    return (File(sidecar.place_of(at, is_folder=False), lambda path, advance: None),)


def _document(
    cube: Cube, kind: Kind, planned: Planned, written: list[Path], made_from: str | None, *, is_scored: bool
) -> dict[str, Any]:
    """All that the sidecar says."""
    document = {**sidecar.opening(kind), **planned.facts}
    if planned.notes:
        document["notes"] = list(planned.notes)
    files = [file for path in written for file in (sorted(path.iterdir()) if path.is_dir() else [path])]
    document["files"] = {file.name: sidecar.digest(file) for file in files}
    document["made_from"] = made_from
    document["made_from_sha256"] = sidecar.digest_of(cube)
    if planned.held is None:
        return document
    document["cube"] = sidecar.of_cube(cube)
    if not is_scored or cube.targets is None:
        return document
    document["predicted"], document["cube"] = _predicted(cube, planned, written[0], document["cube"])
    return document


def _predicted(
    cube: Cube, planned: Planned, path: Path, said: dict[str, Any]
) -> tuple[dict[str, float], dict[str, Any]]:
    """How good what a file holds is, and what is said of its cube: under its lamps, or under those that suit it."""
    assert planned.held is not None  # noqa: S101 - else nothing is cast
    volume, grid = planned.held(path)
    targets = targets_of(cube)
    held = sidecar.cube_of(path, said, volume, grid or cube.grid)
    found: dict[str, float] = {}
    if planned.is_relit:
        as_it_was = _scored(held, targets)
        found = {f"{name}_of_old_lamps": as_it_was[name] for name in ("psnr_mean", "psnr_min")}
        held = lamps.relit(held, targets)
    scores = _scored(held, targets)
    own = cube.scores.get("psnr_mean")
    found |= {name: scores[name] for name in ("psnr_mean", "psnr_min")}
    if isinstance(own, float):
        found["psnr_mean_of_cube"] = own
    return found, {**said, "lamp_powers": held.powers.tolist()}


def _scored(cube: Cube, targets: Targets) -> dict[str, Any]:
    """What `score` says of pictures; grain and thin beams, which take most of its time, are left out."""
    return score_pictures(cast(cube), targets)
