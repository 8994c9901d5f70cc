"""The pages of the public names: a page for each room that has some, with what the architecture says of the room."""

import ast
import re
from collections import defaultdict
from pathlib import Path
from types import ModuleType

from marked import hidden, table

import lightcube

#: Where a room says what it is for.
ARCHITECTURE = Path(__file__).parents[1] / "architecture.md"
#: What of a class's own is shown with it: what it inherits, and what has no words, is not.
_CLASS = """.. autoclass:: {name}
   :members:
   :member-order: bysource
"""
_FUNCTION = ".. autofunction:: {name}\n"
_DATA = ".. autodata:: {name}\n   :no-value:\n"


def rooms(package: ModuleType = lightcube) -> dict[str, list[str]]:
    """The public names of each room, in the order of the alphabet; the stub says where each one stands."""
    stub = ast.parse(Path(str(package.__file__)).with_suffix(".pyi").read_text())
    found: dict[str, list[str]] = defaultdict(list)
    for node in stub.body:
        if isinstance(node, ast.ImportFrom):
            found[str(node.module).split(".")[1]] += [name.name for name in node.names]
    return {room: sorted(found[room]) for room in sorted(found)}


def purposes() -> dict[str, str]:
    """What the architecture says of each room, in Markdown."""
    told = ARCHITECTURE.read_text().split("## The rooms")[1].split("\n## ")[0]
    return dict(re.findall(r"^\* `(\w+)`: (.*?)(?=^\* `|\Z)", told, re.MULTILINE | re.DOTALL))


def pages() -> dict[str, str]:
    """The pages, and what the page of all includes, by the names of their files."""
    by_room, of_room = rooms(), purposes()
    return {
        **{f"python/{room}.md": _page(room, of_room[room], names) for room, names in by_room.items()},
        "python.txt": _index(by_room),
    }


def _page(room: str, purpose: str, names: list[str]) -> str:
    entries = "\n".join(_entry(name) for name in names)
    return f"# {room}\n\n{_first_up(purpose)}\n```{{eval-rst}}\n.. currentmodule:: lightcube\n\n{entries}```\n"


def _entry(name: str) -> str:
    thing = getattr(lightcube, name)
    kind = _CLASS if isinstance(thing, type) else _FUNCTION if callable(thing) else _DATA
    return kind.format(name=name)


def _index(by_room: dict[str, list[str]]) -> str:
    """What the page of all names includes."""
    rows = [
        (f"[{room}](made/python/{room}.md)", ", ".join(f"{{py:obj}}`~lightcube.{name}`" for name in names))
        for room, names in by_room.items()
    ]
    listed = hidden([f"made/python/{room}" for room in by_room])
    return f"{table(('room', 'names'), rows)}\n\n{listed}\n"


def _first_up(text: str) -> str:
    return text[0].upper() + text[1:]
