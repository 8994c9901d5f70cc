"""What a page is told of a relief, in plain JSON, and its heights."""

from __future__ import annotations

import gzip
from typing import Any

import numpy as np
from PIL import Image

from lightcube.optics.transfer import to_uint8
from lightcube.scoring.reliefs import BLURS, score_relief
from lightcube.solids.relief import Relief
from lightcube.solids.relief_light import coloured
from lightcube.viewer.description import FORMAT, encoded
from lightcube.viewer.label import Label

#: What is to be seen, in words that the names of pictures can follow.
WHAT = "A white plate lies under a low lamp, and its shadows are pictures"


def describe_relief(relief: Relief, label: str | Label) -> dict[str, Any]:
    """The plate, where its lamps stand, and what was wanted of them."""
    label, recipe = Label.of(label), relief.recipe
    pictures = [Image.fromarray(to_uint8(picture)) for picture in coloured(relief, relief.wanted)]
    return {
        "format": FORMAT,
        "kind": "relief",
        "title": label.title,
        "by": label.by,
        "note": label.note,
        "columns": relief.heights_px.shape,
        "window": relief.wanted.shape[1:],
        "cell": relief.cell,
        "colours": relief.azimuths_deg if relief.is_colour else None,
        "elevation_deg": recipe.elevation_deg,
        "bounce": recipe.bounce,
        "pitch_mm": recipe.pitch_mm,
        "px_mm": recipe.px_mm,
        "base_mm": recipe.base_mm,
        "size_mm": relief.size_mm,
        "blurs": {**BLURS, "columns": 0.0},
        "pictures": _pictures(relief),
        "wanted": [encoded(picture, "png", optimize=True) for picture in pictures],
    }


def heights_data(relief: Relief) -> bytes:
    """The heights, gzipped float64, the lowest byte first."""
    return gzip.compress(np.ascontiguousarray(relief.heights_px, "<f8").tobytes(), 6, mtime=0)


def _pictures(relief: Relief) -> list[dict[str, Any]]:
    """One for each lamp; of three coloured lamps one."""
    scores = score_relief(relief)
    if relief.is_colour:
        name = relief.names[0].removesuffix(" red")
        return [_picture(name, 0.0, 0, scores["psnr_mean"], scores["near_psnr_mean"])]
    return [
        _picture(each["name"], each["azimuth_deg"], number, each["psnr"], each["near_psnr"])
        for number, each in enumerate(scores["pictures"])
    ]


def _picture(name: str, angle_deg: float, number: int, psnr: float, near_psnr: float) -> dict[str, Any]:
    """As of a cube's picture: its score is that of who looks from near by, as the page does at first."""
    place = {"name": name, "angle_deg": angle_deg, "screen": 0, "wanted": number, "mirrored": False}
    return {**place, "psnr": near_psnr, "far_psnr": psnr, "overlap": None}
