"""From pictures of any sizes to what is wanted on a screen: cropping, resampling in linear light."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Literal, get_args

import numpy as np
from PIL import Image

from lightcube.errors import InputError
from lightcube.optics.arrays import Images, Levels, locked
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.optics.rig import Rig
from lightcube.optics.transfer import from_levels, to_uint16
from lightcube.pictures.pictures import Pictures
from lightcube.pictures.targets import Targets
from lightcube.wording import counted

Fit = Literal["crop", "pad", "stretch"]
Picture = Images

#: Shapes of pictures are told as so many parts high at most; they are nearly that by this part of it.
_HIGHEST, _NEARLY = 16, 0.01


def check_fit(name: str) -> Fit:
    """Return `name` as a `Fit`, or raise `InputError` naming what is allowed."""
    for known in get_args(Fit):
        if name == known:
            return known
    raise InputError(f"unknown fit {name!r}: use one of {', '.join(get_args(Fit))}")


@checked
def fit(pictures: Pictures, rig: Rig, ways: Fit | Sequence[Fit] = "crop") -> Targets:
    """Fit pictures to the screens of a rig, one each.

    Parameters
    ----------
    ways
        What happens to a picture of another aspect than its screen's, of all or of each: ``"crop"`` cuts its edges off,
        evenly on both sides of the pictures' focus, as far as that can be; ``"pad"`` keeps all of it, and the rest is
        white and don't care (weight 0); ``"stretch"`` changes its aspect.

    Returns
    -------
    Targets as large as the rig's pictures; what lies beside a screen is white and don't care. They are resampled in
    linear light with a Lanczos filter of three lobes, widened where pictures shrink, and never leave the range of
    values of the picture. A picture that has that size already stays as it is.

    Raises
    ------
    InputError
        Where there is not one picture, and one way to fit it, for each picture of the rig.

    Examples
    --------
    >>> import numpy as np, lightcube as lc
    >>> rig = lc.turntable(lc.Grid((6, 8, 8)), [45, 225], elevation_deg=35, picture_shape=(4, 4))
    >>> lc.fit(lc.Pictures([np.full((4, 6, 3), level) for level in (0.2, 0.8)], ("dark", "pale")), rig)
    <2 pictures wanted on <rig of 2 pictures of 4 x 4 pixels, 2 views>>
    """
    fits = [ways] * len(pictures) if isinstance(ways, str) else list(ways)
    if not len(pictures) == len(fits) == len(rig):
        raise InputError(
            f"{counted(len(pictures), 'picture')} and {len(fits)} ways to fit them for {len(rig)} on the screens: "
            "give one of each"
        )
    fitted = np.ones((len(pictures), *rig.picture_shape, 3), np.float32)
    weights = np.zeros(fitted.shape[:3], np.float32)
    for p, (image, (rows, columns), way) in enumerate(zip(pictures.images, rig.stops.window, fits, strict=True)):
        fill(fitted[p, :rows, :columns], weights[p, :rows, :columns], image, check_fit(way), pictures.focus)
    return Targets(locked(fitted), rig, locked(weights), pictures.names, pictures.transfer)


def fit_report(pictures: Pictures, targets: Targets, ways: Fit | Sequence[Fit] = "crop") -> str:
    """Say in one line, without a full stop, what `fit` did to the pictures; sizes are width x height."""
    target = targets.rig.picture_shape
    sizes = [(image.shape[0], image.shape[1]) for image in pictures.images]
    count = counted(len(pictures), "picture")
    if set(sizes) == {target}:
        return f"{count} of {said_sizes([target])}, not resampled"
    scaled = f"{count}, scaled from {said_sizes(sizes)} to {said_sizes([target])}"
    if not any(_is_other_shape(size, target) for size in sizes):
        return scaled
    words = {"crop": "cropped", "pad": "padded", "stretch": "stretched"}
    did = {words[check_fit(way)] for way in ([ways] if isinstance(ways, str) else ways)}
    return f"{scaled}, {' or '.join(sorted(did))} to the shape of {pictures.names[0]}, {_aspect(sizes[0])}"


def cut_off(pictures: Pictures, targets: Targets) -> list[float]:
    """Which part of its area each picture loses where it is cropped, 0 to 1, as they were read."""
    parts = []
    for image in pictures.images:
        size = image.shape[:2]
        left, top, right, bottom = source_box(size, targets.rig.picture_shape, "crop", pictures.focus)
        parts.append(1 - (right - left) * (bottom - top) / math.prod(size))
    return parts


def said_sizes(shapes: Sequence[tuple[int, int]]) -> str:
    """``(rows, columns)`` as people say them, width x height: the first, and how many others there are."""
    others = len(set(shapes)) - 1
    rows, columns = shapes[0]
    more = f" and {counted(others, 'other size')}" if others else ""
    return f"{columns} x {rows} pixels{more}"


def as_levels(targets: Targets) -> Levels:
    """Targets as 16-bit display levels ``(view, row, column, channel + 1)``, the last channel the weight.

    Weights are scaled so that the largest is 65535; none that is above 0 becomes 0.
    """
    most = float(targets.weight.max())
    made = np.empty((*targets.pictures.shape[:3], targets.pictures.shape[3] + 1), np.uint16)
    for levels, picture, weight in zip(
        made, targets.pictures, targets.weight, strict=True
    ):  # one by one, for the memory
        levels[..., :-1] = to_uint16(picture, targets.transfer)
        levels[..., -1] = np.where(weight > 0, np.maximum(np.rint(weight.astype(np.float64) / most * 65535), 1), 0)
    return made


def targets_of(cube: Cube) -> Targets:
    """Return the targets that `cube` was made for, from its 16-bit targets; `InputError` where it has none."""
    if cube.targets is None:
        raise InputError("this cube was not made from pictures, so it has no targets: give the pictures themselves")
    pictures = from_levels(cube.targets[..., :-1], cube.transfer)
    weights = cube.targets[..., -1].astype(np.float32) / np.float32(65535)
    return Targets(locked(pictures), cube.rig, locked(weights), cube.names, cube.transfer)


def source_box(
    size: tuple[int, ...], target: tuple[int, ...], mode: Fit, focus: tuple[float, float]
) -> tuple[float, float, float, float]:
    """``(left, top, right, bottom)`` of the part of a picture of `size` (rows, columns) that is shown.

    Of a cropped one `focus` is in its middle, or as near to it as the picture's edges allow.
    """
    rows, columns = size
    wide, high = float(columns), float(rows)
    if mode == "crop" and columns * target[0] != rows * target[1]:
        aspect = target[1] / target[0]
        wide, high = min(wide, high * aspect), min(high, wide / aspect)
    left = min(max(focus[0] * columns - wide / 2, 0.0), columns - wide)
    top = min(max(focus[1] * rows - high / 2, 0.0), rows - high)
    return left, top, min(left + wide, columns), min(top + high, rows)


def cropped(image: Picture, shape: tuple[int, int], focus: tuple[float, float] = (0.5, 0.5)) -> Picture:
    """A picture at `shape` (rows, columns), what is too wide or too high cut off around `focus`, as `fit` does it."""
    return _resample(image, shape, source_box(image.shape[:2], shape, "crop", focus))


def _inside(size: tuple[int, ...], target: tuple[int, int], mode: Fit) -> tuple[slice, slice]:
    """Rows and columns of the screen that the picture fills, in its middle."""
    if mode != "pad":
        return slice(None), slice(None)
    scale = min(target[0] / size[0], target[1] / size[1])
    spans = []
    for whole, part in zip(target, size, strict=True):
        # An even rest keeps the picture exactly in the middle.
        rest = min(max(2 * round((whole - part * scale) / 2), 0), 2 * math.ceil(whole / 2) - 2)
        spans.append(slice(rest // 2, whole - rest // 2))
    return spans[0], spans[1]


def fill(area: Picture, weight: Picture, image: Picture, mode: Fit, focus: tuple[float, float]) -> None:
    """Put `image` into `area`, both ``(row, column, channel)``, and 1 into `weight` where it lies."""
    size, shape = image.shape[:2], (area.shape[0], area.shape[1])
    inside = _inside(size, shape, mode)
    area[inside] = _resample(image, area[inside].shape[:2], source_box(size, shape, mode, focus))
    weight[inside] = 1


def _resample(image: Picture, shape: tuple[int, ...], box: tuple[float, float, float, float]) -> Picture:
    """Part `box` of `image` at `shape` (rows, columns); the very values where nothing changes size."""
    rows, columns, _ = image.shape
    if shape == (rows, columns) and box == (0.0, 0.0, float(columns), float(rows)):
        return image
    planes = []
    for plane in np.moveaxis(image, 2, 0):
        source = Image.fromarray(np.ascontiguousarray(plane, dtype=np.float32))
        resized = np.asarray(source.resize((shape[1], shape[0]), Image.Resampling.LANCZOS, box=box))
        planes.append(np.clip(resized, plane.min(), plane.max()))
    return np.stack(planes, axis=2)


def _is_other_shape(size: tuple[int, int], target: tuple[int, int]) -> bool:
    """Whether pictures of `size`, ``(rows, columns)``, are shaped otherwise, by a pixel at least: less is rounding."""
    rows, columns = target
    high, wide = columns * size[0] / size[1], rows * size[1] / size[0]
    return min(abs(high - rows), abs(wide - columns)) >= 1


def _aspect(shape: tuple[int, int]) -> str:
    """The shape of a picture of ``(rows, columns)`` as photographers say it: a square, 3:2, 9:16; nearly, about 3:2."""
    ratio = Fraction(shape[1], shape[0])
    near = (Fraction(round(ratio * high), high) for high in range(1, _HIGHEST + 1))
    simple = next((each for each in near if abs(each / ratio - 1) <= _NEARLY), None)
    if simple is None:
        return f"{float(ratio):.3g}:1"
    about = "" if simple == ratio else "about "
    return f"{about}{'a square' if simple == 1 else f'{simple.numerator}:{simple.denominator}'}"
