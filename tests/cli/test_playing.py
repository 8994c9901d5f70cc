"""`play` on the command line: the whole screen or the picture, beside what was wanted, in parts, and in folders."""

import json
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest
from PIL import Image

from lightcube import Cube, Grid, load, read_pictures, save, turntable
from lightcube.forward import casting
from lightcube.pictures.fitting import targets_of
from tests.cli.test_cli import cube, pictures, run
from tests.helpers.wall import play

__all__ = ["cube", "pictures", "run"]


@pytest.mark.parametrize("suffix", ["", ".npy", ".webp"])
def test_play_writes_by_suffix(run, cube: Path, tmp_path: Path, suffix: str) -> None:  # type: ignore[no-untyped-def]
    target = tmp_path / f"shadows{suffix}"
    assert run("play", cube, "-o", target, "--angles-deg", "0,12.5,90").code == 0
    assert target.exists()
    if suffix == ".npy":
        shown = np.load(target)
        assert shown.shape[0] == 3
        assert np.array_equal(shown, casting.play(load(cube), [0, 12.5, 90]))


def test_angles_that_may_be_radians_are_told(run, cube: Path, pictures: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    shown = run("play", cube, "-o", tmp_path / "a.npy", "--angles-deg", "0,1.5708,3.1416")
    assert (shown.code, shown.err.count("radians")) == (0, 1)
    solved = run(
        "solve", pictures, "-o", tmp_path / "a.zarr", "--n", 6, "--dry-run", "--angles-deg", "0,1.5708,3.1416,4.7124"
    )
    assert (solved.code, solved.err.count("radians")) == (0, 1)


@pytest.fixture
def played(run, pictures: Path, tmp_path: Path):  # type: ignore[no-untyped-def]
    """A cube of four pictures of 6 x 6, and what `play` shows of it."""
    solved = tmp_path / "a.npz"
    assert run("solve", pictures, "-o", solved, "--n", 6, "--iterations", 2, "--paper").code == 0

    def show(*options: object) -> np.ndarray[Any, np.dtype[np.float32]]:
        done = run("play", solved, "-o", tmp_path / "shown.npy", "--overwrite", *options)
        assert done.code == 0, done.err
        return np.asarray(np.load(tmp_path / "shown.npy"))

    return load(solved), show


def test_play_shows_the_whole_screen_or_the_picture_only(played) -> None:  # type: ignore[no-untyped-def]
    cube, show = played
    whole, picture = show("--stops"), show("--stops", "--picture-only")
    assert (whole.shape, picture.shape) == ((4, 6, 10, 3), (4, 6, 6, 3))
    assert np.array_equal(whole, casting.play(cube))
    assert np.array_equal(picture, play(cube))
    assert np.array_equal(whole[:, :, 2:-2], picture)
    turned = show("--angles-deg", "3,50")
    assert np.array_equal(turned, casting.play(cube, [3, 50]))
    assert np.array_equal(turned, show("--angles-deg", "3,50", "--screens"))
    large = show("--angles-deg", "3,50", "--format", "square")
    assert np.array_equal(large, show("--angles-deg", "3,50", "--format", "square", "--screens"))


def test_play_puts_what_was_wanted_beside_it(played) -> None:  # type: ignore[no-untyped-def]
    """As high as what is shown, in the middle, its pixels as large."""
    cube, show = played
    wanted = targets_of(cube).pictures
    for zoom in (1, 2):
        larger = wanted.repeat(zoom, axis=1).repeat(zoom, axis=2)
        for more, columns in ((["--picture-only"], 6), ([], 10)):
            shown = show("--stops", "--target", "--zoom", zoom, *more)
            assert shown.shape == (4, 6 * zoom, (columns + 6) * zoom + 2, 3)
            assert np.array_equal(shown[:, :, -6 * zoom :], larger)
            assert not np.any(shown[:, :, columns * zoom : columns * zoom + 2])


def test_play_shows_pixels_in_parts(played) -> None:  # type: ignore[no-untyped-def]
    """Finer; while a scale repeats what is there."""
    cube, show = played
    assert np.array_equal(show("--stops", "--zoom", 3), casting.play(cube, zoom=3))
    thin = show("--stops", "--zoom", 2, "--light", "thin", "--scale", 3)
    assert np.array_equal(thin, casting.play(cube, zoom=2, light="thin").repeat(3, axis=1).repeat(3, axis=2))


def test_a_folder_of_pictures_is_read_again_where_it_has_nothing_else(run, played, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    cube, _ = played
    for more, size in (((), (10, 6)), (("--picture-only",), (6, 6))):
        folder = tmp_path / f"shown{len(more)}"
        assert run("play", tmp_path / "a.npz", "-o", folder, "--stops", *more).code == 0
        read = read_pictures(folder)
        assert {image.shape[1::-1] for image in read.images} == {size}
        assert read.angles_deg == pytest.approx(cube.angles_deg)
    assert run("solve", tmp_path / "shown1", "-o", tmp_path / "b.npz", "--n", 6, "--iterations", 2).code == 0


@pytest.fixture
def unlike(tmp_path: Path) -> Path:
    """A cube whose shadows have nothing to do with each other."""
    grid = Grid((8, 10, 12), 2.0)
    extinction = 3 * (np.random.default_rng(3).random((3, *grid.shape)) < 0.1).astype(np.float32)
    rig = turntable(grid, [10.0, 100.0], elevation_deg=20.0, picture_shape=(4, 6))
    cube = Cube(extinction, grid, rig, lamp_powers=np.full((2, 3), 2.0), names=("one", "two"))
    return save(cube, tmp_path / "unlike.npz")


def test_a_movie_rests_on_the_stops_and_says_so(run, unlike: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    done = run("play", unlike, "-o", tmp_path / "a.mp4", "--json")
    said = json.loads(done.out.splitlines()[-1])
    assert (done.code, said["count"]) == (0, 2 * (18 + 30 + 18 + 8))
    assert "at each of 2 stops the lamp fades in" in said["how"]
    assert said["flicker"] <= 0.03
    even = run("play", unlike, "-o", tmp_path / "b.mp4", "--even")
    assert (even.code, even.err.count("this flickers")) == (0, 1)
    assert "fades" not in even.out
    for more in (("--count", "5"), ("--angles-deg", "0,20"), ("--stops",)):
        assert run("play", unlike, "-o", tmp_path / "c.gif", "--overwrite", *more).code == 0
        with av.open(str(tmp_path / "c.gif")) as container:
            assert len(list(container.decode(video=0))) == {"--count": 5}.get(more[0], 2)


def test_formats_of_the_command_line(run, unlike: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    done = run("play", unlike, "-o", tmp_path / "a.gif", "--format", "portrait", "--captions")
    assert done.code == 0, done.err
    with av.open(str(tmp_path / "a.gif")) as container:
        stream = container.streams.video[0]
        assert (stream.height, stream.width) == (640, 360)
        times = [frame.time for frame in container.decode(video=0)]
    assert times[:2] == [0.0, pytest.approx(0.5)]  # from the middle of the first rest on
    assert times[12:14] == [pytest.approx(1.9), pytest.approx(2.9)]  # it rests for a second
    still = run("play", unlike, "-o", tmp_path / "a.png", "--format", "square", "--angles-deg", "10")
    assert still.code == 0, still.err
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.size == (1080, 1080)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--captions"], "give a format too"),
        (["--format", "square", "--scale", "2"], "leave one of them out"),
        (["--format", "round"], "square"),
    ],
)
def test_formats_that_cannot_be_are_refused(run, unlike: Path, tmp_path: Path, options: list[str], said: str) -> None:  # type: ignore[no-untyped-def]
    done = run("play", unlike, "-o", tmp_path / "a.mp4", *options)
    assert (done.code, done.out) == (2, "")
    assert said in done.err
    assert not list(tmp_path.glob("a*"))
