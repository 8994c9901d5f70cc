"""Products with the matrix of a stack of films: each beam meets one cell of each film, as a rule.

Unknowns are numbered as those of any block, ``(y * nx + x) * films + film``; beams as those of any matrix, column by
column of each view, from its lowest pixel upwards. Lengths are counted along a cell's width, times 1 / cos of the
angle at which a beam meets the films.

There are two kinds of beams. Those through the **middles** of pixels may come from anywhere. **Rectangles** are parts
of a pixel in which all beams meet the same cells: where pixels' sides run along cells' sides, the cell of a film is the
sum of a number that a column's part decides and one that a row's part does.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import tasks
from lightcube.kernels.compiled import compiled

Array = NDArray[Any]

#: A number of a cell that is none, and stays below 0 whatever is added to it.
NONE = -(2**30)

#: Fields of a view's beams through the middles of pixels: whether its lamp is near, and where it stands; the lowest
#: left pixel, and the steps to the right and up; slopes (mm of x and y for each mm of z) and lengths of parallel light.
NEAR, LAMP, CORNER, RIGHT, UP, SLOPE, LENGTH, FIELDS = 0, 1, 4, 7, 10, 13, 15, 16


@compiled
def beam_of(view: Array, column: int, row: int) -> tuple[float, float, float, float, float, float, float]:
    """A beam: its x and y at height 0, its slopes, its length, and the heights between which it runs."""
    x = view[CORNER] + column * view[RIGHT] + row * view[UP]
    y = view[CORNER + 1] + column * view[RIGHT + 1] + row * view[UP + 1]
    z = view[CORNER + 2] + column * view[RIGHT + 2] + row * view[UP + 2]
    if view[NEAR] == 0:
        return x - view[SLOPE] * z, y - view[SLOPE + 1] * z, view[SLOPE], view[SLOPE + 1], view[LENGTH], -np.inf, np.inf
    along = z - view[LAMP + 2]
    if along == 0:
        return x, y, 0.0, 0.0, 0.0, np.inf, -np.inf
    aslant, aside = (x - view[LAMP]) / along, (y - view[LAMP + 1]) / along
    length = np.sqrt(1 + aslant * aslant + aside * aside)
    return x - aslant * z, y - aside * z, aslant, aside, length, min(z, view[LAMP + 2]), max(z, view[LAMP + 2])


@compiled
def cell_of(
    beam: tuple[float, float, float, float, float, float, float], place: Array, width: float, nx: int, ny: int
) -> int:
    """Number of the cell of a film, ``y * nx + x``, that a beam meets, or -1; `place` is as in `Stops.films`."""
    at_x, at_y, slope_x, slope_y, _, low, high = beam
    height = place[6]
    if not low <= height <= high:
        return -1
    x, y = at_x + slope_x * height, at_y + slope_y * height
    column = np.floor((place[0] * x + place[1] * y + place[4]) / width + 0.5 * nx)
    row = np.floor((place[2] * x + place[3] * y + place[5]) / width + 0.5 * ny)
    if 0 <= column < nx and 0 <= row < ny:
        return int(row) * nx + int(column)
    return -1


def forward_middles(
    views: Array, places: Array, picture: tuple[int, int], cells: tuple[int, int], width: float, x: Array, b: Array
) -> None:
    """``b = A x`` of the beams through the middles of pixels; every number of `b` is written.

    `views` is ``(views, FIELDS)``, `places` ``(views, films, 7)``, `picture` the ``(columns, rows)`` of pictures and
    `cells` the ``(nx, ny)`` of films.
    """
    work = 4 * len(b) * places.shape[1]
    tasks.run(_forward_middles, len(views) * picture[0], work, views, places, picture, cells, width, x, b)


@compiled
def _forward_middles(
    first: int,
    last: int,
    views: Array,
    places: Array,
    picture: tuple[int, int],
    cells: tuple[int, int],
    width: float,
    x: Array,
    b: Array,
) -> None:
    columns, rows = picture
    nx, ny = cells
    films = places.shape[1]
    for line in range(first, last):
        view, column = line // columns, line % columns
        for row in range(rows):
            beam = beam_of(views[view], column, row)
            sums = b[line * rows + row]
            sums[:] = 0
            for film in range(films):
                cell = cell_of(beam, places[view, film], width, nx, ny)
                if cell >= 0:
                    for colour in range(len(sums)):
                        sums[colour] += x[cell * films + film, colour]
            sums *= beam[4] * width


def adjoint_middles(
    views: Array, places: Array, picture: tuple[int, int], cells: tuple[int, int], width: float, b: Array, x: Array
) -> None:
    """``x = A.T b``; every number of `x` is written. Each film is a task: no two write to the same number."""
    x[:] = 0
    work = 4 * len(b) * places.shape[1]
    tasks.run(_adjoint_middles, places.shape[1], work, views, places, picture, cells, width, b, x)


@compiled
def _adjoint_middles(
    first: int,
    last: int,
    views: Array,
    places: Array,
    picture: tuple[int, int],
    cells: tuple[int, int],
    width: float,
    b: Array,
    x: Array,
) -> None:
    columns, rows = picture
    nx, ny = cells
    films = places.shape[1]
    for film in range(first, last):
        for line in range(len(views) * columns):
            view, column = line // columns, line % columns
            for row in range(rows):
                beam = beam_of(views[view], column, row)
                cell = cell_of(beam, places[view, film], width, nx, ny)
                if cell >= 0:
                    length = beam[4] * width
                    for colour in range(x.shape[1]):
                        x[cell * films + film, colour] += length * b[line * rows + row, colour]


def forward_rectangles(
    across: Array, along: Array, slants: tuple[Array, Array], width: float, x: Array, b: Array
) -> None:
    """``b = A x`` of rectangles; every number of `b` is written.

    Parameters
    ----------
    across, along
        ``(views, parts of a column, columns, films)`` and ``(views, parts of a row, rows, films)``: the numbers whose
        sum is that of the unknown, `NONE` where it lies beside the film. Rectangles of a view follow each other, those
        of a column's first part first.
    slants
        ``(views, parts, columns)`` and ``(views, parts, rows)``: the squares of the slopes along each; NaN where a part
        has no width: 0 is written of its beams.
    width
        Of a cell, mm.
    """
    views, wide, columns, films = across.shape
    count = views * wide * along.shape[1] * columns
    tasks.run(_forward_rectangles, count, 4 * len(b) * films, across, along, *slants, width, x, b)


@compiled
def _forward_rectangles(
    first: int,
    last: int,
    across: Array,
    along: Array,
    aslant: Array,
    upslant: Array,
    width: float,
    x: Array,
    b: Array,
) -> None:
    _, wide, columns, films = across.shape
    high, rows = along.shape[1], along.shape[2]
    for line in range(first, last):
        column, part = line % columns, line // columns
        lower, part = part % high, part // high
        left, view = part % wide, part // wide
        sums = b[line * rows : (line + 1) * rows]
        sums[:] = 0
        if np.isnan(aslant[view, left, column]):
            continue
        own, others = across[view, left, column], along[view, lower]
        for row in range(rows):
            steep = upslant[view, lower, row]
            if np.isnan(steep):
                continue
            length = width * np.sqrt(1 + aslant[view, left, column] + steep)
            if sums.shape[1] == 3:  # the colours of most stacks: in registers
                red, green, blue = sums[row, 0], sums[row, 1], sums[row, 2]
                for film in range(films):
                    cell = own[film] + others[row, film]
                    if cell >= 0:
                        red += x[cell, 0]
                        green += x[cell, 1]
                        blue += x[cell, 2]
                sums[row, 0], sums[row, 1], sums[row, 2] = length * red, length * green, length * blue
            else:
                for film in range(films):
                    cell = own[film] + others[row, film]
                    if cell >= 0:
                        for colour in range(sums.shape[1]):
                            sums[row, colour] += length * x[cell, colour]


def adjoint_rectangles(
    across: Array,
    along: Array,
    slants: tuple[Array, Array],
    stripes: Array,
    width: float,
    b: Array,
    x: Array,
) -> None:
    """``x = A.T b``; every number of `x` is written.

    `stripes`, ``(views, parts, columns, films)`` from 0 on, are tasks: what is in two of them is of different cells.
    """
    x[:] = 0
    films, count = across.shape[3], int(stripes.max()) + 1
    tasks.run(
        _adjoint_rectangles, films * count, 6 * len(b) * films, across, along, *slants, stripes, count, width, b, x
    )


@compiled
def _adjoint_rectangles(
    first: int,
    last: int,
    across: Array,
    along: Array,
    aslant: Array,
    upslant: Array,
    stripes: Array,
    count: int,
    width: float,
    b: Array,
    x: Array,
) -> None:
    views, wide, columns, _ = across.shape
    high, rows = along.shape[1], along.shape[2]
    for task in range(first, last):
        film, stripe = task // count, task % count
        for view in range(views):
            for left in range(wide):
                for column in range(columns):
                    own = across[view, left, column, film]
                    slant = aslant[view, left, column]
                    if own < 0 or np.isnan(slant) or stripes[view, left, column, film] != stripe:
                        continue
                    for lower in range(high):
                        line = (((view * wide + left) * high + lower) * columns + column) * rows
                        for row in range(rows):
                            cell = own + along[view, lower, row, film]
                            steep = upslant[view, lower, row]
                            if cell >= 0 and not np.isnan(steep):
                                length = width * np.sqrt(1 + slant + steep)
                                for colour in range(x.shape[1]):
                                    x[cell, colour] += length * b[line + row, colour]
