"""Which pictures of a film or an animation are read: a part of it, every so many, at most so many."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from lightcube.errors import InputError


@dataclass(frozen=True)
class Excerpt:
    """Which pictures of a film are read.

    Parameters
    ----------
    from_s, to_s
        Seconds at which the part begins and ends that is read; None = with the film.
    every
        Of that part the first picture is read, and from there on every so many.
    most
        Of these at most so many, evenly spread; None = all.
    """

    from_s: float | None = None
    to_s: float | None = None
    every: int = 1
    most: int | None = None

    def __post_init__(self) -> None:
        for second in (self.from_s, self.to_s):
            if second is not None and not (math.isfinite(second) and second >= 0):
                raise InputError(f"a part of a film lies between numbers of seconds from 0 on, not at {second}")
        begin, end = self.from_s or 0.0, math.inf if self.to_s is None else self.to_s
        if begin >= end:
            raise InputError(
                f"the part of a film from {begin:g} s to {end:g} s is none: let it begin (--from) before it ends (--to)"
            )
        if self.every < 1 or (self.most is not None and self.most < 1):
            raise InputError("every and most are numbers of pictures of a film: give at least 1")

    @property
    def is_whole(self) -> bool:
        """Whether all pictures are read."""
        return self == Excerpt()

    @property
    def is_timed(self) -> bool:
        """Whether seconds are said."""
        return self.from_s is not None or self.to_s is not None

    def numbers(self, path: Path, times: Sequence[float | None]) -> tuple[list[int], int]:
        """Numbers, from 0, of the pictures that are read by the times at which they are shown, seconds.

        Returns them and how many there are without `most`; `InputError` where there is none, or no time is known.
        """
        if self.is_timed and None in times:
            raise InputError(f"{path} says no times of its pictures: leave --from and --to out, use --every or --most")
        begin, end = self.from_s or 0.0, math.inf if self.to_s is None else self.to_s
        part = [number for number, time in enumerate(times) if begin <= (time or 0.0) < end or not self.is_timed]
        if not part and times:
            raise InputError(f"{path} ends after {max(time or 0.0 for time in times):.3g} s: let --from be earlier")
        some = part[:: self.every]
        count = len(some) if self.most is None else min(self.most, len(some))
        # The middles of equal parts: what fades in at the very beginning is none of them.
        return [some[(2 * place + 1) * len(some) // (2 * count)] for place in range(count)], len(some)


class Read(NamedTuple):
    """Numbers, from 0, of the pictures that were read of a file, of how many, and what had to be changed in them.

    The latter as rests of sentences that begin with the file's name.
    """

    numbers: Sequence[int]
    of: int
    changed: Sequence[str] = ()
