"""Reliefs as files: all that is known of one, its heights as a picture, or the mesh that is printed."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from importlib.metadata import version
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.io import _metadata, printable
from lightcube.io._files import Writer, system_errors
from lightcube.io._places import Place, child, fetched, name_of, place, read_bytes
from lightcube.optics.arrays import locked
from lightcube.optics.checks import checked
from lightcube.solids.relief import Relief, ReliefRecipe
from lightcube.solids.relief_mesh import relief_mesh

#: What the name of a relief's file ends with.
SUFFIX = ".relief.zarr"
#: Of the files that this version writes.
_VERSION = 1
_KIND, _ATTRIBUTE = "relief", "lightcube"
_MOST_LEVEL = 65535


def is_relief(path: str | Path) -> bool:
    """Whether a name is that of a relief's file."""
    return name_of(place(path)).lower().rstrip("/").endswith(SUFFIX)


def is_relief_folder(at: Place) -> bool:
    """Whether a folder holds a relief, and may therefore be replaced by another one."""
    try:
        document = json.loads(read_bytes(child(at, "zarr.json")) or b"")
        return bool(document["attributes"][_ATTRIBUTE]["kind"] == _KIND)
    except (OSError, ValueError, LookupError, TypeError):
        return False


@checked
def read_relief(path: str | Path) -> Relief:
    """Read a relief from a folder ``NAME.relief.zarr`` that `lightcube.save` wrote.

    Raises
    ------
    InputError
        Where there is no such folder, it is no relief, it is damaged, or a newer version wrote it.
    """
    at = place(path)
    if not is_relief(path):
        raise InputError(f"{at} is no relief: give a folder that ends with {SUFFIX}")
    with fetched(at) as local:
        with system_errors(local, "reading"):
            there = (local / "zarr.json").is_file()
        if not there:
            raise InputError(f"there is no relief {local}: give a folder that lightcube wrote")
        return _read(local)


def _read(path: Path) -> Relief:
    from lightcube.io import _zarr  # here: Zarr takes a while to load

    return _from_json(path, *_zarr.read_relief(path, _check_kind))


def _check_kind(path: Path, document: object) -> Mapping[str, Any]:
    """The document of a relief, of a version that this one reads, or `InputError`."""
    if not isinstance(document, Mapping) or document.get("kind") != _KIND:
        raise InputError(f"{path} is no relief: give a folder that lightcube relief wrote")
    if isinstance(document.get("relief_version"), int) and document["relief_version"] > _VERSION:
        raise InputError(f"{path} is of a newer lightcube than this one: update lightcube")
    return document


def _from_json(path: Path, document: object, heights: NDArray[Any], wanted: NDArray[Any] | None) -> Relief:
    """Build the relief again; `InputError` where its document cannot be right."""
    document = _check_kind(path, document)
    try:
        said = dict(document["recipe"])
        steepest = said.pop("steepest_px")
        recipe = ReliefRecipe(**said, steepest_px=math.inf if steepest is None else steepest)
        known = {name: document[name] for name in ("is_colour", "cell", "provenance")}
        return Relief(locked(heights), locked(np.asarray(wanted)), recipe, tuple(document["names"]), **known)
    except (LookupError, TypeError, ValueError, AttributeError) as error:  # `InputError` is a `ValueError`
        raise damaged(path, f"{type(error).__name__}: {' '.join(str(error).split())[:100]}") from error


def damaged(path: Path, what: str) -> InputError:
    """What to raise where a file is a relief's but not whole."""
    return InputError(f"{path} is a damaged relief ({what}): get another copy or make it again")


def _write(path: Path, relief: Relief) -> None:
    """Write all of a relief as a new Zarr group, heights and wanted light in its arrays."""
    from lightcube.io import _zarr

    said = _metadata.plain(
        {
            "kind": _KIND,
            "relief_version": _VERSION,
            "written_by": f"lightcube {version('lightcube')}",
            "heights_unit": f"{relief.recipe.px_mm} mm",
            "recipe": asdict(relief.recipe),
            **{name: getattr(relief, name) for name in ("names", "is_colour", "cell", "provenance")},
        }
    )

    _zarr.write_relief(path, said, relief.heights_px, relief.wanted)


def _write_heights(path: Path, relief: Relief) -> None:
    """Write heights as a grey PNG of 16 bits, white being as high as the relief may be; a text in it says how high."""
    from PIL import Image  # here: who asks whether a name is a relief's waits for none of it
    from PIL.PngImagePlugin import PngInfo

    top_mm = max(relief.recipe.top_mm, float(relief.heights_mm.max()))
    levels = np.rint(relief.heights_mm / top_mm * _MOST_LEVEL).astype(np.uint16)
    said = PngInfo()
    said.add_text("Description", f"heights of a relief: white is {top_mm:g} mm, a pixel {relief.recipe.pitch_mm:g} mm")
    encoded = BytesIO()  # not into the file: Pillow takes no notice of a disk that is full
    Image.fromarray(levels).save(encoded, "PNG", pnginfo=said)
    path.write_bytes(encoded.getbuffer())


def _printed(write: Writer) -> Writer:
    """Write the mesh of a relief."""

    def written(path: Path, relief: Relief) -> Warning | None:
        return write(path, relief_mesh(relief))

    return written


WRITERS: dict[str, Writer] = {
    SUFFIX: _write,
    ".png": _write_heights,
    **{suffix: _printed(write) for suffix, write in printable.WRITERS.items()},
}
