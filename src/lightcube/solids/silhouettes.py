"""Silhouettes on the pictures of a rig: what an opaque object may cast, and how far each place is from its edges."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Flags, Images, as_indices, keep, locked
from lightcube.optics.arrays import Indices as Which
from lightcube.optics.checks import check_fields
from lightcube.optics.rig import Rig
from lightcube.wording import counted

#: Small pixels along a side of a picture's: in these silhouettes are kept, cast and compared.
FINE = 4


@dataclass(frozen=True, eq=False)
class Silhouettes:
    """What an opaque object is to cast on each picture of a rig.

    Parameters
    ----------
    inside
        ``(picture, FINE * row, FINE * column)``: whether a small pixel is to be dark.
    rig
        Of which each picture is lit by one lamp.
    names
        One per picture.

    Raises
    ------
    InputError
        Where shapes disagree, or a silhouette is empty.
    """

    inside: Flags
    rig: Rig
    names: tuple[str, ...]

    def __post_init__(self) -> None:
        check_fields(self)
        keep(self, inside=np.bool_)
        rows, columns = self.rig.picture_shape
        wanted = (len(self.rig), FINE * rows, FINE * columns)
        if self.inside.shape != wanted:
            raise InputError(f"silhouettes of {self.rig!r} have shape {wanted}, not {self.inside.shape}")
        if len(self.names) != len(self.rig):
            raise InputError(f"{counted(len(self.rig), 'silhouette')} with {len(self.names)} names: give one name each")
        for name, shape in zip(self.names, self.inside, strict=True):
            if not np.any(shape):
                raise InputError(f"nothing of {name} is on its screen: let its shape stand where the block's shadow is")

    def __len__(self) -> int:
        return len(self.inside)

    def __repr__(self) -> str:
        return f"<{counted(len(self), 'silhouette')} on {self.rig!r}>"

    @cached_property
    def distances(self) -> Images:
        """``(picture, rows + 2 MARGIN, columns + 2 MARGIN)``: signed pixels from each one's middle to the edge."""
        from lightcube.kernels import hull, tasks  # here: the compiler comes with it

        around = FINE * hull.MARGIN
        inside = np.pad(self.inside, ((0, 0), (around, around), (around, around)))
        rows, columns = self.rig.picture_shape
        made = np.empty((len(self), rows + 2 * hull.MARGIN, columns + 2 * hull.MARGIN), np.float32)
        tasks.run(hull.signed_distances, len(self), 20 * inside.size, inside, FINE, made)
        return locked(made)

    def pixels(self) -> Flags:
        """``(picture, row, column)``: pixels whose middles are inside."""
        from lightcube.kernels.hull import MARGIN

        return np.asarray(self.distances[:, MARGIN:-MARGIN, MARGIN:-MARGIN] < 0)

    def take(self, pictures: Which) -> Silhouettes:
        """Some of them, in this order."""
        chosen = as_indices(pictures, len(self), "silhouettes")
        return Silhouettes(
            locked(self.inside[chosen]), self.rig.take(chosen), tuple(self.names[number] for number in chosen)
        )
