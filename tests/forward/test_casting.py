"""Program 3 and the scores: what is cast, at the stops and between them."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import ArrayLike
from skimage.color import deltaE_ciede2000, rgb2lab

from lightcube.drawing.sheet import beside_targets
from lightcube.errors import InputError
from lightcube.forward import casting
from lightcube.forward.turning import moment, turn
from lightcube.kernels.layout import columns_from_volume, pictures_from_columns
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.optics.transfer import encode
from lightcube.pictures.fitting import as_levels
from lightcube.pictures.targets import Targets
from lightcube.planning.consistency import mirror_conflicts
from lightcube.projection.projector import Projector
from lightcube.scoring.metrics import mean_psnr, psnr, score, ssim
from tests.helpers import plain
from tests.helpers.thin import cast, play, player

SHAPE = (3, 5, 7)


def make_cube(
    angles_deg: list[float], elevation_deg: float = 0.0, powers: np.ndarray | None = None, **more: object
) -> Cube:
    grid = Grid(SHAPE, 0.5)
    extinction = np.random.default_rng(0).random((3, *SHAPE)).astype(np.float32)
    rig = turntable(grid, angles_deg, elevation_deg=elevation_deg, picture_shape=(3, 5))
    return Cube(extinction, grid, rig, lamp_powers=powers, **more)  # type: ignore[arg-type]


def powers_at(cube: Cube, angles_deg: ArrayLike) -> np.ndarray:
    """Of the one lamp at any angles."""
    return moment(cube, angles_deg)[1]


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0, -20.0])
def test_what_is_played_is_the_plain_forward_computation(elevation_deg: float) -> None:
    powers = np.array([[1.0, 2.0, 0.5], [4.0, 1.0, 1.0]])
    cube = make_cube([10.0, 100.0], elevation_deg, powers)
    expected = np.exp(-plain.absorbance_pictures(cube.grid, cube.rig.views, cube.extinction)) * powers[:, None, None, :]
    assert np.allclose(play(cube), expected, rtol=1e-5)
    assert np.allclose(play(cube, [10.0, 100.0]), expected, rtol=1e-5)


def test_many_views_come_in_order_and_one_by_one() -> None:
    cube = make_cube([10.0, 100.0])
    angles_deg = np.linspace(0, 360, 37)
    one_by_one = np.stack([play(cube, [angle_deg])[0] for angle_deg in angles_deg])
    assert np.array_equal(play(cube, angles_deg), one_by_one)


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
@pytest.mark.parametrize("picture_only", [False, True])
def test_a_player_shows_what_play_does_however_often_it_is_asked(elevation_deg: float, picture_only: bool) -> None:
    powers = np.array([[1.0, 2.0, 0.5], [4.0, 1.0, 1.0]])
    cube = make_cube([10.0, 100.0], elevation_deg, powers)
    show = player(cube, picture_only=picture_only)
    angles_deg = [3.0, 100.0, -77.7]
    expected = play(cube, angles_deg, picture_only=picture_only)
    assert np.array_equal(show(angles_deg), expected)
    assert np.array_equal(np.concatenate([show(angle_deg) for angle_deg in angles_deg]), expected)
    assert np.array_equal(show(None), play(cube, picture_only=picture_only))


def test_a_player_refuses_what_are_no_angles() -> None:
    show = player(make_cube([10.0]))
    with pytest.raises(InputError, match="angle number 2 is not a finite number"):
        show([1.0, np.nan])
    with pytest.raises(InputError, match="at least one"):
        show([])


@pytest.mark.parametrize(("elevation_deg", "window"), [(0.0, (1, 36)), (35.0, (5, 34)), (0.0, None), (20.0, None)])
def test_strips_of_beams_and_batches_leave_no_seam(elevation_deg: float, window: tuple[int, int] | None) -> None:
    """Few views, shared by strips, and more views than a batch: still the plain forward computation."""
    grid = Grid((1, 30, 36), 0.5)
    angles_deg = np.linspace(1, 170, 2) if window else np.linspace(1, 170, 17)
    extinction = np.random.default_rng(6).random((2, 1, 30, 36)).astype(np.float32)
    rig = turntable(grid, angles_deg, elevation_deg=elevation_deg, picture_shape=window)
    cube = Cube(extinction, grid, rig, lamp_powers=np.random.default_rng(7).random((len(angles_deg), 2)) + 0.5)
    matrix = Projector(grid, rig)
    absorbance = matrix.forward(columns_from_volume(extinction).reshape(matrix.shape[1], -1))
    block = absorbance.reshape(-1, rig.picture_shape[0] * 2)
    expected = np.exp(-pictures_from_columns(block, rig.picture_shape, 2)) * cube.powers[:, None, None, :]
    assert np.allclose(play(cube), expected, rtol=1e-5)


def test_beams_that_miss_the_cube_show_the_lamp() -> None:
    cube = make_cube([10.0], powers=np.array([[3.0, 2.0, 1.0]]))
    whole = play(cube, [0.0], picture_only=False)
    assert np.allclose(whole[0, :, 0], [3.0, 2.0, 1.0])
    window = play(cube, [0.0])
    assert np.allclose(whole[0][:, 2:-2], window[0], rtol=1e-6)


def test_the_whole_screen_at_the_stops_has_the_pictures_in_its_middle() -> None:
    cube = make_cube([10.0, 77.0], 35.0)
    whole, window = play(cube, picture_only=False), play(cube)
    top, left = ((big - small) // 2 for big, small in zip(whole.shape[1:3], window.shape[1:3], strict=True))
    rows, columns = window.shape[1:3]
    assert np.allclose(whole[:, top : top + rows, left : left + columns], window, rtol=1e-6)


def test_the_lamp_is_linear_in_its_logarithm_and_periodic() -> None:
    powers = np.array([[1.0] * 3, [4.0] * 3])
    level = make_cube([0.0, 90.0], powers=powers)
    assert powers_at(level, [0, 90, 180, 270])[:, 0] == pytest.approx([1, 4, 1, 4])
    assert powers_at(level, [45, 135])[:, 0] == pytest.approx([2, 2])
    assert powers_at(level, [-315])[:, 0] == pytest.approx([2])
    raised = make_cube([0.0, 90.0], 35.0, powers)
    assert powers_at(raised, [0, 90, 225])[:, 0] == pytest.approx([1, 4, 2])
    opposite = make_cube([0.0, 180.0], 0.0, powers)
    assert powers_at(opposite, [180])[:, 0] == pytest.approx([4])


def test_lamps_at_several_elevations_stand_as_at_the_nearest_stop() -> None:
    grid = Grid(SHAPE)
    one, other = (
        turntable(grid, [a], elevation_deg=e, picture_shape=(3, 5)).views for a, e in ((10, 0.0), (100, 20.0))
    )
    cube = Cube(np.zeros((3, *SHAPE), np.float32), grid, Rig.of(one.joined(other)))
    assert np.allclose(play(cube), 1)
    assert moment(cube, [20.0, 90.0])[0].views.elevations_deg.tolist() == [0, 20]


def test_psnr_is_its_definition_weighted_and_capped() -> None:
    random = np.random.default_rng(1)
    wanted, shown = random.random((2, 6, 4, 3))
    weight = random.integers(0, 2, (6, 4)).astype(float)
    squares = [np.mean((wanted[y, x] - shown[y, x]) ** 2) for y in range(6) for x in range(4) if weight[y, x]]
    assert psnr(shown, wanted, weight) == pytest.approx(-10 * np.log10(np.mean(squares)))
    assert psnr(wanted, wanted, weight) == 100
    assert psnr(wanted + 1.0, wanted, weight) == pytest.approx(0)
    one_level = psnr(wanted + 0.5 / 255 / np.sqrt(3) * 1.0, wanted, weight)
    assert one_level == pytest.approx(58.9, abs=0.1)  # what rounding to 8 bits costs


def test_ssim_is_1_for_the_same_picture_and_needs_3_pixels() -> None:
    random = np.random.default_rng(2)
    picture = random.random((9, 8, 3))
    weight = np.ones((9, 8))
    assert ssim(picture, picture, weight) == pytest.approx(1)
    assert ssim(picture, random.random((9, 8, 3)), weight) < 0.5
    assert np.isnan(ssim(picture[:2], picture[:2], weight[:2]))
    assert ssim(picture[:4, :5], picture[:4, :5], weight[:4, :5]) == pytest.approx(1)


def test_ssim_does_not_see_pixels_of_no_weight() -> None:
    random = np.random.default_rng(5)
    wanted = random.random((9, 8, 3))
    weight = np.ones((9, 8))
    weight[:, :3] = 0
    spoiled = wanted.copy()
    spoiled[:, :3] = random.random((9, 3, 3))
    assert ssim(spoiled, wanted, weight) == pytest.approx(1)
    spoiled[4, 5] = 1 - spoiled[4, 5]
    assert ssim(spoiled, wanted, weight) < 0.99


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
@pytest.mark.parametrize("count", [7, 24, 60])
def test_a_turn_meets_every_stop_and_stays_even_elsewhere(elevation_deg: float, count: int) -> None:
    cube = make_cube([10.1, 77.3, 140.0], elevation_deg)
    angles_deg = turn(cube, count)
    even = np.arange(count) * 360 / count
    assert np.all(np.diff(angles_deg) > 0)
    assert np.max(np.abs(angles_deg - even)) <= 180 / count + 1e-9
    for stop in cube.rig.views.angles_deg:
        assert np.min(np.abs(angles_deg - stop)) < 1e-9
        assert (np.min(np.abs(angles_deg - stop - 180)) < 1e-9) == (elevation_deg == 0)
    assert np.sum(np.abs(angles_deg - even) > 1e-9) <= (6 if elevation_deg == 0 else 3)
    laps = turn(cube, 2 * count, 0.0, 720.0)
    assert np.allclose(laps[count:], angles_deg + 360)
    back = turn(cube, count, 360.0, 0.0)
    assert all(np.min(np.abs(np.remainder(back - stop + 180, 360) - 180)) < 1e-9 for stop in cube.rig.views.angles_deg)
    part = turn(cube, 10, 0.0, 50.0)
    assert part.min() >= -2.5
    assert part.max() <= 50.0


def test_the_score_is_of_what_is_cast_lamp_and_all() -> None:
    powers = np.array([[1.0, 2.0, 0.5], [4.0, 1.0, 1.0]])
    cube = make_cube([10.0, 100.0], 35.0, powers, names=("a", "b"))
    shown = casting.play(cube, picture_only=True)
    random = np.random.default_rng(3)
    targets = Targets(
        np.clip(shown * random.uniform(0.8, 1.1, shown.shape), 0, None).astype(np.float32),
        cube.rig,
        random.integers(0, 2, shown.shape[:3]).astype(np.float32),
        ("a", "b"),
    )
    scores = score(cube, targets)
    for index, view in enumerate(scores["pictures"]):
        pair = encode(shown[index]), encode(targets.pictures[index])
        assert view["psnr"] == pytest.approx(psnr(*pair, targets.weight[index]), rel=1e-4)
        difference = deltaE_ciede2000(rgb2lab(pair[0]), rgb2lab(pair[1]))
        weight = targets.weight[index]
        assert view["delta_e"] == pytest.approx(np.sum(difference * weight) / weight.sum(), rel=1e-3)
        assert view["name"] == "ab"[index]
    assert scores["psnr_mean"] == pytest.approx(np.mean([view["psnr"] for view in scores["pictures"]]))
    assert scores["psnr_min"] == min(view["psnr"] for view in scores["pictures"])
    assert mean_psnr(shown, targets) == pytest.approx(scores["psnr_mean"], rel=1e-4)
    assert score(cube, Targets(shown, cube.rig))["psnr_mean"] == 100


def test_the_score_without_targets_is_that_of_the_pictures() -> None:
    """Targets are kept so finely that the file tells what was told when the cube was solved."""
    cube = make_cube([10.0, 100.0])
    noise = np.random.default_rng(0).normal(0, 0.001, (2, *cube.rig.picture_shape, 3)).astype(np.float32)
    targets = Targets(np.clip(casting.play(cube, picture_only=True) + noise, 0, 1), cube.rig)
    with_targets = Cube(cube.extinction, cube.grid, cube.rig, targets=as_levels(targets))
    told, exact = score(with_targets)["psnr_mean"], score(cube, targets)["psnr_mean"]
    assert 55 < exact < 75
    assert told == pytest.approx(exact, abs=0.01)
    with pytest.raises(InputError, match="no targets"):
        score(cube)
    with pytest.raises(InputError, match="do not fit"):
        score(cube, targets.take([0]))


def test_mirror_conflicts_are_found_only_where_there_are_any() -> None:
    grid = Grid(SHAPE)
    random = np.random.default_rng(4)
    for elevation_deg, expected in ((0.0, [(0, 2)]), (35.0, [])):
        rig = turntable(grid, [10, 50, 190], elevation_deg=elevation_deg, picture_shape=(3, 5))
        pictures = random.random((3, 3, 5, 3)).astype(np.float32)
        assert mirror_conflicts(Targets(pictures, rig)) == expected
        pictures[2] = pictures[0][:, ::-1]
        assert mirror_conflicts(Targets(pictures, rig)) == []


def test_the_nearest_stop_stands_beside() -> None:
    rig = turntable(Grid(SHAPE), [10.0, 350.0], picture_shape=(3, 5))
    pictures = np.stack([np.full((3, 5, 3), 0.25), np.full((3, 5, 3), 0.75)]).astype(np.float32)
    targets = Targets(pictures, rig)
    shown = np.zeros((3, 3, 5, 3), np.float32)
    beside = np.stack(list(beside_targets(shown, targets, np.array([1.0, 359.0, 181.0]))))
    assert beside.shape == (3, 3, 12, 3)
    assert [float(p[0, -1, 0]) for p in beside] == [0.25, 0.75, 0.75]
    higher = next(iter(beside_targets(np.full((1, 16, 9, 3), 9, np.float32), targets, np.array([1.0]), zoom=2)))
    assert higher.shape == (16, 9 + 2 + 10, 3)
    assert [float(row) for row in higher[:, -1, 0]] == 5 * [0.0] + 6 * [0.25] + 5 * [0.0]


def test_cast_is_lazy() -> None:
    cube = make_cube([10.0, 100.0])
    pictures = cast(cube)
    assert np.array_equal(next(pictures), play(cube)[0])


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_a_picture_that_stands_aside_is_shown_there(elevation_deg: float) -> None:
    """At and around each stop the window is where the stop's picture stands; level, half a turn on, mirrored."""
    grid = Grid((5, 8, 6))
    rig = turntable(grid, [20.0, 110.0], elevation_deg=elevation_deg, picture_shape=(3, 2))
    offsets = np.array([[1, -1], [-1, 0]])
    moved = rig.shifted(offsets)
    extinction = np.random.default_rng(5).random((3, 5, 8, 6)).astype(np.float32)
    cube = Cube(extinction, grid, moved)
    assert np.allclose(play(cube), play(cube, [20.0, 110.0]), atol=1e-6)
    whole = play(cube, [20.3], picture_only=False)[0]
    rows, columns = whole.shape[0] // 2, whole.shape[1] // 2
    window = whole[rows - 1 - 1 : rows + 2 - 1, columns - 1 + 1 : columns + 1 + 1]
    assert np.allclose(play(cube, [20.3])[0], window, atol=1e-6)
    if elevation_deg == 0:
        assert np.allclose(play(cube, [200.0])[0], play(cube, [20.0])[0][:, ::-1], atol=1e-6)


def test_a_rig_of_other_colours_than_the_cube_is_refused_at_once() -> None:
    cube = make_cube([10.0, 100.0], 35.0)
    grey = Cube(cube.extinction[:1], cube.grid, cube.rig)
    coloured = replace(cube.rig, sums=replace(cube.rig.sums, share=np.ones((2, 3))))
    with pytest.raises(InputError, match="a rig of 3 colours does not fit a cube of 1"):
        cast(grey, coloured)
