"""Arrays that belong to a value, and what arrays are called in signatures.

A value of this package shares its arrays with nobody who can write to them. What an array of that kind is given as is
taken without a copy: whoever makes a large one and hands it over marks it by `locked`.
"""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from lightcube.errors import InputError

Reals: TypeAlias = NDArray[np.float64]
Floats: TypeAlias = NDArray[np.floating[Any]]
Counts: TypeAlias = NDArray[np.intp]
Integers: TypeAlias = NDArray[np.int64]
Flags: TypeAlias = NDArray[np.bool_]
#: Display values from 0 to 255.
Levels: TypeAlias = NDArray[np.uint16]
#: Colours of pictures of 8 bits.
Bytes: TypeAlias = NDArray[np.uint8]
#: Pictures in linear light.
Images: TypeAlias = NDArray[np.float32]
#: Extinction of voxels, 1/mm.
Volume: TypeAlias = NDArray[np.float32]
#: A number, or an array, list or nested list of numbers, which is made an array.
Numbers: TypeAlias = Annotated[ArrayLike, "numbers"]

#: Which of several things, by their numbers.
Indices: TypeAlias = Sequence[int] | NDArray[np.integer[Any]] | slice

Scalar = TypeVar("Scalar", bound=np.generic)


def as_numbers(given: Numbers, what: str, *shapes: tuple[int, ...]) -> Reals:
    """What was given as an array of float64, or `InputError` that calls it `what`.

    Of several shapes the last is what comes back: what has one of the others is repeated.
    """
    try:
        array = np.asarray(given)
        if array.dtype.kind not in "iuf" or isinstance(given, str):
            raise ValueError
    except (TypeError, ValueError) as error:
        raise InputError(
            f"{what} must be numbers, not {type(given).__name__}: give a list or an array of them"
        ) from error
    if shapes and array.shape not in shapes:
        raise InputError(f"{what} must be numbers of shape {' or '.join(map(str, shapes))}, not {array.shape}")
    made = array.astype(np.float64, copy=False)
    return np.broadcast_to(made, shapes[-1]) if shapes else made


def as_indices(given: Indices, count: int, what: str) -> Counts:
    """Numbers of some of `count` things, from 0 or -1 on, or `InputError` that calls them `what`."""
    try:
        array = np.arange(count)[given] if isinstance(given, slice) else np.asarray(given)
    except (TypeError, ValueError):
        array = np.asarray(None)
    if array.ndim != 1 or (array.size and array.dtype.kind not in "iu"):
        raise InputError(f"{what} are taken by a list of whole numbers, not by {_in_short(given)}: give one")
    if not array.size:
        raise InputError(f"none of {count} {what} is taken by {_in_short(given)}: take one at least")
    if not -count <= array.min() <= array.max() < count:
        raise InputError(f"there are {count} {what}, and {_in_short(given)} names others: count from 0 to {count - 1}")
    return array.astype(np.intp, copy=False)


def _in_short(given: object) -> str:
    """How something is written, on a line; of arrays that takes long."""
    return " ".join(repr(given).split())[:60]


def owned(array: ArrayLike, dtype: DTypeLike | None, *, order: Any = "K") -> NDArray[Any]:
    """The same numbers in an array that nobody can write to: itself where it is one, else a copy, once."""
    with np.errstate(over="ignore"):  # what overflows is no longer finite, and is told so
        made = np.asarray(array, dtype, order=order)
    if _is_safe(made):
        return made
    # numpy's own conversions are new arrays; anything else may have handed out memory that it keeps
    is_new = made is not array and made.base is None and isinstance(array, np.ndarray | np.generic | list | tuple)
    kept = made if is_new else np.array(made, dtype, order=order)
    kept.setflags(write=False)
    return kept


def copied(value: Any) -> Any:
    """Mappings, lists, tuples and arrays copied, whatever is in them; all else as it is."""
    if isinstance(value, Mapping):
        return {key: copied(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return type(value)(map(copied, value)) if type(value) in (list, tuple) else value
    return owned(value, None) if isinstance(value, np.ndarray) else value


def locked(array: NDArray[Scalar]) -> NDArray[Scalar]:
    """Mark a new array, with the memory that it is a view of, as one that is never written to again: it is returned."""
    part: Any = array
    while isinstance(part, np.ndarray):
        part.setflags(write=False)
        part = part.base
    return array


def keep(thing: object, **dtypes: DTypeLike | None) -> None:
    """Make arrays of a frozen value its own, of dtypes by the names of their fields; what is None stays so."""
    for name, dtype in dtypes.items():
        given = getattr(thing, name)
        if given is not None:
            object.__setattr__(thing, name, owned(given, dtype))


def _is_safe(array: NDArray[Any]) -> bool:
    """Whether an array, and all that it is a view of, is read-only memory of numpy's own."""
    part: Any = array
    while isinstance(part, np.ndarray):
        if part.flags.writeable:
            return False
        if part.base is None:
            return bool(part.flags.owndata)
        part = part.base
    return isinstance(part, bytes)
