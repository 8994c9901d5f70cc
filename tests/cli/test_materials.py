"""Cubes of dyes on the command line: solved, told of, and made again."""

import json
from pathlib import Path

import numpy as np
import pytest

from lightcube import load, save
from lightcube.io import read_dyes
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from tests.cli.test_cli import pictures, run

__all__ = ["pictures", "run"]


def solved(run, pictures: Path, out: Path, *more: str) -> str:  # type: ignore[no-untyped-def]
    said = ("--n", "8", "--picture-width", "0.5", "--iterations", "4", *more)
    done = run("solve", pictures, "-o", out, *said)
    assert done.code == 0, done.err
    return f"{done.err}\n{done.out}"


def test_a_cube_of_dyes_is_solved_told_of_and_made_again(run, pictures: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    told = solved(run, pictures, tmp_path / "a.zarr", "--material", "pla", "--size-mm", "20")
    assert "no mixture absorbs alone: green (nearest is magenta" in told
    assert "these filaments are provisional" in told
    assert "% magenta" in told
    cube, dyes = load(tmp_path / "a.zarr"), read_dyes("pla")
    assert cube.dyes == dyes
    assert cube.amounts is not None
    np.testing.assert_array_equal(dyes.mixed(cube.amounts), cube.extinction)
    known = json.loads(run("info", tmp_path / "a.zarr", "--json").out)
    assert known["dyes"] == list(dyes.names)
    assert known["amount_max"] == pytest.approx(cube.amounts.max(axis=(1, 2, 3)).tolist())
    made = run("report", tmp_path / "a.zarr", pictures, "-o", tmp_path / "a.html")
    assert made.code == 0, made.err
    assert "--material pla" in (tmp_path / "a.html").read_text()


def test_a_file_of_ones_own_does_too(run, pictures: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    save(read_dyes("polyjet"), tmp_path / "mine.toml")
    solved(run, pictures, tmp_path / "a.zarr", "--material", str(tmp_path / "mine.toml"))
    assert load(tmp_path / "a.zarr").dyes == read_dyes("polyjet")


def test_what_dyes_cannot_make_of_a_cube_is_told(run, pictures: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    grid = Grid((3, 4, 5), 0.5)
    extinction = read_dyes("polyjet").mixed(np.random.default_rng(0).random((4, 3, 4, 5)))
    extinction[:, 1] = np.array([0, 1, 0])[:, None, None]  # a third of it absorbs green alone
    save(Cube(extinction, grid, turntable(grid, [20.0], picture_shape=(3, 4))), tmp_path / "a.zarr")
    told = " ".join(run("info", tmp_path / "a.zarr", "--material", "polyjet").out.split())
    assert "33.3% of the voxels that are not clear ask for what cyan, magenta, yellow, black cannot make" in told
    assert "most of it where they are to absorb green alone: solve for these dyes by --material" in told
    known = json.loads(run("info", tmp_path / "a.zarr", "--material", "polyjet", "--json").out)
    assert known["out_of_reach_voxels"] == pytest.approx(1 / 3)
    assert 0.01 < known["out_of_reach_extinction"] < 0.1
    solved(run, pictures, tmp_path / "b.zarr", "--size-mm", "20", "--material", "polyjet")
    assert "can make all of it" in run("info", tmp_path / "b.zarr", "--material", "polyjet").out


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (("--material", "polyjets"), "there is no material 'polyjets': give a .toml file, or one of"),
        (("--material", "none.toml"), "there is no none.toml: give a material's .toml file"),
        (("--material", "pla", "--max-extinction", "2"), "--material says how dark it can be"),
    ],
)
def test_what_cannot_be_is_one_sentence(  # type: ignore[no-untyped-def]
    run, pictures: Path, tmp_path: Path, more: tuple[str, ...], said: str
) -> None:
    done = run("solve", pictures, "-o", tmp_path / "a.zarr", "--n", "8", *more)
    assert done.code == 2
    assert said in done.err
    assert not list(tmp_path.glob("a.zarr*"))
