"""NumPy's archives of arrays (.npz), read without trust."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import IO

from numpy.lib.npyio import NpzFile

from lightcube.errors import InputError


@contextmanager
def archive(file: IO[bytes], where: object, damaged: Callable[[str], InputError]) -> Iterator[NpzFile]:
    """Open an archive, whose arrays are read when they are asked for; nothing in it is ever unpickled.

    Parameters
    ----------
    where
        The file, for the sentence where its arrays do not fit into memory.
    damaged
        Makes the error of what else is wrong.
    """
    try:
        with NpzFile(file, allow_pickle=False) as arrays:
            yield arrays
    except InputError:
        raise
    except MemoryError as error:
        raise InputError(f"{where} does not fit into this machine's memory: open it on a larger one") from error
    except Exception as error:  # zipfile, its decompressors and NumPy raise whatever they trip over
        if isinstance(error, OSError) and error.errno is not None:  # the disk's; bzip2's own errors have no number
            raise
        raise damaged(" ".join(str(error).split())[:100] or type(error).__name__) from error
