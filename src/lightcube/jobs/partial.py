"""The place of a cube that is still being made: ``NAME.partial`` beside the NAME it will have.

A folder with what was asked for (``job.json``, ``targets.npz``), the pieces that are finished (``level-1.npz``,
``unit-0.npz``, …) and the newest state of those that are not (``unit-0.state.npz``). Each file is written under a
hidden name and then renamed: whenever the work is killed, what has a name is whole. At a URL a file appears whole too.
"""

import hashlib
import io
import json
import re
import time
from collections.abc import Mapping
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from typing import IO, Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationError

from lightcube.backward.job import Fingerprint, Job, differences, fingerprint, unit_name
from lightcube.backward.recipe import from_plain
from lightcube.backward.store import Arrays
from lightcube.errors import InputError
from lightcube.io._archives import archive
from lightcube.io._blocks import BlockJson, block_to_json
from lightcube.io._bounds import MOST_TEXT, check_file, check_text
from lightcube.io._files import PARTIAL_SUFFIX, system_errors
from lightcube.io._metadata import plain
from lightcube.io._places import (
    Place,
    beside,
    child,
    exists,
    is_folder,
    name_of,
    names_in,
    place,
    read_bytes,
    remove,
    written,
)
from lightcube.io._rig import RigJson, rig_to_json
from lightcube.io._workplaces import workplace
from lightcube.optics.arrays import locked
from lightcube.optics.transfer import Transfer
from lightcube.pictures.targets import Targets
from lightcube.solvers import check_lasting, find_method

#: Of the folders that this version writes and reads.
FORMAT_VERSION = 5

_JOB, _TARGETS = "job.json", "targets.npz"
_PIECE = re.compile(r"((?:level|unit)-[0-9]+)(\.state)?\.npz")
_HIDDEN = re.compile(r"\..+\.npz-[0-9a-f]{32}|\.job\.json-[0-9a-f]{32}")
#: A hidden file that nobody has written to for so many seconds is of a run that was killed.
_STALE_S = 600.0
#: Which job and piece a file belongs to, and what it holds; no array of a piece is called so.
_OWNER = "job-key"


class _JobJson(BlockJson):
    """Everything of a job but its arrays."""

    format_version: Literal[5]
    written_by: str
    fingerprint: dict[str, str | int | float | None]
    shape: Annotated[list[Annotated[int, Field(ge=1)]], Field(min_length=3, max_length=3)]
    names: list[str]
    transfer: Transfer
    rig: RigJson
    recipe: dict[str, Any]
    units: Annotated[int, Field(ge=1)]
    provenance: dict[str, Any]


class DiskStore:
    """The pieces of the job in a partial folder, a `lightcube.backward.store.Store`.

    Several programs may use the same folder at the same time.

    Parameters
    ----------
    partial
        A folder with a job in it, as `open_partial` leaves it.

    Raises
    ------
    InputError
        Where there is no such folder or no job in it; from its methods, where files are damaged or of another job,
        cannot be written, or the disk is full.
    """

    folder: Place

    def __init__(self, partial: str | Path) -> None:
        self.folder = place(partial)
        self._key = _key(_read_job(self.folder).fingerprint)

    def names(self) -> frozenset[str]:
        """Names of the pieces that are finished."""
        return frozenset(match[1] for match in self._files() if not match[2])

    def is_empty(self) -> bool:
        """Whether there is neither a finished piece nor a state of one."""
        return not self._files()

    def finished(self, name: str) -> Arrays | None:
        """Return the result of a piece, or None where it is not finished."""
        return self._read(f"{name}.npz")

    def finish(self, name: str, arrays: Arrays) -> None:
        """Keep the result of a piece, and remove its state."""
        self._write(f"{name}.npz", arrays)
        with system_errors(self.folder, "writing"):
            remove(child(self.folder, f"{name}.state.npz"))

    def state(self, name: str) -> Arrays | None:
        """Return the newest state of a piece, or None where there is none."""
        return self._read(f"{name}.state.npz")

    def keep(self, name: str, arrays: Arrays) -> None:
        """Keep the state of a piece in place of the one before."""
        self._write(f"{name}.state.npz", arrays)

    def _files(self) -> list[re.Match[str]]:
        with system_errors(self.folder, "reading"):
            return [match for name in names_in(self.folder) if (match := _PIECE.fullmatch(name))]

    def _write(self, name: str, arrays: Arrays) -> None:
        _write_arrays(child(self.folder, name), {_OWNER: np.array(self._owner(name, arrays)), **arrays})

    def _owner(self, name: str, arrays: Arrays) -> str:
        """What a file says of which job and which piece it is of, and of what is in it."""
        said = hashlib.blake2b(f"{self._key} {name}".encode(), digest_size=32)
        for key, array in sorted(arrays.items()):
            said.update(f"{key} {array.dtype.str} {array.shape}".encode())
            # Files keep the order of these two kinds; what is neither is written as the first.
            flat = (array.T if array.flags.f_contiguous else np.ascontiguousarray(array)).reshape(-1)
            said.update(flat.view(np.uint8).data if flat.itemsize else b"")
        return said.hexdigest()

    def _read(self, name: str) -> Arrays | None:
        path = child(self.folder, name)
        arrays = _read_arrays(path)
        if arrays is None:
            return None
        owner = arrays.pop(_OWNER, None)
        if owner is None or str(owner) != self._owner(name, arrays):
            raise InputError(
                f"{path} belongs to another cube, or was changed: remove it, and that piece is computed again"
            )
        return arrays


def partial_path(out: str | Path) -> Place:
    """Return the folder of the unfinished cube `out`: ``NAME.partial``."""
    at = place(out)
    return beside(at, name_of(at) + PARTIAL_SUFFIX)


def published_path(partial: str | Path) -> Place:
    """Return the name that the cube of a partial folder will have, or raise `InputError` where it is none by name."""
    at = place(partial)
    name = name_of(at)
    if not name.lower().endswith(PARTIAL_SUFFIX) or len(name) == len(PARTIAL_SUFFIX):
        raise InputError(f"{partial} is no unfinished cube: give a folder that ends with {PARTIAL_SUFFIX}")
    return beside(at, name[: -len(PARTIAL_SUFFIX)])


def open_partial(out: str | Path, job: Job, *, overwrite: bool = False) -> DiskStore:
    """Return the store of a job in the partial folder of `out`, which is made where there is none yet.

    Parameters
    ----------
    overwrite
        Whether a folder that was begun for another job is emptied and begun anew. One of this job is continued.

    Raises
    ------
    InputError
        Naming what changed, where the folder was begun for another job; or where it is something else, is damaged, or
        cannot be written; or where no name leads to the job's method, so that nobody could go on.
    """
    check_lasting(job.recipe.solver)
    folder, document = check_partial(out), _document(job)
    if isinstance(folder, Path):
        _make(folder)
    if overwrite and not _is_of(folder, job):
        _empty(folder)
    if not exists(child(folder, _JOB)):
        _write_job(folder, job, document)
    changed = differences(_read_job(folder).fingerprint, fingerprint(job))
    if changed:
        raise InputError(
            f"{folder} was begun for another cube ({'; '.join(changed)}): use --overwrite to start anew, publish what "
            "is there, or give another name"
        )
    return DiskStore(folder)


def _make(folder: Path) -> None:
    """Make a partial folder where there is none, and remove what killed programs have left in it."""
    with system_errors(folder, "writing"):
        folder.mkdir(exist_ok=True)
        for item in folder.iterdir():
            with suppress(FileNotFoundError):  # somebody else removed or renamed it
                if _HIDDEN.fullmatch(item.name) and time.time() - item.stat().st_mtime > _STALE_S:
                    item.unlink()


def begun_store(at: Place) -> DiskStore:
    """The store of an unfinished cube; `InputError` where there is nothing in it."""
    store = DiskStore(at)
    if store.is_empty():
        raise InputError(f"{at} has nothing of a cube in it yet: start again without it")
    return store


def begun_units(out: str | Path, job: Job) -> int | None:
    """Return into how many units the job in the partial folder of `out` is split; None where it is another job."""
    try:
        said = _read_job(partial_path(out))
    except InputError:  # what is damaged is nobody's
        return None
    return None if differences({**said.fingerprint, "units": job.units}, fingerprint(job)) else said.units


def check_partial(out: str | Path) -> Place:
    """Return the partial folder of `out`, or raise `InputError` where something else stands there."""
    folder = partial_path(out)
    with system_errors(folder, "reading"):
        other = exists(folder) and not is_partial(folder)
    if other:
        raise InputError(f"{folder} stands where the unfinished cube would, and is none: move it or use another name")
    return folder


def is_partial(partial: Place) -> bool:
    """Tell whether there is a folder that holds nothing but parts of a job, or nothing."""
    return is_folder(partial) and all(
        name in (_JOB, _TARGETS) or _PIECE.fullmatch(name) or _HIDDEN.fullmatch(name) for name in names_in(partial)
    )


def discard_partial(out: str | Path) -> None:
    """Remove the partial folder of `out`; `InputError` where there is none, or where it is something else."""
    folder = partial_path(out)
    if not is_partial(folder):
        raise InputError(f"there is no unfinished cube {folder} to remove: check the name")
    if not isinstance(folder, Path):
        _empty(folder)
        with system_errors(folder, "removing"):
            remove(folder)
        return
    with system_errors(folder, "removing"), workplace(folder) as made:
        folder.rename(made / "old")  # all at once: half of it would be nobody's


def is_finished(out: str | Path) -> bool:
    """Whether the partial folder of `out` is there with all of its job's units finished."""
    try:
        store = DiskStore(partial_path(out))
        units = _read_job(store.folder).units
        return store.names().issuperset(map(unit_name, range(units)))
    except InputError:  # there is none, or it is damaged
        return False


def load_job(partial: str | Path) -> Job:
    """Return the job of a partial folder.

    Raises
    ------
    InputError
        Where there is no such folder, no job in it yet, its method cannot be imported, or it is damaged.
    """
    folder = place(partial)
    said, path = _read_job(folder), child(folder, _TARGETS)
    find_method(str(said.recipe.get("method") or "display"))  # by its own words where it cannot be found
    arrays = _read_arrays(path)
    if arrays is None:
        raise _damaged(path, "it is missing")
    try:
        pictures, weights = locked(arrays["pictures"]), locked(arrays["weights"])
        start = locked(arrays["start"]) if "start" in arrays else None
        job = Job(
            targets=Targets(pictures, said.rig.rig(), weights, tuple(said.names), said.transfer),
            grid=said.block(said.shape),
            recipe=from_plain(said.recipe),
            units=said.units,
            start=start,
            provenance=said.provenance,
        )
    except (ValueError, TypeError, IndexError, KeyError) as error:
        raise _damaged(path, str(error)) from error
    changed = differences({**said.fingerprint, "lightcube": version("lightcube")}, fingerprint(job))
    if changed:
        raise _damaged(path, "; ".join(changed))
    return job


def _document(job: Job) -> bytes:
    """What is written of a job beside its arrays; `InputError` where its cube would say more than can be read."""
    targets, grid = job.targets, job.grid
    document = {
        "format_version": FORMAT_VERSION,
        "written_by": f"lightcube {version('lightcube')}",
        "fingerprint": dict(fingerprint(job)),
        "shape": list(grid.shape),
        **block_to_json(grid),
        "names": list(targets.names),
        "transfer": targets.transfer,
        "rig": rig_to_json(targets.rig),
        "recipe": job.recipe.plain(),
        "units": job.units,
        "provenance": plain(job.provenance),
    }
    text = json.dumps(document, indent=2).encode()
    check_text(len(text) + len(text) // 2)  # powers and scores are yet to come
    return text


def _write_job(folder: Place, job: Job, document: bytes) -> None:
    start = {} if job.start is None else {"start": job.start}
    _write_arrays(child(folder, _TARGETS), {"pictures": job.targets.pictures, "weights": job.targets.weight, **start})
    at = child(folder, _JOB)
    with system_errors(at, "writing"), written(at) as file:
        file.write(document)


def _read_job(folder: Place) -> _JobJson:
    path = child(folder, _JOB)
    if not is_folder(folder):
        raise InputError(f"there is no unfinished cube {folder}: give a folder that ends with {PARTIAL_SUFFIX}")
    try:
        with system_errors(path, "reading"):
            data = read_bytes(path)
        if data is not None and len(data) > MOST_TEXT:
            raise _damaged(path, "it is larger than it can be")
        document = None if data is None else json.loads(data)
        if document is None:
            raise InputError(f"{folder} has nothing of a cube in it yet: start again without it")
        if isinstance(document, Mapping) and document.get("format_version", FORMAT_VERSION) != FORMAT_VERSION:
            raise InputError(f"{folder} was begun by another version of lightcube: finish it with that, or start anew")
        return _JobJson.model_validate(document)
    except (json.JSONDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise _damaged(path, " ".join(str(error).split())[:100]) from error
    except ValidationError as error:
        first = error.errors()[0]
        raise _damaged(path, f"{'.'.join(map(str, first['loc']))}: {first['msg']}") from error


def _is_of(folder: Place, job: Job) -> bool:
    """Whether the folder was begun for this job."""
    try:
        return not differences(_read_job(folder).fingerprint, fingerprint(job))
    except InputError:  # a damaged one is nobody's
        return False


def _empty(folder: Place) -> None:
    """Remove all that stands in a partial folder, the job last: no piece is ever there without it."""
    with system_errors(folder, "removing"):
        for name in sorted(names_in(folder), key=lambda name: name == _JOB):
            remove(child(folder, name))


def _key(said: Fingerprint) -> str:
    return hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()


def _write_arrays(path: Place, arrays: Mapping[str, NDArray[Any]]) -> None:
    named: dict[str, Any] = dict(arrays)
    with system_errors(path, "writing"), written(path) as file:
        np.savez(file, **named)


def _read_arrays(path: Place) -> dict[str, NDArray[Any]] | None:
    """All arrays of a file, or None where there is none."""
    with (
        system_errors(path, "reading"),
        suppress(FileNotFoundError),
        _opened(path) as file,
        archive(file, path, lambda what: _damaged(path, what)) as arrays,
    ):
        return {name: arrays[name] for name in arrays.files}
    return None


def _opened(path: Place) -> IO[bytes]:
    """Open a file; what is at a URL is fetched first."""
    if isinstance(path, Path):
        return check_file(path).open("rb")
    data = read_bytes(path)
    if data is None:
        raise FileNotFoundError
    return io.BytesIO(data)


def _damaged(path: Place, what: str) -> InputError:
    if name_of(path) in (_JOB, _TARGETS):
        return InputError(f"{path} is damaged ({what}): remove the folder and start again")
    return InputError(f"{path} is damaged ({what}): remove it, and that piece is computed again")
