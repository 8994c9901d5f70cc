"""Writing single 8-bit pictures and JSON documents."""

import json
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from lightcube.io._files import check_free, suffix_entry, written_whole
from lightcube.io._remote import place

Given = TypeVar("Given", bound=str | Path)

_FORMATS = {".png": "PNG", ".webp": "WEBP", ".jpg": "JPEG", ".jpeg": "JPEG"}


def check_sheet_target(path: str | Path, *, overwrite: bool = False) -> None:
    """Raise `InputError` unless `write_sheet` could write to `path`: ask before long work."""
    at = place(path)
    suffix_entry(at, _FORMATS, "a contact sheet")
    check_free(at, overwrite=overwrite, replaceable=lambda _: False)


def write_sheet(path: Given, picture: NDArray[np.uint8], *, overwrite: bool = False) -> Given:
    """Write one picture ``(row, column, 3)`` of 8-bit sRGB by the suffix of `path`; it appears when it is whole."""
    at = place(path)
    kind = suffix_entry(at, _FORMATS, "a contact sheet")
    with written_whole(at, overwrite=overwrite, replaceable=lambda _: False) as fresh:
        Image.fromarray(picture).save(fresh, format=kind)
    return path


def write_json(path: Given, document: dict[str, Any], *, overwrite: bool = False) -> Given:
    """Write a document as JSON, indented; it appears when it is whole."""
    with written_whole(place(path), overwrite=overwrite, replaceable=lambda _: False) as fresh:
        fresh.write_text(json.dumps(document, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    return path
