"""Palettes and libraries of filaments that other programs keep, as hints of what each absorbs."""

from __future__ import annotations

import colorsys
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lightcube.errors import InputError
from lightcube.io._bounds import MOST_TEXT, check_file
from lightcube.io._files import system_errors
from lightcube.io.materials import LN10
from lightcube.optics.arrays import Reals
from lightcube.optics.dyes import Calibration, Dyes
from lightcube.optics.transfer import decode
from lightcube.scene.description import hex_colour

#: What nothing darker than half a level can be told from, in linear light.
_DARKEST = float(decode(np.array(0.5 / 255)))
#: From this number on a transmission distance stands for none; light may rise so much with a layer more.
_NONE_MM, _RISE = 100.0, 0.03
#: Lines that rise less, 1/mm, do not rise.
_FLAT = 1e-6
#: As many entries are named; the most that a set of dyes has.
_NAMED, _MOST = 8, 12


@dataclass(frozen=True)
class Imported:
    """Dyes of another program's file, and what is to be known of each, a sentence."""

    dyes: Dyes
    said: list[str]


@dataclass(frozen=True)
class _Entry:
    name: str
    colour: Any
    values: Any


def read_palette(source: str, *, only: Sequence[str] = (), skip: bool = False, layer_mm: float = 0.1) -> Imported:
    """Read ``pixestl:FILE``, colours of one to several layers before a lamp, or ``hueforge:FILE``, one number each.

    Parameters
    ----------
    only
        Names of the filaments that are wanted; nothing = all that the file has in use.
    skip
        Leave entries out that say nothing usable, instead of refusing the file.
    layer_mm
        How high the layers of a PIXEstL palette are, mm.

    Raises
    ------
    InputError
        Where the file is none, an entry says nothing usable (by its name), or there are more than 12.
    """
    kind, colon, path = source.partition(":")
    if not colon or kind not in _KINDS:
        raise InputError(f"{source!r} is no palette: give pixestl:FILE or hueforge:FILE")
    if not 0.01 <= layer_mm <= 10:
        raise InputError(f"layers are 0.01 to 10 mm high, not {layer_mm:g}")
    entries_of, fit, calibration = _KINDS[kind]
    entries = _chosen(entries_of(_document(Path(path))), only, path)
    rows, names, labels, said = [], [], [], []
    for entry in entries:
        try:
            row, told = fit(entry, layer_mm)
            labels.append(np.rint(255 * _colour(entry)).astype(np.uint8))
        except InputError as error:
            if not skip:
                raise InputError(f"{Path(path).name}: {error}, or leave it out by --skip") from None
            said.append(f"left out: {error}")
            continue
        rows.append(row)
        names.append(entry.name)
        said.append(told)
    if not rows:
        raise InputError(f"{Path(path).name} has no filament that says what it absorbs: take another palette")
    dyes = Dyes(tuple(names), np.array(rows), label=np.array(labels), calibration=calibration, kind="filament")
    return Imported(dyes, said)


def _document(path: Path) -> Any:
    with system_errors(path, "reading"), check_file(path).open("rb") as opened:
        data = opened.read(MOST_TEXT + 1)
    if len(data) > MOST_TEXT:
        raise InputError(f"{path.name} is larger than any palette: give the palette by itself")
    try:
        return json.loads(data)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path.name} is no JSON ({' '.join(str(error).split())[:80]}): export it again") from None


def _pixestl(document: Any) -> list[_Entry]:
    """Filaments in use: by colour a name, whether it is active, and colours by the number of layers."""
    if not isinstance(document, Mapping) or not all(isinstance(each, Mapping) for each in document.values()):
        raise InputError("this is no palette of PIXEstL: it has filaments by their colours")
    return [
        _Entry(str(each.get("name", colour))[:40], colour, each.get("layers"))
        for colour, each in document.items()
        if each.get("active", True)
    ]


def _hueforge(document: Any) -> list[_Entry]:
    """Filaments with a colour and a transmission distance: ``Filaments`` of a library, or a list."""
    listed = document.get("Filaments") if isinstance(document, Mapping) else document
    if not isinstance(listed, list) or not all(isinstance(each, Mapping) for each in listed):
        raise InputError("this is no library of HueForge: it has a list of Filaments")
    return [
        _Entry(
            " ".join(str(each[key]) for key in ("Brand", "Name", "name") if each.get(key))[:40] or "nameless",
            each.get("Color", each.get("color")),
            each.get("Transmissivity", each.get("td")),
        )
        for each in listed
    ]


def _chosen(entries: list[_Entry], only: Sequence[str], path: str) -> list[_Entry]:
    """Those that are asked for, by names or beginnings of names; `InputError` where one is not there."""
    found = entries
    if only:
        found = []
        for name in only:
            those = [each for each in entries if each.name.lower().startswith(name.strip().lower())]
            if not those or not name.strip():
                known = ", ".join(each.name for each in entries[:_NAMED])
                raise InputError(f"{path} has no filament in use called {name!r}: it has {known}, ...")
            found.append(those[0])
    if len(found) > _MOST:
        raise InputError(f"{path} has {len(found)} filaments in use, and a material {_MOST} at most: choose by --only")
    return found


def _colour(entry: _Entry) -> Reals:
    """Red, green and blue of an entry, display values."""
    given = entry.colour if str(entry.colour).startswith("#") else f"#{entry.colour}"
    try:
        return np.array(hex_colour(given), float)
    except ValueError:
        raise InputError(f"{entry.name} has the colour {entry.colour!r}: write it as #rrggbb") from None


def _wedge(entry: _Entry, layer_mm: float) -> tuple[Reals, str]:
    """Extinction of a filament by straight lines through its layers, and how well they fit."""
    layers = entry.values if isinstance(entry.values, Mapping) else {}
    try:
        steps = sorted((int(count), _light(said)) for count, said in layers.items())
    except (KeyError, TypeError, ValueError):
        raise InputError(f"{entry.name} has layers that are no H, S and L by their number: mend it") from None
    if len(steps) < 2 or steps[0][0] < 1:
        raise InputError(f"{entry.name} has {len(steps)} layers, and a line takes two: photograph more") from None
    counts, light = np.array([count for count, _ in steps]), np.array([shown for _, shown in steps])
    if np.any(np.diff(light.sum(axis=1)) > _RISE * 3):
        raise InputError(f"{entry.name} gets brighter with more layers: measure it again")
    absorbed = -np.log(np.maximum(light, _DARKEST))
    lines = np.stack([counts * layer_mm, np.ones(len(counts))], axis=1)
    slopes, offsets = np.linalg.lstsq(lines, absorbed, rcond=None)[0]
    flat = slopes < _FLAT
    slopes, offsets = np.where(flat, 0, slopes), np.where(flat, absorbed.mean(axis=0), offsets)
    off = float(np.sqrt(np.mean((lines @ np.stack([slopes, offsets]) - absorbed) ** 2)))
    if not np.any(slopes):
        raise InputError(f"{entry.name} absorbs as much in one layer as in {counts[-1]}: measure it again")
    return slopes, f"{entry.name}: off by {off:.2f} (ln, rms), {_three(offsets)} at no thickness"


def _light(said: Mapping[str, float]) -> Reals:
    """Linear light of a colour in degrees and per cent."""
    hue, saturation, lightness = float(said["H"]) / 360, float(said["S"]) / 100, float(said["L"]) / 100
    if not (-1 <= hue <= 1 and 0 <= saturation <= 1 and 0 <= lightness <= 1):
        raise ValueError
    return np.asarray(decode(np.clip(colorsys.hls_to_rgb(hue % 1, lightness, saturation), 0, 1)))


def _distance(entry: _Entry, _: float) -> tuple[Reals, str]:
    """Extinction as it may be, of a colour and one number: after so many mm a tenth of light is left, on average."""
    given = entry.values
    if isinstance(given, bool) or not isinstance(given, int | float) or not 0 < given < _NONE_MM:
        raise InputError(f"{entry.name} has the transmission distance {given!r}, which is none: give mm, above 0")
    colour = _colour(entry)
    parts = -np.log(np.maximum(decode(colour), _DARKEST)) + 1e-3
    row = parts / parts.mean() * LN10 / given
    return row, f"{entry.name}: guessed of its colour and {given:g} mm, a number of which there are three definitions"


def _three(numbers: Reals) -> str:
    return ", ".join(f"{number:.2f}" for number in numbers)


_Fit = Callable[[_Entry, float], tuple[Reals, str]]
_KINDS: Mapping[str, tuple[Callable[[Any], list[_Entry]], _Fit, Calibration]] = {
    "pixestl": (_pixestl, _wedge, "provisional"),
    "hueforge": (_hueforge, _distance, "guess"),
}
