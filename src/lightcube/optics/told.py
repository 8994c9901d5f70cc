"""What a cube remembers of how it was made, checked before it is used: its file may be anybody's."""

import math
from collections.abc import Callable, Mapping
from typing import Any

from lightcube.optics.cube import Cube


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e15


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and _is_number(value) and value >= 0


def _is_word(value: Any) -> bool:
    return isinstance(value, str) and len(value) <= 200


def _is_order(value: Any) -> bool:
    return isinstance(value, list | tuple) and all(map(_is_count, value)) and sorted(value) == list(range(len(value)))


def _is_prediction(value: Any) -> bool:
    if not isinstance(value, Mapping) or not all(_is_number(value.get(name)) for name in ("psnr_mean", "psnr_min")):
        return False
    pictures = value.get("pictures", [])
    return isinstance(pictures, list | tuple) and all(map(_is_number, pictures))


def _is_place(value: Any) -> bool:
    return (
        isinstance(value, list | tuple)
        and len(value) == 2
        and all(_is_number(part) and 0 <= part <= 1 for part in value)
    )


def _is_part(value: Any) -> bool:
    """Whether something says what was taken of a film."""
    seconds, counts = {"from_s", "to_s"}, {"every", "most"}
    return isinstance(value, Mapping) and all(
        (name in seconds and _is_number(each) and each >= 0) or (name in counts and _is_count(each) and each >= 1)
        for name, each in value.items()
    )


#: What is used of it, and what each must be.
_KINDS: Mapping[str, Callable[[Any], bool]] = {
    "units": lambda value: _is_count(value) and value >= 1,
    "passes": lambda value: value is None or (_is_count(value) and value >= 1),
    **dict.fromkeys(("iterations", "shift"), _is_count),
    **dict.fromkeys(("fit", "stop_reason", "dtype", "lightcube", "powers"), _is_word),
    "method": _is_word,
    "enough_db": lambda value: value in (None, math.inf) or _is_number(value),
    "order": _is_order,
    "film": _is_part,
    "focus": _is_place,
    "predicted": _is_prediction,
}


def remembered(cube: Cube) -> dict[str, Any]:
    """How a cube was made, as far as it can have been so: what is of another kind is left out."""
    return {name: value for name, value in cube.provenance.items() if name not in _KINDS or _KINDS[name](value)}
