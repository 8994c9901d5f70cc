"""A cube as NumPy's own archive."""

import json
import sys
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib.npyio import NpzFile

from lightcube.io import _metadata
from lightcube.io._archives import archive
from lightcube.io._bounds import MOST_TEXT, check_text
from lightcube.io._files import system_errors
from lightcube.optics.arrays import locked
from lightcube.optics.cube import Cube

#: Before an array stands what it is, in fewer bytes than these.
_HEADER = 256


def write_npz(path: Path, cube: Cube) -> None:
    """Write a cube as NumPy's archive."""
    text = json.dumps(_metadata.to_json(cube))
    check_text(len(text) + _HEADER)
    arrays: dict[str, Any] = {"extinction": cube.extinction, "lightcube": np.array(text)}
    if cube.targets is not None:
        arrays["targets"] = cube.targets
    if cube.amounts is not None:
        arrays["amounts"] = cube.amounts
    with path.open("wb") as file:
        np.savez(file, **arrays)


def _document(path: Path, arrays: NpzFile) -> Any:
    """What the archive says in JSON."""
    if arrays.zip and arrays.zip.getinfo("lightcube.npy").file_size > 4 * MOST_TEXT:  # text takes four bytes a letter
        raise _metadata.damaged(path, "what it says is larger than it can be")
    said = arrays["lightcube"]
    if said.shape or said.dtype.kind != "U":
        raise _metadata.damaged(path, "what it says is no text")
    letters = np.frombuffer(said.tobytes(), np.dtype(np.uint32).newbyteorder(said.dtype.byteorder))
    if letters.max(initial=0) > sys.maxunicode:  # NumPy makes texts of them that Python cannot handle
        raise _metadata.damaged(path, "what it says has letters that do not exist")
    return json.loads(str(said))


def read_npz(path: Path) -> Cube:
    """Read a cube from NumPy's archive."""
    with (
        system_errors(path, "reading"),
        path.open("rb") as file,
        archive(file, path, partial(_metadata.damaged, path)) as arrays,
    ):
        document = _document(path, arrays) if "lightcube" in arrays else None
        _metadata.check_version(path, document)
        if "extinction" not in arrays:
            raise _metadata.damaged(path, "its array 'extinction' is missing")
        extinction = locked(arrays["extinction"])
        targets, amounts = (locked(arrays[name]) if name in arrays else None for name in ("targets", "amounts"))
    return _metadata.from_json(path, document, extinction, targets, amounts)
