"""Pictures, as read and as wanted on the screen."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.optics.rig import Rig
from lightcube.optics.transfer import Transfer
from lightcube.optics.views import check_angles


@dataclass(frozen=True, eq=False)
class Pictures:
    """Pictures of any sizes as they were read, before they are fitted to a screen.

    Parameters
    ----------
    images
        Each ``(row, column, 3)`` float32 in linear light, 1 = white.
    names
        One name per picture, for people.
    angles
        Turntable angles in degrees that came with the pictures, or None.
    elevation
        Elevation of the lamp in degrees that came with the pictures, or None.
    transfer
        How the display values were decoded.
    """

    images: tuple[NDArray[np.float32], ...]
    names: tuple[str, ...]
    angles: NDArray[np.float64] | None = None
    elevation: float | None = None
    transfer: Transfer = "srgb"

    def __post_init__(self) -> None:
        if len(self.names) != len(self.images):
            raise InputError(f"{len(self.images)} pictures have {len(self.names)} names: give one name per picture")
        for name, image in zip(self.names, self.images, strict=True):
            if image.ndim != 3 or image.shape[2] != 3 or image.size == 0:
                raise InputError(f"picture {name} has shape {image.shape}, not (rows, columns, 3)")
        if self.angles is not None and len(check_angles(self.angles)) != len(self.images):
            raise InputError(f"{len(self.angles)} angles for {len(self.images)} pictures: give one angle per picture")

    def __len__(self) -> int:
        return len(self.images)

    def __repr__(self) -> str:
        sizes = sorted({image.shape[:2] for image in self.images})
        said = f"{sizes[0][0]} x {sizes[0][1]} pixels" if len(sizes) == 1 else f"{len(sizes)} sizes"
        return f"<{len(self)} pictures of {said}>"


@dataclass(frozen=True, eq=False)
class Frames:
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

    pictures: NDArray[np.float32]
    rig: Rig
    weights: NDArray[np.float32] | None = None
    names: tuple[str, ...] = ()
    transfer: Transfer = "srgb"

    def __post_init__(self) -> None:
        pictures = np.ascontiguousarray(self.pictures, dtype=np.float32)
        expected = (len(self.rig), *self.rig.picture_shape)
        if pictures.ndim != 4 or pictures.shape[:3] != expected:
            raise InputError(
                f"pictures of shape {pictures.shape} do not fit the rig, which wants {expected} and a channel"
            )
        if self.rig.sums.share.shape[1] not in (1, pictures.shape[3]):
            raise InputError(f"a rig of {self.rig.sums.share.shape[1]} colours does not fit {pictures.shape[3]}")
        names = self.names or tuple(str(i + 1) for i in range(len(pictures)))
        if len(names) != len(pictures):
            raise InputError(f"{len(pictures)} pictures have {len(names)} names: give one name per picture")
        weights = np.asarray(self.rig.inside if self.weights is None else self.weights, np.float32)
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
        object.__setattr__(self, "names", tuple(names))

    def __len__(self) -> int:
        return len(self.pictures)

    def __repr__(self) -> str:
        return f"<{len(self)} pictures wanted on {self.rig!r}>"

    @property
    def weight(self) -> NDArray[np.float32]:
        """The weights, ``(picture, row, column)``, never None."""
        assert self.weights is not None  # noqa: S101 - __post_init__ filled it
        return self.weights

    @property
    def angles(self) -> NDArray[np.float64]:
        """Turntable angle of each picture's stop, degrees."""
        return self.rig.stops.angle

    def take(self, indices: list[int] | NDArray[np.integer] | slice) -> "Frames":
        """Return some of the frames, in the order of `indices`."""
        chosen = list(range(len(self))[indices] if isinstance(indices, slice) else indices)
        return replace(
            self,
            pictures=self.pictures[chosen],
            rig=self.rig.take(chosen),
            weights=self.weight[chosen],
            names=tuple(self.names[i] for i in chosen),
        )
