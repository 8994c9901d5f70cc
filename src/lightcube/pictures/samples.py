"""Photographs to try things with: those that come with scikit-image."""

from collections.abc import Callable

import numpy as np
import skimage.data
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.optics.transfer import decode
from lightcube.pictures.pictures import Pictures

#: Pictures that come with scikit-image.
_PHOTOGRAPHS: dict[str, Callable[[], NDArray[np.uint8]]] = {
    "astronaut": skimage.data.astronaut,
    "moon": skimage.data.moon,
    "coffee": skimage.data.coffee,
    "brick": skimage.data.brick,
    "cat": skimage.data.chelsea,
    "rocket": skimage.data.rocket,
    "clock": skimage.data.clock,
    "retina": skimage.data.retina,
    "tissue": skimage.data.immunohistochemistry,
    "camera": skimage.data.camera,
    "coins": skimage.data.coins,
    "stars": skimage.data.hubble_deep_field,
    "grass": skimage.data.grass,
    "colours": skimage.data.colorwheel,
    "gravel": skimage.data.gravel,
    "cell": skimage.data.cell,
}


def photographs(count: int = 16, aspect: float = 1.0) -> Pictures:
    """Unrelated photographs that come with scikit-image, as many as asked for (at most 64), cut to one aspect.

    The first sixteen are whole photographs, cut evenly on both sides to `aspect` (width / height). More than sixteen
    are parts of these: up to 32 their halves, left then right (upright ones: upper then lower), up to 64 their
    quarters, each cut evenly too. All first parts come before all second ones, so neighbours are unrelated.
    """
    if not 1 <= count <= 64:
        raise InputError(f"there are 1 to 64 photographs, not {count}")
    parts = next(parts for parts in (1, 2, 4) if count <= parts * len(_PHOTOGRAPHS))
    images, names = [], []
    for part in range(parts):
        for name, read in _PHOTOGRAPHS.items():
            image = np.atleast_3d(read())[..., :3].astype(np.float32) / 255
            cut = _part(np.broadcast_to(image, (*image.shape[:2], 3)), part, parts)
            high, wide = cut.shape[:2]
            size = min(high, int(wide / aspect)), min(wide, int(high * aspect))
            top, left = (high - size[0]) // 2, (wide - size[1]) // 2
            light = decode(cut[top : top + size[0], left : left + size[1]])
            images.append(np.ascontiguousarray(light, dtype=np.float32))
            names.append(name if parts == 1 else f"{name}-{part + 1}")
    return Pictures(tuple(images[:count]), tuple(names[:count]))


def _part(image: NDArray[np.float32], part: int, parts: int) -> NDArray[np.float32]:
    """One of 1, 2 or 4 equal parts of a picture."""
    high, wide = image.shape[:2]
    down, across = {1: (1, 1), 2: (1, 2) if wide >= high else (2, 1), 4: (2, 2)}[parts]
    row, column = divmod(part, across)
    return image[row * high // down : (row + 1) * high // down, column * wide // across : (column + 1) * wide // across]
