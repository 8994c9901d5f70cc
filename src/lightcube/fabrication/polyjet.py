"""A cube as slices of droplets for a PolyJet printer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from lightcube.errors import InputError
from lightcube.fabrication import sidecar
from lightcube.fabrication.blocks import Blocks
from lightcube.fabrication.droplets import Droplets
from lightcube.fabrication.planned import AXES, Advance, File, Planned, named
from lightcube.fabrication.points import check_seed
from lightcube.fabrication.printers import MODES, Mode, Printing
from lightcube.fabrication.resins import Mixed, mixed
from lightcube.fabrication.slices import Held, Look, most_voxels, palette_of, write_slices
from lightcube.io._files import Replaceable
from lightcube.io._places import Place
from lightcube.optics.arrays import Volume
from lightcube.optics.checks import check_fields
from lightcube.optics.cube import Cube
from lightcube.optics.dyes import Dyes
from lightcube.optics.grid import Grid
from lightcube.wording import counted

#: What the clear material is called.
CLEAR = "clear"
#: Names of slices have four digits.
_MOST_SLICES = 10_000


def is_slices_folder(at: Place) -> bool:
    """Whether a folder holds slices, and may therefore be replaced by others."""
    try:
        said = sidecar.read(sidecar.place_of(at, is_folder=True))
    except (InputError, OSError):
        return False
    return said is not None and said.kind == "polyjet"


@dataclass(frozen=True)
class PolyJet:
    """How slices are made.

    Parameters
    ----------
    resins
        What is printed; None = the dyes that the cube was solved in.
    mode
        Of the printer: ``"high-mix"`` (27 µm slices, up to six materials, the clear one among them),
        ``"high-quality"`` (14 µm, six) or ``"high-speed"`` (27 µm, three).
    seed
        Of the droplets' places, from 0 on.
    flips
        Axes along which all is mirrored, such as ``"y"``: printers' programs differ in which way they read slices.
    prefix
        What the names of slices begin with.
    """

    resins: Dyes | None = None
    mode: Mode = "high-mix"
    seed: int = 1
    flips: str = ""
    prefix: str = "slice"

    called: ClassVar[str] = "a folder of slices"
    suffixes: ClassVar[tuple[str, ...]] = ("", ".slices")
    replaceable: ClassVar[Replaceable] = staticmethod(is_slices_folder)

    def __post_init__(self) -> None:
        check_fields(self)
        check_seed(self.seed)
        if set(self.flips) - set("xyz") or len(set(self.flips)) < len(self.flips):
            raise InputError(f"flips are axes, each of x, y and z once at most, not {self.flips!r}")
        if not (self.prefix.isascii() and self.prefix.replace("-", "").isalnum() and len(self.prefix) <= 40):
            raise InputError(f"a prefix is up to 40 letters and digits, not {self.prefix!r}")

    def plan(self, cube: Cube, at: Place) -> Planned:
        """What would be written."""
        printing, made = MODES[self.mode], mixed(cube, self.resins)
        droplets = Droplets(made.amounts, cube.grid, printing.sides_mm, made.order, self.seed)
        unused = droplets.expected() < 1
        if np.any(unused):
            droplets = replace(droplets, amounts=made.amounts * ~unused[:, None, None, None])
        used = [0, *(1 + np.flatnonzero(~unused)).tolist()]
        _check(used, droplets, printing, self.mode)
        look, palette = Look(self.prefix, printing.dpi, "".join(sorted(self.flips))), palette_of(made.dyes.label)
        names = (CLEAR, *made.dyes.names)

        def write(folder: Path, advance: Advance) -> None:
            found = write_slices(folder, droplets, palette, look, advance)
            missing = [names[material] for material in used if not found[material]]
            if missing:
                raise InputError(f"no droplet came out as {missing[0]}, which printers refuse: leave that resin out")

        def held(folder: Path) -> tuple[Volume, Grid]:
            return Held(folder, droplets.shape, printing.sides_mm, palette, made.droplets, look).volume()

        files = (File(at, write, is_slices_folder),)
        facts = _facts(made, droplets, printing, self, palette)
        facts["palette"] = [facts["palette"][material] for material in used]
        left_out = [name for name, is_so in zip(made.dyes.names, unused, strict=True) if is_so]
        notes = [f"nothing of the cube is of {', '.join(left_out)}, which printers refuse: left out"] * bool(left_out)
        return Planned(files, facts, (*notes, *made.dyes.doubts), held, is_relit=True)


def held_of(folder: Path, said: sidecar.Sidecar) -> Held:
    """What slices hold by their sidecar; `InputError` where that does not say all."""
    if said.palette is None or said.droplets is None or said.pitch_mm is None or said.dpi is None:
        raise InputError(f"{folder / sidecar.INSIDE} does not say what the slices are of: export them again")
    palette = np.array([each.rgba for each in said.palette], np.uint8)
    extinction = [each.extinction for each in said.palette]
    if len({len(each) for each in extinction}) != 1 or not extinction[0]:
        raise InputError(f"{folder / sidecar.INSIDE} has materials of different colours: export the slices again")
    x, y, z = (said.pitch_mm[axis] for axis in ("x", "y", "z"))
    nx, ny, nz = (said.droplets[axis] for axis in ("x", "y", "z"))
    look = Look(said.prefix, said.dpi, said.flips)
    return Held(folder, (nz, ny, nx), (x, y, z), palette, np.array(extinction), look)


def _check(used: Sequence[int], droplets: Droplets, printing: Printing, mode: Mode) -> None:
    """Raise `InputError` where a printer could not print it."""
    materials, slices = len(used), droplets.shape[0]
    if materials == 1:
        raise InputError("the cube is clear all over, so there is nothing to print: solve one first")
    if materials > printing.most:
        raise InputError(
            f"{counted(materials, 'material')} with the clear one are more than the {printing.most} that mode {mode} "
            "prints: take fewer resins"
        )
    if not printing.least <= slices < _MOST_SLICES:
        low, high = printing.least * printing.layer_mm, _MOST_SLICES * printing.layer_mm
        raise InputError(
            f"the cube is {counted(slices, 'slice')} of {printing.layer_mm * 1000:g} micrometres high, and a print has "
            f"{printing.least} to {_MOST_SLICES - 1}: make it between {low:.3g} and {high:.3g} mm high"
        )


def _facts(made: Mixed, droplets: Droplets, printing: Printing, how: PolyJet, palette: Any) -> dict[str, Any]:
    """All that is known of slices before they are made."""
    count, sides = droplets.shape[::-1], printing.sides_mm
    blocks = Blocks.of(droplets.shape, sides, most_voxels())
    parts = made.amounts.mean(axis=(1, 2, 3), dtype=np.float64)
    names = (CLEAR, *made.dyes.names)
    return {
        "droplets": named(count),
        "pitch_mm": named(sides),
        "size_mm": named(np.array(count) * sides),
        "axes": f"{AXES}; slices go up from the first, seen from above: columns along x, rows against y",
        "flips": "".join(sorted(how.flips)),
        "prefix": how.prefix,
        "dpi": list(printing.dpi),
        "mode": how.mode,
        "seed": how.seed,
        "calibration": made.dyes.calibration,
        "palette": [
            {"name": name, "rgba": rgba, "extinction": extinction, "part": part}
            for name, rgba, extinction, part in zip(
                names, palette.tolist(), made.droplets.tolist(), (1 - parts.sum(), *parts.tolist()), strict=True
            )
        ],
        "cast_in": named(blocks.each[::-1]),
        **({"conversion": dict(made.facts)} if made.facts else {}),
    }
