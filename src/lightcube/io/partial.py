"""The place of a cube that is still being made: ``NAME.partial`` beside the NAME it will have.

It is a folder of whole states ``state-1``, ``state-2``, …, each a Zarr cube. A state gets its name when it is
whole, and only then are older ones removed: whenever the work is killed, the newest state is whole.
"""

import re
import shutil
from contextlib import suppress
from pathlib import Path

from lightcube.cube import Cube
from lightcube.errors import InputError
from lightcube.io._files import system_errors
from lightcube.io._zarr import write_zarr

PARTIAL_SUFFIX = ".partial"

_STATE = re.compile(r"state-([0-9]+)")
_UNNAMED = ".state"


def partial_path(out: str | Path) -> Path:
    """Return the folder of the unfinished cube `out`: ``NAME.partial``."""
    out = Path(out)
    return out.with_name(out.name + PARTIAL_SUFFIX)


def write_partial(out: str | Path, cube: Cube) -> Path:
    """Put `cube` in place as the newest state of the unfinished cube `out`, and return the partial folder.

    The caller says by ``cube.status`` whether the solver had come to its end.

    Raises
    ------
    InputError
        Where the folder cannot be written or the disk is full; the state before is kept then.
    """
    folder = partial_path(out)
    with system_errors(folder, "writing"):
        folder.mkdir(exist_ok=True)
        older = _states(folder)
        fresh = folder / _UNNAMED
        if fresh.exists():  # of a run that was killed
            shutil.rmtree(fresh)
        try:
            write_zarr(fresh, cube)
            fresh.rename(folder / f"state-{max(older, default=0) + 1}")
        except BaseException:
            shutil.rmtree(fresh, ignore_errors=True)
            with suppress(OSError):
                folder.rmdir()  # goes only where nothing is in it
            raise
        for state in older.values():
            shutil.rmtree(state)
    return folder


class PartialStore:
    """Keeps the unfinished states of the cube `out` in its partial folder, for `lightcube.backward.solve`."""

    def __init__(self, out: str | Path) -> None:
        self.out = Path(out)

    def keep(self, cube: Cube) -> None:
        """Put `cube` in place of the state kept before."""
        write_partial(self.out, cube)


def newest_state(partial: Path) -> Path:
    """Return the newest whole state in a partial folder, or raise `InputError` where there is none."""
    if not partial.is_dir():
        raise InputError(f"there is no unfinished cube {partial}: give a folder that ends with {PARTIAL_SUFFIX}")
    states = _states(partial)
    if not states:
        raise InputError(f"{partial} has no state of a cube in it yet: start again without it")
    return states[max(states)]


def is_partial(partial: Path) -> bool:
    """Tell whether there is a folder that `write_partial` made, or an empty one."""
    return partial.is_dir() and all(_STATE.fullmatch(item.name) or item.name == _UNNAMED for item in partial.iterdir())


def discard_partial(out: str | Path) -> None:
    """Remove the partial folder of `out`; `InputError` where there is none, or where it is something else."""
    folder = partial_path(out)
    if not is_partial(folder):
        raise InputError(f"there is no unfinished cube {folder} to remove: check the name")
    with system_errors(folder, "removing"):
        shutil.rmtree(folder)


def _states(folder: Path) -> dict[int, Path]:
    """The whole states in `folder` by their number."""
    named = ((_STATE.fullmatch(item.name), item) for item in folder.iterdir())
    return {int(match[1]): item for match, item in named if match}
