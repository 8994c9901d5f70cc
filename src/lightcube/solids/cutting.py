"""Pictures cut out: what of each is the shape and what is ground, and how that was told."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.optics.arrays import Flags, Floats, Images, keep
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.transfer import encode
from lightcube.pictures.pictures import Pictures

#: How the shape of a picture was told from its ground.
By = Literal["opacity", "dark", "light"]

#: Display grey of linear light's three colours (ITU-R BT.709).
_LUMA = np.array([0.2126, 0.7152, 0.0722], np.float32)
#: Alpha tells the shape where so much of a picture, at least, is more transparent than not.
_TRANSPARENT = 0.005
#: Levels nearer to the threshold than this part of the way between shape and ground are near it.
_NEAR = 0.2
#: Pieces and holes of less than this part of the shape, and of so many pixels at most, are dirt.
_SPECK, _MOST_SPECK = 1 / 1000, 64
#: Shape and ground whose greys are nearer to each other than this are one.
_SAME_GREY = 0.02
#: So much of the border, at least, shows the ground where it is beyond doubt.
_PLAIN = 0.8


@dataclass(frozen=True, eq=False)
class Cut:
    """A picture's shape.

    Parameters
    ----------
    name
        Of the picture.
    coverage
        ``(row, column)``: how much of each pixel is shape, 0 to 1; above 0.5 it is inside.
    by
        Whether its opacity told it, or that it is darker or lighter than its ground.
    threshold
        The opacity or grey, as a part of white in display values, between shape and ground.
    near
        Which part of the pixels is so near to the threshold that it may be of the other side: noise, or soft edges.
    specks
        How many small pieces and holes were taken for dirt and removed.
    border
        Which part of the picture's border the shape covers.
    kept
        ``(row, column)``: above 0.5 what is there stays where it is when pictures are bent, if it can; None = nothing.
    """

    name: str
    coverage: Images
    by: By
    threshold: float
    near: float
    specks: int
    border: float
    kept: Images | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        keep(self, coverage=np.float32, kept=np.float32)
        if self.kept is not None and self.kept.shape != self.coverage.shape:
            raise InputError(
                f"what is kept of {self.name} has shape {self.kept.shape}, not {self.coverage.shape} as its picture"
            )

    def __repr__(self) -> str:
        rows, columns = self.coverage.shape
        return f"<{self.name}: a shape of {rows} x {columns} pixels by {self.by}, threshold {self.threshold:.2f}>"

    @property
    def inside(self) -> Flags:
        """``(row, column)``: the shape's pixels."""
        return self.coverage > 0.5

    def mirrored(self) -> Cut:
        """The same, left and right exchanged."""
        return self._moved(lambda each: each[:, ::-1])

    def turned(self, quarters: int) -> Cut:
        """The same, turned counter-clockwise by so many quarters."""
        return self._moved(lambda each: np.rot90(each, quarters))

    def trimmed(self) -> Cut:
        """The same without the rows and columns around the shape that are empty."""
        inside = self.inside
        rows, columns = (np.flatnonzero(inside.any(axis=axis)) for axis in (1, 0))
        return self._moved(lambda each: each[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1])

    def _moved(self, way: Callable[[Images], Images]) -> Cut:
        """The same, its pixels moved."""
        return replace(
            self, coverage=way(self.coverage).copy(), kept=None if self.kept is None else way(self.kept).copy()
        )


@checked
def cut(pictures: Pictures, *, threshold: float | None = None, invert: bool | None = None) -> tuple[Cut, ...]:
    """Cut every picture out of its ground.

    Parameters
    ----------
    threshold
        Between shape and ground, a part of white in display values from 0 to 1, of opacity where that tells them apart;
        default half way between the greys of the two sides that N. Otsu's threshold makes of a picture, and 0.5 of
        opacity.
    invert
        Whether the light part of a picture is the shape; default that part which covers less of its border. Of a
        picture that is cut by opacity, whether what is transparent is the shape.

    Raises
    ------
    InputError
        Where a picture is all shape or all ground.

    Examples
    --------
    >>> import numpy as np
    >>> import lightcube as lc
    >>> disc = np.hypot(*np.mgrid[-4:5, -4:5]) < 3
    >>> drawn = lc.Pictures((np.where(disc[..., None], 0.1, [1.0, 1.0, 1.0]),), ("disc",))
    >>> (one,) = lc.cut(drawn)
    >>> one.by, int(one.inside.sum())
    ('dark', 25)
    """
    if threshold is not None and not 0 < threshold < 1:
        raise InputError(f"a threshold between shape and ground lies between 0 and 1, not {threshold:g}")
    opacities = pictures.opacities or (None,) * len(pictures)
    return tuple(
        _cut(name, image, opacity, pictures, threshold, invert)
        for name, image, opacity in zip(pictures.names, pictures.images, opacities, strict=True)
    )


def _cut(
    name: str,
    image: Images,
    opacity: Images | None,
    pictures: Pictures,
    threshold: float | None,
    invert: bool | None,
) -> Cut:
    """One picture's shape."""
    if not np.all(np.isfinite(image)):
        raise InputError(f"picture {name} holds NaN or infinities: mend it")
    by_opacity = opacity is not None and float(np.mean(opacity < 0.5)) >= _TRANSPARENT and bool(np.any(opacity >= 0.5))
    if by_opacity and opacity is not None:
        grey, at = 1 - opacity, 0.5 if threshold is None else 1 - threshold
        light_shape = bool(invert)
    else:
        grey = encode(np.clip(image @ _LUMA, 0, 1), pictures.transfer)
        if float(np.ptp(grey)) < _SAME_GREY:
            raise InputError(f"picture {name} is of one grey, and shows no shape: give a shape on a plain ground")
        at = _between(grey) if threshold is None else threshold
        light_shape = _is_light_shape(grey, at) if invert is None else invert
    low, high = (0.0, 1.0) if by_opacity else _sides(grey, at)
    coverage = _coverage(grey, at, low, high, light=light_shape)
    inside = coverage > 0.5
    if not np.any(inside) or np.all(inside):
        what = "ground" if not np.any(inside) else "shape"
        raise InputError(
            f"picture {name} is all {what} at a threshold of {at:.2f}: give another --threshold, or --invert"
        )
    specks = _without_specks(coverage)
    return Cut(
        name,
        coverage,
        "opacity" if by_opacity else "light" if light_shape else "dark",
        1 - at if by_opacity else at,
        float(np.mean(np.abs(coverage - 0.5) < _NEAR / 2)),
        specks,
        float(np.mean(_border(inside))),
    )


def _between(grey: Floats) -> float:
    """Half way between the usual greys of the two sides that N. Otsu's threshold (1979) makes."""
    from skimage.filters import threshold_otsu  # here: scipy comes with it

    return sum(_sides(grey, float(threshold_otsu(grey)))) / 2


def _sides(grey: Floats, at: float) -> tuple[float, float]:
    """The usual grey of what is dark and of what is light, however many soft edges there are."""
    darker = grey <= at
    low = float(np.median(grey[darker])) if np.any(darker) else 0.0
    return low, float(np.median(grey[~darker])) if not np.all(darker) else 1.0


def _border(picture: Flags) -> Flags:
    """The pixels along a picture's border, each once."""
    if min(picture.shape) < 3:
        return picture.ravel()
    return np.concatenate([picture[0], picture[-1], picture[1:-1, 0], picture[1:-1, -1]])


def _is_light_shape(grey: Floats, at: float) -> bool:
    """Whether what is lighter covers less of the border than what is darker."""
    return float(np.mean(_border(np.asarray(grey > at)))) < 0.5


def _coverage(grey: Floats, at: float, low: float, high: float, *, light: bool) -> NDArray[np.float32]:
    """How much of each pixel is shape: 0.5 at the threshold, 0 and 1 at the two sides' own greys."""
    below, above = max(at - low, 1e-6), max(high - at, 1e-6)
    share = np.where(grey <= at, 0.5 - (at - grey) / (2 * below), 0.5 + (grey - at) / (2 * above))
    share = np.clip(share, 0, 1)
    made = share if light else 1 - share
    return np.ascontiguousarray(made, np.float32)


def _without_specks(coverage: NDArray[np.float32]) -> int:
    """Remove from a coverage pieces and holes that are dirt; how many there were."""
    from scipy import ndimage  # here: whoever cuts nothing does without

    inside = coverage > 0.5
    most = min(_MOST_SPECK, math.floor(_SPECK * np.count_nonzero(inside)))
    removed = 0
    for side, ground in ((inside, 0.0), (~inside, 1.0)):
        numbers, count = ndimage.label(side, np.ones((3, 3)) if ground == 0 else None)
        sizes = np.bincount(numbers.ravel(), minlength=count + 1)
        small = (sizes <= most) & (np.arange(count + 1) > 0)
        if np.any(small):
            coverage[small[numbers]] = ground
            removed += int(np.count_nonzero(small))
    return removed


def plain_ground(one: Cut) -> bool:
    """Whether it is beyond doubt which side is the ground."""
    return one.by == "opacity" or one.border <= 1 - _PLAIN
