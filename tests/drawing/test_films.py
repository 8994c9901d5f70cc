"""Movies: how the lamp comes and goes, what flickers, and frames in which a picture stands large."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest
from numpy.typing import NDArray

import lightcube as lc
from lightcube.backward.mat import margin
from lightcube.drawing import films, shows
from lightcube.drawing.orbit import lamps_orbit
from lightcube.drawing.poster import SIZES, mat_pixels, poster
from lightcube.drawing.room import Room
from lightcube.drawing.tableau import Tableau
from lightcube.errors import InputError
from lightcube.forward.dimming import Course, dimmed
from lightcube.forward.flicker import Flicker
from lightcube.io import movies
from lightcube.optics.transfer import Transfer, decode, encode, to_uint8

GRID = lc.Grid((8, 10, 12), 2.0)
Levels = NDArray[np.uint8]


def noisy(angles_deg: list[float], **options: Any) -> lc.Cube:
    """A cube whose shadows have nothing to do with each other, under a strong lamp."""
    rig = lc.turntable(GRID, angles_deg, elevation_deg=20.0, picture_shape=(4, 6), **options)
    extinction = 3 * (np.random.default_rng(3).random((3, *GRID.shape)) < 0.1).astype(np.float32)
    return lc.Cube(extinction, GRID, rig, lamp_powers=np.full((len(angles_deg), 3), 2.0))


def frames_of(film: films.Film) -> Levels:
    return np.stack([f if f.dtype == np.uint8 else to_uint8(np.asarray(f, np.float32)) for f in film])


def flashes(frames: Levels, fps: float) -> int:
    """The most flashes within a second of any 4 x 4 block: pairs of opposite changes of a tenth of the range."""
    rows, columns = (size // 4 for size in frames.shape[1:3])
    blocks = frames[:, : 4 * rows, : 4 * columns].mean(axis=3).reshape(len(frames), rows, 4, columns, 4)
    light = blocks.mean(axis=(2, 4))
    most = 0
    for series in light.reshape(len(frames), -1).T:
        turns, way, last = list[int](), 0, series[0]
        for number, value in enumerate(series):
            if way and (value - last) * way > 0:
                last = value
            elif abs(value - last) >= 25.5:
                turns, way, last = [*turns, number], (1 if value > last else -1), value
        most = max(most, *(sum(t <= u < t + fps for u in turns) for t in turns), 0) if turns else most
    return most // 2


@pytest.mark.parametrize("stops", [1, 3, 70])
@pytest.mark.parametrize("fps", [10.0, 30.0, 60.0])
def test_a_course_begins_and_ends_in_the_dark_and_rests_between(stops: int, fps: float) -> None:
    course = Course.of(stops, fps)
    lamp = np.array(course.lamp)
    assert lamp[0] == lamp[-1] == 0
    assert (np.sum(lamp == 1), len(lamp)) == (course.rest, 2 * course.fade + course.rest + course.dark)
    assert np.max(np.abs(np.diff(np.tile(lamp, 2)))) < 0.2
    assert course.seconds > 1 / 3 * 3
    if stops < 4:
        assert course.rest == fps
    else:
        assert stops * course.seconds < 120


def test_a_strong_lamp_fades_more_slowly() -> None:
    assert [Course.of(3, 30, bright).fade for bright in (1.0, 5.0, 99.0)] == [18, 26, 45]


@pytest.mark.parametrize("transfer", ["srgb", "linear"])
def test_what_is_dimmed_is_the_light_times_the_lamp(transfer: Transfer) -> None:
    light = np.random.default_rng(1).exponential(0.6, (3, 5, 7, 3)).astype(np.float32)
    course = Course(4, 2, 3, 30.0)
    shown = list(dimmed(iter(light), course, transfer))
    assert len(shown) == 3 * len(course.lamp)
    for number, levels in enumerate(shown):
        part = decode(np.array(course.lamp[number % len(course.lamp)]), transfer)
        wanted = to_uint8(light[number // len(course.lamp)] * part, transfer)
        assert np.max(np.abs(levels.astype(int) - wanted)) <= 1
        assert np.mean(levels != wanted) < 0.04


def test_a_film_rests_on_whole_screens_and_does_not_flicker() -> None:
    cube = noisy([20.0, 100.0, 290.0])
    film = lc.film(cube)
    loop = frames_of(film)
    course = Course.of(3, 30.0, shows.brightest(cube))
    assert len(loop) == len(film) == 3 * len(course.lamp)
    np.testing.assert_array_equal(loop[0], loop[-1])
    frames = np.roll(loop, course.fade + course.rest // 2, axis=0)
    assert not frames[0].any()
    assert not frames[-1].any()
    for stop, wanted in enumerate(to_uint8(lc.play(cube))):
        start = stop * len(course.lamp) + course.fade
        assert np.max(np.abs(frames[start : start + 30].astype(int) - wanted)) <= 1
    jumps = np.max(np.abs(np.diff(loop.astype(int), axis=0)), axis=3) >= 51
    assert film.flicker.share == pytest.approx(np.mean(jumps), abs=1e-9)
    assert film.flicker.share <= 0.03
    assert film.warning == ""
    assert flashes(np.concatenate([loop, loop]), 30.0) <= 1
    assert "rests for 1 s" in film.said


def test_an_even_turn_of_unlike_pictures_is_told() -> None:
    film = lc.film(noisy([20.0, 100.0, 290.0]), even=True)
    frames = frames_of(film)
    assert len(frames) == 120
    assert film.said == ""
    assert film.flicker.share > 0.03
    assert "flickers" in film.warning
    assert "leave out --even" in film.warning


def test_flashes_are_counted() -> None:
    blinking = np.zeros((30, 8, 8, 3), np.uint8)
    blinking[::6] = 255
    assert (flashes(blinking, 30.0), flashes(blinking, 12.0)) == (4, 2)


def test_pictures_that_flow_into_each_other_turn_evenly() -> None:
    rig = lc.turntable(GRID, [20.0, 100.0], elevation_deg=20.0, picture_shape=(4, 6))
    cube = lc.Cube(np.full((3, *GRID.shape), 0.02, np.float32), GRID, rig)
    film = lc.film(cube)
    assert len(frames_of(film)) == 120
    assert film.warning == ""
    assert film.flicker.share <= 0.03
    assert "flow into each other" in film.said


def test_unlike_pictures_rest_however_softly_one_becomes_the_other() -> None:
    """The wall is dark on one side at one stop, on the other at the other; nothing jumps on the way."""
    rig = lc.turntable(GRID, [0.0, 180.0], elevation_deg=20.0, picture_shape=(4, 6))
    extinction = np.zeros((3, *GRID.shape), np.float32)
    extinction[...] = np.linspace(0.1, 0, GRID.shape[1])[:, None]
    film = lc.film(lc.Cube(extinction, GRID, rig), picture_only=True)
    assert "rests for 1 s" in film.said
    assert shows.flickers(lc.Cube(extinction, GRID, rig), np.arange(0, 360, 3.0), shows.Look(True)) <= 0.03


def test_where_nothing_turns_the_one_stop_fades_in_and_out() -> None:
    sun, wall = lc.Lamp("sun", (1, 0, -0.2)), lc.Screen("wall", (60, 0, -9), (20, 16), 4.0)
    stage = lc.Stage(GRID, (sun,), (wall,), (lc.Shot("a", "wall", ("sun",)),), cube_turns=False)
    film = lc.film(lc.Cube(noisy([5.0]).extinction, GRID, stage.rig()))
    frames = frames_of(film)
    dark = [number for number, frame in enumerate(frames) if not frame.any()]
    assert (dark, len(film)) == (list(range(15 + 17, 15 + 18 + 8 + 1)), 18 + 30 + 18 + 8)
    assert "on the one stop" in film.said


def test_a_room_rests_first() -> None:
    cube = noisy([20.0, 140.0])
    film = films.filmed(cube, shows.Look(), films.Style((30, 54), fps=10, view="room"), cube.angles_deg, even=False)
    frames = frames_of(film)
    room = Tableau(cube, (30, 54))
    np.testing.assert_array_equal(frames[0], to_uint8(room.seen(20.0)))
    np.testing.assert_array_equal(frames[-1], frames[0])
    assert len(frames) == len(film)


def test_an_eye_goes_from_the_dark_room_to_the_lamp_where_the_picture_rests() -> None:
    cube, style = noisy([20.0, 140.0]), films.Style((54, 96), fps=10, view="eye")
    film = films.filmed(cube, shows.Look(), style, cube.angles_deg, even=False)
    frames = frames_of(film)
    assert len(frames) == len(film)
    assert frames[0].mean() > 10
    frames = np.roll(frames, Course.of(1, 10).fade, axis=0)
    assert not np.any(frames[0])
    assert not np.any(frames[-1])
    assert not film.flicker.is_much
    assert flashes(frames, 10) <= 3
    rest = frames[-20]
    assert sum(np.array_equal(frame, rest) for frame in frames) >= 14
    room = Room(cube)
    camera = lamps_orbit(*room.eyes_lamp(20.0), (54, 96)).camera((54, 96))
    np.testing.assert_array_equal(rest, to_uint8(room.from_lamp(camera, 20.0)))
    assert len(films.to_the_lamp(cube, style, cube.angles_deg)) == 2 * len(film)


def test_a_tableau_has_the_room_and_the_wall_as_it_is() -> None:
    cube, size = noisy([20.0, 140.0]), (90, 160)
    shown = lc.play(cube, [20.0], picture_only=True)[0]
    tableau = Tableau(cube, size)
    lit, unlit = tableau.seen(20.0), tableau.seen(20.0, lit=False)
    wide = round(0.36 * 160)  # the wall's part; the picture, of 4 x 6 pixels, fills 0.84 of it
    pixel = 0.84 * wide / 6
    for row, column in np.ndindex(4, 6):
        y, x = 45 + (row - 1.5) * pixel, 160 - wide / 2 + (column - 2.5) * pixel
        np.testing.assert_allclose(lit[int(y), int(x)], np.clip(shown[row, column], 0, 1), atol=0.12)
    assert np.ptp(unlit[40:50, -40:-20], axis=(0, 1)).max() < 0.01
    assert Tableau(cube, (160, 90)).seen(20.0).shape == (160, 90, 3)


def test_flicker_counts_what_jumps_by_a_fifth() -> None:
    dark, part = np.zeros((10, 10, 3), np.uint8), np.zeros((10, 10, 3), np.uint8)
    part[:3, :, 1], part[3:5, :, 2] = 51, 50
    flicker = Flicker()
    assert (flicker.share, flicker.is_much) == (0.0, False)
    for frame in (dark, part, part):
        flicker.see(frame)
    assert flicker.share == pytest.approx(0.15)
    assert flicker.is_much


def lit_box(frame: NDArray[np.floating[Any]]) -> tuple[int, int, int, int]:
    """First and last row and column on which any light is."""
    rows, columns = (np.flatnonzero(frame.any(axis=axis)) for axis in ((1, 2), (0, 2)))
    return int(rows[0]), int(rows[-1]), int(columns[0]), int(columns[-1])


SHAPES = [(8, 8), (5, 13), (19, 4)]


@pytest.mark.parametrize("mat", [False, True])
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("size", SIZES.values())
def test_nothing_around_a_picture_is_lit_and_all_of_it_is_seen(
    size: tuple[int, int], shape: tuple[int, int], mat: bool
) -> None:
    """Whatever stands around it, however bright; a mat only as far as it is shown, which is within the frame."""
    small, (rows, columns) = (size[0] // 4, size[1] // 4), shape
    picture = np.full((40, 31, 3), 5.0, np.float32)
    picture[9 : 9 + rows, 5 : 5 + columns] = (0.5, 0.2, 0.7)
    wide = mat_pixels(shape) if mat else 0
    scale = 0.8 * min(small[0] / (rows + 2 * wide), small[1] / (columns + 2 * wide))
    frame = poster(picture, np.array([9, 5, rows, columns]), small, "srgb", mat=mat)
    assert frame.shape == (*small, 3)

    down, across = (np.abs(np.arange(count) + 0.5 - count / 2) for count in small)
    beyond_down, beyond_across = down[:, None] - scale * rows / 2, across - scale * columns / 2
    beyond = np.maximum(beyond_down, beyond_across)
    assert np.mean(frame[beyond > scale * wide + 1]) == 0
    within = frame[beyond < -(2 * scale if mat else 1)]  # a mat's light is smoothly enlarged, too
    np.testing.assert_allclose(within, np.broadcast_to((0.5, 0.2, 0.7), within.shape), rtol=2e-3)
    assert np.all(frame[beyond < -1] > 0.05)
    if mat:
        ring = frame[(beyond > 0.3 * scale * wide) & (beyond < 0.4 * scale * wide)]
        assert ring.max() > 0.3
        rim = np.hypot(np.maximum(beyond_down, 0), np.maximum(beyond_across, 0)) > scale * wide + 1
        assert not frame[rim].any()


@pytest.mark.parametrize("mat", [False, True])
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("size", [(320, 180), (180, 320), (200, 200)])
def test_a_caption_stands_whole_in_the_black_below(size: tuple[int, int], shape: tuple[int, int], mat: bool) -> None:
    bright, window = np.full((40, 31, 3), 5.0, np.float32), np.array([9, 5, *shape])
    bare, named = (poster(bright, window, size, "srgb", name, mat=mat) for name in ("", "gj moon ÅÉ"))
    top, bottom, left, right = lit_box(bare)
    np.testing.assert_array_equal(named[: bottom + 1], bare[: bottom + 1])
    first, last, begin, end = lit_box(named[bottom + 1 :])
    assert (first > 0, last < size[0] - bottom - 2, begin > 0, end < size[1] - 1) == (True, True, True, True)
    assert (top > 0, left > 0, right < size[1] - 1) == (True, True, True)


@pytest.mark.parametrize("name", ["a", "a_very " * 2000, "<b>", "שלום", "\n\t", "日本"])
def test_captions_are_one_line_in_the_frame(name: str) -> None:
    black = np.zeros((30, 20, 3), np.float32)
    frame = poster(black, np.array([9, 5, 8, 8]), (180, 320), "srgb", name)
    lit = np.argwhere(frame[..., 0] > 0.1)
    if name.strip():
        assert lit[:, 0].min() > 90 + 0.5 * 0.8 * 180
        assert (lit[:, 0].max() < 180, lit[:, 1].min() > 9, lit[:, 1].max() < 311) == (True, True, True)
        assert 0.6 < float(encode(frame.max(keepdims=True)).item()) <= 0.75 + 1e-6
    else:
        assert not len(lit)


@pytest.mark.parametrize(
    ("mat", "noise", "calm"),
    [
        (None, 0.0, False),
        (lc.Mat(0.5), 0.1, True),
        (lc.Mat(0.5), 0.3, False),
        (lc.Mat(0.02), 0.02, False),
        (lc.Mat(0.02), 0.0, True),
        (lc.Mat(0.5, width=0.01), 0.0, False),
    ],
)
def test_a_mat_is_seen_where_there_is_one_and_it_is_calm(
    monkeypatch: pytest.MonkeyPatch, mat: lc.Mat | None, noise: float, calm: bool
) -> None:
    """Only what a poster shows of it counts: neither the picture nor what lies beyond."""

    def cast(cube: lc.Cube, rig: lc.Rig) -> Iterator[NDArray[np.float32]]:
        assert mat is not None
        (rows, columns), (high, wide) = margin(rig_of, GRID, mat), rig_of.picture_shape
        for sign in (1, -1):
            shown = np.full((*rig.picture_shape, 3), 4.0)
            shown[rows - 1 : rows + high + 1, columns - 1 : columns + wide + 1] = decode(
                np.array(max(mat.tone + sign * noise, 0.0)), cube.transfer
            )
            shown[rows : rows + high, columns : columns + wide] = 3.0
            yield shown.astype(np.float32)

    plain = noisy([20.0, 140.0])
    rig_of = plain.rig
    recipe = lc.Recipe(mat=mat)
    cube = lc.Cube(plain.extinction, GRID, rig_of, provenance=recipe.plain())
    monkeypatch.setattr("lightcube.forward.casting.cast", cast)
    assert shows.has_calm_mat(cube) is calm


def test_captions_say_names_without_the_numbers_of_files() -> None:
    cube = lc.Cube(noisy([1.0, 2.0]).extinction, GRID, noisy([1.0, 2.0]).rig, names=("07-a_cat", "1984"))
    assert shows.captions_of(cube, cube.angles_deg) == ["a cat", "1984"]


def test_captions_want_a_format() -> None:
    with pytest.raises(InputError, match="give a format too"):
        lc.film(noisy([3.0]), captions=True)


@pytest.mark.parametrize("format", SIZES)
def test_formats_are_small_files_that_a_second_decoder_reads(tmp_path: Path, format: Any) -> None:  # noqa: A002
    film = lc.film(noisy([20.0]), format=format, captions=True, fps=3)
    path = lc.save(film, tmp_path / "a.mp4", fps=3, shared=True)
    flicker, bright = Flicker(), list[float]()
    with av.open(str(path)) as container:
        context = container.streams.video[0].codec_context
        assert (context.height, context.width, context.pix_fmt) == (*SIZES[format], "yuv420p")
        assert (context.colorspace, context.color_primaries, context.color_trc, context.color_range) == (1, 1, 13, 1)
        for frame in container.decode(video=0):
            shown = np.asarray(frame.to_ndarray(format="rgb24"), np.uint8)
            flicker.see(shown)
            bright.append(float(shown.max()))
    assert len(bright) == len(film) == 6 + 3 + 6 + 1
    assert min(bright) <= 2
    assert min(bright[0], bright[-1]) > 150
    assert flicker.share <= 0.03
    assert path.stat().st_size / (len(bright) / 3) < 700_000


def test_an_mp4_to_be_sent_is_small_even_of_noise(tmp_path: Path) -> None:
    frames = np.random.default_rng(2).integers(0, 255, (30, 300, 401, 3), np.uint8)
    sizes = [lc.save(frames, tmp_path / f"{way}.mp4", fps=30, shared=way).stat().st_size for way in (False, True)]
    assert sizes[0] > 2_000_000
    assert sizes[1] < 700_000


def test_a_gif_to_be_sent_becomes_smaller_until_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    frames = np.random.default_rng(2).integers(0, 255, (5, 200, 150, 3), np.uint8)
    frames[2] = frames[1]
    monkeypatch.setattr("lightcube.io.movies.SHARED_GIF", 60_000)
    with pytest.warns(movies.SmallerPictures, match=r"at 150 x 200 pixels and has \d+ x \d+: write .mp4"):
        path = lc.save(frames, tmp_path / "a.gif", fps=5, shared=True)
    assert path.stat().st_size <= 60_000
    with av.open(str(path)) as container:
        shown = list(container.decode(video=0))
    assert [frame.time for frame in shown] == [0.0, 0.2, 0.6, 0.8]  # what stands still is one picture that stays
    assert shown[0].width / shown[0].height == pytest.approx(0.75, abs=0.02)
    assert min(shown[0].width, shown[0].height) > 40
