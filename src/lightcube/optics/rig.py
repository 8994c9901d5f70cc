"""How the shadows of one or more lamps make a picture, where the lamps and screens of a stage stand.

A picture is a sum over its views of ``P g (1 - a (1 - T))``: P the lamp's power, g the light of a lamp of power 1 that
reaches the pixel past no cube, T the transmittance of the beam, and a the strength of the shadow, which fades with
distance. Lengths are mm, everything is in the cube's own frame, as in `lightcube.optics.views`.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lightcube.errors import InputError
from lightcube.optics.views import Views, hold_offsets, rotations, smallest_gap

Reals = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Lighting:
    """Which views make which picture, under which lamp and how strong; views of a picture follow each other.

    Parameters
    ----------
    picture
        ``(views,)``: the picture that each view adds to, ascending from 0, none left out.
    lamp
        ``(views,)``: the lamp of each view, a number into `lamp_names`.
    share
        ``(views, channels)`` of at least 0: the lamp's colour, divided among the samples of its disc and of pixels.
    reach_mm, falloff_mm
        ``(views, 2)``, of the lamp and of the screen: so far behind the cube the shadow keeps its full strength, and
        over each such length beyond it fades to 1/e (0 = it ends there). Both apply.
    full_at_mm
        ``(views,)``: so far from it a point lamp shows its power, and elsewhere by the inverse square of the distance;
        infinity = the same everywhere.
    disc_deg
        ``(views,)``: angular diameter of the lamp's disc as seen from the cube's middle, degrees, of which the view is
        the middle; 0 where it has none, or the view is a sample of it (`sampled`).
    cosine
        ``(views,)`` bool: whether light that falls aslant on the screen is spread over more of it.
    turning
        ``(views, 2)`` bool: whether the lamp, and the screen, goes round the cube when the table turns.
    way
        ``(views, 2)``: which way they then go round, in the cube's frame, as the angle rises: 1 counter-clockwise
        about `axis`, else -1.
    axis
        ``(3,)``, of the turntable.
    angle, screen
        ``(pictures,)``: angle of the stop (degrees), and the screen, a number into `screen_names`.
    window
        ``(pictures, 2)``: how many rows and columns of the picture, from its upper left, lie on the screen.
    least, most
        ``(lamps,)``: bounds of each lamp's power, equal where it is fixed.
    lamp_names, screen_names
        For people.
    """

    picture: NDArray[np.intp]
    lamp: NDArray[np.intp]
    share: Reals
    reach_mm: Reals
    falloff_mm: Reals
    full_at_mm: Reals
    disc_deg: Reals
    cosine: NDArray[np.bool_]
    turning: NDArray[np.bool_]
    way: Reals
    axis: Reals
    angle: Reals
    screen: NDArray[np.intp]
    window: NDArray[np.intp]
    least: Reals
    most: Reals
    lamp_names: tuple[str, ...]
    screen_names: tuple[str, ...]

    def __post_init__(self) -> None:
        views, pictures, lamps = len(self.picture), len(self.angle), len(self.lamp_names)
        shapes: dict[str, tuple[type, tuple[int, ...]]] = {
            **dict.fromkeys(("picture", "lamp"), (np.intp, (views,))),
            "share": (np.float64, (views, np.shape(self.share)[-1])),
            **dict.fromkeys(("reach_mm", "falloff_mm", "way"), (np.float64, (views, 2))),
            **dict.fromkeys(("full_at_mm", "disc_deg"), (np.float64, (views,))),
            "cosine": (np.bool_, (views,)),
            "turning": (np.bool_, (views, 2)),
            "axis": (np.float64, (3,)),
            "angle": (np.float64, (pictures,)),
            "screen": (np.intp, (pictures,)),
            "window": (np.intp, (pictures, 2)),
            **dict.fromkeys(("least", "most"), (np.float64, (lamps,))),
        }
        for name, (kind, shape) in shapes.items():
            array: NDArray[Any] = np.array(getattr(self, name), dtype=kind)
            if array.shape != shape:
                raise InputError(f"{name} of a lighting has shape {array.shape}, not {shape}")
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        steps = np.diff(self.picture, prepend=-1, append=pictures)
        if not (views and pictures) or np.any((steps != 0) & (steps != 1)) or steps[0] != 1 or steps[-1] != 1:
            raise InputError("views of a lighting must be in the order of their pictures, none of which is left out")
        if np.any(self.share < 0) or not np.all((self.least > 0) & (self.least <= self.most)):
            raise InputError("a lighting's shares must be at least 0, and its lamps' powers above 0, least before most")
        for numbers, names in ((self.lamp, self.lamp_names), (self.screen, self.screen_names)):
            if np.any((numbers < 0) | (numbers >= len(names))):
                raise InputError("a lighting's lamps and screens must be numbers of the names that it has, from 0")
        object.__setattr__(self, "lamp_names", tuple(self.lamp_names))
        object.__setattr__(self, "screen_names", tuple(self.screen_names))

    @property
    def pictures(self) -> int:
        """How many pictures there are."""
        return len(self.angle)

    @cached_property
    def pairs(self) -> NDArray[np.intp]:
        """``(pairs, 2)``: every (picture, lamp) once, in order; each pair has lamp powers of its own."""
        found: NDArray[np.intp] = np.unique(np.stack([self.picture, self.lamp], axis=1), axis=0)
        return found

    @cached_property
    def pair(self) -> NDArray[np.intp]:
        """``(views,)``: which of the `pairs` each view belongs to."""
        keys = self.pairs[:, 0] * len(self.lamp_names) + self.pairs[:, 1]
        return np.searchsorted(keys, self.picture * len(self.lamp_names) + self.lamp)

    @property
    def starts(self) -> NDArray[np.intp]:
        """``(pictures + 1,)``: the views of picture p are those from ``starts[p]`` to before ``starts[p + 1]``."""
        return np.searchsorted(self.picture, np.arange(self.pictures + 1))

    @property
    def is_plain(self) -> bool:
        """Whether every picture is the unfaded shadow of one lamp: then the problem is convex."""
        return bool(
            len(self.picture) == self.pictures
            and np.all(self.share == 1)
            and np.all(np.isinf(self.reach_mm))
            and np.all(np.isinf(self.full_at_mm))
            and not np.any(self.cosine)
        )

    def inside(self, picture_shape: tuple[int, int]) -> NDArray[np.bool_]:
        """``(pictures, rows, columns)``: the pixels that lie on their screen."""
        rows, columns = (np.arange(count) for count in picture_shape)
        inside: NDArray[np.bool_] = (rows[:, None] < self.window[:, :1, None]) & (columns < self.window[:, 1:, None])
        return inside

    def take(self, pictures: Sequence[int] | NDArray[np.integer]) -> tuple["Lighting", NDArray[np.intp]]:
        """Some of the pictures, in this order, and the numbers of the views that belong to them.

        A picture may come several times.
        """
        starts = self.starts
        views = np.concatenate([np.arange(starts[p], starts[p + 1]) for p in pictures])
        counts = [starts[p + 1] - starts[p] for p in pictures]
        per_view = {each.name: getattr(self, each.name)[views] for each in fields(self) if each.name in _PER_VIEW}
        per_picture = {name: getattr(self, name)[np.asarray(pictures)] for name in ("angle", "screen", "window")}
        taken = per_view | per_picture | {"picture": np.repeat(np.arange(len(counts)), counts)}
        return replace(self, **taken), views


_PER_VIEW = ("lamp", "share", "reach_mm", "falloff_mm", "full_at_mm", "disc_deg", "cosine", "turning", "way")


def turned_by(views: Views, lighting: Lighting, degrees: ArrayLike) -> Views:
    """Views of a stage when the table has turned on by so many degrees: one number, or one per view."""
    angles = np.broadcast_to(np.asarray(degrees, np.float64), len(views))
    lamp, screen = (
        rotations(lighting.axis, np.where(lighting.turning[:, i], lighting.way[:, i] * angles, 0.0)) for i in (0, 1)
    )
    shone = np.einsum("vij,vj->vi", lamp, views.lamps[:, :3])
    origins, right, down = (
        np.einsum("vij,vj->vi", screen, vectors) for vectors in (views.origins, views.column_steps, views.row_steps)
    )
    return Views(np.column_stack([shone, views.lamps[:, 3]]), origins, right, down, views.picture_shape)


def held_lighting(
    views: Views, lighting: Lighting, hold_deg: float, step_deg: float
) -> tuple[Views, Lighting, NDArray[np.intp]]:
    """Every picture at several angles within `hold_deg` degrees of its stop, at most `step_deg` apart.

    Also returns ``(views,)``: the number of the given view that each one is a copy of.

    Raises
    ------
    InputError
        Where `hold_deg` is negative, or wider than half the way to the nearest other stop of a screen.
    """
    gaps = [smallest_gap(lighting.angle[lighting.screen == screen], 360.0) for screen in np.unique(lighting.screen)]
    offsets = hold_offsets(hold_deg, min(gaps) / 2, step_deg)
    repeated, kept = lighting.take(np.repeat(np.arange(lighting.pictures), len(offsets)))
    turn = np.tile(offsets, lighting.pictures)
    moved = turned_by(views.take(kept), repeated, turn[repeated.picture])
    return moved, replace(repeated, angle=repeated.angle + turn), kept


def sampled(
    views: Views, lighting: Lighting, *, lamp_samples: int = 1, pixel_samples: int = 1
) -> tuple[Views, Lighting]:
    """Each view as several, whose mean is the light of a lamp's whole disc on a whole pixel.

    Parameters
    ----------
    lamp_samples
        Points that the disc of a lamp with a size is sampled at, spread evenly over it like a sunflower's seeds
        (H. Vogel, A better way to construct the sunflower head, 1979). The disc faces the cube's middle.
    pixel_samples
        Points along each side of a pixel that it is averaged over; 1 = its middle.
    """
    if not 1 <= lamp_samples <= 1024 or not 1 <= pixel_samples <= 16:
        raise InputError("take 1 to 1024 samples of a lamp's disc, and 1 to 16 along the side of a pixel")
    seeds = [_seeds(*each, lamp_samples) for each in zip(views.lamps, lighting.disc_deg, strict=True)]
    fine = (np.arange(pixel_samples) + 0.5) / pixel_samples - 0.5
    down, right = (each.ravel() for each in np.meshgrid(fine, fine, indexing="ij"))
    copies = np.array([len(each) * len(fine) ** 2 for each in seeds])
    kept = np.repeat(np.arange(len(views)), copies)
    lamps = np.concatenate([np.repeat(each, len(fine) ** 2, axis=0) for each in seeds])
    spread = np.concatenate([np.tile(np.stack([right, down], axis=1), (len(each), 1)) for each in seeds])
    steps = views.column_steps[kept], views.row_steps[kept]
    origins = views.origins[kept] + spread[:, :1] * steps[0] + spread[:, 1:] * steps[1]
    copied = {name: getattr(lighting, name)[kept] for name in _PER_VIEW}
    copied |= {"share": copied["share"] / copies[kept, None], "picture": lighting.picture[kept]}
    if lamp_samples > 1:
        copied["disc_deg"] = np.zeros(len(kept))
    return Views(lamps, origins, *steps, views.picture_shape), replace(lighting, **copied)


def _seeds(lamp: Reals, disc_deg: float, samples: int) -> Reals:
    """Points of a lamp's disc, homogeneous, ``(samples, 4)``; the lamp itself where that is a point."""
    if disc_deg == 0 or samples == 1:
        return lamp[None]
    number = np.arange(samples) + 0.5
    radius = math.tan(math.radians(disc_deg / 2)) * np.sqrt(number / samples) * np.linalg.norm(lamp[:3])
    turn = number * (math.pi * (3 - math.sqrt(5)))
    aside = np.cross(lamp[:3], (0.0, 0.0, 1.0) if np.hypot(lamp[0], lamp[1]) > abs(lamp[2]) else (1.0, 0.0, 0.0))
    beside = np.cross(lamp[:3], aside)
    disc = sum(
        np.outer(radius * wave(turn), way / np.linalg.norm(way)) for wave, way in ((np.cos, aside), (np.sin, beside))
    )
    disc -= np.mean(disc, axis=0)  # the mean of a few seeds is not quite the middle
    return np.asarray(lamp + np.column_stack([disc, np.zeros(samples)]))


#: The lower bound of the power of a lamp that is not fixed.
LAMP_MIN = 1e-4
