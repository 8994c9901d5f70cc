"""Writing whole files or none, and what the operating system says in one sentence."""

import errno
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TypeVar

from lightcube.errors import InputError

Entry = TypeVar("Entry")


def suffix_entry(path: Path, table: Mapping[str, Entry], what: str) -> Entry:
    """Entry of `table` for the longest suffix that the name of `path` ends with, in any case, or `InputError`."""
    name = path.name.lower()
    for suffix in sorted(table, key=len, reverse=True):
        if name.endswith(suffix) and len(name) > len(suffix):
            return table[suffix]
    known = ", ".join(suffix for suffix in table if suffix)
    raise InputError(f"{path} has no suffix that {what} can have: use one of {known}")


def check_free(path: Path, *, overwrite: bool, replaceable: Callable[[Path], bool]) -> None:
    """Raise `InputError` unless `path` can be written.

    Parameters
    ----------
    overwrite
        Whether something that stands there may be replaced.
    replaceable
        Tells of an existing folder whether it is of the kind that is about to be written: no other folder is
        ever replaced.
    """
    with system_errors(path, "writing"):
        has_place, taken = path.parent.is_dir(), path.exists() or path.is_symlink()
        other_folder = path.is_dir() and not replaceable(path)
    if not has_place:
        raise InputError(f"there is no folder {path.parent} to write {path.name} into: make it first")
    if taken and not overwrite:
        raise InputError(f"{path} exists already: give another name, or overwrite it (--overwrite)")
    if other_folder:
        raise InputError(f"{path} is a folder with other things in it and is not overwritten: give another name")


@contextmanager
def system_errors(path: Path, doing: str) -> Iterator[None]:
    """Raise `InputError` with one sentence where the operating system refuses to write or read `path`."""
    try:
        yield
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            raise InputError(
                f"no space is left on the disk of {path.parent} for {doing} {path.name}: make room and start again"
            ) from error
        raise InputError(f"{doing} {path} failed: {error.strerror or error}") from error


@contextmanager
def written_whole(path: Path, *, overwrite: bool, replaceable: Callable[[Path], bool]) -> Iterator[Path]:
    """Yield a path beside `path`, in a folder of its own; what was written there takes its place at the end.

    Nothing is left behind when the body raises. An older target stays until the new one is whole.
    """
    check_free(path, overwrite=overwrite, replaceable=replaceable)
    with system_errors(path, "writing"):
        workplace = Path(tempfile.mkdtemp(prefix=".lightcube-", dir=path.parent))
        try:
            fresh = workplace / path.name
            yield fresh
            check_free(path, overwrite=overwrite, replaceable=replaceable)
            _put(fresh, path, workplace / "old")
        finally:
            shutil.rmtree(workplace, ignore_errors=True)


def _put(fresh: Path, path: Path, aside: Path) -> None:
    """Rename `fresh` to `path`; a folder cannot be renamed onto another one, so an older folder steps `aside`."""
    if not path.is_dir() or path.is_symlink():
        fresh.replace(path)
        return
    path.rename(aside)
    try:
        fresh.rename(path)
    except OSError:
        with suppress(OSError):
            aside.rename(path)
        raise
