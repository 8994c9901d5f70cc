"""Pictures as a project keeps them: small enough for a page, large enough for any wall."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from lightcube.io._files import system_errors
from lightcube.optics.transfer import decode
from lightcube.pictures.resampling import shares
from lightcube.studio.project import DROPPED, Crop, Project

#: Pixels along the longer side of a picture as it is kept: a wall has some hundred.
SIDE = 640


def dropped(project: Project, key: str) -> Path:
    """The file of a picture as it was dropped."""
    return project.path(DROPPED, f"{key}.png")


def box(crop: Crop, size: tuple[int, int]) -> tuple[int, int, int, int]:
    """Left, top, right and bottom of a crop in pixels of a picture of so many ``(columns, rows)``."""
    columns, rows = size
    left, top = min(round(crop.left * columns), columns - 1), min(round(crop.top * rows), rows - 1)
    right, bottom = round((crop.left + crop.width) * columns), round((crop.top + crop.height) * rows)
    return left, top, min(max(right, left + 1), columns), min(max(bottom, top + 1), rows)


def smaller(image: NDArray[np.float32], side: int = SIDE) -> NDArray[np.float32]:
    """Linear light, averaged over areas where it has more than `side` pixels along a side."""
    rows, columns = image.shape[:2]
    ratio = max(rows, columns) / side
    if ratio <= 1:
        return image
    down, across = (shares(count, max(1, round(count / ratio))) for count in (rows, columns))
    return np.stack([down @ image[..., channel] @ across.T for channel in range(3)], axis=-1).astype(np.float32)


def linear(file: Path, crop: Crop, side: int) -> NDArray[np.float32]:
    """What is taken of a dropped picture, in linear light, of at most so many pixels along a side."""
    with system_errors(file, "reading"), Image.open(file) as image:
        levels = np.asarray(image.convert("RGB").crop(box(crop, image.size)))
    return smaller(decode(levels.astype(np.float32) / np.float32(255)), side)


def png(levels: NDArray[np.uint8]) -> bytes:
    """A picture as a PNG."""
    stream = BytesIO()
    Image.fromarray(levels).save(stream, "png", compress_level=3)
    return stream.getvalue()
