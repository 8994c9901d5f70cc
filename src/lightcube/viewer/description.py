"""What a page is told of a cube, in plain JSON."""

import base64
import gzip
import json
import math
from io import BytesIO
from typing import Any

import numpy as np
from PIL import Image

from lightcube.drawing.eyes import camera_for
from lightcube.drawing.standing import carries_cube, drawn
from lightcube.optics.cube import Cube
from lightcube.optics.light import discs_sampled
from lightcube.optics.refraction import iors
from lightcube.optics.rig import Rig
from lightcube.scoring import metrics
from lightcube.scoring.overlap import overlaps
from lightcube.solids.shape import is_opaque
from lightcube.viewer.label import Label
from lightcube.viewer.packing import Packed, lost

#: Of the description; a page of another one is not read.
FORMAT = 2
#: Rows and columns of the picture that the camera is chosen for.
_WIDE = (900, 1600)
#: Bytes that all wanted pictures may have without loss; larger ones lose a little.
_EXACT = 1_000_000
_QUALITY = 85


def describe(cube: Cube, packed: Packed, label: str | Label) -> dict[str, Any]:
    """What stands where at which angle, in the cube's own axes, and what was wanted; infinity is None.

    Parameters
    ----------
    cube
        The full cube, whose targets are shown.
    packed
        What the page holds of it, or of a `smaller` one.
    label
        For people; a text is a title.
    """
    label = Label.of(label)
    shown = drawn(packed.cube)
    rig = shown.rig
    camera = camera_for(packed.cube, _WIDE)
    same = packed.cube.grid.shape == cube.grid.shape
    worst, mean = packed.lost if same else lost(cube, packed.cube)
    wanted = wanted_images(cube)
    return {
        "format": FORMAT,
        "kind": "cube",
        "title": label.title if cube.status == "complete" else f"{label.title} (unfinished)",
        "by": label.by,
        "note": label.note,
        "voxels": {
            "shape": packed.cube.grid.shape,
            "voxel_mm": packed.cube.grid.voxel_mm,
            "channels": len(packed.codes),
            "bits": packed.bits,
            "least": packed.least,
            "rates": packed.rates,
        },
        "solid": is_opaque(cube),
        "glass": _glass(rig),
        "kept": {"full": cube.grid.shape, "worst_levels": worst, "rms_levels": mean},
        "transfer": cube.transfer,
        "hold_deg": cube.hold_deg,
        "axis": rig.turning.axis.tolist(),
        "turns": bool(np.any(rig.turning.turns) or len(np.unique(rig.stops.angle_deg)) > 1),
        "carried": carries_cube(rig),
        "raster": rig.picture_shape,
        "whole_shadow": _whole(packed.cube),
        "screens": rig.screens.names,
        "lamps": rig.lamps.names,
        "camera": {
            "eye": [float(each) for each in camera.eye],
            "target": [float(each) for each in camera.target],
            "field_deg": camera.field_deg,
        },
        "pictures": _pictures(cube if same else packed.cube, shown.names, rig, bool(wanted)),
        "views": _views(rig, len(packed.codes)),
        "pairs": [
            {"picture": int(picture), "lamp": int(lamp), "power": power.tolist()}
            for (picture, lamp), power in zip(rig.pairs, shown.powers, strict=True)
        ],
        "wanted": wanted,
    }


def zipped(description: dict[str, Any]) -> bytes:
    """A description as gzipped JSON: so damage is found."""
    return gzip.compress(json.dumps(description, allow_nan=False).encode(), 9, mtime=0)


def _whole(cube: Cube) -> tuple[int, int] | None:
    """Rows and columns of the whole shadow; None where screens have edges and are shown whole anyway."""
    return cube.rig.whole(cube.grid).picture_shape if np.all(cube.rig.screens.endless) else None


def _pictures(cube: Cube, names: tuple[str, ...], rig: Rig, wanted: bool) -> list[dict[str, Any]]:
    """One for each stop and screen; those after the cube's own are their mirror images."""
    own = len(cube.names)
    scores = cube.scores.get("pictures", [])
    if is_opaque(cube):  # a decibel says little of black and white
        scores = [{"psnr": None, "overlap": each} for each in (overlaps(cube) if wanted else own * [None])]
    elif len(scores) != own:
        scores = metrics.score(cube)["pictures"] if wanted else own * [{"psnr": None}]
    return [
        {
            "name": name,
            "angle_deg": float(rig.stops.angle_deg[i]),
            "screen": int(rig.stops.screen[i]),
            "window": rig.stops.window[i].tolist(),
            "wanted": i % own if wanted else None,
            "mirrored": i >= own,
            "psnr": scores[i % own]["psnr"],
            "overlap": scores[i % own].get("overlap"),
        }
        for i, name in enumerate(names)
    ]


def _views(rig: Rig, channels: int) -> list[dict[str, Any]]:
    """One for each picture and point of a lamp; the page itself averages over pixels."""
    rig = discs_sampled(rig)
    views = rig.views
    columns = {
        "picture": rig.sums.picture,
        "lamp": rig.sums.lamp,
        "pair": rig.pair,
        "light": views.lamps,
        "origin": views.origins_mm,
        "right": views.column_steps_mm,
        "down": views.row_steps_mm,
        "share": rig.sums.of_colours(channels),
        "reach_mm": rig.fading.reach_mm,
        "falloff_mm": rig.fading.falloff_mm,
        "full_at_mm": rig.fading.full_at_mm,
        "cosine": rig.fading.cosine,
        "veil": rig.fading.veil,
        "turning": rig.turning.turns,
        "way": rig.turning.way,
        "ior": np.ones(len(views)) if rig.glass is None else iors(rig),
    }
    return [{name: _plain(column[view].tolist()) for name, column in columns.items()} for view in range(len(views))]


def _glass(rig: Rig) -> dict[str, Any] | None:
    """What bends the light on its way to the voxels; how much is said of each view."""
    if rig.glass is None:
        return None
    half_mm = [side / 2 for side in rig.glass.size_mm or ()]
    return {"form": rig.glass.form, "half": _plain(half_mm), "blocked": rig.glass.bottom == "blocked"}


def _plain(value: Any) -> Any:
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and math.isinf(value) else value


def wanted_images(cube: Cube) -> list[str]:
    """The wanted pictures as data URIs, clear where nothing is wanted: exact ones, or where these are large, WebP."""
    images = []
    windows = cube.rig.stops.window
    for kept, (rows, columns) in zip([] if cube.targets is None else cube.targets, windows, strict=False):
        picture = kept[:rows, :columns]
        levels = np.rint(picture[..., :-1] / 257).astype(np.uint8)
        colours = np.broadcast_to(levels, (*picture.shape[:2], 3))
        images.append(Image.fromarray(np.dstack([colours, np.where(picture[..., -1:] > 0, 255, 0).astype(np.uint8)])))
    exact: list[str] = []
    for image in images:
        exact.append(encoded(image, "png", optimize=True))
        if sum(map(len, exact)) > _EXACT:
            return [encoded(each, "webp", quality=_QUALITY) for each in images]
    return exact


def encoded(image: Image.Image, kind: str, **options: Any) -> str:
    """A picture as a data URI."""
    stream = BytesIO()
    image.save(stream, kind, **options)
    return f"data:image/{kind};base64,{base64.b64encode(stream.getvalue()).decode()}"
