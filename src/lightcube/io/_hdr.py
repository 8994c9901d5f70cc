"""Films and pictures of high dynamic range and of wide colours, made ordinary: to sRGB with white at 203 nits."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from lightcube.io._frames import BT2020, Levels
from lightcube.optics.transfer import decode, to_uint16

Light = NDArray[np.floating]

#: Brightness of a white wall, in nits (ITU-R BT.2408).
_WHITE = 203.0
#: Codes of ITU-T H.273: of curves PQ and HLG, of primaries those of two cinemas.
_PQ, _HLG, _DCI_P3, _DISPLAY_P3 = 16, 18, 11, 12

#: From linear red, green and blue of other primaries to those of sRGB, with the same white.
_TO_SRGB = {
    BT2020: ((1.660491, -0.587641, -0.072850), (-0.124550, 1.132900, -0.008349), (-0.018151, -0.100579, 1.118730)),
    _DISPLAY_P3: ((1.224940, -0.224940, 0.0), (-0.042057, 1.042057, 0.0), (-0.019638, -0.078636, 1.098274)),
}
_TO_SRGB[_DCI_P3] = _TO_SRGB[_DISPLAY_P3]


def _pq(values: Light) -> Light:
    """Light of PQ (ITU-R BT.2100), 1 = white."""
    m1, m2, c1, c2, c3 = 2610 / 16384, 2523 / 32, 3424 / 4096, 2413 / 128, 2392 / 128
    power = values ** (1 / m2)
    return 10000 / _WHITE * (np.maximum(power - c1, 0) / (c2 - c3 * power)) ** (1 / m1)


def _hlg(values: Light) -> Light:
    """Light of HLG on a screen of 1000 nits (ITU-R BT.2100), 1 = white."""
    a, b, c = 0.17883277, 0.28466892, 0.55991073
    scene = np.where(values <= 0.5, values**2 / 3, (np.exp((values - c) / a) + b) / 12)
    brightness = scene @ np.array([0.2627, 0.6780, 0.0593])
    return 1000 / _WHITE * scene * brightness[..., None] ** 0.2


_CURVES: dict[int, tuple[str, Callable[[Light], Light]]] = {_PQ: ("PQ", _pq), _HLG: ("HLG", _hlg)}

#: Names of the curves of high dynamic range, by their codes.
HDR_CURVES = {code: name for code, (name, _) in _CURVES.items()}


def light_of(shown: Light, curve: int, primaries: int) -> Light:
    """Linear light of sRGB's colours, 1 = white, of display values ``(row, column, 3)`` with such a curve.

    Light up to white is as it was; what is brighter keeps its hue and is as bright as a screen can be.
    """
    light = _CURVES[curve][1](shown) if curve in _CURVES else decode(shown)
    wide = BT2020 if curve in _CURVES and primaries not in (1, *_TO_SRGB) else primaries
    if wide in _TO_SRGB:
        light = np.maximum(light @ np.array(_TO_SRGB[wide]).T, 0)
    return light / np.maximum(light.max(axis=2, keepdims=True), 1)


def curve_of(tagged: int, matrix: int | None, primaries: int, *, deep: bool) -> int:
    """The code of a film's curve, as it is `tagged`.

    A deep film in BT.2020 without a word about its curve is taken for PQ, the common one: what has BT.2020's colours
    and an ordinary curve is rare, and says so.
    """
    untold = tagged in (0, 2, 3) and deep and BT2020 in (matrix, primaries)
    return _PQ if untold else tagged


def converted(curve: int, primaries: int) -> str:
    """What is done to a film with such a curve and primaries, as part of a sentence; empty where nothing is."""
    if curve in _CURVES:
        name = _CURVES[curve][0]
        return f"is of high dynamic range (HDR, {name}): white is at {_WHITE:g} nits, what is brighter was dimmed"
    if primaries in _TO_SRGB:
        return "is of wide colours: they were brought into sRGB, what is outside was cut off"
    return ""


def ordinary(levels: Levels, curve: int, primaries: int) -> NDArray[np.uint16]:
    """Levels of a film of which `converted` has something to say, as levels of sRGB."""
    full = np.iinfo(levels.dtype).max
    colours = to_uint16(light_of(levels[..., :3] / np.float32(full), curve, primaries))
    opacity = np.rint(levels[..., 3:] * (65535 / full)).astype(np.uint16)
    return np.concatenate([colours, opacity], axis=2)
