"""The light cube: extinction of every voxel and colour, and what it was made for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from lightcube.errors import InputError
from lightcube.optics import showing
from lightcube.optics.arrays import Levels, Reals, Volume, copied, keep, owned
from lightcube.optics.checks import check_fields
from lightcube.optics.dyes import Dyes
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.optics.transfer import Transfer
from lightcube.optics.views import check_pixels, check_reach
from lightcube.wording import counted

Status = Literal["complete", "interrupted"]
#: Amounts and what is mixed of them may be off by so much, as numbers of other programs are.
_ROUNDED = 1.0001


@dataclass(frozen=True, eq=False)
class Cube:
    """A block of coloured semi-transparent voxels and the views it was made for.

    Parameters
    ----------
    extinction
        ``(channel, z, y, x)`` float32 in 1/mm, at least 0; its axes may lie in memory in any order.
    grid
        Shape ``(nz, ny, nx)`` and voxel side.
    rig
        Lamps and screens of the pictures the cube was made for.
    lamp_powers
        ``(pair, channel)`` float64 above 0, linear light, 1 = the paper's white lamp; default all 1. One for each
        picture and lamp, in the order of ``rig.pairs``.
    targets
        The wanted pictures as 8-bit display levels ``(picture, row, column, channel + 1)``; the last channel is
        the weight (0 = don't care, 255 = full). None where the cube was not made from pictures.
    names
        One name per picture.
    transfer
        How display values follow from linear light.
    scores
        Figures of the fit, by name (see `lightcube.scoring.metrics`).
    provenance
        How the cube was made: method, options, version of this package.
    hold_deg
        Degrees on either side of its stop over which a picture was asked to stand; the lamp does not change there.
    amounts, dyes
        ``(dye, z, y, x)`` float32 from 0 to each dye's limit: how much of each dye every voxel holds, and the dyes, of
        which the extinction is mixed. None where a cube is of no dyes.
    status
        ``"complete"``, or ``"interrupted"`` where the solver was stopped early.

    Raises
    ------
    InputError
        Where shapes disagree, or a number is negative, NaN or infinite.

    Examples
    --------
    >>> import numpy as np, lightcube as lc
    >>> grid = lc.Grid((3, 5, 7), voxel_mm=2)
    >>> lc.Cube(np.zeros((3, 3, 5, 7)), grid, lc.turntable(grid, [0, 90]), names=("front", "side"))
    <light cube of 3 x 5 x 7 voxels for 2 pictures, complete>
    """

    extinction: Volume
    grid: Grid
    rig: Rig
    lamp_powers: Reals | None = None
    targets: Levels | None = None
    names: tuple[str, ...] = ()
    transfer: Transfer = "srgb"
    scores: Mapping[str, Any] = field(default_factory=dict)
    provenance: Mapping[str, Any] = field(default_factory=dict)
    status: Status = "complete"
    hold_deg: float = 0.0
    amounts: Volume | None = None
    dyes: Dyes | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        extinction = owned(self.extinction, np.float32)
        if extinction.ndim != 4 or extinction.shape[1:] != self.grid.shape or not extinction.shape[0]:
            raise InputError(
                f"extinction has shape {extinction.shape}, not (channels, {', '.join(map(str, self.grid.shape))})"
            )
        if not np.all(np.isfinite(extinction)) or np.any(extinction < 0):
            raise InputError(
                "extinction holds negative or non-finite numbers: every voxel needs a finite value of at least 0"
            )
        check_reach(self.rig.views, self.grid)
        check_pixels(self.rig.views, self.grid)
        pictures, channels = len(self.rig), len(extinction)
        if self.rig.sums.share.shape[1] not in (1, channels):
            raise InputError(
                f"a rig of {self.rig.sums.share.shape[1]} colours does not fit {channels}: give one of as many"
            )
        shape = (len(self.rig.pairs), channels)
        powers = owned(np.ones(shape) if self.lamp_powers is None else self.lamp_powers, np.float64)
        if powers.shape != shape or not np.all(np.isfinite(powers)) or np.any(powers <= 0):
            raise InputError(f"lamp powers must be positive finite numbers of shape {shape}, not {powers.shape}")
        if self.targets is not None:
            wanted = (pictures, *self.rig.picture_shape, channels + 1)
            given = np.asarray(self.targets)
            if given.shape != wanted or given.dtype != np.uint16:
                raise InputError(
                    f"targets must be 16-bit numbers of shape {wanted}, not {given.dtype} of {given.shape}"
                )
            keep(self, targets=np.uint16)
        names = self.names or tuple(str(i + 1) for i in range(pictures))
        if len(names) != pictures:
            raise InputError(
                f"{counted(pictures, 'picture')} with {counted(len(names), 'name')}: give one name per picture"
            )
        if not 0 <= self.hold_deg <= 180:
            raise InputError(f"a cube's hold lies between 0 and 180 degrees, not {self.hold_deg}")
        self._check_amounts(extinction)
        object.__setattr__(self, "extinction", extinction)
        object.__setattr__(self, "lamp_powers", powers)
        object.__setattr__(self, "names", names)
        for field_name in ("scores", "provenance"):
            object.__setattr__(self, field_name, copied(getattr(self, field_name)))

    def _check_amounts(self, extinction: Volume) -> None:
        """Keep the amounts of dyes; `InputError` unless the extinction is that of such a mixture."""
        if self.amounts is None and self.dyes is None:
            return
        if self.amounts is None or self.dyes is None:
            raise InputError("a cube of dyes has their amounts too, and amounts are of dyes: give both, or neither")
        amounts, dyes = owned(self.amounts, np.float32), self.dyes
        shape = (len(dyes.names), *self.grid.shape)
        if amounts.shape != shape or dyes.channels != len(extinction):
            raise InputError(f"amounts of {dyes!r} have shape {amounts.shape}, not {shape}, or colours differ")
        if not np.all((amounts >= 0) & (amounts <= _ROUNDED * dyes.limit[:, None, None, None])):
            raise InputError("amounts of dyes must lie between 0 and the limit of each: mend them")
        off = np.abs(dyes.in_block(self.grid).mixed(amounts) - extinction)
        if np.any(off > (_ROUNDED - 1) * float(extinction.max())):
            raise InputError("the extinction of a cube is not that of its amounts of dyes: mix it by Dyes.mixed")
        object.__setattr__(self, "amounts", amounts)

    @property
    def powers(self) -> Reals:
        """The lamp powers, never None."""
        assert self.lamp_powers is not None  # noqa: S101 - __post_init__ filled it
        return self.lamp_powers

    @property
    def angles_deg(self) -> Reals:
        """Turntable angle of each picture's stop, degrees."""
        return self.rig.stops.angle_deg

    def __repr__(self) -> str:
        nz, ny, nx = self.grid.shape
        if isinstance(self.grid, Stack):
            of = f"{counted(nz, 'film')} of {ny} x {nx} cells"
            return f"<stack of {of} for {counted(len(self.names), 'picture')}, {self.status}>"
        return f"<light cube of {nz} x {ny} x {nx} voxels for {counted(len(self.names), 'picture')}, {self.status}>"

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, Any]:
        """What a notebook shows of the cube; front ends choose among it."""
        return {"text/plain": repr(self)} if showing.by is None else showing.by(self)
