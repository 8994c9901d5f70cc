"""A wedge in a photograph: found by its marks, and read against the bare film around every patch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lightcube.calibration.wedge import HOLE, MARKS_MM, WINDOWS_MM, Patch, Wedge, bare_mm
from lightcube.errors import InputError
from lightcube.optics.arrays import Flags, Images, Reals
from lightcube.pictures.projective import homography, projected

#: Of a mark: how far from a square it may look, its least size in pixels, and by how many times, as a logarithm, its
#: holes may be larger or smaller.
_LONG, _SMALL, _UNLIKE = 2.5, 150, 1.0
#: Bare film is as bright as the brightest of a picture but for some per cent, and marks are darker than parts of it.
_BRIGHT, _THRESHOLDS = 85, (0.4, 0.6, 0.8)
#: Pixels a mm at least; light that is too much for a camera, and too little.
_FINE, _CLIPPED, _DARK = 3.0, 0.985, 0.0008
#: Parts of a patch and of a gap that are looked at, mm, and how many points across.
_INNER_MM, _GAP_MM, _POINTS = 7.0, 1.0, 32
#: So many of these points are too bright or too dark to count: dust, and noise that is cut off at black.
_TRIMMED = _POINTS**2 // 5
#: Bare places further than this from the smooth light of the others are dirty.
_DIRTY = 0.1


@dataclass(frozen=True, eq=False)
class Readings:
    """What patches let through.

    Parameters
    ----------
    wedge
        The page that was printed.
    patches
        Those that were read.
    light
        ``(patch, channel)``: their light as a part of that of bare film.
    base
        ``(channel,)``: absorbance of bare film, natural logarithm; None where it is not known.
    said
        What is to be known of the photograph, each a sentence.
    """

    wedge: Wedge
    patches: list[Patch]
    light: Reals
    base: Reals | None
    said: list[str]


def read_wedge(photo: Images, wedge: Wedge) -> Readings:
    """Read a photograph ``(row, column, channel)`` in linear light of a printed wedge, turned or mirrored as it may be.

    Raises
    ------
    InputError
        Where the marks are not found, the photograph is too coarse, or patches lie outside or are clipped.
    """
    place = homography(MARKS_MM, _marks(photo))
    said = ["the film was photographed from its other side, which makes no difference"] if _is_mirrored(place) else []
    fine = np.sqrt(np.abs(np.linalg.det(place[:2, :2] / place[2, 2])))
    if fine < _FINE:
        raise InputError(f"the page has {fine:.1f} pixels a mm in the photograph, and takes {_FINE:g}: go nearer")
    patches = wedge.patches
    middles = np.array([patch.middle_mm for patch in patches])
    shown = _sampled(photo, place, middles, _INNER_MM)
    _check_inside(wedge, shown)
    bare, kept = _bare(photo, place)
    light = shown / np.exp(_smooth(bare_mm()[kept], np.log(bare[kept]), middles))
    _check_clipped(wedge, shown, bare)
    said += _too_dark(wedge, shown)
    return Readings(wedge, patches, light, _base(photo, place, bare, kept), said)


def _marks(photo: Images) -> Reals:
    """``(4, 2)`` middles of the marks in pixels, x and y, in the order of their holes."""
    light = np.sqrt(photo.min(axis=2))
    bare, found = float(np.percentile(light, _BRIGHT)), dict[int, list[tuple[float, float, Reals]]]()
    for part in _THRESHOLDS:
        found = _with_holes(light < part * bare)
        if len(found) == len(MARKS_MM):
            break
    missing = [str(holes) for holes in range(1, len(MARKS_MM) + 1) if holes not in found]
    if missing:
        raise InputError(
            f"of the page's four corner marks, which have 1 to 4 holes, that with {missing[0]} is not found: "
            "photograph all of the page, sharp, before a light that is brighter than the room"
        )
    size = float(np.median([min(places, key=lambda each: each[0])[1] for places in found.values()]))
    best = [min(found[holes], key=lambda each: each[0] + abs(np.log(each[1] / size))) for holes in sorted(found)]
    return np.array([middle for *_, middle in best])


def _with_holes(dark: Flags) -> dict[int, list[tuple[float, float, Reals]]]:
    """Dark squares by their holes: how unlike a mark's these are, how large the square is, and its middle, x and y."""
    from skimage.measure import label, regionprops  # here: it takes long to load

    found: dict[int, list[tuple[float, float, Reals]]] = {}
    for region in regionprops(label(dark, connectivity=1)):
        if region.area < _SMALL or region.axis_minor_length * _LONG < region.axis_major_length:
            continue
        holes, filled = 1 - region.euler_number, float(region.area_filled)
        is_full = region.area == filled  # holes that touch the outside at a corner are none
        if is_full or not 1 <= holes <= len(MARKS_MM) or filled < 0.85 * region.area_convex:
            continue
        unlike = abs(float(np.log((1 - region.area / filled) / (holes * HOLE))))
        if unlike < _UNLIKE:
            middle = np.argwhere(region.image_filled).mean(axis=0) + region.bbox[:2]
            found.setdefault(holes, []).append((unlike, filled, middle[::-1]))
    return found


def _is_mirrored(place: Reals) -> bool:
    """Whether right of up is left in the picture."""
    corners = projected(place, MARKS_MM[:3])
    return bool(np.linalg.det(np.diff(corners, axis=0)) < 0)


def _sampled(photo: Images, place: Reals, middles_mm: Reals, side_mm: float) -> Reals:
    """``(middle, channel)``: mean light in squares about places of the page; NaN where they leave the picture."""
    steps = (np.arange(_POINTS) + 0.5) / _POINTS * side_mm - side_mm / 2
    grid = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    points = np.rint(projected(place, middles_mm[:, None] + grid)).astype(int)
    inside = np.all((points >= 0) & (points < photo.shape[1::-1]), axis=(1, 2))
    x, y = np.where(inside[:, None, None], points, 0).transpose(2, 0, 1)
    light = np.sort(photo[y, x].astype(np.float64), axis=1)[:, _TRIMMED:-_TRIMMED].mean(axis=1)
    return np.where(inside[:, None], light, np.nan)


def _bare(photo: Images, place: Reals) -> tuple[Reals, Flags]:
    """Light in the gaps between patches, and which of these places are bare film and clean."""
    places = bare_mm()
    shown = _sampled(photo, place, places, _GAP_MM)
    kept = np.all(shown > 0, axis=1)
    for _ in range(3):
        if kept.sum() < 20:
            raise InputError("too little of the page's bare film is seen: photograph all of it, before an even light")
        off = np.abs(np.log(np.maximum(shown, 1e-9)) - _smooth(places[kept], np.log(shown[kept]), places))
        kept &= np.all(off < _DIRTY, axis=1)
    return shown, kept


def _smooth(known_mm: Reals, values: Reals, places_mm: Reals) -> Reals:
    """A polynomial of the third degree through values at places, elsewhere: light is even, but for its slow changes."""

    def terms(at_mm: Reals) -> Reals:
        x, y = ((at_mm - 100) / 100).T
        return np.stack([x**i * y**j for i in range(4) for j in range(4 - i)], axis=1)

    return np.asarray(terms(places_mm) @ np.linalg.lstsq(terms(known_mm), values, rcond=None)[0])


def _check_inside(wedge: Wedge, shown: Reals) -> None:
    outside = np.flatnonzero(np.isnan(shown[:, 0]))
    if outside.size:
        called = wedge.called(wedge.patches[outside[0]])
        raise InputError(f"{called} is not in the photograph: photograph all of the page")


def _check_clipped(wedge: Wedge, shown: Reals, bare: Reals) -> None:
    clipped = np.flatnonzero(shown.max(axis=1) > _CLIPPED)
    if clipped.size or np.nanmedian(bare, axis=0).max() > _CLIPPED:
        called = wedge.called(wedge.patches[clipped[0]]) if clipped.size else "bare film"
        raise InputError(f"{called} is as bright as the photograph can be: expose it less, and leave it as it is")


def _too_dark(wedge: Wedge, shown: Reals) -> list[str]:
    alone = np.array([sum(part > 0 for part in patch.coverages) == 1 for patch in wedge.patches])
    dark = np.flatnonzero((shown.min(axis=1) < _DARK) & alone)
    if not dark.size:
        return []
    called = wedge.called(wedge.patches[dark[0]])
    return [f"{called} is darker than the photograph can tell: what is fitted there is a least density"]


def _base(photo: Images, place: Reals, bare: Reals, kept: Flags) -> Reals | None:
    """Absorbance of bare film, by the windows that were cut into it; None where there are none."""
    light = _sampled(photo, place, WINDOWS_MM, _INNER_MM)
    around = np.exp(_smooth(bare_mm()[kept], np.log(bare[kept]), WINDOWS_MM))
    absorbed = np.log(light / around)
    open_ = np.all(np.isfinite(absorbed), axis=1) & np.all(light < _CLIPPED, axis=1) & (absorbed.max(axis=1) > 0.005)
    return np.maximum(absorbed[open_].mean(axis=0), 0) if open_.any() else None
