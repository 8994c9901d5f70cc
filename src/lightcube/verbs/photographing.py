"""What `score --photo` finds: a photograph of the real thing beside what was promised, and what was wanted."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube import io
from lightcube.drawing.sheet import contact_sheet
from lightcube.errors import InputError
from lightcube.forward.casting import cast
from lightcube.optics.arrays import Images, Reals, locked
from lightcube.optics.cube import Cube
from lightcube.pictures.targets import Targets
from lightcube.scoring.metrics import nearness
from lightcube.scoring.photographs import Photographed, photographed
from lightcube.wording import counted

#: A photograph of which more is clipped is told so; and one that shows a promise no better than this is wrong, dB.
_MUCH, _WRONG_DB = 0.02, 15.0


@dataclass(frozen=True, eq=False)
class Compared:
    """A photograph of one picture.

    Parameters
    ----------
    found
        What it shows.
    targets
        What was promised, and what was wanted, as two pictures.
    figures
        As `lightcube.scoring.photographs.Photographed.figures`, for JSON.
    """

    found: Photographed
    targets: Targets
    figures: dict[str, Any]

    @property
    def lines(self) -> list[str]:
        """What is to be known, for people."""
        said = []
        for what in ("promised", "wanted"):
            near = self.figures[what]
            figures = f"PSNR {near['psnr']:.1f} dB, SSIM {near['ssim']:.3f}, colour difference {near['delta_e']:.1f}"
            said.append(f"beside what was {what}: {nearness(near['psnr'])}, {figures}")
        exposure = ", ".join(f"{each:+.1f}" for each in self.figures["exposure_ev"])
        said.append(f"the photograph is exposed {exposure} EV beside the promise, by colour")
        if self.found.is_mirrored:
            said.append(
                "wrong: it shows the picture mirrored: turn the cube or films over, or photograph the other side"
            )
        if self.found.clipped > _MUCH:
            said.append(f"doubtful: {self.found.clipped:.0%} of it is too bright for the camera: expose it less")
        if self.figures["promised"]["psnr"] < _WRONG_DB:
            said.append("wrong: it is far off: is it this picture's lamp and stop, and are all films in their order?")
        return said

    def sheet(self, title: str) -> NDArray[np.uint8]:
        """What the photograph shows beside the promise and the wish, ``(row, column, 3)`` display levels."""
        psnr = [self.figures[what]["psnr"] for what in ("promised", "wanted")]
        return contact_sheet(np.stack([self.found.light] * 2), self.targets, psnr, title)


def compare(cube: Cube, targets: Targets, photo: str, picture: int, corners_px: Reals | None = None) -> Compared:
    """Compare a photograph with a picture of a cube.

    Parameters
    ----------
    cube, targets
        What casts, and what was wanted of it.
    photo
        The photograph's file.
    picture
        Number of the picture, from 1 on.
    corners_px
        ``(4, 2)`` of the picture in the photograph, clockwise from its upper left; None = it is looked for.

    Raises
    ------
    InputError
        Where there is no such picture, the file cannot be read, or the picture is not found in it.
    """
    if not 1 <= picture <= len(targets):
        raise InputError(f"there is no picture {picture}: the cube has {counted(len(targets), 'picture')}, from 1 on")
    read = io.read_pictures(photo, transfer=cube.transfer, least=1)
    if len(read.images) != 1:
        raise InputError(f"{photo} holds {counted(len(read.images), 'picture')}: give one photograph")
    index = picture - 1
    of_it = cube.powers[cube.rig.pairs[:, 0] == index]
    promised = next(cast(cube, cube.rig.take([index]), of_it))
    found = photographed(read.images[0], promised, corners_px, cube.transfer)
    both = _both(targets, index, promised)
    return Compared(found, both, found.figures(promised, targets.pictures[index], targets.weight[index], cube.transfer))


def _both(targets: Targets, index: int, promised: Images) -> Targets:
    """What was promised and what was wanted, as two pictures."""
    twice = targets.take(np.array([index, index]))
    name = targets.names[index]
    pictures = locked(np.stack([promised, targets.pictures[index]]).astype(np.float32))
    return replace(twice, pictures=pictures, names=(f"promised: {name}", f"wanted: {name}"))
