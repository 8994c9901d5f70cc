"""NumPy's archives of arrays (.npz), read without trust."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import IO
from zipfile import ZipInfo

from numpy.lib.format import MAGIC_PREFIX
from numpy.lib.npyio import NpzFile

from lightcube.errors import InputError
from lightcube.io._bounds import memory

#: Bytes at the end of a zip archive that say how long its list of members is; and the longest, of some 100,000.
_TAIL, _MOST_LISTED = 1 << 17, 8 << 20


def is_crowded(file: IO[bytes]) -> bool:
    """Whether a zip archive lists more members than any cube has: each takes time and memory before it is looked at."""
    size = file.seek(0, 2)
    file.seek(max(0, size - _TAIL))
    tail = file.read()
    file.seek(0)
    sizes = [
        int.from_bytes(tail[at + first : at + first + length], "little")
        for mark, first, length in ((b"PK\5\6", 12, 4), (b"PK\6\6", 40, 8))
        if (at := tail.rfind(mark)) >= 0
    ]
    return any(_MOST_LISTED < listed <= size for listed in sizes)


def _is_array(arrays: NpzFile, member: ZipInfo) -> bool:
    """Whether a member begins as an array does: else NumPy gives its bytes."""
    if arrays.zip is None:
        return False
    with arrays.zip.open(member) as opened:
        return opened.read(len(MAGIC_PREFIX)) == MAGIC_PREFIX


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
        if is_crowded(file):
            raise damaged("it lists too many members")
        with NpzFile(file, allow_pickle=False) as arrays:
            members = arrays.zip.infolist() if arrays.zip else []
            if sum(member.file_size for member in members) > memory() // 2:
                raise MemoryError
            for member in members:
                if member.filename.endswith(".npy") and not _is_array(arrays, member):
                    raise damaged(f"{member.filename} is no array")
            yield arrays
    except InputError:
        raise
    except MemoryError as error:
        raise InputError(f"{where} does not fit into this machine's memory: open it on a larger one") from error
    except Exception as error:  # zipfile, its decompressors and NumPy raise whatever they trip over
        if isinstance(error, OSError) and error.errno is not None:  # the disk's; bzip2's own errors have no number
            raise
        raise damaged(" ".join(str(error).split())[:100] or type(error).__name__) from error
