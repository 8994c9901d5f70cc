"""What a browser prints: which of a page's parts stand on which sheets of paper, read from the PDF itself."""

import re
import zlib
from typing import Any

#: Gives each part a colour of its own behind it, counted from 1, and says what it is.
_COLOURED = """(parts) => Array.from(document.querySelectorAll(parts), (each, number) => {
  each.style.setProperty("background", `rgb(${(number + 1) & 255}, ${(number + 1) >> 8}, 77)`, "important");
  return `${each.tagName} ${each.textContent.trim().slice(0, 40)}`;
})"""
_OBJECT = re.compile(rb"(?:^|\n)(\d+) 0 obj\n(.*?)\nendobj", re.DOTALL)
_FILL = re.compile(rb"([\d.]+) ([\d.]+) ([\d.]+) rg\b")


def sheets_of(tab: Any, parts: str) -> dict[str, set[int]]:
    """For each element that a CSS selector names: the sheets (from 0) of the printed page that it stands on."""
    names = tab.evaluate(_COLOURED, parts)
    objects = {int(number): body for number, body in _OBJECT.findall(tab.pdf(prefer_css_page_size=True))}
    pages = [body for _, body in sorted(objects.items()) if re.search(rb"/Type\s*/Page\b", body)]
    found: dict[int, set[int]] = {number: set() for number in range(1, len(names) + 1)}
    for sheet, page in enumerate(pages):
        contents = re.search(rb"/Contents (\d+) 0 R", page)
        assert contents is not None
        stream = objects[int(contents[1])].split(b"stream\n", 1)[1]
        for fill in _FILL.findall(zlib.decompressobj().decompress(stream)):
            red, green, blue = (round(255 * float(part)) for part in fill)
            if blue == 77 and (number := red + 256 * green) in found:
                found[number].add(sheet)
    return {f"{number} {names[number - 1]}": on for number, on in found.items()}
