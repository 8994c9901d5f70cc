"""How light goes through a stack of films: where each view's beams meet each film.

Between films that lie in acrylic or glass light is less aslant than in the air, by Snell's law: ``sin(inside) =
sin(outside) / index``. What lies between the lowest and the highest film of a picture is full of it, and faces are
flat; pixels below or above lie in air. Light that is reflected at faces is left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lightcube.errors import InputError
from lightcube.kernels.films import CORNER, FIELDS, LAMP, LENGTH, NEAR, RIGHT, SLOPE, UP
from lightcube.optics.arrays import Reals
from lightcube.optics.moves import places_of
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack

#: Light is along the films where the cosine to their normal is smaller than this.
_EDGE_ON = 1e-3
#: A part of a vector smaller than this, beside its others, is none.
_NONE = 1e-9


@dataclass(frozen=True, eq=False)
class Paths:
    """Beams of a rig's views through the films.

    Parameters
    ----------
    table
        ``(views, FIELDS)``, as `lightcube.kernels.films` has them.
    places
        ``(views, films, 7)``: where each film lies, as in `lightcube.optics.tables.Stops`.
    """

    table: Reals
    places: Reals

    @cached_property
    def lines(self) -> Reals:
        """``(views, films, 2, 3)``: u and v of where a beam meets a film, of its ``(column, row, 1)``, mm."""
        height = self.places[..., 6]
        corner, right, up = (self.table[:, None, field : field + 3] for field in (CORNER, RIGHT, UP))
        lamp, slope = (self.table[:, None, field : field + size] for field, size in ((LAMP, 3), (SLOPE, 2)))
        near = self.table[:, None, NEAR] == 1
        away = np.where(near, corner[..., 2] - lamp[..., 2], 1.0)
        part = np.where(near, (height - lamp[..., 2]) / away, 1.0)[..., None]  # of the way from a near lamp
        base = np.where(near[..., None], lamp + part * (corner - lamp), corner + 0 * part)
        steps = (part * right, 0.0), (part * up, 0.0), (base, height)
        at = np.stack([step[..., :2] + slope * (z - step[..., 2])[..., None] for step, z in steps], axis=-1)
        turned = self.places[..., :4].reshape(*height.shape, 2, 2) @ at
        turned[..., 2] += self.places[..., 4:6]
        return np.asarray(turned)

    @cached_property
    def are_aligned(self) -> bool:
        """Whether the sides of all films' cells run along the sides of all pixels, seen along the light."""
        near = self.table[:, NEAR] == 1
        if np.any(np.abs(self.table[near][:, [RIGHT + 2, UP + 2]]) > _NONE * _length(self.table[near])[:, None]):
            return False
        if np.any(near) and not self._is_between:
            return False
        steps = np.abs(self.lines[..., :2])
        small = steps < _NONE * np.max(steps, axis=(2, 3), keepdims=True)
        straight = small[..., 0, 1] & small[..., 1, 0]
        crossed = small[..., 0, 0] & small[..., 1, 1]
        return bool(np.all(straight | crossed))

    @property
    def _is_between(self) -> bool:
        """Whether all films lie between near lamps and their screens."""
        table, height = self.table[self.table[:, NEAR] == 1], self.places[self.table[:, NEAR] == 1][..., 6]
        ends = np.sort(np.stack([table[:, LAMP + 2], table[:, CORNER + 2]]), axis=0)[..., None]
        return bool(np.all((ends[0] <= height) & (height <= ends[1])))

    def along(self, view: int, film: int, axis: int) -> tuple[int, float, float]:
        """Which side of a film (0: its u, 1: its v) a view's columns (axis 0) or rows (1) run along, where, and how.

        Where the first one's middle lies, mm, and how far the next one is, of films that are aligned.
        """
        line = self.lines[view, film]
        which = int(np.argmax(np.abs(line[:, axis])))
        return which, float(line[which, 2]), float(line[which, axis])

    def slants(self, middles: Reals, axis: int) -> Reals:
        """The square of the slope along columns (axis 0) or rows (1), mm for each mm of z, at ``(views, …, count)``."""
        table = self.table
        near = table[:, NEAR] == 1
        step = table[:, RIGHT : RIGHT + 2] if axis == 0 else table[:, UP : UP + 2]
        main = np.argmax(np.abs(step), axis=1)
        every = np.arange(len(table))
        away = table[:, CORNER + 2] - table[:, LAMP + 2]
        away = np.where(near, away, 1.0)
        first = np.where(
            near, (table[every, CORNER + main] - table[every, LAMP + main]) / away, table[every, SLOPE + main]
        )
        more = np.where(near, step[every, main] / away, 0.0)
        shape = (-1, *[1] * (middles.ndim - 1))
        return np.asarray((first.reshape(shape) + more.reshape(shape) * middles) ** 2)


def paths(stack: Stack, rig: Rig) -> Paths:
    """Find where beams of a rig's views meet the films of a stack.

    Raises
    ------
    InputError
        Where light runs along the films, or a near lamp shines into anything but air.
    """
    views = rig.views
    places = places_of(stack, rig)[rig.sums.picture]
    rows, columns = rig.picture_shape
    near = views.lamps[:, 3] == 1
    right, up = views.column_steps_mm, -views.row_steps_mm
    corner = views.origins_mm - (columns - 1) / 2 * right - (rows - 1) / 2 * up
    table = np.zeros((len(views), FIELDS))
    table[:, NEAR], table[:, LAMP : LAMP + 3] = near, views.lamps[:, :3] * near[:, None]
    table[:, CORNER : CORNER + 3], table[:, RIGHT : RIGHT + 3], table[:, UP : UP + 3] = corner, right, up
    ways = np.where(near[:, None], views.origins_mm - views.lamps[:, :3], views.lamps[:, :3])
    upright = np.abs(ways[:, 2]) / np.linalg.norm(ways, axis=1)
    if np.any(upright < _EDGE_ON):
        raise InputError(
            f"the light of picture {int(rig.sums.picture[np.argmin(upright)]) + 1} runs along the films, which cast no "
            "picture then: let it fall on them from above or below"
        )
    if np.any(near) and stack.index != 1:
        raise InputError("a lamp that is near shines through films in air only: give it a direction, or index 1")
    outside = ways[:, :2] / ways[:, 2:]
    inside = _refracted(outside, stack.index)
    table[:, SLOPE : SLOPE + 2] = np.where(near[:, None], 0.0, inside)
    table[:, LENGTH] = np.where(near, 0.0, np.sqrt(1 + np.sum(inside**2, axis=1)))
    if stack.index != 1:
        table[:, CORNER : CORNER + 3] += _bent(table, places, outside - inside)
    return Paths(table, places)


def are_exact(stack: Stack, rig: Rig) -> bool:
    """Whether means over pixels can be taken exactly: cells' sides run along pixels'."""
    return paths(stack, rig).are_aligned


def _refracted(slopes: Reals, index: float) -> Reals:
    """Slopes inside what has an index of refraction, of those outside."""
    if index == 1:
        return slopes
    tangent = np.linalg.norm(slopes, axis=1)
    sine = tangent / np.sqrt(1 + tangent**2) / index
    ratio = np.where(tangent > 0, sine / np.sqrt(1 - sine**2) / np.where(tangent > 0, tangent, 1), 1 / index)
    return np.asarray(slopes * ratio[:, None])


def _bent(table: Reals, places: Reals, more: Reals) -> Reals:
    """``(views, 3)``: how far beams move aside because they are more aslant, by `more`, between pixel and films."""
    low, high = places[..., 6].min(axis=1), places[..., 6].max(axis=1)
    height = table[:, CORNER + 2]
    tilted = np.abs(table[:, [RIGHT + 2, UP + 2]]).max(axis=1) > _NONE * _length(table)
    if np.any(tilted):
        raise InputError("films in anything but air cast pictures on screens that lie along them only: tilt none")
    face = np.clip(height, low, high)
    return np.column_stack([more * (face - height)[:, None], np.zeros(len(table))])


def _length(table: Reals) -> Reals:
    """Length of each view's steps, mm."""
    return np.asarray(np.linalg.norm(table[:, RIGHT : RIGHT + 3], axis=1))
