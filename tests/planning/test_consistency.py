"""What no cube can do, against cubes that did it, plain sums, and pictures made to fail."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numba import config
from numpy.typing import NDArray

from lightcube.io.scenes import read_scene
from lightcube.kernels.layout import columns_from_volume, pictures_from_columns
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.transfer import decode, encode
from lightcube.optics.views import spread_angles
from lightcube.pictures.samples import photographs
from lightcube.pictures.targets import Targets
from lightcube.planning.consistency import (
    advice,
    check,
    duplicates,
    load,
    mirror_conflicts,
    moments,
    plain_rows,
    row_conflicts,
)
from lightcube.projection.projector import Projector
from lightcube.scene.tracer import scene_targets
from tests.helpers.recipes import fitted, lit

JIT_OFF = bool(getattr(config, "DISABLE_JIT", 0))
SHAPE = (3, 5, 7)
SIDE = 1.5
GEMS = Grid((16, 16, 16)) if JIT_OFF else Grid((32, 34, 30))
ANGLES = [11.0, 52.0, 83.0, 124.0, 165.0]


def pictures_of(cube: NDArray[Any], grid: Grid, rig: Any, powers: NDArray[Any] | float = 1.0) -> Targets:
    """What a cube ``(channel, z, y, x)`` casts."""
    absorbance = Projector(grid, rig).forward(columns_from_volume(cube)).reshape(-1, rig.picture_shape[0] * 3)
    light = pictures_from_columns(np.exp(-absorbance), rig.picture_shape, 3)
    return Targets((light * powers).astype(np.float32), rig)


def gems(angles_deg: Any, elevation_deg: float) -> Targets:
    return scene_targets(read_scene("gems"), turntable(GEMS, angles_deg, elevation_deg=elevation_deg), GEMS)


def unrelated(elevation_deg: float) -> Targets:
    whole = turntable(GEMS, [0.0], elevation_deg=elevation_deg).picture_shape[1]
    return fitted(
        photographs(5), GEMS, angles_deg=ANGLES, elevation_deg=elevation_deg, picture_width=whole / GEMS.shape[1]
    )


def grey(seed: int = 0, columns: int = 9, angles_deg: Any = ANGLES, elevation_deg: float = 0.0) -> Targets:
    """Pictures of 3 rows, between a fifth and a third of white."""
    rig = turntable(Grid(SHAPE, SIDE), angles_deg, elevation_deg=elevation_deg, picture_shape=(3, columns))
    light = np.random.default_rng(seed).uniform(0.2, 0.3, (len(rig), 3, columns, 3))
    return Targets(light.astype(np.float32), rig, names=tuple("abcdefgh"[: len(rig)]))


@pytest.mark.parametrize("columns", [3, 4, 6, 7, 9])
@pytest.mark.parametrize("filled", [0.02, 0.2, 1.0])
@pytest.mark.parametrize("shape", [SHAPE, (3, 3, 11)])
def test_no_cube_s_own_pictures_conflict(shape: tuple[int, int, int], filled: float, columns: int) -> None:
    grid = Grid(shape, SIDE)
    for seed in range(3 if JIT_OFF else 20):
        random = np.random.default_rng(seed)
        angles_deg = np.append(random.uniform(0, 360, 7), [0.0, 45.0, 90.0, 180.0, 225.0, 270.0])
        cube = random.exponential(1.0, (3, *shape)) * (random.random((3, *shape)) < filled)
        powers = random.uniform(0.25, 1, (len(angles_deg), 1, 1, 3))
        targets = pictures_of(cube, grid, turntable(grid, angles_deg, picture_shape=(3, columns)), powers)
        assert row_conflicts(targets, grid, lamp_max=1.0) == []


def test_of_beams_two_voxels_apart_no_row_is_said_to_conflict() -> None:
    """One voxel may stand in the way of none of them in one view, and of one in another."""
    grid, angles_deg = Grid((3, 5, 7)), [0.0, 20.0, 45.0, 90.0]
    for y, x in np.ndindex(5, 7):
        cube = np.zeros((3, 3, 5, 7))
        cube[..., y, x] = 5.0
        targets = pictures_of_rays(cube, grid, turntable(grid, angles_deg, pixel=2))
        assert row_conflicts(targets, grid, lamp_max=1.0) == []
    assert check(targets, grid)["whole_shadow"]
    narrow = turntable(grid, angles_deg, picture_shape=(2, targets.rig.picture_shape[1] - 2), pixel=2)
    assert not check(pictures_of_rays(cube, grid, narrow), grid)["whole_shadow"]


def pictures_of_rays(cube: NDArray[Any], grid: Grid, rig: Any) -> Targets:
    """What a cube ``(channel, z, y, x)`` casts, by pixels of any size."""
    return Targets(np.exp(-Projector(grid, rig)(cube)).astype(np.float32), rig)


def test_one_voxel_s_totals_differ_by_the_factor_that_is_allowed() -> None:
    # Turned by 45 degrees a voxel is a rhomb, seen by one beam through its tip or by two beside it.
    grid = Grid((1, 8, 8))
    rig = turntable(grid, [45.0])
    totals = []
    for x in range(8):
        cube = np.zeros((3, 1, 8, 8))
        cube[:, 0, 3, x] = 1
        totals.append(-np.log(pictures_of(cube, grid, rig).pictures[0, 0, :, 0].astype(float)).sum())
    assert max(totals) <= np.sqrt(2) + 1e-5
    assert min(totals) >= 2 * np.sqrt(2) - 2 - 1e-5
    assert max(totals) / min(totals) > 1.5


@pytest.mark.parametrize(("view", "row", "channel"), [(3, 0, 1), (1, 2, 2)])
def test_a_white_row_is_found_where_it_is(view: int, row: int, channel: int) -> None:
    grid, targets = Grid(SHAPE, SIDE), grey()
    light = targets.pictures.copy()
    light[:, 0, 0] = 1  # so that no weak lamp makes the pictures' grey white
    light[view, row, :, channel] = 1
    (found,) = row_conflicts(replace(targets, pictures=light), grid, lamp_max=1.0)
    assert (found["row"], found["channel"]) == (row, ("red", "green", "blue")[channel])
    assert found["bright"] == "abcde"[view]
    assert found["dark"] != found["bright"]
    assert found["columns"] == 9
    dark = light["abcde".index(found["dark"]), row, :, channel].astype(float)
    assert found["allowed"] == pytest.approx(0, abs=1e-6)
    assert found["wanted"] == pytest.approx(-np.log(dark).sum(), rel=1e-5)
    assert found["darkest"] == pytest.approx(1)
    assert found["mean"] == pytest.approx(encode(np.array(np.prod(dark) ** (1 / 9))), rel=1e-5)


def test_a_white_row_forces_nothing_where_one_of_its_pixels_may_be_as_dark_as_it_likes() -> None:
    grid, targets = Grid(SHAPE, SIDE), grey()
    light, weights = targets.pictures.copy(), targets.weight.copy()
    light[:, 0, 0] = 1
    light[3, 1] = 1
    light[0, 1] = 0.13  # darker than one black beam elsewhere could account for
    white = replace(targets, pictures=light)
    assert row_conflicts(white, grid, 1.0)
    weights[3, 1, 2] = 0
    assert row_conflicts(replace(white, weights=weights), grid, 1.0) == []
    light[3, 1, 2] = 0
    assert row_conflicts(replace(white, pictures=light), grid, 1.0) == []


def test_a_stronger_lamp_a_raised_lamp_and_a_margin_each_undo_a_white_row() -> None:
    grid = Grid(SHAPE, SIDE)

    def conflicts(lamp_max: float = 1.0, **how: Any) -> list[dict[str, Any]]:
        targets = grey(**how)
        light = targets.pictures.copy()
        light[:, 0, 0] = 1
        light[1, 2] = 1
        return row_conflicts(replace(targets, pictures=light), grid, lamp_max)

    found = conflicts()
    assert [(each["row"], each["channel"]) for each in found] == [(2, "red"), (2, "green"), (2, "blue")]
    needed = max(each["lamp"] for each in found)
    assert conflicts(0.9 * needed)
    assert not conflicts(1.001 * needed)
    assert not conflicts(elevation_deg=30.0)
    assert not conflicts(columns=3)
    # ... but not a margin between views that look through the same strip
    assert conflicts(columns=5, angles_deg=[10.0, 12.0, 100.0])


def test_shadows_of_a_solid_have_the_moments_of_one_and_photographs_have_not() -> None:
    for elevation_deg in (0.0, 35.0):
        solid, photos = moments(gems(ANGLES, elevation_deg)), moments(unrelated(elevation_deg))
        assert solid["total"] < 0.05
        assert max(solid["across"], solid["down"]) < 0.01
        assert photos["total"] > 0.25
        assert photos["across"] > 0.02
        assert (photos["down"] > 0.01) == (elevation_deg > 0)
        assert (photos["total_with_lamps"] > 0.15) == (elevation_deg == 0)


def test_mirrored_shadows_of_a_solid_are_no_conflict() -> None:
    targets = gems([20.0, 77.0, 200.0], 0.0)
    assert mirror_conflicts(targets) == []
    assert mirror_conflicts(replace(targets, pictures=targets.pictures[[0, 1, 1]])) == [(0, 2)]


def test_moments_are_those_of_plain_sums() -> None:
    level = moments(grey(1))
    assert level == pytest.approx(plain_moments(grey(1)), rel=1e-5)
    raised = grey(2, angles_deg=[10.0, 60.0, 200.0, 250.0, 300.0], elevation_deg=30.0)
    assert moments(raised) == pytest.approx(plain_moments(raised), rel=1e-5, abs=1e-12)


def plain_moments(targets: Targets) -> dict[str, float]:
    rig, rows, columns, _ = targets.pictures.shape
    raised = targets.rig.views.elevations_deg[0] > 0
    turn = np.radians(targets.rig.views.angles_deg)
    total: dict[tuple[int, int, int], float] = {}
    across: dict[tuple[int, int, int], float] = {}
    down: dict[tuple[int, int, int], float] = {}
    for v, r, k, c in np.ndindex(targets.pictures.shape):
        absorbance = -np.log(float(targets.pictures[v, r, k, c]))
        slot = (v, 0 if raised else r, c)
        total[slot] = total.get(slot, 0) + absorbance
        across[slot] = across.get(slot, 0) + absorbance * (k - columns / 2 + 0.5)
        down[v, 0, c] = down.get((v, 0, c), 0) + absorbance * (r - rows / 2 + 0.5)
    slots = sorted({slot[1:] for slot in total})
    scale = float(np.mean(list(total.values())))
    deviations: dict[str, list[float]] = {"total": [], "with": [], "across": [], "down": []}
    for r, c in slots:
        column = np.array([total[v, r, c] for v in range(rig)])
        of_channel = np.array([[total[v, other, c] for v in range(rig)] for other, k in slots if k == c])
        deviations["total"] += list(column - column.mean())
        deviations["with"] += list(column - column.mean() - of_channel.mean(axis=0) + of_channel.mean())
        design = np.stack([np.cos(turn), np.sin(turn)]).T
        deviations["across"] += list(left_by(design, np.array([across[v, r, c] for v in range(rig)])))
        if raised:
            design = np.stack([np.cos(turn), np.sin(turn), np.ones(rig)]).T
            deviations["down"] += list(left_by(design, np.array([down[v, r, c] for v in range(rig)])))
    spread = {name: float(np.sqrt(np.mean(np.square(found or [0.0])))) / scale for name, found in deviations.items()}
    return {
        "total": spread["total"],
        "total_with_lamps": spread["with"],
        "across": spread["across"] / columns,
        "down": spread["down"] / rows,
    }


def left_by(design: NDArray[Any], values: NDArray[Any]) -> NDArray[Any]:
    """Residual of the normal equations."""
    return np.asarray(values - design @ np.linalg.solve(design.T @ design, design.T @ values))


@pytest.mark.parametrize("elevation_deg", [0.0, 30.0])
def test_lamp_powers_change_totals_only(elevation_deg: float) -> None:
    targets = grey(3, elevation_deg=elevation_deg)
    powers = np.random.default_rng(3).uniform(0.3, 1, (5, 1, 1, 3))
    powers /= np.exp(np.mean(np.log(powers)))  # keeps the mean total, which the figures are parts of
    dimmed = replace(targets, pictures=(targets.pictures * powers).astype(np.float32))
    before, after = moments(targets), moments(dimmed)
    assert after["total"] > 2 * before["total"]
    for name in ("total_with_lamps", "across", "down"):
        assert after[name] == pytest.approx(before[name], rel=1e-4, abs=1e-9)


def test_duplicates_are_those_a_loop_finds() -> None:
    targets = grey(4, angles_deg=[*ANGLES, 170.0])
    light = targets.pictures.copy()
    light[3], light[4] = light[1], decode(encode(light[0]) + np.float32(0.8 / 255))
    light[5] = light[0]
    light[5, ..., 0] += 0.01
    weights = np.random.default_rng(4).uniform(0, 2, light.shape[:3]).astype(np.float32)
    weights[2, :, 3:] = 0
    light[2, :, :3] = light[1, :, :3]
    made = replace(targets, pictures=light, weights=weights)
    expected = []
    for first in range(6):
        for second in range(first + 1, 6):
            both = weights[first] * weights[second]
            apart = (encode(light[first]) - encode(light[second])) ** 2
            if np.sum(both[..., None] * apart) <= np.sum(both) * 3 / 255**2:
                expected.append((first, second))
    assert expected == [(0, 4), (1, 2), (1, 3), (2, 3)]
    assert duplicates(made) == expected


def test_white_and_blank_rows_count_only_what_matters() -> None:
    targets = grey(5, columns=7)
    light, weights = targets.pictures.copy(), targets.weight.copy()
    light[1, :2] = 0.995
    light[2, 1] = [0.1, 0.5, 0.9]
    light[3, 2, 1:] = 1
    weights[3, 2, 0] = 0
    weights[4, 0] = 0
    light[0, 2, 1:] = 1
    white, blank = plain_rows(replace(targets, pictures=light, weights=weights))
    assert white == {1: [[0, 1]], 3: [[2, 2]]}
    assert blank == {2: [[1, 1]]}


@pytest.mark.parametrize("elevation_deg", [0.0, 30.0])
def test_what_is_don_t_care_changes_nothing(elevation_deg: float) -> None:
    grid, targets = Grid(SHAPE, SIDE), grey(6, elevation_deg=elevation_deg)
    weights = targets.weight.copy()
    weights[1, :, :2] = 0
    weights[2, 1] = 0
    weights[:, 2, 4] = 0
    weights[:, 0] = 0
    light = targets.pictures.copy()
    light[3, 1] = 1
    made = replace(targets, pictures=light, weights=weights)
    other = np.where(weights[..., None] > 0, light, np.random.default_rng(7).random(light.shape)).astype(np.float32)
    made = lit(made, lamp_power=1.0)
    facts = check(made, grid)
    assert facts == check(replace(made, pictures=other), grid)
    assert bool(facts["row_conflicts"]) == (elevation_deg == 0)


def test_the_load_counts_widths_or_areas() -> None:
    grid = Grid((6, 5, 7))
    level = turntable(grid, ANGLES, picture_shape=(4, 3))
    raised = turntable(grid, ANGLES, elevation_deg=30.0, picture_shape=(4, 3))
    assert load(level.views, grid) == pytest.approx(5 * 3 / 5)
    assert load(raised.views, grid) == pytest.approx(5 * 3 * 4 / (5 * 6))
    wide = turntable(grid, ANGLES, picture_shape=(3, 3), pixel=2)
    assert load(wide.views, grid) == pytest.approx(5 * 3 * 3 / (5 * 6))  # pixels a voxel, times the width
    assert load(turntable(grid, ANGLES, elevation_deg=30.0, picture_shape=(3, 3), pixel=2).views, grid) == (
        pytest.approx(load(wide.views, grid))
    )


def test_facts_go_through_json_and_say_whether_the_whole_shadow_is_seen() -> None:
    grid = Grid(SHAPE, SIDE)
    facts = check(grey(), grid)
    assert json.loads(json.dumps(facts)) == facts
    assert facts["whole_shadow"]
    assert not check(grey(columns=7), grid)["whole_shadow"]
    assert not check(grey(elevation_deg=30.0), grid)["whole_shadow"]
    white = check(replace(grey(), pictures=np.ones((5, 3, 9, 3), np.float32)), grid)
    assert set(white["moments"].values()) == {0.0}


def test_good_pictures_need_no_advice() -> None:
    grid = Grid((32, 32, 32))
    assert advice(check(fitted(photographs(16), grid, elevation_deg=35.0, picture_width=0.5), grid)) == []
    for elevation_deg in (0.0, 35.0):
        assert (
            advice(check(lit(gems(spread_angles(5, elevation_deg=elevation_deg), elevation_deg), lamp_power=1.0), GEMS))
            == []
        )


def test_advice_names_pictures_rows_and_a_way_out() -> None:
    grid = Grid((24, 24, 24))
    targets = fitted(photographs(8), grid, span_deg=360.0, elevation_deg=0.0, picture_width=1.4)
    light = targets.pictures.copy()
    light[3, 4:7] = 1
    light[3, 9] = 1
    light[6], light[5, :2] = light[1], 0.5
    facts = check(lit(replace(targets, pictures=light), lamp_power=1.0), grid)
    said = advice(facts)
    for beginning, part in [
        (
            "These are 2.5 times as many pixels as a cube keeps well of unrelated pictures: use at most 3 pictures",
            "at most 13 pixels",
        ),
        ("No solid casts these shadows", "--picture-width"),
        ("astronaut and cat are half a turn apart", "--elevation-deg 35"),
        ("moon and clock are the same picture: leave one of them out", ""),
        ("brick is too bright for a lamp of 1 (0 EV) in rows", "--lamp-max"),
        ("rocket is of one colour in rows 0-1", "cut such edges off"),
    ]:
        assert sum(sentence.startswith(beginning) and part in sentence for sentence in said) == 1, (beginning, said)
    assert {each["row"] for each in facts["row_conflicts"] if each["bright"] == "brick"} >= {4, 5, 6, 9}
    assert facts["white_rows"]["brick"] == [[4, 6], [9, 9]]
