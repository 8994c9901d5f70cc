"""A number for each voxel, as NumPy writes it: where a brush lies."""

from pathlib import Path

import numpy as np

from lightcube.errors import InputError
from lightcube.io._bounds import check_file, memory
from lightcube.io._files import system_errors
from lightcube.io._places import fetched, place
from lightcube.optics.arrays import Flags, locked


def read_mask(path: str | Path) -> Flags:
    """``(z, y, x)``: where the numbers of a ``.npy`` file are not 0; nothing in it is ever unpickled.

    Raises
    ------
    InputError
        Where there is no such file, it does not hold numbers, not a block of them, or NaN.
    """
    with fetched(place(path)) as local:
        with system_errors(local, "reading"):
            if not check_file(local).is_file():
                raise InputError(f"there is no file {path}: give numbers that numpy.save wrote")
            if local.stat().st_size > memory() // 4:
                raise InputError(f"{path} does not fit into this machine's memory: make it smaller")
        try:
            values = np.load(local, allow_pickle=False, mmap_mode="r")
            numbers = values.dtype.kind in "buif"
            if not isinstance(values, np.ndarray) or values.ndim != 3 or not numbers:
                raise InputError(f"{path} holds no block of numbers (z, y, x): save such an array")
            if values.dtype.kind == "f" and np.any(np.isnan(values)):
                raise InputError(f"{path} holds NaN: give 0 where nothing may be taken")
            return locked(np.asarray(values != 0))
        except InputError:
            raise
        except Exception as error:  # NumPy raises whatever it trips over
            detail = " ".join(str(error).split())[:100] or type(error).__name__
            raise InputError(f"{path} cannot be read ({detail}): write it by numpy.save") from error
