"""What films that are off cast: nothing else where nothing is off, what is known where one thing is."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import lightcube as lc
from lightcube.errors import InputError
from lightcube.optics.attenuator import Films, attenuator
from lightcube.optics.disturbance import DISTURBANCES, FILMS_OFF, SAID, FilmsOff
from lightcube.optics.moves import misplaced
from lightcube.optics.stack import Stack
from lightcube.pictures.fitting import targets_of
from lightcube.scoring.films import absorbance, coverage, disturbed
from lightcube.scoring.metrics import score
from lightcube.scoring.robust import robust
from tests.helpers import films as plain
from tests.helpers.made import some_dyes

NAMES = ["one", "two", "three"]


@pytest.fixture(scope="module")
def cube() -> lc.Cube:
    stage = attenuator(NAMES, Films(4, 8.0, size_mm=32.0, pixels=8), 8 / 5)
    rig, random = stage.rig(), np.random.default_rng(3)
    pictures = random.uniform(0.1, 0.9, (3, *rig.picture_shape, 3)).astype(np.float32)
    return lc.solve(lc.Targets(pictures, rig, names=tuple(NAMES)), stage.grid, lc.Recipe(passes=40)).cube


def stack_of(cube: lc.Cube) -> Stack:
    assert isinstance(cube.grid, Stack)
    return cube.grid


def shown(cube: lc.Cube, seed: int = 0, **off: Any) -> np.ndarray:
    return np.stack(list(disturbed(cube, FilmsOff(**off), seed)))


def test_films_that_are_not_off_cast_what_they_cast(cube: lc.Cube) -> None:
    np.testing.assert_array_equal(shown(cube), np.stack(list(lc.cast(cube))))


def test_ink_of_another_strength_is_another_cube(cube: lc.Cube) -> None:
    weak = replace(cube, extinction=(0.9 * cube.extinction).astype(np.float32))
    np.testing.assert_allclose(shown(cube, ink=-0.1), np.stack(list(lc.cast(weak))), atol=1e-6)


def test_films_of_inks_are_off_as_films_of_the_same_colours_are(cube: lc.Cube) -> None:
    dyes = some_dyes()
    amounts = np.random.default_rng(1).uniform(0, 0.1, cube.extinction.shape).astype(np.float32)
    plainly = replace(cube, extinction=dyes.mixed(amounts))
    inked = replace(plainly, amounts=amounts, dyes=dyes)
    np.testing.assert_array_equal(shown(inked, seed=5, ink_each=0.05), shown(plainly, seed=5, ink_each=0.05))


def test_ghosts_are_light_that_is_spread_evenly(cube: lc.Cube) -> None:
    plainly = shown(cube)
    np.testing.assert_allclose(
        shown(cube, ghosts=0.1), plainly + 0.1 * plainly.mean(axis=(1, 2), keepdims=True), atol=1e-6
    )


def test_films_that_lie_off_are_those_of_a_misplaced_rig_beam_by_beam(cube: lc.Cube) -> None:
    random = np.random.default_rng(7)
    off_mm = random.standard_normal((4, 3)) * (0.4, 0.4, 0.3)
    rig = misplaced(cube.rig, stack_of(cube), off_mm)
    np.testing.assert_allclose(shown(cube, 7, shift_mm=0.4, height_mm=0.3), plain.cast(cube, rig, 40), atol=0.02)
    assert np.abs(shown(cube, 7, shift_mm=0.4, height_mm=0.3) - shown(cube)).max() > 0.05


def test_a_film_that_is_printed_too_large_has_larger_cells(cube: lc.Cube) -> None:
    """All by the same part: as if the cells themselves were larger."""
    places = np.zeros((3, 4, 7))
    places[..., 0] = places[..., 3] = 1 / 1.03
    places[..., 6] = stack_of(cube).heights_mm
    rig = replace(cube.rig, stops=replace(cube.rig.stops, films=places))
    larger = replace(cube, grid=replace(cube.grid, voxel_mm=1.03 * cube.grid.voxel_mm))
    larger = replace(larger, extinction=(cube.extinction / 1.03).astype(np.float32))
    np.testing.assert_allclose(np.stack(list(lc.cast(cube, rig))), np.stack(list(lc.cast(larger))), atol=1e-5)


def test_lamps_that_stand_off_shift_what_is_high(cube: lc.Cube) -> None:
    """A lamp 5 degrees off is that of a room in which it stands there."""
    lamps = cube.rig.views.lamps.copy()
    lamps[:, 0] += np.tan(np.radians(5.0)) * np.abs(lamps[:, 2])
    rig = replace(cube.rig, views=replace(cube.rig.views, lamps=lamps))
    np.testing.assert_allclose(shown(cube, lamp_deg=5.0), np.stack(list(lc.cast(cube, rig))), atol=1e-6)


def test_the_suns_disc_is_many_lamps(cube: lc.Cube) -> None:
    """Its mean is between those of lamps at its rim, and blurs what is far from the screen."""
    blurred, sharp = shown(cube, disc_deg=8.0), shown(cube)
    assert 0.005 < np.abs(blurred - sharp).mean() < 0.2
    np.testing.assert_allclose(blurred.mean(), sharp.mean(), rtol=0.1)


def test_coverage_and_absorbance_are_inverse_and_dots_let_light_through_beside_them() -> None:
    solid = 2.0
    covered = np.linspace(0, 1, 11)
    np.testing.assert_allclose(coverage(absorbance(covered, solid), solid), covered, atol=1e-12)
    np.testing.assert_allclose(np.exp(-absorbance(covered, solid)), 1 - covered * (1 - np.exp(-solid)))
    assert absorbance(np.array([0.5]), solid)[0] < 0.5 * solid


def test_dot_gain_makes_films_darker_and_levels_hardly_change_them(cube: lc.Cube) -> None:
    assert np.all(shown(cube, gain=0.1) <= shown(cube) + 1e-6)
    assert shown(cube, gain=0.1).mean() < 0.9 * shown(cube).mean()
    assert np.abs(shown(cube, levels=255) - shown(cube)).max() < 0.02
    assert np.abs(shown(cube, levels=7) - shown(cube)).max() > 0.02


def test_what_is_told_is_worse_than_what_was_made_and_better_relit(cube: lc.Cube) -> None:
    """Asked of the function that is for cubes: of films it tells what films suffer."""
    told: list[tuple[int, int]] = []
    found = robust(cube, targets_of(cube), callback=lambda done, of: told.append((done, of)))
    assert set(found) == set(FILMS_OFF) <= set(SAID)
    assert told[-1][0] == told[-1][1] == len(told)
    made = found.pop("undisturbed")
    assert made["psnr_mean"] == pytest.approx(score(cube)["psnr_mean"], abs=1e-3)
    for name, left in found.items():
        assert left["psnr_min"] <= left["psnr_mean"] < made["psnr_mean"], name
        assert left["relit_mean"] >= left["psnr_mean"] - 1e-9, name
    assert found["shifted-more"]["psnr_mean"] < found["shifted"]["psnr_mean"]
    assert found["ink"]["relit_mean"] > found["ink"]["psnr_mean"] + 1


@pytest.mark.parametrize(
    "wrong", [{"shift_mm": -1}, {"ink": -1}, {"ghosts": np.nan}, {"gain": 1e308}, {"disc_deg": 90}]
)
def test_films_that_cannot_be_so_off_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="no films are off by"):
        FilmsOff(**wrong)


def test_every_disturbance_says_what_it_is() -> None:
    assert len(set(SAID.values())) == len(SAID)
    assert SAID["together"] != SAID["undisturbed"] == "as made"
    assert set(DISTURBANCES) & set(FILMS_OFF) == {"undisturbed"}
