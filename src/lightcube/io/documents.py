"""Writing documents: drawings and pages, single pictures and JSON, plots."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from lightcube.io._files import check_free, suffix_entry, written_whole
from lightcube.io._places import place

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Given = TypeVar("Given", bound=str | Path)

_DRAWINGS, _PAGES = {".svg": "a drawing"}, {".html": "a page"}
_PLOTS = {".png": "png", ".svg": "svg"}
_SHEETS = {".png": "PNG", ".webp": "WEBP", ".jpg": "JPEG", ".jpeg": "JPEG"}


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


def check_figure_target(path: str | Path, *, overwrite: bool = False) -> None:
    """Raise `InputError` unless `write_figure` could write to `path`: ask before long work."""
    at = place(path)
    suffix_entry(at, _PLOTS, "a plot")
    check_free(at, overwrite=overwrite, replaceable=lambda _: False)


def write_figure(path: Given, figure: "Figure", *, overwrite: bool = False) -> Given:
    """Write a matplotlib figure by the suffix of `path`; it appears when it is whole.

    The same figure gives the same file: nothing in it tells when it was made.
    """
    import matplotlib as mpl

    at = place(path)
    kind = suffix_entry(at, _PLOTS, "a plot")
    with (
        written_whole(at, overwrite=overwrite, replaceable=lambda _: False) as fresh,
        mpl.rc_context({"svg.hashsalt": "lightcube"}),
    ):
        figure.savefig(fresh, format=kind, dpi=100, metadata={"Date": None} if kind == "svg" else None)
    return path


def check_sheet_target(path: str | Path, *, overwrite: bool = False) -> None:
    """Raise `InputError` unless `write_sheet` could write to `path`: ask before long work."""
    at = place(path)
    suffix_entry(at, _SHEETS, "a contact sheet")
    check_free(at, overwrite=overwrite, replaceable=lambda _: False)


def write_sheet(path: Given, picture: NDArray[np.uint8], *, overwrite: bool = False) -> Given:
    """Write one picture ``(row, column, 3)`` of 8-bit sRGB by the suffix of `path`; it appears when it is whole."""
    at = place(path)
    kind = suffix_entry(at, _SHEETS, "a contact sheet")
    with written_whole(at, overwrite=overwrite, replaceable=lambda _: False) as fresh:
        Image.fromarray(picture).save(fresh, format=kind)
    return path


def write_json(path: Given, document: dict[str, Any], *, overwrite: bool = False) -> Given:
    """Write a document as JSON, indented; it appears when it is whole."""
    with written_whole(place(path), overwrite=overwrite, replaceable=lambda _: False) as fresh:
        fresh.write_text(json.dumps(document, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    return path
