"""Writing whole files or none, and what the operating system says in one sentence."""

import errno
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path, PurePath
from typing import TypeVar

from lightcube.errors import InputError
from lightcube.io._places import Place, exists, is_folder, name_of, send
from lightcube.io._workplaces import is_same, put, settle, was_begun, workplace

Entry = TypeVar("Entry")

#: Called with a path where nothing is yet, a thing, and what may be said of it; returns what to warn of, if anything.
Writer = Callable[..., Warning | None]

#: Tells of an existing folder whether one that is written may take its place; None where a file is written.
Replaceable = Callable[[Place], bool] | None

#: What the name of a cube that is still being made ends with.
PARTIAL_SUFFIX = ".partial"
#: What the names of shapes and of reliefs end with.
SHAPE_SUFFIX, RELIEF_SUFFIX = ".shape.zarr", ".relief.zarr"
#: And what follows where they are in one file.
ZIP_SUFFIX = ".zip"


def suffix_entry(path: Place, table: Mapping[str, Entry], what: str) -> Entry:
    """Entry of `table` for the longest suffix that the name of `path` ends with, in any case, or `InputError`.

    An entry for ``""`` is that of names without a suffix.
    """
    name = name_of(path).lower()
    for suffix in sorted(table, key=len, reverse=True):
        if name.endswith(suffix) and len(name) > len(suffix) and (suffix or not PurePath(name).suffix):
            return table[suffix]
    known = [suffix for suffix in table if suffix]
    which = f"one of {', '.join(known)}" if len(known) > 1 else known[0]
    raise InputError(f"{path} has no suffix that {what} can have: use {which}")


def check_free(path: Place, *, overwrite: bool, replaceable: Replaceable, at_last: bool = False) -> None:
    """Raise `InputError` unless `path` can be written. At a URL, folders on the way are made where there are any.

    Parameters
    ----------
    overwrite
        Whether something that stands there may be replaced.
    replaceable
        Tells of an existing folder whether it is of the kind that is about to be written: no other folder is
        ever replaced. None where a file is written: no folder takes the place of a file, and no file that of a folder.
    at_last
        Whether it is about to get its name. Before that, what stands there may be what a killed program of the same
        command has finished: `written_whole` sees whether it is.
    """
    with system_errors(path, "writing"):
        taken = exists(path)
        folder = taken and is_folder(path)
        other_folder = replaceable is not None and folder and not replaceable(path)
    if isinstance(path, Path) and not path.parent.is_dir():
        raise InputError(f"there is no folder {path.parent} to write {path.name} into: make it first")
    if folder and replaceable is None:
        raise InputError(f"{path} is a folder, and what is written is a file: give another name")
    if taken and not folder and replaceable is not None:
        raise InputError(f"{path} is a file, and what is written is a folder: give another name")
    if other_folder:
        raise InputError(f"{path} is a folder of something else and is not overwritten: give another name")
    if taken and not overwrite and (at_last or not (isinstance(path, Path) and was_begun(_led_to(path)))):
        raise InputError(f"{path} exists already: give another name, or overwrite it (--overwrite)")


@contextmanager
def system_errors(path: Place, doing: str) -> Iterator[None]:
    """Raise `InputError` with one sentence where the operating system refuses to write or read `path`."""
    try:
        yield
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            raise InputError(
                f"no space is left on the disk of {Path(path).parent} for {doing} {name_of(path)}: "
                "make room and start again"
            ) from error
        refuse_gone_folder(error)
        raise InputError(f"{doing} {path} failed: {error.strerror or error}") from error


def refuse_gone_folder(error: OSError) -> None:
    """Raise `InputError` where what the system did not find is the current folder."""
    try:
        Path.cwd()
    except FileNotFoundError:
        if error.errno == errno.ENOENT:
            raise InputError("the current folder is gone: change to one that is there, and start again") from error


@contextmanager
def written_whole(
    path: Place, *, overwrite: bool, replaceable: Replaceable
) -> Iterator[tuple[Path, Callable[[], None]]]:
    """Yield a path beside `path`, in a folder of its own, and what gives it its name when it is whole.

    Nothing is left behind when the body raises, and what a killed program leaves is removed by the next one that writes
    into the same folder. An older target stays until the new one is whole and on the disk. For a URL the folder is a
    temporary one. What a killed program has put there already, the very same, stays. `check_free` goes before.
    """

    def check_at_last() -> None:
        check_free(path, overwrite=overwrite, replaceable=replaceable, at_last=True)

    if not isinstance(path, Path):
        with tempfile.TemporaryDirectory(prefix="lightcube-", ignore_cleanup_errors=True) as folder:
            sent, url = Path(folder) / name_of(path), path

            def send_it() -> None:
                check_at_last()
                send(sent, url)

            with system_errors(sent, "writing"):
                yield sent, send_it
        return
    target = _led_to(path)

    def put_it() -> None:
        with system_errors(target, "writing"):
            if not overwrite and is_same(fresh, target):
                settle(target.parent)
                return
            check_at_last()
            put(fresh, target, made / "old")

    with system_errors(target, "writing"), workplace(target) as made:
        fresh = made / target.name
        yield fresh, put_it


def _led_to(path: Path) -> Path:
    """What is written: what a link leads to, and the link stays."""
    return path.resolve() if path.is_symlink() else path
