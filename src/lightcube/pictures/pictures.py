"""Pictures as they were read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Images, Reals, owned
from lightcube.optics.checks import check_fields
from lightcube.optics.grid import check_elevation
from lightcube.optics.transfer import Transfer
from lightcube.optics.views import check_angles
from lightcube.wording import counted


@dataclass(frozen=True, eq=False)
class Pictures:
    """Pictures of any sizes as they were read, before they are fitted to a screen.

    Parameters
    ----------
    images
        Each ``(row, column, 3)`` float32 in linear light, 1 = white.
    names
        One name per picture, for people.
    angles_deg
        Turntable angles in degrees that came with the pictures, or None.
    elevation_deg
        Elevation of the lamp in degrees that came with the pictures, or None.
    transfer
        How the display values were decoded.
    focus
        What stays in the middle, as far as it can, of pictures that are cropped: parts of their width and height, from
        their upper left.
    opacities
        How opaque each was before it was put on white, ``(row, column)`` from 0 to 1, None of those that are all
        opaque; () where nothing is known of it.

    Examples
    --------
    >>> import numpy as np, lightcube as lc
    >>> lc.Pictures([np.full((4, 6, 3), level) for level in (0.2, 0.8)], ("dark", "pale"))
    <2 pictures of 4 x 6 pixels>
    """

    images: tuple[Images, ...]
    names: tuple[str, ...]
    angles_deg: Reals | None = None
    elevation_deg: float | None = None
    transfer: Transfer = "srgb"
    focus: tuple[float, float] = (0.5, 0.5)
    opacities: tuple[Images | None, ...] = ()

    def __post_init__(self) -> None:
        check_fields(self)
        object.__setattr__(self, "images", tuple(owned(image, np.float32) for image in self.images))
        if len(self.names) != len(self.images):
            raise InputError(
                f"{counted(len(self.images), 'picture')} with {counted(len(self.names), 'name')}: "
                "give one name per picture"
            )
        for name, image in zip(self.names, self.images, strict=True):
            if image.ndim != 3 or image.shape[2] != 3 or image.size == 0:
                raise InputError(f"picture {name} has shape {image.shape}, not (rows, columns, 3)")
        if self.angles_deg is not None:
            angles_deg = owned(check_angles(self.angles_deg), np.float64)
            if len(angles_deg) != len(self.images):
                raise InputError(
                    f"{counted(len(angles_deg), 'angle')} for {counted(len(self.images), 'picture')}: "
                    "give one angle per picture"
                )
            object.__setattr__(self, "angles_deg", angles_deg)
        if not all(0 <= part <= 1 for part in self.focus):
            x, y = self.focus
            raise InputError(f"the focus {x:g},{y:g} is outside the picture: give two numbers from 0 to 1")
        if self.elevation_deg is not None:
            check_elevation(self.elevation_deg)
        self._check_opacities()

    def _check_opacities(self) -> None:
        """Raise `InputError` where there is not one opacity for each picture, of its size."""
        kept = tuple(None if each is None else owned(each, np.float32) for each in self.opacities)
        sizes = [None if each is None else each.shape for each in kept]
        if kept and (
            len(kept) != len(self.images)
            or any(size not in (None, image.shape[:2]) for size, image in zip(sizes, self.images, strict=True))
        ):
            raise InputError(
                f"opacities of {counted(len(self.images), 'picture')} must be one each, of its size, or None"
            )
        object.__setattr__(self, "opacities", kept)

    def __len__(self) -> int:
        return len(self.images)

    def __repr__(self) -> str:
        sizes = sorted({image.shape[:2] for image in self.images})
        said = f"{sizes[0][0]} x {sizes[0][1]} pixels" if len(sizes) == 1 else f"{len(sizes)} sizes"
        return f"<{counted(len(self), 'picture')} of {said}>"
