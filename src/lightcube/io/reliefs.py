"""Reliefs as files: all that is known of one, its heights as a picture, or the mesh that is printed."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np

from lightcube.errors import InputError
from lightcube.io import printable
from lightcube.io._files import RELIEF_SUFFIX, ZIP_SUFFIX, Writer, system_errors
from lightcube.io._places import Place, fetched, holds, name_of, place
from lightcube.io._relief_json import KIND
from lightcube.optics.checks import checked
from lightcube.solids.relief import Relief
from lightcube.solids.relief_mesh import relief_mesh

_MOST_LEVEL = 65535
_ZIP = RELIEF_SUFFIX + ZIP_SUFFIX


def is_relief(path: str | Path) -> bool:
    """Whether a name is that of a relief's file."""
    return name_of(place(path)).lower().rstrip("/").endswith((RELIEF_SUFFIX, _ZIP))


def is_relief_folder(at: Place) -> bool:
    """Whether a folder holds a relief, and may therefore be replaced by another one."""
    return holds(at, KIND)


@checked
def read_relief(path: str | Path) -> Relief:
    """Read a relief from ``NAME.relief.zarr``, or in one file ``NAME.relief.zarr.zip``, as `lightcube.save` wrote it.

    Raises
    ------
    InputError
        Where there is no such folder, it is no relief, it is damaged, or a newer version wrote it.
    """
    from lightcube.io import _zarr  # here: Zarr comes with it

    at = place(path)
    if not is_relief(path):
        raise InputError(f"{at} is no relief: give a folder that ends with {RELIEF_SUFFIX}")
    with fetched(at) as local:
        with system_errors(local, "reading"):
            there = (local / "zarr.json").is_file() or (local.is_file() and local.name.lower().endswith(_ZIP))
        if not there:
            raise InputError(f"there is no relief {local}: give one that lightcube wrote")
        return _zarr.read_relief(local)


def _write(path: Path, relief: Relief) -> None:
    """Write all of a relief."""
    from lightcube.io import _zarr  # here: Zarr comes with it

    _zarr.write_relief(path, relief)


def _write_zip(path: Path, relief: Relief) -> None:
    """Write all of a relief into one file."""
    from lightcube.io import _zarr

    _zarr.zipped(_zarr.write_relief)(path, relief)


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
    RELIEF_SUFFIX: _write,
    _ZIP: _write_zip,
    ".png": _write_heights,
    **{suffix: _printed(write) for suffix, write in printable.WRITERS.items()},
}
