"""What commands remember for each other: small answers in the user's cache folder, which may vanish at any time."""

import json
import os
from collections.abc import Iterator, MutableMapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from lightcube.io._workplaces import workplace

#: So many answers are kept at most, each of at most so many bytes of JSON: 100 MB together. The oldest go first.
MOST, LARGEST = 2_500, 40_000


class Remembered(MutableMapping[str, Any]):
    """JSON values by name, a file each in ``$XDG_CACHE_HOME/lightcube`` or ``~/.cache/lightcube``.

    Nothing is said of what cannot be read or written: it is not there then, and is found anew. Names are file names;
    several programs may read and write at once.
    """

    def __getitem__(self, name: str) -> Any:
        try:
            with _file(name).open("rb") as file:
                return json.loads(file.read(LARGEST + 1))
        except (OSError, ValueError, RecursionError) as error:
            raise KeyError(name) from error

    def __setitem__(self, name: str, value: Any) -> None:
        text = json.dumps(value)
        if len(text) > LARGEST:
            return
        with suppress(OSError):
            folder = _folder()
            folder.mkdir(parents=True, exist_ok=True)
            _make_room(folder)
            with workplace(_file(name)) as made:
                fresh = made / "answer"
                fresh.write_text(text)
                fresh.replace(_file(name))

    def __delitem__(self, name: str) -> None:
        try:
            _file(name).unlink()
        except OSError as error:
            raise KeyError(name) from error

    def __iter__(self) -> Iterator[str]:
        with suppress(OSError):
            yield from (path.stem for path in _folder().glob("*.json"))

    def __len__(self) -> int:
        return sum(1 for _ in self)


def _folder() -> Path:
    """Where answers lie; `OSError` where nobody is at home."""
    said = Path(os.environ.get("XDG_CACHE_HOME", ""))
    try:
        return (said if said.is_absolute() else Path.home() / ".cache") / "lightcube"
    except RuntimeError as error:
        raise OSError("there is no home") from error


def _file(name: str) -> Path:
    return _folder() / f"{name}.json"


def _make_room(folder: Path) -> None:
    """Let the older half go where there is no room for one more."""
    kept = sorted(folder.glob("*.json"), key=lambda path: path.stat().st_mtime)
    if len(kept) >= MOST:
        for path in kept[: MOST // 2]:
            path.unlink(missing_ok=True)
