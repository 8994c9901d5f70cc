"""Small pieces of a page: everything that comes from outside is escaped here, and nowhere else.

No URL is shown with its login or its query.
"""

import base64
import math
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from lightcube.errors import without_secrets

#: Rows of a table that fit a printed page.
_SHORT = 32


def element(tag: str, inside: str, **attributes: str) -> str:
    """``<tag attributes>inside</tag>``; `inside` is HTML, attributes are plain text (``class_`` is class)."""
    return f"<{tag}{_attributes(attributes)}>{inside}</{tag}>"


def text(tag: str, words: object, **attributes: str) -> str:
    """An element with plain text inside."""
    return element(tag, escape(without_secrets(str(words))), **attributes)


def image(levels: NDArray[np.uint8], alt: str, *, exact: bool = True) -> str:
    """A picture ``(row, column, 3)`` inside of the page, as PNG, or with a little loss as WebP."""
    stream = BytesIO()
    kind, options = ("png", {"optimize": True}) if exact else ("webp", {"quality": 80, "method": 4})
    Image.fromarray(np.ascontiguousarray(levels)).save(stream, kind, **options)
    data = base64.b64encode(stream.getvalue()).decode("ascii")
    rows, columns = levels.shape[:2]
    size = {"width": str(columns), "height": str(rows)}
    return f"<img{_attributes({'src': f'data:image/{kind};base64,{data}', 'alt': alt} | size)}>"


def figure(inside: str, caption: str, **attributes: str) -> str:
    """A figure of HTML with a caption of HTML."""
    return element("figure", inside + element("figcaption", caption), **attributes)


def sideways(inside: str, label: str) -> str:
    """Something that is scrolled sideways where it is too wide, with the keyboard too."""
    return element("div", inside, class_="sideways", tabindex="0", role="region", aria_label=label)


def table(caption: str, heads: Sequence[str], rows: Iterable[Sequence[object]], kind: str = "") -> str:
    """A table of plain text; the first cell of a row is its head, or the second one where the first is a number.

    One that fits a page is printed on one.
    """
    rows = list(rows)
    kind = f"{kind} short" if len(rows) <= _SHORT else kind
    head = "".join(text("th", name, scope="col") for name in heads)
    body = "\n".join(element("tr", "".join(_cells(row))) for row in rows)
    inside = text("caption", caption) + element("thead", element("tr", head)) + element("tbody", "\n" + body + "\n")
    return element("table", inside, class_=kind.strip())


def _cells(row: Sequence[object]) -> Iterable[str]:
    head = 1 if isinstance(row[0], int) and len(row) > 1 else 0
    for place, value in enumerate(row):
        if place == head:
            yield text("th", value, scope="row")
        else:
            yield text("td", value)


def pairs(facts: Mapping[str, object]) -> str:
    """Names and what they are, as a list."""
    return element("dl", "\n".join(element("div", text("dt", k) + text("dd", v)) for k, v in facts.items()))


def figure_tiles(tiles: Mapping[str, tuple[str, str]]) -> str:
    """Large figures with their names, and a word on each."""
    shown = "".join(
        element("div", text("dt", name) + text("dd", value, class_="figure") + text("dd", more, class_="more"))
        for name, (value, more) in tiles.items()
    )
    return element("dl", shown, class_="tiles")


def sentences(said: Iterable[str]) -> str:
    """A list of plain sentences."""
    return element("ul", "".join(text("li", sentence) for sentence in said))


def number(value: object, digits: int = 2) -> str:
    """A number with so many digits behind the point, and a dash where there is none."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "–"
    return f"{value:.{digits}f}"


def plain(value: Any) -> str:
    """A value of any kind as people read it."""
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {plain(each)}" for name, each in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(map(plain, value)) or "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return "–" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)


def _attributes(given: Mapping[str, str]) -> str:
    """Attributes of an element, escaped."""
    named = {name.rstrip("_").replace("_", "-"): escape(without_secrets(value)) for name, value in given.items()}
    return "".join(f' {name}="{value}"' for name, value in named.items())
