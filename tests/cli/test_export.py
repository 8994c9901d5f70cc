"""`export` on the command line, and what score and play make of what it wrote."""

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lightcube as lc
from lightcube import io
from lightcube.fabrication import sidecar
from lightcube.fabrication.volumes import FORMATS
from lightcube.optics.arrays import locked
from tests.cli.test_cli import run
from tests.helpers.made import a_cube, in_dyes

__all__ = ["run"]


@pytest.fixture
def cube(tmp_path: Path) -> Path:
    return io.save(a_cube(), tmp_path / "cube.npz")


@pytest.fixture
def dyed(tmp_path: Path) -> Path:
    return io.save(in_dyes(), tmp_path / "dyed.npz")


def score_of(document: str) -> float:
    return float(json.loads(document)["psnr_mean"])


@pytest.mark.parametrize("suffix", FORMATS)
def test_a_volume_is_written_told_scored_and_played(run, cube: Path, tmp_path: Path, suffix: str) -> None:  # type: ignore[no-untyped-def]
    file = tmp_path / f"a{suffix}"
    done = run("export", "volume", cube, "-o", file)
    assert done.code == 0, done.err
    assert "7 x 6 x 5 mm (x, y, z): 14 x 12 x 10 voxels of 0.5 x 0.5 x 0.5 mm" in done.out
    assert "what the file casts: mean PSNR" in done.out
    wanted = score_of(run("score", cube, "--json").out)
    for words in ((file,), (file, cube)):
        assert abs(score_of(run("score", *words, "--json").out) - wanted) < 0.05
    done = run("score", file)
    assert f"as it was exported: mean PSNR {wanted:.2f} dB" in done.out
    assert run("play", file, "-o", tmp_path / "played.npy", "--stops", "--picture-only").code == 0
    np.testing.assert_allclose(np.load(tmp_path / "played.npy"), lc.play(lc.load(cube), picture_only=True), atol=1e-6)


def test_slices_are_written_told_scored_and_played(run, dyed: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    folder = tmp_path / "print"
    done = run("export", "polyjet", dyed, "-o", folder, "--dry-run")
    assert done.code == 0, done.err
    assert "84 x 36 x 76 droplets of 42.3333 x 84.6667 x 27 micrometres, seed 1" in done.out
    assert not folder.exists()
    done = run("export", "polyjet", dyed, "-o", folder, "--json")
    said = json.loads(done.out.splitlines()[-1])
    assert abs(score_of(run("score", folder, dyed, "--json").out) - said["predicted"]["psnr_mean"]) < 1e-6
    assert run("play", folder, "-o", tmp_path / "a.gif", "--stops").code == 0
    assert run("export", "polyjet", dyed, "-o", folder).code == 2
    assert run("export", "polyjet", dyed, "-o", folder, "--overwrite", "--seed", 2, "--no-score").code == 0
    again = json.loads((folder / "slices.json").read_text())
    assert again["seed"] == 2
    assert "predicted" not in again
    (tmp_path / "thesis").mkdir()
    done = run("export", "polyjet", dyed, "-o", tmp_path / "thesis", "--overwrite")
    assert done.code == 2
    assert "is a folder of something else and is not overwritten" in done.err


def test_a_known_material_is_named_and_what_it_costs_is_told(run, cube: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    done = run("export", "polyjet", cube, "-o", tmp_path / "print", "--resins", "polyjet", "--flip", "y")
    assert done.code == 0, done.err
    assert "of all extinction is out of their reach" in done.err
    assert "under lamps found anew, which the sidecar has" in done.out
    assert "nobody measured them" in done.out
    assert json.loads((tmp_path / "print" / "slices.json").read_text())["flips"] == "y"


def test_a_mirrored_and_a_reversed_copy_is_told(run, cube: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    loaded = lc.load(cube)
    for axes, flip in ((3, "x"), (1, "z"), (2, "y")):
        mirrored = replace(loaded, extinction=locked(np.flip(loaded.extinction, axes).copy()))
        lc.export(mirrored, tmp_path / f"{flip}.nrrd", "volume", score=False)
        done = run("score", tmp_path / f"{flip}.nrrd", cube)
        assert re.search(
            rf"the other way round, .* exchanged, it would be .* mirrored or reversed, .*--flip {flip}", done.out
        )
        found = json.loads(run("score", tmp_path / f"{flip}.nrrd", cube, "--json").out)["other_way_round"]
        assert found["flip"] == flip
        assert found["psnr_mean"] > 60
    assert "other_way_round" not in json.loads(run("score", cube, "--json").out)
    lc.export(loaded, tmp_path / "right.nrrd", "volume", score=False)
    assert "the other way round" not in run("score", tmp_path / "right.nrrd", cube).out


def test_a_file_that_was_changed_is_told_and_force_scores_it(run, cube: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    file = tmp_path / "a.npy"
    assert run("export", "volume", cube, "-o", file).code == 0
    np.save(file, np.load(file) * np.float32(1.5))
    for words in (("score", file), ("play", file, "-o", tmp_path / "a.gif")):
        done = run(*words)
        assert done.code == 2
        assert "is not the file that was exported" in done.err
        assert run(*words, "--force").code == 0
    assert score_of(run("score", file, "--force", "--json").out) < 40
    done = run("score", cube, "--force")
    assert done.code == 2
    assert "--force is for files that lightcube export wrote" in done.err


def test_the_cube_need_not_lie_where_it_was(run, cube: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    """But then it has to be named, or the pictures; one that was made anew is another cube."""
    file = tmp_path / "a.vdb"
    assert run("export", "volume", cube, "-o", file).code == 0
    away = tmp_path / "away.npz"
    shutil.move(cube, away)
    done = run("score", file)
    assert done.code == 2
    assert "does not hold what was wanted, and the cube it was made from is not where it was" in done.err
    assert run("score", file, away).code == 0
    io.save(a_cube(seed=1), cube)
    assert "does not hold what was wanted" in run("score", file).err


def test_what_does_not_belong_together_is_refused_and_nothing_is_written(run, cube: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "out").mkdir()
    at = tmp_path / "out"
    for words, said in (
        (
            ("cake", cube, "-o", at / "a.vdb"),
            "cake is nothing that is made of a cube: give one of volume, ",
        ),
        (("volume", cube, "-o", at / "a.vdb", "--levels", 3), "volume takes unit, not levels: leave it out"),
        (("schedule", cube, "-o", at / "a.csv", "--seed", 3), "schedule takes no options, not seed"),
        (("volume", cube, "-o", at / "a.ply"), "has no suffix that a volume can have: use one of .vdb, .nrrd"),
        (("shell", cube, "-o", at / "a.vdb"), "has no suffix that a shell can have: use one of .3mf, .ply"),
        (("polyjet", cube, "-o", at / "a"), "was not solved in dyes: name the resins"),
        (("volume", tmp_path / "none.npz", "-o", at / "a.vdb"), "there is no "),
        (("volume", cube, "-o", at / "none" / "a.vdb"), "there is no folder"),
        (("volume", cube, "-o", at / "a.vdb", "--unit", "inch"), "VolumeFile takes"),
    ):
        done = run("export", *words)
        assert done.code == 2
        assert said in done.err
        assert "Traceback" not in done.err
        assert list(at.iterdir()) == []


def test_a_sidecar_that_stands_in_the_way_is_not_overwritten_unasked(run, cube: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "a.vti.json").write_text("mine")
    done = run("export", "volume", cube, "-o", tmp_path / "a.vti")
    assert done.code == 2
    assert "a.vti.json exists already" in done.err
    assert not (tmp_path / "a.vti").exists()
    assert run("export", "volume", cube, "-o", tmp_path / "a.vti", "--overwrite").code == 0
    assert sidecar.read(tmp_path / "a.vti.json") is not None


def test_a_full_disk_leaves_nothing_and_keeps_what_was(run, cube: Path, tmp_path: Path, monkeypatch: Any) -> None:  # type: ignore[no-untyped-def]
    file = tmp_path / "a.3mf"
    assert run("export", "shell", cube, "-o", file).code == 0
    before = {each.name: each.read_bytes() for each in tmp_path.iterdir() if each.is_file()}

    def full(document: object) -> bytes:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(sidecar, "text", full)
    done = run("export", "shell", cube, "-o", file, "--overwrite", "--levels", 2)
    assert done.code == 2
    assert "no space is left" in done.err
    assert {each.name: each.read_bytes() for each in tmp_path.iterdir() if each.is_file()} == before
    assert not list(tmp_path.glob(".lightcube*"))


def test_a_schedule_can_be_made_of_slices_whose_lamps_were_found_anew(run, cube: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    folder = tmp_path / "print"
    assert run("export", "polyjet", cube, "-o", folder, "--resins", "polyjet").code == 0
    done = run("export", "schedule", folder, "-o", tmp_path / "a.csv")
    assert done.code == 0, done.err
    assert "3 stops, once round takes" in done.out
    assert "one constant white lamp instead" in done.out
    rows = json.loads((tmp_path / "a.csv.json").read_text())["rows"]
    assert [row["power_red"] for row in rows] != lc.load(cube).powers[:, 0].tolist()
