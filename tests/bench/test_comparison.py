"""The comparison of results: all get the same pictures the same way up, and the same method comes to the same block."""

import sys
from functools import partial
from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import lightcube as lc

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
NEEDS_ASTRA = "ASTRA is an optional oracle: lightcube[oracle]"


@pytest.fixture
def comparison(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(BENCHMARKS)
    monkeypatch.setattr("lightcube.threads", lambda _: None)
    for name in ("peers", "comparison"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    return import_module("comparison")


def of_light(comparison: ModuleType, pictures: np.ndarray, views: int) -> object:
    """A block of so many voxels as pictures are wide, and these pictures."""
    n = pictures.shape[2]
    grid = lc.Grid((n, n, n))
    rig = lc.turntable(grid, lc.spread_angles(views), picture_shape=(n, n), power=1.0)
    return comparison.Problem("some", lc.Targets(pictures.astype(np.float32), rig), grid)


@pytest.fixture
def uneven(comparison: ModuleType) -> object:
    """Pictures without any symmetry."""
    return of_light(comparison, np.random.default_rng(1).uniform(0.2, 1.0, (3, 9, 9, 3)), 3)


def test_slice_by_slice_and_all_at_once_come_to_the_same_block(comparison: ModuleType, uneven: object) -> None:
    one = comparison.slice_by_slice(uneven, partial(comparison.peers.by_lightcube, method="sirt"), 12)
    all_at_once = comparison.by_lightcube(uneven, "sirt", 12)
    np.testing.assert_allclose(one.extinction, all_at_once.extinction, atol=1e-4)
    assert one.extinction.std() > 0.01


def test_tomosipos_sirt_by_astras_projector_is_astras(comparison: ModuleType, uneven: object) -> None:
    pytest.importorskip("astra", reason=NEEDS_ASTRA)
    theirs = partial(comparison.peers.by_astra, method="SIRT", MinConstraint=0.0)
    one, other = (comparison.slice_by_slice(uneven, run, 30) for run in (comparison.by_tomosipo, theirs))
    np.testing.assert_allclose(one.extinction, other.extinction, atol=1e-3)
    assert one.extinction.std() > 0.01


def test_light_comes_within_the_thresholds_where_a_block_can_cast_it(comparison: ModuleType) -> None:
    grid = lc.Grid((7, 7, 7))
    rig = lc.turntable(grid, lc.spread_angles(5), picture_shape=(7, 7), power=1.0)
    volume = np.random.default_rng(2).uniform(0, 0.2, (3, 7, 7, 7)).astype(np.float32)
    light = lc.play(lc.Cube(volume, grid, rig), light="thin", picture_only=True)
    found = comparison.by_thresholds(of_light(comparison, light, 5), 200)
    off = np.abs(lc.play(found, light="thin", picture_only=True) - light)
    assert off.max() < 1.1 * comparison.NEAR


def test_black_and_white_may_be_as_dark_and_as_bright_as_thresholds_say(comparison: ModuleType) -> None:
    flat = np.ones((1, 7, 7, 3), np.float32)
    flat[:, 2:5, 1:3] = 0
    shown = lc.play(comparison.by_thresholds(of_light(comparison, flat, 1), 200), light="thin", picture_only=True)
    assert shown[flat == 1].min() > comparison.BRIGHT - 0.01
    assert shown[flat == 0].max() < comparison.DARK + 0.01
    assert shown[flat == 0].min() > comparison.DARK / 2, "no darker than it must be"


def test_a_row_for_each_method_and_a_picture(
    comparison: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(comparison, "METHODS", [comparison.METHODS[0], comparison.METHODS[-1]])
    comparison.main(["--n", "9", "--repeats", "1", "--picture", str(tmp_path / "all.png")])
    rows = [line.split(" | ") for line in capsys.readouterr().out.splitlines()[2:]]
    assert [row[0] for row in rows] == ["| lightcube `sirt`", "| the same, lamps up to 16"]
    logarithms, seen = ([float(cell.split(" / ")[0]) for cell in row[2:4]] for row in rows)
    assert all(more > less + 3 for less, more in zip(logarithms, seen, strict=True))
    assert (tmp_path / "all.png").stat().st_size > 2000
