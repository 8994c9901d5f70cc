"""Films as one likes to see them: thin sheets with air between, each in its own colours, clearer than they are."""

from __future__ import annotations

import numpy as np

from lightcube.drawing.camera import Canvas, Floats, Reals
from lightcube.drawing.glass import Seen, clearer, enter, whole_pixels
from lightcube.drawing.stacks import sheets
from lightcube.drawing.standing import Standing
from lightcube.errors import InputError
from lightcube.optics.cube import Cube
from lightcube.optics.stack import Stack

#: How much of a film shines, and how that grows with the purity of its colour.
_SHINES, _PURITY = 0.45, 3.0
#: Part of the room that a film mirrors, seen upright, and how much more along it.
_MIRRORS, _ALONG = 0.012, 0.35
#: A box round the films is so much larger than they are, in cells: one film has no height.
_ROUND = 0.5


class FilmGlass:
    """A stack's films, laid out for eyes; the same as `lightcube.drawing.glass.Glass` is of a cube."""

    def __init__(self, cube: Cube) -> None:
        if not isinstance(cube.grid, Stack):
            raise InputError("only a stack has films: draw a cube as glass")
        self._stack = cube.grid
        channels = [min(channel, len(cube.extinction) - 1) for channel in range(3)]
        absorbed = np.moveaxis(cube.extinction[channels], 0, -1) * cube.grid.voxel_mm
        # around each film nothing: what lies beside it meets that
        self._films = np.pad(absorbed.astype(np.float32), ((0, 0), (1, 1), (1, 1), (0, 0)))

    def seen(self, canvas: Canvas, now: Standing, ember: Reals, bare: float) -> Seen | None:
        """What the canvas's eye sees of the films, None where that is nothing; as `Glass.seen`."""
        corners = sheets(self._stack, now.films).reshape(-1, 3)
        spare = _ROUND * self._stack.voxel_mm
        region = enter(canvas, corners.min(axis=0) - spare, corners.max(axis=0) + spare, np.eye(3))
        if region is None:
            return None
        pixels, shape = whole_pixels(region)
        ways = canvas.ways(pixels).reshape(-1, 3)
        upright = np.abs(ways[:, 2]) / np.linalg.norm(ways, axis=1)
        absorbed, shining = np.zeros((2, len(ways), 3), np.float32)
        clear, unveiled = np.ones((2, len(ways), 1), np.float32)
        order = np.argsort(np.abs(now.films[:, 6] - canvas.eye[2]), kind="stable")  # no ray meets films on both sides
        mirror = (_MIRRORS + _ALONG * (1 - upright) ** 4)[:, None].astype(np.float32)
        for film in order:
            met, colours = self._met(canvas.eye, ways, film, now.films[film])
            colours = colours * (1 / np.maximum(upright, 1e-3)).astype(np.float32)[:, None]
            high, low = colours.max(axis=1, keepdims=True), colours.min(axis=1, keepdims=True)
            part = unveiled * -np.expm1(-_SHINES * np.log1p(_PURITY * (high - low)))
            shining += part * (high - colours) / np.maximum(high - low, np.float32(1e-6))
            unveiled -= part
            absorbed += colours
            clear *= 1 - mirror * met[:, None]
        through = (1 - bare) * clearer(absorbed) + bare * np.exp(-absorbed)
        more = (1 - bare) * np.asarray(ember) * shining
        mirrors = (1 - bare) * (1 - clear)
        found = [each.astype(np.float32).reshape(*shape, -1) for each in (through, more, mirrors, 0 * clear)]
        return Seen(pixels, found[0], found[1], found[2], found[3], canvas.glass[pixels])

    def _met(self, eye: Reals, ways: Reals, film: int, place: Reals) -> tuple[Floats, Floats]:
        """Whether each ray meets a film, and the absorbance of the cell that it meets there."""
        _, ny, nx = self._stack.shape
        with np.errstate(divide="ignore", invalid="ignore"):
            far = (place[6] - eye[2]) / ways[:, 2]
        far = np.where(np.isfinite(far) & (far > 0), far, np.nan)
        at = eye[:2] + far[:, None] * ways[:, :2]
        u, v = (at @ place[:4].reshape(2, 2).T + place[4:6]).T / self._stack.voxel_mm
        rows, columns = (
            np.clip(np.nan_to_num(np.floor(each + count / 2), nan=-1), -1, count).astype(np.intp)
            for each, count in ((v, ny), (u, nx))
        )
        met = (rows >= 0) & (rows < ny) & (columns >= 0) & (columns < nx)
        return met.astype(np.float32), self._films[film][rows + 1, columns + 1]
