"""The page of what lightcube says where something is wrong: every sentence of its source, by rooms."""

import ast
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

from marked import plain, table

import lightcube

PACKAGE = Path(lightcube.__file__).parent
#: Who says a sentence, and which of what it is given is the sentence.
_SAYS = {"InputError": 0, "PydanticCustomError": 1}


def pages() -> dict[str, str]:
    """What the page of sentences includes, by the name of its file."""
    parts = []
    for room, said in by_room().items():
        rows = [tuple(plain(part) for part in _parted(sentence)) for sentence in said]
        parts += [f"## {room}", table(("what is wrong", "what to do"), rows)]
    return {"sentences.txt": "\n\n".join(parts) + "\n"}


def by_room() -> dict[str, list[str]]:
    """The sentences of each room, in the order of the alphabet; what differs from case to case is in ‹›."""
    found: dict[str, set[str]] = defaultdict(set)
    for file in sorted(PACKAGE.rglob("*.py")):
        room = file.relative_to(PACKAGE).with_suffix("").parts[0].strip("_")
        found[room] |= set(of_source(file.read_text()))
    return {room: sorted(said, key=lambda each: each.strip("‹").lower()) for room, said in found.items() if said}


def of_source(text: str) -> Iterator[str]:
    """The sentences in the text of a module; not those that are put together elsewhere and only passed on."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in _SAYS:
            place = _SAYS[node.func.id]
            said = _words(node.args[place]) if len(node.args) > place else ""
            if any(letter.isalpha() for letter in _outside(said)):
                yield said


def _words(node: ast.expr) -> str:
    """A text as it is written, with ‹what› for what is put into it."""
    match node:
        case ast.Constant(value=str(text)):
            return text
        case ast.JoinedStr(values=values):
            return "".join(_words(each) for each in values)
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            return _words(left) + _words(right)
        case ast.FormattedValue(value=value):
            return _words(value)
        case ast.Name(id=name) | ast.Attribute(attr=name):
            return f"‹{name.strip('_').replace('_', ' ')}›"
        case _:
            return "‹…›"


def _outside(said: str) -> str:
    """What of a sentence is the same in all cases."""
    return "".join(part.split("›")[-1] for part in said.split("‹"))


def _parted(said: str) -> tuple[str, str]:
    """What is wrong, and what to do, which stands behind the last colon."""
    wrong, _, mend = said.rpartition(": ")
    return (wrong, mend) if wrong and _outside(wrong).strip() else (said, "")
