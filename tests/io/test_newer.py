"""AVIF and HEIC: pictures as others, or a sentence that says what is missing."""

import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image, ImageOps, features

from lightcube.errors import InputError
from lightcube.io import TransparentPictures, read_pictures
from lightcube.optics.transfer import to_uint8

HEIC = Path(__file__).parent / "files" / "four-colours.heic"
COLOURS = np.array([[(220, 30, 40), (30, 180, 60)], [(40, 60, 210), (240, 220, 30)]], np.uint8)
PICTURE = COLOURS.repeat(32, 0).repeat(48, 1)

needs_avif = pytest.mark.skipif(not features.check("avif"), reason="this Pillow has no AVIF")


def off(shown: NDArray[np.float32], wanted: NDArray[np.uint8]) -> int:
    levels = to_uint8(shown)
    assert levels.shape == wanted.shape
    return int(np.max(np.abs(levels.astype(int) - wanted)))


@needs_avif
@pytest.mark.parametrize("orientation", range(1, 9))
def test_avifs_are_pictures_of_a_folder(tmp_path: Path, orientation: int) -> None:
    image, exif = Image.fromarray(PICTURE), Image.Exif()
    exif[0x0112] = orientation
    for name in ("1.avif", "2.AVIF"):
        image.save(tmp_path / name, "AVIF", quality=100, subsampling="4:4:4", exif=exif.tobytes())
    image.getexif()[0x0112] = orientation
    read = read_pictures(tmp_path)
    assert read.names == ("1", "2")
    for shown in read.images:
        assert off(shown, np.asarray(ImageOps.exif_transpose(image))) <= 3


@needs_avif
def test_an_animated_avif_is_all_its_pictures(tmp_path: Path) -> None:
    path = tmp_path / "a.avif"
    others = [Image.fromarray(PICTURE[::-1]), Image.fromarray(PICTURE[:, ::-1])]
    Image.fromarray(PICTURE).save(path, save_all=True, append_images=others, quality=100, subsampling="4:4:4")
    read = read_pictures(path)
    for shown, wanted in zip(read.images, (PICTURE, PICTURE[::-1], PICTURE[:, ::-1]), strict=True):
        assert off(shown, wanted) <= 3
    with pytest.raises(InputError, match=r"a\.avif is an animation inside a folder"):
        read_pictures(tmp_path)


@needs_avif
def test_a_cut_avif_is_refused(tmp_path: Path) -> None:
    Image.fromarray(PICTURE).save(tmp_path / "a.avif")
    content = (tmp_path / "a.avif").read_bytes()
    for kept in (10, len(content) // 2, len(content) - 1):
        (tmp_path / "a.avif").write_bytes(content[:kept])
        with pytest.raises(InputError, match=r"a\.avif"):
            read_pictures(tmp_path / "a.avif", least=1)


def test_a_pillow_without_avif_is_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.avif").write_bytes(b"x")
    monkeypatch.setattr(features, "check", lambda _: False)
    for path in (tmp_path, tmp_path / "a.avif"):
        with pytest.raises(InputError, match=r"a\.avif is an AVIF, .*: pip install --upgrade pillow$"):
            read_pictures(path)


@pytest.mark.parametrize("suffix", [".heic", ".HEIC", ".heif"])
def test_a_missing_package_is_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str) -> None:
    monkeypatch.setitem(sys.modules, "pi_heif", None)
    shutil.copy(HEIC, tmp_path / f"a{suffix}")
    Image.fromarray(PICTURE).save(tmp_path / "b.png")
    for path in (tmp_path, tmp_path / f"a{suffix}"):
        with pytest.raises(InputError, match=rf"a\{suffix} is a HEIC, .*: pip install 'lightcube\[heif\]'$"):
            read_pictures(path)


def test_a_heic_is_a_picture(tmp_path: Path) -> None:
    pytest.importorskip("pi_heif")
    with pytest.warns(TransparentPictures):
        shown = read_pictures(HEIC, least=1).images[0]
    assert off(shown[:, :40], np.full((64, 40, 3), 255, np.uint8)) <= 2
    assert off(shown[4:28, 56:], PICTURE[4:28, 56:]) <= 4
    assert off(shown[36:60, 56:], PICTURE[36:60, 56:]) <= 4
    content = HEIC.read_bytes()
    for kept in (10, len(content) // 2, len(content) - 1):
        (tmp_path / "a.heic").write_bytes(content[:kept])
        with pytest.raises(InputError, match=r"a\.heic"):
            read_pictures(tmp_path / "a.heic", least=1)
