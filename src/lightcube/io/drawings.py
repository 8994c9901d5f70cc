"""Writing drawings of a stage."""

from pathlib import Path
from typing import TypeVar

from lightcube.io._files import check_free, suffix_entry, written_whole
from lightcube.io._remote import place

Given = TypeVar("Given", bound=str | Path)

_FORMATS = {".svg": "SVG"}


def check_drawing_target(path: str | Path, *, overwrite: bool = False) -> None:
    """Raise `InputError` unless `write_drawing` could write to `path`."""
    at = place(path)
    suffix_entry(at, _FORMATS, "a drawing")
    check_free(at, overwrite=overwrite, replaceable=lambda _: False)


def write_drawing(path: Given, drawing: str, *, overwrite: bool = False) -> Given:
    """Write the text of an SVG drawing; it appears when it is whole."""
    at = place(path)
    suffix_entry(at, _FORMATS, "a drawing")
    with written_whole(at, overwrite=overwrite, replaceable=lambda _: False) as fresh:
        fresh.write_text(drawing, encoding="utf-8")
    return path
