"""What a cube or a film can be made of: a clear material, and dyes that are put into it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from typing import Any, Literal

import numpy as np

from lightcube.errors import InputError
from lightcube.kernels.layout import clear_volume
from lightcube.optics.arrays import Bytes, Floats, Reals, Volume, keep
from lightcube.optics.checks import check_fields
from lightcube.optics.grid import Grid
from lightcube.optics.stack import Stack
from lightcube.wording import counted

#: What absorbs: ink on a film, a resin that is cured drop by drop, a filament.
DyeKind = Literal["ink", "resin", "filament"]
#: Nobody measured it, somebody did, or it was made up of a number that says something else.
Calibration = Literal["provisional", "measured", "guess"]

#: No dye absorbs more, 1/mm or natural absorbance of a film; no set has more dyes.
_MOST, _MOST_DYES = 1e6, 12
#: Sets whose second direction is so much weaker than the first make no colours that can be told apart.
_ALIKE = 1e-3
#: Density of a full film below which no picture gets dark.
_WEAK = 0.3
#: A curve of dot gain is followed at so many steps.
_STEPS = 1024


def _none() -> Reals:
    return np.empty(0)


@dataclass(frozen=True, eq=False)
class Dyes:
    """Dyes that are mixed into a clear material, and what each of them absorbs.

    Parameters
    ----------
    names
        One for each dye.
    extinction
        ``(dye, channel)`` of a place that is full of it: 1/mm of resins and filaments, and of inks the absorbance
        (natural logarithm) of a film that is covered; without the clear material's own.
    limit
        ``(dye,)``: the largest amount of each, above 0 up to 1; default 1.
    label
        ``(dye, 3)`` levels from 0 to 255 by which the dye is known in pictures; default as it looks.
    base
        ``(channel,)``: what the clear material takes of the light, absorbed or thrown aside, 1/mm, or a clear film's
        absorbance; default 0.
    calibration
        Whether it was measured.
    kind
        What absorbs.
    gain
        Of each dye its dot gain: ``(points, 2)`` of coverages as they are sent and as they come out, from (0, 0) to
        (1, 1), both rising; None = they come out as they are sent. Default none.
    scattering
        ``(dye,)``, 1/mm: light that is thrown aside. It is kept and told; nothing here reckons with it.
    haze, g
        How much of `base` is thrown aside, 1/mm, and the mean cosine of where to: 0 = to all sides alike, 0.9 = ahead.

    Raises
    ------
    InputError
        Where shapes disagree, numbers are out of their range, or the dyes are too much alike to make colours.
    """

    names: tuple[str, ...]
    extinction: Reals
    limit: Reals = field(default_factory=_none)
    label: Bytes = field(default_factory=lambda: np.empty(0, np.uint8))
    base: Reals = field(default_factory=_none)
    calibration: Calibration = "provisional"
    kind: DyeKind = "resin"
    gain: tuple[Reals | None, ...] = ()
    scattering: Reals = field(default_factory=_none)
    haze: float = 0.0
    g: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self)
        keep(self, extinction=np.float64)
        _check_names(self.names)
        _check_extinction(self.names, self.extinction)
        dyes, channels = self.extinction.shape
        self._fill(limit=np.ones(dyes), base=np.zeros(channels), scattering=np.zeros(dyes))
        if not np.all((self.limit > 0) & (self.limit <= 1)):
            raise InputError(f"the limit of a dye lies above 0 and up to 1, not at {_worst(self.limit, 1)}: mend it")
        for name in ("base", "scattering"):
            if not _are_within(getattr(self, name)):
                raise InputError(f"the {name} of a material must be numbers from 0 to {_MOST:g}: mend it")
        _check_haze(self)
        self._fill_labels()
        if self.gain and len(self.gain) != dyes:
            raise InputError(f"{counted(dyes, 'dye')} with {counted(len(self.gain), 'dot gain')}: give one for each")
        gain = tuple(_curve(name, each) for name, each in zip(self.names, self.gain or (None,) * dyes, strict=True))
        object.__setattr__(self, "gain", gain)

    def _fill(self, **usual: Reals) -> None:
        """Keep arrays, as usual where nothing was given."""
        for name, default in usual.items():
            given = np.asarray(getattr(self, name), np.float64)
            object.__setattr__(self, name, given if given.size else default)
            if given.size and given.shape != default.shape:
                raise InputError(f"the {name} of a material must be {default.size} numbers, not {given.shape}")
        keep(self, **dict.fromkeys(usual, np.float64))

    def _fill_labels(self) -> None:
        """Keep the labels: by default the colour of light that a full place lets through."""
        given = np.asarray(self.label)
        if not given.size:
            through = np.exp(-self.extinction / self.extinction.max())
            given = np.rint(255 * through[:, [0, -1, -1] if through.shape[1] < 3 else [0, 1, 2]]).astype(np.uint8)
        if given.shape != (len(self.names), 3) or given.min() < 0 or given.max() > 255:
            raise InputError("the label of a dye is three levels from 0 to 255: give red, green and blue")
        object.__setattr__(self, "label", given)
        keep(self, label=np.uint8)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Dyes) and self.plain() == other.plain()

    def __hash__(self) -> int:
        return hash((self.names, self.extinction.tobytes(), self.limit.tobytes()))

    def __repr__(self) -> str:
        return f"<{counted(len(self.names), self.kind)}: {', '.join(self.names)}; {self.calibration}>"

    @property
    def channels(self) -> int:
        """Colours of light that they absorb."""
        return self.extinction.shape[1]

    @property
    def doubts(self) -> list[str]:
        """What is to be known before such dyes are used, each a sentence."""
        found = []
        if self.calibration != "measured":
            called = "provisional: nobody measured them" if self.calibration == "provisional" else "guessed"
            found.append(f"these {self.kind}s are {called}; calibrate your own by lightcube calibrate")
        dark = (self.extinction * self.limit[:, None]).max(axis=1) / math.log(10)
        if self.kind == "ink" and dark.max() < _WEAK:
            found.append(f"a film gets no darker than density {dark.max():.2f}: pictures need {_WEAK} at least")
        if np.any(self.scattering):
            found.append("scattering is told in the file, and nothing here reckons with it")
        return found

    def in_block(self, grid: Grid) -> Dyes:
        """The same dyes by their extinction, 1/mm, in a grid's voxels: inks lie on films, one for each slice."""
        if self.kind != "ink":
            return self
        film_mm = grid.voxel_mm if isinstance(grid, Stack) else grid.slice_mm
        extinction, base = self.extinction / film_mm, self.base / film_mm
        return replace(self, extinction=extinction, base=base, kind="resin")

    def mixed(self, amounts: Floats) -> Volume:
        """Extinction ``(channel, z, y, x)`` of amounts ``(dye, z, y, x)``: 1/mm, or of inks the films' absorbance."""
        full, clear = self.extinction.astype(np.float32), self.base.astype(np.float32)
        nz, ny, nx = amounts.shape[1:]
        volume = clear_volume((nz, ny, nx), self.channels)
        for channel, extinction in enumerate(volume):  # dye by dye: the same bits on any machine
            extinction += clear[channel]
            for dye, amount in enumerate(amounts):
                extinction += full[dye, channel] * amount
        return volume

    def coverage(self, amount: Floats) -> Reals:
        """How much of the place to cover, as it is sent to the printer, for amounts of the dyes ``(dye, ...)``.

        Of inks what covers ``a`` of a film lets ``1 - a (1 - exp(-E))`` through (Murray and Davies), here where the ink
        absorbs most; drops of resin take their part of the place. A dot gain is allowed for.
        """
        given = np.clip(np.asarray(amount, np.float64), 0, 1)
        return np.stack([self._sent(dye, each) for dye, each in enumerate(given)])

    def amount(self, coverage: Floats) -> Reals:
        """Amounts that come of coverages ``(dye, ...)`` as they are sent to the printer: the inverse of `coverage`."""
        given = np.clip(np.asarray(coverage, np.float64), 0, 1)
        return np.stack([self._printed(dye, each) for dye, each in enumerate(given)])

    def _sent(self, dye: int, amount: Reals) -> Reals:
        most, curve = float(self.extinction[dye].max()), self.gain[dye]
        covered = np.expm1(-most * amount) / math.expm1(-most) if self.kind == "ink" else amount
        return covered if curve is None else np.interp(covered, *monotone(curve)[::-1])

    def _printed(self, dye: int, coverage: Reals) -> Reals:
        most, curve = float(self.extinction[dye].max()), self.gain[dye]
        covered = coverage if curve is None else np.interp(coverage, *monotone(curve))
        return -np.log1p(covered * math.expm1(-most)) / most if self.kind == "ink" else covered

    def plain(self) -> dict[str, Any]:
        """Every field by name in JSON's own types, of which `Dyes` makes the same again."""
        flat = {each.name: getattr(self, each.name) for each in fields(self)}
        flat["gain"] = [None if curve is None else curve.tolist() for curve in self.gain]
        return {
            name: value.tolist() if isinstance(value, np.ndarray) else list(value) if name == "names" else value
            for name, value in flat.items()
        }


def monotone(curve: Reals) -> tuple[Reals, Reals]:
    """A smooth curve through rising points that rises everywhere: where, and how high."""
    from scipy.interpolate import PchipInterpolator  # here: it takes long to load

    at = np.union1d(np.linspace(0, 1, _STEPS + 1), curve[:, 0])
    return at, np.clip(PchipInterpolator(*curve.T)(at), 0, 1)


def _check_names(names: tuple[str, ...]) -> None:
    if not 1 <= len(names) <= _MOST_DYES:
        raise InputError(f"a material has 1 to {_MOST_DYES} dyes, not {len(names)}")
    for name in names:
        if not name.strip() or len(name) > 40 or not name.isprintable():
            raise InputError(f"{name!r} is no name of a dye: give up to 40 letters")
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise InputError(f"two dyes are called {twice!r}: give each a name of its own")


def _check_extinction(names: tuple[str, ...], extinction: Reals) -> None:
    if extinction.ndim != 2 or len(extinction) != len(names) or not extinction.shape[1]:
        raise InputError(f"the extinction of {len(names)} dyes has shape {extinction.shape}, not one row each")
    for name, row in zip(names, extinction, strict=True):
        if not _are_within(row):
            raise InputError(f"dye {name!r} absorbs {_worst(row, _MOST)}, which is not from 0 to {_MOST:g}: mend it")
        if not np.any(row > 0):
            raise InputError(f"dye {name!r} absorbs nothing: leave it out, or give it a density")
    sizes = np.linalg.svd(extinction / extinction.max(axis=1, keepdims=True), compute_uv=False)
    if extinction.shape[1] > 1 and (len(sizes) < 2 or sizes[1] < _ALIKE * sizes[0]):
        raise InputError(f"{', '.join(names)} absorb all colours alike, and make only greys or tints: add another dye")


def _check_haze(dyes: Dyes) -> None:
    if not -1 <= dyes.g <= 1:
        raise InputError(f"g is a mean cosine, from -1 to 1, not {dyes.g:g}")
    if not dyes.haze >= 0:
        raise InputError(f"haze is a number per mm of at least 0, not {dyes.haze:g}")
    if dyes.haze and dyes.kind == "ink":
        raise InputError("haze is of blocks, per mm, and inks lie on films: leave it out")
    if dyes.haze > dyes.base.min():
        raise InputError(
            f"haze is a part of what the clear material takes, and base takes less than {dyes.haze:g} per mm of a "
            "colour: add the haze to each number of base"
        )


def _curve(name: str, points: Reals | None) -> Reals | None:
    """A dot gain that is the dye's own, or `InputError`."""
    if points is None:
        return None
    made = np.array(points, np.float64)
    fits = made.ndim == 2 and made.shape[1] == 2 and len(made) >= 2
    if not fits or not np.array_equal(made[[0, -1]], [[0, 0], [1, 1]]) or not np.all(np.diff(made, axis=0) > 0):
        raise InputError(f"the dot gain of {name!r} must rise from [0, 0] to [1, 1] in both numbers: mend it")
    made.setflags(write=False)
    return made


def _are_within(numbers: Reals) -> bool:
    return bool(np.all((numbers >= 0) & (numbers <= _MOST)))  # NaN is not


def _worst(numbers: Reals, most: float) -> str:
    """The first number that cannot be."""
    wrong = numbers[~((numbers >= 0) & (numbers <= most))]
    return f"{wrong[0] if wrong.size else 0:g}"
