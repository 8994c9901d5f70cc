"""Make pictures easier to store: which picture stands at which stop, and where on the screen each one stands."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.sparse import block_diag, csr_array, eye_array, kron

from lightcube.backward import solving
from lightcube.backward.recipe import Recipe
from lightcube.forward.casting import cast
from lightcube.kernels import ordering
from lightcube.optics.absorption import absorbance
from lightcube.optics.arrays import Counts, Images, Reals, keep, locked
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.grid import Grid, raster_shape
from lightcube.optics.light import Light
from lightcube.optics.rig import Rig
from lightcube.pictures.resampling import shares
from lightcube.pictures.targets import Targets
from lightcube.planning.measured import raised
from lightcube.projection.projector import Projector
from lightcube.scoring.metrics import mean_psnr

#: Voxels along the longest side of the draft cube, passes of its solve, and points of its pixels.
_DRAFT, _PASSES, _POINTS = 16, 40, Light(5, 4)
#: The model sees pictures of at most so many tiles along a side, and has room for so many numbers.
_TILES, _ROOM = 8, 32_000_000
#: Noise of the model, relative to its signal; linear light that counts as black; variance of a lamp in absorbance.
_NOISE, _BLACK, _LAMP = 0.1, 1e-3, 1e3
#: Walks of the annealing, swaps per pair of stops in each, and its first and last temperature.
_WALKS, _SWAPS, _HOT, _COLD = 8, 40, 0.3, 0.01


@dataclass(frozen=True, eq=False)
class Order:
    """Which picture stands at which stop.

    Parameters
    ----------
    pictures
        ``pictures[stop]`` is the number of the picture that stands there: a permutation.
    given_db, best_db
        Mean PSNR of a draft of the cube, 16 voxels long, with the pictures as given and in this order.
    """

    pictures: Counts
    given_db: float
    best_db: float

    def __post_init__(self) -> None:
        check_fields(self)
        keep(self, pictures=np.intp)

    def __call__(self, targets: Targets) -> Targets:
        """Return `targets` with its pictures, weights and names in this order, the views as they are."""
        names = tuple(targets.names[picture] for picture in self.pictures)
        return replace(
            targets,
            pictures=locked(targets.pictures[self.pictures]),
            weights=locked(targets.weight[self.pictures]),
            names=names,
        )


@checked
def best_order(targets: Targets, grid: Grid, recipe: Recipe | None = None) -> Order:
    """Find which picture should stand at which stop, so that they fight each other least.

    Parameters
    ----------
    targets
        Pictures in any order, in the views where they or others of them shall stand.
    recipe
        As `lightcube.solve` takes it; pictures of the draft are not held.

    Returns
    -------
    The best of these orders, as a draft of the cube shows them: the given one, a short closed tour of pictures with
    similar absorbance, and eight more that annealing finds from there. It is never worse than the given one in that
    draft, and does not depend on the order in which the pictures are given except where the given one is best.

    Notes
    -----
    The model of what is left unfitted is linear: with absorbance ``b`` of the pictures in tiles, ``A`` the draft
    cube's matrix in tiles, and ``K = A A^T / mean(diag(A A^T))``, voxels and lamps of any sign leave
    ``r = n (K + L + n)^-1 b`` with n = 0.1 and L a large variance of each view's mean, for the lamp. Annealing lowers
    the mean over views of ``ln |r_view|^2``, which is what mean PSNR is, by swapping pictures. The model needs
    ``pictures^3`` numbers per tile and colour: from 139 pictures on there is no room for two tiles a side, and the
    tour is all there is beside the given order.
    """
    targets = replace(targets, rig=targets.rig.as_one_colour())
    raised(targets.rig, grid)
    recipe = recipe or Recipe()
    bound = recipe.bounded_by.of_any_size(grid)
    drafted = replace(recipe.by_display(_PASSES), material=bound, hold_deg=0.0, mat=None)
    if not recipe.beams.is_thin:
        drafted = replace(drafted, light=_POINTS)
    draft, small = _draft(targets, grid)
    seen = _features(draft, _tiles(1, draft.rig.picture_shape)).reshape(len(targets), -1)
    canonical = np.lexsort(seen.T[::-1])
    along = np.argsort(targets.angles_deg, kind="stable")
    tour = np.empty(len(targets), np.int64)
    tour[along] = ordering.shortest_tour(scipy.spatial.distance.cdist(seen[canonical], seen[canonical]))
    candidates = [np.arange(len(targets)), canonical[tour]]
    tiles = _tiles(len(targets), draft.rig.picture_shape)
    if len(targets) > 1 and max(tiles) > 1:
        parts = _parts(draft.rig, small, _features(draft, tiles)[canonical], tiles)
        candidates += [canonical[order] for order in _walks(parts, tour)]
    scores = [_draft_db(draft, small, candidate, drafted) for candidate in candidates]
    best = int(np.argmax(scores))
    return Order(candidates[best].astype(np.intp), scores[0], scores[best])


def _draft(targets: Targets, grid: Grid) -> tuple[Targets, Grid]:
    """Return the targets and the grid at a size that solves in a moment: as they are, or 16 voxels long."""
    scale = max(1.0, max(grid.shape) / _DRAFT)
    nz, ny, nx = (max(1, round(side / scale)) for side in grid.shape)
    small = grid.coarser((nz, ny, nx), scale)
    rig = targets.rig
    most = raster_shape(small, float(np.min(np.abs(rig.views.elevations_deg))), rig.views.pixel_in(grid))
    rows, columns = (min(max(1, round(side / scale)), end) for side, end in zip(rig.picture_shape, most, strict=True))
    draft = rig.with_pixels(scale, (rows, columns))
    pictures, weights = _tiled(targets.pictures, targets.weight, (rows, columns))
    smaller = replace(targets, pictures=pictures.astype(np.float32), rig=draft, weights=weights.astype(np.float32))
    return smaller, small


def _tiled(
    pictures: NDArray[np.floating], weights: NDArray[np.floating], shape: tuple[int, int]
) -> tuple[Reals, Reals]:
    """Weighted means over ``shape`` tiles of pictures ``(view, row, column, channel)``, and means of the weights.

    A tile without weight has the mean of its picture.
    """
    down, across = (shares(*sizes) for sizes in zip(pictures.shape[1:3], shape, strict=True))
    mean = np.einsum("ai,vij,bj->vab", down, weights, across, optimize=True)
    weighted = weights[..., None] * pictures
    total = np.einsum("ai,vijc,bj->vabc", down, weighted, across, optimize=True)
    whole = weighted.sum(axis=(1, 2), dtype=np.float64) / weights.sum(axis=(1, 2), dtype=np.float64)[:, None]
    filled = np.where(mean[..., None] > 0, total / np.maximum(mean, 1e-30)[..., None], whole[:, None, None])
    return filled, mean


def _tiles(count: int, shape: tuple[int, int]) -> tuple[int, int]:
    """Rows and columns of tiles in which the model sees `count` pictures of so many pixels."""
    side = min(_TILES, math.isqrt(_ROOM // (3 * count**3)))
    return min(side, shape[0]), min(side, shape[1])


def _features(draft: Targets, tiles: tuple[int, int]) -> Reals:
    """``(picture, tile, channel)``: absorbance of each picture in tiles; columns of tiles one after the other."""
    dark = absorbance(np.maximum(draft.pictures, _BLACK))
    seen, _ = _tiled(dark, draft.weight, tiles)
    return np.ascontiguousarray(seen.transpose(0, 2, 1, 3).reshape(len(draft), tiles[0] * tiles[1], -1))


def _parts(rig: Rig, grid: Grid, features: Reals, tiles: tuple[int, int]) -> Images:
    """``(stop seen, stop, picture, tile and channel)``: what a picture at a stop adds to what is left unfitted."""
    stops, size = len(rig), tiles[0] * tiles[1]
    rows, columns = rig.picture_shape
    # equations run over a view's columns, each bottom-up: hence the flip
    tiling = csr_array(np.kron(shares(columns, tiles[1]), shares(rows, tiles[0])[:, ::-1]))
    beams = Projector(grid, rig).to_sparse()
    # with level beams the matrix is that of one slice, the same for all
    slices = stops * rows * columns // beams.shape[0]
    matrix = block_diag([tiling] * stops, format="csr") @ kron(beams, eye_array(slices), format="csr")
    system = (matrix @ matrix.T).toarray()
    system /= np.mean(np.diag(system))
    for at in range(0, len(system), size):
        system[at : at + size, at : at + size] += _LAMP
    system[np.diag_indices_from(system)] += _NOISE
    left = _NOISE * np.linalg.inv(system).reshape(stops, size, stops, size)
    parts = np.einsum("satb,pbc->stpac", left, features, optimize=True)
    return np.ascontiguousarray(parts.reshape(stops, stops, stops, -1), dtype=np.float32)


def _walks(parts: Images, start: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Orders that annealing finds from `start`, one per walk."""
    stops, random = len(start), np.random.default_rng(0)
    found = []
    for _ in range(_WALKS):
        steps = _SWAPS * stops * (stops - 1) // 2
        first = random.integers(0, stops, steps)
        second = (first + random.integers(1, stops, steps)) % stops
        places = np.stack([first, second], axis=1)
        found.append(ordering.anneal(parts, start, places, random.random(steps), _HOT, _COLD))
    return found


def _draft_db(draft: Targets, grid: Grid, order: NDArray[np.integer], recipe: Recipe) -> float:
    """Mean PSNR in dB of the draft cube with the pictures in this order."""
    targets = Order(order.astype(np.intp), 0.0, 0.0)(draft)
    cube = solving.solve(targets, grid, recipe).cube
    return mean_psnr(np.stack(list(cast(cube))), targets)
