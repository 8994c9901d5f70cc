"""What a page is told of a cube: one description for turntables and stages, in plain JSON."""

import base64
import gzip
import json
import math
from io import BytesIO
from typing import Any

import numpy as np
from PIL import Image

from lightcube.drawing.room import camera_for
from lightcube.drawing.standing import as_stage
from lightcube.optics.cube import Cube
from lightcube.optics.grid import raster_shape
from lightcube.optics.rig import Lighting
from lightcube.scoring import metrics
from lightcube.viewer.packing import Packed, lost

#: Of the description; a page of another one is not read.
FORMAT = 1
#: Rows and columns of the picture that the camera is chosen for.
_WIDE = (900, 1600)
#: Bytes that all wanted pictures may have without loss; larger ones lose a little.
_EXACT = 1_000_000
_QUALITY = 85


def describe(cube: Cube, packed: Packed, title: str) -> dict[str, Any]:
    """What stands where at which angle, in the cube's own frame, and what was wanted; infinity is None.

    Parameters
    ----------
    cube
        The full cube, whose targets are shown.
    packed
        What the page holds of it, or of a `smaller` one.
    title
        For people.

    Raises
    ------
    InputError
        Where the lamps of a turntable stand at several elevations.
    """
    staged = as_stage(packed.cube)
    lighting = staged.lighting
    assert lighting is not None  # noqa: S101 - a stage's
    camera = camera_for(staged, _WIDE)
    same = packed.cube.grid.shape == cube.grid.shape
    worst, mean = packed.lost if same else lost(cube, packed.cube)
    wanted = _wanted(cube)
    return {
        "format": FORMAT,
        "title": title if cube.status == "complete" else f"{title} (unfinished)",
        "voxels": {
            "shape": packed.cube.grid.shape,
            "mm": packed.cube.grid.voxel_mm,
            "channels": len(packed.codes),
            "bits": packed.bits,
            "least": packed.least,
            "rates": packed.rates,
        },
        "kept": {"full": cube.grid.shape, "worst_levels": worst, "rms_levels": mean},
        "transfer": cube.transfer,
        "hold": cube.hold_deg,
        "axis": lighting.axis.tolist(),
        "turns": bool(np.any(lighting.turning) or len(np.unique(lighting.angle)) > 1),
        "carried": bool(np.any(lighting.turning & (lighting.way < 0))),
        "raster": staged.views.picture_shape,
        "whole": _whole(packed.cube),
        "screens": lighting.screen_names,
        "lamps": lighting.lamp_names,
        "camera": {
            "eye": [float(each) for each in camera.eye],
            "target": [float(each) for each in camera.target],
            "field": camera.field_deg,
        },
        "pictures": _pictures(cube if same else packed.cube, staged.names, lighting, bool(wanted)),
        "views": _views(staged, lighting),
        "pairs": [
            {"picture": int(picture), "lamp": int(lamp), "power": power.tolist()}
            for (picture, lamp), power in zip(lighting.pairs, staged.powers, strict=True)
        ],
        "wanted": wanted,
    }


def zipped(description: dict[str, Any]) -> bytes:
    """A description as gzipped JSON: so damage is found."""
    return gzip.compress(json.dumps(description, allow_nan=False).encode(), 9, mtime=0)


def _whole(cube: Cube) -> tuple[int, int] | None:
    """Rows and columns of the whole shadow; None on a stage, whose screens are whole anyway."""
    if cube.lighting is not None:
        return None
    return raster_shape(cube.grid, float(cube.views.elevations[0]))


def _pictures(cube: Cube, names: tuple[str, ...], lighting: Lighting, wanted: bool) -> list[dict[str, Any]]:
    """One for each stop and screen; those after the cube's own are their mirror images."""
    own = len(cube.names)
    scores = cube.scores.get("views", [])
    if len(scores) != own:
        scores = metrics.score(cube)["views"] if wanted else own * [{"psnr": None}]
    return [
        {
            "name": name,
            "angle": float(lighting.angle[i]),
            "screen": int(lighting.screen[i]),
            "window": lighting.window[i].tolist(),
            "wanted": i % own if wanted else None,
            "mirrored": i >= own,
            "psnr": scores[i % own]["psnr"],
        }
        for i, name in enumerate(names)
    ]


def _views(cube: Cube, lighting: Lighting) -> list[dict[str, Any]]:
    views = cube.views
    columns = {
        "picture": lighting.picture,
        "lamp": lighting.lamp,
        "pair": lighting.pair,
        "light": views.lamps,
        "origin": views.origins,
        "right": views.column_steps,
        "down": views.row_steps,
        "share": lighting.share,
        "reach": lighting.reach_mm,
        "falloff": lighting.falloff_mm,
        "full_at": lighting.full_at_mm,
        "cosine": lighting.cosine,
        "turning": lighting.turning,
        "way": lighting.way,
    }
    return [{name: _plain(column[view].tolist()) for name, column in columns.items()} for view in range(len(views))]


def _plain(value: Any) -> Any:
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and math.isinf(value) else value


def _wanted(cube: Cube) -> list[str]:
    """The wanted pictures as data URIs, clear where nothing is wanted: exact ones, or where these are large, WebP."""
    images = []
    whole = np.tile(cube.views.picture_shape, (len(cube.names), 1))
    windows = whole if cube.lighting is None else cube.lighting.window
    for levels, (rows, columns) in zip([] if cube.targets is None else cube.targets, windows, strict=False):
        picture = levels[:rows, :columns]
        colours = np.broadcast_to(picture[..., :-1], (*picture.shape[:2], 3))
        images.append(Image.fromarray(np.dstack([colours, np.where(picture[..., -1:] > 0, 255, 0).astype(np.uint8)])))
    exact: list[str] = []
    for image in images:
        exact.append(_encoded(image, "png", optimize=True))
        if sum(map(len, exact)) > _EXACT:
            return [_encoded(each, "webp", quality=_QUALITY) for each in images]
    return exact


def _encoded(image: Image.Image, kind: str, **options: Any) -> str:
    stream = BytesIO()
    image.save(stream, kind, **options)
    return f"data:image/{kind};base64,{base64.b64encode(stream.getvalue()).decode()}"
