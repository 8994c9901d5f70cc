"""Flicker: how much of what is shown jumps from frame to frame."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import cast

import numpy as np
from numpy.typing import NDArray

from lightcube.optics.transfer import Transfer, to_uint8

Frame = NDArray[np.float32] | NDArray[np.uint8]

#: Of larger frames so many pixels are looked at, evenly.
_PIXELS = 1 << 16


class Flicker:
    """The share of pixels that jump by a fifth of the range from a frame to the next, on average."""

    #: A pixel jumps where a colour changes by so much of the range; frames flicker where more than so many pixels do.
    JUMP, MUCH = 0.2, 0.03

    def __init__(self) -> None:
        self._last: NDArray[np.int16] | None = None
        self._sum, self._pairs = 0.0, 0

    @property
    def share(self) -> float:
        """0 to 1; 0 of a single frame."""
        return self._sum / max(self._pairs, 1)

    @property
    def is_much(self) -> bool:
        """Whether it is hard to look at."""
        return self.share > self.MUCH

    def see(self, frame: Frame) -> None:
        """Take the next frame, ``(row, column, channel)``."""
        every = max(1, int(np.sqrt(frame.shape[0] * frame.shape[1] / _PIXELS)))
        now = frame[::every, ::every].astype(np.int16)
        if self._last is not None:
            self._sum += float(np.mean(np.max(np.abs(now - self._last), axis=2) >= 255 * self.JUMP))
            self._pairs += 1
        self._last = now

    def watched(self, frames: Iterable[Frame], transfer: Transfer) -> Iterator[Frame]:
        """Yield frames, of linear light or of 8-bit display levels, that were seen."""
        for frame in frames:
            self.see(frame if frame.dtype == np.uint8 else to_uint8(cast("NDArray[np.float32]", frame), transfer))
            yield frame
