"""`relief` on the command line, and what play, score and info make of one."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import av
import numpy as np
import pytest
from PIL import Image

from lightcube.io import read_relief
from lightcube.solids.relief_light import relief_shadow, shown
from tests.cli.test_cli import run

__all__ = ["run"]

SMALL = ("--columns", 12, "--sweeps", 3, "--relief", 4)


@pytest.fixture
def photos(tmp_path: Path) -> list[Path]:
    """Five pictures of 20 x 20."""
    y, x = np.indices((20, 20)) / 19
    places = []
    for number, tone in enumerate((x, y, 1 - x, 1 - y, x * y)):
        places.append(tmp_path / f"p{number}.png")
        colours = np.stack([tone, tone, tone**2], axis=2)
        Image.fromarray(np.rint(255 * colours).astype(np.uint8)).save(places[-1])
    return places


@pytest.fixture
def kept(run, photos: list[Path], tmp_path: Path) -> Path:  # type: ignore[no-untyped-def]
    """A relief of three pictures."""
    path = tmp_path / "plate.relief.zarr"
    assert run("relief", *photos[:3], "-o", path, *SMALL).code == 0
    return path


def test_a_relief_is_written_in_all_its_forms_at_once(run, photos: list[Path], tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    names = [tmp_path / f"plate{suffix}" for suffix in (".stl", ".3mf", ".relief.zarr", ".png")]
    outputs = [word for name in names for word in ("-o", name)]
    sheet = tmp_path / "sheet.png"
    done = run("relief", *photos[:2], *outputs, "--sheet", sheet, *SMALL, "--layer-mm", 0.2, "--frame-mm", 3)
    assert done.code == 0, done.err
    assert all(name.exists() for name in (*names, sheet))
    assert "p0: " in done.out
    assert "lamp on the left" in done.out
    assert "plate 15.6 x 15.6 x " in done.out
    made = read_relief(names[2])
    assert made.names == ("p0", "p1")
    np.testing.assert_allclose(made.heights_mm / 0.2, np.rint(made.heights_mm / 0.2), atol=1e-9)


def test_a_folder_of_pictures_is_as_good_and_a_seed_decides(run, photos: list[Path], tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    folder, made = tmp_path / "folder", []
    folder.mkdir()
    for photo in photos[:2]:
        photo.rename(folder / photo.name)
    for number, seed in enumerate((4, 4, 5)):
        path = tmp_path / f"{number}.relief.zarr"
        assert run("relief", folder, "-o", path, *SMALL, "--seed", seed, "--threads", 1).code == 0
        made.append(read_relief(path).heights_px)
    np.testing.assert_array_equal(made[0], made[1])
    assert not np.array_equal(made[0], made[2])


def test_machines_are_told_all_figures(run, photos: list[Path], tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    done = run("relief", *photos[:2], "-o", tmp_path / "a.stl", *SMALL, "--json")
    *_, last = [json.loads(line) for line in done.out.splitlines()]
    assert last["event"] == "result"
    assert last["lamps"] == ["on the right", "on the left"]
    assert last["columns"] == [12, 12]
    assert {"psnr_mean", "near_psnr_mean", "off", "pictures"} <= set(last["scores"])
    assert any(json.loads(line)["event"] == "progress" for line in done.out.splitlines())


def test_one_picture_in_colour(run, photos: list[Path], tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    path = tmp_path / "c.relief.zarr"
    done = run("relief", photos[0], "-o", path, "--colour", *SMALL)
    assert (done.code, "red lamp right, green left, blue behind" in done.out) == (0, True)
    assert run("play", path, "-o", tmp_path / "c.npy", "--stops").code == 0
    assert np.load(tmp_path / "c.npy").shape == (1, 12, 12, 3)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "1 to 4 pictures, not 5"),
        (("--colour",), "1 to 4 pictures, not 5"),
        (("--pitch-mm", 0.01), "columns of 0.01 mm cannot be made"),
        (("--black", "dark"), "--black dark: give a number, or auto"),
        (("--sheet", "p.txt"), "p.txt has no suffix that a picture can have"),
        (("--method", "local"), "1 to 4 pictures, not 5"),
    ],
)
def test_what_cannot_be_is_one_sentence(  # type: ignore[no-untyped-def]
    run, photos: list[Path], tmp_path: Path, words: tuple[object, ...], said: str
) -> None:
    before = sorted(tmp_path.iterdir())
    done = run("relief", *photos, "-o", tmp_path / "a.stl", *SMALL, *words)
    assert (done.code, said in done.err) == (2, True), done.err
    assert sorted(tmp_path.iterdir()) == before


def test_outputs_are_looked_at_before_the_work(run, photos: list[Path], tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    taken = tmp_path / "taken.stl"
    taken.write_text("solid")
    assert "exists already" in run("relief", photos[0], "-o", taken, *SMALL).err
    assert taken.read_text() == "solid"
    assert "named twice" in run("relief", photos[0], "-o", "a.png", "--sheet", "a.png", *SMALL).err
    assert "no suffix that a relief can have" in run("relief", photos[0], "-o", "a.gif", *SMALL).err
    assert run("relief", photos[0], "-o", taken, *SMALL, "--overwrite").code == 0


def test_walls_that_would_be_too_high_are_refused(run, photos: list[Path], tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    done = run("relief", *photos[:2], "-o", tmp_path / "a.stl", "--method", "local", "--columns", 60)
    assert (done.code, "or use the global method" in done.err) == (2, True)
    done = run("relief", photos[0], "-o", tmp_path / "a.stl", "--method", "local", "--columns", 60)
    assert (done.code, "walls drift by 0.0 columns" in done.out) == (0, True), done.err


def test_ctrl_c_leaves_nothing(photos: list[Path], tmp_path: Path) -> None:
    before = sorted(tmp_path.iterdir())
    words = ["relief", str(photos[0]), "-o", str(tmp_path / "a.stl"), "--columns", "64", "--sweeps", "90000", "--json"]
    with subprocess.Popen(
        [sys.executable, "-m", "lightcube", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as program:
        assert program.stdout is not None
        assert json.loads(program.stdout.readline())["event"] == "progress"
        time.sleep(0.1)
        program.send_signal(signal.SIGINT)
        _, err = program.communicate(timeout=60)
    assert (program.returncode, err.splitlines()[-1]) == (130, "interrupted: no file was finished")
    assert sorted(tmp_path.iterdir()) == before


def test_the_lamp_goes_round_and_rests_at_the_pictures(run, kept: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    assert run("play", kept, "-o", tmp_path / "a.mp4").code == 0
    with av.open(str(tmp_path / "a.mp4")) as film:
        assert film.streams.video[0].frames == 240 + 3 * 39
        assert film.streams.video[0].height >= 256
    assert run("play", kept, "-o", tmp_path / "b.npy").code == 0
    assert np.load(tmp_path / "b.npy").shape == (240, 12, 12, 3)


def test_stills_are_what_the_lamps_show(run, kept: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    """Blurred by one column, in grey."""
    relief = read_relief(kept)
    assert run("play", kept, "-o", tmp_path / "a.npy", "--stops").code == 0
    stills = np.load(tmp_path / "a.npy")
    assert stills.shape == (3, 12, 12, 3)
    np.testing.assert_allclose(stills.mean(axis=(1, 2, 3)), shown(relief).mean(axis=(1, 2)), rtol=0.02)
    assert run("play", kept, "-o", tmp_path / "b.npy", "--angles-deg", "180,33").code == 0
    np.testing.assert_array_equal(np.load(tmp_path / "b.npy")[0], stills[1])
    other = np.load(tmp_path / "b.npy")[1].mean()
    assert other == pytest.approx(relief_shadow(relief, 33.0).mean(), rel=0.02)


@pytest.mark.parametrize(
    "words", [("--zoom", 2), ("--target",), ("--count", 5), ("--view", "room"), ("--light", "thin")]
)
def test_what_only_cubes_have_is_refused(run, kept: Path, tmp_path: Path, words: tuple[object, ...]) -> None:  # type: ignore[no-untyped-def]
    done = run("play", kept, "-o", tmp_path / "a.npy", *words)
    assert (done.code, "a relief takes --stops" in done.err) == (2, True)


def test_scores_and_what_is_in_the_file(run, kept: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    done = run("score", kept, "--robust", "--sheet", tmp_path / "s.png")
    assert (done.code, "lamps 3 deg higher: " in done.out, (tmp_path / "s.png").exists()) == (0, True, True)
    scores = json.loads(run("score", kept, "--json").out)
    assert [each["name"] for each in scores["pictures"]] == ["p0", "p1", "p2"]
    assert "off" not in scores
    assert "leave out all but" in run("score", kept, "--between").err
    known = json.loads(run("info", kept, "--json").out)
    assert (known["kind"], known["columns"], known["relief_px"] <= 4) == ("relief", [12, 12], True)
    assert "on the right" in run("info", kept).out


def test_view_writes_a_page_and_a_picture_of_it(run, kept: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    page, picture = tmp_path / "plate.html", tmp_path / "plate.png"
    done = run("view", kept, "-o", page, "--preview", "--title", "Three", "--json")
    assert done.code == 0, done.err
    assert json.loads(done.out)["shape"] == [12, 12]
    assert "<title>Three</title>" in page.read_text(encoding="utf-8")
    with Image.open(picture) as drawn:
        assert drawn.size == (1200, 630)
    page.unlink()
    refused = run("view", kept, "-o", page, "--full")
    assert (refused.code, page.exists()) == (2, False)
    assert "leave out --full" in refused.err


def test_a_dry_run_says_what_is_to_be_expected_and_writes_nothing(run, photos: list[Path], tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    wish = (*photos[:2], "--columns", 16, "--relief", 4, "--sweeps", 60)
    done = run("relief", *wish, "-o", tmp_path / "b.stl", "--dry-run", "--json")
    assert done.code == 0, done.err
    told = json.loads(done.out)
    made = run("relief", *wish, "-o", tmp_path / "a.relief.zarr", "--json")
    came = json.loads(made.out.splitlines()[-1])["scores"]
    assert told["sweeps"] == 6
    assert came["psnr_mean"] - 8 < told["psnr_mean"] < came["psnr_mean"]
    assert told["seconds"] > 0
    said = run("relief", *wish, "--dry-run", "-o", tmp_path / "b.stl")
    assert "with 6 sweeps already" in said.out
    assert "nothing is written" in said.out
    assert not (tmp_path / "b.stl").exists()


def test_bounce_is_kept(run, photos: list[Path], tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    place = tmp_path / "plate.relief.zarr"
    assert run("relief", *photos[:2], "-o", place, *SMALL, "--bounce", 0.1).code == 0
    assert read_relief(place).recipe.bounce == 0.1
    assert json.loads(run("info", place, "--json").out)["bounce"] == 0.1
