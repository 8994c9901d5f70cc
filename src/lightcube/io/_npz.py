"""A cube as NumPy's own archive."""

import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from lightcube.errors import InputError
from lightcube.io import _metadata
from lightcube.io._files import system_errors
from lightcube.optics.arrays import locked
from lightcube.optics.cube import Cube


def write_npz(path: Path, cube: Cube) -> None:
    """Write a cube as NumPy's archive."""
    arrays: dict[str, Any] = {"extinction": cube.extinction, "lightcube": np.array(json.dumps(_metadata.to_json(cube)))}
    if cube.targets is not None:
        arrays["targets"] = cube.targets
    with path.open("wb") as file:
        np.savez(file, **arrays)


def read_npz(path: Path) -> Cube:
    """Read a cube from NumPy's archive."""
    try:
        with (
            system_errors(path, "reading"),
            path.open("rb") as file,
            np.lib.npyio.NpzFile(file, allow_pickle=False) as arrays,
        ):
            document = json.loads(str(arrays["lightcube"])) if "lightcube" in arrays else None
            _metadata.check_version(path, document)
            if "extinction" not in arrays:
                raise _metadata.damaged(path, "its array 'extinction' is missing")
            extinction = locked(arrays["extinction"])
            targets = locked(arrays["targets"]) if "targets" in arrays else None
    except InputError:
        raise
    except MemoryError as error:
        raise InputError(f"{path} does not fit into this machine's memory: open it on a larger one") from error
    # NotImplementedError is what zipfile raises for a way of compression that it does not know
    except (ValueError, EOFError, zipfile.BadZipFile, KeyError, RecursionError, NotImplementedError) as error:
        raise _metadata.damaged(path, " ".join(str(error).split())[:100]) from error
    return _metadata.from_json(path, document, extinction, targets)
