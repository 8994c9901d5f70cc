"""What a page is told of a stack of films, in plain JSON, and its films: enough to cast its pictures exactly."""

from __future__ import annotations

import gzip
from typing import TYPE_CHECKING, Any

import numpy as np

from lightcube.drawing.stacks import lowered, sheets
from lightcube.errors import InputError
from lightcube.optics.arrays import Reals
from lightcube.optics.cube import Cube
from lightcube.optics.light import discs_sampled
from lightcube.optics.moves import places_of
from lightcube.optics.naming import told_apart
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.optics.transfer import encode
from lightcube.pictures.fitting import targets_of
from lightcube.scoring import metrics
from lightcube.viewer.description import FORMAT, wanted_images
from lightcube.viewer.label import Label

if TYPE_CHECKING:
    from lightcube.optics.films import Paths

#: What is to be seen, in words that the names of pictures can follow.
WHAT = "Light falls through printed films that lie above each other, and their shadows are pictures"
#: Cells of all films, in all colours, that a browser takes.
_MOST = 12_000_000
#: Seed of the ways in which films are laid wrongly.
_SEED = 0


def describe_films(cube: Cube, label: str | Label) -> dict[str, Any]:
    """The films, where light meets them for each picture, and what was wanted.

    Raises
    ------
    InputError
        Where the page could not cast the pictures exactly.
    """
    from lightcube.optics.films import paths  # here: the compiler comes with it

    stack, label = cube.grid, Label.of(label)
    assert isinstance(stack, Stack)  # noqa: S101 - nobody asks of anything else
    rig = discs_sampled(cube.rig)
    found = paths(stack, rig)
    _check(cube, found)
    return {
        "format": FORMAT,
        "kind": "films",
        "title": label.title if cube.status == "complete" else f"{label.title} (unfinished)",
        "by": label.by,
        "note": label.note,
        "shape": stack.shape,
        "cell_mm": stack.voxel_mm,
        "raster": rig.picture_shape,
        "transfer": cube.transfer,
        "pictures": _pictures(cube),
        "views": _views(cube, rig, found),
        "room": _room(stack, cube.rig),
        "wanted": wanted_images(cube),
    }


def films_data(cube: Cube) -> bytes:
    """Gzipped float32, the lowest byte first: absorbances ``[film][row][column][colour]``, then wanted display values.

    These are ``[picture][row][column][colour]``, NaN where nothing is wanted; there are none where none were kept.
    """
    absorbed = _in_colour(np.moveaxis(cube.extinction, 0, -1) * cube.grid.voxel_mm)
    parts = [absorbed]
    if cube.targets is not None:
        targets = targets_of(cube)
        wanted = _in_colour(encode(targets.pictures, targets.transfer))
        parts.append(np.where(targets.weight[..., None] > 0, wanted, np.nan))
    return gzip.compress(b"".join(np.ascontiguousarray(part, "<f4").tobytes() for part in parts), 6, mtime=0)


def _check(cube: Cube, found: Paths) -> None:
    """Raise `InputError` where the page's own sums would not be those of `play`."""
    if len(cube.extinction) not in (1, 3):
        count = len(cube.extinction)
        raise InputError(f"a page shows films of 1 or 3 colours, and these have {count}: play them instead")
    if 3 * cube.extinction[0].size > _MOST:
        raise InputError("these films have more cells than a browser takes: play them instead")
    if not cube.rig.fading.is_none:
        raise InputError("a page shows films whose light does not fade with distance: play these instead")
    if not found.are_aligned:
        raise InputError(
            "a page casts films whose cells run along the pixels, and some of these are turned: play them instead"
        )


def _in_colour(values: Any) -> Any:
    """The same in three colours."""
    return np.broadcast_to(values, (*values.shape[:-1], 3))


def _pictures(cube: Cube) -> list[dict[str, Any]]:
    """One for each picture, as of a cube, with what tells it apart."""
    scores = cube.scores.get("pictures", [])
    if len(scores) != len(cube.names):
        scores = metrics.score(cube)["pictures"] if cube.targets is not None else [{"psnr": None}] * len(cube.names)
    each = zip(cube.names, told_apart(cube.rig), scores, cube.rig.stops.window.tolist(), strict=True)
    return [
        {
            "name": name,
            "told": told,
            "angle_deg": float(number),
            "screen": 0,
            "window": window,
            "wanted": None if cube.targets is None else number,
            "mirrored": False,
            "psnr": score["psnr"],
            "overlap": None,
        }
        for number, (name, told, score, window) in enumerate(each)
    ]


def _views(cube: Cube, rig: Rig, found: Paths) -> list[dict[str, Any]]:
    """For each lamp of each picture, or point of its disc: where light meets each film, how aslant, and its power."""
    assert isinstance(cube.grid, Stack)  # noqa: S101 - nobody asks of anything else
    powers = np.broadcast_to(cube.powers[rig.pair] * rig.sums.share, (len(rig.views), len(cube.extinction)))
    off = np.random.default_rng(_SEED).standard_normal((cube.grid.shape[0], 2))
    turns = found.places[..., :4].reshape(*found.places.shape[:2], 2, 2)
    return [
        {
            "picture": int(rig.sums.picture[view]),
            "power": _in_colour(powers[view]).tolist(),
            "lines": found.lines[view].tolist(),
            "off": (-np.einsum("fij,fj->fi", turns[view], off)).tolist(),
            "slants": _slants(found.table[view]),
        }
        for view in range(len(rig.views))
    ]


def _slants(table: Reals) -> list[list[float]]:
    """Of columns and rows: slope of the light at the first one's middle, and how much more from one to the next."""
    from lightcube.kernels.films import CORNER, LAMP, LENGTH, NEAR, RIGHT, UP  # here: a compiler comes with them

    if not table[NEAR]:
        aside = float(np.sqrt(max(table[LENGTH] ** 2 - 1, 0)))
        return [[aside, 0.0], [0.0, 0.0]]  # only the sum of squares counts
    steps = table[RIGHT : RIGHT + 2], table[UP : UP + 2]
    away = table[CORNER + 2] - table[LAMP + 2]
    mains = [int(np.argmax(np.abs(step))) for step in steps]
    return [
        [float((table[CORNER + main] - table[LAMP + main]) / away), float(step[main] / away)]
        for step, main in zip(steps, mains, strict=True)
    ]


def _room(stack: Stack, rig: Rig) -> list[dict[str, Any]]:
    """Where films, paper and lamps are for each picture: corners, mm, and the way to the lamp or its place."""
    lower, places = lowered(stack, rig), places_of(stack, rig)
    views, (rows, columns) = lower.views, rig.picture_shape
    room = []
    for picture, view in enumerate(lower.starts[:-1]):
        right, down = views.column_steps_mm[view] * columns / 2, views.row_steps_mm[view] * rows / 2
        middle = views.origins_mm[view]
        paper = [middle + a * right + b * down for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        lamps = [
            {"way": (lamp[:3] if lamp[3] else -lamp[:3]).tolist(), "near": bool(lamp[3])}
            for lamp in views.lamps[lower.sums.picture == picture]
        ]
        films = sheets(stack, places[picture]).tolist()
        room.append({"films": films, "paper": np.array(paper).tolist(), "lamps": lamps})
    return room
