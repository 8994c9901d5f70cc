"""What takes a while to make, and is kept until something that decides it changes."""

import shutil
from collections.abc import Callable, Iterable
from hashlib import sha256
from pathlib import Path

#: The whole package: whatever is made by it changes with it.
PACKAGE = Path(__file__).parents[2] / "src" / "lightcube"
#: Stands in a folder that is whole, and says of what it was made.
_NOTE = "made-of.txt"


def once(folder: Path, read: Iterable[Path], make: Callable[[Path], None]) -> None:
    """Let a folder be made, unless it is whole and of the very same package and files; folders stand for theirs."""
    note, now = folder / _NOTE, fingerprint([*read, PACKAGE])
    if note.is_file() and note.read_text() == now:
        return
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    make(folder)
    note.write_text(now)


def fingerprint(read: Iterable[Path]) -> str:
    """A digest of files, and of all files in folders."""
    digest = sha256()
    for path in read:
        for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
            if file.is_file() and "__pycache__" not in file.parts:
                digest.update(file.name.encode() + file.read_bytes())
    return digest.hexdigest()
