"""Colours that are not sRGB: the same light as LittleCMS makes of their profiles, at any depth."""

import io
import struct
import warnings
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import PIL
import pytest
import tifffile
from numpy.typing import NDArray
from PIL import Image, ImageCms, features

from lightcube.io import ChangedPictures, read_pictures
from lightcube.optics.transfer import decode, encode
from tests.io.test_still import chunk, png
from tests.io.test_videos import hlg, in_2020, pq

Array = NDArray[Any]

RANDOM = np.random.default_rng(33)

#: Colourants under D50, as profiles have them, each (X, Y, Z).
SRGB = [(0.43607, 0.22249, 0.01392), (0.38515, 0.71687, 0.09708), (0.14307, 0.06061, 0.71410)]
P3 = [(0.51512, 0.24120, -0.00105), (0.29198, 0.69225, 0.04189), (0.15710, 0.06657, 0.78407)]
ADOBE = [(0.60974, 0.31111, 0.01947), (0.20528, 0.62567, 0.06087), (0.14919, 0.06322, 0.74457)]
PROPHOTO = [(0.79767, 0.28804, 0.0), (0.13519, 0.71188, 0.0), (0.03134, 0.00009, 0.82491)]


def fixed(*values: float) -> bytes:
    return struct.pack(f">{len(values)}i", *[round(value * 65536) for value in values])


def gamma(value: float) -> bytes:
    return b"curv\0\0\0\0" + struct.pack(">IH", 1, round(value * 256))


def table(values: Array) -> bytes:
    return b"curv\0\0\0\0" + struct.pack(">I", len(values)) + np.rint(values * 65535).astype(">u2").tobytes()


def formula(kind: int, *values: float) -> bytes:
    return b"para\0\0\0\0" + struct.pack(">HH", kind, 0) + fixed(*values)


LINEAR = b"curv\0\0\0\0" + struct.pack(">I", 0)
TOE = formula(3, 2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045)
CURVES = {
    "linear": LINEAR,
    "gamma": gamma(2.2),
    "low gamma": gamma(1.8),
    "table": table(np.linspace(0, 1, 1024) ** 2.0),
    "power": formula(0, 1.9),
    "line": formula(1, 2.0, 1.1, -0.1),
    "lifted line": formula(2, 2.0, 0.93, 0.02, 0.05),
    "toe": TOE,
    "two lines": formula(4, 2.4, 0.9, 0.05, 0.1, 0.06, 0.02, 0.0),
}


def profile(curve: bytes, colourants: list[tuple[float, float, float]] | None = None, name: str = "Test") -> bytes:
    """An ICC profile of version 4: RGB where there are colourants, else grey."""
    tags = {}
    if colourants is None:
        tags[b"kTRC"] = curve
    for letter, colourant in zip(b"rgb", colourants or (), strict=False):
        tags[bytes([letter]) + b"XYZ"] = b"XYZ \0\0\0\0" + fixed(*colourant)
        tags[bytes([letter]) + b"TRC"] = curve
    return of_tags(tags, b"RGB " if colourants else b"GRAY", b"XYZ ", name)


def of_tags(tags: dict[bytes, bytes], kind: bytes, shared: bytes, name: str = "Test") -> bytes:
    """An ICC profile of a kind of colours, with what all profiles have."""
    text = name.encode("utf-16-be")
    desc = b"mluc\0\0\0\0" + struct.pack(">II2s2sII", 1, 12, b"en", b"US", len(text), 28) + text
    tags = {b"desc": desc, b"cprt": desc, b"wtpt": b"XYZ \0\0\0\0" + fixed(0.9642, 1, 0.8249), **tags}
    body, entries, start = b"", b"", 132 + 12 * len(tags)
    for tag, content in tags.items():
        entries += struct.pack(">4sII", tag, start + len(body), len(content))
        body += content + b"\0" * (-len(content) % 4)
    head = struct.pack(">I4sI4s4s4s", 0, b"\0" * 4, 0x04300000, b"scnr" if kind == b"CMYK" else b"mntr", kind, shared)
    head += struct.pack(">6H4s", 2026, 1, 1, 0, 0, 0, b"acsp") + b"\0" * 28 + fixed(0.9642, 1, 0.8249) + b"\0" * 48
    return struct.pack(">I", start + len(body)) + head[4:] + struct.pack(">I", len(tags)) + entries + body


#: Lab of each kind of colours: what no colour is, and what each of its samples adds.
LAB = {
    b"GRAY": ((0, 0, 0), [(100, 4, -9)]),
    b"RGB ": ((0, 0, 0), [(30, 22, 6), (55, -20, 12), (15, -2, -18)]),
    b"CMYK": ((100, 0, 0), [(-20, -14, -16), (-25, 24, -2), (-10, -2, 26), (-45, -8, -8)]),
}


def of_tables(kind: bytes, *, deep: bool = True, base: tuple[float, float, float] | None = None) -> bytes:
    """An ICC profile of a table of 8 or 16 bits that only has the corners, with straight lines between them."""
    none, each = LAB[kind]
    corners = np.array(list(np.ndindex(*[2] * len(each)))) @ np.array(each) + np.array(base or none)
    if base:  # what is darker is lifted up to it
        corners = np.maximum(corners, np.array(base))
        corners[-1] = (100, 0, 0)
    full, sort = (65280, ">u2") if deep else (255, "u1")
    middle = 32768 if deep else 128
    numbers = np.stack([corners[:, 0] / 100 * full, *(corners[:, 1:].T * (256 if deep else 1) + middle)], axis=-1)
    line = np.linspace(0, 65535 if deep else 255, 2 if deep else 256).astype(sort).tobytes()
    tag = (b"mft2" if deep else b"mft1") + bytes(4) + bytes((len(each), 3, 2, 0)) + fixed(1, 0, 0, 0, 1, 0, 0, 0, 1)
    tag += struct.pack(">HH", 2, 2) if deep else b""
    tag += line * len(each) + np.rint(numbers).astype(sort).tobytes() + line * 3
    return of_tags({b"A2B0": tag, b"A2B1": tag}, kind, b"Lab ", "Table")


def by_lab(samples: Array, kind: bytes) -> Array:
    """8-bit levels of samples ``(row, column, sample)`` from 0 to 1, by the formulas of Lab."""
    none, each = LAB[kind]
    lab = samples @ np.array(each, float) + np.array(none)
    y = (lab[..., 0] + 16) / 116
    roots = np.stack([y + lab[..., 1] / 500, y, y - lab[..., 2] / 200], axis=-1)
    xyz = np.where(roots > 6 / 29, roots**3, 3 * (6 / 29) ** 2 * (roots - 4 / 29)) * (0.9642, 1, 0.8249)
    return encode(np.clip(xyz @ np.linalg.inv(np.array(SRGB).T).T, 0, 1)) * 255


def tags_of(icc: bytes) -> dict[bytes, bytes]:
    entries = [struct.unpack_from(">4sII", icc, 132 + 12 * at) for at in range(int.from_bytes(icc[128:132], "big"))]
    return {name: icc[start : start + length] for name, start, length in entries}


def read(path: Path) -> Array:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ChangedPictures)
        return read_pictures(path, least=1).images[0]


def by_littlecms(picture: Array, icc: bytes) -> Array:
    """8-bit levels as LittleCMS turns them into sRGB."""
    image, grey = Image.fromarray(picture), picture.ndim == 2
    turned = ImageCms.profileToProfile(
        image,
        ImageCms.ImageCmsProfile(io.BytesIO(icc)),
        ImageCms.createProfile("sRGB"),
        renderingIntent=ImageCms.Intent.RELATIVE_COLORIMETRIC,
        outputMode="RGB" if grey else None,
        flags=ImageCms.Flags.NOOPTIMIZE,
    )
    assert turned is not None
    return np.asarray(turned)


def noise(*shape: int, kind: type[Any] = np.uint8) -> Array:
    return RANDOM.integers(0, np.iinfo(kind).max + 1, shape, dtype=kind)


@pytest.mark.parametrize("curve", CURVES)
@pytest.mark.parametrize(
    "colourants", [SRGB, P3, ADOBE, PROPHOTO, None], ids=["srgb", "p3", "adobe", "prophoto", "grey"]
)
def test_the_same_colours_as_littlecms(tmp_path: Path, curve: str, colourants: Any) -> None:
    icc = profile(CURVES[curve], colourants)
    picture = noise(9, 13, 3) if colourants else noise(9, 13)
    Image.fromarray(picture).save(tmp_path / "a.png", icc_profile=icc)
    wanted = by_littlecms(picture, icc)
    # Of 8 bits LittleCMS rounds; near black the steepest curves make more of that.
    np.testing.assert_allclose(np.rint(encode(read(tmp_path / "a.png")) * 255), wanted, atol=2.1)


@pytest.mark.parametrize("colourants", [P3, None], ids=["p3", "grey"])
@pytest.mark.parametrize("suffix", [".png", ".jpg", ".webp", ".tif", "16.png", "16.tif"])
def test_every_kind_of_file_can_have_a_profile(tmp_path: Path, suffix: str, colourants: Any) -> None:
    icc = profile(gamma(1.8), colourants)
    picture = np.full((9, 13, 3), (60, 130, 220), np.uint8) if colourants else np.full((9, 13), 130, np.uint8)
    path = tmp_path / f"a{suffix}"
    if suffix == "16.png":
        deep = np.atleast_3d(picture).astype(np.uint16) * 257
        png(path, deep, chunk(b"iCCP", b"x\0\0" + zlib.compress(icc)))
    elif suffix == "16.tif":
        kind = "rgb" if colourants else "minisblack"
        tifffile.imwrite(path, picture.astype(np.uint16) * 257, photometric=kind, iccprofile=icc)
    else:
        lossless = {"lossless": True} if suffix == ".webp" else {"quality": 100} if suffix == ".jpg" else {}
        Image.fromarray(picture).save(path, icc_profile=icc, **lossless)
    with pytest.warns(ChangedPictures, match=r"^1 of 1 picture in .* not sRGB \(Test: turned into sRGB\)$"):
        image = read_pictures(path, least=1).images[0]
    np.testing.assert_allclose(encode(image) * 255, np.broadcast_to(by_littlecms(picture, icc), image.shape), atol=2.1)


#: How each kind of file is saved, by the end of its name.
OPTIONS: dict[str, dict[str, Any]] = {
    ".webp": {"lossless": True},
    ".jpg": {"quality": 100},
    "lzw.tif": {"compression": "tiff_lzw"},
    "jpeg.tif": {"compression": "jpeg"},
}


@pytest.mark.parametrize("deep", [True, False], ids=["16-bit table", "8-bit table"])
@pytest.mark.parametrize(
    ("suffix", "kind"),
    [
        *((suffix, kind) for suffix in (".png", ".jpg", ".tif") for kind in (b"RGB ", b"GRAY")),
        (".webp", b"RGB "),
        *(("16.png", kind) for kind in (b"RGB ", b"GRAY")),
        *(("16.tif", kind) for kind in LAB),
        *((suffix, b"CMYK") for suffix in (".jpg", ".tif", "lzw.tif", "jpeg.tif")),
    ],
)
def test_tables_are_followed(tmp_path: Path, suffix: str, kind: bytes, *, deep: bool) -> None:
    """One colour a file: JPEG mixes neighbours."""
    icc, path = of_tables(kind, deep=deep), tmp_path / f"a{suffix}"
    for colour in ([0.2, 0.5, 0.4, 0.1], [0.8, 0.7, 0.75, 0.3], [0, 0, 0, 0], [1, 1, 1, 1]):
        levels = np.rint(np.full((9, 13, 4), colour)[..., : len(LAB[kind][1])] * 255).astype(np.uint8)
        plain = levels[..., 0] if kind == b"GRAY" else levels
        if suffix == "16.png":
            png(path, levels.astype(np.uint16) * 257, chunk(b"iCCP", b"x\0\0" + zlib.compress(icc)))
        elif suffix == "16.tif":
            photometric = {b"RGB ": "rgb", b"GRAY": "minisblack", b"CMYK": "separated"}[kind]
            tifffile.imwrite(path, plain.astype(np.uint16) * 257, photometric=photometric, iccprofile=icc)
        else:
            mode = {b"GRAY": "L", b"RGB ": "RGB", b"CMYK": "CMYK"}[kind]
            options = OPTIONS.get(suffix, {})
            Image.frombytes(mode, (13, 9), plain.tobytes()).save(path, icc_profile=icc, **options)
        with pytest.warns(ChangedPictures, match=r"not sRGB \(Table, in 8 bits: turned into sRGB\)$"):
            image = read_pictures(path, least=1).images[0]
        np.testing.assert_allclose(encode(image) * 255, by_lab(levels / 255, kind), atol=3.1 if deep else 5.1)


@pytest.mark.parametrize("kind", [b"RGB ", b"GRAY"])
def test_the_darkest_of_a_table_is_black_and_its_white_is_white(tmp_path: Path, kind: bytes) -> None:
    picture = np.zeros((2, 2, 3), np.uint8)
    picture[1] = 255
    plain = picture if kind == b"RGB " else picture[..., 0]
    Image.fromarray(plain).save(tmp_path / "a.png", icc_profile=of_tables(kind, base=(12, 0, 0)))
    np.testing.assert_allclose(encode(read(tmp_path / "a.png")) * 255, picture, atol=1.1)


def test_tables_go_before_curves(tmp_path: Path) -> None:
    table, curves = of_tables(b"RGB "), profile(gamma(1.8), P3)
    both = {name: data for icc in (curves, table) for name, data in tags_of(icc).items()}
    picture = noise(9, 13, 3)
    images = []
    for icc in (table, of_tags(both, b"RGB ", b"Lab ")):
        Image.fromarray(picture).save(tmp_path / "a.png", icc_profile=icc)
        images.append(read(tmp_path / "a.png"))
    np.testing.assert_array_equal(images[0], images[1])


@pytest.mark.parametrize(
    ("mode", "kind"), [("CMYK", b"RGB "), ("CMYK", b"GRAY"), ("RGB", b"CMYK"), ("L", b"CMYK"), ("CMYK", b"cut")]
)
def test_profiles_of_other_colours_are_told(tmp_path: Path, mode: str, kind: bytes) -> None:
    icc = of_tables(kind) if kind in LAB else of_tables(b"CMYK")[:400]
    picture = Image.frombytes(mode, (4, 4), noise(4, 4, Image.getmodebands(mode)).tobytes())
    picture.save(tmp_path / "a.tif", icc_profile=icc)
    picture.save(tmp_path / "b.tif")
    with pytest.warns(ChangedPictures, match="1 of 2 .* taken as sRGB"):
        images = read_pictures(tmp_path).images
    np.testing.assert_array_equal(images[0], images[1])


def test_16_bits_keep_all_their_bits(tmp_path: Path) -> None:
    picture = noise(9, 13, 3, kind=np.uint16)
    tifffile.imwrite(tmp_path / "a.tif", picture, photometric="rgb", iccprofile=profile(LINEAR, SRGB))
    np.testing.assert_allclose(read(tmp_path / "a.tif"), picture / 65535, atol=3e-5)


@pytest.mark.parametrize(
    "icc", [profile(TOE, SRGB), ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()]
)
def test_srgb_is_not_told(tmp_path: Path, icc: bytes) -> None:
    picture = noise(9, 13, 3)
    Image.fromarray(picture).save(tmp_path / "a.png", icc_profile=icc)
    np.testing.assert_array_equal(read_pictures(tmp_path, least=1).images[0], decode(picture / np.float32(255)))


def test_linear_transfer_means_the_numbers(tmp_path: Path) -> None:
    picture = noise(9, 13, 3)
    Image.fromarray(picture).save(tmp_path / "a.png", icc_profile=profile(gamma(1.8), P3))
    image = read_pictures(tmp_path, transfer="linear", least=1).images[0]
    np.testing.assert_array_equal(image, picture / np.float32(255))


@pytest.mark.parametrize("icc", [b"nonsense", profile(LINEAR, P3)[:300], profile(b"unkn" + bytes(8), P3)])
def test_what_is_not_known_is_told_and_taken_as_srgb(tmp_path: Path, icc: bytes) -> None:
    picture = noise(9, 13, 3)
    Image.fromarray(picture).save(tmp_path / "0.png", icc_profile=icc)
    Image.fromarray(picture).save(tmp_path / "1.png", icc_profile=profile(gamma(1.8), P3, "Wide"))
    with pytest.warns(
        ChangedPictures, match=r"^2 of 2 .*Wide: turned into sRGB; .*: not known here and taken as sRGB"
    ) as caught:
        image = read_pictures(tmp_path).images[0]
    assert len(caught) == 1
    np.testing.assert_array_equal(image, decode(picture / np.float32(255)))


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
@pytest.mark.parametrize(
    ("numbers", "curve", "colourants"),
    [((12, 13), TOE, P3), ((12, 8), LINEAR, P3), ((1, 8), LINEAR, SRGB), ((9, 13), TOE, None)],
)
def test_cicp_of_a_png(
    tmp_path: Path, numbers: tuple[int, int], curve: bytes, colourants: Any, kind: type[Any]
) -> None:
    colours = [(0.67349, 0.27904, -0.00193), (0.16567, 0.67534, 0.02998), (0.12507, 0.04562, 0.79686)]  # BT.2020
    icc = profile(curve, colourants or colours)
    picture = noise(9, 13, 3)
    deep = picture.astype(kind) * (257 if kind is np.uint16 else 1)
    path = png(tmp_path / "a.png", deep, chunk(b"cICP", bytes([*numbers, 0, 1])))
    np.testing.assert_allclose(encode(read(path)) * 255, by_littlecms(picture, icc), atol=2.1)


@pytest.mark.parametrize(
    "numbers", [(9, 17, 0, 1), (9, 16, 9, 1), (9, 18, 0, 0), (12, 13, 1, 1), (12, 13, 0, 0), (77, 13, 0, 1)]
)
def test_cicp_that_is_not_known_is_told(tmp_path: Path, numbers: tuple[int, ...]) -> None:
    png(tmp_path / "a.png", noise(9, 13, 3), chunk(b"cICP", bytes(numbers)))
    with pytest.warns(ChangedPictures, match="cICP .* taken as sRGB"):
        read_pictures(tmp_path, least=1)


def gama(value: float) -> bytes:
    return chunk(b"gAMA", struct.pack(">I", round(value * 100_000)))


def chrm(*places: float) -> bytes:
    """White, red, green and blue, each as x and y."""
    return chunk(b"cHRM", struct.pack(">8I", *[round(each * 100_000) for each in places]))


D65, D50 = (0.3127, 0.3290), (0.3457, 0.3585)
OF_SRGB = chrm(*D65, 0.64, 0.33, 0.30, 0.60, 0.15, 0.06)
OF_P3 = chrm(*D65, 0.68, 0.32, 0.265, 0.69, 0.15, 0.06)
OF_PROPHOTO = chrm(*D50, 0.7347, 0.2653, 0.1596, 0.8404, 0.0366, 0.0001)


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
@pytest.mark.parametrize(
    ("said", "curve", "colourants"),
    [
        (gama(1 / 1.8), gamma(1.8), SRGB),
        (gama(1), LINEAR, SRGB),
        (gama(1 / 2.2) + OF_P3, TOE, P3),
        (gama(1 / 1.8) + OF_P3, gamma(1.8), P3),
        (OF_P3, TOE, P3),
        (gama(1 / 1.8) + OF_PROPHOTO, gamma(1.8), PROPHOTO),
    ],
)
def test_gamma_and_primaries_of_a_png(
    tmp_path: Path, said: bytes, curve: bytes, colourants: Any, kind: type[Any]
) -> None:
    picture = noise(9, 13, 3)
    deep = picture.astype(kind) * (257 if kind is np.uint16 else 1)
    image = read(png(tmp_path / "a.png", deep, said))
    np.testing.assert_allclose(encode(image) * 255, by_littlecms(picture, profile(curve, colourants)), atol=2.1)


@pytest.mark.parametrize(
    "said",
    [
        gama(1 / 2.2),
        gama(0.455),
        OF_SRGB,
        gama(1 / 2.2) + OF_SRGB,
        gama(1) + OF_P3 + chunk(b"sRGB", b"\0"),
        gama(1) + OF_P3 + chunk(b"cICP", bytes((1, 13, 0, 1))),
        gama(1) + chunk(b"iCCP", b"x\0\0" + zlib.compress(profile(TOE, SRGB))),
    ],
)
def test_gamma_and_primaries_of_srgb_are_not_told(tmp_path: Path, said: bytes) -> None:
    """Nor those beside a chunk that goes before them."""
    picture = noise(9, 13, 3)
    image = read_pictures(png(tmp_path / "a.png", picture, said), least=1).images[0]
    np.testing.assert_array_equal(image, decode(picture / np.float32(255)))


#: Earlier Pillows read no picture at all behind a chunk of a wrong length.
GIVEN_UP_BEFORE_13 = pytest.mark.skipif(int(PIL.__version__.split(".")[0]) < 13, reason="this Pillow gives up there")


@pytest.mark.parametrize(
    "said",
    [
        gama(0),
        chunk(b"gAMA", bytes(5)),
        chrm(*[0] * 8),
        chrm(*D65, *[0.3] * 6),
        pytest.param(chunk(b"cHRM", bytes(33)), marks=GIVEN_UP_BEFORE_13),
    ],
)
def test_damaged_gamma_and_primaries_are_told(tmp_path: Path, said: bytes) -> None:
    path = png(tmp_path / "a.png", noise(9, 13, 3), said)
    with pytest.warns(ChangedPictures, match="a damaged (gAMA|cHRM).* taken as sRGB"):
        read_pictures(path, least=1)


@pytest.mark.parametrize(("curve", "code"), [(pq, 16), (hlg, 18)])
@pytest.mark.parametrize("suffix", [".png", ".avif"])
def test_high_dynamic_range_is_dimmed_as_that_of_films(tmp_path: Path, curve: Any, code: int, suffix: str) -> None:
    """Light up to white comes back; what is brighter keeps its hue."""
    if suffix == ".avif" and not features.check("avif"):
        pytest.skip("this Pillow has no AVIF")
    light = np.ones((16, 32, 1)) * np.array([0.7, 0.3, 0.15])
    light[:, 16:] = (3.0, 1.5, 0.75)
    display, path = curve(in_2020(light)), tmp_path / f"a{suffix}"
    if suffix == ".png":
        png(path, np.rint(display * 65535).astype(np.uint16), chunk(b"cICP", bytes((9, code, 0, 1))))
    else:
        Image.fromarray(np.rint(display * 255).astype(np.uint8)).save(path, quality=100, subsampling="4:4:4")
        renumbered(path, 9, code)
    with pytest.warns(ChangedPictures, match=r"BT\.2020 (PQ|HLG).*: turned into sRGB"):
        shown = read_pictures(path, least=1).images[0]
    close = 0.01 if suffix == ".png" else 0.2  # a level of PQ in 8 bits is one part in 40
    np.testing.assert_allclose(shown[4:12, 4:12], light[4:12, 4:12], rtol=close)
    np.testing.assert_allclose(shown[4:12, 20:28], light[4:12, 20:28] / 3, rtol=close)


def renumbered(path: Path, primaries: int, curve: int) -> None:
    """Let a container of pictures name other colours."""
    data = bytearray(path.read_bytes())
    struct.pack_into(">2H", data, data.index(b"colrnclx") + 8, primaries, curve)
    path.write_bytes(data)


@pytest.mark.skipif(not features.check("avif"), reason="this Pillow has no AVIF")
@pytest.mark.parametrize(
    ("primaries", "curve", "colourants"),
    [(12, 13, P3), (12, 1, P3), (12, 2, P3), (1, 13, None), (1, 1, None), (2, 2, None), (77, 13, None)],
)
def test_numbers_of_an_avif(tmp_path: Path, primaries: int, curve: int, colourants: Any) -> None:
    path, picture = tmp_path / "a.avif", np.full((16, 16, 3), (200, 120, 60), np.uint8)
    Image.fromarray(picture).save(path, quality=100, subsampling="4:4:4")
    renumbered(path, primaries, curve)
    wanted = by_littlecms(picture, profile(TOE, colourants)) if colourants else picture
    image = read(path) if colourants else read_pictures(path, least=1).images[0]
    np.testing.assert_allclose(encode(image) * 255, wanted, atol=4)


def test_a_camera_names_adobe_rgb_in_its_exif(tmp_path: Path) -> None:
    exif = Image.Exif()
    exif.get_ifd(0x8769)[0xA001] = 65535
    exif.get_ifd(0x8769)[0xA005] = {1: "R03"}
    picture = np.full((8, 8, 3), (60, 130, 200), np.uint8)
    Image.fromarray(picture).save(tmp_path / "a.jpg", quality=100, exif=exif)
    with pytest.warns(ChangedPictures, match="Adobe RGB"):
        image = read_pictures(tmp_path, least=1).images[0]
    wanted = by_littlecms(picture, profile(gamma(563 / 256), ADOBE))
    np.testing.assert_allclose(encode(image) * 255, wanted, atol=3)
