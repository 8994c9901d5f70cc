"""Files of materials: what dyes absorb, as TOML, and the materials that ship with the package."""

from __future__ import annotations

import datetime
import math
import re
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from lightcube.errors import InputError
from lightcube.io._files import Writer
from lightcube.io._toml import read_tables
from lightcube.optics.arrays import Reals
from lightcube.optics.checks import checked
from lightcube.optics.dyes import Calibration, DyeKind, Dyes
from lightcube.scene.description import AtLeastZero, Fraction, Line, Number, hex_colour, sentence

#: A density is the logarithm to the base 10 of what is let through, absorbance the natural one.
LN10 = math.log(10)


def _levels(value: Any) -> Any:
    """An sRGB colour such as ``"#00a0dc"`` as three levels from 0 to 255; anything else as it is."""
    colour = hex_colour(value)
    return value if colour is value else tuple(round(255 * part) for part in colour)


Level = Annotated[int, Field(strict=True, ge=0, le=255)]
Colours = tuple[AtLeastZero, AtLeastZero, AtLeastZero]


class _Table(BaseModel):
    model_config: ClassVar[ConfigDict] = ConfigDict(extra="forbid", frozen=True, defer_build=True)


class Absorbing(_Table):
    """What absorbs red, green and blue: the density of a film, or the extinction of a block, 1/mm."""

    density: Colours | None = None
    extinction: Colours | None = None

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.density is None) == (self.extinction is None):
            raise PydanticCustomError("one", "say either density (of a film) or extinction (1/mm), of red, green, blue")
        return self

    def absorbed(self, kind: DyeKind, where: str) -> Reals:
        """Natural absorbance of a film, or extinction; `InputError` where it is said the other way."""
        given, key = (self.density, "density") if kind == "ink" else (self.extinction, "extinction")
        if given is None:
            raise InputError(f"{where} needs {key}, as its material is a kind of {kind}: give three numbers")
        return np.array(given) * (LN10 if kind == "ink" else 1.0)


class InkTable(Absorbing):
    """A dye."""

    scattering: AtLeastZero = 0.0
    dot_gain: Annotated[tuple[tuple[Fraction, Fraction], ...], Field(max_length=1000)] | None = None
    limit: Fraction = 1.0
    label: Annotated[tuple[Level, Level, Level], BeforeValidator(_levels)] | None = None


class MaterialFile(_Table):
    """All that a file says of a material."""

    calibration: Calibration
    kind: DyeKind
    date: datetime.date | Line | None = None
    instrument: Line | None = None
    base: Absorbing | None = None
    haze: AtLeastZero = 0.0
    g: Number = 0.0
    ink: Annotated[dict[Line, InkTable], Field(min_length=1, max_length=12)]

    @property
    def measured(self) -> dict[str, str]:
        """When and with what it was measured, as far as the file says so."""
        said = {"date": self.date, "instrument": self.instrument}
        return {name: str(value) for name, value in said.items() if value is not None}

    def dyes(self, called: str) -> Dyes:
        """The dyes themselves; `InputError` that names the file as it is `called`."""
        try:
            inks, made = list(self.ink.values()), dict[str, Any]()
            if all(ink.label is not None for ink in inks):
                made["label"] = np.array([ink.label for ink in inks], np.uint8)
            if self.base is not None:
                made["base"] = self.base.absorbed(self.kind, "base")
            return Dyes(
                tuple(self.ink),
                np.stack([ink.absorbed(self.kind, f"ink.{name}") for name, ink in self.ink.items()]),
                np.array([ink.limit for ink in inks]),
                calibration=self.calibration,
                kind=self.kind,
                gain=tuple(None if ink.dot_gain is None else np.array(ink.dot_gain) for ink in inks),
                scattering=np.array([ink.scattering for ink in inks]),
                haze=self.haze,
                g=self.g,
                **made,
            )
        except InputError as error:
            raise InputError(f"{called}: {error}") from None


def material_names() -> list[str]:
    """Names of the materials that ship with the package, sorted."""
    return sorted(entry.name.removesuffix(".toml") for entry in (resources.files("lightcube") / "materials").iterdir())


def read_material(place_or_name: str | Path) -> MaterialFile:
    """All that the file of a material says; parameters and errors as of `read_dyes`."""
    path = Path(place_or_name)
    if path.suffix.lower() != ".toml":
        if str(place_or_name) not in material_names():
            known = ", ".join(material_names())
            raise InputError(f"there is no material {str(place_or_name)!r}: give a .toml file, or one of {known}")
        path = Path(str(resources.files("lightcube") / "materials" / f"{place_or_name}.toml"))
    if not path.exists():
        raise InputError(f"there is no {path}: give a material's .toml file, or one of {', '.join(material_names())}")
    try:
        return MaterialFile.model_validate(read_tables(path, path.name))
    except ValidationError as error:
        raise InputError(f"{path.name}: {sentence(error.errors(include_url=False)[0])}") from None


@checked
def read_dyes(place_or_name: str | Path) -> Dyes:
    """Read the dyes of a material's file (TOML), or of one of the shipped materials by its name.

    Parameters
    ----------
    place_or_name
        A path ending in ``.toml``, or one of `material_names`.

    Raises
    ------
    InputError
        Where the file cannot be read, or is no material.

    Examples
    --------
    >>> import lightcube as lc
    >>> lc.read_dyes("polyjet")
    <4 resins: cyan, magenta, yellow, black; provisional>
    """
    return read_material(place_or_name).dyes(Path(place_or_name).name)


def as_toml(dyes: Dyes) -> str:
    """The text of a material's file, from which `read_dyes` makes the same dyes again."""
    is_ink = dyes.kind == "ink"
    key, unit = ("density", LN10) if is_ink else ("extinction", 1.0)
    lines = [f'calibration = "{dyes.calibration}"', f'kind = "{dyes.kind}"']
    lines += [f"base = {{ {key} = {_numbers(dyes.base / unit)} }}"] if np.any(dyes.base) else []
    lines += [f"haze = {dyes.haze:.6g}", f"g = {dyes.g:.6g}"] if dyes.haze else []
    for number, name in enumerate(dyes.names):
        lines += ["", f"[ink.{_key(name)}]", f"{key} = {_numbers(dyes.extinction[number] / unit)}"]
        curve = dyes.gain[number]
        lines += [] if curve is None else [f"dot_gain = [{', '.join(map(_numbers, curve))}]"]
        lines += [] if dyes.limit[number] == 1 else [f"limit = {dyes.limit[number]:.6g}"]
        lines += [f"scattering = {dyes.scattering[number]:.6g}"] if dyes.scattering[number] else []
        lines += [f"label = {dyes.label[number].tolist()}"]
    return "\n".join(lines) + "\n"


def _numbers(numbers: Reals) -> str:
    return f"[{', '.join(f'{number:.6g}' for number in numbers)}]"


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _quoted(name)


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _write(path: Path, dyes: Dyes) -> None:
    path.write_text(as_toml(dyes), encoding="utf-8")


WRITERS: dict[str, Writer] = {".toml": _write}
