"""What a sidecar says of printed films, and the stack that such pages hold."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from lightcube.errors import InputError
from lightcube.fabrication.coverage import Printed, Space
from lightcube.io._pdf import Placed, read_pages, whole
from lightcube.optics.arrays import Reals, Volume, locked
from lightcube.optics.cube import Cube
from lightcube.optics.dyes import Dyes
from lightcube.optics.moves import misplaced
from lightcube.optics.stack import Stack
from lightcube.wording import counted

#: Pictures that stand nearer to where they should be than this, mm, do stand there.
_STILL_MM = 1e-3
#: A film's cells may be so much wider than high, or than another film's, of themselves.
_ALIKE = 1e-4

_Length = Annotated[float, Field(gt=0, le=1e6, allow_inf_nan=False)]
_Place = Annotated[float, Field(ge=-1e6, le=1e6, allow_inf_nan=False)]


class FilmFacts(BaseModel):
    """What is said of pages of films, and needed to read them.

    Parameters
    ----------
    cells
        ``[ny, nx]`` of each film.
    middle_mm
        Where the middle of each film's picture stands on its page.
    page_mm
        Width and height of a page.
    scale
        How much larger than they are things were drawn on purpose, along x and y.
    is_mirrored
        Whether pages are mirrored, to be printed on the side that lies below.
    space
        What levels are of: light, or coverages of inks.
    inks
        The inks, as `Dyes` has them; None where levels are light.
    """

    model_config = ConfigDict(strict=True)

    cells: Annotated[list[Annotated[int, Field(ge=1, le=100_000)]], Field(min_length=2, max_length=2)]
    middle_mm: Annotated[list[_Place], Field(min_length=2, max_length=2)]
    page_mm: Annotated[list[_Length], Field(min_length=2, max_length=2)]
    scale: Annotated[list[_Length], Field(min_length=2, max_length=2)]
    is_mirrored: bool
    space: Literal["grey", "rgb", "cmyk"]
    inks: dict[str, Any] | None

    def printed(self) -> Printed:
        """What levels stand for; `InputError` where inks are none."""
        space: Space = self.space
        try:
            return Printed(space, None if self.inks is None else _dyes(self.inks))
        except (TypeError, ValueError, KeyError) as error:
            raise InputError("the sidecar does not say of which inks films are: export them again") from error


def _dyes(said: dict[str, Any]) -> Dyes:
    """Inks of plain values."""
    gain = tuple(None if curve is None else np.array(curve) for curve in said["gain"])
    arrays = {name: np.array(said[name]) for name in ("extinction", "limit", "base", "scattering")}
    given = {**said, **arrays, "names": tuple(said["names"]), "label": np.array(said["label"], np.uint8), "gain": gain}
    return Dyes(**given)


def stack_of(path: Path, said: FilmFacts, heights_mm: tuple[float, ...], index: float) -> tuple[Volume, Stack, Reals]:
    """What the pages of films hold: extinction, the stack, and how far each film lies off, ``(films, 3)``, mm.

    Raises
    ------
    InputError
        Where the file is another program's, or there are more or fewer films than heights.
    """
    pages = [page for page in read_pages(path) if page.count == 1]
    if len(pages) != len(heights_mm):
        raise InputError(
            f"{path} has {counted(len(pages), 'film')}, and its stack {len(heights_mm)}: pages were lost or added, "
            "export it again"
        )
    printed, absorbance, cell_mm, off_mm = said.printed(), [], [], []
    with whole(path):
        for page in pages:
            (picture,) = page.pictures()
            absorbance.append(printed.absorbance(_cells(picture, said)))
            size_mm = np.array([picture.width_mm, picture.height_mm])
            cell_mm.append(size_mm / said.scale / said.cells[::-1])
            off_mm.append(_off(picture, said, page.width_mm))
    if np.ptp(cell_mm) > _ALIKE * np.max(cell_mm):
        raise InputError(f"films of {path} are not all of one size, or not square any more: export it again")
    voxel_mm = float(np.mean(cell_mm))
    stack = Stack((len(pages), *said.cells), voxel_mm, heights_mm=heights_mm, index=index)  # type: ignore[arg-type]
    off = np.array(off_mm)
    off[np.abs(off) < _STILL_MM] = 0
    return locked((np.stack(absorbance, axis=1) / voxel_mm).astype(np.float32)), stack, off


def _cells(picture: Placed, said: FilmFacts) -> Reals:
    """``(y, x, colour)``: the mean level of each cell, as it lies: printed on its lower side or the upper one."""
    ny, nx = said.cells
    rows, columns, colours = picture.levels.shape
    if rows % ny or columns % nx:
        raise InputError(
            f"a film of {columns} x {rows} dots does not fall into {nx} x {ny} cells: it was resized, export it again"
        )
    high, wide = rows // ny, columns // nx
    cells = np.empty((ny, nx, colours))
    for row in range(ny):  # row by row: a page may be large
        part = picture.levels[row * high : (row + 1) * high].reshape(high, nx, wide, colours)
        cells[ny - 1 - row] = part.sum(axis=(0, 2), dtype=np.int64) / (high * wide)
    return cells[:, ::-1] if picture.is_mirrored != said.is_mirrored else cells


def _off(picture: Placed, said: FilmFacts, page_width_mm: float) -> tuple[float, float, float]:
    """How far to the right, up and higher than it should be a film lies."""
    right = picture.left_mm + picture.width_mm / 2
    right = page_width_mm - right if said.is_mirrored else right
    up = picture.bottom_mm + picture.height_mm / 2
    return (right - said.middle_mm[0]) / said.scale[0], (up - said.middle_mm[1]) / said.scale[1], 0.0


def laid(cube: Cube, off_mm: Reals) -> Cube:
    """A stack with its films where they lie."""
    if not np.any(off_mm):
        return cube
    assert isinstance(cube.grid, Stack)  # noqa: S101 - made of films
    return replace(cube, rig=misplaced(cube.rig, cube.grid, off_mm))
