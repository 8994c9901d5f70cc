"""Cubes of earlier formats, told as the newest tells them: whoever reads one need know no other.

Each format is made the next one, and what it does not say is as it was then:

* 1: a turntable's views; what bounds the lamp, and the screen's black, are among what is said of how it was made.
* 2: the same of a stage, with what lights it.
* 3: a rig, which bounds its lamps itself.
* 4: names of lengths and angles have their units. Later ones of it may be solved for light on areas, and say so.
* 5: targets are 16-bit.

The numbers here are those of the formats, which do not change: they follow no default of today.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Document = dict[str, Any]

#: The first format, and the last one whose targets are 8-bit.
FIRST, _EIGHT_BIT = 1, 4
#: What bounded a lamp and a screen where nothing was said.
_POWER_MIN, _POWER_MAX, _BLACK = 1e-4, 16.0, 0.5 / 255
_POWERS = {"per-view": "per-picture", "global": "shared", "coarse": "coarse"}
#: The tables of a rig, with what their columns were called in a lighting.
_TABLES = {
    "sums": {"picture": "picture", "lamp": "lamp", "share": "share", "disc_deg": "disc_deg"},
    "fading": {"reach_mm": "reach_mm", "falloff_mm": "falloff_mm", "full_at_mm": "full_at_mm", "cosine": "cosine"},
    "turning": {"turns": "turning", "way": "way", "axis": "axis"},
    "stops": {"angle": "angle", "screen": "screen", "window": "window"},
    "lamps": {"names": "lamp_names", "least": "least", "most": "most"},
    "screens": {"names": "screen_names", "black": "black", "endless": "endless"},
}
_VIEWS_IN_MM = {"origins": "origins_mm", "column_steps": "column_steps_mm", "row_steps": "row_steps_mm"}
_THIN_SCORES = {"psnr_mean": "thin_psnr_mean", "psnr_min": "thin_psnr_min"}


def targets_dtype(document: object) -> np.dtype[Any]:
    """The dtype of the targets beside a document."""
    return np.dtype(np.uint8 if _format(document) <= _EIGHT_BIT else np.uint16)


def has_cut_pixels(document: object) -> bool:
    """Whether each pixel is in several views, as those of stages could be: light on areas would be averaged twice."""
    if not isinstance(document, Mapping) or _format(document) > _EIGHT_BIT:
        return False
    made = document.get("provenance")
    return isinstance(made, Mapping) and made.get("pixel_samples", 1) != 1


def newest(document: Mapping[str, Any], targets: NDArray[Any] | None) -> tuple[Document, NDArray[Any] | None]:
    """What a cube's file says, and its targets, as the newest format has them; what is newest already stays as it is.

    Raises
    ------
    LookupError, TypeError, ValueError, AttributeError
        Where a document is not what its format says.
    """
    said, found = dict(document), _format(document)
    if found <= _EIGHT_BIT and targets is not None:
        targets = targets * np.uint16(257)  # 255 becomes 65535
    for number in range(found, _EIGHT_BIT + 1):
        said = _STEPS[number](said) | {"format_version": number + 1}
    return said, targets


def _format(document: object) -> int:
    """The number of a document's format; that of the newest where it is none, which whoever checks it will say."""
    found = document.get("format_version") if isinstance(document, Mapping) else None
    return found if isinstance(found, int) and not isinstance(found, bool) else _EIGHT_BIT + 1


def _of_stages(said: Document) -> Document:
    """Format 1 as format 2: the same, which has a lighting besides where the cube is a stage's."""
    return said


def _with_rig(said: Document) -> Document:
    """Format 2 as format 3."""
    views, lighting, made = said["views"], said.get("lighting"), said["provenance"]
    light = _turntable(views, made) if lighting is None else dict(lighting)
    screens = len(light["screen_names"])
    light["black"] = screens * [_said(made, "black", _BLACK)]
    light["endless"] = screens * [lighting is None]
    known = {old for columns in _TABLES.values() for old in columns.values()}
    if set(light) != known:
        raise ValueError(f"lighting: {', '.join(sorted(set(light) ^ known))}")
    rig = {table: {new: light[old] for new, old in columns.items()} for table, columns in _TABLES.items()}
    kept = {name: value for name, value in said.items() if name not in ("views", "lighting")}
    return kept | {"rig": {"views": views, **rig}, "provenance": _without_lamps(made)}


def _turntable(views: Mapping[str, Any], made: Mapping[str, Any]) -> Document:
    """The lighting of a turntable: each view is a picture, and its lamp and screen go round together."""
    lamps = np.asarray(views["lamps"], np.float64)
    count = len(lamps)
    least, most = _lamp_bounds(made)
    return {
        "picture": list(range(count)),
        "lamp": count * [0],
        "share": count * [[1.0]],
        "disc_deg": count * [0.0],
        "reach_mm": count * [[None, None]],  # infinity
        "falloff_mm": count * [[0.0, 0.0]],
        "full_at_mm": count * [None],
        "cosine": count * [False],
        "turning": count * [[True, True]],
        "way": count * [[-1.0, -1.0]],
        "axis": [0.0, 0.0, 1.0],
        "angle": (np.round(np.degrees(np.arctan2(-lamps[:, 1], lamps[:, 0])), 9) % 360).tolist(),
        "screen": count * [0],
        "window": count * [list(views["picture_shape"])],
        "least": [least],
        "most": [most],
        "lamp_names": ["lamp"],
        "screen_names": ["screen"],
    }


def _lamp_bounds(made: Mapping[str, Any]) -> tuple[float, float]:
    """Least and largest power of a turntable's lamp: the same where it was fixed, as by all methods but one."""
    power = made.get("lamp_power")
    if power is not None or made.get("method", "display") != "display":
        return (_said(made, "lamp_power", 1.0),) * 2
    return _POWER_MIN, _said(made, "lamp_max", _POWER_MAX)


def _said(made: Mapping[str, Any], name: str, usual: float) -> float:
    """A number that may be missing or null."""
    found = made.get(name)
    return usual if found is None else float(found)


def _without_lamps(made: Mapping[str, Any]) -> Document:
    """How a cube was made, without what its rig says, in format 3's words."""
    kept = {name: value for name, value in made.items() if name not in ("lamp", "lamp_power", "lamp_max", "black")}
    if made.get("lamp") in _POWERS:
        kept["powers"] = _POWERS[made["lamp"]]
    if "max_extinction" in made:
        kept.setdefault("per", "mm")
    return _renamed(kept, {"angles_per_view": "angles_per_picture"})


def _with_units(said: Document) -> Document:
    """Format 3 as format 4."""
    rig = said["rig"]
    views, stops = _renamed(rig["views"], _VIEWS_IN_MM), _renamed(rig["stops"], {"angle": "angle_deg"})
    return said | {"rig": {**rig, "views": views, "stops": stops}}


def _of_light(said: Document) -> Document:
    """Format 4 as format 5: a cube that does not say of how many points was solved for one beam a pixel.

    Its scores and what was predicted of it were of thin beams too, and do not pass for what a wall shows.
    """
    made, scores = said["provenance"], said["scores"]
    if "points" in made:
        return said
    thin = {name: value for name, value in made.items() if name != "predicted"}
    if "thin_psnr_mean" not in scores:
        scores = {new: scores[old] for old, new in _THIN_SCORES.items() if old in scores}
    return said | {"scores": scores, "provenance": {**thin, "points": 1, "row_points": 1}}


def _renamed(part: Mapping[str, Any], names: Mapping[str, str]) -> Document:
    """The same with other names for some of its keys."""
    return {names.get(name, name): value for name, value in part.items()}


_STEPS: Mapping[int, Callable[[Document], Document]] = {1: _of_stages, 2: _with_rig, 3: _with_units, 4: _of_light}
