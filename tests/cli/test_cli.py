"""The command line as people and machines use it: results, exit codes, sentences, nothing half-written."""

import json
import os
import re
import signal
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from lightcube import load
from lightcube.cli import main
from lightcube.io import save
from lightcube.jobs.reading import UnfinishedCube
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.verbs import wonders

SCENE = """
camera = {type = "shadow", cube_width = 4.0}
pictures = {count = 4, size = [6, 6]}
[[shapes]]
type = "sphere"
radius = 1.5
colour = "#2060c0"
glass = 2.0
"""


class Run:
    def __init__(self, code: int, out: str, err: str) -> None:
        self.code, self.out, self.err = code, out, err
        self.lines = err.strip().splitlines()


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]):  # type: ignore[no-untyped-def]
    def call(*arguments: object) -> Run:
        code = main.run([*map(str, arguments)])
        captured = capsys.readouterr()
        return Run(code, captured.out, captured.err)

    return call


@pytest.fixture
def pictures(tmp_path: Path) -> Path:
    """Four pictures of 6 x 6 pixels that a cube of 6 voxels can cast well: smooth and bright."""
    folder = tmp_path / "pictures"
    folder.mkdir()
    ramp = np.linspace(150, 250, 6)
    for index in range(4):
        picture = np.stack([np.roll(ramp, index)[None, :] + np.zeros((6, 1))] * 3, axis=-1)
        Image.fromarray(picture.astype(np.uint8)).save(folder / f"{index + 1}.png")
    return folder


@pytest.fixture
def cube(tmp_path: Path) -> Path:
    grid = Grid((4, 5, 6), 2.0)
    extinction = np.random.default_rng(0).uniform(0, 0.1, (3, 4, 5, 6)).astype(np.float32)
    path = tmp_path / "known.npz"
    save(Cube(extinction, grid, turntable(grid, [10.0, 100.0], picture_shape=(4, 5))), path)
    return path


def test_from_a_scene_to_a_score(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "ball.toml").write_text(SCENE)
    traced = run("trace", tmp_path / "ball.toml", "-o", tmp_path / "ball")
    assert (traced.code, len(list((tmp_path / "ball").glob("*.png")))) == (0, 4)
    solved = run(
        "solve", tmp_path / "ball", "-o", tmp_path / "ball.zarr", "--n", 6, "--picture-width", 1, "--iterations", 300
    )
    assert solved.code == 0
    assert "not resampled" in solved.err
    assert "well: all 4 pictures are " in solved.out
    assert "PSNR" not in solved.out
    assert f"turn it by hand: lightcube view {tmp_path / 'ball.zarr'}" in solved.out
    assert not (tmp_path / "ball.zarr.partial").exists()
    played = run("play", tmp_path / "ball.zarr", "-o", tmp_path / "ball.gif", "--count", 5, "--scale", 4)
    assert played.code == 0
    with Image.open(tmp_path / "ball.gif") as movie:
        assert movie.size == (40, 24)  # the whole screen
    scored = run("score", tmp_path / "ball.zarr", tmp_path / "ball", "--json", "--sheet", tmp_path / "sheet.png")
    scores = json.loads(scored.out)
    area = ["psnr_mean", "psnr_min", "ssim_mean", "delta_e_mean", "pictures"]
    assert list(scores) == [
        *area,
        "thin_psnr_mean",
        "thin_psnr_min",
        "grain_rms",
        "grain_db",
    ]  # too wide for a mat
    assert scores["psnr_mean"] > 30
    assert [view["angle_deg"] for view in scores["pictures"]] == pytest.approx([22.5, 67.5, 112.5, 157.5])
    with Image.open(tmp_path / "sheet.png") as sheet:
        assert sheet.size[0] > 100
    told = run("info", tmp_path / "ball.zarr")
    assert "complete" in told.out
    assert "6 x 6 x 6" in told.out
    assert json.loads(run("info", tmp_path / "ball.zarr", "--json").out)["made_with_method"] == "display"


def test_solve_prints_json_lines_for_machines(run, pictures: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    done = run("solve", pictures, "-o", tmp_path / "a.npz", "--n", 6, "--iterations", 5, "--json")
    events = [json.loads(line) for line in done.out.splitlines()]
    planning, solving = ([each for each in events if each.get("task") == task] for task in ("planning", "solving"))
    assert {each["event"] for each in planning + solving} == {"progress"}
    assert {"width", "hold"} <= set(planning[0])
    assert "PSNR" in solving[0]
    result = events[-1]
    assert result["event"] == "result"
    assert result["iterations"] == 5
    assert {"psnr_mean", "psnr_min", "ssim_mean", "delta_e_mean", "pictures", "rejected"} <= set(result)


def test_gauss_seidel_says_what_it_threw_out(run, pictures: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    literal = ["--method", "gauss-seidel", "--paper"]
    done = run("solve", pictures, "-o", tmp_path / "a.npz", "--n", 6, *literal)
    assert done.code == 0
    assert "thrown out" in done.out


def pressed(*_: object) -> float:
    signal.raise_signal(signal.SIGINT)
    return 20.0


def test_ctrl_c_keeps_what_was_reached(run, pictures: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:  # type: ignore[no-untyped-def]
    out = tmp_path / "a.zarr"
    with monkeypatch.context() as patched:
        patched.setattr("lightcube.scoring.metrics.mean_psnr", pressed)
        stopped = run("solve", pictures, "-o", out, "--n", 6)
    assert stopped.code == 130
    assert f"lightcube publish {out}.partial" in stopped.err
    assert not out.exists()
    again = run("solve", pictures, "-o", out, "--n", 6, "--hold-deg", 1)
    assert again.code == 2
    assert "hold was" in again.err
    published = run("publish", f"{out}.partial")
    assert published.code == 0
    assert f"{out} holds 0 of 1 unit, the rest is" in published.out
    told = run("info", out)
    assert "interrupted" in told.out
    assert run("publish", f"{out}.partial").code == 2
    assert run("solve", pictures, "-o", out, "--n", 6, "--overwrite", "--iterations", 3).code == 0
    assert "complete" in run("info", out).out


def test_publish_tells_machines_whether_a_cube_is_whole(run, pictures: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    out, said = tmp_path / "a.npz", ("--n", 6, "--iterations", 3, "--powers", "coarse")
    for units, whole in ((("1/2",), False), (("1/2", "2/2"), True)):
        for unit in units:
            assert run("solve", pictures, "-o", out, *said, "--unit", unit, "--overwrite").code == 0
        told = json.loads(run("publish", f"{out}.partial", "--overwrite", "--json").out)
        assert (told["event"], told["out"], told["units"]) == ("result", str(out), 2)
        assert (told["whole"], told["units_done"]) == (whole, len(units))
        assert ("psnr_mean" in told, "psnr_mean" in load_quietly(out).scores) == (whole, whole)


def load_quietly(path: Path) -> Cube:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnfinishedCube)
        return load(path)


def test_an_interrupted_cube_remembers_how_it_was_made(  # type: ignore[no-untyped-def]
    run, pictures: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    Image.new("RGB", (12, 6), (200, 180, 160)).save(pictures / "4.png")
    with monkeypatch.context() as patched:
        patched.setattr("lightcube.scoring.metrics.mean_psnr", pressed)
        run("solve", pictures, "-o", tmp_path / "a.npz", "--n", 6, "--fit", "pad", "--hold-deg", 3)
    run("publish", tmp_path / "a.npz.partial")
    told = json.loads(run("info", tmp_path / "a.npz", "--json").out)
    assert (told["made_with_fit"], told["hold_deg"], told["status"]) == ("pad", 3.0, "interrupted")
    own, fitted = (json.loads(run("score", tmp_path / "a.npz", *f, "--json").out) for f in ([], [pictures]))
    assert own["psnr_mean"] == pytest.approx(fitted["psnr_mean"], abs=0.1)


def test_overwrite_removes_an_old_partial(run, pictures: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:  # type: ignore[no-untyped-def]
    out = tmp_path / "a.npz"
    with monkeypatch.context() as patched:
        patched.setattr("lightcube.scoring.metrics.mean_psnr", pressed)
        run("solve", pictures, "-o", out, "--n", 6)
    assert (tmp_path / "a.npz.partial").exists()
    assert run("solve", pictures, "-o", out, "--n", 6, "--iterations", 3, "--overwrite").code == 0
    assert not (tmp_path / "a.npz.partial").exists()


def test_a_real_process_stops_at_ctrl_c_with_130(pictures: Path, tmp_path: Path) -> None:
    """SIGINT as a terminal sends it, while solving as long as it takes."""
    command = [sys.executable, "-m", "lightcube", "solve", str(pictures), "-o"]
    command += [str(tmp_path / "a.zarr"), "--n", "8", "--iterations", "1000000", "--json", "--method", "sirt"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        while '"solving"' not in (line := process.stdout.readline()):
            assert '"planning"' in line
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=120)
    assert process.returncode == 130, err
    assert "Traceback" not in err
    assert (tmp_path / "a.zarr.partial").is_dir()


BAD = [
    ("solve", "{none}", "-o", "{tmp}/a.zarr"),
    ("solve", "{empty}", "-o", "{tmp}/a.zarr"),
    ("solve", "{pictures}", "-o", "{tmp}/a.xyz"),
    ("solve", "{pictures}", "-o", "{tmp}/missing/a.zarr"),
    ("solve", "{pictures}", "-o", "{pictures}/1.png"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "0"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "-3"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "six"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--shape", "6,6,6"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--shape", "6,6"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--size-mm", "-1"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--size-mm", "nan"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--picture-width", "3"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--angles-deg", "0,1,2"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--angles-deg", "0,1,2,360"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--angles-deg", "0,1,2,nan"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--angles-deg", "0,1,2,x"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--elevation-deg", "90"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--elevation-deg", "-90"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--span-deg", "0"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--method", "magic"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--fit", "squeeze"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--lamp-power", "0"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--iterations", "0"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--max-extinction", "-2"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "4000"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--lamp-power", "1e300"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--lamp-max", "0.5"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--lamp-power", "1", "--lamp-max", "4"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--powers", "coarse", "--lamp-power", "4"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--powers", "shared", "--method", "cgls"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--picture-width", "1e308"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--size-mm", "1e-300"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--max-extinction", "nan"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--clear", "-0.1"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--clear", "0.1,0.2"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--clear", "0.5", "--max-extinction", "0.2"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--clear", "0.5", "--material", "polyjet"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--clear", "0.5", "--films", "3"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--hold-deg", "60"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--hold-deg", "nan"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--grain", "-0.1"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--grain", "3"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--grain", "fine"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--grain", "0.1", "--light", "thin"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--grain", "0.1", "--method", "sirt"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--grain", "0.1", "--paper"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "12", "--start-from", "{cube}"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--start-from", "{none}"),
    ("solve", "{pictures}", "-o", "{tmp}/a.zarr", "--n", "6", "--start-from", "{pictures}"),
    ("solve", "{pictures}"),
    ("play", "{cube}", "-o", "{tmp}/a.gif", "--stops", "--angles-deg", "5"),
    ("play", "{cube}", "-o", "{tmp}/a.gif", "--angles-deg", "5", "--count", "3"),
    ("play", "{cube}", "-o", "{tmp}/a.gif", "--from-deg", "5", "--to-deg", "5"),
    ("trace", "carousel", "-o", "{tmp}/a", "--count", "1000000", "--size", "640x480"),
    ("play", "{none}", "-o", "{tmp}/a.mp4"),
    ("play", "{pictures}", "-o", "{tmp}/a.mp4"),
    ("play", "{cube}", "-o", "{tmp}/a.doc"),
    ("play", "{cube}", "-o", "{cube}"),
    ("play", "{cube}", "-o", "{tmp}/a.gif", "--angles-deg", "nan"),
    ("play", "{cube}", "-o", "{tmp}/a.gif", "--angles-deg", ""),
    ("play", "{cube}", "-o", "{tmp}/a.gif", "--count", "0"),
    ("play", "{cube}", "-o", "{tmp}/a.gif", "--from-deg", "inf"),
    ("play", "{cube}", "-o", "{tmp}/a.gif", "--scale", "0"),
    ("play", "{cube}", "-o", "{tmp}/a.gif", "--zoom", "0"),
    ("play", "{cube}", "-o", "{tmp}/a.gif", "--zoom", "17"),
    ("play", "{cube}", "-o", "{tmp}/a.gif", "--zoom", "1.5"),
    ("play", "{cube}", "-o", "{tmp}/a.gif", "--view", "room", "--zoom", "2"),
    ("play", "{cube}", "-o", "{tmp}/a.gif", "--view", "room", "--zoom", "0"),
    ("play", "{cube}", "-o", "{tmp}/a.gif", "--view", "room", "--picture-only"),
    ("play", "{cube}", "-o", "{tmp}/a.gif", "--fps", "0"),
    ("play", "{cube}", "-o", "{tmp}/a.gif", "--target"),
    ("score", "{cube}"),
    ("score", "{cube}", "{pictures}"),
    ("score", "{cube}", "--sheet", "{cube}"),
    ("score", "{cube}", "--sheet", "{tmp}/a.png", "--plot", "{tmp}/a.png"),
    ("info", "{none}"),
    ("info", "{pictures}/1.png"),
    ("publish", "{cube}"),
    ("publish", "{none}.zarr.partial"),
    ("draw", "{none}", "-o", "{tmp}/a.png"),
    ("draw", "{cube}", "-o", "{tmp}/a.svg"),
    ("draw", "{cube}", "-o", "{cube}"),
    ("draw", "{cube}", "-o", "{tmp}/a.png", "--angle-deg", "nan"),
    ("trace", "{none}", "-o", "{tmp}/a"),
    ("trace", "carousel", "-o", "{tmp}/a", "--size", "64"),
    ("trace", "carousel", "-o", "{tmp}/a", "--count", "0"),
    ("trace", "carousel", "-o", "{tmp}/a", "--elevation-deg", "90"),
    ("trace", "carousel", "-o", "{tmp}/a.what"),
    ("juggle",),
    ("info", "{cube}", "--magic"),
]


#: What stands where something else is wanted, and what is said of it.
MISTAKEN = [
    *(
        (verb, "{tmp}/cube.zarr", "{tmp}/cube.zarr holds arrays, such as a cube's, not pictures: give ")
        for verb in ("solve", "check")
    ),
    ("trace", "{tmp}/none.toml", "there is no {tmp}/none.toml: give a scene's .toml file, or one of "),
    *(
        (verb, "{tmp}/none.toml", "there is no {tmp}/none.toml: give a stage's file or pic")
        for verb in ("solve", "check")
    ),
    *(
        (verb, given, f"{given} is {kind}, no cube: make one ")
        for verb in ("play", "info", "score", "view", "report")
        for given, kind in (
            ("{tmp}/photos", "pictures"),
            ("{tmp}/photos/1.PNG", "one picture by its name"),
            ("{tmp}/film.mp4", "pictures"),
            ("{tmp}/film.GIF", "pictures"),
            ("{tmp}/room.toml", "a stage's or a scene's file"),
        )
    ),
    *(
        (
            verb,
            f"{{tmp}}/word.{suffix}",
            f"{{tmp}}/word.{suffix} is a mesh, which holds no lamps and screens: lightcube ",
        )
        for verb in ("play", "info", "view", "report")
        for suffix in ("stl", "3MF", "obj", "ply")
    ),
    ("score", "{tmp}/word.stl", "{tmp}/word.stl is a mesh and keeps no pictures: give them after it"),
    *(
        (verb, "{tmp}/made", "{tmp}/made is a folder, no cube: give a cube that is in it, such as {tmp}/made/moon.zarr")
        for verb in ("play", "info", "score", "view", "report")
    ),
    ("view", "{tmp}/plates", "{tmp}/plates has no suffix that a cube can have: "),
    ("play", "{tmp}/empty", "{tmp}/empty has no suffix that a cube can have: "),
    *((verb, "{tmp}/file.zarr", "{tmp}/file.zarr is a file, and no cube ") for verb in ("play", "info", "score")),
]


@pytest.mark.parametrize(("verb", "given", "said"), MISTAKEN)
def test_what_stands_in_the_wrong_place_is_named(  # type: ignore[no-untyped-def]
    run, tmp_path: Path, verb: str, given: str, said: str
) -> None:
    (tmp_path / "cube.zarr").mkdir()
    (tmp_path / "cube.zarr" / "zarr.json").write_text("{}")
    (tmp_path / "file.zarr").write_text("x")
    (tmp_path / "empty").mkdir()
    (tmp_path / "photos").mkdir()
    (tmp_path / "photos" / "1.PNG").touch()
    (tmp_path / "photos" / "2.jpg").touch()
    for name in ("made/1.png", "made/2.png", "made/art.shape.zarr", "made/moon.zarr", "plates/a.relief.zarr"):
        (tmp_path / name).mkdir(parents=True)
    target = {"solve": ("-o", "{tmp}/a.zarr"), "trace": ("-o", "{tmp}/a"), "play": ("-o", "{tmp}/a.gif")}
    target |= dict.fromkeys(("view", "report"), ("-o", "{tmp}/a.html"))
    done = run(*[word.format(tmp=tmp_path) for word in (verb, given, *target.get(verb, ()))])
    assert done.code == 2, done.err
    assert any(line.startswith(f"lightcube: {said.format(tmp=tmp_path)}") for line in done.lines), done.err


@pytest.mark.parametrize(("verb", "target"), [("solve", "a.zarr"), ("play", "a.gif")])
@pytest.mark.parametrize("given", ["one.jpg", "folder"])
def test_what_solve_would_refuse_is_not_suggested(  # type: ignore[no-untyped-def]
    run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, given: str, verb: str, target: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("folder").mkdir()
    Path("one.jpg").write_text("a text")
    Path("folder/a.png").write_text("another")
    done = run(verb, given, "-o", target)
    assert (done.code, len(done.lines)) == (2, 1)
    assert f"solve {given}" not in done.err
    assert ("in lightcube solve photos -o" in done.err) == (verb == "play")


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (("solve", "a.jpg", "b.jpg", "-o", "x.zarr"), "b.jpg is too much for lightcube solve, which takes pictures"),
        (("solve", "a.jpg", "-o", "x.zarr", "b.jpg", "c.jpg"), "b.jpg, c.jpg are too much for lightcube solve, which"),
        (("score", "x.zarr", "a.jpg", "b.jpg"), "b.jpg is too much for lightcube score, which takes pictures"),
        (("report", "x.zarr", "a.jpg", "b.jpg"), "b.jpg is too much for lightcube report, which takes pictures"),
        (("check", "a.jpg", "b.jpg"), "more than one place is for opaque objects: put all"),
    ],
)
def test_pictures_of_several_places_go_into_one_folder(  # type: ignore[no-untyped-def]
    run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, asked: tuple[str, ...], said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    done = run(*asked)
    assert (done.code, len(done.lines), list(tmp_path.iterdir())) == (2, 1, [])
    assert done.err.startswith(f"lightcube: {said}")
    assert "into one folder" in done.err


def test_other_words_that_are_too_many_are_named(run) -> None:  # type: ignore[no-untyped-def]
    done = run("view", "a.zarr", "b.zarr")
    assert (done.code, done.lines) == (
        2,
        ["lightcube: b.zarr is too much for lightcube view: leave it out, or see lightcube view --help"],
    )


@pytest.mark.parametrize("arguments", BAD, ids=lambda a: " ".join(a))
def test_bad_input_is_one_sentence_and_exit_code_2(  # type: ignore[no-untyped-def]
    run, pictures: Path, cube: Path, tmp_path: Path, arguments: tuple[str, ...]
) -> None:
    (tmp_path / "empty").mkdir()
    before = sorted(tmp_path.rglob("*"))
    places = {
        "tmp": tmp_path,
        "none": tmp_path / "none",
        "empty": tmp_path / "empty",
        "pictures": pictures,
        "cube": cube,
    }
    done = run(*[argument.format(**places) for argument in arguments])
    assert done.code == 2, done.err
    sentences = [line for line in done.lines if line.startswith("lightcube: ")]
    assert len(sentences) == 1
    assert len(sentences[0]) > 20
    assert "Traceback" not in done.err
    assert sorted(tmp_path.rglob("*")) == before


def test_an_old_partial_outlives_options_that_are_refused(run, pictures: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    kept = tmp_path / "a.zarr.partial" / "unit-0.npz"
    kept.parent.mkdir()
    kept.write_bytes(b"")
    out = tmp_path / "a.zarr"
    for options in (("--method", "magic"), ("--n", 0), ("--lamp-power", -1), ("--picture-width", 9)):
        assert run("solve", pictures, "-o", out, "--overwrite", *options).code == 2
    assert run("solve", tmp_path / "none", "-o", out, "--overwrite").code == 2
    assert kept.exists()


def test_what_is_no_partial_is_never_touched(run, pictures: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    other = tmp_path / "a.zarr.partial"
    other.mkdir()
    (other / "mine.txt").write_text("dear diary")
    refused = run("solve", pictures, "-o", tmp_path / "a.zarr", "--n", 6, "--overwrite")
    assert refused.code == 2
    assert "is none" in refused.err
    assert (other / "mine.txt").exists()


def test_names_with_brackets_and_letters_a_terminal_lacks(pictures: Path, tmp_path: Path) -> None:
    (pictures / "views.toml").write_text('names = ["[/a]", "[red]b", "\u2603", ":cat:"]\n')
    command = [sys.executable, "-m", "lightcube"]
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    arguments = ["solve", str(pictures), "-o", str(tmp_path / "a.npz"), "--n", "6", "--method", "gauss-seidel"]
    solved = subprocess.run([*command, *arguments], capture_output=True, text=True, env=environment)
    assert solved.returncode == 0, solved.stderr
    told = subprocess.run([*command, "score", str(tmp_path / "a.npz")], capture_output=True, text=True, env=environment)
    assert told.returncode == 0, told.stderr
    assert "[/a]" in told.stdout
    assert ":cat:" in told.stdout


def test_score_remembers_how_pictures_were_fitted(run, pictures: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    Image.new("RGB", (12, 6), (200, 180, 160)).save(pictures / "4.png")
    run("solve", pictures, "-o", tmp_path / "a.npz", "--n", 6, "--iterations", 30, "--fit", "pad", "--json")
    again = json.loads(run("score", tmp_path / "a.npz", pictures, "--json").out)
    assert again["psnr_mean"] == pytest.approx(load(tmp_path / "a.npz").scores["psnr_mean"])
    (pictures / "views.toml").write_text("angles_deg = [1, 2, 3, 4]\n")
    assert "other angles" in run("score", tmp_path / "a.npz", pictures).err


def test_warnings_are_notes(run, pictures: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    Image.new("RGBA", (6, 6), (255, 0, 0, 128)).save(pictures / "4.png")
    level = ["--elevation-deg", 0, "--angles-deg", "10,50,100,190"]
    done = run("solve", pictures, "-o", tmp_path / "a.zarr", "--n", 6, "--iterations", 2, *level)
    notes = [line for line in done.lines if line.startswith("note: ")]
    assert len(notes) == 1
    assert "transparent" in notes[0]
    assert "mirror images" in done.err


def test_help_names_every_command() -> None:
    environment = {**os.environ, "COLUMNS": "100"}
    command = [sys.executable, "-m", "lightcube", "--help"]
    text = subprocess.run(command, capture_output=True, text=True, env=environment, check=True).stdout
    listed = re.findall(r"^\s+([a-z]+)\s\s+[A-Z]", text, re.MULTILINE)
    assert " ".join(listed) == (
        "studio trace check solve hull carve relief play score view report draw info export materials calibrate "
        "publish bench demo"
    )


def test_the_demo_leaves_what_it_says(run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:  # type: ignore[no-untyped-def]
    """As a whole, on cubes of a moment."""
    monkeypatch.setattr(wonders, "SIDE", 10)
    done = run("demo", "-o", tmp_path / "out")
    assert done.code == 0, done.err
    figures = json.loads((tmp_path / "out/metrics.json").read_text())
    shown = (tmp_path / "out/index.html").read_text()
    for name, count in (("photographs", 8), ("juggler", 24), ("walls", 8)):
        assert len(figures[name]["pictures"]) == count
        cube = load(tmp_path / f"out/{name}.zarr")
        assert cube.grid.shape == (10, 10, 10)
        assert shown.count(f'href="{name}.html"') == 2  # the picture and its title
        made = {file.name for file in (tmp_path / "out").glob(f"{name}*")}
        assert made == {f"{name}.{suffix}" for suffix in ("zarr", "html", "png", "mp4")}
    assert "lightcube solve photos -o cube.zarr" in shown
    assert "index.html in a browser" in done.out
    assert not re.search(r"https?://|<script", shown)


def test_the_paper_is_drawn(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    done = run("demo", "--paper", "-o", tmp_path / "out")
    assert done.code == 0, done.err
    assert f"drawn in {tmp_path}/out/paper.png" in done.out
    assert sorted(each.name for each in (tmp_path / "out").iterdir()) == ["paper.gif", "paper.png"]
