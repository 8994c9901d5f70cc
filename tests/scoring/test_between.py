"""Between the pictures and around them: the curve, its lobes, and what a set-up that is off costs."""

import builtins
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from lightcube import io
from lightcube.drawing import plots
from lightcube.errors import InputError
from lightcube.forward.casting import cast
from lightcube.forward.turning import moment
from lightcube.jobs.reading import load
from lightcube.optics.cube import Cube
from lightcube.optics.disturbance import DISTURBANCES, Disturbance
from lightcube.optics.grid import Grid
from lightcube.optics.haze import Phase, veil_part
from lightcube.optics.setups import soft, turntable
from lightcube.optics.transfer import encode
from lightcube.pictures.fitting import as_levels
from lightcube.pictures.targets import Targets
from lightcube.report.measuring import measure
from lightcube.scoring.between import curve
from lightcube.scoring.metrics import psnr, score, ssim
from lightcube.scoring.robust import disturbances, disturbed, robust
from tests.cli.test_cli import run
from tests.helpers.wall import play

SHAPE = (3, 5, 7)
__all__ = ["run"]


def make_cube(angles_deg: list[float], elevation_deg: float = 0.0, strength: float = 1.0) -> Cube:
    random = np.random.default_rng(0)
    extinction = (strength * random.random((3, *SHAPE))).astype(np.float32)
    grid = Grid(SHAPE, 0.5)
    rig = turntable(grid, angles_deg, elevation_deg=elevation_deg, picture_shape=(3, 5))
    return Cube(extinction, grid, rig, lamp_powers=random.uniform(0.5, 4.0, (len(rig), 3)))


def cast_targets(cube: Cube, noise: float = 0.0) -> Targets:
    """What the cube casts, a little off, with weights."""
    random = np.random.default_rng(1)
    shown = play(cube)
    shown = (shown * random.uniform(1 - noise, 1 + noise, shown.shape)).astype(np.float32)
    return Targets(shown, cube.rig, random.integers(1, 4, shown.shape[:3]).astype(np.float32))


def white(cube: Cube) -> Targets:
    return Targets(np.ones((len(cube.rig), *cube.rig.picture_shape, 3), np.float32), cube.rig)


def empty(angles_deg: list[float], elevation_deg: float = 0.0) -> Cube:
    return replace(make_cube(angles_deg, elevation_deg, 0.0), lamp_powers=None)


def decibels(shown: np.ndarray, targets: Targets, view: int) -> float:
    return psnr(encode(shown), encode(targets.pictures[view]), targets.weight[view])


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_at_the_stops_the_curve_is_the_score(elevation_deg: float) -> None:
    cube = make_cube([200.0, 10.0, 100.0], elevation_deg)
    targets = cast_targets(cube, 0.1)
    found, scores = curve(cube, targets), score(cube, targets)
    at_stops = found.offsets_deg == 0
    assert sorted(found.nearest[at_stops]) == [0, 1, 2]
    for view, quality, likeness in zip(
        found.nearest[at_stops], found.psnr[at_stops], found.ssim[at_stops], strict=True
    ):
        assert quality == pytest.approx(scores["pictures"][view]["psnr"], rel=1e-5)
        assert likeness == pytest.approx(scores["pictures"][view]["ssim"], rel=1e-5)
    assert np.allclose(found.angles_deg[at_stops] % 180, cube.angles_deg[found.nearest[at_stops]] % 180)


def test_between_the_stops_it_is_what_is_played_against_the_nearer_picture() -> None:
    angles_deg = [20.0, 75.0, 250.0]
    cube = make_cube(angles_deg, 35.0)
    targets = cast_targets(cube, 0.1)
    found = curve(cube, targets)
    for index in range(0, len(found.angles_deg), 5):
        shown = play(cube, [found.angles_deg[index]])[0]
        view = found.nearest[index]
        pair = encode(shown), encode(targets.pictures[view]), targets.weight[view]
        assert found.psnr[index] == pytest.approx(psnr(*pair), rel=1e-4)
        assert found.ssim[index] == pytest.approx(ssim(*pair), rel=1e-3)
    apart = np.abs((np.array(angles_deg)[:, None] - found.angles_deg + 180) % 360 - 180)
    assert np.allclose(apart[found.nearest, np.arange(len(found.angles_deg))], apart.min(axis=0))
    assert np.allclose(apart.min(axis=0), np.abs(found.offsets_deg))


@pytest.mark.parametrize("steps", [1, 2, 7, 8])
def test_it_has_so_many_even_steps_from_stop_to_stop(steps: int) -> None:
    stops = np.array([20.0, 75.0, 250.0])
    cube = empty(list(stops), 35.0)
    angles_deg = curve(cube, white(cube), steps).angles_deg
    assert np.all(np.diff(angles_deg) >= 0)
    assert angles_deg[-1] - angles_deg[0] == pytest.approx(360)
    for start, gap in zip(stops, np.diff(stops, append=380.0), strict=True):
        for wanted in start + gap * np.arange(steps) / steps:
            assert np.min(np.abs((angles_deg - wanted + 180) % 360 - 180)) < 1e-9


def test_lobes_of_an_empty_cube_and_white_pictures_are_the_whole_spacing() -> None:
    raised, level = empty([20.0, 75.0, 250.0], 35.0), empty([160.0, 10.0, 50.0])
    assert curve(raised, white(raised)).lobes_deg == pytest.approx([92.5, 115.0, 152.5])
    assert curve(level, white(level)).lobes_deg == pytest.approx([70.0, 35.0, 75.0])
    alone = empty([20.0])
    found = curve(alone, white(alone))
    assert (found.lobes_deg.tolist(), found.period_deg) == ([180.0], 180.0)
    assert np.all(found.psnr == 100)
    black = replace(white(level), pictures=np.zeros((3, 3, 5, 3), np.float32))
    assert curve(level, black).lobes_deg.tolist() == [0, 0, 0]


def test_a_lobe_ends_where_the_picture_falls_below_30_db() -> None:
    cube = make_cube([20.0, 75.0, 250.0], 35.0, strength=3.0)
    targets = cast_targets(cube)
    found = curve(cube, targets)
    assert np.all((found.lobes_deg > 0.2) & (found.lobes_deg < 50))
    for view, stop in enumerate(cube.rig.views.angles_deg):
        plain = 0.0
        for side in (-1, 1):
            distance = 0.0
            for step in (0.2, 0.02):
                while decibels(play(cube, [stop + side * (distance + step)])[0], targets, view) >= 30:
                    distance += step
            plain += distance + 0.01
        assert found.lobes_deg[view] == pytest.approx(plain, abs=0.05)


def test_with_a_level_lamp_half_a_turn_is_the_mirror_image() -> None:
    cube = make_cube([10.0, 70.0, 140.0])
    targets = cast_targets(cube, 0.1)
    found = curve(cube, targets)
    assert found.period_deg == 180
    pictures, weights = targets.pictures.copy(), targets.weight.copy()
    pictures[0], weights[0] = pictures[0, :, ::-1], weights[0, :, ::-1]
    rig = turntable(cube.grid, [190.0, 70.0, 140.0], picture_shape=(3, 5))
    mirrored = curve(replace(cube, rig=rig), Targets(pictures, rig, weights))
    assert np.array_equal(mirrored.nearest, found.nearest)
    assert mirrored.psnr == pytest.approx(found.psnr, rel=1e-4)
    assert mirrored.lobes_deg == pytest.approx(found.lobes_deg, abs=1e-3)
    # The wrap: past the last stop the first one comes again, mirrored, and so does its lamp.
    last = int(np.flatnonzero(found.offsets_deg == 0)[-1])
    sample = last + int(np.argmin(np.abs(found.angles_deg[last:] - 150)))
    shown = play(cube, [found.angles_deg[sample]])[0]
    assert found.psnr[sample] == pytest.approx(decibels(shown, targets, 2), rel=1e-4)
    before = int(np.flatnonzero(found.offsets_deg < 0)[0])
    shown = play(cube, [found.angles_deg[before] + 180])[0][:, ::-1]
    assert found.psnr[before] == pytest.approx(decibels(shown, targets, 0), rel=1e-4)


def test_stops_half_a_turn_apart_take_the_whole_turn() -> None:
    cube = make_cube([10.0, 100.0, 190.0])
    assert curve(cube, cast_targets(cube, 0.1)).period_deg == 360


@settings(max_examples=15)
@given(
    st.lists(st.integers(0, 35999), min_size=1, max_size=4, unique_by=lambda a: a % 36000),
    st.sampled_from([0.0, -20.0]),
    st.integers(1, 5),
)
def test_any_stops_make_a_curve_of_one_period(hundredths: list[int], elevation_deg: float, steps: int) -> None:
    cube = make_cube([a / 100 for a in hundredths], elevation_deg)
    found = curve(cube, cast_targets(cube), steps)
    assert np.all(np.diff(found.angles_deg) > -1e-9)
    assert found.angles_deg[-1] - found.angles_deg[0] == pytest.approx(found.period_deg)
    assert np.all(found.lobes_deg > 0)
    assert np.all(np.isfinite(found.psnr))
    assert found.lobes_deg.sum() <= found.period_deg + 1e-9


@pytest.mark.parametrize("tall", [1.0, 2.0])
def test_a_cube_that_is_off_by_voxels_is_so_by_fewer_pixels(tall: float) -> None:
    """Two voxels aside are a pixel of 2 x 2; up, so are two slices, or one that is twice as tall."""
    cube = make_cube([20.0, 75.0, 250.0], 35.0)
    grid = Grid(cube.grid.shape, cube.grid.voxel_mm, tall)
    cube = replace(cube, grid=grid, rig=turntable(grid, cube.angles_deg, elevation_deg=35.0, pixel=2))
    shown = play(cube)
    right = np.stack(list(disturbed(cube, Disturbance(right_voxels=2.0))))
    up = np.stack(list(disturbed(cube, Disturbance(up_voxels=2 / tall))))
    assert np.allclose(right[:, :, 1:], shown[:, :, :-1], rtol=1e-4)
    assert np.allclose(up[:, :-1], shown[:, 1:], rtol=1e-4)


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_each_disturbance_is_what_it_says(elevation_deg: float) -> None:
    cube = make_cube([20.0, 75.0, 250.0], elevation_deg)
    shown = play(cube)

    def off(**how: Any) -> np.ndarray:
        return np.stack(list(disturbed(cube, Disturbance(**how))))

    assert np.array_equal(off(), shown)
    assert np.allclose(off(lamp=0.02), shown * 1.02, rtol=1e-5)
    assert np.allclose(off(black=0.01), shown + 0.01, rtol=1e-5)
    # By a whole voxel the picture moves by a whole pixel: to the right, and up.
    assert np.allclose(off(right_voxels=1.0)[:, :, 1:], shown[:, :, :-1], rtol=1e-5)
    assert np.allclose(off(up_voxels=1.0)[:, :-1], shown[:, 1:], rtol=1e-5)
    now, powers = moment(cube, cube.angles_deg + 0.2)
    further = np.stack(list(cast(cube, now, powers))) / powers[:, None, None]
    assert np.allclose(off(turn_deg=0.2), further * cube.powers[:, None, None], rtol=1e-4)
    assert np.array_equal(off(turn_of_64_deg=0.2), off(turn_deg=0.2 * 64 / 7))
    rig = turntable(cube.grid, cube.angles_deg, elevation_deg=elevation_deg, picture_shape=(3, 5), lamp_deg=3.0)
    assert np.allclose(off(disc_deg=3.0), play(replace(cube, rig=rig)), rtol=1e-5)
    assert not np.allclose(off(disc_deg=3.0), shown, rtol=1e-2)


def test_a_lamp_gets_a_size_only_on_a_turntable_where_it_has_none() -> None:
    cube = make_cube([20.0, 75.0, 250.0], 35.0)
    far, bent = {"far", "near"}, {"index", "index-more"}
    assert list(disturbances(cube)) == [name for name in DISTURBANCES if name not in far | bent]
    blurred = replace(cube, rig=soft(cube.rig, cube.grid, 1.0))
    assert list(disturbances(blurred)) == [name for name in DISTURBANCES if name not in bent | {"disc"}]
    for other in (
        replace(cube, rig=replace(cube.rig, screens=replace(cube.rig.screens, endless=np.array([False])))),
        make_cube([20.0, 75.0, 250.0], 89.9),
    ):
        assert list(disturbances(other)) == [name for name in DISTURBANCES if name not in far | bent | {"disc"}]
        assert "disc" not in robust(other, cast_targets(other))


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_screens_of_lamps_with_a_disc_stand_further_away(elevation_deg: float) -> None:
    """Along the light: a raised one goes less far behind the cube on the same way."""
    cube, far = make_cube([20.0, 75.0, 250.0], elevation_deg), Disturbance(further=0.5)
    assert all(np.array_equal(*pair) for pair in zip(disturbed(cube, far), cast(cube), strict=True))
    blurred = replace(cube, rig=soft(cube.rig, cube.grid, 9.0, 2.0))
    moved = 0.5 * cube.grid.size_mm[1] * np.cos(np.radians(elevation_deg))
    expected = cast(replace(cube, rig=soft(cube.rig, cube.grid, 9.0, 2.0 + moved)))
    for shown, wanted, before in zip(disturbed(blurred, far), expected, cast(blurred), strict=True):
        np.testing.assert_allclose(shown, wanted, rtol=1e-4)
        assert not np.allclose(shown, before, rtol=1e-2)


def test_the_shadow_of_a_near_lamp_grows_with_the_screens_distance() -> None:
    cube = make_cube([20.0], 0.0)
    way = cube.rig.views.lamps[0, :3]
    views = replace(cube.rig.views, lamps=np.append(-40 * way, 1.0)[None], origins_mm=20 * way[None])
    rig = replace(cube.rig, views=views)
    near = replace(cube, rig=rig)
    assert {"far", "near"} <= set(disturbances(near))
    width = cube.grid.size_mm[1]
    (shown,) = disturbed(near, Disturbance(further=60 / width))  # twice as far from the lamp
    steps = {name: getattr(rig.views, name) / 2 for name in ("column_steps_mm", "row_steps_mm")}
    (expected,) = cast(replace(near, rig=replace(rig, views=replace(rig.views, **steps))))
    np.testing.assert_allclose(shown, expected, rtol=1e-4)


def test_extinction_is_rounded_to_so_many_levels_of_each_colour() -> None:
    cube = make_cube([20.0, 75.0])
    extinction = cube.extinction.copy()
    extinction[1] = 0
    extinction[2] *= 7
    coarse = extinction.copy()
    for colour in (0, 2):
        most = float(extinction[colour].max())
        coarse[colour] = np.round(extinction[colour] / most * 255) / 255 * most
    expected = play(replace(cube, extinction=coarse))
    found = np.stack(list(disturbed(replace(cube, extinction=extinction), Disturbance(levels=255))))
    assert np.allclose(found, expected, rtol=1e-5)
    assert not np.allclose(found, play(replace(cube, extinction=extinction)), rtol=1e-5)
    again = np.stack(list(disturbed(replace(cube, extinction=coarse), Disturbance(levels=255))))
    assert np.allclose(again, expected, rtol=1e-5)


def test_robust_scores_every_disturbance() -> None:
    cube = make_cube([20.0, 75.0, 250.0], 35.0)
    targets = cast_targets(cube, 0.02)
    figures = robust(cube, targets)
    assert list(figures) == list(disturbances(cube))
    scores = score(cube, targets)
    assert figures["undisturbed"]["psnr_mean"] == pytest.approx(scores["psnr_mean"], rel=1e-5)
    assert figures["undisturbed"]["psnr_min"] == pytest.approx(scores["psnr_min"], rel=1e-5)
    stronger = score(replace(cube, lamp_powers=cube.powers * 1.02), targets)
    assert figures["lamp"]["psnr_mean"] == pytest.approx(stronger["psnr_mean"], rel=1e-5)
    assert figures["lamp"]["psnr_min"] == pytest.approx(stronger["psnr_min"], rel=1e-5)
    lighter = [decibels(picture + 0.01, targets, view) for view, picture in enumerate(play(cube))]
    assert figures["black"] == pytest.approx({"psnr_mean": np.mean(lighter), "psnr_min": min(lighter)}, rel=1e-4)
    assert figures["all"]["psnr_mean"] < min(each["psnr_mean"] for name, each in figures.items() if name != "all")


@pytest.mark.parametrize("phase", ["isotropic", "forward"])
def test_haze_is_a_loss_that_is_made_good_and_an_even_veil(phase: Phase) -> None:
    cube = make_cube([20.0, 75.0, 250.0], 35.0)
    found = np.stack(list(disturbed(cube, Disturbance(haze=0.4, phase=phase))))
    clear = play(cube, picture_only=True)
    np.testing.assert_allclose(found.mean(axis=(1, 2)), clear.mean(axis=(1, 2)), rtol=1e-5)  # lamps are turned up
    loss = np.float32(0.4 / max(cube.grid.size_mm))
    straight = play(replace(cube, extinction=cube.extinction + loss), picture_only=True)
    part = veil_part(0.4, phase)
    gain = (1 - part) * clear.mean(axis=(1, 2), keepdims=True) / straight.mean(axis=(1, 2), keepdims=True)
    veil = found - gain * straight
    np.testing.assert_allclose(veil, np.broadcast_to(veil.mean(axis=(1, 2), keepdims=True), veil.shape), rtol=1e-3)
    np.testing.assert_allclose(veil.mean(axis=(1, 2)), part * clear.mean(axis=(1, 2)), rtol=1e-3)


def test_more_haze_costs_more_and_most_where_it_throws_light_ahead() -> None:
    cube = make_cube([20.0, 75.0, 250.0], 35.0)
    figures = robust(cube, cast_targets(cube))
    thin, thick, ahead, thick_ahead = (
        figures[name]["psnr_mean"] for name in ("haze", "haze-more", "haze-ahead", "haze-ahead-more")
    )
    assert figures["undisturbed"]["psnr_mean"] > thin > max(thick, ahead)
    assert min(thick, ahead) > thick_ahead
    assert str(DISTURBANCES["haze-more"]) == "haze that throws 33 % to all sides along the cube (an estimate)"
    assert str(DISTURBANCES["haze-ahead"]) == "haze that throws 10 % ahead along the cube (an estimate)"


def marks(work: Callable[[Callable[[int, int], None]], object]) -> list[tuple[int, int]]:
    """What a long work says of its progress."""
    said: list[tuple[int, int]] = []
    work(lambda done, of: said.append((done, of)))
    return said


def test_progress_counts_every_picture_to_the_end() -> None:
    cube = make_cube([20.0, 75.0, 250.0], 35.0)
    targets = cast_targets(cube, 0.02)
    samples = len(curve(cube, targets).angles_deg)
    pictures = 3 * len(disturbances(cube))
    for said, last in (
        (marks(lambda tell: curve(cube, targets, callback=tell)), samples),
        (marks(lambda tell: robust(cube, targets, callback=tell)), pictures),
        (marks(lambda tell: measure(cube, targets, callback=tell)), samples + pictures + 3),
    ):
        assert said[-1] == (last, last)
        done, of = np.array(said).T
        assert np.all(np.diff(done) > 0)
        assert np.all(np.diff(of) >= 0)
        assert np.all(done <= of)
        assert len(said) > 0.8 * last


@pytest.mark.parametrize(
    ("field", "sizes"),
    [
        ("turn_deg", [0.05, 0.1, 0.2, 0.4]),
        ("right_voxels", [0.05, 0.1, 0.25, 0.5]),
        ("up_voxels", [0.05, 0.1, 0.25, 0.5]),
        ("lamp", [0.01, 0.02, 0.05, 0.2]),
        ("turn_of_64_deg", [0.01, 0.02, 0.04]),
        ("disc_deg", [1.0, 3.0, 9.0]),
        ("levels", [4000, 250, 16, 3]),
        ("black", [0.003, 0.01, 0.03, 0.1]),
    ],
)
def test_more_disturbance_costs_more(field: str, sizes: list[float]) -> None:
    cube = make_cube([20.0, 75.0], 35.0)
    targets = cast_targets(cube)
    means = []
    for size in sizes:
        how: dict[str, Any] = {field: size}
        shown = disturbed(cube, Disturbance(**how))
        means.append(np.mean([decibels(picture, targets, view) for view, picture in enumerate(shown)]))
    assert np.all(np.diff(means) < -0.5), means


def test_a_disturbance_says_what_it_is() -> None:
    assert str(Disturbance()) == "as made"
    assert str(DISTURBANCES["turned"]) == "turned 0.2°"
    assert str(DISTURBANCES["turned-as-64"]) == "turned 0.2° · 64 / n"
    assert str(DISTURBANCES["disc"]) == "lamp of 0.5°, screen a cube's width behind (as made, behind glass)"
    assert str(DISTURBANCES["lamp"]) == "lamp +2 %"
    assert str(DISTURBANCES["far"]) == "screen 5 % of the cube's width too far"
    assert str(DISTURBANCES["near"]) == "screen 5 % of the cube's width too near"
    assert str(DISTURBANCES["all"]).count(", ") == 5


def test_bad_input_is_a_sentence() -> None:
    cube = make_cube([20.0, 75.0], 35.0)
    targets = cast_targets(cube)
    with pytest.raises(InputError, match="at least 1 step"):
        curve(cube, targets, 0)
    with pytest.raises(InputError, match="do not fit the cube"):
        curve(cube, targets.take([0]))
    with pytest.raises(InputError, match="do not fit the cube"):
        robust(cube, targets.take([0]))
    off: list[dict[str, Any]] = [{"lamp": -1.0}, {"black": -0.1}, {"levels": -1}, {"turn_deg": np.nan}]
    for bad in (*off, {"up_voxels": np.inf}):
        with pytest.raises(InputError, match="finite numbers"):
            Disturbance(**bad)


def test_the_plot_shows_every_sample_and_marks_the_stops() -> None:
    cube = make_cube([20.0, 75.0, 250.0], 35.0)
    found = curve(cube, cast_targets(cube))
    figure = plots.between_plot({"one": found, "another": found})
    assert [axes.get_title() for axes in figure.axes] == ["one", "another"]
    lines = figure.axes[0].get_lines()
    stops = next(line for line in lines if line.get_marker() == "o")
    assert np.asarray(stops.get_xdata()).tolist() == [20.0, 75.0, 250.0]
    drawn = np.concatenate([np.asarray(line.get_xdata()) for line in lines if line.get_marker() == "None"])
    assert set(found.angles_deg) <= set(drawn)


def test_the_same_plot_is_the_same_file(tmp_path: Path) -> None:
    cube = make_cube([20.0, 75.0], 35.0)
    found = {"": curve(cube, cast_targets(cube))}
    for suffix in (".svg", ".png"):
        first, second = tmp_path / f"a{suffix}", tmp_path / f"b{suffix}"
        for path in (first, second):
            assert io.save(plots.between_plot(found), path) == path
        assert first.read_bytes() == second.read_bytes()
    assert (tmp_path / "a.svg").read_text().startswith("<?xml")
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.size == (900, 320)


@pytest.fixture
def solved(tmp_path: Path) -> Path:
    """A cube with the pictures that it casts."""
    grid = Grid((4, 5, 6), 2.0)
    extinction = np.random.default_rng(0).uniform(0, 0.1, (3, 4, 5, 6)).astype(np.float32)
    cube = Cube(extinction, grid, turntable(grid, [10.0, 100.0], picture_shape=(4, 5)))
    path = tmp_path / "solved.npz"
    io.save(replace(cube, targets=as_levels(Targets(play(cube), cube.rig))), path)
    return path


def test_score_adds_what_is_asked_for(run, solved: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    scores = json.loads(run("score", solved, "--json", "--between", "--robust").out)
    found = scores["between"]
    assert list(found) == ["angles_deg", "nearest", "psnr", "ssim", "lobe_deg"]
    assert len(found["angles_deg"]) == len(found["nearest"]) == len(found["psnr"]) == len(found["ssim"]) >= 16
    assert len(found["lobe_deg"]) == 2
    possible = disturbances(load(solved))
    assert set(scores["robust"]) == set(possible)
    assert scores["robust"]["undisturbed"]["psnr_mean"] == pytest.approx(scores["psnr_mean"], rel=1e-6)
    told = run("score", solved, "--robust", "--plot", tmp_path / "a.svg").out
    assert (tmp_path / "a.svg").exists()
    assert f"{found['lobe_deg'][0]:.2f}°" in told
    assert all(str(each) in told for each in possible.values())
    plain = run("score", solved).out
    assert "30 dB over" not in plain
    assert "between" not in json.loads(run("score", solved, "--json").out)


def test_score_replaces_plot_and_sheet_only_when_asked(run, solved: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    plot, sheet = tmp_path / "a.png", tmp_path / "b.png"
    for path in (plot, sheet):
        path.write_text("mine")
    for option, path in (("--plot", plot), ("--sheet", sheet)):
        assert run("score", solved, option, path).code == 2
        assert path.read_text() == "mine"
        assert run("score", solved, option, path, "--overwrite").code == 0
        with Image.open(path) as picture:
            assert picture.size[0] > 100
    done = run("score", solved, "--plot", tmp_path / "a.pdf")
    assert done.code == 2
    assert done.lines[-1].startswith("lightcube: ")


def test_without_matplotlib_a_sentence_says_what_to_install(  # type: ignore[no-untyped-def]
    run, solved: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name.startswith("matplotlib"):
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    done = run("score", solved, "--plot", tmp_path / "a.png", "--sheet", tmp_path / "b.png")
    assert done.code == 2
    assert "pip install 'lightcube[plot]'" in done.err
    assert sorted(tmp_path.iterdir()) == [solved]
    assert run("score", solved, "--between").code == 0
