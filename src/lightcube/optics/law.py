"""The law of light: what a screen shows.

A pixel shows the sum, over the views of its picture, of ``P g (1 - a (1 - T))``: P the power of the view's lamp times
its share, g the light of a lamp of power 1 that reaches the pixel past no cube, a the strength of the shadow, and
``T = e^-(A x)`` what the cube lets through. Of a view ``P g (1 - a)`` reaches the screen whatever the cube, and the
cube acts on ``P g a``. `lightcube.kernels.light` has this compiled: what is cast, what a solver is asked for, and the
figures of its progress are all made of it. `lightcube.kernels.convex` is the case of pictures of one whole view each.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from lightcube.errors import InputError
from lightcube.kernels.layout import columns_from_pictures
from lightcube.optics.grid import PARALLEL
from lightcube.optics.refraction import bent
from lightcube.optics.rig import Rig

if TYPE_CHECKING:
    from lightcube.kernels import light as kernels

Floats = NDArray[np.floating[Any]]
Reals = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Mixture:
    """How views add up to pictures: those of a picture follow each other.

    Parameters
    ----------
    starts
        ``(pictures + 1,)``: the views of picture p are those from ``starts[p]`` to before ``starts[p + 1]``.
    share
        ``(views, channels)`` of at least 0.
    light, shadow
        g and a, ``(views, pixels)``, of at least 0 and in [0, 1]: a view's pixels in the order of the matrix's
        equations and columns. Or ``(views, 1)``, where all pixels of a view are alike.

    Raises
    ------
    InputError
        Where these are not of the same views, or out of range.
    """

    starts: NDArray[np.intp]
    share: Reals
    light: Floats
    shadow: Floats

    def __post_init__(self) -> None:
        views = self.light.shape[0]
        if self.light.ndim != 2 or self.shadow.shape != self.light.shape or self.share.shape[:1] != (views,):
            raise InputError(
                f"light of shape {self.light.shape}, shadow of shape {self.shadow.shape} and share of shape "
                f"{self.share.shape} are not of the same views: give each of them for all"
            )
        if [*self.starts[:1], *self.starts[-1:]] != [0, views] or np.any(np.diff(self.starts) < 1):
            raise InputError(f"pictures must begin at views from 0 up to {views}, each with one at least")
        for name, values, most in (
            ("share", self.share, np.inf),
            ("light", self.light, np.inf),
            ("shadow", self.shadow, 1),
        ):
            if not within(values, 0, most):
                raise InputError(f"{name} must be finite and {'at least 0' if most == np.inf else 'from 0 to 1'}")

    @classmethod
    def of(
        cls,
        rig: Rig,
        channels: int,
        colours: slice = slice(None),
        rows: slice = slice(None),
    ) -> "Mixture":
        """How a rig's views add up; some colours or rows only."""
        starts, share = rig.starts, rig.sums.of_colours(channels)[:, colours]
        if rig.fading.is_none and rig.glass is None:
            return cls(starts, share, *np.ones((2, len(rig.views), 1), np.float32))
        light, shadow = (
            columns_from_pictures(each[:, rows, :, None]).reshape(len(rig.views), -1) for each in falling_light(rig)
        )
        return cls(starts, share, light, shadow)

    @classmethod
    def of_whole_views(cls, views: int, channels: int) -> "Mixture":
        """Each view a picture, under all of its lamp's light, whose shadow does not fade."""
        return cls(np.arange(views + 1), np.ones((views, channels)), *np.ones((2, views, 1), np.float32))

    def in_parts(self, parts: int, areas: Floats | None) -> "Mixture":
        """Each view as so many that follow each other, of parts of its pixels' `areas`, ``(views * parts, pixels)``."""
        if areas is None:
            return self
        light, shadow = (each.repeat(parts, axis=0) for each in (self.light, self.shadow))
        return Mixture(
            self.starts * parts, self.share.repeat(parts, axis=0), light * areas, np.broadcast_to(shadow, areas.shape)
        )

    def under(self, powers: Floats, dtype: DTypeLike | None = None) -> "kernels.Mixture":
        """The same for compiled loops, under lamps of powers ``(views, channels)``, all in `dtype`; None = as it is."""
        from lightcube.kernels.light import Mixture as Compiled  # here: the compiler comes with it

        numbers = powers * self.share, self.light, self.shadow
        return Compiled(self.starts, *(each.astype(dtype or each.dtype, copy=False) for each in numbers))


def shown_light(
    mixture: Mixture,
    powers: Floats,
    absorbance: Floats,
    picture_shape: tuple[int, int],
    pictures: NDArray[np.intp] | None = None,
) -> Floats:
    """What the screen shows, by the law.

    Parameters
    ----------
    powers
        ``(views, channels)``, of each view's lamp.
    absorbance
        ``A x`` of all views, as the matrix gives it: of level light or not, the numbers lie in the same order.
    picture_shape
        ``(rows, columns)``.
    pictures
        Numbers of those that are asked for; None = all.

    Returns
    -------
    ``(picture, row, column, channel)``, linear light in the dtype of `absorbance`, the top row first.
    """
    from lightcube.kernels.light import show  # here: the compiler comes with it

    asked = np.arange(len(mixture.starts) - 1) if pictures is None else pictures
    light = np.empty((len(asked), *picture_shape, powers.shape[1]), absorbance.dtype)
    show(mixture.under(powers), asked, absorbance.reshape(len(powers), -1), light)
    return light


def falling_light(rig: Rig, chosen: Sequence[int] | None = None) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Light g and strength of the shadow a of every pixel, ``(view, row, column)``, without the lamps' shares.

    Of all views, or of those that are `chosen`.

    With u the unit direction of the beam through the pixel at q, n the screen's normal and l the place of a point lamp:
    ``g = (full_at / |q - l|)^2 |u.n|``, each factor only where it is asked for, and
    ``a = exp(-max(0, u.q - reach) / falloff)``, a factor for the lamp and one for the screen. ``u.q`` is how far
    the light travels from where it is nearest to the cube's centre to the screen. Glass lets some light pass beside it,
    which has no shadow, and some through it (`lightcube.optics.refraction`): then g is their sum, times that above, and
    a the latter's part of it. A veil v has no shadow either: with it g becomes ``g + v``, and a ``a g / (g + v)``.
    """
    views, fading = rig.views, rig.fading
    rows, columns = views.picture_shape
    across = np.arange(columns) - (columns - 1) / 2
    along = np.arange(rows) - (rows - 1) / 2
    numbers = range(len(views)) if chosen is None else chosen
    light = np.ones((len(numbers), rows, columns), np.float32)
    shadow = np.ones_like(light)
    if rig.glass is not None:
        found = bent(rig, numbers)
        whole = found.beside + found.through
        light[:] = whole
        shadow[:] = np.divide(found.through, whole, where=whole > 0, out=np.ones_like(whole))
    for k, v in enumerate(numbers):
        asked = fading.cosine[v], np.isfinite(fading.full_at_mm[v]), np.isfinite(fading.reach_mm[v])
        if not np.any(np.hstack(asked)):
            continue
        pixels = (
            views.origins_mm[v]
            + along[:, None, None] * views.row_steps_mm[v]
            + across[None, :, None] * views.column_steps_mm[v]
        )
        ways = pixels - views.lamps[v, :3] if views.lamps[v, 3] else np.broadcast_to(views.lamps[v, :3], pixels.shape)
        lengths = np.maximum(np.linalg.norm(ways, axis=-1), PARALLEL)  # a lamp may stand on a pixel
        units = ways / lengths[..., None]
        if asked[0]:
            normal = np.cross(views.column_steps_mm[v], views.row_steps_mm[v])
            light[k] *= np.abs(units @ normal) / np.linalg.norm(normal)
        if asked[1] and views.lamps[v, 3]:
            light[k] *= (fading.full_at_mm[v] / lengths) ** 2
        travelled = np.sum(units * pixels, axis=-1)
        for reach, falloff in zip(fading.reach_mm[v], fading.falloff_mm[v], strict=True):
            shadow[k] *= fade(travelled, reach, falloff)
    veil = fading.veil[list(numbers), None, None].astype(np.float32)
    if np.any(veil):
        shaded = light * shadow
        light += veil
        shadow = np.divide(shaded, light, where=light > 0, out=shadow)
    return light, shadow


def fade(distance: Reals, reach: float, falloff: float) -> Reals:
    """Strength of a shadow so far behind the cube: 1 up to `reach`, then ``exp(-(distance - reach) / falloff)``."""
    beyond = np.maximum(distance - reach, 0)
    if falloff == 0:
        return np.where(beyond > 0, 0.0, 1.0)
    return np.asarray(np.exp(-beyond / falloff))


def within(values: Floats, least: float, most: float) -> bool:
    """Whether all numbers are finite and within bounds; False where one is NaN."""
    return values.size == 0 or bool(values.min() >= least and values.max() <= most and values.max() < np.inf)
