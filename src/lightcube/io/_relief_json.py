"""What a relief's file says besides its arrays: one JSON document, checked when it is read."""

import math
from collections.abc import Mapping
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.io._metadata import plain
from lightcube.optics.arrays import locked
from lightcube.solids.relief import Relief, ReliefRecipe

KIND = "relief"
#: Of the files that this version writes; those of version 1 know of no bounce.
_VERSION = 2


def to_json(relief: Relief) -> dict[str, Any]:
    """`relief` without its arrays as plain JSON values; every number comes back bit for bit."""
    said: dict[str, Any] = plain(
        {
            "kind": KIND,
            "relief_version": _VERSION,
            "written_by": f"lightcube {version('lightcube')}",
            "heights_unit": f"{relief.recipe.px_mm} mm",
            "recipe": asdict(relief.recipe),
            **{name: getattr(relief, name) for name in ("names", "is_colour", "cell", "provenance")},
        }
    )
    return said


def check_version(path: Path, document: object) -> Mapping[str, Any]:
    """Return `document`, or raise `InputError` unless it is a relief's that this version reads."""
    if not isinstance(document, Mapping) or document.get("kind") != KIND:
        raise InputError(f"{path} is no relief: give a folder that lightcube relief wrote")
    if isinstance(document.get("relief_version"), int) and document["relief_version"] > _VERSION:
        raise InputError(f"{path} is of a newer lightcube than this one: update lightcube")
    return document


def from_json(path: Path, document: object, heights: NDArray[Any], wanted: NDArray[Any]) -> Relief:
    """Build the relief again; `InputError` where its document cannot be right."""
    document = check_version(path, document)
    try:
        said = dict(document["recipe"])
        steepest = said.pop("steepest_px")
        recipe = ReliefRecipe(**said, steepest_px=math.inf if steepest is None else steepest)
        known = {name: document[name] for name in ("is_colour", "cell", "provenance")}
        return Relief(locked(heights), locked(np.asarray(wanted)), recipe, tuple(document["names"]), **known)
    except (LookupError, TypeError, ValueError, AttributeError) as error:  # `InputError` is a `ValueError`
        raise damaged(path, f"{type(error).__name__}: {' '.join(str(error).split())[:100]}") from error


def damaged(path: Path, what: str) -> InputError:
    """What to raise where a file is a relief's but not whole."""
    return InputError(f"{path} is a damaged relief ({what}): get another copy or make it again")
