"""Absorbance of all beams from all voxels, and its transpose, over blocks of columns.

``x`` is ``(ny * nx, slices * channels)`` and ``b`` is ``(beams, rows * channels)``. Beam ``view * width + column``
starts at ``beams[view, 0] + column * beams[view, 1]`` and runs along ``beams[view, 2]`` (x, y, z in voxels) for
the lowest picture row, from ``beams[view, 3, 0]`` to ``beams[view, 3, 1]`` widths of a voxel behind its start; row
``j`` is the same beam ``j`` voxels higher. So a piece in slice ``level`` joins column
``i`` of ``b`` to column ``i + level * channels`` of ``x``. Where beams are level, rows of the source may be longer.

Where rows are `apart` slices apart, more than one, row ``j`` of a picture touches slice ``level + apart * j``: every
such row meets slices of one class, ``level`` mod `apart`, and those one after the other. So the slices of each voxel
stand sorted by class (`by_class`), classes all equally long, and each is a voxel of its own: ``x`` is
``(ny * nx * apart, ceil(nz / apart) * channels)``, and its columns lie as close as where rows are one slice apart.

Of view v only beams ``windows[v, 0]`` to before ``windows[v, 1]`` count, and of them the columns ``windows[v, 2]`` to
before ``windows[v, 3]`` of ``b``: the others of a product are 0, and what stands there is not read.

Both directions go tile by tile of voxels and group by group of views: a tile's columns, and those of the beams
through it, stay in the cache while their few pieces, traced once for all columns, are used. A task owns a part of its
result, and every number is summed in one order: no two threads write the same one, and sums do not depend on their
number.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels.compiled import compiled
from lightcube.kernels.marching import ABREAST
from lightcube.kernels.ray import MOST_PARTS, most_pieces, trace
from lightcube.kernels.rows import LANES, add_rows, prefetch
from lightcube.kernels.tasks import run
from lightcube.kernels.tiles import TILE, Traced, paper, room, trace_tile

Array = NDArray[Any]

#: Views in a group at most, of one product and of the other, and columns that are worked on at a time (measured).
GROUP, BACK_GROUP, COLUMNS = 32, 16, 256
#: Pieces that a group may have at most: fewer views are taken where light is steep.
_MOST_PIECES = 1 << 20


def forward(
    beams: Array,
    windows: Array,
    width: int,
    nx: int,
    ny: int,
    scale: float,
    x: Array,
    b: Array,
    channels: int,
    apart: int,
    tasks: int,
) -> None:
    """``b = A x``; every number of `b` is written. At least `tasks` parts are worked on side by side, if possible."""
    rays, pieces = room(beams, width)
    group = max(1, min(GROUP, len(beams) // tasks, _MOST_PIECES // (MOST_PARTS * rays * pieces)))
    groups = (len(beams) + group - 1) // group
    parts = min((tasks + groups - 1) // groups, width)  # where there are few views, strips of beams
    work = _work(windows, nx, ny)
    grid = beams, windows, width, nx, ny, scale
    run(_forward, groups * parts, work, *grid, x, b, channels, apart, group, parts, rays, pieces)


def _work(windows: Array, nx: int, ny: int) -> int:
    """Nanoseconds that a product takes, roughly: the pieces of all beams, traced once and added up in vectors."""
    wide, high = windows[:, 1] - windows[:, 0], windows[:, 3] - windows[:, 2]
    return int(np.sum(wide * (4 + 2 * high // LANES))) * (nx + ny)


@compiled
def _forward(
    first: int,
    last: int,
    beams: Array,
    windows: Array,
    width: int,
    nx: int,
    ny: int,
    scale: float,
    x: Array,
    b: Array,
    channels: int,
    apart: int,
    group: int,
    parts: int,
    rays: int,
    pieces: int,
) -> None:
    """Do the groups of views, or strips of their beams, that are tasks `first` to before `last`."""
    columns, slices = b.shape[1], x.shape[1]
    source, target = x.reshape(-1), b.reshape(-1)
    for task in range(first, last):
        view = (task // parts) * group
        after = min(view + group, len(beams))
        low, high = task % parts * width // parts, (task % parts + 1) * width // parts
        for each in range(view, after):
            b[each * width + low : each * width + high] = 0
        traced = paper(group * rays, pieces, x)
        strides = (apart * slices, nx * apart * slices, channels if apart == 1 else 1)
        for tile_y in range(0, ny, TILE):
            for tile_x in range(0, nx, TILE):
                size_x, size_y = min(TILE, nx - tile_x), min(TILE, ny - tile_y)
                met = trace_tile(
                    beams,
                    windows,
                    width,
                    view,
                    after,
                    low,
                    high,
                    tile_x,
                    tile_y,
                    size_x,
                    size_y,
                    scale,
                    strides,
                    traced,
                )
                if apart > 1:
                    _into_classes(traced, met, apart, slices, channels)
                base = (tile_y * nx + tile_x) * apart * slices
                for column in range(0, columns, COLUMNS):
                    end = min(column + COLUMNS, columns)
                    for i in range(met):
                        if i + 1 < met:
                            for near in range(column, end, LANES):
                                prefetch(target, (view * width + traced.rays[i + 1]) * columns + near)
                        own = windows[view + traced.rays[i] // width]
                        at = (view * width + traced.rays[i]) * columns
                        piece, count = traced.firsts[i], traced.counts[i]
                        enters, leaves = traced.shifts[piece], traced.shifts[piece + ABREAST * (count - 1)]
                        add_rows(
                            target,
                            at,
                            source,
                            base,
                            slices,
                            traced.places,
                            traced.shifts,
                            traced.weights,
                            piece,
                            count,
                            ABREAST,
                            min(enters, leaves),
                            max(enters, leaves),
                            max(column, own[2]),
                            min(end, own[3]),
                        )


def adjoint(
    beams: Array,
    windows: Array,
    width: int,
    nx: int,
    ny: int,
    scale: float,
    b: Array,
    x: Array,
    channels: int,
    apart: int,
    tasks: int,
) -> None:
    """``x = A.T b``; every number of `x` is written. At least `tasks` parts are worked on side by side, if possible."""
    tiles = ((nx + TILE - 1) // TILE) * ((ny + TILE - 1) // TILE)
    parts = max(1, min((tasks + tiles - 1) // tiles, x.shape[1] // (4 * LANES)))
    work = _work(windows, nx, ny)
    grid = beams, windows, width, nx, ny, scale
    run(_adjoint, tiles * parts, work, *grid, b, x, channels, apart, parts, *room(beams, width))


@compiled
def _adjoint(
    first: int,
    last: int,
    beams: Array,
    windows: Array,
    width: int,
    nx: int,
    ny: int,
    scale: float,
    b: Array,
    x: Array,
    channels: int,
    apart: int,
    parts: int,
    rays: int,
    pieces: int,
) -> None:
    """Do the tiles, or strips of their columns, that are tasks `first` to before `last`."""
    rows, columns = b.shape[1], x.shape[1]
    source, target = b.reshape(-1), x.reshape(-1)
    group = max(1, min(BACK_GROUP, len(beams), _MOST_PIECES // (MOST_PARTS * rays * pieces)))
    across = (nx + TILE - 1) // TILE
    part = (columns + parts * LANES - 1) // (parts * LANES) * LANES
    for task in range(first, last):
        tile_y, tile_x = (task // parts) // across * TILE, (task // parts) % across * TILE
        size_x, size_y = min(TILE, nx - tile_x), min(TILE, ny - tile_y)
        start = (task % parts) * part
        stop = min(start + part, columns)
        for y in range(size_y):
            row = ((tile_y + y) * nx + tile_x) * apart
            x[row : row + size_x * apart, start:stop] = 0
        traced = paper(group * rays, pieces, x)
        most = len(traced.places)
        places, shifts, weights = np.empty(most, np.int32), np.empty(most, np.int32), np.empty(most, x.dtype)
        voxel_ends = np.zeros(TILE * TILE * apart + 1, np.uint32)  # signed numbers are asked whether they are below 0
        strides = (apart, size_x * apart, -channels if apart == 1 else 1)
        after = 0
        while after < len(beams):
            view, after = after, _after(windows, after, group)
            lowest, highest = windows[view, 2], windows[view, 3]
            met = trace_tile(
                beams,
                windows,
                width,
                view,
                after,
                0,
                width,
                tile_x,
                tile_y,
                size_x,
                size_y,
                scale,
                strides,
                traced,
            )
            if apart > 1:
                _into_classes(traced, met, apart, 1, -channels)
            _by_voxel(traced, met, rows, lowest, voxel_ends, places, shifts, weights)
            for column in range(start, stop, COLUMNS):
                end = min(column + COLUMNS, stop)
                wide = size_x * apart
                for voxel in range(wide * size_y):
                    piece, beyond = voxel_ends[voxel], voxel_ends[voxel + 1]
                    if piece < beyond:
                        low, high = shifts[piece], shifts[piece]
                        for k in range(piece, beyond):
                            low, high = min(low, shifts[k]), max(high, shifts[k])
                        at = (((tile_y + voxel // wide) * nx + tile_x) * apart + voxel % wide) * columns
                        add_rows(
                            target,
                            at,
                            source,
                            view * width * rows + lowest,
                            highest - lowest,
                            places,
                            shifts,
                            weights,
                            piece,
                            beyond - piece,
                            1,
                            low,
                            high,
                            column,
                            end,
                        )


@compiled
def _into_classes(traced: Traced, met: int, apart: int, length: int, step: int) -> None:
    """Say where pieces are in classes of slices: so far, `length` a class, from their places, and `step` a slice of it.

    What comes as ``level`` of each of them leaves as ``step * floor(level / apart)``.
    """
    for i in range(met):
        first = traced.firsts[i]
        for k in range(first, first + ABREAST * traced.counts[i], ABREAST):
            level = traced.shifts[k]
            lifted = level // apart
            traced.places[k] += (level - lifted * apart) * length
            traced.shifts[k] = lifted * step


def by_class(source: Array, target: Array, slices: int, apart: int) -> None:
    """Sort slices by class, as the products want them: `source` is ``(voxels, slices * channels)``, 0 follows each."""
    run(_by_class, len(source), source.size // 2, source, target, slices, apart)


@compiled
def _by_class(first: int, last: int, source: Array, target: Array, slices: int, apart: int) -> None:
    channels, length = source.shape[1] // slices, target.shape[1]
    for voxel in range(first, last):
        for kind in range(apart):
            row = target[voxel * apart + kind]
            after = 0
            for z in range(kind, slices, apart):
                for channel in range(channels):
                    row[after + channel] = source[voxel, z * channels + channel]
                after += channels
            row[after:length] = 0


def from_classes(source: Array, target: Array, slices: int, apart: int) -> None:
    """Inverse of `by_class`: `target` is ``(voxels, slices * channels)``."""
    run(_from_classes, len(target), target.size // 2, source, target, slices, apart)


@compiled
def _from_classes(first: int, last: int, source: Array, target: Array, slices: int, apart: int) -> None:
    channels = target.shape[1] // slices
    for voxel in range(first, last):
        for z in range(slices):
            row, at = source[voxel * apart + z % apart], z // apart * channels
            for channel in range(channels):
                target[voxel, z * channels + channel] = row[at + channel]


@compiled
def _after(windows: Array, view: int, most: int) -> int:
    """Return one after the last of at most so many views from `view` on with the same columns of ``b``."""
    after = view + 1
    while (
        after < min(view + most, len(windows))
        and windows[after, 2] == windows[view, 2]
        and windows[after, 3] == windows[view, 3]
    ):
        after += 1
    return after


@compiled
def _by_voxel(
    traced: Traced, met: int, rows: int, low: int, voxel_ends: Array, places: Array, shifts: Array, weights: Array
) -> None:
    """Sort the pieces of a tile's beams by voxel: those of voxel ``v`` then end before ``voxel_ends[v + 1]``.

    Columns of ``b`` are counted from `low` on.
    """
    ends = voxel_ends[1:]
    ends[:] = 0
    for i in range(met):
        first = traced.firsts[i]
        for k in range(first, first + ABREAST * traced.counts[i], ABREAST):
            ends[traced.places[k]] += 1
    count = 0
    for voxel in range(len(ends)):
        ends[voxel], count = count, count + ends[voxel]
    for i in range(met):
        first, place = traced.firsts[i], traced.rays[i] * rows
        for k in range(first, first + ABREAST * traced.counts[i], ABREAST):
            voxel = traced.places[k]
            to = ends[voxel]
            places[to], shifts[to], weights[to] = place, traced.shifts[k] - low, traced.weights[k]
            ends[voxel] = to + 1


def copy_rows(source: Array, target: Array) -> None:
    """Write the rows of `source` to the beginnings of those of `target`, which may be longer."""
    run(_copy_rows, len(source), source.size // 2, source, target)


@compiled
def _copy_rows(first: int, last: int, source: Array, target: Array) -> None:
    for row in range(first, last):
        target[row, : source.shape[1]] = source[row]


@compiled
def trace_column(
    beams: Array, width: int, beam: int, nx: int, ny: int, scale: float, voxels: Array, levels: Array, lengths: Array
) -> int:
    """Trace beam number `beam` through the whole grid; return how many pieces it has."""
    own = beams[beam // width]
    start, step, light, ends = own[0], own[1], own[2], own[3]
    column = beam % width
    px, py, pz = start[0] + column * step[0], start[1] + column * step[1], start[2] + column * step[2]
    ray = (px, py, pz, light[0], light[1], light[2], ends[0], ends[1])
    return trace(ray, (nx, ny, 0), (1, nx, 1), scale, voxels, levels, lengths)


@compiled
def trace_all(
    beams: Array,
    width: int,
    nx: int,
    ny: int,
    scale: float,
    rise: int,
    offsets: Array,
    voxels: Array,
    levels: Array,
    lengths: Array,
) -> None:
    """Write the pieces of beam ``i`` to ``offsets[i]`` and on, or where there is no room only count them.

    With `voxels` of length 0, ``offsets[i + 1]`` is set to the number of pieces up to and with beam ``i``. `rise`
    bounds the z faces that a beam crosses.
    """
    most = MOST_PARTS * most_pieces(nx, ny, rise)
    v, z, w = np.empty(most, np.int32), np.empty(most, np.int32), np.empty(most, np.float64)
    for beam in range(len(offsets) - 1):
        count = trace_column(beams, width, beam, nx, ny, scale, v, z, w)
        if len(voxels) == 0:
            offsets[beam + 1] = offsets[beam] + count
        else:
            here = slice(offsets[beam], offsets[beam] + count)
            voxels[here], levels[here], lengths[here] = v[:count], z[:count], w[:count]
