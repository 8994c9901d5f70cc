"""TIFF files of every kind give the picture that was meant, with and without the extra, or a sentence."""

import random
import sys
import warnings
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile
from numpy.typing import NDArray
from PIL import Image, ImageOps

from lightcube.errors import InputError
from lightcube.io import TransparentPictures, read_pictures
from lightcube.optics.transfer import decode

Array = NDArray[Any]

RANDOM = np.random.default_rng(31)
SHALLOW, DEEP = 255, 65535


def levels(channels: int, full: int = DEEP, rows: int = 19, columns: int = 37) -> Array:
    """A picture of unequal sides, more than one tile of 16 each way."""
    kind = np.uint8 if full == SHALLOW else np.uint16
    return RANDOM.integers(0, full + 1, (rows, columns, channels), dtype=kind)


def read(path: Path, which: int = 0) -> Array:
    """Display values of one picture, 0 to 1."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TransparentPictures)
        return read_pictures(path, transfer="linear", least=1).images[which]


def written(path: Path, data: Array, **options: Any) -> Path:
    """A TIFF by tifffile; planes stand first where `planarconfig` is separate."""
    tifffile.imwrite(path, data, metadata=None, **options)
    return path


def on_white(colours: Array, opacity: Array) -> Array:
    return opacity * colours + (1 - opacity)


@pytest.fixture(params=["with", "without"])
def extra(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Whether imagecodecs is there to be imported."""
    if request.param == "with":
        pytest.importorskip("imagecodecs", reason="imagecodecs is not installed")
    else:
        for name in [name for name in sys.modules if name.partition(".")[0] == "tifffile"]:
            monkeypatch.delitem(sys.modules, name)
        monkeypatch.setitem(sys.modules, "imagecodecs", None)
    return str(request.param)


@pytest.mark.parametrize("full", [SHALLOW, DEEP])
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"byteorder": ">"},
        {"bigtiff": True},
        {"bigtiff": True, "byteorder": ">"},
        {"tile": (16, 16)},
        {"rowsperstrip": 5},
        {"compression": "zlib"},
        {"compression": "zlib", "predictor": True},
        {"compression": "zlib", "predictor": True, "tile": (16, 16), "byteorder": ">"},
        {"compression": "lzma"},
    ],
    ids=str,
)
def test_layouts_without_the_extra(tmp_path: Path, extra: str, options: dict[str, Any], full: int) -> None:
    picture = levels(3, full)
    path = written(tmp_path / "a.tif", picture, photometric="rgb", **options)
    np.testing.assert_allclose(read(path), picture / full, atol=1e-7)
    planes = written(tmp_path / "b.tif", np.moveaxis(picture, 2, 0), photometric="rgb", planarconfig=2, **options)
    np.testing.assert_allclose(read(planes), picture / full, atol=1e-7)


@pytest.mark.parametrize("full", [SHALLOW, DEEP])
@pytest.mark.parametrize("compression", ["lzw", "zstd", "packbits", "jpeg2000", "jpegxl", "png"])
def test_other_ways_of_packing_need_the_extra(tmp_path: Path, compression: str, full: int) -> None:
    pytest.importorskip("imagecodecs", reason="imagecodecs is not installed")
    picture = levels(3, full)
    lossless = {"compressionargs": {"level": 0, "reversible": True}} if compression == "jpeg2000" else {}
    lossless = {"compressionargs": {"lossless": True}} if compression == "jpegxl" else lossless
    path = written(tmp_path / "a.tif", picture, photometric="rgb", compression=compression, **lossless)
    np.testing.assert_allclose(read(path), picture / full, atol=1e-7)


@pytest.mark.parametrize("compression", ["lzw", "zstd"])
def test_without_the_extra_a_sentence_names_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, compression: str
) -> None:
    pytest.importorskip("imagecodecs", reason="imagecodecs is not installed")
    deep = written(tmp_path / "a.tif", levels(3), photometric="rgb", compression=compression)
    shallow = levels(3, SHALLOW)
    plain = written(tmp_path / "b.tif", shallow, photometric="rgb", compression="lzw", predictor=True)
    for name in [name for name in sys.modules if name.partition(".")[0] == "tifffile"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "imagecodecs", None)
    with pytest.raises(InputError, match=rf"a\.tif: .*{compression.upper()}, 16 bits.*lightcube\[tiff\]"):
        read(deep)
    np.testing.assert_allclose(read(plain), shallow / SHALLOW, atol=1e-7)


@pytest.mark.parametrize("full", [SHALLOW, DEEP])
class TestColours:
    def test_grey(self, tmp_path: Path, extra: str, full: int) -> None:
        picture = levels(1, full)
        black = written(tmp_path / "a.tif", picture[..., 0], photometric="minisblack")
        white = written(tmp_path / "b.tif", full - picture[..., 0], photometric="miniswhite")
        for path in (black, white):
            np.testing.assert_allclose(read(path), np.broadcast_to(picture / full, (19, 37, 3)), atol=1e-7)

    def test_grey_with_opacity(self, tmp_path: Path, extra: str, full: int) -> None:
        picture = levels(2, full)
        path = written(tmp_path / "a.tif", picture, photometric="minisblack", planarconfig=1, extrasamples=[2])
        wanted = on_white(picture[..., :1] / full, picture[..., 1:] / full)
        np.testing.assert_allclose(read(path), np.broadcast_to(wanted, (19, 37, 3)), atol=1e-6)

    @pytest.mark.parametrize("kinds", [[2], [0, 2], [2, 0]])
    def test_opacity_among_spare_samples(self, tmp_path: Path, extra: str, full: int, kinds: list[int]) -> None:
        picture = levels(3 + len(kinds), full)
        path = written(tmp_path / "a.tif", picture, photometric="rgb", planarconfig=1, extrasamples=kinds)
        at = 3 + kinds.index(2)
        wanted = on_white(picture[..., :3] / full, picture[..., at : at + 1] / full)
        np.testing.assert_allclose(read(path), wanted, atol=1e-6)

    @pytest.mark.parametrize("kinds", [[0], [0, 0]])
    def test_spare_samples_are_no_opacity(self, tmp_path: Path, extra: str, full: int, kinds: list[int]) -> None:
        picture = levels(3 + len(kinds), full)
        path = written(tmp_path / "a.tif", picture, photometric="rgb", planarconfig=1, extrasamples=kinds)
        np.testing.assert_allclose(read(path), picture[..., :3] / full, atol=1e-7)

    def test_colours_with_opacity_multiplied_in(self, tmp_path: Path, extra: str, full: int) -> None:
        straight, opacity = levels(3, full) / full, levels(1, full) / full
        opacity[:3], opacity[3:6] = 0, 1
        picture = np.rint(np.concatenate([straight * opacity, opacity], axis=2) * full)
        path = written(
            tmp_path / "a.tif",
            picture.astype(levels(1, full).dtype),
            photometric="rgb",
            planarconfig=1,
            extrasamples=[1],
        )
        # What is divided out is put on white with the same opacity again: one level of rounding stays.
        np.testing.assert_allclose(read(path), on_white(straight, opacity), atol=0.75 / full + 1e-5)

    @pytest.mark.parametrize("kinds", [[], [2]])
    def test_inks(self, tmp_path: Path, extra: str, full: int, kinds: list[int]) -> None:
        picture = levels(4 + len(kinds), full)
        picture[..., 4:] = full
        path = written(tmp_path / "a.tif", picture, photometric="separated", planarconfig=1, extrasamples=kinds)
        light = 1 - picture / full
        np.testing.assert_allclose(read(path), light[..., :3] * light[..., 3:4], atol=0.51 / full + 1e-7)

    def test_lab(self, tmp_path: Path, extra: str, full: int) -> None:
        wanted = np.array(
            [[[1, 1, 1], [0.5, 0.5, 0.5], [0.8, 0.3, 0.2]], [[0.2, 0.6, 0.3], [0.2, 0.3, 0.7], [0, 0, 0]]]
        )
        path = written(tmp_path / "a.tif", of_lab(wanted, full), photometric="cielab", planarconfig=1)
        np.testing.assert_allclose(read(path), wanted, atol=0.02 if full == SHALLOW else 4e-4)


def of_lab(colours: Array, full: int) -> Array:
    """sRGB as CIE L*a*b* under D50 in a TIFF's numbers, by the matrix of the sRGB profile."""
    matrix = np.array([[0.43607, 0.38515, 0.14307], [0.22249, 0.71687, 0.06061], [0.01392, 0.09708, 0.71410]])
    xyz = decode(colours) @ matrix.T / matrix.sum(axis=1)
    roots = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    lab = np.stack(
        [116 * roots[..., 1] - 16, 500 * (roots[..., 0] - roots[..., 1]), 200 * (roots[..., 1] - roots[..., 2])],
        axis=-1,
    )
    if full == SHALLOW:
        return np.rint(lab * [2.55, 1, 1]).astype(np.int16).astype(np.uint8)
    return np.rint(lab * [655.35, 256, 256]).astype(np.int32).astype(np.uint16)


@pytest.mark.parametrize("bits", [2, 4, 6, 10, 12, 14])
@pytest.mark.parametrize("channels", [1, 3])
def test_odd_numbers_of_bits_fill_the_range(tmp_path: Path, bits: int, channels: int) -> None:
    pytest.importorskip("imagecodecs", reason="imagecodecs is not installed")
    most = 2**bits - 1
    picture = RANDOM.integers(0, most + 1, (19, 37, channels), dtype=np.uint16 if bits > 8 else np.uint8)
    data, photometric = (picture[..., 0], "minisblack") if channels == 1 else (picture, "rgb")
    try:
        path = written(tmp_path / "a.tif", data, photometric=photometric, bitspersample=bits)
    except NotImplementedError:
        pytest.skip("this imagecodecs reads such bits and cannot write them")
    np.testing.assert_allclose(
        read(path), np.broadcast_to(picture / most, (19, 37, 3)), atol=0.5 / (255 if bits < 8 else 65535) + 1e-7
    )


@pytest.mark.parametrize("full", [SHALLOW, DEEP])
@pytest.mark.parametrize("channels", [1, 3, 4])
@pytest.mark.parametrize("options", [{}, {"tile": (16, 16)}, {"compression": "zlib"}], ids=str)
@pytest.mark.parametrize("orientation", range(1, 9))
def test_every_kind_is_turned_upright(
    tmp_path: Path, orientation: int, options: dict[str, Any], channels: int, full: int
) -> None:
    picture = levels(channels, full)
    picture[..., 3:] = full
    tag = [(274, 3, 1, orientation, True)]
    kind = "minisblack" if channels == 1 else "rgb"
    path = written(
        tmp_path / "a.tif", picture[..., 0] if channels == 1 else picture, photometric=kind, extratags=tag, **options
    )
    image = Image.fromarray(np.broadcast_to(np.arange(19 * 37, dtype=np.int32).reshape(19, 37), (19, 37)))
    image.getexif()[0x0112] = orientation
    order = np.asarray(ImageOps.exif_transpose(image))
    wanted = np.broadcast_to(picture[..., :3], (19, 37, 3)).reshape(-1, 3)[order] / full
    np.testing.assert_allclose(read(path), wanted, atol=1e-7)


@pytest.mark.parametrize("mode", ["1", "L", "P", "RGB", "RGBA", "CMYK", "YCbCr"])
@pytest.mark.parametrize("compression", ["raw", "tiff_lzw", "packbits", "tiff_deflate", "jpeg", "group4"])
def test_shallow_pages_are_as_pillow_has_them(tmp_path: Path, extra: str, mode: str, compression: str) -> None:
    if (compression == "group4") != (mode == "1") or (compression == "jpeg" and mode in ("P", "RGBA")):
        pytest.skip("not packed so")
    if mode == "YCbCr" and compression != "jpeg":
        pytest.skip("its upsampling is libtiff's")
    image = Image.fromarray(levels(4, SHALLOW)).convert(mode if mode != "CMYK" else "RGB").convert(mode)
    image.save(tmp_path / "a.tif", compression=compression)
    with Image.open(tmp_path / "a.tif") as again:
        wanted = np.asarray(again.convert("RGBA")) / 255
    np.testing.assert_allclose(read(tmp_path / "a.tif"), on_white(wanted[..., :3], wanted[..., 3:]), atol=1e-6)


class TestPages:
    def test_deep_pages(self, tmp_path: Path, extra: str) -> None:
        pages = [levels(3), levels(3, rows=7)]
        with tifffile.TiffWriter(tmp_path / "a.tif") as file:
            for page in pages:
                file.write(page, photometric="rgb", metadata=None)
        found = read_pictures(tmp_path / "a.tif", transfer="linear")
        for image, page in zip(found.images, pages, strict=True):
            np.testing.assert_allclose(image, page / DEEP, atol=1e-7)

    @pytest.mark.parametrize("first", [0, 1])
    @pytest.mark.parametrize("full", [SHALLOW, DEEP])
    def test_thumbnails_and_masks_are_left_out(self, tmp_path: Path, first: int, full: int) -> None:
        picture, mask = levels(3, full), np.ones((19, 37), bool)
        thumbnail = picture[::4, ::4]
        with tifffile.TiffWriter(tmp_path / "a.tif") as file:
            parts: list[tuple[Array, dict[str, Any]]] = [
                (picture, {"photometric": "rgb"}),
                (thumbnail, {"photometric": "rgb", "subfiletype": 1}),
                (thumbnail, {"photometric": "rgb", "extratags": [(255, 3, 1, 2, True)]}),
                (mask, {"photometric": "mask", "subfiletype": 4}),
                (mask, {"photometric": "minisblack", "subfiletype": 5}),
            ]
            for part, options in parts[first:] + parts[:first]:
                file.write(part, metadata=None, **options)
        found = read_pictures(tmp_path / "a.tif", transfer="linear", least=1)
        assert len(found) == 1
        np.testing.assert_allclose(found.images[0], picture / full, atol=1e-7)
        np.testing.assert_array_equal(read_pictures(tmp_path, transfer="linear", least=1).images[0], found.images[0])

    def test_a_reduced_picture_alone_is_the_picture(self, tmp_path: Path) -> None:
        picture = levels(3)
        path = written(tmp_path / "a.tif", picture, photometric="rgb", subfiletype=1)
        np.testing.assert_allclose(read(path), picture / DEEP, atol=1e-7)


class TestRefused:
    @pytest.mark.parametrize("kind", [np.float32, np.float64, np.int16, np.uint32])
    @pytest.mark.parametrize("channels", [1, 3])
    def test_numbers(self, tmp_path: Path, extra: str, kind: type[Any], channels: int) -> None:
        data = np.zeros((5, 7, channels), kind)
        photometric = "rgb" if channels == 3 else "minisblack"
        path = written(tmp_path / "a.tif", data if channels == 3 else data[..., 0], photometric=photometric)
        with pytest.raises(InputError, match=r"a\.tif holds numbers"):
            read(path)

    @pytest.mark.parametrize("kind", ["cfa", "logluv", "itulab"])
    def test_other_colours(self, tmp_path: Path, kind: str) -> None:
        data = levels(1)[..., 0] if kind == "cfa" else levels(3)
        path = written(tmp_path / "a.tif", data, photometric=kind)
        with pytest.raises(InputError, match=rf"a\.tif has colours of a kind that is not read \({kind.upper()}\)"):
            read(path)

    def test_other_inks(self, tmp_path: Path) -> None:
        path = written(tmp_path / "a.tif", levels(4), photometric="separated", extratags=[(332, 3, 1, 2, True)])
        with pytest.raises(InputError, match="colours of a kind"):
            read(path)

    @pytest.mark.parametrize("tag", ["StripOffsets", "StripByteCounts"])
    def test_missing_pixels(self, tmp_path: Path, tag: str) -> None:
        path = written(tmp_path / "a.tif", levels(3), photometric="rgb", compression="zlib", rowsperstrip=5)
        with tifffile.TiffFile(path, mode="r+") as file:
            found = file.pages.first.tags[tag]
            found.overwrite([0, *found.value[1:]])
        with pytest.raises(InputError, match="lacks some of its pixels"):
            read(path)

    @pytest.mark.parametrize("options", [{}, {"compression": "zlib"}, {"tile": (16, 16)}], ids=str)
    def test_pixels_beyond_the_end(self, tmp_path: Path, extra: str, options: dict[str, Any]) -> None:
        path = written(tmp_path / "a.tif", levels(3), photometric="rgb", **options)
        path.write_bytes(path.read_bytes()[:-100])
        with pytest.raises(InputError, match="damaged or cut short"):
            read(path)

    def test_masks_alone(self, tmp_path: Path) -> None:
        for name in ("a.tif", "b.tif"):
            written(tmp_path / name, np.ones((5, 7), bool), photometric="mask", subfiletype=4)
        for path in (tmp_path, tmp_path / "a.tif"):
            with pytest.raises(InputError, match=r"a\.tif holds masks"):
                read(path)

    @pytest.mark.parametrize(
        "tag", ["ImageWidth", "BitsPerSample", "TileWidth", "Compression", "PhotometricInterpretation"]
    )
    @pytest.mark.parametrize(
        "kind", [b"\x02\0", b"\x03\0", b"\x05\0", b"\x0c\0"], ids=["text", "short", "ratio", "real"]
    )
    def test_tags_of_the_wrong_kind(self, tmp_path: Path, tag: str, kind: bytes) -> None:
        path = written(tmp_path / "a.tif", levels(1)[..., 0], photometric="minisblack", tile=(16, 16))
        with tifffile.TiffFile(path) as file:
            at = file.pages.first.tags[tag].offset
        data = bytearray(path.read_bytes())
        data[at + 2 : at + 4], data[at + 8 : at + 12] = kind, bytes(4)
        path.write_bytes(data)
        with suppress(InputError):  # some tags can be done without; no other exception is allowed
            read(path)


def test_libtiff_prints_nothing(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """What it would say of damage is a sentence of the reader's."""
    path = tmp_path / "a.tif"
    Image.effect_noise((40, 40), 90).convert("1").save(path, compression="group4")
    honest = path.read_bytes()
    refused = 0
    for number in range(60):
        chance = random.Random(number)  # noqa: S311 - the same each time
        data = bytearray(honest)
        for _ in range(4):
            data[chance.randrange(8, len(data))] = chance.randrange(256)
        path.write_bytes(data)
        try:
            read_pictures(path, least=1)
        except InputError:
            refused += 1
    assert refused > 10
    assert capfd.readouterr() == ("", "")
