"""ICC profiles of tables, as printers and scanners have them, through LittleCMS, which reads 8 bits here."""

from collections.abc import Callable
from io import BytesIO
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageCms

from lightcube.io._samples import Samples, full_of

#: Levels ``(row, column)`` or ``(row, column, sample)`` of a picture's own colours to levels of sRGB.
Turn: TypeAlias = Callable[[Samples], NDArray[np.uint8]]


def turn_of_profile(data: bytes | None, mode: Literal["L", "RGB", "CMYK"]) -> Turn | None:
    """What a profile makes of grey, RGB or inks; None where it is damaged, or is not for those.

    White stays white and black becomes black (relative colorimetric, black point compensation).
    """
    try:
        transform = ImageCms.buildTransform(
            ImageCms.ImageCmsProfile(BytesIO(data or b"")),
            ImageCms.createProfile("sRGB"),
            mode,
            "RGB",
            renderingIntent=ImageCms.Intent.RELATIVE_COLORIMETRIC,
            flags=ImageCms.Flags.BLACKPOINTCOMPENSATION,
        )
    except (ImageCms.PyCMSError, OSError, TypeError):
        return None

    def turn(levels: Samples) -> NDArray[np.uint8]:
        whole = np.rint(levels * np.float32(255 / full_of(levels))).astype(np.uint8)
        rows, columns = whole.shape[:2]
        image = Image.frombytes(mode, (columns, rows), whole.tobytes())
        return np.asarray(ImageCms.applyTransform(image, transform))

    return turn
