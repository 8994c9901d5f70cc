"""Small stacks of films whose pages are known, and what other readers find in such pages."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lightcube.forward.casting import cast
from lightcube.optics.attenuator import Films, attenuator
from lightcube.optics.cube import Cube
from lightcube.optics.dyes import Dyes
from lightcube.optics.moves import Move
from lightcube.optics.transfer import encode

#: Side of a cell, mm: 30 dots at 600 dpi.
CELL = 1.27
#: Inks that absorb more than one colour, with a dot gain of one of them.
INKS = Dyes(
    ("cyan", "magenta", "yellow"),
    np.array([[2.8, 1.1, 0.4], [0.5, 2.6, 1.5], [0.1, 0.2, 2.2]]),
    kind="ink",
    calibration="measured",
    gain=(None, np.array([[0, 0], [0.5, 0.65], [1, 1]]), None),
)


def stack(films: int = 3, *, moves: tuple[Move | None, ...] = (), inks: Dyes | None = None, seed: int = 7) -> Cube:
    """A stack of films for two pictures of 4 x 6 pixels that are just what it casts."""
    lying = Films(films, gap_mm=4 * CELL, size_mm=12 * CELL, pixels=6)
    stage = attenuator(["one", "two"], lying, 1.5, moves=moves)
    grid = stage.grid
    draw = np.random.default_rng(seed)
    if inks is None:
        patches = draw.choice((0.05, 2.0), (3, films, *(-(-side // 4) for side in grid.shape[1:])), p=(0.7, 0.3))
        cells = patches.repeat(4, axis=2).repeat(4, axis=3)[:, :, : grid.shape[1], : grid.shape[2]]
        noise = draw.uniform(0, 0.3, (3, *grid.shape))
        made = Cube(((cells + noise) / CELL).astype(np.float32), grid, stage.rig())
    else:
        amounts = draw.uniform(0, 0.6, (len(inks.names), *grid.shape)).astype(np.float32)
        made = Cube(inks.mixed(amounts) / np.float32(CELL), grid, stage.rig(), amounts=amounts, dyes=inks)
    return wanted(replace(made, lamp_powers=draw.uniform(0.5, 1.5, made.powers.shape), names=("one", "two")))


def wanted(cube: Cube) -> Cube:
    """The same cube, made for the pictures that it casts."""
    shown = np.clip(np.stack([encode(light, cube.transfer) for light in cast(cube)]), 0, 1)
    levels = np.rint(65535 * shown).astype(np.uint16)
    weights = np.full((*levels.shape[:3], 1), 65535, np.uint16)
    return replace(cube, targets=np.concatenate([levels, weights], axis=3))


def placed(path: Path) -> list[tuple[NDArray[np.float64], NDArray[np.uint8]]]:
    """By pikepdf, of each page with a picture: the matrix of the unit square in points, and the picture's levels."""
    pikepdf = pytest.importorskip("pikepdf")
    found = []
    with pikepdf.open(path) as pdf:
        for page in pdf.pages:
            matrix, kept = np.eye(3), list[Any]()
            for operands, operator in pikepdf.parse_content_stream(page):
                if str(operator) == "q":
                    kept.append(matrix)
                elif str(operator) == "Q":
                    matrix = kept.pop()
                elif str(operator) == "cm":
                    a, b, c, d, e, f = map(float, operands)
                    matrix = np.array([[a, b, 0], [c, d, 0], [e, f, 1]]) @ matrix
                elif str(operator) == "Do":
                    image = pikepdf.PdfImage(page.Resources.XObject[str(operands[0])])
                    levels = np.frombuffer(image.read_bytes(), np.uint8).reshape(image.height, image.width, -1)
                    found.append((matrix, levels))
    return found
