"""Docstrings and annotations as people read them: results in whole sentences, types by the names they are used by."""

import re
from typing import Any

from sphinx.application import Sphinx

import lightcube

_ARRAY = re.compile(r"~?numpy\.ndarray\[tuple\[~?(?:typing\.)?Any, \.\.\.\], ~?numpy\.dtype\[(.+?)\]\](?!\])")
_OWN = re.compile(r"~?lightcube\.[a-z_.0-9]+\.([A-Z]\w*)")


def told(_app: Sphinx, _what: str, _name: str, _thing: object, _options: object, lines: list[str]) -> None:
    """Let what comes back be told in sentences, where a docstring does so; numpy's style takes each line for a type."""
    for first, line in enumerate(lines):
        if line.strip() == "Returns" and lines[first + 1 : first + 2] and set(lines[first + 1].strip()) == {"-"}:
            after = next((i for i in range(first + 2, len(lines)) if _is_rule(lines, i)), len(lines))
            body = lines[first + 2 : after]
            if not any(each.startswith(" ") for each in body):
                lines[first + 2 : after] = [":", *(f"    {each}" for each in body)]  # neither name nor type
            return


def _is_rule(lines: list[str], number: int) -> bool:
    """Whether the next section begins at a line."""
    following = lines[number + 1].strip() if number + 1 < len(lines) else ""
    return bool(lines[number].strip()) and len(following) > 2 and set(following) == {"-"}


def short(annotation: str) -> str:
    """An annotation without what nobody says: `NDArray` of its numbers, public names as they are imported."""
    while (shorter := _ARRAY.sub(lambda found: f"NDArray[{found[1]}]", annotation)) != annotation:
        annotation = shorter
    return _OWN.sub(lambda found: f"~lightcube.{found[1]}" if found[1] in lightcube.__all__ else found[0], annotation)


def shorten(app: Sphinx, _kind: str, name: str, *_rest: Any) -> None:
    """Shorten what was noted of a thing's annotations."""
    noted = app.env.current_document.autodoc_annotations.get(name, {})
    for parameter, annotation in noted.items():
        noted[parameter] = short(annotation)


def setup(app: Sphinx) -> dict[str, bool]:
    """Look at docstrings before napoleon does, at annotations after autodoc noted them."""
    app.connect("autodoc-process-docstring", told, priority=100)
    app.connect("autodoc-process-signature", shorten, priority=900)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
