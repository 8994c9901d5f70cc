"""A frame of a film as levels: its own matrix and range named, its pixels made square, turned as the film says."""

from fractions import Fraction
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import av

#: ``(row, column, 3 or 4)`` in uint8 or uint16; a fourth channel is the opacity.
Levels = NDArray[np.uint8] | NDArray[np.uint16]

#: Codes of ITU-T H.273, as they are tagged and as the scaler has them: one for both kinds of BT.601 and of BT.2020.
BT709, UNSPECIFIED, BT601, BT2020 = 1, 2, 5, 9
NARROW, FULL = 1, 2
_MATRICES = {1: BT709, 4: 4, 5: BT601, 6: BT601, 7: 7, 9: BT2020, 10: BT2020}
_UNTAGGED = (UNSPECIFIED, 3)
#: Films that do not say it are BT.709 where they are larger than television was before.
_LARGEST_601 = (576, 1279)

#: Flags of the scaler. Colours of half the resolution are means over their pixels when they are written, and repeated,
#: not blended with their neighbours, when they are read: so squares of pixels stay what they are.
AVERAGING, _REPEATING, _BICUBIC = 0x20 | 0x2000 | 0x40000, 0x10, 0x4 | 0x2000 | 0x4000 | 0x40000


def levels_of(frame: "av.VideoFrame", shape: tuple[int, int] | None = None) -> Levels:
    """Levels of a decoded frame with as many bits and channels as it has, resampled to a `shape`, its own if None."""
    deep = max(part.bits for part in frame.format.components) > 8
    alpha = any(part.is_alpha for part in frame.format.components)
    wanted = ("rgba" if alpha else "rgb") + (("64le" if alpha else "48le") if deep else ("" if alpha else "24"))
    rows, columns = shape or (frame.height, frame.width)
    matrix, full = matrix_of(frame), _range_of(frame)
    # Curves and primaries are not the scaler's business: it would change colours as it sees fit.
    frame.color_trc = frame.color_primaries = UNSPECIFIED
    if matrix is not None:
        frame.colorspace = matrix
    shown = frame.reformat(
        columns,
        rows,
        wanted,
        src_colorspace=matrix,
        dst_colorspace=matrix,
        interpolation=_BICUBIC if shape not in (None, (frame.height, frame.width)) else _REPEATING,
        src_color_range=full,
        dst_color_range=FULL,
    )
    levels = shown.to_ndarray()
    return levels.astype(np.uint16, copy=False) if deep else levels.astype(np.uint8, copy=False)


def matrix_of(frame: "av.VideoFrame") -> int | None:
    """The matrix from a frame's brightness and two colours to red, green and blue: as tagged, or else by its size.

    None where it has red, green and blue already.
    """
    if frame.format.is_rgb or len(frame.format.components) < 3:
        return None
    if frame.colorspace in _MATRICES:
        return _MATRICES[frame.colorspace]
    if frame.color_primaries == BT2020:
        return BT2020
    large = frame.height > _LARGEST_601[0] or frame.width > _LARGEST_601[1]
    return BT709 if large and not _is_jpeg(frame) else BT601


def is_known(frame: "av.VideoFrame") -> bool:
    """Whether a frame's matrix is one that the scaler has, or is not told."""
    return frame.format.is_rgb or frame.colorspace in (*_MATRICES, *_UNTAGGED)


def _range_of(frame: "av.VideoFrame") -> int | None:
    """Whether black is 0 or 16: as tagged; RGB and JPEG's formats are full, others narrow; None = the scaler knows."""
    if frame.format.is_rgb or _is_jpeg(frame):
        return FULL
    if frame.color_range in (NARROW, FULL):
        return frame.color_range
    return NARROW if len(frame.format.components) > 2 else None


def _is_jpeg(frame: "av.VideoFrame") -> bool:
    return frame.format.name.startswith("yuvj")


def square(frame: "av.VideoFrame", aspect: Fraction | None) -> tuple[int, int]:
    """Rows and columns of a frame whose pixels are `aspect` times as wide as high, once they are square."""
    if not aspect or aspect <= 0:
        return frame.height, frame.width
    ratio = float(aspect)
    return round(frame.height * max(1.0, 1 / ratio)), round(frame.width * max(1.0, ratio))


def turned(levels: Levels, frame: "av.VideoFrame") -> Levels:
    """`levels` turned by quarters and mirrored as the frame's display matrix says."""
    matrix = frame.side_data.get("DISPLAYMATRIX")
    if matrix is None:
        return levels
    # x goes to a x + c y, y to b x + d y, y down.
    a, b, _, c, d = np.frombuffer(bytes(cast("memoryview", matrix)), np.int32)[:5].tolist()
    if abs(b) + abs(c) > abs(a) + abs(d):
        levels, a, d = levels.transpose(1, 0, 2), c, b
    return levels[:: -1 if d < 0 else 1, :: -1 if a < 0 else 1]
