"""Writing pictures: what comes back of them, and what is made of their options."""

import errno
import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as st_numpy
from numpy.typing import NDArray
from PIL import Image

from lightcube.errors import InputError
from lightcube.io import ClippedPictures, read_pictures, save
from lightcube.optics.grid import Grid
from lightcube.optics.transfer import Transfer, from_levels, to_uint8
from lightcube.optics.views import Views, turntable_views

RANDOM = np.random.default_rng(21)
EXACT = (".webm", ".webp", ".apng", "")
ALL = (*EXACT, ".mp4", ".gif", ".npy")
Levels = NDArray[np.uint8]


def levels(count: int = 4, rows: int = 5, columns: int = 7) -> Levels:
    """Noise, in which the second picture is the first one again: encoders like to drop such pictures."""
    noise = RANDOM.integers(0, 256, (count, rows, columns, 3), dtype=np.uint8)
    noise[1] = noise[0]
    return noise


def smooth(count: int = 12, rows: int = 65, columns: int = 97) -> Levels:
    """Pictures of more than 256 colours that change slowly in space and time."""
    t, y, x = np.meshgrid(np.arange(count), np.arange(rows), np.arange(columns), indexing="ij")
    waves = [np.sin(x / 17 + t / 3), np.cos(y / 11 - t / 4), np.sin((x + y) / 23 + t / 5)]
    return np.rint(127.5 + 120 * np.stack(waves, axis=3)).astype(np.uint8)


def views(count: int, elevation_deg: float = 20.0) -> Views:
    return turntable_views(Grid((5, 7, 7)), np.arange(count) * 31.7 + 350, elevation_deg=elevation_deg)


def files_in(folder: Path) -> list[str]:
    return sorted(item.name for item in folder.iterdir())


def read_levels(path: Path) -> Levels:
    return np.stack([to_uint8(image) for image in read_pictures(path).images])


@pytest.mark.parametrize("suffix", EXACT)
@pytest.mark.parametrize("shape", [(1, 1), (5, 7), (3, 16), (66, 33)])
def test_lossless_kinds_come_back_exactly(tmp_path: Path, suffix: str, shape: tuple[int, int]) -> None:
    wanted = levels(4, *shape)
    path = tmp_path / f"a{suffix}"
    assert save(from_levels(wanted), path) == path
    np.testing.assert_array_equal(read_levels(path), wanted)
    assert files_in(tmp_path) == [path.name]


def test_a_gif_of_few_colours_comes_back_exactly(tmp_path: Path) -> None:
    wanted = levels()
    save(from_levels(wanted), tmp_path / "a.gif")
    np.testing.assert_array_equal(read_levels(tmp_path / "a.gif"), wanted)


@pytest.mark.parametrize(("suffix", "least"), [(".mp4", 44.0), (".gif", 25.0)])
def test_lossy_kinds_keep_the_colours(tmp_path: Path, suffix: str, least: float) -> None:
    wanted = smooth()
    save(from_levels(wanted), tmp_path / f"a{suffix}")
    error = read_levels(tmp_path / f"a{suffix}").astype(float) - wanted
    assert error.shape == wanted.shape
    assert 20 * np.log10(255 / np.sqrt(np.mean(error**2))) > least
    np.testing.assert_allclose(error.mean(axis=(1, 2)), 0, atol=1.5)


def test_an_mp4_keeps_the_colours_of_single_pixels(tmp_path: Path) -> None:
    wanted = np.zeros((2, 16, 16, 3), np.uint8)
    wanted[:, ::2, ::2] = 255, 0, 0
    wanted[:, 1::2, 1::2] = 0, 0, 255
    save(from_levels(wanted), tmp_path / "a.mp4")
    assert np.max(np.abs(read_levels(tmp_path / "a.mp4").astype(int) - wanted)) < 25


@pytest.mark.parametrize(("scale", "pixels"), [(1, "yuv444p"), (2, "yuv420p"), (3, "yuv444p"), (4, "yuv420p")])
def test_an_mp4_says_which_colours_it_means(tmp_path: Path, scale: int, pixels: str) -> None:
    save(from_levels(smooth(3)), tmp_path / "a.mp4", scale=scale)
    with av.open(str(tmp_path / "a.mp4")) as container:
        context = container.streams.video[0].codec_context
        assert context.name == "h264"
        assert context.pix_fmt == pixels
        assert (context.colorspace, context.color_primaries, context.color_trc, context.color_range) == (1, 1, 13, 1)


@pytest.mark.parametrize("scale", [1, 2, 3, 4])
def test_an_mp4_comes_back_whatever_its_first_picture_is(tmp_path: Path, scale: int) -> None:
    colours = np.array([(255, 0, 0), (0, 255, 0), (0, 0, 255), (220, 30, 40), (255, 255, 255), (0, 0, 0)], np.uint8)
    wanted = colours[RANDOM.integers(0, len(colours), (5, 24, 32))]
    wanted[0] = 255
    path = save(from_levels(wanted), tmp_path / "a.mp4", scale=scale)
    enlarged = wanted.repeat(scale, 1).repeat(scale, 2).astype(float)
    with av.open(str(path)) as container:
        shown = np.stack([frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)])
    for read in (read_levels(path), shown):
        assert np.mean(np.abs(read - enlarged)) < 1.5


@pytest.mark.parametrize("suffix", [*ALL, ".png"])
def test_the_same_pictures_are_the_same_bytes(tmp_path: Path, suffix: str) -> None:
    pictures = from_levels(levels()[: 1 if suffix == ".png" else 4])

    def written(name: str) -> list[bytes]:
        save(pictures, tmp_path / name)
        files = [tmp_path / name, *(tmp_path / name).glob("*")]
        return [file.read_bytes() for file in sorted(files) if file.is_file()]

    first = written(f"a{suffix}")
    assert first
    assert written(f"b{suffix}") == first


@pytest.mark.parametrize("suffix", ["", ".png", ".apng"])
def test_pngs_say_that_they_are_srgb(tmp_path: Path, suffix: str) -> None:
    save(from_levels(levels()[: 1 if suffix == ".png" else 3]), tmp_path / f"a{suffix}")
    save(levels()[0], tmp_path / "single.png")
    files = list((tmp_path / "a").iterdir()) if not suffix else [tmp_path / f"a{suffix}"]
    for file in (*files, tmp_path / "single.png"):
        assert file.read_bytes().index(b"\0\0\0\x01sRGB") < file.read_bytes().index(b"IDAT")


@pytest.mark.parametrize("suffix", [".webm", ".webp", ".apng", ".mp4", ".gif"])
@pytest.mark.parametrize("fps", [7.0, 30.0, 29.97])
def test_movies_have_the_asked_speed(tmp_path: Path, suffix: str, fps: float) -> None:
    path = tmp_path / f"a{suffix}"
    save(from_levels(levels(6)), path, fps=fps)
    if suffix == ".webp":
        with Image.open(path) as image:
            delays = []
            for index in range(6):
                image.seek(index)
                image.load()
                delays.append(image.info["duration"])
        times = np.cumsum([0, *delays[:-1]]) / 1000
    else:
        with av.open(str(path)) as container:
            times = np.array([frame.time for frame in container.decode(video=0)], dtype=np.float64)
    np.testing.assert_allclose(times - times[0], np.arange(6) / fps, atol=0.0051 if suffix == ".gif" else 0.0011)


def test_a_pipe_is_refused_and_no_folder_is_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for path in ("-", Path("-")):
        with pytest.raises(InputError, match=r"^- is no name"):
            save(from_levels(levels()), path)
    assert files_in(tmp_path) == []


def test_a_gif_faster_than_browsers_play_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="at most 50 pictures a second"):
        save(from_levels(levels()), tmp_path / "a.gif", fps=51)


def test_a_gif_slower_than_its_delays_is_refused(tmp_path: Path) -> None:
    save(from_levels(levels()), tmp_path / "a.gif", fps=1 / 655)
    with av.open(str(tmp_path / "a.gif")) as container:
        assert [frame.time for frame in container.decode(video=0)] == [0, 655, 1310, 1965]
    with pytest.raises(InputError, match="at most 655 seconds, not 656:"):
        save(from_levels(levels()), tmp_path / "b.gif", fps=1 / 656)


def test_a_gif_of_many_colours_has_one_palette(tmp_path: Path) -> None:
    save(from_levels(smooth()), tmp_path / "a.gif")
    assert len(np.unique(read_levels(tmp_path / "a.gif").reshape(-1, 3), axis=0)) <= 256


@pytest.mark.parametrize("transfer", ["srgb", "linear"])
def test_levels_follow_the_transfer(tmp_path: Path, transfer: Transfer) -> None:
    light = RANDOM.random((2, 3, 5, 3), dtype=np.float32)
    save(light, tmp_path / "a.webm", transfer=transfer)
    shown = np.stack(read_pictures(tmp_path / "a.webm", transfer="linear").images)
    np.testing.assert_array_equal(np.rint(shown * 255), to_uint8(light, transfer))


@pytest.mark.parametrize("suffix", ALL)
def test_scale_makes_squares_of_pixels(tmp_path: Path, suffix: str) -> None:
    small = from_levels(levels(3))
    save(small, tmp_path / f"a{suffix}", scale=3)
    save(np.kron(small, np.ones((1, 3, 3, 1), np.float32)), tmp_path / f"b{suffix}")
    if suffix == ".npy":
        np.testing.assert_array_equal(np.load(tmp_path / "a.npy"), np.load(tmp_path / "b.npy"))
    else:
        np.testing.assert_array_equal(read_levels(tmp_path / f"a{suffix}"), read_levels(tmp_path / f"b{suffix}"))


def test_npy_is_never_clipped_and_bit_exact(tmp_path: Path) -> None:
    light = RANDOM.normal(0.5, 3, (3, 5, 7, 4)).astype(np.float32)
    save(light, tmp_path / "a.npy")
    read = np.load(tmp_path / "a.npy")
    assert read.dtype == np.float32
    np.testing.assert_array_equal(read.view(np.uint32), light.view(np.uint32))


@pytest.mark.parametrize("suffix", [suffix for suffix in ALL if suffix != ".npy"])
def test_clipped_values_are_counted_once(tmp_path: Path, suffix: str) -> None:
    light = np.full((3, 5, 7, 3), 0.5, np.float32)
    light[0, 0, 0] = 1.1
    light[2, 4, 6, 1] = -0.1
    light[1] = 1.0000001  # rounds to white: not worth a word
    with pytest.warns(ClippedPictures, match=r"^4 of 315 values") as caught:
        save(light, tmp_path / f"a{suffix}")
    assert len(caught) == 1
    assert caught[0].filename == __file__


@pytest.mark.parametrize("suffix", [*EXACT, ".npy"])
def test_display_levels_are_written_as_they_are(tmp_path: Path, suffix: str) -> None:
    wanted = levels(3)
    save(wanted, tmp_path / f"a{suffix}")
    if suffix == ".npy":
        np.testing.assert_array_equal(np.load(tmp_path / "a.npy"), from_levels(wanted))
    else:
        np.testing.assert_array_equal(read_levels(tmp_path / f"a{suffix}"), wanted)


def test_a_folder_holds_its_views(tmp_path: Path) -> None:
    wanted = levels(11)
    names = ['"quoted"', "back\\slash", "tab\tnew\nline", "\x7f", "ünï 日本 🎈", *"678901"]
    save(from_levels(wanted), tmp_path / "a", views=views(11), names=names)
    assert files_in(tmp_path / "a") == [*(f"{index:02d}.png" for index in range(1, 12)), "views.toml"]
    read = read_pictures(tmp_path / "a")
    assert read.angles_deg is not None
    np.testing.assert_array_equal(read.angles_deg, views(11).angles_deg)
    assert read.elevation_deg == views(11).elevations_deg[0]
    assert read.names == tuple(names)


def test_a_folder_without_views_has_no_views_file(tmp_path: Path) -> None:
    save(from_levels(levels(2)), tmp_path / "a")
    assert files_in(tmp_path / "a") == ["1.png", "2.png"]


def test_views_that_the_file_cannot_hold_are_refused(tmp_path: Path) -> None:
    low, high = views(2, 10), views(2, 20)
    mixed = Views(
        np.concatenate([low.lamps[:1], high.lamps[:1]]),
        low.origins_mm,
        low.column_steps_mm,
        low.row_steps_mm,
        low.picture_shape,
    )
    near = replace(low, lamps=low.lamps + np.array([0, 0, 0, 1]))
    for wrong in (mixed, near):
        with pytest.raises(InputError, match="one elevation"):
            save(from_levels(levels(2)), tmp_path / "a", views=wrong)
    assert files_in(tmp_path) == []


def test_a_stream_is_taken_one_picture_at_a_time(tmp_path: Path) -> None:
    wanted = from_levels(levels(6))
    alive: set[int] = set()

    class Watched(np.ndarray):
        def __del__(self) -> None:
            alive.discard(id(self))

    def stream() -> Iterator[NDArray[np.float32]]:
        for picture in wanted:
            # The one in hand and the one before, which loop variables still hold.
            assert len(alive) <= 2
            watched = picture.copy().view(Watched)
            alive.add(id(watched))
            yield watched
            del watched

    for suffix in ALL:
        save(stream(), tmp_path / f"a{suffix}", count=6)
        if suffix != ".npy":
            assert len(read_pictures(tmp_path / f"a{suffix}")) == 6


@pytest.mark.parametrize("suffix", ALL)
@pytest.mark.parametrize("count", [3, 5])
def test_a_wrong_count_leaves_nothing(tmp_path: Path, suffix: str, count: int) -> None:
    with pytest.raises(InputError, match="announced"):
        save(iter(from_levels(levels(4))), tmp_path / f"a{suffix}", count=count)
    assert files_in(tmp_path) == []


def test_a_stream_needs_a_count(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="count"):
        save(iter(from_levels(levels())), tmp_path / "a.gif")


@pytest.mark.parametrize("suffix", ALL)
@pytest.mark.parametrize("old", [False, True])
@pytest.mark.parametrize(
    ("raised", "caught"),
    [(KeyboardInterrupt(), KeyboardInterrupt), (OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)), InputError)],
    ids=["Ctrl-C", "a full disk"],
)
def test_a_stream_that_breaks_off_leaves_the_old_state(
    tmp_path: Path, suffix: str, old: bool, raised: BaseException, caught: type[BaseException]
) -> None:
    path = tmp_path / f"a{suffix}"
    if old:
        save(from_levels(levels(2)), path)
    before = {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()}

    def stream() -> Iterator[NDArray[np.float32]]:
        yield from from_levels(levels(3))
        raise raised

    with pytest.raises(caught):
        save(stream(), path, count=4, overwrite=old)
    assert {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()} == before
    assert files_in(tmp_path) == [path.name] * old


def test_bad_input_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    light = from_levels(levels(2))
    for fps in (0, -1, float("inf"), 1e9):
        with pytest.raises(InputError, match="pictures per second"):
            save(light, tmp_path / "a.gif", fps=fps)
    for scale in (0, -1, 1.5):
        with pytest.raises(InputError, match="scale"):
            save(light, tmp_path / "a.gif", scale=scale)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="0 pictures"):
        save(light[:0], tmp_path / "a.gif")
    with pytest.raises(InputError, match="3 views for 2 pictures"):
        save(light, tmp_path / "a", views=views(3))
    with pytest.raises(InputError, match="1 names for 2 pictures"):
        save(light, tmp_path / "a", names=["x"])
    with pytest.raises(InputError, match="three colour channels, not 4"):
        save(np.zeros((2, 3, 5, 4), np.float32), tmp_path / "a.gif")
    for bad in (np.nan, np.inf):
        with pytest.raises(InputError, match="picture number 2 holds NaN"):
            save(np.stack([light[0], light[1] * 0 + bad]), tmp_path / "a.npy")
    assert files_in(tmp_path) == []


def test_what_a_codec_cannot_do_is_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"a\.mp4 cannot be encoded"):
        save(np.zeros((2, 1, 40000, 3), np.float32), tmp_path / "a.mp4")
    with pytest.raises(InputError, match="at most 16383 pixels"):
        save(np.zeros((2, 1, 20000, 3), np.float32), tmp_path / "a.webp")
    assert files_in(tmp_path) == []


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    wanted=st_numpy.arrays(np.uint8, st.tuples(st.integers(2, 4), st.integers(1, 9), st.integers(1, 9), st.just(3))),
    suffix=st.sampled_from(EXACT),
)
def test_any_pictures_come_back(tmp_path: Path, wanted: Levels, suffix: str) -> None:
    path = tmp_path / f"a{suffix}"
    save(from_levels(wanted), path, overwrite=True)
    np.testing.assert_array_equal(read_levels(path), wanted)


def test_what_systems_leave_in_a_folder_of_pictures_does_not_keep_it(tmp_path: Path) -> None:
    pictures = np.full((2, 3, 4, 3), 0.5, np.float32)
    save(pictures, tmp_path / "a")
    (tmp_path / "a" / "1.png").rename(tmp_path / "a" / "1.PNG")
    for name in (".DS_Store", "Thumbs.db", "desktop.ini", "._1.png"):
        (tmp_path / "a" / name).write_bytes(b"x")
    save(pictures, tmp_path / "a", overwrite=True)
    assert files_in(tmp_path / "a") == ["1.png", "2.png"]
    (tmp_path / "a" / ".git").mkdir()
    with pytest.raises(InputError, match="folder of something else"):
        save(pictures, tmp_path / "a", overwrite=True)


GREY = np.full((2, 3, 4, 3), 0.5, np.float32)


@pytest.mark.parametrize("name", ["a", "a.npy", "a.gif"])
@pytest.mark.parametrize(
    "wrong",
    [GREY * 1j, GREY.astype(object), GREY.astype(str), [GREY[0], [[1, 2], [3]]], [GREY[0], None], ["a", "b"]],
    ids=["complex", "objects", "texts", "ragged", "none", "words"],
)
def test_pictures_are_real_numbers(tmp_path: Path, name: str, wrong: Any) -> None:
    with pytest.raises(InputError, match=r"^picture number [12] does not hold real numbers but"):
        save(wrong, tmp_path / name)
    assert files_in(tmp_path) == []


def test_lists_are_pictures_and_what_has_no_length_needs_a_count(tmp_path: Path) -> None:
    save(GREY.tolist(), tmp_path / "a.npy")
    np.testing.assert_array_equal(np.load(tmp_path / "a.npy"), GREY)
    with pytest.raises(InputError, match="one by one need a count"):
        save(iter(GREY), tmp_path / "b.npy")
