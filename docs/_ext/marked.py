"""Plain words as Markdown."""

import re
from collections.abc import Sequence

#: What Markdown would take for more than a letter.
_SPECIAL = re.compile(r"([\\`*_\[\]<>|$~#])")
#: Options, which are typed as they are.
_OPTION = re.compile(r"(?<![\w`-])(--[a-z][\w-]*)")


def plain(text: str) -> str:
    """A text in which every letter stands for itself, and options are set as what is typed."""
    parts = _OPTION.split(text)
    return "".join(f"`{part}`" if _OPTION.fullmatch(part) else _SPECIAL.sub(r"\\\1", part) for part in parts)


def hidden(pages: Sequence[str]) -> str:
    """What puts pages below the one that includes this."""
    listed = "\n".join(pages)
    return f"```{{toctree}}\n:hidden:\n{listed}\n```"


def table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    """A table of cells in Markdown, of one line each."""
    lines = [head, tuple("---" for _ in head), *rows]
    return "\n".join("| " + " | ".join(" ".join(cell.split()) for cell in line) + " |" for line in lines)
