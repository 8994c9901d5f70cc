"""How many threads this process may use: as many as there are cores that are free to it, unless told otherwise."""

from __future__ import annotations

import math
import os
from pathlib import Path, PurePosixPath

from lightcube.errors import InputError

#: Says how many threads there are by default, as it does to all that numba compiles.
_VARIABLE = "NUMBA_NUM_THREADS"
_GROUPS = Path("/sys/fs/cgroup")


def threads(count: int | None = None) -> int:
    """Set how many threads of this process compute; results are the same, bit for bit, for any number.

    Parameters
    ----------
    count
        At least 1, and at most as many as there are cores; None changes nothing.

    Returns
    -------
    The number in force. Until one is set it is what the environment variable ``NUMBA_NUM_THREADS`` says, else the
    number of cores that are free to this process: by its affinity, and by the limits of its container.

    Raises
    ------
    InputError
        For another number, or one that contradicts ``NUMBA_NUM_THREADS``.
    """
    from lightcube.kernels import tasks  # here: the compiler comes with it

    if count is not None:
        tasks.set_threads(_checked(count))
    return tasks.threads()


def _checked(count: object) -> int:
    if isinstance(count, bool) or not isinstance(count, int) or count < 1:
        raise InputError(f"threads: {count!r} is no number of threads: give a whole number of at least 1")
    said, cores = _said(), free_cores()
    if said is not None and said != count:
        raise InputError(f"threads: {count} contradicts {_VARIABLE}={said} in the environment: leave one of them out")
    if said is None and count > cores:
        have = "is 1 core" if cores == 1 else f"are {cores} cores"
        raise InputError(f"threads: {count} are too many: there {have} for this process: give no more")
    return count


def default() -> int:
    """How many threads compute where nobody said so in this process."""
    said = _said()
    return free_cores() if said is None else said


def _said() -> int | None:
    """The number of threads that the environment asks for, if it does."""
    text = os.environ.get(_VARIABLE, "").strip()
    if not text:
        return None
    if not (text.isascii() and text.isdigit() and int(text)):
        raise InputError(f"{_VARIABLE}={text} in the environment: give a whole number of at least 1, or leave it out")
    return int(text)


def free_cores() -> int:
    """Cores that this process may run on, or the part of them that its container may use, rounded up."""
    allowed = getattr(os, "sched_getaffinity", None)  # of Linux
    cores = len(allowed(0)) if allowed else os.cpu_count() or 1
    return max(1, min(cores, math.ceil(min(_quotas(), default=cores))))


def _quotas() -> list[float]:
    """Cores by the limits of all control groups that this process is in, of either version of these."""
    found = []
    for line in _lines(Path("/proc/self/cgroup")):
        number, names, path = line.split(":", 2)
        if number != "0" and "cpu" not in names.split(","):
            continue
        root = _GROUPS if number == "0" else _GROUPS / "cpu"
        inside = PurePosixPath(path.lstrip("/"))
        # in a container the path may be that of the machine, which is not to be seen there: then the root counts
        for folder in {root, *(root / part for part in (inside, *inside.parents))}:
            found += _quota(folder)
    return found


def _quota(folder: Path) -> list[float]:
    """The limit of one control group in cores, if it has any."""
    lines = _lines(folder / "cpu.max") or [
        " ".join(_lines(folder / "cpu.cfs_quota_us") + _lines(folder / "cpu.cfs_period_us"))
    ]
    match lines[0].split():
        case [quota, period] if quota.isdigit() and period.isdigit() and int(period):
            return [int(quota) / int(period)]
    return []


def _lines(file: Path) -> list[str]:
    try:
        return file.read_text().splitlines()
    except OSError:
        return []
