"""What it costs to bend a picture: little to turn it, more to stretch or shear it, most to fold it."""

import numpy as np

from lightcube.optics.arrays import Reals

#: Cost of a strain, and of its trace (Lamé's second and first constant), of bending and of moving at all, for pictures
#: of `_SIDE` pixels.
_STRAIN, _SWELL, _BEND, _MOVE = 5.0, 2.5, 20.0, 0.02
_SIDE = 64
#: Spots that keep less than this part of their area cost more, so much.
_LEAST, _FOLD = 0.3, 400.0
#: Nodes of the splines along each side: cubic B-splines, so what they make has no kinks.
NODES = 11


def splines(count: int) -> Reals:
    """``(count, NODES)``: the uniform cubic B-splines of `NODES` nodes at the middles of `count` pixels."""
    place = (np.arange(count) + 0.5) / count * (NODES - 3)
    first = np.minimum(place.astype(int), NODES - 4)
    t = place - first
    parts = ((1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3)
    made = np.zeros((count, NODES))
    for number, part in enumerate(parts):
        made[np.arange(count), first + number] = part / 6
    return made


def elastic(moves: Reals, held: Reals) -> tuple[float, Reals]:
    """Cost of moves ``(picture, 2, row, column)``, down and across in pixels, and its slope by each of them.

    With the strain ``e = (grad u + grad u^T) / 2`` it is ``sum mu e:e + lambda / 2 (tr e)^2 + bend |second
    differences|^2 + move |u|^2``: turning is nearly free. What is squeezed to less than a third costs more, so that
    nothing folds. Finer pictures have as many times the displacement.

    Parameters
    ----------
    held
        ``(picture, row, column)``: what moving costs there besides, for parts that are to stay.
    """
    scale = max(moves.shape[2:]) / _SIDE
    bend, move = _BEND * scale**2, _MOVE / scale**2 + held[:, None]
    slopes = 2 * move * moves
    cost = float(np.sum(move * moves**2))
    down, across = moves[:, 0], moves[:, 1]
    along, beside = np.diff(down, axis=1)[:, :, :-1], np.diff(across, axis=2)[:, :-1]
    sheared = np.diff(across, axis=1)[:, :, :-1] + np.diff(down, axis=2)[:, :-1]
    swell = along + beside
    cost += float(np.sum(_STRAIN * (along**2 + beside**2 + 0.5 * sheared**2) + _SWELL / 2 * swell**2))
    slopes[:, 0] += _back(2 * _STRAIN * along + _SWELL * swell, 1) + _back(_STRAIN * sheared, 2)
    slopes[:, 1] += _back(2 * _STRAIN * beside + _SWELL * swell, 2) + _back(_STRAIN * sheared, 1)
    for axis in (2, 3):
        second = np.diff(moves, 2, axis=axis)
        cost += bend * float(np.sum(second**2))
        slopes += _undone(_undone(2 * bend * second, axis), axis)
    rows, columns, areas = _areas(moves)
    squeezed = np.maximum(_LEAST - areas, 0)
    if np.any(squeezed):
        cost += _FOLD * float(np.sum(squeezed**2))
        by = -2 * _FOLD * squeezed
        slopes[:, 0] += _back(by * (1 + columns[:, 1]), 1) - _back(by * rows[:, 1], 2)
        slopes[:, 1] += _back(by * (1 + rows[:, 0]), 2) - _back(by * columns[:, 0], 1)
    return cost, slopes


def least_area(moves: Reals) -> float:
    """The least part of its area that any square between four pixels keeps: below 0 a picture is folded."""
    return float(_areas(moves)[2].min())


def _areas(moves: Reals) -> tuple[Reals, Reals, Reals]:
    """How steps down and across change the moves, ``(picture, 2, row, column)``, and what area each square keeps."""
    rows, columns = np.diff(moves, axis=2)[..., :-1], np.diff(moves, axis=3)[:, :, :-1]
    return rows, columns, (1 + rows[:, 0]) * (1 + columns[:, 1]) - rows[:, 1] * columns[:, 0]


def _back(differences: Reals, axis: int) -> Reals:
    """The adjoint of differences along an axis of all squares between pixels, last row and column left out."""
    padded = np.pad(differences, ((0, 0), (0, 0), (0, 1)) if axis == 1 else ((0, 0), (0, 1), (0, 0)))
    return _undone(padded, axis)


def _undone(differences: Reals, axis: int) -> Reals:
    """The adjoint of ``np.diff`` along an axis."""
    nothing = [(0, 0)] * differences.ndim
    nothing[axis] = (1, 1)
    return -np.diff(np.pad(differences, nothing), axis=axis)
