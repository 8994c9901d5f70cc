"""Bending silhouettes: the slopes of what it costs, what agrees stays, what does not becomes one object's shadows."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import ndimage

from lightcube.errors import InputError
from lightcube.kernels import bending
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.solids import projections
from lightcube.solids import warp as warping
from lightcube.solids.certificate import certify
from lightcube.solids.elastic import NODES, elastic, least_area, splines
from lightcube.solids.reach import reach
from lightcube.solids.repair import bridges, form, repair
from lightcube.solids.silhouettes import FINE, Silhouettes
from lightcube.solids.walls import walls
from lightcube.solids.warp import warp
from tests.helpers.solid import compiled_only

BLOCK = Grid((5, 6, 7), 1.3)
BULB = Stage(
    BLOCK,
    (Lamp("bulb", position_mm=(-30.0, 4.0, 9.0)), Lamp("sun", direction=(0.2, 1.0, -0.3))),
    (
        Screen("far", (14.0, 0.0, -2.0), (14.0, 12.0), 1.4),
        Screen("back", (2.0, 12.0, -2.0), (14.0, 12.0), 1.4, normal=(0.0, -1.0, 0.0)),
    ),
    (Shot("one", "far", ("bulb",)), Shot("two", "back", ("sun",))),
    cube_turns=False,
)
RIGS = {
    "walls": walls(BLOCK).rig(),
    "raised": turntable(BLOCK, [0.0, 70.0, 200.0], elevation_deg=35.0, picture_shape=(11, 9)),
    "bulb": BULB.rig(),
}
#: Letters of bars, as parts of a square of side 10: top, bottom, left, right.
BARS = {
    "H": [(0, 10, 0, 3), (0, 10, 7, 10), (4, 6, 0, 10)],
    "U": [(0, 10, 0, 3), (0, 10, 7, 10), (7, 10, 0, 10)],
    "T": [(0, 3, 0, 10), (0, 10, 4, 6)],
    "O": [(0, 10, 0, 10)],
}


def letters(word: str, n: int) -> tuple[Silhouettes, Grid]:
    """Three letters on three walls of a block of `n` voxels, with a tenth of it around them."""
    grid = Grid((n, n, n))
    inside = np.zeros((3, FINE * n, FINE * n), bool)
    for picture, letter in zip(inside, word, strict=True):
        for bar in BARS[letter]:
            top, bottom, left, right = (round(FINE * n * (0.1 + 0.08 * each)) for each in bar)
            picture[top:bottom, left:right] = True
        if letter == "O":
            third = round(FINE * n / 3)
            picture[third:-third, third:-third] = False
    return Silhouettes(inside, walls(grid).rig(), tuple("FST")), grid


def random_distances(rig: Rig) -> NDArray[np.float64]:
    random = np.random.default_rng(2)
    rough = random.normal(size=(len(rig), *rig.picture_shape))
    return np.stack([3 * ndimage.gaussian_filter(each, 1.0) for each in rough])


def problem(rig: Rig, grid: Grid = BLOCK, joined: int = 0) -> warping._Problem:
    distances = random_distances(rig)
    onto = projections.of_voxels(projections.matrices(rig), grid)
    random = np.random.default_rng(5)
    places = random.uniform(0, np.array(grid.shape) - 1, (joined, 3))
    held, urgency = random.uniform(0, 0.1, distances.shape), random.uniform(0.5, 2, distances.shape)
    return warping._Problem(distances, onto, grid.shape, 0.5, held, urgency, places)


@pytest.mark.parametrize("name", RIGS)
def test_ways_are_those_of_plain_rays(name: str) -> None:
    """Each ray walked layer by layer, by the rig's own lamps and screens, each landing by its definition."""
    rig = RIGS[name]
    asked = problem(rig)
    deficits, culprits, places = asked.ways(asked.distances)
    rows, columns = rig.picture_shape
    onto = projections.of_voxels(projections.matrices(rig), BLOCK)
    checked = 0
    for own, row, column in np.ndindex(len(rig), rows, columns):
        if asked.distances[own, row, column] > 4:
            continue
        best, at = bending.MISSED, None
        start, way = plain_ray(rig, own, row, column)
        axis = int(np.argmax(np.abs(way)))
        for layer in range(BLOCK.shape[axis]):
            place = start + (layer - start[axis]) / way[axis] * way
            if np.any(place < -0.5 - 1e-9) or np.any(place > np.array(BLOCK.shape) - 0.5 + 1e-9):
                continue
            values = {}
            for other in range(len(rig)):
                x, y, w = onto[other] @ [*place, 1]
                values[other] = between(asked.distances[other], y / w, x / w)
            values.pop(own)
            if max(values.values()) < best - 1e-9:
                best, at = max(values.values()), max(values, key=lambda each: values[each])
        assert deficits[own, row, column] == pytest.approx(best, abs=1e-9)
        if at is not None:
            which = culprits[own, row, column]
            value = between(asked.distances[which], *places[own, row, column])
            assert value == pytest.approx(best, abs=1e-9)
            checked += 1
        else:
            assert culprits[own, row, column] == -1
    assert checked > 20


def plain_ray(rig: Rig, own: int, row: int, column: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A point and a direction, in voxels (z, y, x) from the middle of the first one."""
    views = rig.views
    middle = (np.array(views.picture_shape) - 1) / 2
    pixel = (
        views.origins_mm[own]
        + (row - middle[0]) * views.row_steps_mm[own]
        + (column - middle[1]) * views.column_steps_mm[own]
    )
    lamp = views.lamps[own]
    way = pixel - lamp[:3] if lamp[3] == 1 else lamp[:3]
    start = pixel[::-1] / BLOCK.sides_mm[::-1] + (np.array(BLOCK.shape) - 1) / 2
    return start, way[::-1] / BLOCK.sides_mm[::-1]


def between(picture: NDArray[np.float64], row: float, column: float) -> float:
    found = ndimage.map_coordinates(picture, [[row], [column]], order=1, mode="nearest")
    return float(found[0])


@pytest.mark.parametrize("name", RIGS)
def test_the_cost_falls_as_its_slope_says(name: str) -> None:
    """Along random ways, by the middle of two small steps; kinks lie on few of them."""
    asked = problem(RIGS[name], joined=4)
    random = np.random.default_rng(7)
    moves = random.normal(0, 0.4, (len(asked.distances), 2, *asked.distances.shape[1:]))
    _, slope = asked.cost(moves, 2.0)
    off = []
    for _ in range(12):
        way = random.normal(size=moves.shape) * (random.uniform(size=moves.shape) < 0.1)
        ahead, back = (asked.cost(moves + step * way, 2.0)[0] for step in (1e-6, -1e-6))
        said = float(np.sum(slope * way))
        off.append(abs((ahead - back) / 2e-6 - said) / (1 + abs(said)))
    assert np.median(off) < 1e-5
    assert np.mean(np.array(off) < 1e-3) > 0.7


def test_the_elastic_cost_falls_as_its_slope_says() -> None:
    """Folded spots included."""
    random = np.random.default_rng(3)
    moves, held = random.normal(0, 0.7, (2, 2, 5, 7)), random.uniform(0, 1, (2, 5, 7))
    assert least_area(moves) < 0
    _, slope = elastic(moves, held)
    for at in [(0, 0, 0, 0), (1, 1, 2, 3), (0, 1, 4, 6), (1, 0, 3, 0)]:
        step = np.zeros_like(moves)
        step[at] = 1e-6
        ahead, back = (elastic(moves + sign * step, held)[0] for sign in (1, -1))
        assert (ahead - back) / 2e-6 == pytest.approx(slope[at], rel=1e-5, abs=1e-5)


def test_turning_costs_little_and_shearing_much() -> None:
    y, x = np.mgrid[-16:17, -16:17].astype(float)
    small = 0.02
    turned, sheared, shrunk = (small * np.stack(each)[None] for each in ((x, -y), (x, y), (-y, -x)))  # down, across
    nothing = np.zeros((1, 33, 33))
    costs = [elastic(each, nothing)[0] - 0.02 / (33 / 64) ** 2 * np.sum(each**2) for each in (turned, sheared, shrunk)]
    assert costs[0] < 1e-3 * min(costs[1:])
    assert least_area(shrunk) == pytest.approx((1 - small) ** 2)


def test_splines_are_even() -> None:
    for count in (7, 40):
        made = splines(count)
        assert made.shape == (count, NODES)
        np.testing.assert_allclose(made.sum(axis=1), 1)
        line = made @ np.arange(NODES)
        np.testing.assert_allclose(np.diff(line), (NODES - 3) / count)


@compiled_only
def test_what_agrees_stays() -> None:
    silhouettes, grid = letters("OOO", 30)
    found = warp(silhouettes, grid)
    assert np.abs(found.moves()).max() <= 0.05
    assert np.mean(found.silhouettes.inside ^ silhouettes.inside) < 0.02


@compiled_only
def test_a_word_becomes_one_object() -> None:
    """H, U and T leave two fifths of each other out: bent, all is cast by one watertight piece, as they were formed."""
    silhouettes, grid = letters("HUT", 40)
    assert reach(silhouettes, grid).share > 0.1
    found = repair(silhouettes, grid, "warp")
    assert found.warped is not None
    assert found.warped.least_area > 0.1
    after = reach(found.shape.silhouettes, grid)
    assert after.share < 1e-3
    assert after.is_one_piece
    assert found.kept_forms == (True, True, True)
    assert found.shape.mesh.is_watertight
    assert certify(found.shape.mesh, found.shape.silhouettes).overlap.min() > 0.99
    assert 0.5 < found.overlaps.min() < 0.95
    assert 0.2 < found.moved_px < 3


@compiled_only
def test_threads_decide_no_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    from lightcube import kernels

    silhouettes, grid = letters("HUT", 20)
    found = []
    for count in (1, 3):
        monkeypatch.setattr(kernels, "default_threads", lambda count=count: count)
        found.append(warp(silhouettes, grid).nodes)
    assert np.array_equal(found[0], found[1])


@compiled_only
def test_what_is_held_stays() -> None:
    silhouettes, grid = letters("HUT", 30)
    held = np.zeros((3, 30, 30), bool)
    held[1] = True
    free, kept = (np.abs(warp(silhouettes, grid, held=each).moves()).mean(axis=(1, 2, 3)) for each in (None, held))
    assert kept[1] < 0.2 * free[1]
    assert kept[0] > 0.5 * free[0]
    with pytest.raises(InputError, match="what is held"):
        warp(silhouettes, grid, held=held[:2])


@compiled_only
def test_walls_are_kept_thick() -> None:
    """With walls of 3 pixels asked for, what a ball of that size can reach casts nearly all."""
    silhouettes, grid = letters("HUT", 48)
    lost = []
    for wall in (0.0, 1.5):
        shape = repair(silhouettes, grid, "warp", wall_px=wall).shape
        deep = ndimage.distance_transform_edt(shape.inside) > 1.5
        opened = (ndimage.distance_transform_edt(~deep) <= 1.5) & shape.inside
        shadows = [opened.any(axis=axis) for axis in (1, 2, 0)], [shape.inside.any(axis=axis) for axis in (1, 2, 0)]
        lost.append(1 - sum(map(np.sum, shadows[0])) / sum(map(np.sum, shadows[1])))
    assert lost[1] < 0.02
    assert lost[1] < 0.5 * lost[0]


@compiled_only
def test_trimming_keeps_to_what_was_given_and_ends() -> None:
    silhouettes, grid = letters("HUT", 30)
    once = repair(silhouettes, grid, "trim")
    assert not np.any(once.shape.silhouettes.inside & ~silhouettes.inside)
    again = repair(once.shape.silhouettes, grid, "trim")
    assert again.overlaps.min() > 0.98


@compiled_only
def test_growing_keeps_all_that_was_given() -> None:
    silhouettes, grid = letters("HUT", 24)
    found = repair(silhouettes, grid, "grow")
    lost = silhouettes.pixels() & ~found.shape.silhouettes.pixels()
    assert np.count_nonzero(lost) <= 0.01 * np.count_nonzero(silhouettes.pixels())
    assert reach(found.shape.silhouettes, grid).share < 0.01
    assert found.overlaps.min() > 0.5


@compiled_only
def test_alone_it_trims_what_hardly_shows_and_bends_the_rest() -> None:
    agreeing, grid = letters("OOO", 30)
    assert repair(agreeing, grid).way == "trim"
    word, grid = letters("HUT", 24)
    assert repair(word, grid).way == "warp"
    assert repair(word, grid, "none").shape.silhouettes is word


@compiled_only
def test_what_casts_nothing_in_common_is_bent_until_it_does() -> None:
    """The front is above the side: nothing at all can stand, and alone it bends nevertheless."""
    grid = Grid((24, 24, 24))
    inside = np.zeros((3, 96, 96), bool)
    inside[0, 24:48, 20:76] = inside[1, 50:76, 20:76] = inside[2, 20:76, 20:76] = True
    given = Silhouettes(inside, walls(grid).rig(), ("F", "S", "T"))
    assert reach(given, grid).share == 1
    found = repair(given, grid)
    assert found.way == "warp"
    assert reach(found.shape.silhouettes, grid).share < 0.01
    assert found.overlaps.min() > 0.4
    with pytest.raises(InputError, match="nothing casts shadows in all these"):
        repair(given, grid, "trim")


def test_bridges_join_pieces() -> None:
    z, y, x = np.mgrid[:9, :11, :25]
    balls = [np.sqrt((z - 4) ** 2 + (y - 5) ** 2 + (x - at) ** 2) - 3.3 for at in (4, 20)]
    field = np.minimum(*balls)
    assert ndimage.label(field < 0)[1] == 2
    ways = bridges(field)
    joined = field < 0
    joined[tuple(ways.astype(int).T)] = True
    assert ndimage.label(joined)[1] == 1
    assert np.all(ways[:, 0] == 4)  # straight on
    assert bridges(balls[0]).shape == (0, 3)


def test_forms_count_parts_and_holes() -> None:
    for word, forms in (("HUO", [(1, 0), (1, 0), (1, 1)]), ("TOH", [(1, 0), (1, 1), (1, 0)])):
        assert [form(each) for each in letters(word, 20)[0].inside] == forms
    two = np.zeros((5, 7), bool)
    two[1, 1] = two[3, 5] = True
    assert form(two) == (2, 0)


def test_a_problem_at_half_its_size_is_the_same_one() -> None:
    """Where a place of the block lands, halved."""
    asked = problem(RIGS["raised"])
    half = asked.halved()
    place = np.array([1.0, 2.0, 1.5])  # of voxels twice as large
    for whole, halved in zip(asked.onto, half.onto, strict=True):
        x, y, w = whole @ [*(2 * place + 0.5), 1]
        u, v, t = halved @ [*place, 1]
        np.testing.assert_allclose([u / t, v / t], [(x / w - 0.5) / 2, (y / w - 0.5) / 2])
    flat = replace(asked, distances=np.full_like(asked.distances, 3.0))
    assert np.all(flat.halved().distances == 1.5)
