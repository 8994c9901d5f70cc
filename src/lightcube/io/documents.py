"""Writers of documents: pages and drawings, single pictures and JSON, plots."""

import io
import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from lightcube.errors import encodable
from lightcube.io._encoders import png
from lightcube.io._files import Writer

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def write_text(path: Path, text: str) -> None:
    """Write the text of a page or of a drawing."""
    path.write_text(encodable(text), encoding="utf-8")


def write_json(path: Path, document: Mapping[str, Any]) -> None:
    """Write a document as JSON, indented."""
    write_text(path, json.dumps(document, indent=2, ensure_ascii=False) + "\n")


def _plot(kind: str) -> Writer:
    """Writer of matplotlib figures; the same figure gives the same file: nothing in it tells when it was made."""

    def write(path: Path, figure: "Figure") -> None:
        import matplotlib as mpl

        with mpl.rc_context({"svg.hashsalt": "lightcube"}):
            figure.savefig(path, format=kind, dpi=100, metadata={"Date": None} if kind == "svg" else None)

    return write


def _write_png(path: Path, picture: NDArray[np.uint8]) -> None:
    """Write one picture ``(row, column, 3)`` of 8-bit sRGB, and say so."""
    path.write_bytes(png(picture))


def _picture(kind: str) -> Writer:
    """Writer of one picture ``(row, column, 3)`` of 8-bit sRGB."""

    def write(path: Path, picture: NDArray[np.uint8]) -> None:
        encoded = io.BytesIO()  # Pillow's own way into a file of JPEG takes no notice of a disk that is full
        Image.fromarray(picture).save(encoded, format=kind)
        path.write_bytes(encoded.getbuffer())

    return write


PLOTS = {".png": _plot("png"), ".svg": _plot("svg")}
PICTURES: dict[str, Writer] = {
    ".png": _write_png,
    ".webp": _picture("WEBP"),
    ".jpg": _picture("JPEG"),
    ".jpeg": _picture("JPEG"),
}
