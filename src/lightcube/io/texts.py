"""Writing texts: drawings as SVG, pages as HTML."""

from pathlib import Path
from typing import TypeVar

from lightcube.io._files import check_free, suffix_entry, written_whole
from lightcube.io._remote import place

Given = TypeVar("Given", bound=str | Path)

_DRAWINGS, _PAGES = {".svg": "a drawing"}, {".html": "a page"}


def check_drawing_target(path: str | Path, *, overwrite: bool = False) -> None:
    """Raise `InputError` unless `write_drawing` could write to `path`."""
    _check(path, _DRAWINGS, overwrite)


def write_drawing(path: Given, drawing: str, *, overwrite: bool = False) -> Given:
    """Write the text of an SVG drawing; it appears when it is whole."""
    return _write(path, drawing, _DRAWINGS, overwrite)


def check_page_target(path: str | Path, *, overwrite: bool = False) -> None:
    """Raise `InputError` unless `write_page` could write to `path`."""
    _check(path, _PAGES, overwrite)


def write_page(path: Given, text: str, *, overwrite: bool = False) -> Given:
    """Write the text of an HTML page; it appears when it is whole.

    Parameters
    ----------
    path
        Ends with ``.html``.
    overwrite
        Whether a file that stands there may be replaced.

    Raises
    ------
    InputError
        Where the name has another suffix, something stands there already, or the system does not let it be written.
    """
    return _write(path, text, _PAGES, overwrite)


def _check(path: str | Path, kinds: dict[str, str], overwrite: bool) -> None:
    at = place(path)
    suffix_entry(at, kinds, *kinds.values())
    check_free(at, overwrite=overwrite, replaceable=lambda _: False)


def _write(path: Given, text: str, kinds: dict[str, str], overwrite: bool) -> Given:
    at = place(path)
    suffix_entry(at, kinds, *kinds.values())
    with written_whole(at, overwrite=overwrite, replaceable=lambda _: False) as fresh:
        fresh.write_text(text, encoding="utf-8")
    return path
