"""Pre-flight: what the pictures ask of a cube, and what no cube can do."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.optics.checks import checked
from lightcube.optics.grid import Grid
from lightcube.optics.tables import POWER_MAX
from lightcube.optics.transfer import BLACK, decode, encode
from lightcube.optics.views import Views
from lightcube.pictures.targets import Targets
from lightcube.planning.measured import raised, voxels_a_pixel
from lightcube.wording import counted, in_ev

Floats = NDArray[np.float64]

#: Difference of display values (root mean square over pictures) above which it can be seen, and up to which there is
#: none (one level of 255).
_VISIBLE, _SAME = 0.02, 1 / 255
#: Beams a voxel apart see between ``2 sqrt(2) - 2`` and ``sqrt(2)`` of a voxel's cross-section (both at 45 degrees):
#: totals of two views of one thing differ by this factor at most.
_SAMPLING = 1 / (2 - math.sqrt(2))
#: The largest load that was stored with 40 dB at lamp powers up to 16, for a level and for a raised lamp (measured).
_LOAD_LEVEL, _LOAD_RAISED = 4.5, 5.0
#: Spread of totals above which pictures are no shadows of one solid (those measured: at most 0.05).
_SOLID = 0.1


@checked
def check(targets: Targets, grid: Grid) -> dict[str, Any]:
    """Find out about pictures, all under lamps of one elevation, what can be known before solving.

    Returns
    -------
    Facts for JSON and for `advice`; pictures go by their names, row 0 is the top one:

    ``pictures, columns, rows, elevation_deg, lamp_max``
        As given; `lamp_max` is the largest power of the lamp, linear light.
    ``load, load_limit``
        How full the cube will be, see `load`, and up to what load unrelated pictures were stored with 40 dB.
    ``mirrored, duplicates``
        Pairs of names, see `mirror_conflicts` and `duplicates`.
    ``white_rows, blank_rows``
        See `plain_rows`, by name.
    ``row_conflicts``
        See there.
    ``whole_shadow``
        Whether every picture is as large as the cube's whole shadow: only then do moments bind.
    ``moments``
        See there.
    """
    if targets.rig.glass is not None:
        raise InputError("what pictures demand of each other is known of straight light only: check them without glass")
    elevation_deg, lamp_max = raised(targets.rig, grid), float(targets.rig.lamps.most.max())
    rows, columns = targets.rig.views.picture_shape
    white, blank = plain_rows(targets)
    return {
        "pictures": len(targets),
        "columns": columns,
        "rows": rows,
        "elevation_deg": elevation_deg,
        "lamp_max": lamp_max,
        "load": load(targets.rig.views, grid),
        "load_limit": _LOAD_LEVEL if _is_level(targets.rig.views) else _LOAD_RAISED,
        "mirrored": [[targets.names[view] for view in pair] for pair in mirror_conflicts(targets)],
        "duplicates": [[targets.names[view] for view in pair] for pair in duplicates(targets)],
        "white_rows": {targets.names[view]: runs for view, runs in white.items()},
        "blank_rows": {targets.names[view]: runs for view, runs in blank.items()},
        "row_conflicts": row_conflicts(targets, grid, lamp_max),
        "whole_shadow": bool(np.all(_holds_shadow(targets.rig.views, grid))),
        "moments": moments(targets),
    }


def load(views: Views, grid: Grid) -> float:
    """How full the pictures make the cube: pixels per voxel, times the cube's width in voxels.

    Level lamps: ``views * columns / ny`` over the slices that a pixel is high, how many widths of the cube the pictures
    are where that is one. Raised lamps, where rows share slices: ``views * columns * rows / (ny * nz)``.
    """
    rows, columns = views.picture_shape
    nz, ny, _ = grid.shape
    slices = views.pixel_in(grid)[0] / grid.tall
    return len(views) * columns / ny * (1 / slices if _is_level(views) else rows / nz)


def mirror_conflicts(targets: Targets) -> list[tuple[int, int]]:
    """Pairs of views half a turn apart at elevation 0 whose pictures are not mirror images of each other.

    With level light every beam runs through the same voxels in both, so the later picture is the mirror
    image of the earlier one whatever the cube.
    """
    level = targets.rig.views.elevations_deg == 0
    angles_deg = targets.rig.views.angles_deg
    conflicts = []
    for first in range(len(targets)):
        half_turn = np.abs(np.remainder(angles_deg[first] + 180 - angles_deg + 180, 360) - 180) < 1e-6
        for second in np.flatnonzero(half_turn & level & level[first]):
            if second <= first:
                continue
            shown = encode(targets.pictures[first], targets.transfer)
            mirrored = encode(targets.pictures[second][:, ::-1], targets.transfer)
            weight = targets.weight[first] * targets.weight[second][:, ::-1]
            squares = np.sum(weight[..., None] * (shown - mirrored) ** 2)
            if squares > _VISIBLE**2 * np.sum(weight) * shown.shape[-1]:
                conflicts.append((first, int(second)))
    return conflicts


def duplicates(targets: Targets) -> list[tuple[int, int]]:
    """Pairs of views that want the same picture, to a root mean square of one display level of 255.

    Over pixels that matter in both, weighted by the product of their weights.
    """
    weight = targets.weight.reshape(len(targets), -1)
    common = weight @ weight.T
    squares = np.zeros_like(common)
    # sum of w w' (p - p')^2 for all pairs at once, by matrix products
    for channel in np.moveaxis(targets.pictures, -1, 0):
        shown = encode(channel, targets.transfer).reshape(weight.shape) - np.float32(0.5)
        crossed = (weight * shown**2) @ weight.T
        squares += crossed + crossed.T - 2 * (weight * shown) @ (weight * shown).T
    common *= targets.pictures.shape[-1]
    pairs = np.argwhere(np.triu((squares <= _SAME**2 * common) & (common > 0), k=1))
    return [(int(first), int(second)) for first, second in pairs]


def plain_rows(targets: Targets) -> tuple[dict[int, list[list[int]]], dict[int, list[list[int]]]]:
    """Rows that are white from end to end, and rows of any other one colour, by view: runs of ``[first, last]`` row.

    White is a display value of at least 0.98, one colour is one to a display level of 255, both over pixels that
    matter. Views without such rows are left out.
    """
    shown, matters = encode(targets.pictures, targets.transfer), targets.weight[..., None] > 0
    darkest = np.min(np.where(matters, shown, 1e9), axis=2)
    lightest = np.max(np.where(matters, shown, -1e9), axis=2)
    some = np.any(targets.weight > 0, axis=2)
    white = some & np.all(darkest >= 1 - _VISIBLE, axis=-1)
    blank = some & np.all(lightest - darkest <= _SAME, axis=-1) & ~white
    whites, blanks = ({v: _runs(np.flatnonzero(row)) for v, row in enumerate(kind)} for kind in (white, blank))
    return {v: runs for v, runs in whites.items() if runs}, {v: runs for v, runs in blanks.items() if runs}


def row_conflicts(targets: Targets, grid: Grid, lamp_max: float = POWER_MAX) -> list[dict[str, Any]]:
    """Rows in which one picture is so bright that another cannot be as dark as it wants, whatever the cube.

    Level lamps only; with a raised lamp every row draws on many slices, and the list is empty.

    Returns
    -------
    At most one entry per row and channel, the two pictures of the widest gap (more than 0.02) between `darkest` and
    `mean`; row 0 is the top:

    ``row, channel, bright, dark``
        Where, and the names of the pictures.
    ``allowed, wanted``
        Total absorbance (of beams a voxel apart) that `bright` leaves in its row with a lamp of `lamp_max`, and what
        those beams of `dark` that must be seen there want, with the weakest lamp that its brightest pixel allows.
    ``columns, darkest, mean``
        How many beams of `dark` these are; the darkest possible and the wanted geometric mean over them, in display
        values.
    ``lamp``
        Power of the lamp from which the two no longer conflict.

    Notes
    -----
    A beam of `dark` that runs through the cube within the strip that the other picture shows has all its absorbance
    seen there. So totals bound each other, up to the factor ``1 / (2 - sqrt(2))`` by which sums over beams a voxel
    apart can differ for one and the same voxel: what is listed is certain, and less goes unnoticed. Of beams that are
    further apart nothing is certain, and nothing is listed.
    """
    if not _is_level(targets.rig.views) or voxels_a_pixel(targets.rig, grid) > 1:
        return []
    light = _log_light(targets)
    matters = targets.weight[..., None] > 0
    _, _, width, channels = light.shape
    strongest = math.log(lamp_max)
    white = np.minimum(np.max(np.where(matters, light, -np.inf), axis=(1, 2)), strongest)
    wanted = np.where(matters, np.maximum(white[:, None, None] - light, 0), 0)
    # what is black already may absorb any more
    bound = matters & (targets.pictures > _black(targets))
    allowed = np.sum(np.where(bound, np.maximum(strongest - light, 0), np.inf), axis=2)
    found: dict[tuple[int, int], dict[str, Any]] = {}
    for dark in range(len(targets)):
        inside = _inside(targets.rig.views, grid, dark)
        totals = np.tensordot(inside.astype(np.float64), wanted[dark], axes=(0, 1))
        at = np.argwhere(totals > _SAMPLING * allowed)
        bright, row, channel = at.T
        total, left, columns = totals[bright, row, channel], allowed[bright, row, channel], inside.sum(axis=0)[bright]
        means = np.exp(white[dark, channel] - np.stack([_SAMPLING * left, total]) / columns)
        darkest, mean = encode(means, targets.transfer)
        for i in np.flatnonzero(darkest - mean > _VISIBLE):
            key = int(row[i]), int(channel[i])
            if key in found and found[key]["darkest"] - found[key]["mean"] >= darkest[i] - mean[i]:
                continue
            found[key] = {
                "row": key[0],
                "channel": ("red", "green", "blue")[key[1]] if channels == 3 else str(key[1]),
                "bright": targets.names[bright[i]],
                "dark": targets.names[dark],
                "allowed": float(left[i]),
                "wanted": float(total[i]),
                "columns": int(columns[i]),
                "darkest": float(darkest[i]),
                "mean": float(mean[i]),
                "lamp": math.exp(strongest + float(total[i] / _SAMPLING - left[i]) / width),
            }
    return [found[key] for key in sorted(found)]


def moments(targets: Targets) -> dict[str, float]:
    """How far totals and centroids of absorbance are from those that shadows of one solid have.

    Of the shadows of one solid the totals (zeroth moments) agree, and the centroids (first moments) move as the solid
    turns: ``a cos θ + b sin θ`` across, and with a raised lamp ``c + a cos θ + b sin θ`` down (Helgason and Ludwig).
    With level lamps this holds for each row, with a raised lamp, which mixes rows, for the whole picture.
    Absorbance is that under a lamp of power 1, and 0.5 of a display level is the darkest.

    Returns
    -------
    ``total``
        Root mean square deviation of totals from their mean over views, as a part of the mean total.
    ``total_with_lamps``
        What of it is left with the best lamp power per view and colour, which adds one constant to all rows of a
        view (unbounded; with a raised lamp 0, since a picture has but one total).
    ``across, down``
        Root mean square deviation of first moments, divided by the mean total, as a part of the picture's width and
        height; `down` is 0 with level lamps, where totals say it. Lamp powers do not change them, except where pixels
        are don't care. Up to two views (three, for `down`) always agree.

    Notes
    -----
    Beams through pixel centres sample the solid, so a solid's own figures are not 0: at most a few per cent. Pixels
    that are don't care count as the mean of their row, rows of such pixels as the mean of the other views. Pictures
    that leave a margin are not the whole shadow, and the cube's material there takes up differences.
    """
    absorbance = _absorbance(targets)
    _, rows, columns, channels = absorbance.shape
    theta = np.radians(targets.rig.views.angles_deg)
    turning = np.stack([np.cos(theta), np.sin(theta)], axis=1)
    totals = absorbance.sum(axis=2)
    across = absorbance.transpose(0, 1, 3, 2) @ _offsets(columns)
    down = np.zeros((len(targets), channels))
    if not _is_level(targets.rig.views):
        down = totals.transpose(0, 2, 1) @ _offsets(rows)
        totals, across = (moment.sum(axis=1, keepdims=True) for moment in (totals, across))
    scale = float(np.abs(np.mean(totals))) or 1.0
    apart = totals - totals.mean(axis=0)
    with_lamps = apart - apart.mean(axis=1, keepdims=True)
    still = np.ones((len(targets), 1))
    return {
        "total": _rms(apart) / scale,
        "total_with_lamps": _rms(with_lamps) / scale,
        "across": _rms(_unexplained(across, turning)) / scale / columns,
        "down": _rms(_unexplained(down, np.hstack([turning, still]))) / scale / rows,
    }


def advice(facts: dict[str, Any], *, crowded: bool = True) -> list[str]:
    """Say in a sentence each what is wrong with pictures by the facts of `check`, and what to do; often nothing.

    That they are too many or too large is left out where they are not `crowded`, since something better tells so.
    """
    said = []
    level, moment = facts["elevation_deg"] == 0, facts["moments"]
    spread = moment["total_with_lamps" if level and facts["lamp_max"] > 1 else "total"]
    # Shadows of one solid are no unrelated pictures, however many there are.
    solid = max(moment["total"], moment["across"], moment["down"]) <= _SOLID
    if crowded and facts["load"] > facts["load_limit"] and not solid:
        said.append(_on_load(facts, level))
    if facts["whole_shadow"] and spread > _SOLID:
        said.append(
            f"No solid casts these shadows: what {'a row absorbs' if level else 'they absorb'} differs by "
            f"{spread:.0%} between pictures, a solid's by 5% at most: leave a margin (--picture-width)."
        )
    if facts["mirrored"]:
        (first, second), more = facts["mirrored"][0], len(facts["mirrored"]) - 1
        said.append(
            f"{first} and {second} are half a turn apart, where a level lamp shows mirror images, but they are "
            f"different pictures{_more(more, 'such pair')}: use other angles, or raise the lamp (--elevation-deg 35)."
        )
    if facts["duplicates"]:
        (first, second), more = facts["duplicates"][0], len(facts["duplicates"]) - 1
        said.append(f"{first} and {second} are the same picture{_more(more, 'such pair')}: leave one of them out.")
    return said + _on_rows(facts)


def _on_load(facts: dict[str, Any], level: bool) -> str:
    part = facts["load_limit"] / facts["load"]
    count, wide = int(facts["pictures"] * part), int(facts["columns"] * (part if level else math.sqrt(part)))
    fewer = f"at most {counted(count, 'picture')}, or " if count > 1 else ""
    raise_lamp = ", or raise the lamp (--elevation-deg 35)" if level else ""
    return (
        f"These are {1 / part:.1f} times as many pixels as a cube keeps well of unrelated pictures: use "
        f"{fewer}pictures at most {max(wide, 1)} pixels wide{raise_lamp}."
    )


def _on_rows(facts: dict[str, Any]) -> list[str]:
    said = []
    conflicts = facts["row_conflicts"]
    if conflicts:
        worst = max(conflicts, key=lambda each: float(each["darkest"] - each["mean"]))
        bright = worst["bright"]
        rows = _runs(np.unique([each["row"] for each in conflicts if each["bright"] == bright]))
        others = len({each["bright"] for each in conflicts}) - 1
        power = max(each["lamp"] for each in conflicts)
        most = f"{facts['lamp_max']:g} ({in_ev(facts['lamp_max'])})"
        said.append(
            f"{bright} is too bright for a lamp of {most} in {_rows(rows)}{_more(others, 'picture')}: "
            f"in row {worst['row']} {worst['dark']} wants {worst['channel']} of {worst['mean']:.0%} on average and "
            f"cannot go below {worst['darkest']:.0%}: allow a lamp of more than {power:.2g} ({in_ev(power)}, "
            f"--lamp-max), or raise the lamp (--elevation-deg 35)."
        )
    edges = {
        name: [run for run in runs if run[0] == 0 or run[1] == facts["rows"] - 1]
        for name, runs in facts["blank_rows"].items()
    }
    blank = [f"{name} is of one colour in {_rows(runs)}" for name, runs in edges.items() if runs]
    if blank:
        said.append(f"{blank[0]}{_more(len(blank) - 1, 'picture')}: cut such edges off, they take up room.")
    return said


def _runs(rows: NDArray[np.integer]) -> list[list[int]]:
    """Ascending row numbers as ``[first, last]`` of each run."""
    runs = np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1) if rows.size else []
    return [[int(run[0]), int(run[-1])] for run in runs]


def _rows(runs: list[list[int]]) -> str:
    """Runs of rows as people say them: ``rows 0-3, 7``."""
    spans = [f"{first}-{last}" if last > first else f"{first}" for first, last in runs]
    return f"row{'s' if len(runs) > 1 or '-' in spans[0] else ''} {', '.join(spans)}"


def _more(count: int, what: str) -> str:
    return f" (and {counted(count, f'more {what}')})" if count else ""


def _is_level(views: Views) -> bool:
    return bool(np.all(views.elevations_deg == 0))


def _offsets(count: int) -> Floats:
    """Places of pixels from the picture's middle, in pixels."""
    return np.linspace(-(count - 1) / 2, (count - 1) / 2, count)


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _unexplained(moments: Floats, by: Floats) -> Floats:
    """What least squares of `by` ``(views, terms)`` leave of ``(views, …)``."""
    flat = moments.reshape(len(moments), -1)
    return np.asarray(flat - by @ np.linalg.lstsq(by, flat)[0], np.float64)


def _black(targets: Targets) -> Floats:
    """The darkest light that a screen shows."""
    return np.asarray(decode(np.array([BLACK]), targets.transfer), np.float64)


def _log_light(targets: Targets) -> Floats:
    """Logarithms of the pictures' linear light, floored where a screen is black."""
    return np.asarray(np.log(np.maximum(targets.pictures, _black(targets))), np.float64)


def _absorbance(targets: Targets) -> Floats:
    """Absorbance under a lamp of power 1; what is don't care is filled with means, of the row, then of views."""
    matters = targets.weight[..., None] > 0
    absorbance = np.where(matters, -_log_light(targets), 0)
    count = matters.sum(axis=2)
    means = absorbance.sum(axis=2) / np.maximum(count, 1)
    over_views = means.sum(axis=0) / np.maximum((count > 0).sum(axis=0), 1)
    return np.where(matters, absorbance, np.where(count > 0, means, over_views)[:, :, None])


def _holds_shadow(views: Views, grid: Grid) -> NDArray[np.bool_]:
    """For each view, whether no beam outside the picture touches the cube, or with a level lamp the slices shown."""
    (rows, columns), (tall, wide) = views.picture_shape, views.pixel_in(grid)
    _, ny, nx = grid.shape
    theta = np.radians(views.angles_deg)
    cos, sin = np.abs(np.cos(theta)), np.abs(np.sin(theta))
    high = grid.tall * grid.shape[0] + (nx * cos + ny * sin) * np.abs(np.tan(np.radians(views.elevations_deg)))
    wide_enough = (columns + 1) * wide > nx * sin + ny * cos + 1e-6
    return np.asarray(wide_enough & ((views.elevations_deg == 0) | ((rows + 1) * tall > high + 1e-6)))


def _inside(views: Views, grid: Grid, view: int) -> NDArray[np.bool_]:
    """``(columns, views)``: whether all voxels that a level beam of `view` touches are seen whole in each view."""
    columns = views.picture_shape[1]
    middle = (columns + 1) / 2 - 1e-6
    half = np.array([grid.shape[2], grid.shape[1]]) / 2 + 1e-9  # beams along an outer face touch the cube
    across, along = (
        vectors[:, :2] / np.linalg.norm(vectors[:, :2], axis=1, keepdims=True)
        for vectors in (views.column_steps_mm, views.lamps)
    )
    points = _offsets(columns)[:, None] * across[view]
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.sort(np.stack([(-half - points) / along[view], (half - points) / along[view]]), axis=0)
    enter, leave = np.nanmax(ends[0], axis=1), np.nanmin(ends[1], axis=1)
    reach = np.zeros((columns, len(views)))
    for end in (enter, leave):
        place = points + np.where(enter < leave, end, 0)[:, None] * along[view]
        reach = np.maximum(reach, np.abs(place @ across.T))
    # a voxel's corner is at most half a diagonal from the beam, plus half of one to its far side
    near = reach + math.sqrt(2) < middle
    return np.asarray(near | (enter >= leave)[:, None] | _holds_shadow(views, grid))
