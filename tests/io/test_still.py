"""Animations and photographs: what each picture shows, held against a plain composition and a second decoder."""

import struct
import warnings
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from lightcube.errors import InputError
from lightcube.io import TransparentPictures, _bounds, _png, _still, read_pictures

Array = NDArray[Any]

RANDOM = np.random.default_rng(32)
ROWS, COLUMNS = 9, 13


@dataclass
class Part:
    """One picture of an animation: what it brings, where it stands, what becomes of it and how it is laid on."""

    levels: Array
    top: int = 0
    left: int = 0
    disposal: int = 0
    over: bool = False


def noise(rows: int = ROWS, columns: int = COLUMNS, channels: int = 4, kind: type[Any] = np.uint8) -> Array:
    return RANDOM.integers(0, np.iinfo(kind).max + 1, (rows, columns, channels), dtype=kind)


def read(path: Path) -> list[Array]:
    """Display values of every picture on white, 0 to 1."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TransparentPictures)
        return list(read_pictures(path, transfer="linear", least=1).images)


def chunk(name: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def pixels(levels: Array) -> bytes:
    big = levels.astype(levels.dtype.newbyteorder(">"))
    return zlib.compress(b"".join(b"\0" + line.tobytes() for line in big))


def header(levels: Array, rows: int = ROWS, columns: int = COLUMNS) -> bytes:
    kind = {1: 0, 2: 4, 3: 2, 4: 6}[levels.shape[2]]
    return struct.pack(">IIBBBBB", columns, rows, 8 * levels.itemsize, kind, 0, 0, 0)


def png(path: Path, levels: Array, extra: bytes = b"") -> Path:
    head = chunk(b"IHDR", header(levels, *levels.shape[:2])) + extra
    path.write_bytes(_png.PNG_START + head + chunk(b"IDAT", pixels(levels)) + chunk(b"IEND", b""))
    return path


def apng(path: Path, parts: list[Part], still: Array | None = None, extra: bytes = b"") -> Path:
    """An animated PNG written by hand; `still` is what programs show that know no animations."""
    body, count = b"", 0
    for index, part in enumerate(parts):
        rows, columns, _ = part.levels.shape
        place = (columns, rows, part.left, part.top, 1, 10, part.disposal, part.over)
        body += chunk(b"fcTL", struct.pack(">IIIIIHHBB", count, *place))
        data = pixels(part.levels)
        in_front = index == 0 and still is None
        body += chunk(b"IDAT", data) if in_front else chunk(b"fdAT", struct.pack(">I", count + 1) + data)
        count += 1 if in_front else 2
    before = b"" if still is None else chunk(b"IDAT", pixels(still))
    head = chunk(b"IHDR", header(parts[0].levels)) + chunk(b"acTL", struct.pack(">II", len(parts), 0)) + extra
    path.write_bytes(_png.PNG_START + head + before + body + chunk(b"IEND", b""))
    return path


def composed(parts: list[Part]) -> list[Array]:
    """What the canvas shows after each part, pixel by pixel, on white."""
    shown, canvas = [], np.zeros((ROWS, COLUMNS, 4))
    for part in parts:
        full = np.iinfo(part.levels.dtype).max
        before = canvas.copy()
        for row, column in np.ndindex(part.levels.shape[:2]):
            new = part.levels[row, column] / full
            new = np.append(new, 1.0) if len(new) == 3 else new
            place = (part.top + row, part.left + column)
            if part.over:
                old = canvas[place]
                opacity = new[3] + old[3] * (1 - new[3])
                mixed = (new[:3] * new[3] + old[:3] * old[3] * (1 - new[3])) / (opacity or 1)
                new = np.append(mixed, opacity)
            canvas[place] = new
        shown.append(canvas[..., 3:] * canvas[..., :3] + 1 - canvas[..., 3:])
        if part.disposal == 2:
            canvas = before
        elif part.disposal == 1:
            canvas = canvas.copy()
            rows, columns, _ = part.levels.shape
            canvas[part.top : part.top + rows, part.left : part.left + columns] = 0
    return shown


class TestAnimatedPng:
    @pytest.mark.parametrize("kind", [np.uint8, np.uint16])
    @pytest.mark.parametrize("channels", [3, 4])
    @pytest.mark.parametrize("over", [False, True])
    @pytest.mark.parametrize("disposal", [0, 1, 2])
    def test_every_way_of_laying_on(
        self, tmp_path: Path, disposal: int, over: bool, channels: int, kind: type[Any]
    ) -> None:
        parts = [
            Part(noise(channels=channels, kind=kind), disposal=disposal, over=over),
            Part(noise(4, 5, channels, kind), 2, 3, disposal, over),
            Part(noise(3, 6, channels, kind), 4, 7, (disposal + 1) % 3, over),
            Part(noise(5, 5, channels, kind), 1, 6, disposal, not over),
        ]
        for image, wanted in zip(read(apng(tmp_path / "a.png", parts)), composed(parts), strict=True):
            np.testing.assert_allclose(image, wanted, atol=2 / np.iinfo(kind).max)

    def test_the_still_picture_is_left_out_and_orientation_turns_the_canvas(self, tmp_path: Path) -> None:
        exif = b"II*\0" + struct.pack("<IHHHIII", 8, 1, 0x0112, 3, 1, 6, 0)
        parts = [Part(noise(channels=3)), Part(noise(2, 3, 3), 1, 4)]
        path = apng(tmp_path / "a.png", parts, still=noise(channels=3), extra=chunk(b"eXIf", exif))
        for image, wanted in zip(read(path), composed(parts), strict=True):
            np.testing.assert_allclose(image, np.rot90(wanted, -1), atol=1e-6)

    def test_one_picture_in_a_folder(self, tmp_path: Path) -> None:
        part = Part(noise(channels=3))
        apng(tmp_path / "a.png", [part], still=noise(channels=3))
        np.testing.assert_allclose(read(tmp_path)[0], part.levels / 255, atol=1e-6)
        apng(tmp_path / "b.png", [part, part])
        with pytest.raises(InputError, match=r"b\.png is an animation inside a folder"):
            read(tmp_path)

    @pytest.mark.parametrize(("top", "left"), [(7, 0), (0, 11)])
    def test_pictures_beyond_the_canvas(self, tmp_path: Path, top: int, left: int) -> None:
        path = apng(tmp_path / "a.png", [Part(noise()), Part(noise(3, 3), top, left)])
        with pytest.raises(InputError, match="damaged"):
            read(path)

    def test_missing_pictures(self, tmp_path: Path) -> None:
        path = apng(tmp_path / "a.png", [Part(noise()), Part(noise())])
        data = path.read_bytes()
        three = chunk(b"acTL", struct.pack(">II", 3, 0))
        path.write_bytes(data.replace(chunk(b"acTL", struct.pack(">II", 2, 0)), three))
        with pytest.raises(InputError, match="lacks some of its pictures"):
            read(path)
        path.write_bytes(data[: data.rindex(b"fdAT") + 20])
        with pytest.raises(InputError, match="cut short"):
            read(path)


@pytest.mark.parametrize("channels", [1, 3])
def test_a_colour_that_is_transparent_in_16_bits(tmp_path: Path, channels: int) -> None:
    picture = noise(channels=channels, kind=np.uint16)
    picture[0, 0], picture[0, 1] = 4660, 4661
    image = read(png(tmp_path / "a.png", picture, chunk(b"tRNS", struct.pack(">H", 4660) * channels)))[0]
    np.testing.assert_array_equal(image[0, 0], 1)
    np.testing.assert_allclose(image[1:], np.broadcast_to(picture / 65535, (ROWS, COLUMNS, 3))[1:], atol=1e-6)
    np.testing.assert_allclose(image[0, 1], 4661 / 65535, atol=1e-6)


def gif(path: Path, parts: list[Part], see_through: int | None = None) -> Path:
    """A GIF written by hand: palette indices without compression."""
    colours = np.random.default_rng(5).integers(0, 256, (256, 3), dtype=np.uint8)
    data = b"GIF89a" + struct.pack("<HHBBB", COLUMNS, ROWS, 0xF7, 0, 0) + colours.tobytes()
    for part in parts:
        rows, columns, _ = part.levels.shape
        flags = part.disposal << 2 | (see_through is not None)
        data += b"!\xf9\x04" + struct.pack("<BHB", flags, 10, see_through or 0) + b"\0"
        data += b"," + struct.pack("<HHHHB", part.left, part.top, columns, rows, 0) + b"\x08"
        # Codes of 9 bits, with a clear code before the table grows beyond them.
        codes = [
            code for at, value in enumerate(part.levels.ravel()) for code in ([256] if at % 100 == 0 else []) + [value]
        ]
        bits = sum(int(code) << (9 * at) for at, code in enumerate([*codes, 257]))
        packed = bits.to_bytes((9 * (len(codes) + 1) + 7) // 8, "little")
        blocks = [packed[at : at + 255] for at in range(0, len(packed), 255)]
        data += b"".join(bytes([len(block)]) + block for block in blocks) + b"\0"
    path.write_bytes(data + b";")
    return path


def by_ffmpeg(path: Path) -> list[Array]:
    with av.open(str(path)) as container:
        frames = [frame.to_ndarray(format="rgba") / 255 for frame in container.decode(video=0)]
    return [frame[..., 3:] * frame[..., :3] + 1 - frame[..., 3:] for frame in frames]


class TestGif:
    @pytest.mark.parametrize("see_through", [None, 7])
    @pytest.mark.parametrize("disposal", [0, 1, 2, 3])
    def test_pictures_are_as_a_second_decoder_has_them(
        self, tmp_path: Path, disposal: int, see_through: int | None
    ) -> None:
        parts = [
            Part(noise(channels=1), disposal=1),
            Part(noise(4, 5, 1), 2, 3, disposal),
            Part(noise(3, 6, 1), 4, 7, disposal),
            Part(noise(2, 2, 1), 0, 0, disposal),
        ]
        for part in parts:
            part.levels[::2, ::2] = 7
        path = gif(tmp_path / "a.gif", parts, see_through)
        for image, wanted in zip(read(path), by_ffmpeg(path), strict=True):
            np.testing.assert_allclose(image, wanted, atol=1e-6)

    @pytest.mark.parametrize("disposal", [0, 1, 2, 3])
    @pytest.mark.parametrize(("top", "left"), [(6, 10), (6, 0), (0, 10), (20, 20)])
    def test_what_goes_beyond_the_screen_is_cut_off(self, tmp_path: Path, top: int, left: int, disposal: int) -> None:
        first, last = Part(noise(channels=1), disposal=1), Part(noise(2, 2, 1), 1, 1)
        outside = Part(noise(5, 6, 1), top, left, disposal)
        wide = read(gif(tmp_path / "a.gif", [first, outside, last]))
        rows, columns = max(ROWS - top, 0), max(COLUMNS - left, 0)
        inside = [Part(outside.levels[:rows, :columns], top, left, disposal)] if rows and columns else []
        cut = read(gif(tmp_path / "b.gif", [first, *(inside or [Part(first.levels[:1, :1])]), last]))
        for image, wanted in zip(wide, cut, strict=True):
            np.testing.assert_array_equal(image, wanted)


def multi(path: Path, kind: int, second: Image.Image) -> Image.Image:
    """A JPEG with a second picture of some kind behind the first."""
    first = Image.fromarray(noise(16, 24, 3))
    first.save(path, format="MPO", save_all=True, append_images=[second])
    data = path.read_bytes()
    with Image.open(path) as image:
        size = image.mpinfo[0xB002][1]["Size"]  # type: ignore[attr-defined]
        order = ">" if image.mpinfo[0xB000] and data[data.index(b"MPF\0") + 4 :][:2] == b"MM" else "<"  # type: ignore[attr-defined]
    at = data.rindex(struct.pack(f"{order}I", size), 0, data.index(b"MPF\0") + 200) - 4
    path.write_bytes(data[:at] + struct.pack(f"{order}I", kind) + data[at + 4 :])
    return first


@pytest.mark.parametrize("kind", [0x000000, 0x010001, 0x010002, 0x050000, 0x020001, 0x020002, 0x020003])
def test_what_a_phone_puts_behind_a_photograph_is_no_picture(tmp_path: Path, kind: int) -> None:
    multi(tmp_path / "a.jpg", kind, Image.fromarray(noise(8, 12, 3)))
    assert len(read(tmp_path)) == 1
    assert len(read(tmp_path / "a.jpg")) == (2 if kind >> 16 == 2 else 1)


class TestLarge:
    @pytest.mark.parametrize("suffix", [".png", ".tif", ".jpg", ".webp", ".gif"])
    def test_the_header_alone_tells(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str) -> None:
        path = tmp_path / f"a{suffix}"
        Image.fromarray(noise(40, 50, 3)).save(path)
        monkeypatch.setattr(_bounds, "MOST_PIXELS", 2000)
        assert len(read(path)) == 1
        monkeypatch.setattr(_bounds, "MOST_PIXELS", 1998)
        monkeypatch.setattr(Image.Image, "load", lambda *_: pytest.fail("it was unpacked"))
        with pytest.raises(InputError, match=r"has more than 0\.001998 megapixels"):
            read(path)

    def test_pillow_keeps_its_own_limit(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        Image.fromarray(noise(40, 50, 3)).save(tmp_path / "a.png")
        monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 100)
        assert len(read(tmp_path)) == 1
        assert Image.MAX_IMAGE_PIXELS == 100


class TestWhatIsWrong:
    def test_no_picture(self, tmp_path: Path) -> None:
        (tmp_path / "a.png").write_bytes(b"<svg/>")
        with pytest.raises(InputError, match="no picture of a known kind"):
            read(tmp_path)

    @pytest.mark.parametrize("suffix", [".png", ".jpg", ".webp", ".gif", ".tif"])
    def test_a_damaged_header(self, tmp_path: Path, suffix: str) -> None:
        path = tmp_path / f"a{suffix}"
        Image.fromarray(noise(channels=3)).save(path)
        start = path.read_bytes()[:12]
        path.write_bytes(start[:4] + b"\0\0\0\0" + start[8:] + bytes(200))
        with pytest.raises(InputError, match=r"damaged|holds masks or nothing"):
            read(path)

    def test_no_memory(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        def fail(*_: object) -> None:
            raise MemoryError

        Image.fromarray(noise()).save(tmp_path / "a.png")
        monkeypatch.setattr(Image.Image, "load", fail)
        with pytest.raises(InputError, match="memory"):
            read(tmp_path)

    @pytest.mark.parametrize("error", [AttributeError, NameError, AssertionError, TypeError, ImportError, RuntimeError])
    def test_a_fault_of_the_program_is_not_called_damage(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: type[Exception]
    ) -> None:
        def fail(*_: object) -> None:
            raise error("a fault")

        Image.fromarray(noise()).save(tmp_path / "a.jpg", format="PNG")
        monkeypatch.setattr(_still, "read_png", lambda *_, **__: fail())
        with pytest.raises(error, match="a fault"):
            read(tmp_path)
