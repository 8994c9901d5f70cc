"""Films: their pictures are what a player shows, and what they do not say is not guessed in silence."""

import io
import struct
from collections.abc import Callable, Iterable
from fractions import Fraction
from pathlib import Path
from typing import cast

import av
import numpy as np
import pytest
from av.stream import Disposition
from numpy.typing import NDArray
from PIL import Image

from lightcube.errors import InputError
from lightcube.io import ChangedPictures, TransparentPictures, read_pictures, save
from lightcube.optics.transfer import from_levels, to_uint8

Levels = NDArray[np.uint8]
Reals = NDArray[np.float64]

RANDOM = np.random.default_rng(22)
#: Saturated and plain colours: a wrong matrix or range shows in each.
COLOURS = np.array(
    [(220, 30, 40), (30, 180, 60), (40, 60, 210), (240, 220, 30), (255, 255, 255), (0, 0, 0), (90, 90, 90)]
)
#: Weights of red and blue in the brightness, by the code of the matrix.
WEIGHTS = {1: (0.2126, 0.0722), 4: (0.30, 0.11), 5: (0.299, 0.114), 6: (0.299, 0.114), 7: (0.212, 0.087)}
WEIGHTS |= {9: (0.2627, 0.0593)}


def film(
    path: Path,
    frames: Iterable[av.VideoFrame],
    codec: str = "ffv1",
    *,
    aspect: Fraction | None = None,
    tags: tuple[int, int, int, int] = (2, 0, 2, 2),
    said: dict[str, str] | None = None,
    options: dict[str, str] | None = None,
    layout: str = "",
) -> Path:
    """Frames as they are, with tags of matrix, range, primaries and curve."""
    stream: av.VideoStream | None = None
    with av.open(str(path), "w", options={"movflags": layout} if layout else {}) as container:
        for frame in frames:
            frame.colorspace, frame.color_range, frame.color_primaries, frame.color_trc = tags
            if stream is None:
                stream = cast("av.VideoStream", container.add_stream(codec, rate=10, options=options or {}))
                stream.width, stream.height, stream.pix_fmt = frame.width, frame.height, frame.format.name
                context = stream.codec_context
                context.colorspace, context.color_range, context.color_primaries, context.color_trc = tags
                stream.metadata.update(said or {})
                if aspect:
                    context.sample_aspect_ratio = aspect
            container.mux(stream.encode(frame))
        assert stream is not None
        container.mux(stream.encode())
    return path


def rgb(picture: Levels) -> av.VideoFrame:
    return av.VideoFrame.from_ndarray(picture, format="rgb24")


def coded(display: Reals, matrix: int, *, full: bool, bits: int) -> av.VideoFrame:
    """Display values ``(row, column, 3)``, 1 = white, as brightness and two colours in 4:4:4, by the formula."""
    red, blue = WEIGHTS[matrix]
    y = display @ np.array([red, 1 - red - blue, blue])
    u, v = (display[..., 2] - y) / (2 * (1 - blue)), (display[..., 0] - y) / (2 * (1 - red))
    step, most = 2 ** (bits - 8), 2**bits - 1
    planes = [y * most, u * most, v * most] if full else [(16 + 219 * y) * step, 224 * u * step, 224 * v * step]
    levels = np.stack([planes[0], *(plane + 128 * step for plane in planes[1:])])
    whole = np.clip(np.rint(levels), 0, most).astype(np.uint8 if bits == 8 else np.uint16)
    if bits == 8:
        return av.VideoFrame.from_ndarray(whole, format="yuv444p")
    return av.VideoFrame.from_ndarray(np.moveaxis(whole, 0, -1).copy(), format="yuv444p16le")


def squares(rows: int = 32, columns: int = 48, size: int = 8) -> Levels:
    """Squares of some colours."""
    few = COLOURS[RANDOM.integers(0, len(COLOURS), (-(-rows // size), -(-columns // size)))]
    return few.repeat(size, 0).repeat(size, 1)[:rows, :columns].astype(np.uint8)


def read(path: Path, least: int = 1) -> list[Levels]:
    return [to_uint8(image) for image in read_pictures(path, least=least).images]


def off(shown: Levels, wanted: Levels) -> int:
    assert shown.shape == wanted.shape
    return int(np.max(np.abs(shown.astype(int) - wanted)))


class TestColours:
    @pytest.mark.parametrize("bits", [8, 16])
    @pytest.mark.parametrize("full", [False, True])
    @pytest.mark.parametrize("matrix", list(WEIGHTS))
    def test_a_film_has_its_own_matrix_and_range(self, tmp_path: Path, matrix: int, full: bool, bits: int) -> None:
        wanted = squares()
        frame = coded(wanted / 255, matrix, full=full, bits=bits)
        path = film(tmp_path / "a.mkv", [frame], tags=(matrix, 2 if full else 1, 1, 1))
        assert off(read(path)[0], wanted) <= 2

    @pytest.mark.parametrize(("shape", "matrix"), [((576, 720), 5), ((720, 1280), 1), ((32, 1280), 1), ((578, 48), 1)])
    def test_a_film_that_says_nothing_is_of_its_size(self, tmp_path: Path, shape: tuple[int, int], matrix: int) -> None:
        wanted = squares(*shape)
        path = film(tmp_path / "a.mkv", [coded(wanted / 255, matrix, full=False, bits=8)])
        assert off(read(path)[0], wanted) <= 2

    def test_colours_that_are_not_read_are_refused(self, tmp_path: Path) -> None:
        frame = coded(squares() / 255, 1, full=True, bits=8)
        path = film(tmp_path / "a.mkv", [frame], tags=(8, 2, 1, 1))
        with pytest.raises(InputError, match=r"a\.mkv has colours of a kind that is not read"):
            read(path)

    @pytest.mark.parametrize("codec", ["libvpx", "libvpx-vp9"])
    @pytest.mark.parametrize("suffix", [".webm", ".mkv"])
    def test_transparent_films_are_put_on_white(self, tmp_path: Path, suffix: str, codec: str) -> None:
        picture = np.full((32, 48, 4), 255, np.uint8)
        picture[..., :3] = COLOURS[0]
        picture[:, :24, 3] = 0
        frame = av.VideoFrame.from_ndarray(picture, format="rgba").reformat(format="yuva420p")
        options = {"auto-alt-ref": "0"}
        path = film(tmp_path / f"a{suffix}", [frame] * 3, codec, said={"alpha_mode": "1"}, options=options)
        with pytest.warns(TransparentPictures, match="3 of 3"):
            shown = read(path)
        for one in shown:
            assert off(one[:, :20], np.full((32, 20, 3), 255, np.uint8)) <= 2
            assert off(one[:, 28:], picture[:, 28:, :3]) <= 8


def pq(light: Reals) -> Reals:
    power = (np.maximum(light, 0) * 203 / 10000) ** (2610 / 16384)
    return ((3424 / 4096 + 2413 / 128 * power) / (1 + 2392 / 128 * power)) ** (2523 / 32)


def hlg(light: Reals) -> Reals:
    nits = np.maximum(light, 0) * 203 / 1000
    brightness = nits @ np.array([0.2627, 0.6780, 0.0593])
    scene = nits * np.maximum(brightness, 1e-9)[..., None] ** (1 / 1.2 - 1)
    a, b, c = 0.17883277, 0.28466892, 0.55991073
    return np.where(scene <= 1 / 12, np.sqrt(3 * scene), a * np.log(np.maximum(12 * scene - b, 1e-9)) + c)


def in_2020(light: Reals) -> Reals:
    """Linear light of sRGB's primaries in those of BT.2020 (ITU-R BT.2087)."""
    return light @ np.array([(0.6274, 0.3293, 0.0433), (0.0691, 0.9195, 0.0114), (0.0164, 0.0880, 0.8956)]).T


class TestHighDynamicRange:
    @pytest.mark.parametrize(("curve", "tagged"), [(pq, 16), (hlg, 18), (pq, 2)])
    def test_light_up_to_white_comes_back(self, tmp_path: Path, curve: Callable[[Reals], Reals], tagged: int) -> None:
        wanted = squares()
        display = curve(in_2020(from_levels(wanted).astype(np.float64)))
        path = film(
            tmp_path / "a.mkv", [coded(display, 9, full=False, bits=16)], tags=(9, 1, 2 if tagged == 2 else 9, tagged)
        )
        with pytest.warns(ChangedPictures, match=r"a\.mkv is of high dynamic range .*203 nits") as caught:
            shown = read(path)[0]
        assert len(caught) == 1
        assert off(shown, wanted) <= 6

    @pytest.mark.parametrize(("curve", "tagged"), [(pq, 16), (hlg, 18)])
    def test_what_is_brighter_than_white_keeps_its_hue(
        self, tmp_path: Path, curve: Callable[[Reals], Reals], tagged: int
    ) -> None:
        light = np.ones((16, 16, 1)) * np.array([3.0, 1.5, 0.75])
        path = film(tmp_path / "a.mkv", [coded(curve(in_2020(light)), 9, full=False, bits=16)], tags=(9, 1, 9, tagged))
        with pytest.warns(ChangedPictures):
            shown = read_pictures(path, least=1).images[0]
        np.testing.assert_allclose(shown, light / 3, atol=0.02)

    def test_wide_colours_are_brought_into_srgb(self, tmp_path: Path) -> None:
        wanted = squares()
        display = to_uint8(in_2020(from_levels(wanted).astype(np.float64)).astype(np.float32)) / 255
        path = film(tmp_path / "a.mkv", [coded(display, 9, full=False, bits=16)], tags=(9, 1, 9, 14))
        with pytest.warns(ChangedPictures, match="wide colours"):
            shown = read(path)[0]
        assert off(shown, wanted) <= 9


class TestShape:
    @pytest.mark.parametrize("mirrored", [False, True])
    @pytest.mark.parametrize("quarters", [0, 1, 2, 3])
    @pytest.mark.parametrize("suffix", [".mp4", ".mov"])
    def test_a_film_is_turned_and_mirrored_as_it_says(
        self, tmp_path: Path, suffix: str, quarters: int, mirrored: bool
    ) -> None:
        pictures = RANDOM.integers(0, 256, (2, 6, 10, 3), dtype=np.uint8)
        path = film(tmp_path / f"a{suffix}", map(rgb, pictures), "libx264rgb", options={"crf": "0"})
        cos, sin = [(1, 0), (0, 1), (-1, 0), (0, -1)][quarters]
        flip = -1 if mirrored else 1
        data = path.read_bytes()
        at = data.index(b"tkhd") + 4 + 40
        matrix = struct.pack(">9i", flip * cos << 16, flip * sin << 16, 0, -sin << 16, cos << 16, 0, 0, 0, 1 << 30)
        path.write_bytes(data[:at] + matrix + data[at + 36 :])
        for shown, picture in zip(read(path), pictures, strict=True):
            # The matrix (a b; c d) takes x to a x + c y and y to b x + d y, y down: clockwise, once it is mirrored.
            first = picture[:, ::-1] if mirrored else picture
            np.testing.assert_array_equal(shown, np.rot90(first, -quarters))

    @pytest.mark.parametrize("suffix", [".mp4", ".mkv", ".mov"])
    @pytest.mark.parametrize("aspect", [Fraction(2), Fraction(1, 2), Fraction(4, 3), Fraction(16, 15)])
    def test_oblong_pixels_become_square_and_none_is_lost(self, tmp_path: Path, aspect: Fraction, suffix: str) -> None:
        small = np.array([[(220, 30, 40), (30, 180, 60)], [(40, 60, 210), (240, 220, 30)]], np.uint8)
        picture = small.repeat(48, 0).repeat(32, 1)
        path = film(tmp_path / f"a{suffix}", [rgb(picture)], "libx264rgb", aspect=aspect, options={"crf": "0"})
        shown = read(path)[0]
        rows, columns = round(96 * max(1, float(1 / aspect))), round(64 * max(1, float(aspect)))
        assert shown.shape == (rows, columns, 3)
        for row in (0, 1):
            for column in (0, 1):
                place = shown[(1 + 2 * row) * rows // 4, (1 + 2 * column) * columns // 4]
                assert np.max(np.abs(place.astype(int) - small[row, column])) <= 1

    def test_square_pixels_are_not_touched(self, tmp_path: Path) -> None:
        picture = RANDOM.integers(0, 256, (6, 10, 3), dtype=np.uint8)
        path = film(tmp_path / "a.mp4", [rgb(picture)], "libx264rgb", aspect=Fraction(1), options={"crf": "0"})
        np.testing.assert_array_equal(read(path)[0], picture)


def with_cover(path: Path, pictures: Levels) -> Path:
    """A film with a cover behind it."""
    cover = io.BytesIO()
    Image.new("RGB", (24, 16), (255, 0, 255)).save(cover, "JPEG")
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264rgb", rate=10, options={"crf": "0"})
        stream.width, stream.height, stream.pix_fmt = pictures.shape[2], pictures.shape[1], "rgb24"
        shown = container.add_stream("mjpeg")
        shown.width, shown.height, shown.pix_fmt = 24, 16, "yuvj420p"
        value = Disposition.attached_pic.value
        setattr(shown, "disposition", value)  # noqa: B010 - PyAV 17 takes numbers, as types do not have it
        packet = av.Packet(cover.getvalue())
        packet.stream, packet.pts, packet.dts, packet.is_keyframe = shown, 0, 0, True
        container.mux(packet)
        for picture in pictures:
            container.mux(stream.encode(rgb(picture)))
        container.mux(stream.encode())
    return path


@pytest.mark.parametrize("cover_first", [False, True])
def test_a_cover_is_no_film(tmp_path: Path, cover_first: bool) -> None:
    pictures = RANDOM.integers(0, 256, (3, 6, 10, 3), dtype=np.uint8)
    path = with_cover(tmp_path / "a.mp4", pictures)
    if cover_first:
        data = path.read_bytes()
        track, cover = data.rindex(b"trak") - 4, data.rindex(b"udta") - 4
        behind = cover + int.from_bytes(data[cover : cover + 4], "big")
        path.write_bytes(data[:track] + data[cover:behind] + data[track:cover] + data[behind:])
    np.testing.assert_array_equal(np.stack(read(path)), pictures)


class TestInterlaced:
    @staticmethod
    def comb() -> list[av.VideoFrame]:
        """A bar that moves on from field to field."""
        fields = np.zeros((8, 64, 96, 3), np.uint8)
        for index, field in enumerate(fields):
            field[:, 8 + 8 * index : 24 + 8 * index] = COLOURS[0]
        woven = fields[::2].copy()
        woven[:, 1::2] = fields[1::2, 1::2]
        return [coded(picture / 255, 5, full=False, bits=8) for picture in woven]

    def test_fields_of_two_moments_are_not_left_woven(self, tmp_path: Path) -> None:
        path = film(
            tmp_path / "a.mp4", self.comb(), "libx264", tags=(5, 1, 2, 2), options={"crf": "1", "flags": "+ildct"}
        )
        with pytest.warns(ChangedPictures, match=r"a\.mp4 is interlaced"):
            shown = read(path)
        assert len(shown) == 4
        bar = np.broadcast_to(COLOURS[0].astype(np.uint8), (44, 6, 3))
        for index, picture in enumerate(shown):
            middle = picture[10:-10].astype(int)
            assert np.max(np.abs(middle - middle[:1])) < 40
            # The bar of one field or of the other one.
            assert off(picture[10:-10, 17 + 16 * index : 23 + 16 * index], bar) < 12
            assert {int(picture[32, 10 + 16 * index, 0]) > 128, int(picture[32, 29 + 16 * index, 0]) > 128} == {
                True,
                False,
            }

    def test_a_whole_film_has_nothing_said_about_it(self, tmp_path: Path) -> None:
        path = film(tmp_path / "a.mp4", self.comb(), "libx264", tags=(5, 1, 2, 2), options={"crf": "1"})
        read(path)


class TestEnds:
    @pytest.fixture
    def pictures(self) -> Levels:
        return RANDOM.integers(0, 256, (3, 16, 24, 3), dtype=np.uint8)

    @pytest.mark.parametrize(
        "behind", [b"\0", bytes(4), bytes(7), bytes(8), bytes(100), b"\r\n", b"SEFT" * 5, b"\xff" * 33]
    )
    @pytest.mark.parametrize("suffix", [".mp4", ".mov"])
    @pytest.mark.parametrize("flags", ["", "+faststart", "+frag_keyframe+empty_moov"])
    def test_bytes_behind_the_last_box_are_nothing(
        self, tmp_path: Path, pictures: Levels, suffix: str, flags: str, behind: bytes
    ) -> None:
        path = film(tmp_path / f"a{suffix}", map(rgb, pictures), "libx264rgb", options={"crf": "0"}, layout=flags)
        path.write_bytes(path.read_bytes() + behind)
        np.testing.assert_array_equal(np.stack(read(path)), pictures)

    @pytest.mark.parametrize("suffix", [".avi", ".mkv", ".webm", ".mp4"])
    def test_films_that_were_written_through_a_pipe(self, tmp_path: Path, pictures: Levels, suffix: str) -> None:
        path = piped(tmp_path / f"a{suffix}", pictures)
        np.testing.assert_array_equal(np.stack(read(path)), pictures)
        content = path.read_bytes()
        for kept in range(len(content) * 9 // 10, len(content), 37):
            path.write_bytes(content[:kept])
            try:
                shown = read(path)
            except InputError:
                continue
            np.testing.assert_array_equal(np.stack(shown), pictures)


def piped(path: Path, pictures: Levels) -> Path:
    """A film whose writer could not go back to say how long it became."""

    class Pipe:
        def __init__(self) -> None:
            self.written = b""

        def write(self, data: bytes) -> int:
            self.written += bytes(data)
            return len(data)

    pipe = Pipe()
    form = {".avi": "avi", ".mkv": "matroska", ".webm": "webm", ".mp4": "mp4"}[path.suffix]
    codec, pixels = {
        ".avi": ("rawvideo", "bgr24"),
        ".mkv": ("ffv1", "bgr0"),
        ".webm": ("libvpx-vp9", "gbrp"),
        ".mp4": ("libx264rgb", "rgb24"),
    }[path.suffix]
    options = {"lossless": "1"} if path.suffix == ".webm" else {"crf": "0"} if path.suffix == ".mp4" else {}
    flags = {"movflags": "+frag_keyframe+empty_moov"} if path.suffix == ".mp4" else {}
    with av.open(pipe, "w", format=form, options=flags) as container:
        stream = cast("av.VideoStream", container.add_stream(codec, rate=10, options=options))
        stream.width, stream.height, stream.pix_fmt = pictures.shape[2], pictures.shape[1], pixels
        for picture in pictures:
            container.mux(stream.encode(rgb(picture)))
        container.mux(stream.encode())
    path.write_bytes(pipe.written)
    return path


#: Numbers of an MP4's tables by box and word, and what damage makes of them; the pictures themselves are whole.
TABLES: dict[str, tuple[str, int, Callable[[int], int]]] = {
    "sizes": ("stsz", 2, lambda count: count - 4),
    "sizes of one": ("stsz", 2, lambda count: 1),
    "chunks": ("stsc", 3, lambda count: count // 2),
    "shown at": ("ctts", 2, lambda count: 1),
    "clock": ("mdhd", 3, lambda ticks: ticks // 2),
    "edit": ("elst", 2, lambda length: length // 2),
    "beginning": ("elst", 3, lambda begin: begin // 2),
}


@pytest.mark.parametrize("table", TABLES)
def test_pictures_that_a_film_counts_and_does_not_show_are_told(tmp_path: Path, table: str) -> None:
    path = tmp_path / "a.mp4"
    save(np.random.default_rng(0).random((12, 16, 16, 3)).astype(np.float32), path)  # else its tables may be others
    assert len(read(path)) == 12  # and nothing is said of it
    box, word, harmed = TABLES[table]
    data = bytearray(path.read_bytes())
    at = data.index(box.encode()) + 4 + 4 * word
    data[at : at + 4] = struct.pack(">I", harmed(struct.unpack_from(">I", data, at)[0]))
    path.write_bytes(data)
    with pytest.warns(ChangedPictures, match=r"a\.mp4 counts 12 pictures and shows [1-9]\d?: it was trimmed, or"):
        assert 0 < len(read_pictures(path, least=1).images) < 12
