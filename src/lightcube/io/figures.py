"""Writing plots."""

from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from lightcube.io._files import check_free, suffix_entry, written_whole
from lightcube.io._remote import place

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Given = TypeVar("Given", bound=str | Path)

_FORMATS = {".png": "png", ".svg": "svg"}


def check_figure_target(path: str | Path, *, overwrite: bool = False) -> None:
    """Raise `InputError` unless `write_figure` could write to `path`: ask before long work."""
    at = place(path)
    suffix_entry(at, _FORMATS, "a plot")
    check_free(at, overwrite=overwrite, replaceable=lambda _: False)


def write_figure(path: Given, figure: "Figure", *, overwrite: bool = False) -> Given:
    """Write a matplotlib figure by the suffix of `path`; it appears when it is whole.

    The same figure gives the same file: nothing in it tells when it was made.
    """
    import matplotlib as mpl

    at = place(path)
    kind = suffix_entry(at, _FORMATS, "a plot")
    with (
        written_whole(at, overwrite=overwrite, replaceable=lambda _: False) as fresh,
        mpl.rc_context({"svg.hashsalt": "lightcube"}),
    ):
        figure.savefig(fresh, format=kind, dpi=100, metadata={"Date": None} if kind == "svg" else None)
    return path
