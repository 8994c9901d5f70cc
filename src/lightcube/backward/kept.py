"""What a store gives of a job's pieces, checked against the job before it is used: somebody may have changed it."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.backward.job import Job
from lightcube.backward.store import Arrays, Store
from lightcube.backward.units import coarse_shape
from lightcube.errors import InputError

#: Names of what is kept of a piece: its voxels ``(channel or dye, z, y, x)``, lamp powers ``(lamp, channel)``, figures
#: of its iterations; of a checkpoint the least error that was cast with its iteration, and the figures of earlier
#: phases.
VOXELS, POWERS, HISTORY, LOOKS, EARLIER = "extinction", "lamp-powers", "history", "looks", "earlier-history"
_REASONS = ("iterations", "enough", "best", "converged")


def result_of(job: Job, store: Store, name: str) -> Arrays | None:
    """The result of a piece, or None where it is not finished; `InputError` where it cannot be this job's."""
    found = store.finished(name)
    return None if found is None else _checked(name, found, _wrong_results(job, name, found))


def state_of(job: Job, store: Store, name: str) -> Arrays | None:
    """The checkpoint of a piece, or None where there is none; `InputError` where it cannot be this job's.

    What else a solver has kept it checks itself.
    """
    found = store.state(name)
    return None if found is None else _checked(f"{name}.state", found, _wrong_state(job, name, found))


def shape_of(job: Job, name: str) -> tuple[int, int, int, int]:
    """Shape ``(channel or dye, z, y, x)`` of a piece's voxels."""
    kind, number = name.split("-")
    if kind == "level":
        return (job.kinds, *coarse_shape(job.grid.shape, int(number)))
    part = job.parts[int(number)]
    kinds = job.kinds_of(part)
    return (kinds.stop - kinds.start, part.slices.stop - part.slices.start, *job.grid.shape[1:])


def _powers_shape(job: Job, name: str) -> tuple[int, int]:
    """Shape ``(lamps, channels)`` of a piece's lamp powers."""
    kind, number = name.split("-")
    colours = slice(0, job.channels) if kind == "level" else job.parts[int(number)].colours
    return job.lamp_bounds[0].shape[0], colours.stop - colours.start


def _checked(name: str, found: Arrays, wrong: Iterator[str]) -> Arrays:
    """What was found, or `InputError` of the first thing that is wrong."""
    try:
        what = next(wrong, None)
    except KeyError as error:
        what = f"{error} is missing"
    if what is not None:
        raise InputError(
            f"{name}.npz of the unfinished cube is damaged ({what}): remove it, and that piece is computed again"
        )
    return found


def _wrong_results(job: Job, name: str, found: Arrays) -> Iterator[str]:
    """Yield what a result cannot be."""
    shape = shape_of(job, name)
    if not _is_finite(found[VOXELS], shape) or np.min(found[VOXELS]) < 0:
        yield f"{VOXELS} are not finite numbers from 0 on of shape {shape}"
    yield from _wrong_powers(found[POWERS], _powers_shape(job, name))
    if not _is_finite(found[HISTORY], (None,)) or not found[HISTORY].size:
        yield f"{HISTORY} is no list of finite numbers"
    rejected = found["rejected"]
    if rejected.dtype.kind not in "iu" or rejected.ndim != 2 or rejected.shape[1] != 4 or not _is_of(job, rejected):
        yield "rejected names no pixels of this job"
    if found["undetermined"].shape or found["undetermined"].dtype.kind not in "iu":
        yield "undetermined is no number"
    if found["stop_reason"].shape or str(found["stop_reason"]) not in _REASONS:
        yield f"stop_reason is none of {', '.join(_REASONS)}"
    if "lower_bound" in found and not _is_finite(found["lower_bound"], ()):
        yield "lower_bound is no finite number"


def _wrong_state(job: Job, name: str, found: Arrays) -> Iterator[str]:
    """Yield what a checkpoint cannot be."""
    count = math.prod(shape_of(job, name))
    if not _is_finite(found["x"], None) or found["x"].size != count:
        yield f"x holds no {count} finite numbers"
    yield from _wrong_powers(found[POWERS], _powers_shape(job, name))
    for key in (HISTORY, EARLIER):
        if not _is_finite(found[key], (None,)):
            yield f"{key} is no list of finite numbers"
    looks = found[LOOKS]
    if looks.dtype.kind != "f" or looks.shape != (2,) or np.any(np.isnan(looks)):
        yield f"{LOOKS} are no two numbers"


def _wrong_powers(powers: NDArray[Any], shape: tuple[int, int]) -> Iterator[str]:
    if not _is_finite(powers, shape) or np.min(powers) <= 0:
        yield f"{POWERS} are not positive numbers of shape {shape}"


def _is_of(job: Job, rejected: NDArray[Any]) -> bool:
    """Whether pixels ``(picture, row, column, channel)`` are such of the job's pictures."""
    return bool(np.all((rejected >= 0) & (rejected < np.array(job.targets.pictures.shape))))


def _is_finite(array: NDArray[Any], shape: tuple[int | None, ...] | None) -> bool:
    """Whether an array is one of finite floats of a shape, in which None is any length; None is any shape."""
    if array.dtype.kind != "f" or not np.all(np.isfinite(array)):
        return False
    return shape is None or (
        array.ndim == len(shape) and all(side in (None, found) for side, found in zip(shape, array.shape, strict=True))
    )
