"""Files of materials: those that ship, there and back, and what is wrong in them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lightcube.errors import InputError
from lightcube.io import material_names, read_cube, read_dyes, save
from lightcube.io.materials import as_toml, read_material
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable

FILM = """calibration = "measured"
kind = "ink"
date = 2026-11-28
[ink.cyan]
density = [1.5, 0.5, 0.25]
[ink.magenta]
density = [0.25, 1.5, 0.75]
"""


@pytest.mark.parametrize("name", material_names())
def test_what_ships_says_that_nobody_measured_it_and_comes_back(name: str, tmp_path: Path) -> None:
    dyes = read_dyes(name)
    assert dyes.calibration == "provisional"
    save(dyes, tmp_path / "a.toml")
    again = read_dyes(tmp_path / "a.toml")
    for field in ("extinction", "base", "limit"):
        np.testing.assert_allclose(getattr(again, field), getattr(dyes, field), rtol=1e-5)
    assert (again.names, again.kind, again.label.tolist()) == (dyes.names, dyes.kind, dyes.label.tolist())


def test_every_key_of_a_file_comes_back(tmp_path: Path) -> None:
    curve = np.array([[0, 0], [0.5, 0.625], [1, 1]])
    said: dict[str, Any] = {
        "limit": np.array([0.75, 1]),
        "scattering": np.array([0.5, 0]),
        "base": np.array([1.0, 0.5, 0.25]),
    }
    dyes = read_dyes("polyjet")
    two = type(dyes)(('a "b" \\', "é"), dyes.extinction[:2], gain=(curve, None), calibration="guess", **said)
    file = tmp_path / "a.toml"
    file.write_text(as_toml(two), encoding="utf-8")
    assert read_dyes(file) == two


def test_when_and_how_it_was_measured_is_told(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text(f'instrument = "a lamp"\n{FILM}')
    assert read_material(tmp_path / "a.toml").measured == {"date": "2026-11-28", "instrument": "a lamp"}
    assert read_material("pla").measured == {}


def test_densities_are_of_films_and_to_the_base_of_10(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text(FILM)
    np.testing.assert_allclose(10 ** -np.array([1.5, 0.5, 0.25]), np.exp(-read_dyes(tmp_path / "a.toml").extinction[0]))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("1.5, 0.5, 0.25", "0, 0, 0", "dye 'cyan' absorbs nothing"),
        ("1.5, 0.5, 0.25", "-1, 0, 0", "ink.cyan.density"),
        ("1.5, 0.5, 0.25", "nan, 0, 0", "ink.cyan.density"),
        ("1.5, 0.5, 0.25", "1, 2", "ink.cyan.density"),
        ("1.5, 0.5, 0.25", "0.25, 1.5, 0.75", "absorb all colours alike"),
        ('"ink"', '"resin"', "needs extinction, as its material is a kind of resin"),
        ('"ink"', '"toner"', "kind"),
        ('"measured"', '"sure"', "calibration"),
        ("density = [1.5", "extinction = [1.0, 2.0, 3.0]\ndensity = [1.5", "say either density"),
        ("[ink.cyan]", "[ink.cyan]\nopacity = 1", "ink.cyan.opacity"),
        ("[ink.cyan]", "[ink.cyan]\nlimit = 0", "the limit of a dye"),
        ("[ink.cyan]", "[ink.cyan]\ndot_gain = [[0, 0], [0.5, 0.4], [0.6, 0.3], [1, 1]]", "the dot gain of 'cyan'"),
    ],
)
def test_what_is_wrong_in_a_file_is_one_sentence_that_names_it(tmp_path: Path, old: str, new: str, said: str) -> None:
    file = tmp_path / "inkjet.toml"
    assert FILM.count(old) == 1
    file.write_text(FILM.replace(old, new))
    with pytest.raises(InputError, match=said) as refused:
        read_dyes(file)
    assert "inkjet.toml: " in str(refused.value)
    assert "\n" not in str(refused.value)


def test_names_that_are_none_are_told_with_those_that_are(tmp_path: Path) -> None:
    for name in ("polyjets", tmp_path / "none.toml"):
        with pytest.raises(InputError, match=r"one of cmy-film, cmyk-film, pla, polyjet"):
            read_dyes(name)


@pytest.mark.parametrize("suffix", [".zarr", ".zarr.zip", ".npz"])
def test_a_cube_keeps_amounts_and_dyes_to_the_last_bit(tmp_path: Path, suffix: str) -> None:
    grid = Grid((2, 3, 5), 0.5)
    rig = turntable(grid, [20, 70], picture_shape=(2, 3))
    for name in ("polyjet", "cmy-film"):
        dyes = read_dyes(name)
        amounts = np.random.default_rng(2).random((len(dyes.names), 2, 3, 5), np.float32)
        cube = Cube(dyes.in_block(grid).mixed(amounts), grid, rig, amounts=amounts, dyes=dyes)
        save(cube, tmp_path / f"{name}{suffix}")
        again = read_cube(tmp_path / f"{name}{suffix}")
        np.testing.assert_array_equal(again.amounts, amounts)
        np.testing.assert_array_equal(again.extinction, cube.extinction)
        assert again.dyes == dyes
