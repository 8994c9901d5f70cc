"""Silhouettes that contradict each other, bent as little as can be until one object casts them all."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Flags, Integers, Reals, keep, locked
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.grid import Grid
from lightcube.solids import projections
from lightcube.solids.elastic import NODES, elastic, least_area, splines
from lightcube.solids.silhouettes import FINE, Silhouettes
from lightcube.wording import counted

Vector = np.ndarray[tuple[int], np.dtype[np.float64]]

#: Weights of agreeing beside staying as they are, tried in turn: the first that is enough bends least.
_LADDER = (0.05, 0.2, 0.6, 2.0, 6.0, 20.0, 60.0, 200.0)
#: Part of the silhouettes' pixels that may be left for which there is no room.
_ENOUGH = 5e-4
#: Pixels: width of a silhouette's soft edge while it is bent; how far the others are to give way beyond just enough.
_EDGE, _MARGIN = 0.5, 0.4
#: Pictures of more pixels along a side are bent at half their size first.
_LARGE = 80
#: Steps of the optimiser for each weight, and where a smaller size has been bent before.
_STEPS, _FEWER = 30, 15
#: How much what moves a kept part costs there, and how much more a pixel counts that would leave a hole.
_HELD, _URGENT = 50.0, 8.0
#: Half of a wall is not thicker, pixels.
_MOST_PX = 1e4
#: Places of the block that must be inside, by how many pixels, and how much that counts.
_INSIDE, _JOINED = 0.7, 4.0


@dataclass(frozen=True, eq=False)
class Warped:
    """How silhouettes were bent.

    Parameters
    ----------
    given
        What they were.
    nodes
        ``(picture, 2, NODES, NODES)``: how far down and across from each place its pixel was taken, by cubic B-splines,
        in pixels.
    weight
        Of agreeing, at which it ended.
    """

    given: Silhouettes
    nodes: Reals
    weight: float

    def __post_init__(self) -> None:
        check_fields(self)
        keep(self, nodes=np.float64)
        wanted = (len(self.given), 2, NODES, NODES)
        if self.nodes.shape != wanted or not np.all(np.isfinite(self.nodes)):
            raise InputError(f"the nodes of bent silhouettes are numbers of shape {wanted}, not {self.nodes.shape}")
        if not 0 <= self.weight <= _LADDER[-1]:
            raise InputError(f"the weight of agreeing is a number from 0 to {_LADDER[-1]:g}, not {self.weight:g}")

    def __repr__(self) -> str:
        moved = f"moved by {self.moved_px:.2f} pixels on average"
        return f"<{counted(len(self.given), 'silhouette')} {moved}, least area {self.least_area:.2f}>"

    def moves(self, finer: int = 1) -> Reals:
        """``(picture, 2, row, column)`` in pixels, at the middles of so many pixels for each along a side."""
        rows, columns = self.given.rig.picture_shape
        return _moves(self.nodes, finer * rows, finer * columns)

    @cached_property
    def silhouettes(self) -> Silhouettes:
        """What they became."""
        from lightcube.kernels import bending, hull, tasks  # here: the compiler comes with it

        inside = self.given.inside
        distances = np.empty((len(inside), *(side + 2 * hull.MARGIN for side in inside.shape[1:])), np.float32)
        around = ((0, 0), (hull.MARGIN,) * 2, (hull.MARGIN,) * 2)
        tasks.run(hull.signed_distances, len(inside), 20 * inside.size, np.pad(inside, around), 1, distances)
        own = np.ascontiguousarray(distances[:, hull.MARGIN : -hull.MARGIN, hull.MARGIN : -hull.MARGIN], np.float64)
        values, slopes = np.empty_like(own), np.empty((len(own), 2, *own.shape[1:]))
        tasks.run(bending.bent, len(own), 20 * own.size, own, FINE * self.moves(FINE), values, slopes)
        return Silhouettes(locked(values < 0), self.given.rig, self.given.names)

    @property
    def moved_px(self) -> float:
        """How far the shapes' pixels were moved, on average."""
        inside = self.silhouettes.pixels()
        return float(np.hypot(*np.moveaxis(self.moves(), 1, 0))[inside].mean())

    @property
    def least_area(self) -> float:
        """The least part of its area that any spot keeps: below 0 a picture is folded."""
        return least_area(self.moves())


@dataclass(frozen=True, eq=False)
class _Problem:
    """Silhouettes at one size, and what is asked of them."""

    distances: Reals  # (picture, row, column), without a margin
    onto: Reals  # of the block's voxels
    shape: tuple[int, int, int]
    edge: float
    held: Reals  # (picture, row, column)
    urgency: Reals  # (picture, row, column)
    joined: Reals  # (place, 3): z, y, x of voxels that must be inside

    def halved(self) -> _Problem:
        """The same at half the size."""
        rows, columns = (side // 2 * 2 for side in self.distances.shape[1:])

        def mean(picture: Reals) -> Reals:
            return picture[:, :rows, :columns].reshape(len(picture), rows // 2, 2, columns // 2, 2).mean(axis=(2, 4))

        onto = projections.finer(self.onto, 0.5)
        # voxels twice as large: place 2 i + 0.5 of the finer ones
        onto = np.concatenate([2 * onto[:, :, :3], onto[:, :, 3:] + 0.5 * onto[:, :, :3].sum(axis=2, keepdims=True)], 2)
        nz, ny, nx = (max(1, side // 2) for side in self.shape)
        return _Problem(
            mean(self.distances) / 2, onto, (nz, ny, nx), self.edge, mean(self.held), mean(self.urgency),
            (self.joined - 0.5) / 2,
        )  # fmt: skip

    def cost(self, moves: Reals, weight: float) -> tuple[float, Reals]:
        """Of moves, and its slope by each."""
        values, by_move = self.bent(moves)
        slopes = np.zeros_like(values)
        loss = self.pull(values, slopes) + self.join(values, slopes)
        cost, slope = elastic(moves, self.held)
        return cost + weight * loss, slope + weight * slopes[:, None] * by_move

    def bent(self, moves: Reals) -> tuple[Reals, Reals]:
        """Distances after moves, and their slopes."""
        from lightcube.kernels import bending, tasks  # here: the compiler comes with it

        values, slopes = np.empty_like(self.distances), np.empty((len(moves), 2, *self.distances.shape[1:]))
        tasks.run(bending.bent, len(values), 20 * values.size, self.distances, moves, values, slopes)
        return values, slopes

    def ways(self, values: Reals) -> tuple[Reals, Integers, Reals]:
        """How far each pixel is from being cast, who is in its way most, and where."""
        from lightcube.kernels import bending, tasks  # here: the compiler comes with it

        deficits, culprits = np.empty_like(values), np.empty(values.shape, np.int64)
        places = np.empty((*values.shape, 2))
        lines = len(values) * values.shape[1]
        work = 5 * values.size * max(self.shape) * len(values)
        shape = np.array(self.shape)
        tasks.run(bending.ways, lines, work, values, self.onto, shape, self.edge, deficits, culprits, places)
        return deficits, culprits, places

    def pull(self, values: Reals, slopes: Reals) -> float:
        """How much they contradict each other; its slopes are added."""
        from lightcube.kernels import bending

        return float(bending.pull(values, *self.ways(values), self.urgency, self.edge, _MARGIN, slopes))

    def join(self, values: Reals, slopes: Reals) -> float:
        """What is wanting where voxels must be inside; its slopes are added."""
        if not len(self.joined):
            return 0.0
        loss = 0.0
        places = np.column_stack([self.joined, np.ones(len(self.joined))])
        rows, columns = values.shape[1:]
        for picture, onto in enumerate(self.onto):
            across, down, w = onto @ places.T
            i = np.clip(np.rint(down / w).astype(int), 0, rows - 1)
            j = np.clip(np.rint(across / w).astype(int), 0, columns - 1)
            wanting = np.maximum(values[picture, i, j] + _INSIDE, 0)
            loss += _JOINED * float(np.sum(wanting**2))
            np.add.at(slopes[picture], (i, j), 2 * _JOINED * wanting)
        return loss

    def left(self, nodes: Reals) -> float:
        """Which part of the pixels inside the others leave no room for."""
        values = self.bent(_moves(nodes, *self.distances.shape[1:]))[0]
        inside = values < 0
        lost = inside & (self.ways(values)[0] > 0)
        return int(np.count_nonzero(lost)) / max(int(np.count_nonzero(inside)), 1)


def _moves(nodes: Reals, rows: int, columns: int) -> Reals:
    return np.einsum("ri,kwij,cj->kwrc", splines(rows), nodes, splines(columns), optimize=True)


@checked
def warp(
    silhouettes: Silhouettes,
    grid: Grid,
    *,
    wall_px: float = 0.0,
    held: Flags | None = None,
    start: Warped | None = None,
    joined: Reals | None = None,
    urgent: Flags | None = None,
    told: Callable[[int, int], None] | None = None,
) -> Warped:
    """Bend silhouettes gently until, nearly everywhere, one object casts them.

    The sum of an elastic cost and of what the silhouettes contradict each other in is made small by L-BFGS (N. J.
    Mitra and M. Pauly, Shadow Art, 2009, deform meshes instead), for one weight of the latter after another, until at
    most one pixel in 2000 is left.

    Parameters
    ----------
    wall_px
        Half of how thick walls are to be, in pixels: what is bent agrees when its edges have gone back so far.
    held
        ``(picture, row, column)``: parts that are to stay where they are, if they can.
    start
        Where to begin: bent before.
    joined
        ``(place, 3)``: voxels (z, y, x) that must be inside.
    urgent
        ``(picture, row, column)``: places of the bent pictures that matter more.
    told
        Called with each weight's number and how many there are.

    Raises
    ------
    InputError
        Where `held` has another shape, or `wall_px` is below 0.
    """
    check_wall(wall_px)
    problem = _problem(silhouettes, grid, wall_px, held, joined)
    if urgent is not None:
        problem = replace(problem, urgency=1 + _URGENT * urgent.astype(np.float64))
    nodes = np.zeros((len(silhouettes), 2, NODES, NODES)) if start is None else start.nodes
    ladder = _LADDER if start is None else tuple(weight for weight in _LADDER if weight >= start.weight)
    weight = ladder[0]
    large = start is None and max(silhouettes.rig.picture_shape) > _LARGE
    if large:
        nodes, weight = _relaxed(problem.halved(), nodes / 2, ladder, _STEPS, told)
        nodes = 2 * nodes
        ladder = tuple(each for each in ladder if each >= weight / 4)
        problem = replace(problem, edge=1.5 * problem.edge)
    nodes, weight = _relaxed(problem, nodes, ladder, _FEWER if large else _STEPS, told)
    return Warped(silhouettes, locked(nodes), weight)


def check_wall(wall_px: float) -> None:
    """Raise `InputError` where half of a wall is no length that pictures have."""
    if not 0 <= wall_px <= _MOST_PX:
        raise InputError(f"half of a wall is 0 pixels or more, and at most {_MOST_PX:g}, not {wall_px:g}")


def _problem(
    silhouettes: Silhouettes, grid: Grid, wall_px: float, held: Flags | None, joined: Reals | None
) -> _Problem:
    from lightcube.kernels.hull import MARGIN

    projections.check_rig(silhouettes.rig, grid)
    distances = np.ascontiguousarray(silhouettes.distances[:, MARGIN:-MARGIN, MARGIN:-MARGIN], np.float64) + wall_px
    if held is not None and held.shape != distances.shape:
        raise InputError(
            f"what is held has shape {held.shape}, not {distances.shape} as the pictures: give one mask each"
        )
    stiff = np.zeros_like(distances) if held is None else _HELD * held.astype(float)
    onto = projections.of_voxels(projections.matrices(silhouettes.rig), grid)
    places = np.empty((0, 3)) if joined is None else joined.astype(float)
    return _Problem(distances, onto, grid.shape, _EDGE, stiff, np.ones_like(distances), places)


def _relaxed(
    problem: _Problem,
    nodes: Reals,
    ladder: Sequence[float],
    steps: int,
    told: Callable[[int, int], None] | None,
) -> tuple[Reals, float]:
    """Nodes for the first weight that is enough, and that weight."""
    from scipy.optimize import minimize  # here: whoever bends nothing does without

    rows, columns = problem.distances.shape[1:]
    high, wide = splines(rows), splines(columns)
    weight = ladder[0]

    def cost(weight: float, flat: Vector) -> tuple[float, Vector]:
        moves = np.einsum("ri,kwij,cj->kwrc", high, flat.reshape(nodes.shape), wide, optimize=True)
        value, slopes = problem.cost(moves, weight)
        return value, np.einsum("ri,kwrc,cj->kwij", high, slopes, wide, optimize=True).ravel()

    for number, weight in enumerate(ladder):
        own = partial(cost, weight)
        found = minimize(own, nodes.ravel(), jac=True, method="L-BFGS-B", options={"maxiter": steps, "maxcor": 12})
        nodes = found.x.reshape(nodes.shape)
        if told is not None:
            told(number + 1, len(ladder))
        if problem.left(nodes) <= _ENOUGH:
            break
    return nodes, weight
