"""How a cube was made: pictures and glass from clear to finished, as the solver went."""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator

import numpy as np

from lightcube.backward.pieces import Step
from lightcube.drawing.films import FPS, ROOM, Film
from lightcube.drawing.shows import Levels, Show
from lightcube.drawing.tableau import Tableau
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.transfer import to_uint8
from lightcube.pictures.targets import Targets

#: Looks at the solver's cube at most: ever more seldom, since most of it is there after a tenth of the work.
_LOOKS = 40
#: Seconds that the clear block is shown, that all looks take at most and each of them, and that the last frame rests.
_CLEAR_S, _GROWS_S, _LOOK_S, _RESTS_S = 0.7, 5.0, 0.2, 2.0


class MakingOf:
    """Looks on while a cube is solved, and makes a movie of it: a callback of `lightcube.solve`.

    Each look takes about a second; the cube's bits are those of a solve that nobody looks at.

    Parameters
    ----------
    targets, grid
        What is solved for.
    size
        Rows and columns of the movie.
    fps
        Frames a second.

    Examples
    --------
    >>> import lightcube as lc, numpy as np
    >>> from lightcube.drawing.making import MakingOf
    >>> grid = lc.Grid((4, 6, 6))
    >>> rig = lc.turntable(grid, [20, 80], picture_shape=(4, 4))
    >>> targets = lc.scene_targets(lc.read_scene("gems"), rig, grid)
    >>> making = MakingOf(targets, grid, size=(54, 96))
    >>> cube = lc.solve(targets, grid, lc.Recipe(passes=5), callback=making).cube
    >>> making.film(cube).said
    '4 s: the cube as it was solved, from clear to finished'
    """

    def __init__(self, targets: Targets, grid: Grid, size: tuple[int, int] = ROOM, fps: float = FPS) -> None:
        colours = targets.pictures.shape[-1]
        clear = Cube(np.zeros((colours, *grid.shape), np.float32), grid, targets.rig, transfer=targets.transfer)
        self._size, self._fps, self._transfer = size, fps, targets.transfer
        self._from, self._angle_deg, self._next = Tableau(clear, size), float(clear.angles_deg[0]), 0
        self._kept = [self._look(self._from)]

    def __call__(self, step: Step) -> bool:
        """Look at the cube, if it is time; never stops the solver."""
        if step.cube is not None and step.done >= (self._next / _LOOKS) ** 3:
            self._next = math.floor(_LOOKS * math.cbrt(step.done)) + 1
            self._kept.append(self._look(Tableau(step.cube(), self._size, self._from)))
        return False

    def _look(self, tableau: Tableau) -> bytes:
        """A frame, packed: in memory there are many."""
        return zlib.compress(to_uint8(tableau.seen(self._angle_deg), self._transfer).tobytes(), 1)

    def _unpacked(self, kept: bytes) -> Levels:
        return np.frombuffer(zlib.decompress(kept), np.uint8).reshape(*self._size, 3)

    def film(self, cube: Cube) -> Film:
        """The movie, which ends with the cube as it is finished."""
        kept = [*self._kept, self._look(Tableau(cube, self._size, self._from))]
        clear, rest = round(_CLEAR_S * self._fps), round(_RESTS_S * self._fps)
        grows = max(1, round(min(_GROWS_S, _LOOK_S * (len(kept) - 1)) * self._fps))

        def frames() -> Iterator[Levels]:
            for _ in range(clear):
                yield self._unpacked(kept[0])
            number, one, other = -1, *(2 * [np.empty(0, np.float32)])
            for frame in range(1, grows + 1):
                place = frame / grows * (len(kept) - 1)
                if (here := min(int(place), len(kept) - 2)) != number:
                    number = here
                    one, other = (self._unpacked(each).astype(np.float32) for each in kept[here : here + 2])
                yield np.rint(one + (place - here) * (other - one)).astype(np.uint8)
            for _ in range(rest):
                yield self._unpacked(kept[-1])

        count = clear + grows + rest
        said = f"{count / self._fps:.0f} s: the cube as it was solved, from clear to finished"
        return Film(Show(frames(), count, self._size[0]), self._fps, self._transfer, said)
