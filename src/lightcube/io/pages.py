"""Writing pages."""

from pathlib import Path
from typing import TypeVar

from lightcube.io._files import check_free, suffix_entry, written_whole
from lightcube.io._remote import place

Given = TypeVar("Given", bound=str | Path)

_FORMATS = {".html": "HTML"}


def check_page_target(path: str | Path, *, overwrite: bool = False) -> None:
    """Raise `InputError` unless `write_page` could write to `path`."""
    at = place(path)
    suffix_entry(at, _FORMATS, "a page")
    check_free(at, overwrite=overwrite, replaceable=lambda _: False)


def write_page(path: Given, text: str, *, overwrite: bool = False) -> Given:
    """Write the text of an HTML page; it appears when it is whole."""
    at = place(path)
    suffix_entry(at, _FORMATS, "a page")
    with written_whole(at, overwrite=overwrite, replaceable=lambda _: False) as fresh:
        fresh.write_text(text, encoding="utf-8")
    return path
