"""Pictures as they are wanted on the screens of a rig."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Flags, Images, Indices, Reals, as_indices, locked, owned
from lightcube.optics.checks import check_fields
from lightcube.optics.rig import Rig
from lightcube.optics.transfer import Transfer
from lightcube.wording import counted


@dataclass(frozen=True, eq=False)
class Targets:
    """Pictures wanted on the screens of a rig.

    Parameters
    ----------
    pictures
        ``(picture, row, column, channel)`` float32 in linear light; 1 = what the white lamp of power 1 shows.
    rig
        Lamps and screens of each picture.
    weights
        ``(picture, row, column)`` float32 of at least 0, 0 = don't care; default 1 where the screen is.
    names
        One name per picture; default ``"1"``, ``"2"``, …
    transfer
        How display values follow from linear light, for whoever shows or scores the pictures.

    Raises
    ------
    InputError
        Where shapes disagree, or a number is negative, NaN or infinite.
    """

    pictures: Images
    rig: Rig
    weights: Images | Flags | None = None
    names: tuple[str, ...] = ()
    transfer: Transfer = "srgb"

    def __post_init__(self) -> None:
        check_fields(self)
        pictures = owned(self.pictures, np.float32, order="C")
        expected = (len(self.rig), *self.rig.picture_shape)
        if pictures.ndim != 4 or pictures.shape[:3] != expected:
            raise InputError(
                f"pictures of shape {pictures.shape} do not fit the rig, which wants {expected} and a channel: "
                "fit them to it"
            )
        if self.rig.sums.share.shape[1] not in (1, pictures.shape[3]):
            raise InputError(
                f"a rig of {self.rig.sums.share.shape[1]} colours does not fit {pictures.shape[3]}: give one of as many"
            )
        names = self.names or tuple(str(i + 1) for i in range(len(pictures)))
        if len(names) != len(pictures):
            raise InputError(
                f"{counted(len(pictures), 'picture')} with {counted(len(names), 'name')}: give one name per picture"
            )
        weights = owned(self.rig.inside if self.weights is None else self.weights, np.float32)
        if weights.shape != expected:
            raise InputError(f"weights have shape {weights.shape}, not {expected}")
        for what, array in (("picture", pictures), ("weights of picture", weights)):
            bad = ~np.isfinite(array) | (array < 0)
            if np.any(bad):
                view = int(np.argwhere(bad)[0][0])
                raise InputError(
                    f"{what} {names[view]!r} holds negative or non-finite numbers: mend or leave out that picture"
                )
        blank = np.max(weights, axis=(1, 2)) == 0
        if np.any(blank):
            raise InputError(f"picture {names[int(np.argmax(blank))]!r} has no pixel of weight above 0: leave it out")
        object.__setattr__(self, "pictures", pictures)
        object.__setattr__(self, "weights", weights)
        object.__setattr__(self, "names", names)

    def __len__(self) -> int:
        return len(self.pictures)

    def __repr__(self) -> str:
        return f"<{counted(len(self), 'picture')} wanted on {self.rig!r}>"

    @property
    def weight(self) -> Images:
        """The weights, ``(picture, row, column)``, never None."""
        return cast(Images, self.weights)  # __post_init__ made it so

    @property
    def angles_deg(self) -> Reals:
        """Turntable angle of each picture's stop, degrees."""
        return self.rig.stops.angle_deg

    def take(self, indices: Indices) -> Targets:
        """Return some of them, in the order of `indices`."""
        chosen = as_indices(indices, len(self), "targets")
        return replace(
            self,
            pictures=locked(self.pictures[chosen]),
            rig=self.rig.take(chosen),
            weights=locked(self.weight[chosen]),
            names=tuple(self.names[i] for i in chosen),
        )
