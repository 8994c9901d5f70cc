"""Cubes of films: how much of one is taken, that it is said, and that it is remembered."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from lightcube import load
from lightcube.io import save
from lightcube.verbs.options import FILM_MOST
from tests.cli.test_cli import pictures, run

__all__ = ["pictures", "run"]

SMALL = ("--n", 6, "--picture-width", 0.5, "--iterations", 2, "--hold-deg", 0, "--grain", 0, "--mat", "none")


@pytest.fixture
def film(tmp_path: Path) -> Path:
    """Forty pictures that brighten, ten a second."""
    levels = np.linspace(0.3, 0.9, 40)[:, None, None, None]
    return save(np.broadcast_to(levels, (40, 6, 10, 3)).astype(np.float32), tmp_path / "film.mp4", fps=10, scale=2)


@pytest.mark.parametrize(
    ("said", "names"),
    [
        ((), [str(int((place + 0.5) * 40 / FILM_MOST) + 1) for place in range(FILM_MOST)]),
        (("--every", 10), ["1", "11", "21", "31"]),
        (("--from", 1.05, "--to", 1.55), ["12", "13", "14", "15", "16"]),
        (("--from", 1.05, "--to", 1.55, "--most", 2), ["13", "15"]),
    ],
)
def test_what_is_taken_of_a_film_is_remembered(  # type: ignore[no-untyped-def]
    run, film: Path, tmp_path: Path, said: tuple[object, ...], names: list[str]
) -> None:
    out = tmp_path / "a.npz"
    done = run("solve", film, "-o", out, *SMALL, *said)
    assert done.code == 0, done.err
    cube = load(out)
    assert len(cube.names) == len(names)
    assert list(cube.names) == names
    own, again = (json.loads(run("score", out, *given, "--json").out)["psnr_mean"] for given in ((), (film,)))
    assert again == pytest.approx(own, abs=0.3)
    thinned = [line for line in done.lines if "were taken, evenly spread" in line]
    assert len(thinned) == ("--every" not in said and said[-2:-1] != ("--to",))
    report = tmp_path / "a.html"
    assert run("report", out, film, "-o", report).code == 0
    written = dict(re.findall(r"--(from|to|every|most) (\S+?)(?=[\s<])", report.read_text()))
    asked = dict(zip([str(name)[2:] for name in said[::2]], map(str, said[1::2]), strict=True))
    assert written == (asked | ({"most": "32"} if "--to" in said and "--most" not in said else {}))


def test_check_takes_the_same_of_a_film(run, film: Path) -> None:  # type: ignore[no-untyped-def]
    facts = json.loads(run("check", film, "--n", 6, "--picture-width", 0.5, "--most", 4, "--json").out)
    assert facts["names"] == ["6", "16", "26", "36"]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--most", 0), "--most"),
        (("--every", 0), "--every"),
        (("--from", 3, "--to", 1), "let it begin (--from) before it ends (--to)"),
        (("--from", 60), "ends after 3.9 s"),
        (("--from", "soon"), "--from"),
    ],
)
def test_parts_that_cannot_be_are_one_sentence(  # type: ignore[no-untyped-def]
    run, film: Path, tmp_path: Path, options: tuple[object, ...], said: str
) -> None:
    for command in (("solve", film, "-o", tmp_path / "a.npz"), ("check", film)):
        done = run(*command, "--n", 6, *options)
        assert (done.code, len(done.lines)) == (2, 1), done.err
        assert said in done.err
    assert not list(tmp_path.glob("a.*"))


def test_only_films_are_taken_in_part(run, pictures: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "room.toml").write_text("")
    for source in (pictures, tmp_path / "room.toml"):
        done = run("check", source, "--n", 6, "--most", 3)
        assert (done.code, len(done.lines)) == (2, 1), done.err
        assert f"are for films and animations, not for {source}: leave them out" in done.err


def test_a_making_of_is_written_with_the_cube_and_changes_no_bit(run, pictures: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    plain, watched, movie = tmp_path / "a.npz", tmp_path / "b.npz", tmp_path / "b.gif"
    assert run("solve", pictures, "-o", plain, *SMALL).code == 0
    done = run("solve", pictures, "-o", watched, *SMALL, "--making-of", movie, "--format", "square")
    assert done.code == 0, done.err
    assert "from clear to finished" in done.out
    np.testing.assert_array_equal(load(plain).extinction, load(watched).extinction)
    with Image.open(movie) as image:
        assert (image.size, getattr(image, "n_frames", 1) > 3) == ((360, 360), True)
    before = movie.read_bytes()
    refused = run("solve", pictures, "-o", tmp_path / "c.npz", *SMALL, "--making-of", movie)
    assert (refused.code, movie.read_bytes()) == (2, before)
    assert not list(tmp_path.glob("c.*"))


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--making-of", "a.npy"), "is no movie"),
        (("--making-of", "a"), "is no movie"),
        (("--format", "wide"), "--making-of"),
        (("--making-of", "a.mp4", "--unit", "1/3"), "leave out --unit"),
        (("--making-of", "a.mp4", "--scheduler", "local"), "leave out --unit and --scheduler"),
        (("--making-of", "a.mp4", "--memory", "1MB"), ""),
    ],
)
def test_no_making_of_is_one_sentence(  # type: ignore[no-untyped-def]
    run, pictures: Path, tmp_path: Path, options: tuple[str, ...], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = run("solve", pictures, "-o", "c.npz", *SMALL, *options)
    assert (done.code, len(done.lines)) == (2, 1), done.err
    assert said in done.err
    assert not [path for path in tmp_path.iterdir() if path != pictures]


@pytest.mark.parametrize("options", [("--even",), ("--count", 3), ("--to-deg", 90), ("--captions", "--format", "wide")])
def test_the_lamps_eye_stays_at_an_angle(run, pictures: Path, tmp_path: Path, options: tuple[object, ...]) -> None:  # type: ignore[no-untyped-def]
    out = tmp_path / "a.npz"
    assert run("solve", pictures, "-o", out, *SMALL).code == 0
    done = run("play", out, "--view", "eye", "-o", tmp_path / "a.gif", *options)
    assert (done.code, len(done.lines)) == (2, 1), done.err
    assert not list(tmp_path.glob("a.gif*"))
