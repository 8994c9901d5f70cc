"""Folders in which files are made before they get their names, and renaming that a power cut does not undo.

A workplace lies beside its target, ``.lightcube-NAME-…``, and holds a mark that its program has locked: the system
takes the lock away however a program ends, so the next one that writes there knows whose workplaces nobody needs.
"""

import ctypes
import errno
import filecmp
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

if sys.platform != "win32":
    import fcntl

#: What `tempfile` makes of the prefix of a workplace: so many letters more.
_NAME, _RANDOM = re.compile(r"\.lightcube-.*-[a-z0-9_]{8}", re.DOTALL), 8
_MARK = "owner"
#: Of the target's name, so that the workplace's is none that is too long.
_LETTERS = 50
_AT_CWD, _SWAP = -100, 2


@contextmanager
def workplace(target: Path) -> Iterator[Path]:
    """Yield a folder of one's own beside `target`, which goes away at the end; those of killed programs go first."""
    sweep(target.parent)
    made, owner = _made(target)
    try:
        yield made
    finally:
        try:
            _clear(made)
        finally:
            os.close(owner)


def sweep(folder: Path) -> None:
    """Remove the workplaces in a folder whose programs are gone."""
    with suppress(OSError):  # whoever may not look there is told when writing
        for found in folder.iterdir():
            if _NAME.fullmatch(found.name) and found.is_dir() and not found.is_symlink():
                _remove_deserted(found)


def was_begun(target: Path) -> bool:
    """Whether a program that was killed, or is about to begin, has a workplace for `target`."""
    prefix = _prefix(target)
    with suppress(OSError):
        for found in target.parent.iterdir():
            if _NAME.fullmatch(found.name) and found.name[:-_RANDOM] == prefix:
                with _deserted(found) as deserted:
                    if deserted:
                        return True
    return False


@contextmanager
def _deserted(found: Path) -> Iterator[bool]:
    """Tell whether the program of a workplace is gone, or has put no mark there yet."""
    try:
        owner = os.open(found / _MARK, os.O_RDWR)
    except FileNotFoundError:
        yield True
        return
    except OSError:
        yield False
        return
    try:
        yield _locked(owner, wait=False)
    finally:
        os.close(owner)


def _remove_deserted(found: Path) -> None:
    with suppress(OSError), _deserted(found) as deserted:
        if deserted and (found / _MARK).exists():
            _clear(found)
        elif deserted:  # killed before there was a mark; or it is about to be there, and then another is made
            found.rmdir()


def _clear(made: Path) -> None:
    """Remove a workplace, its mark last: without it nobody may finish what was begun here."""
    with suppress(OSError):
        for each in made.iterdir():
            if each.is_dir() and not each.is_symlink():
                shutil.rmtree(each, ignore_errors=True)
            elif each.name != _MARK:
                each.unlink()
        (made / _MARK).unlink()
        made.rmdir()


def _prefix(target: Path) -> str:
    """What the names of workplaces for `target` begin with."""
    return f".lightcube-{target.name[:_LETTERS]}-"


def _made(target: Path) -> tuple[Path, int]:
    """A new workplace and its open mark, locked."""
    while True:
        made = Path(tempfile.mkdtemp(prefix=_prefix(target), dir=target.parent))
        with suppress(FileNotFoundError):  # it was swept before it was marked
            owner = os.open(made / _MARK, os.O_CREAT | os.O_RDWR, 0o600)
            if _locked(owner, wait=True) and (made / _MARK).exists():
                return made, owner
            os.close(owner)


def _locked(owner: int, *, wait: bool) -> bool:
    """Whether a mark is ours now. Where nobody can lock, each is its owner's for ever."""
    if sys.platform == "win32":
        return wait
    try:
        fcntl.flock(owner, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except OSError:
        return wait
    return True


def put(fresh: Path, path: Path, aside: Path) -> None:
    """Rename what is whole to `path`, so that it lasts; an older folder, which no name can replace, goes `aside`.

    On Linux and macOS, where two names can change places, there is the old one or the new one at every moment.
    """
    for each in (fresh, *(fresh.rglob("*") if fresh.is_dir() else ())):
        settle(each)
    if not path.is_dir():
        fresh.replace(path)
    elif not _swapped(fresh, path):
        path.rename(aside)
        try:
            fresh.rename(path)
        except OSError:
            with suppress(OSError):
                aside.rename(path)
            raise
    settle(path.parent)


def is_same(one: Path, other: Path) -> bool:
    """Whether two files hold the same bytes, or two folders the same files."""
    if one.is_dir() and other.is_dir():
        names = [{each.relative_to(folder) for each in folder.rglob("*")} for folder in (one, other)]
        return names[0] == names[1] and all(is_same(one / name, other / name) for name in names[0])
    return one.is_file() and other.is_file() and filecmp.cmp(one, other, shallow=False)


def settle(path: Path) -> None:
    """Have the system write a file, or the names in a folder, to the disk."""
    if sys.platform == "win32" and path.is_dir():
        return
    opened = os.open(path, os.O_RDONLY)
    try:
        os.fsync(opened)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):  # some network disks cannot be asked, and need not be
            raise
    finally:
        os.close(opened)


def _swapped(one: Path, other: Path) -> bool:
    """Let two names change places at once, or return False where the system cannot."""
    if sys.platform == "win32":
        return False
    names, library = (os.fsencode(one), os.fsencode(other)), ctypes.CDLL(None)
    with suppress(AttributeError):
        return not library.renameat2(_AT_CWD, names[0], _AT_CWD, names[1], _SWAP)
    with suppress(AttributeError):
        return not library.renamex_np(*names, _SWAP)
    return False
