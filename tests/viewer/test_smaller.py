"""The smaller cube that a page holds: of the same size, for the same pictures."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lightcube import io
from lightcube.backward import solving
from lightcube.backward.recipe import Recipe
from lightcube.errors import InputError
from lightcube.io import read_dyes, save
from lightcube.jobs.reading import load
from lightcube.optics.cube import Cube
from lightcube.optics.glass import Glass
from lightcube.optics.grid import Grid
from lightcube.optics.material import Material
from lightcube.optics.setups import turntable
from lightcube.pictures.fitting import targets_of
from lightcube.pictures.resampling import coarser
from lightcube.pictures.targets import Targets
from lightcube.scoring.metrics import mean_psnr
from lightcube.viewer import smaller as page_cube
from lightcube.viewer.description import describe
from lightcube.viewer.packing import lost, pack
from lightcube.viewer.page import contents
from lightcube.viewer.smaller import in_cubes, shown_coarsely, smaller
from tests.backward.test_stages import known, stage
from tests.cli.test_cli import run
from tests.helpers.recipes import asked
from tests.helpers.wall import play

__all__ = ["run"]


@pytest.fixture(scope="module")
def solved() -> Cube:
    """A cube of 10 x 12 x 12 voxels and two smooth pictures of 6 x 8."""
    grid = Grid((10, 12, 12), 2.0)
    rig = turntable(grid, [20.0, 130.0], elevation_deg=35.0, picture_shape=(6, 8))
    down, across = np.meshgrid(np.linspace(0, 1, 6), np.linspace(0, 1, 8), indexing="ij")
    waves = [0.5 + 0.4 * np.sin(3 * down + 4 * across + phase) for phase in range(6)]
    pictures = np.stack([np.stack(waves[:3], -1), np.stack(waves[3:], -1)]).astype(np.float32)
    return solving.solve(Targets(pictures, rig), grid, Recipe(passes=60)).cube


def test_a_page_has_tall_slices_as_so_many_cubes(solved: Cube) -> None:
    tall = replace(solved, grid=Grid((10, 12, 12), 2.0, 3.0))
    cubes = in_cubes(tall)
    assert cubes.grid == Grid((30, 12, 12), 2.0)
    assert in_cubes(solved) is solved
    np.testing.assert_allclose(play(cubes), play(tall), rtol=2e-5)
    description, _ = contents(tall, "tall")
    assert description["voxels"]["shape"] == description["kept"]["full"] == (30, 12, 12)
    with pytest.raises(InputError, match="whole voxels"):
        contents(replace(solved, grid=Grid((10, 12, 12), 2.0, 1.5)), "odd")


def test_a_cube_that_fits_is_kept(solved: Cube) -> None:
    assert smaller(solved) is solved


def test_the_smaller_cube_shows_the_same_pictures(solved: Cube, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page_cube, "MOST_SIDE", 8)
    small = smaller(solved)
    assert small.grid == Grid((7, 8, 8), 3.0)
    assert small.rig.picture_shape == (4, 6)
    np.testing.assert_allclose(small.angles_deg, solved.angles_deg)
    wanted, _ = coarser(targets_of(solved), solved.grid, 1.5)
    assert small.scores["psnr_mean"] == pytest.approx(mean_psnr(play(small), wanted))
    assert small.scores["psnr_mean"] > 35
    told = describe(solved, pack(small), "two")
    assert told["kept"]["full"] == (10, 12, 12)
    assert told["voxels"]["shape"] == (7, 8, 8)
    assert told["raster"] == (4, 6)
    assert [each["psnr"] for each in told["pictures"]] == [each["psnr"] for each in small.scores["pictures"]]


BOUNDS: dict[str, dict[str, Any]] = {
    "as it comes": {},
    "extinction": {"max_extinction": 0.02},
    "a lamp of power 1": {"lamp_power": 1.0},
    "one lamp": {"powers": "shared", "lamp_max": 3.0},
    "weak lamps": {"lamp_max": 1.5},
    "extinction of a voxel": {"material": Material(0.04, "voxel")},
    "what is clear": {"material": Material(0.5, clear=(0.01, 0.02, 0.03))},
    "dyes": {"material": Material(dyes=read_dyes("pla"))},
    "black": {"black": 0.3},
    "all": {"lamp_power": 2.0, "max_extinction": 0.03, "black": 0.2},
}


@pytest.mark.parametrize("bounds", BOUNDS.values(), ids=BOUNDS.keys())
def test_what_bounded_the_cube_bounds_the_smaller_one(
    solved: Cube, bounds: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    cube = solving.solve(**asked(targets_of(solved), solved.grid, passes=20, **bounds)).cube
    monkeypatch.setattr(page_cube, "MOST_SIDE", 8)
    small = smaller(cube)
    assert small.extinction.max() <= (
        bounds["material"].most(cube.grid) if "material" in bounds else bounds.get("max_extinction", np.inf)
    ) * (1 + 1e-6)
    clear = np.broadcast_to(cube.provenance["clear"], 3).astype(np.float32)
    assert np.all(small.extinction.min(axis=(1, 2, 3)) >= clear)
    least, most = bounds.get("lamp_power", 0), bounds.get("lamp_power", bounds.get("lamp_max", 16))
    assert np.all((least <= small.powers) & (small.powers <= most))
    if bounds.get("powers") == "shared":
        assert np.all(small.powers == small.powers[0])
    assert small.provenance["powers"] == cube.provenance["powers"]
    for name in ("least", "most"):
        np.testing.assert_array_equal(getattr(small.rig.lamps, name), getattr(cube.rig.lamps, name))
    assert small.rig.screens.black == cube.rig.screens.black


def test_what_bounded_a_stages_cube_bounds_the_smaller_one(monkeypatch: pytest.MonkeyPatch) -> None:
    known_cube, wanted = known(stage("two coloured lamps"))
    bounds: dict[str, Any] = {"powers": "shared", "max_extinction": 0.05, "black": 0.1}
    cube = solving.solve(**asked(wanted, known_cube.grid, passes=20, **bounds)).cube
    monkeypatch.setattr(page_cube, "MOST_SIDE", max(cube.grid.shape) - 1)
    small = smaller(cube)
    assert small.extinction.max() <= 0.05 * (1 + 1e-6)
    for bound in ("powers", "max_extinction"):
        assert small.provenance[bound] == cube.provenance[bound], bound
    assert small.rig.screens.black.tolist() == cube.rig.screens.black.tolist() == [0.1] * len(cube.rig.screens.names)


def test_what_it_loses_is_what_its_pixels_show(solved: Cube, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page_cube, "MOST_SIDE", 6)
    small = smaller(solved)
    halves = play(solved).reshape(2, 3, 2, 4, 2, 3).mean(axis=(2, 4))  # 6 x 8 pixels in pairs
    np.testing.assert_allclose(shown_coarsely(solved, small), halves, rtol=1e-5)
    dark = replace(small, extinction=small.extinction + 10)
    assert lost(solved, dark)[0] > 100 > lost(solved, small)[0]


@pytest.mark.parametrize("room", ["two coloured lamps", "aslant and by the inverse square"])
def test_a_stages_cube_gets_smaller_too(room: str, monkeypatch: pytest.MonkeyPatch) -> None:
    cube, _ = known(stage(room))
    monkeypatch.setattr(page_cube, "MOST_SIDE", max(cube.grid.shape) - 1)
    small = smaller(cube)
    ratio = small.grid.voxel_mm / cube.grid.voxel_mm
    for window, fine in zip(small.rig.stops.window, cube.rig.stops.window, strict=True):
        assert np.all(window >= np.ceil(fine / ratio))
        assert np.all(window <= small.rig.picture_shape)
    assert lost(cube, small)[1] < 40


def test_the_command_says_that_it_holds_less(
    run: Any, solved: Cube, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page_cube, "MOST_SIDE", 8)
    monkeypatch.chdir(tmp_path)
    io.save(solved, "cube.npz")
    done = run("view", "cube.npz")
    assert done.code == 0, done.err
    assert "8 x 8 x 7 voxels, solved anew for the pictures of 12 x 12 x 10" in done.err
    assert json.loads(run("view", "cube.npz", "-o", "b.html", "--full", "--json").out)["shape"] == [10, 12, 12]


@pytest.mark.parametrize("glass", [Glass(1.5, bottom="blocked"), Glass((1.4, 1.5, 1.6), "cylinder")])
def test_all_that_is_kept_has_the_glass(glass: Glass, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Files, and a page's smaller cube, which is solved for it."""
    monkeypatch.setattr(page_cube, "MOST_SIDE", 8)
    grid = Grid((10, 12, 12), 2.0)
    rig = turntable(grid, [20.0, 130.0], elevation_deg=20, picture_shape=(4, 6), glass=glass)
    pictures = np.random.default_rng(1).uniform(0.3, 0.7, (2, 4, 6, 3)).astype(np.float32)
    cube = solving.solve(Targets(pictures, rig), grid, Recipe(passes=20)).cube
    for name in ("a.npz", "a.zarr"):
        save(cube, tmp_path / name)
        again = load(tmp_path / name)
        assert again.rig.glass == cube.rig.glass is not None
        np.testing.assert_array_equal(play(again), play(cube))
    small = smaller(cube)
    assert small.grid.shape == (7, 8, 8)
    assert small.rig.glass == cube.rig.glass
    assert small.scores["psnr_mean"] > 25
    assert describe(cube, pack(small), "two")["glass"]["form"] == glass.form
