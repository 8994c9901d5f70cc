"""Which picture stands at which stop, and where on the screen: laws, and plain second implementations."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from lightcube.errors import InputError
from lightcube.kernels import ordering
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid, raster_shape
from lightcube.optics.setups import turntable
from lightcube.optics.views import spread_angles
from lightcube.pictures.arranging import spread_over_screen
from lightcube.pictures.targets import Targets
from lightcube.planning import order as orders
from lightcube.planning.order import Order, best_order
from tests.helpers.plain import beam_of_pixel, lengths_of_beam
from tests.helpers.thin import play

GRID = Grid((3, 5, 7), 0.5)


def unrelated(count: int, elevation_deg: float = 35.0, grid: Grid = GRID, seed: int = 0) -> Targets:
    """Pictures of noise, 3 pixels high and 5 wide, with weights and names."""
    random = np.random.default_rng(seed)
    rig = turntable(
        grid, spread_angles(count, elevation_deg=elevation_deg), elevation_deg=elevation_deg, picture_shape=(3, 5)
    )
    pictures = random.random((count, 3, 5, 3)).astype(np.float32)
    weights = random.integers(1, 4, (count, 3, 5)).astype(np.float32)
    return Targets(pictures, rig, weights, tuple(f"picture {i}" for i in range(count)))


def cast_by_a_cube(count: int, elevation_deg: float) -> Targets:
    extinction = np.random.default_rng(3).random((3, *GRID.shape)).astype(np.float32)
    rig = turntable(
        GRID, spread_angles(count, elevation_deg=elevation_deg), elevation_deg=elevation_deg, picture_shape=(3, 5)
    )
    cube = Cube(extinction, GRID, rig)
    return Targets(play(cube), rig)


@pytest.fixture(autouse=True)
def few_walks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Short enough without compiled loops too."""
    monkeypatch.setattr(orders, "_WALKS", 2)
    monkeypatch.setattr(orders, "_PASSES", 5)


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
@pytest.mark.parametrize("count", [1, 2, 5])
def test_an_order_is_a_permutation_and_never_worse_than_the_given_one(count: int, elevation_deg: float) -> None:
    targets = unrelated(count, elevation_deg)
    order = best_order(targets, GRID)
    assert sorted(order.pictures) == list(range(count))
    assert order.best_db >= order.given_db
    kept = best_order(order(targets), GRID)
    assert kept.given_db == pytest.approx(order.best_db, abs=1e-6)


def test_names_and_weights_go_with_their_pictures_and_the_views_stay() -> None:
    targets = unrelated(4)
    order = Order(np.array([2, 0, 3, 1]), 0.0, 0.0)(targets)
    assert order.names == ("picture 2", "picture 0", "picture 3", "picture 1")
    np.testing.assert_array_equal(order.pictures[0], targets.pictures[2])
    np.testing.assert_array_equal(order.weight[3], targets.weight[1])
    assert order.rig is targets.rig


def test_the_order_does_not_depend_on_how_the_pictures_are_numbered() -> None:
    targets = unrelated(5)
    found = best_order(targets, GRID)
    relabelled = Order(np.array([3, 1, 4, 0, 2]), 0.0, 0.0)(targets)
    again = best_order(relabelled, GRID)
    assert found.best_db > max(found.given_db, again.given_db)  # neither given order is the best one
    np.testing.assert_array_equal(again(relabelled).pictures, found(targets).pictures)
    assert again.best_db == found.best_db


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_pictures_of_a_real_cube_find_an_order_as_good_as_its_own(elevation_deg: float) -> None:
    targets = cast_by_a_cube(6, elevation_deg)
    shuffled = Order(np.array([3, 0, 5, 2, 4, 1]), 0.0, 0.0)(targets)
    own = best_order(targets, GRID).given_db
    found = best_order(shuffled, GRID)
    assert found.given_db < own - 0.1
    assert found.best_db > own - 0.05


def test_equal_pictures_stay_as_they_are() -> None:
    targets = unrelated(3)
    same = replace(
        targets, pictures=np.repeat(targets.pictures[:1], 3, axis=0), weights=np.repeat(targets.weight[:1], 3, axis=0)
    )
    order = best_order(same, GRID)
    np.testing.assert_array_equal(order.pictures, [0, 1, 2])
    assert order.best_db == order.given_db


def test_what_has_no_weight_does_not_matter() -> None:
    targets = unrelated(4)
    weights = targets.weight.copy()
    weights[:, 0, :2] = 0
    pictures = targets.pictures.copy()
    pictures[:, 0, :2] = np.random.default_rng(9).random((4, 2, 3))
    first = best_order(replace(targets, weights=weights), GRID)
    second = best_order(replace(targets, weights=weights, pictures=pictures), GRID)
    np.testing.assert_array_equal(first.pictures, second.pictures)
    assert first.best_db == second.best_db


def test_where_the_model_has_no_room_the_tour_remains(monkeypatch: pytest.MonkeyPatch) -> None:
    assert orders._tiles(32, (28, 16)) == (8, 8)
    assert orders._tiles(32, (3, 5)) == (3, 5)
    assert orders._tiles(300, (8, 8)) == (0, 0)
    monkeypatch.setattr(orders, "_tiles", lambda count, shape: shape if count == 1 else (0, 0))
    turn = 2 * np.pi * np.array([3, 0, 5, 2, 4, 1]) / 6 + 0.1
    pictures = np.full((6, 3, 5, 3), 0.5, np.float32)
    pictures[:, :, :2] += 0.45 * np.cos(turn)[:, None, None, None]
    pictures[:, :, 3:] += 0.4 * np.sin(turn)[:, None, None, None]
    targets = replace(unrelated(6), pictures=pictures, weights=np.ones((6, 3, 5), np.float32))
    order = best_order(targets, GRID)
    steps = np.diff(turn[order.pictures] * 6 / (2 * np.pi))
    assert set(np.rint(steps) % 6) in ({1}, {5})
    assert order.best_db > order.given_db  # so it is the tour
    # the tour goes round by angle, however the views are numbered
    shuffle = np.array([4, 2, 0, 1, 5, 3])
    again = best_order(targets.take(shuffle), GRID)
    np.testing.assert_array_equal(again(targets.take(shuffle)).pictures, order(targets).pictures[shuffle])


@pytest.mark.parametrize("shape", [(3, 5), (2, 5), (1, 3), (4, 4)])
def test_tiles_are_weighted_means(shape: tuple[int, int]) -> None:
    random = np.random.default_rng(0)
    pictures, weights = random.random((2, 4, 5, 3)), random.integers(0, 2, (2, 4, 5)).astype(float)
    found, mean = orders._tiled(pictures, weights, shape)
    for view, row, column in np.ndindex(2, *shape):
        total, weight, area = np.zeros(3), 0.0, 0.0
        for i, j in np.ndindex(4, 5):
            high = max(0.0, min(i + 1, (row + 1) * 4 / shape[0]) - max(i, row * 4 / shape[0]))
            wide = max(0.0, min(j + 1, (column + 1) * 5 / shape[1]) - max(j, column * 5 / shape[1]))
            total += high * wide * weights[view, i, j] * pictures[view, i, j]
            weight += high * wide * weights[view, i, j]
            area += high * wide
        whole = np.average(pictures[view].reshape(-1, 3), axis=0, weights=weights[view].ravel())
        np.testing.assert_allclose(found[view, row, column], total / weight if weight else whole, atol=1e-12)
        assert mean[view, row, column] == pytest.approx(weight / area)


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
@pytest.mark.parametrize("tiles", [(3, 5), (3, 2)])
def test_the_model_is_what_ridge_regression_leaves(elevation_deg: float, tiles: tuple[int, int]) -> None:
    targets = unrelated(3, elevation_deg)
    features = orders._features(targets, tiles)
    parts = orders._parts(targets.rig, GRID, features, tiles)
    order = [1, 2, 0]
    left = sum(parts[:, stop, order[stop]] for stop in range(3))
    matrix = np.zeros((3, 5, 3, 105))
    for view, row, column in np.ndindex(3, 3, 5):
        lengths = lengths_of_beam(GRID, *beam_of_pixel(targets.rig.views, view, row, column))
        matrix[view, column, row] = lengths.ravel()
    edges = [range(round(i * 5 / tiles[1] * 2), round((i + 1) * 5 / tiles[1] * 2)) for i in range(tiles[1])]
    rows = np.stack([np.mean([matrix[:, half // 2] for half in halves], axis=0) for halves in edges], axis=1)
    rows = rows.reshape(3 * tiles[0] * tiles[1], -1)
    rows /= math.sqrt(np.mean(np.sum(rows**2, axis=1)))
    lamps = math.sqrt(orders._LAMP) * np.kron(np.eye(3), np.ones((tiles[0] * tiles[1], 1)))
    system = np.concatenate([rows, lamps], axis=1)
    wanted = features[order].reshape(len(system), -1)
    ridge = np.concatenate([system, math.sqrt(orders._NOISE) * np.eye(system.shape[1])])
    best = np.linalg.lstsq(ridge, np.concatenate([wanted, np.zeros((system.shape[1], 3))]), rcond=None)[0]
    np.testing.assert_allclose(np.ravel(left), np.ravel(wanted - system @ best), atol=2e-5)


def test_annealing_finds_the_best_of_all_orders() -> None:
    random = np.random.default_rng(1)
    parts = random.normal(size=(5, 5, 5, 4)).astype(np.float32)

    def plain(order: tuple[int, ...]) -> float:
        left = [sum(parts[seen, stop, order[stop]] for stop in range(5)) for seen in range(5)]
        return float(np.mean([np.log(np.mean(np.square(vector))) for vector in left]))

    best = min(itertools.permutations(range(5)), key=plain)
    assert ordering.misfit(parts, np.array(best)) == pytest.approx(plain(best), abs=1e-5)
    first = random.integers(0, 5, 1000)
    places = np.stack([first, (first + random.integers(1, 5, 1000)) % 5], axis=1)
    found = ordering.anneal(parts, np.arange(5), places, random.random(1000), 3.0, 0.1)
    assert tuple(found) == best


def test_annealing_recovers_the_best_order_of_pictures_that_do_not_fight() -> None:
    random = np.random.default_rng(2)
    cost = random.uniform(0.1, 3.0, (9, 9))
    parts = np.zeros((9, 9, 9, 1), np.float32)
    parts[np.arange(9), np.arange(9), :, 0] = cost
    _, best = linear_sum_assignment(2 * np.log(cost))
    first = random.integers(0, 9, 1500)
    places = np.stack([first, (first + random.integers(1, 9, 1500)) % 9], axis=1)
    found = ordering.anneal(parts, np.arange(9), places, random.random(1500), 1.0, 0.05)
    np.testing.assert_array_equal(found, best)


def test_a_tour_of_points_on_a_circle_goes_round_it() -> None:
    order = np.random.default_rng(0).permutation(9)
    angle_deg = 2 * np.pi * order / 9
    points = np.stack([np.cos(angle_deg), 0.8 * np.sin(angle_deg)], axis=1)
    tour = ordering.shortest_tour(np.linalg.norm(points[:, None] - points[None], axis=-1))
    steps = np.diff(order[tour], append=order[tour[0]]) % 9
    assert set(steps) in ({1}, {8})


def test_moved_pictures_of_larger_pixels_stay_on_the_screen_too() -> None:
    grid, angles_deg = Grid((15, 36, 42)), spread_angles(6, elevation_deg=35.0)
    rig = turntable(grid, angles_deg, elevation_deg=35.0, picture_shape=(3, 4), pixel=3)
    offsets = spread_over_screen(Targets(np.ones((6, 3, 4, 3), np.float32), rig), grid, 99)
    across, up = np.max(np.abs(offsets), axis=0)
    assert (across, up) == (2, (raster_shape(grid, 35.0, 3)[0] - 3) // 2)


@pytest.mark.parametrize(("elevation_deg", "rows"), [(0.0, 3), (35.0, 3), (20.0, 5)])
def test_moved_pictures_stand_on_the_screen_and_neighbours_apart(elevation_deg: float, rows: int) -> None:
    grid = Grid((5, 12, 14))
    rig = turntable(
        grid, spread_angles(6, elevation_deg=elevation_deg), elevation_deg=elevation_deg, picture_shape=(rows, 4)
    )
    targets = Targets(np.ones((6, rows, 4, 3), np.float32), rig)
    offsets = spread_over_screen(targets, grid, 2)
    screen = raster_shape(grid, elevation_deg)
    assert np.all(2 * np.abs(offsets) <= np.array([12 - 4, screen[0] - rows]))
    assert len(np.unique(offsets, axis=0)) == 6
    np.testing.assert_array_equal(np.unique(spread_over_screen(targets, grid, 99)[:, 0]), [-2, 2])
    shuffle = np.array([3, 5, 0, 1, 4, 2])
    np.testing.assert_array_equal(spread_over_screen(targets.take(shuffle), grid, 2), offsets[shuffle])
    np.testing.assert_array_equal(spread_over_screen(targets, grid, 0), 0)


def test_level_pictures_as_high_as_the_cube_move_sideways_only() -> None:
    offsets = spread_over_screen(unrelated(6, 0.0, Grid((3, 9, 9))), Grid((3, 9, 9)))
    assert set(offsets[:, 0]) == {1, -1}
    assert not np.any(offsets[:, 1])


def test_a_moved_window_shows_that_part_of_the_whole_screen() -> None:
    targets = cast_by_a_cube(4, 35.0)
    cube = Cube(np.random.default_rng(3).random((3, *GRID.shape)).astype(np.float32), GRID, targets.rig)
    offsets = np.array([[1, 2], [-1, 0], [0, -2], [2, 1]])
    shown = play(replace(cube, rig=targets.rig.shifted(offsets)))
    whole = play(cube, picture_only=False, angles_deg=targets.rig.views.angles_deg)
    for picture, screen, (right, down) in zip(shown, whole, offsets, strict=True):
        top, side = (screen.shape[0] - 3) // 2 + down, (screen.shape[1] - 5) // 2 + right
        np.testing.assert_allclose(picture, screen[top : top + 3, side : side + 5], rtol=1e-5)


def test_what_cannot_be_moved_is_refused() -> None:
    targets = unrelated(3)
    with pytest.raises(InputError, match="at least 0"):
        spread_over_screen(targets, GRID, -1)
    with pytest.raises(InputError, match="offsets of shape"):
        targets.rig.shifted(np.zeros((2, 2), int))
