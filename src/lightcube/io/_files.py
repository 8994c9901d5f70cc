"""Writing whole files or none, and what the operating system says in one sentence."""

import errno
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path, PurePath
from typing import TypeVar

from lightcube.errors import InputError
from lightcube.io._places import Place, exists, is_folder, name_of, send
from lightcube.io._workplaces import put, workplace

Entry = TypeVar("Entry")

#: Called with a path where nothing is yet, a thing, and what may be said of it; returns what to warn of, if anything.
Writer = Callable[..., Warning | None]

#: What the name of a cube that is still being made ends with.
PARTIAL_SUFFIX = ".partial"


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


def check_free(path: Place, *, overwrite: bool, replaceable: Callable[[Place], bool]) -> None:
    """Raise `InputError` unless `path` can be written. At a URL, folders on the way are made where there are any.

    Parameters
    ----------
    overwrite
        Whether something that stands there may be replaced.
    replaceable
        Tells of an existing folder whether it is of the kind that is about to be written: no other folder is
        ever replaced.
    """
    with system_errors(path, "writing"):
        taken = exists(path)
        other_folder = taken and is_folder(path) and not replaceable(path)
    if isinstance(path, Path) and not path.parent.is_dir():
        raise InputError(f"there is no folder {path.parent} to write {path.name} into: make it first")
    if other_folder:
        raise InputError(f"{path} is a folder of something else and is not overwritten: give another name")
    if taken and not overwrite:
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
def written_whole(path: Place, *, overwrite: bool, replaceable: Callable[[Place], bool]) -> Iterator[Path]:
    """Yield a path beside `path`, in a folder of its own; what was written there takes its place at the end.

    Nothing is left behind when the body raises, and what a killed program leaves is removed by the next one that writes
    into the same folder. An older target stays until the new one is whole and on the disk. For a URL the folder is a
    temporary one.
    """
    check_free(path, overwrite=overwrite, replaceable=replaceable)
    if not isinstance(path, Path):
        with tempfile.TemporaryDirectory(prefix="lightcube-", ignore_cleanup_errors=True) as folder:
            fresh = Path(folder) / name_of(path)
            with system_errors(fresh, "writing"):
                yield fresh
            check_free(path, overwrite=overwrite, replaceable=replaceable)
            send(fresh, path)
        return
    path = path.resolve() if path.is_symlink() else path  # what a link leads to is written, and the link stays
    with system_errors(path, "writing"), workplace(path) as made:
        fresh = made / path.name
        yield fresh
        check_free(path, overwrite=overwrite, replaceable=replaceable)
        put(fresh, path, made / "old")
