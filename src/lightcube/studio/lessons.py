"""Class mode: silhouettes drawn in three boxes and the hull they make, and a small cube with its equations."""

from __future__ import annotations

import base64
import threading
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any, Literal

import numpy as np
from fastapi import APIRouter
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from lightcube import io
from lightcube.errors import InputError
from lightcube.optics.absorption import extinction, transmittance
from lightcube.optics.arrays import Flags, locked
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.transfer import to_uint8
from lightcube.optics.views import spread_angles
from lightcube.projection.projector import Projector
from lightcube.solids.reach import Reach, count_pieces, reach
from lightcube.solids.repair import Repaired, Way, repair
from lightcube.solids.shape import as_cube
from lightcube.solids.silhouettes import FINE, Silhouettes
from lightcube.solids.walls import WALLS, walls
from lightcube.solvers import METHODS
from lightcube.solvers.contract import Wanted
from lightcube.studio.desk import Desk
from lightcube.studio.makers import without_commands
from lightcube.studio.viewed import viewed
from lightcube.verbs import hull_words, hulls

#: Pixels along a side of the boxes to draw in, and mm of the block that they are the faces of.
SIDE, _SIZE_MM = 24, 100.0
#: Pictures that the small cube is asked for at most, over half a turn.
_MOST_VIEWS = 8
#: Of what is drawn, empty and filled; in what is lost a digit names the picture that is in the way, `x` none.
_EMPTY, _FULL = ".", "#"
#: A voxel is found where it is off by less than this part of the darkest.
_FOUND = 1e-3
_Row = Annotated[str, Field(pattern=f"^[.#]{{{SIDE}}}$")]
_Box = Annotated[list[_Row], Field(min_length=SIDE, max_length=SIDE)]


class Drawn(BaseModel):
    """What is drawn in the three boxes, row by row, how many of them are to count, and how they are to agree."""

    model_config = ConfigDict(extra="forbid")

    front: _Box
    side: _Box
    top: _Box
    count: Annotated[int, Field(ge=1, le=3)] = 3
    way: Way = "none"


def router(desk: Desk) -> APIRouter:
    """What class mode asks; it keeps nothing of the project."""
    made, one_at_a_time = APIRouter(prefix="/api/lessons"), threading.Lock()

    @made.post("/hull")
    def carved(drawn: Drawn) -> dict[str, Any]:
        """The solid of what is drawn, where it contradicts itself, and the solid as a scene to be turned."""
        with one_at_a_time:
            return solid(drawn)

    @made.post("/mesh/{suffix}")
    def mesh(suffix: Literal["stl", "3mf"], drawn: Drawn) -> dict[str, Any]:
        """The solid as a file for a 3-D printer, and what that file really casts."""
        with one_at_a_time:
            return printable(drawn, suffix)

    @made.get("/cube")
    def equations() -> dict[str, Any]:
        """The cube of 3 x 3 x 3 voxels: its pictures, their equations, and what they say of the voxels."""
        with one_at_a_time:
            return small_cube()

    return made


def solid(drawn: Drawn) -> dict[str, Any]:
    """The solid of what is drawn, or of what it becomes; `InputError` where nothing is left."""
    given = _silhouettes(drawn)
    found = reach(given, _grid())
    repaired = repair(given, _grid(), drawn.way)
    cast = repaired.shape.silhouettes.inside
    return {
        "names": list(WALLS),
        "lost": [_rows(_letters(found, number)) for number in range(len(WALLS))],
        "shares": found.shares.tolist(),
        "pieces": found.pieces,
        "is_one_piece": found.is_one_piece,
        "said": _said(found, drawn),
        "cast": [_rows(np.where(_coarse(each), _FULL, _EMPTY)) for each in cast],
        "overlaps": repaired.overlaps.tolist(),
        "repaired": _done(repaired),
        **viewed(as_cube(repaired.shape), "Your solid"),
    }


def printable(drawn: Drawn, suffix: Literal["stl", "3mf"]) -> dict[str, Any]:
    """A file of the solid, in base64, and what is to be said of it: it is read again and held beside the drawings."""
    repaired = repair(_silhouettes(drawn), _grid(), drawn.way)
    shape = replace(repaired.shape, provenance={"repair": {"way": repaired.way}})
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"solid.{suffix}"
        io.Output(path, "shape").write(shape)
        found, data = hulls.certificate(str(path), shape), path.read_bytes()
    said = hull_words.results(shape, found, count_pieces(shape.inside))
    return {
        "name": path.name,
        "data": base64.b64encode(data).decode(),
        "said": without_commands(said),
    }


def _grid() -> Grid:
    return Grid((SIDE, SIDE, SIDE), _SIZE_MM / SIDE)


def _silhouettes(drawn: Drawn) -> Silhouettes:
    """What is drawn on three walls; boxes that do not count yet leave everything."""
    boxes = np.ones((len(WALLS), SIDE, SIDE), np.bool_)
    for number, name in enumerate(WALLS[: drawn.count]):
        boxes[number] = [[letter == _FULL for letter in row] for row in getattr(drawn, name)]
        if not np.any(boxes[number]):
            raise InputError(f"the {name} is empty: draw something in its box")
    fine = boxes.repeat(FINE, axis=1).repeat(FINE, axis=2)
    return Silhouettes(locked(fine), walls(_grid()).rig(), WALLS)


def _coarse(fine: Flags) -> Flags:
    """Boxes' pixels of which half or more is dark."""
    return np.asarray(fine.reshape(SIDE, FINE, SIDE, FINE).mean(axis=(1, 3)) >= 0.5)


def _letters(found: Reach, number: int) -> NDArray[np.str_]:
    """Of each pixel that no object casts, which picture is in the way."""
    culprit = np.where(found.culprit[number] < 0, "x", found.culprit[number].astype(str))
    return np.where(found.unreachable[number], culprit, _EMPTY)


def _rows(letters: NDArray[np.str_]) -> list[str]:
    return ["".join(row) for row in letters.tolist()]


def _said(found: Reach, drawn: Drawn) -> list[str]:
    """Where silhouettes contradict each other, a sentence each."""
    said = []
    for number, name in enumerate(WALLS[: drawn.count]):
        blamed = [WALLS[other] for other, part in found.blamed(number) if other >= 0 and part > 0]
        if blamed:
            part = f"{100 * found.shares[number]:.0f} %" if found.shares[number] >= 0.01 else "a little"
            verb = "is" if len(blamed) == 1 else "are"
            who = f"the {' and the '.join(blamed)} {verb} empty there"
            said.append(f"No object casts {part} of the {name} while it stays inside the others: {who}.")
    if not found.is_one_piece and found.pieces > 1:
        said.append(f"The solid falls into {found.pieces} pieces.")
    return said or ["One object casts all of this."]


def _done(repaired: Repaired) -> str:
    """What was done so that they agree, in a sentence."""
    least = f"{100 * float(repaired.overlaps.min()):.0f} %"
    if repaired.way == "warp":
        moved = f"{repaired.moved_px:.1f} pixels on average"
        return f"The outlines were bent by {moved}. What is cast overlaps what you drew by {least} or more."
    if repaired.way == "trim":
        return f"What no object casts was left out. What is cast overlaps what you drew by {least} or more."
    if repaired.way == "grow":
        return f"What was missing was added to the others. What is cast overlaps what you drew by {least} or more."
    return ""


@lru_cache(maxsize=1)
def small_cube() -> dict[str, Any]:
    """The paper's cube: 27 tinted voxels, pictures of 5 x 3 pixels, and lengths that are the equations' numbers."""
    grid = Grid((3, 3, 3))
    truth = extinction(np.random.default_rng(2).uniform(0.3, 1.0, (3, 3, 3, 3)), grid.voxel_mm)
    every = Projector(grid, turntable(grid, spread_angles(_MOST_VIEWS)))
    columns: NDArray[np.float64] = truth.transpose(2, 3, 1, 0).reshape(9, 9).astype(np.float64)
    light = transmittance(every.forward(columns))
    lengths = every.forward(np.eye(9))
    views = lengths.reshape(_MOST_VIEWS, -1, 9)
    beams = views.shape[1]
    pictures = light.reshape(_MOST_VIEWS, beams, 3, 3).transpose(0, 2, 1, 3)[:, ::-1]
    tints = np.exp(-truth * grid.voxel_mm).transpose(1, 2, 3, 0)
    return {
        "angles_deg": spread_angles(_MOST_VIEWS).tolist(),
        "tints": to_uint8(tints.astype(np.float32)).tolist(),
        "absorbed": truth.transpose(1, 2, 3, 0).tolist(),
        "pictures": to_uint8(pictures.astype(np.float32)).tolist(),
        "light": pictures.tolist(),
        "lengths": views.tolist(),
        "found": [_found(grid, columns, count) for count in range(1, _MOST_VIEWS + 1)],
    }


def _found(grid: Grid, columns: NDArray[np.float64], count: int) -> dict[str, Any]:
    """What the first pictures say of the voxels: equations that count, and the paper's method of solving them."""
    angles_deg = spread_angles(_MOST_VIEWS)[:count]
    matrix = Projector(grid, turntable(grid, angles_deg))
    lengths = matrix.forward(np.eye(9))
    result = METHODS["row-reduction"].solve(matrix, Wanted(transmittance(matrix.forward(columns))), iterations=1)
    off = np.abs(result.x - columns).max(axis=1) / columns.max()
    tints = np.exp(-result.x * grid.voxel_mm).reshape(3, 3, 3, 3).transpose(2, 0, 1, 3)
    return {
        "pictures": count,
        "equations": int(np.count_nonzero(lengths.sum(axis=1) > 0)),
        "rank": int(np.linalg.matrix_rank(lengths)),
        "right": (off < _FOUND).tolist(),
        "tints": to_uint8(tints.astype(np.float32)).tolist(),
    }
