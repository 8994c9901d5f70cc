"""Reading pictures: what is handled and what is refused."""

import struct
import warnings
import zlib
from fractions import Fraction
from pathlib import Path
from typing import Any, cast

import av
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image, ImageOps

from lightcube.errors import InputError
from lightcube.io import DoubtfulFolder, TransparentPictures, _bounds, pictures, read_pictures, save
from lightcube.optics.transfer import Transfer, decode, from_levels, to_uint8
from lightcube.optics.views import DoubtfulAngles, spread_angles
from lightcube.pictures.pictures import Pictures

Array = NDArray[np.uint8] | NDArray[np.uint16]

RANDOM = np.random.default_rng(20)
MANY = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def noise(count: int = 3, channels: int = 3, dtype: type[np.uint8] | type[np.uint16] = np.uint8) -> Array:
    """Pictures of 5 rows and 7 columns."""
    shape = (count, 5, 7, channels)
    if dtype is np.uint16:
        return RANDOM.integers(0, 65536, shape, dtype=np.uint16)
    return RANDOM.integers(0, 256, shape, dtype=np.uint8)


def folder_of(folder: Path, images: list[Image.Image], suffix: str = ".png") -> Path:
    folder.mkdir()
    for index, image in enumerate(images):
        image.save(folder / f"{index}{suffix}")
    return folder


def png(path: Path, levels: Array, extra: bytes = b"", colour: int | None = None) -> None:
    """A PNG written by hand: Pillow cannot write 16 bits per colour. Grey, grey + alpha, RGB or RGBA."""
    levels = levels if levels.ndim == 3 else levels[:, :, None]
    rows, columns, channels = levels.shape
    kind = {1: 0, 2: 4, 3: 2, 4: 6}[channels] if colour is None else colour

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    big = levels.astype(levels.dtype.newbyteorder(">"))
    lines = b"".join(b"\0" + line.tobytes() for line in big)
    header = struct.pack(">IIBBBBB", columns, rows, 8 * levels.itemsize, kind, 0, 0, 0)
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + extra
        + chunk(b"IDAT", zlib.compress(lines))
        + chunk(b"IEND", b"")
    )


def tiff(path: Path, levels: Array, orientation: int = 1) -> None:
    """An uncompressed little-endian RGB or RGBA TIFF with 8 or 16 bits, written by hand."""
    rows, columns, channels = levels.shape
    data = levels.astype(levels.dtype.newbyteorder("<")).tobytes()
    tags = [
        (256, 4, 1, columns),
        (257, 4, 1, rows),
        (258, 3, channels, 8 + len(data)),
        (259, 3, 1, 1),
        (262, 3, 1, 2),
        (273, 4, 1, 8),
        (274, 3, 1, orientation),
        (277, 3, 1, channels),
        (278, 4, 1, rows),
        (279, 4, 1, len(data)),
    ]
    tags += [(338, 3, 1, 2)] if channels == 4 else []
    bits = struct.pack(f"<{channels}H", *[8 * levels.itemsize] * channels)
    directory = struct.pack("<H", len(tags)) + b"".join(struct.pack("<HHII", *tag) for tag in tags) + b"\0" * 4
    path.write_bytes(b"II*\0" + struct.pack("<I", 8 + len(data) + len(bits)) + data + bits + directory)


def video(path: Path, pictures: Array, codec: str, pixels: str, source: str = "rgb24", **options: str) -> Path:
    with av.open(str(path), "w") as container:
        stream = cast("av.VideoStream", container.add_stream(codec, rate=Fraction(10), options=options))
        stream.width, stream.height, stream.pix_fmt = pictures.shape[2], pictures.shape[1], pixels
        for picture in pictures:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format=source)))
        container.mux(stream.encode())
    return path


def animation(path: Path, pictures: Array) -> Path:
    images = [Image.fromarray(picture) for picture in pictures]
    of_kind: dict[str, dict[str, Any]] = {".webp": {"lossless": True}, ".apng": {"format": "PNG"}}
    options = of_kind.get(path.suffix, {})
    images[0].save(path, save_all=True, append_images=images[1:], **options)
    return path


def few_colours(count: int = 3) -> NDArray[np.uint8]:
    """Pictures that a GIF holds exactly: 35 pixels are fewer than 256 colours."""
    return noise(count).astype(np.uint8)


def sample(path: Path) -> Array:
    """Write three pictures into `path` by its suffix, without loss, and return them."""
    pictures = few_colours()
    codecs = {
        ".mp4": ("libx264rgb", "rgb24", {"crf": "0"}),
        ".mov": ("libx264rgb", "rgb24", {"crf": "0"}),
        ".mkv": ("ffv1", "bgr0", {}),
        ".webm": ("libvpx-vp9", "gbrp", {"lossless": "1"}),
        ".avi": ("ffv1", "bgr0", {}),
    }
    if path.suffix in codecs:
        codec, pixels, options = codecs[path.suffix]
        video(path, pictures, codec, pixels, **options)
    else:
        animation(path, pictures)
    return pictures


SUFFIXES = (".gif", ".webp", ".apng", ".tif", ".mp4", ".mov", ".mkv", ".webm", ".avi")


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_each_kind_of_file_gives_its_pictures_exactly(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"film{suffix}"
    pictures = sample(path)
    read = read_pictures(path)
    assert read.names == ("1", "2", "3")
    assert read.angles_deg is None
    assert read.elevation_deg is None
    for image, picture in zip(read.images, pictures, strict=True):
        assert image.dtype == np.float32
        np.testing.assert_array_equal(image, from_levels(picture))


@pytest.mark.parametrize("transfer", ["srgb", "linear"])
def test_a_folder_is_read_in_natural_order(tmp_path: Path, transfer: Transfer) -> None:
    first, second, tenth = noise()
    Image.fromarray(tenth).save(tmp_path / "view 10.png")
    Image.fromarray(second[:3]).save(tmp_path / "View 2.PNG")
    Image.fromarray(first).save(tmp_path / "view 01.tif")
    (tmp_path / ".hidden.png").write_bytes(b"not a picture")
    read = read_pictures(tmp_path, transfer=transfer)
    assert read.names == ("view 01", "View 2", "view 10")
    assert read.transfer == transfer
    for image, picture in zip(read.images, (first, second[:3], tenth), strict=True):
        np.testing.assert_array_equal(image, from_levels(picture, transfer))


def test_names_are_in_order_by_their_stems(tmp_path: Path) -> None:
    names = ["a.png", "a1.PNG", "a1b.jpg", "A2.png", "a10.png", "b.webp", "b1.png", "٣.png", "४².png"]
    for name in names:
        Image.new("RGB", (3, 2)).save(tmp_path / name)
    assert read_pictures(tmp_path).names == tuple(Path(name).stem for name in names)


def test_what_is_left_out_of_a_folder_is_said_once(tmp_path: Path) -> None:
    for index in range(2):
        Image.new("RGB", (3, 2)).save(tmp_path / f"{index}.png")
    for name in (".DS_Store", "Thumbs.db", "desktop.ini", "Desktop.INI", "._0.png", ".hidden"):
        (tmp_path / name).write_bytes(b"x")
    assert len(read_pictures(tmp_path)) == 2
    for name in ("a.cr2", "b.gif", "notes.txt"):
        (tmp_path / name).write_bytes(b"x")
    with pytest.warns(DoubtfulFolder, match=r": 3 of what is .* left out: a\.cr2, b\.gif, notes\.txt$") as caught:
        assert len(read_pictures(tmp_path)) == 2
    assert len(caught) == 1
    (tmp_path / "z.png").mkdir()
    (tmp_path / "z.tiff.part").write_bytes(b"x")
    with pytest.warns(DoubtfulFolder, match=r": 5 of what is .* a\.cr2, b\.gif, notes\.txt and 2 more$"):
        read_pictures(tmp_path)


def test_angles_that_may_be_radians_are_told(tmp_path: Path) -> None:
    for index in range(4):
        Image.new("RGB", (3, 2)).save(tmp_path / f"{index}.png")
    for said in ("[0, 1.5708, 3.1416, 4.7124]", "[-1.5, -0.5, 0.5, 1.5]", "[361, 362, 363, 364]"):
        (tmp_path / "views.toml").write_text(f"angles_deg = {said}")
        with pytest.warns(DoubtfulAngles, match=r"all angles lie within a few degrees: if they are radians"):
            read_pictures(tmp_path)
    for said in ("angles_deg = [0, 3, 6, 9]", "span_deg = 10", "angles_deg = [0, 45, 90, 135]"):
        (tmp_path / "views.toml").write_text(said)
        read_pictures(tmp_path)


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_16_bit_pngs_keep_all_their_bits(tmp_path: Path, channels: int) -> None:
    pictures = noise(2, channels, np.uint16)
    for index, picture in enumerate(pictures):
        png(tmp_path / f"{index}.png", picture)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TransparentPictures)
        read = read_pictures(tmp_path)
    for image, picture in zip(read.images, pictures.astype(np.float64) / 65535, strict=True):
        colour = np.broadcast_to(decode(picture[..., : 1 if channels < 3 else 3]), (5, 7, 3))
        opacity = picture[..., -1:] if channels in (2, 4) else 1.0
        np.testing.assert_allclose(image, opacity * colour + (1 - opacity), atol=2e-7)


@pytest.mark.parametrize("channels", [3, 4])
def test_16_bit_tiffs_keep_all_their_bits(tmp_path: Path, channels: int) -> None:
    pictures = noise(2, channels, np.uint16)
    pictures[..., 3:] = 65535
    for index, picture in enumerate(pictures):
        tiff(tmp_path / f"{index}.tif", picture)
    for image, picture in zip(read_pictures(tmp_path).images, pictures, strict=True):
        np.testing.assert_array_equal(image, decode(picture[..., :3].astype(np.float32) / np.float32(65535)))


def test_deep_video_keeps_all_its_bits(tmp_path: Path) -> None:
    pictures = noise(2, 3, np.uint16)
    video(tmp_path / "film.mkv", pictures, "ffv1", "gbrp16le", "gbrp16le")
    for image, picture in zip(read_pictures(tmp_path / "film.mkv").images, pictures, strict=True):
        np.testing.assert_array_equal(image, decode(picture.astype(np.float32) / np.float32(65535)))


@pytest.mark.parametrize("mode", ["1", "L", "P", "RGB", "CMYK"])
def test_grey_palette_and_print_pictures_are_colours_too(tmp_path: Path, mode: str) -> None:
    images = [Image.fromarray(picture).convert(mode) for picture in noise(2)]
    suffix = ".tif" if mode == "CMYK" else ".png"
    read = read_pictures(folder_of(tmp_path / "f", images, suffix))
    for image, original in zip(read.images, images, strict=True):
        np.testing.assert_array_equal(image, from_levels(np.asarray(original.convert("RGB"))))


def test_transparent_pictures_are_put_on_white_in_linear_light(tmp_path: Path) -> None:
    pictures = noise(3, 4)
    pictures[1, ..., 3] = 255
    pictures[0, 0, 0, 3], pictures[0, 0, 1, 3] = 0, 255
    folder = folder_of(tmp_path / "f", [Image.fromarray(picture) for picture in pictures])
    with pytest.warns(TransparentPictures, match=r"^2 of 3 pictures .*white") as caught:
        read = read_pictures(folder)
    assert len(caught) == 1
    assert caught[0].filename == __file__
    light = from_levels(pictures[..., :3].astype(np.uint8))
    opacity = pictures[..., 3:] / 255
    np.testing.assert_allclose(np.stack(read.images), opacity * light + (1 - opacity), atol=1e-6)
    np.testing.assert_array_equal(read.images[0][0, 0], 1)
    np.testing.assert_array_equal(read.images[0][0, 1], light[0, 0, 1])


def test_transparent_palettes_and_colour_keys_are_put_on_white(tmp_path: Path) -> None:
    pictures = noise(2)
    pictures[:, 0, 0] = 9, 8, 7
    palette = Image.fromarray(pictures[0]).quantize(64)
    key = int(np.asarray(palette)[0, 0])
    palette.save(tmp_path / "0.png", transparency=key)
    Image.fromarray(pictures[1]).save(tmp_path / "1.png", transparency=(9, 8, 7))
    with pytest.warns(TransparentPictures, match=r"^2 of 2"):
        read = read_pictures(tmp_path)
    for image in read.images:
        np.testing.assert_array_equal(image[0, 0], 1)
        assert image.min() < 0.5


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("suffix", [".png", ".tif", ".webp"])
def test_exif_orientation_turns_pictures_upright(tmp_path: Path, orientation: int, suffix: str) -> None:
    exif = Image.Exif()
    exif[0x0112] = orientation
    pictures = noise(2)
    wanted = []
    for index, picture in enumerate(pictures):
        image = Image.fromarray(picture)
        options: dict[str, Any] = {"lossless": True} if suffix == ".webp" else {}
        image.save(tmp_path / f"{index}{suffix}", exif=exif, **options)
        image.getexif()[0x0112] = orientation
        wanted.append(np.asarray(ImageOps.exif_transpose(image)))
    for upright, correct in zip(read_pictures(tmp_path).images, wanted, strict=True):
        np.testing.assert_array_equal(upright, from_levels(correct))


@pytest.mark.parametrize("orientation", range(1, 9))
def test_orientation_holds_for_16_bits_as_for_8(tmp_path: Path, orientation: int) -> None:
    deep = noise(2, 3, np.uint16)
    exif = b"II*\0" + struct.pack("<IHHHIII", 8, 1, 0x0112, 3, 1, orientation, 0)
    chunk = struct.pack(">I", len(exif)) + b"eXIf" + exif + struct.pack(">I", zlib.crc32(b"eXIf" + exif))
    folders = [tmp_path / name for name in ("deep tiff", "shallow tiff", "deep png", "shallow png")]
    for folder in folders:
        folder.mkdir()
    for index, picture in enumerate(deep):
        shallow = (picture >> 8).astype(np.uint8)
        tiff(folders[0] / f"{index}.tif", picture, orientation)
        tiff(folders[1] / f"{index}.tif", shallow, orientation)
        png(folders[2] / f"{index}.png", picture, chunk)
        png(folders[3] / f"{index}.png", shallow, chunk)
    reads = [read_pictures(folder, transfer="linear").images for folder in folders]
    for views in zip(*reads, strict=True):
        for image in views:
            np.testing.assert_allclose(image, views[0], atol=1 / 200)
    wanted = np.asarray(Image.fromarray((deep[0] >> 8).astype(np.uint8)))
    image = Image.fromarray(wanted)
    image.getexif()[0x0112] = orientation
    np.testing.assert_allclose(reads[0][0], np.asarray(ImageOps.exif_transpose(image)) / 255, atol=1 / 200)


def test_a_gif_of_changes_shows_whole_pictures(tmp_path: Path) -> None:
    base = Image.new("P", (7, 5), 1)
    base.putpalette([255, 255, 255, 200, 30, 10, 0, 90, 220])
    patch = Image.new("P", (7, 5), 0)
    patch.putpalette(base.getpalette() or [])
    patch.putpixel((2, 3), 2)
    base.save(tmp_path / "a.gif", save_all=True, append_images=[patch], transparency=0, disposal=1, optimize=False)
    read = read_pictures(tmp_path / "a.gif")
    np.testing.assert_array_equal(to_uint8(read.images[0]), np.broadcast_to((200, 30, 10), (5, 7, 3)))
    changed = to_uint8(read.images[1])
    np.testing.assert_array_equal(changed[3, 2], (0, 90, 220))
    np.testing.assert_array_equal(changed[:3], to_uint8(read.images[0])[:3])


def test_the_still_picture_of_an_apng_is_left_out(tmp_path: Path) -> None:
    pictures = few_colours()
    still, first, second = (Image.fromarray(picture) for picture in pictures)
    still.save(tmp_path / "a.png", save_all=True, append_images=[first, second], default_image=True)
    read = read_pictures(tmp_path / "a.png")
    np.testing.assert_array_equal(np.stack(read.images), from_levels(pictures[1:]))


class TestViewsToml:
    @pytest.fixture
    def folder(self, tmp_path: Path) -> Path:
        return folder_of(tmp_path / "f", [Image.fromarray(picture) for picture in noise()])

    def test_angles_elevation_and_names(self, folder: Path) -> None:
        (folder / "views.toml").write_text('angles_deg = [350, 0.5, -7]\nelevation_deg = 20\nnames = ["a", "ü", "c"]\n')
        read = read_pictures(folder)
        assert read.angles_deg is not None
        np.testing.assert_array_equal(read.angles_deg, [350, 0.5, -7])
        assert read.elevation_deg == 20
        assert read.names == ("a", "ü", "c")

    def test_span_spreads_the_angles(self, folder: Path) -> None:
        (folder / "views.toml").write_text("span_deg = 90.0\n")
        read = read_pictures(folder)
        assert read.angles_deg is not None
        np.testing.assert_array_equal(read.angles_deg, spread_angles(3, 90.0))

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("angles_deg = [1, 2]", "angles_deg: 2 are listed for 3 pictures"),
            ('names = ["a"]', "names: 1 are listed for 3 pictures"),
            ("angles_deg = [1, 2, 361]", "angles_deg: angles number 1 and 3"),
            ("angles_deg = [1, 2, nan]", "angles_deg.2: "),
            ("angles_deg = [1, 2, inf]", "angles_deg.2: "),
            ("angles_deg = [1, 2, true]", "angles_deg.2: "),
            ("angles_deg = [1, 2, '3']", "angles_deg.2: "),
            ("angles_deg = 3", "angles_deg: "),
            ("span_deg = 0", "span_deg: "),
            ("span_deg = 720", "span_deg: "),
            ("span_deg = 90\nangles_deg = [1, 2, 3]", "span_deg: angles_deg is given already"),
            ("elevation_deg = 90", "elevation_deg: "),
            ("elevation_deg = -90", "elevation_deg: "),
            ("elevation_deg = nan", "elevation_deg: "),
            ("elevations = 3", "elevations: no such key here"),
            ("names = [1, 2, 3]", "names.0: "),
            ("angles_deg = [1, 2", "not a TOML file"),
            ("angles_deg = [1, 2, 3]\xff", "not a TOML file"),
        ],
    )
    def test_faults_name_the_file_and_the_key(self, folder: Path, text: str, message: str) -> None:
        (folder / "views.toml").write_bytes(text.encode("latin-1"))
        with pytest.raises(InputError, match=message) as caught:
            read_pictures(folder)
        assert str(folder / "views.toml") in str(caught.value)
        assert "\n" not in str(caught.value)


class TestRefused:
    def test_what_is_not_there(self, tmp_path: Path) -> None:
        with pytest.raises(InputError, match="there is no"):
            read_pictures(tmp_path / "missing")
        with pytest.raises(InputError, match="File name too long"):
            read_pictures(tmp_path / ("x" * 300 + ".gif"))

    def test_an_empty_folder(self, tmp_path: Path) -> None:
        with pytest.raises(InputError, match="empty"):
            read_pictures(tmp_path)

    def test_a_folder_without_pictures(self, tmp_path: Path) -> None:
        (tmp_path / "a.txt").write_text("x")
        with pytest.raises(InputError, match="no pictures"):
            read_pictures(tmp_path)

    def test_one_picture(self, tmp_path: Path) -> None:
        path = folder_of(tmp_path / "f", [Image.fromarray(noise()[0])])
        for single in (path, path / "0.png", animation(tmp_path / "a.gif", noise(1))):
            with pytest.raises(InputError, match="holds one picture"):
                read_pictures(single)

    @pytest.mark.parametrize("name", ["a.txt", "a.zarr", "a", ".png"])
    def test_unknown_suffixes(self, tmp_path: Path, name: str) -> None:
        (tmp_path / name).write_bytes(b"x")
        with pytest.raises(InputError, match="suffix"):
            read_pictures(tmp_path / name)

    @pytest.mark.parametrize("suffix", SUFFIXES)
    @pytest.mark.parametrize("content", [b"", b"nothing like it", bytes(3000)])
    def test_other_content(self, tmp_path: Path, suffix: str, content: bytes) -> None:
        (tmp_path / f"a{suffix}").write_bytes(content)
        with pytest.raises(InputError, match="cannot be read"):
            read_pictures(tmp_path / f"a{suffix}")

    def test_numbers_instead_of_levels(self, tmp_path: Path) -> None:
        image = Image.fromarray(np.zeros((5, 7), np.float32))
        with pytest.raises(InputError, match=r"1\.tif holds numbers"):
            read_pictures(folder_of(tmp_path / "f", [Image.fromarray(noise()[0]), image], ".tif"))

    def test_an_animation_in_a_folder(self, tmp_path: Path) -> None:
        animation(tmp_path / "a.webp", noise())
        with pytest.raises(InputError, match=r"a\.webp is an animation inside a folder"):
            read_pictures(tmp_path)

    def test_a_sound_without_pictures(self, tmp_path: Path) -> None:
        with av.open(str(tmp_path / "a.mkv"), "w") as container:
            stream = container.add_stream("pcm_s16le", rate=8000)
            frame = av.AudioFrame.from_ndarray(np.zeros((1, 800), np.int16), format="s16", layout="mono")
            frame.sample_rate = 8000
            container.mux(stream.encode(frame))
        with pytest.raises(InputError, match="no video"):
            read_pictures(tmp_path / "a.mkv")

    @pytest.mark.parametrize("text", ["ffconcat version 1.0\nfile 'real.mp4'\n", "#EXTM3U\n#EXTINF:1,\nreal.mp4\n"])
    def test_a_playlist_under_the_name_of_a_video_opens_nothing(self, tmp_path: Path, text: str) -> None:
        sample(tmp_path / "real.mp4")
        (tmp_path / "a.mkv").write_text(text)
        with pytest.raises(InputError, match="cannot be read"):
            read_pictures(tmp_path / "a.mkv")

    def test_a_video_with_damaged_pictures(self, tmp_path: Path) -> None:
        path = save(np.random.default_rng(1).random((8, 65, 97, 3), dtype=np.float32), tmp_path / "a.mp4")
        content = bytearray(path.read_bytes())
        middle = len(content) // 2
        content[middle : middle + 60] = bytes(byte ^ 0x5A for byte in content[middle : middle + 60])
        path.write_bytes(content)
        with pytest.raises(InputError, match="cannot be read"):
            read_pictures(path)

    @pytest.mark.parametrize("limit", [5, 30])
    @pytest.mark.parametrize("suffix", [".png", ".gif", ".mp4"])
    def test_pictures_larger_than_any_photograph(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, limit: int, suffix: str
    ) -> None:
        folder_of(tmp_path / "f", [Image.fromarray(picture) for picture in noise()])
        path = tmp_path / ("f" if suffix == ".png" else f"a{suffix}")
        if suffix != ".png":
            sample(path)
        monkeypatch.setattr(_bounds, "MOST_PIXELS", limit)
        with pytest.raises(InputError, match="megapixels, the most a picture can have"):
            read_pictures(path)

    @pytest.mark.parametrize("suffix", [".gif", ".mp4", ""])
    def test_more_pictures_than_half_the_memory(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str
    ) -> None:
        path = tmp_path / f"a{suffix}"
        if suffix:
            sample(path)
        else:
            folder_of(path, [Image.fromarray(picture) for picture in noise()])
        monkeypatch.setattr(_bounds, "memory", lambda: 3 * 35 * 12 * 2)
        assert len(read_pictures(path)) == 3
        monkeypatch.setattr(_bounds, "memory", lambda: 3 * 35 * 12 * 2 - 1)
        with pytest.raises(InputError, match=r"one too many.* half of this machine's memory"):
            read_pictures(path)

    def test_unknown_transfer(self, tmp_path: Path) -> None:
        with pytest.raises(InputError, match="transfer"):
            read_pictures(tmp_path, transfer="gamma")  # type: ignore[arg-type]


@pytest.mark.parametrize("suffix", [".gif", ".webp", ".mp4", ".mov", ".mkv", ".webm", ".avi"])
def test_containers_know_their_length(tmp_path: Path, suffix: str) -> None:
    whole, cut = tmp_path / f"a{suffix}", tmp_path / f"b{suffix}"
    sample(whole)
    if suffix in (".mp4", ".mov"):  # with its index in front, where a cut loses pictures and nothing else
        save(np.stack(read_pictures(whole).images), tmp_path / "c.mp4")
        (tmp_path / "c.mp4").rename(whole)
    content = whole.read_bytes()
    assert len(read_pictures(whole)) == 3
    for kept in (len(content) - 1, len(content) * 3 // 4, len(content) // 2):
        cut.write_bytes(content[:kept])
        with pytest.raises(InputError, match="its end is missing"):
            read_pictures(cut)


@pytest.mark.parametrize("suffix", [*SUFFIXES, ".png", ".jpg"])
@MANY
@given(data=st.data())
def test_a_file_cut_short_is_refused_or_whole(tmp_path: Path, suffix: str, data: st.DataObject) -> None:
    whole, cut = tmp_path / "whole", tmp_path / "cut"
    if not whole.exists():
        whole.mkdir()
        cut.mkdir()
        if suffix in (".png", ".jpg"):
            for index, picture in enumerate(noise(2)):
                Image.fromarray(picture).save(whole / f"{index}{suffix}")
        else:
            sample(whole / f"0{suffix}")
        for file in whole.iterdir():
            (cut / file.name).write_bytes(file.read_bytes())
    content = (whole / f"0{suffix}").read_bytes()
    kept = data.draw(st.integers(0, len(content) - 1))
    (cut / f"0{suffix}").write_bytes(content[:kept])
    paths = (whole, cut) if suffix in (".png", ".jpg") else (whole / f"0{suffix}", cut / f"0{suffix}")
    try:
        read = read_pictures(paths[1])
    except InputError as error:
        assert str(cut) in str(error)  # noqa: PT017 - any other exception fails the test
        return
    expected = read_pictures(paths[0])
    assert len(read) == len(expected)
    for image, other in zip(read.images, expected.images, strict=True):
        np.testing.assert_array_equal(image, other)


def test_a_gif_without_its_palette_is_damaged(tmp_path: Path) -> None:
    path = tmp_path / "a.gif"
    sample(path)
    content = bytearray(path.read_bytes())
    content[10] = 0
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"a\.gif"):
        read_pictures(path)


@pytest.mark.parametrize("suffix", [*SUFFIXES, ".png", ".jpg"])
@MANY
@given(data=st.data())
def test_damaged_bytes_raise_nothing_but_a_sentence(tmp_path: Path, suffix: str, data: st.DataObject) -> None:
    path = tmp_path / f"a{suffix}"
    whole = tmp_path / "whole"
    if not whole.exists():
        if suffix in (".png", ".jpg"):
            Image.fromarray(noise()[0]).save(path)
        else:
            sample(path)
        whole.write_bytes(path.read_bytes())
    content = bytearray(whole.read_bytes())
    for at in data.draw(st.lists(st.integers(0, min(len(content), 400) - 1), min_size=1, max_size=4)):
        content[at] = data.draw(st.integers(0, 255))
    path.write_bytes(content)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TransparentPictures)
        try:
            read_pictures(path)
        except InputError as error:
            assert str(path) in str(error)  # noqa: PT017 - any other exception fails the test


@pytest.mark.parametrize("suffix", [".png", ".tif", ".jpg"])
@pytest.mark.parametrize(("most", "times"), [(2000, 1), (1000, 2), (300, 3)])
def test_a_picture_of_too_many_pixels_is_kept_smaller(
    suffix: str, most: int, times: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its light is averaged over squares of pixels, which may be cut at the end."""
    random = np.random.default_rng(8)
    Image.fromarray(random.integers(0, 256, (37, 54, 3), np.uint8)).save(tmp_path / f"a{suffix}")
    (whole,) = read_pictures(tmp_path / f"a{suffix}", least=1).images
    monkeypatch.setattr(pictures, "MOST_KEPT", most)
    monkeypatch.setattr(pictures, "ROWS", 7)
    (small,) = read_pictures(tmp_path / f"a{suffix}", least=1).images
    assert small.shape[0] * small.shape[1] <= most * 1.1
    wanted = [
        [whole[row : row + times, column : column + times].mean(axis=(0, 1)) for column in range(0, 54, times)]
        for row in range(0, 37, times)
    ]
    if times == 1:
        np.testing.assert_array_equal(small, whole)
    np.testing.assert_allclose(small, wanted, rtol=1e-5)


def test_how_opaque_pictures_were_comes_along(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of those that were not all opaque, also where pictures are made smaller."""
    levels = noise(3, channels=4)
    levels[1, ..., 3] = 255
    for number, each in enumerate(levels):
        Image.fromarray(each).save(tmp_path / f"{number}.png")
    with pytest.warns(TransparentPictures, match=r"^2 of 3"):
        read = read_pictures(tmp_path)
    assert read.opacities[1] is None
    for number in (0, 2):
        opacity = read.opacities[number]
        assert opacity is not None
        np.testing.assert_allclose(opacity, np.asarray(levels[number, ..., 3] / 255, np.float32), atol=1e-6)
    monkeypatch.setattr(pictures, "MOST_KEPT", 5 * 7 // 4)
    with pytest.warns(TransparentPictures):
        smaller = read_pictures(tmp_path).opacities[0]
    assert smaller is not None
    assert smaller.shape == (2, 3)
    assert smaller[0, 0] == pytest.approx(levels[0, :3, :3, 3].mean() / 255, abs=1e-6)


def test_opacities_are_one_for_each_picture_and_of_its_size() -> None:
    image = np.ones((4, 5, 3), np.float32)
    for wrong in ((None, None), (np.ones((5, 4), np.float32),)):
        with pytest.raises(InputError, match="opacities of 1 picture must be one each, of its size, or None"):
            Pictures((image,), ("a",), opacities=wrong)
