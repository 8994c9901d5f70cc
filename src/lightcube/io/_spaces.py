"""Colours that are not sRGB: of ICC profiles, of PNG's chunks, and of cameras' Adobe RGB."""

import struct
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from io import BytesIO

import numpy as np
from numpy.typing import NDArray
from PIL import ImageCms

from lightcube.io._hdr import HDR_CURVES, light_of
from lightcube.io._samples import LIGHT_OF_XYZ
from lightcube.io._tables import Turn, turn_of_profile
from lightcube.optics.transfer import decode, encode

_Light = NDArray[np.float32]
_Curve = Callable[[_Light], _Light]
_Places = tuple[tuple[float, float], ...]

#: Red, green, blue and white of ITU-T H.273, by number, as x and y; and what the curves of its numbers are.
_WHITE_D65 = (0.3127, 0.3290)
_PRIMARIES = {
    1: ("BT.709", ((0.640, 0.330), (0.300, 0.600), (0.150, 0.060))),
    9: ("BT.2020", ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046))),
    12: ("Display P3", ((0.680, 0.320), (0.265, 0.690), (0.150, 0.060))),
}
_ADOBE = ((0.640, 0.330), (0.210, 0.710), (0.150, 0.060))
_ADOBE_GAMMA = 563 / 256
#: What PNG's gAMA says of pictures that are nearly or wholly sRGB, and how far others are off at least, of 100000.
_GAMMA_SRGB, _GAMMA_OFF = 45455, 1000
#: From X, Y, Z to how eyes see them under another white (Bradford).
_CONES = np.array([(0.8951, 0.2664, -0.1614), (-0.7502, 1.7135, 0.0367), (0.0389, -0.0685, 1.0296)])
_H273_LINEAR, _H273_SRGB, _H273_VIDEO = 8, 13, (1, 6, 14, 15)
#: What stands before the numbers in a container of pictures (ISO 14496-12, 12.1.5).
_NUMBERS = b"colrnclx"
#: The tags of tables to colours that all devices share, and what is said of them.
_TABLES, _IN_8_BITS = {b"A2B0", b"A2B1", b"A2B2"}, ", in 8 bits"
#: Less than one level of 8 bits from sRGB is sRGB.
_SAME = 1 / 255


@dataclass(frozen=True)
class Space:
    """How display values become linear light of sRGB's colours: by curves and a matrix, or as a `whole`.

    Without either it is not known, and taken as sRGB.
    """

    name: str
    curves: tuple[_Curve, ...] | None = None
    matrix: NDArray[np.float64] | None = None
    whole: _Curve | None = None

    @property
    def is_known(self) -> bool:
        """Whether these colours can be turned into sRGB."""
        return self.curves is not None or self.whole is not None

    def light(self, display: _Light) -> _Light:
        """Linear light of display values ``(row, column, 3)``; what sRGB has no colour for is clipped."""
        if self.whole is not None:
            return self.whole(display).astype(np.float32)
        if self.curves is None:
            return decode(display).astype(np.float32, copy=False)
        light = np.stack([curve(display[..., at]) for at, curve in enumerate(self.curves)], axis=-1)
        mixed = light if self.matrix is None else light @ self.matrix.T
        return np.clip(mixed, 0, 1).astype(np.float32)


def space_of_profile(data: bytes | None, *, inks: bool = False) -> Space | None:
    """Return the colours of an ICC profile; None where there is none, or it is sRGB.

    Of pictures in `inks` they are those that `turn_of_profile` has made sRGB of.
    """
    if not data:
        return None
    try:
        data = bytes(data)  # what a damaged tag holds may be anything
        name = ImageCms.ImageCmsProfile(BytesIO(data)).profile.profile_description or "no name"
        if inks:
            return Space(f"{name.strip()}{_IN_8_BITS}", whole=decode) if turn_of_profile(data, "CMYK") else Space(name)
        tags = _tags(data)
        if _TABLES & set(tags):
            return _space_of_tables(name.strip(), data)
        return _space_of_tags(name.strip(), data[16:20], tags)
    except (OSError, LookupError, ValueError, TypeError, struct.error):
        return Space("a damaged profile")


def _space_of_tables(name: str, data: bytes) -> Space | None:
    """Return the colours of a profile that has tables: they go before curves and a matrix (ICC.1:2022, 8.2)."""
    grey = data[16:20] == b"GRAY"
    turn = turn_of_profile(data, "L" if grey else "RGB")
    if turn is None:
        return Space(name)
    space = Space(f"{name}{_IN_8_BITS}", whole=partial(_turned, turn, grey))
    return None if _is_srgb(space) else space


def _turned(turn: Turn, grey: bool, display: _Light) -> _Light:
    """Light of display values by tables."""
    levels = np.rint(display * 255).astype(np.uint8)
    shown = np.stack([turn(levels[..., at])[..., at] for at in range(3)], axis=-1) if grey else turn(levels)
    return decode(shown / np.float32(255)).astype(np.float32, copy=False)


def _space_of_tags(name: str, kind: bytes, tags: dict[bytes, bytes]) -> Space | None:
    """Return the colours of a profile's tags."""
    if kind == b"GRAY" and b"kTRC" in tags:
        return _unless_srgb(name, [_curve(tags[b"kTRC"])] * 3, None)
    columns, curves = (b"rXYZ", b"gXYZ", b"bXYZ"), (b"rTRC", b"gTRC", b"bTRC")
    if kind != b"RGB " or not {*columns, *curves} <= set(tags):
        return Space(name)
    xyz = np.array([struct.unpack(">3i", tags[column][8:20]) for column in columns]).T / 65536
    return _unless_srgb(name, [_curve(tags[curve]) for curve in curves], LIGHT_OF_XYZ @ xyz)


def space_of_cicp(data: bytes) -> Space | None:
    """Return the colours that a PNG's cICP chunk names; None where they are sRGB.

    High dynamic range is dimmed as that of films is.
    """
    primaries, transfer, matrix, whole = data[:4].ljust(4, b"\0")
    name, places = _PRIMARIES.get(primaries, ("", ()))
    curves: dict[int, _Curve] = {_H273_LINEAR: _same, _H273_SRGB: decode, **dict.fromkeys(_H273_VIDEO, _video)}
    if transfer in HDR_CURVES and name and not matrix and whole == 1:
        return Space(f"{name} {HDR_CURVES[transfer]}", whole=partial(light_of, curve=transfer, primaries=primaries))
    if transfer not in curves or not name or matrix or whole != 1:
        return Space(f"cICP {primaries}/{transfer}/{matrix}/{whole}")
    return _unless_srgb(name, [curves[transfer]] * 3, _matrix(places))


def space_of_container(data: bytes) -> Space | None:
    """Return the colours that an AVIF or HEIC picture names by numbers; None where they are sRGB or not named.

    What such files say of ordinary curves means that of sRGB.
    """
    at = data.find(_NUMBERS)
    if at < 0 or len(data) < at + len(_NUMBERS) + 6:
        return None
    primaries, transfer, _ = struct.unpack_from(">3H", data, at + len(_NUMBERS))
    if primaries not in _PRIMARIES:
        return None
    return space_of_cicp(bytes((primaries, transfer if transfer in HDR_CURVES else _H273_SRGB, 0, 1)))


def space_of_gamma(gamma: bytes | None, places: bytes | None) -> Space | None:
    """Return the colours that a PNG's gAMA and cHRM chunks say; None where they are sRGB, or there are none."""
    name = " and ".join(["gAMA"] * (gamma is not None) + ["cHRM"] * (places is not None))
    try:
        exponent = _GAMMA_SRGB if gamma is None else struct.unpack(">I", gamma)[0]
        curve = decode if abs(exponent - _GAMMA_SRGB) < _GAMMA_OFF else partial(_power, 100_000 / exponent)
        numbers = (0.0,) * 8 if places is None else tuple(each / 100_000 for each in struct.unpack(">8I", places))
        white, *primaries = zip(numbers[::2], numbers[1::2], strict=True)
        matrix = None if places is None else _matrix(tuple(primaries), white)
    except (struct.error, ZeroDivisionError, np.linalg.LinAlgError):
        return Space(f"a damaged {name}")
    return _unless_srgb(name, [curve] * 3, matrix)


def adobe_rgb() -> Space:
    """Return the colours of Adobe RGB (1998), which cameras name in EXIF without a profile."""
    return Space("Adobe RGB", (partial(_power, _ADOBE_GAMMA),) * 3, _matrix(_ADOBE))


def _unless_srgb(name: str, curves: list[_Curve], matrix: NDArray[np.float64] | None) -> Space | None:
    """Return a space, or None where it is sRGB but for less than a level."""
    space = Space(name, tuple(curves), matrix)
    return None if _is_srgb(space) else space


def _is_srgb(space: Space) -> bool:
    """Whether colours are sRGB but for less than a level."""
    steps = np.linspace(0, 1, 9, dtype=np.float32)
    display = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(27, 27, 3)
    return bool(np.max(np.abs(encode(space.light(display)) - display)) <= _SAME)


def _matrix(places: _Places, white: tuple[float, float] = _WHITE_D65) -> NDArray[np.float64]:
    """Linear light of primaries at `places` ``(x, y)`` to linear light of sRGB; their white becomes that of sRGB."""

    def to_cones(places: _Places, white: tuple[float, float]) -> NDArray[np.float64]:
        columns = _CONES @ np.array([(x / y, 1, (1 - x - y) / y) for x, y in (*places, white)]).T
        shares: NDArray[np.float64] = np.linalg.solve(columns[:, :3], columns[:, 3])
        return columns[:, :3] * shares / columns[:, 3:]

    return np.asarray(np.linalg.solve(to_cones(_PRIMARIES[1][1], _WHITE_D65), to_cones(places, white)), np.float64)


def _tags(data: bytes) -> dict[bytes, bytes]:
    """Content of each tag of a profile (ICC.1:2022, 7.3)."""
    count = int.from_bytes(data[128:132], "big")
    entries = [struct.unpack_from(">4sII", data, 132 + 12 * at) for at in range(count)]
    return {name: data[start : start + length] for name, start, length in entries}


def _curve(tag: bytes) -> _Curve:
    """Return the curve of a tag of the type `curv` or `para` (ICC.1:2022, 10.6 and 10.18)."""
    if tag[:4] == b"para":
        kind = int.from_bytes(tag[8:10], "big")
        count = (1, 3, 4, 5, 7)[kind]
        return partial(_parametric, kind, [value / 65536 for value in struct.unpack_from(f">{count}i", tag, 12)])
    if tag[:4] != b"curv":
        raise ValueError(tag[:4])
    count = int.from_bytes(tag[8:12], "big")
    table = np.frombuffer(tag, ">u2", count, 12).astype(np.float64)
    if count == 0:
        return _same
    if count == 1:
        return partial(_power, float(table[0]) / 256)
    return partial(_from_table, table / 65535)


def _same(display: _Light) -> _Light:
    """Display values that are linear light."""
    return display


def _power(gamma: float, display: _Light) -> _Light:
    """A pure power."""
    return display**gamma


def _from_table(table: NDArray[np.float64], display: _Light) -> _Light:
    """Values of a table, straight between them."""
    return np.interp(display, np.linspace(0, 1, len(table)), table).astype(np.float32)


def _parametric(kind: int, numbers: list[float], display: _Light) -> _Light:
    """A power of a straight line, and below some value another straight line."""
    gamma, a, b, c, d, e, f = [*numbers, *(1.0, 0.0, 0.0, 0.0, 0.0, 0.0)[len(numbers) - 1 :]]
    powered = np.maximum(a * display + b, 0) ** gamma
    if kind in (0, 1):
        return powered
    if kind == 2:
        return powered + c
    return np.where(display >= d, powered + e, c * display + f).astype(np.float32)


def _video(display: _Light) -> _Light:
    """Light of the curve that ITU-R BT.709 and BT.2020 share."""
    return np.where(display < 0.081, display / 4.5, (np.maximum(display + 0.099, 0) / 1.099) ** (1 / 0.45))
