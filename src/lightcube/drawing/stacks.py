"""Where light goes in the room of a stack of films, and where its pictures are seen: on a sheet below the films."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lightcube.optics.arrays import Reals
from lightcube.optics.attenuator import inside
from lightcube.optics.moves import places_of
from lightcube.optics.naming import shifts_of
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.optics.views import rotations

#: A sheet lies so far below the lowest film where it may be anywhere, in widths of the stack.
_BELOW = 0.6
#: Heights that differ by less, in cells, are one.
_SAME = 1e-6


def followed(stack: Stack, rig: Rig, view: int, points: Reals, heights_mm: Reals) -> Reals:
    """``(points, heights, 3)``: where the light of a view that falls on some points passes some heights, mm."""
    lamp, heights = rig.views.lamps[view], np.asarray(heights_mm, np.float64)
    if lamp[3]:
        part = (heights - lamp[2]) / (points[:, 2:] - lamp[2])
        return np.asarray(lamp[:3] + part[..., None] * (points - lamp[:3])[:, None])
    outer = lamp[:2] / lamp[2]
    inner = inside(outer[None], stack.index)[0]

    def aside(z: Reals) -> Reals:
        """How far aside light is at some heights, beside where it is in the middle."""
        within = np.clip(z, stack.heights_mm[0], stack.heights_mm[-1])
        return np.asarray(within[..., None] * inner + (z - within)[..., None] * outer)

    flat = points[:, None, :2] + aside(heights) - aside(points[:, 2])[:, None]
    return np.concatenate([flat, np.broadcast_to(heights[:, None], (*flat.shape[:2], 1))], axis=-1)


def is_anywhere(stack: Stack, rig: Rig) -> list[bool]:
    """For each picture whether it is the same on any sheet below the films: one lamp, no disc, none where it is said.

    A sheet of which nothing is said is thought to lie within the stack, or at the lowest film.
    """
    found = []
    for picture in range(len(rig)):
        own = np.flatnonzero(rig.sums.picture == picture)
        high = rig.views.origins_mm[own[0], 2]
        level = np.abs(rig.views.column_steps_mm[own[0], 2]) + np.abs(rig.views.row_steps_mm[own[0], 2]) < 1e-9
        is_within = high >= stack.heights_mm[0] - _SAME * stack.voxel_mm
        found.append(bool(level and is_within and len(own) == 1 and rig.sums.disc_deg[own[0]] == 0))
    return found


def lowered(stack: Stack, rig: Rig) -> Rig:
    """The rig with sheets that may be anywhere where they are seen: some way below the films."""
    views, anywhere = rig.views, is_anywhere(stack, rig)
    low = stack.heights_mm[0] - _BELOW * max(stack.size_mm[1:])
    origins, columns, rows = (each.copy() for each in (views.origins_mm, views.column_steps_mm, views.row_steps_mm))
    for view, picture in enumerate(rig.sums.picture):
        if not anywhere[picture]:
            continue
        corners = origins[view] + np.stack([0 * columns[view], columns[view], rows[view]])
        middle, right, down = followed(stack, rig, view, corners, np.array([low]))[:, 0]
        origins[view], columns[view], rows[view] = middle, right - middle, down - middle
    moved = replace(views, origins_mm=origins, column_steps_mm=columns, row_steps_mm=rows)
    return replace(rig, views=moved)


def films_at(stack: Stack, rig: Rig, angle_deg: float) -> Reals:
    """``(films, 7)``: where each film lies at an angle of the dial, as in `lightcube.optics.tables.Stops`.

    Between two pictures films are on their way.
    """
    places, stops = places_of(stack, rig), rig.stops.angle_deg % 360
    stops, first = np.unique(stops, return_index=True)
    shifts, turns = shifts_of(places[first])
    rows = np.concatenate([shifts.reshape(len(stops), -1), turns, places[first][..., 6]], axis=1)
    now = np.array([np.interp(angle_deg, stops, column, period=360) for column in rows.T])
    count = stack.shape[0]
    shift, turned, heights = now[: 2 * count].reshape(-1, 2), now[2 * count : 3 * count], now[3 * count :]
    matrices = rotations((0.0, 0.0, 1.0), -turned)[:, :2, :2]
    offsets = -np.einsum("fij,fj->fi", matrices, shift)
    return np.column_stack([matrices.reshape(count, 4), offsets, heights])


def are_moved(stack: Stack, rig: Rig) -> bool:
    """Whether films lie otherwise for one picture than for another."""
    places = places_of(stack, rig)
    return not np.allclose(places, places[:1], rtol=0, atol=1e-9)


def sheets(stack: Stack, places: Reals) -> Reals:
    """``(films, 4, 3)``: the corners of films that lie somewhere, in order around each, mm."""
    half = np.array(stack.size_mm[:0:-1]) / 2
    own = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half
    turns = places[:, :4].reshape(-1, 2, 2)
    flat = np.linalg.solve(turns[:, None], (own - places[:, None, 4:6])[..., None])[..., 0]
    return np.concatenate([flat, np.broadcast_to(places[:, None, 6:], (*flat.shape[:2], 1))], axis=-1)
