"""What the page's sliders say, as the options of the verbs, and as the command that does the same."""

from __future__ import annotations

import shlex
from dataclasses import fields
from pathlib import Path

from lightcube.optics.tables import POWER_MAX
from lightcube.studio.project import MADE, PICTURES, Making
from lightcube.verbs.options import Options

#: The cube, in the folder of what was made.
CUBE = "cube.zarr"


def options_of(making: Making) -> Options:
    """The same as a command takes it."""
    return Options(
        n=making.voxels,
        picture_width=making.width,
        lamp_max=None if making.lamp == POWER_MAX else making.lamp,
        hold_deg=making.hold_deg,
        max_extinction=making.richness or None,
        fit=making.fit,
        mat=None if making.mat == "dark" else making.mat,
        order=making.order,
        quality=None if making.quality == "normal" else making.quality,
    )


def words_of(making: Making) -> list[str]:
    """The options of a command that are not as usual, as they are typed."""
    said, usual = options_of(making), Options()
    words = []
    for each in fields(Options):
        value = getattr(said, each.name)
        if value != getattr(usual, each.name):
            words += [f"--{each.name.replace('_', '-')}", str(value).removesuffix(".0")]
    return words


def command_of(folder: Path, making: Making) -> str:
    """The command that makes the cube of a project."""
    places = [str(folder / PICTURES), "-o", str(folder / MADE / CUBE)]
    return shlex.join(["lightcube", "solve", *places, *words_of(making), "--overwrite"])
