"""The reader of pages: its own, and nothing else."""

import zlib
from pathlib import Path

import numpy as np
import pytest

from lightcube.errors import InputError
from lightcube.io._pdf import POINTS, Page, Placed, read_pages, whole


def written(
    drawn: bytes, levels: np.ndarray[tuple[int, ...], np.dtype[np.uint8]], *, space: str = "DeviceRGB", more: str = ""
) -> bytes:
    """A PDF of one page, as plain as one can be."""
    rows, columns = levels.shape[:2]
    packed = zlib.compress(levels.tobytes())
    objects = [
        b"<< /Type /Catalog /Pages 2 0 R >>",
        b"<< /Type /Pages /Kids [ 3 0 R ] /Count 1 /MediaBox [ 0 0 200 100.5 ] >>",
        b"<< /Type /Page /Contents 4 0 R /Resources << /XObject << /Im 5 0 R >> >> >>",
        b"<< /Length %d >>\nstream\n%s\nendstream" % (len(drawn), drawn),
        b"<< /Subtype /Image /Width %d /Height %d /BitsPerComponent 8 /ColorSpace /%s %s"
        b"/Filter [ /FlateDecode ] /Length %d >>\nstream\n%s\nendstream"
        % (columns, rows, space.encode(), more.encode(), len(packed), packed),
    ]
    data, places = b"%PDF-1.4\n", []
    for number, each in enumerate(objects, 1):
        places.append(len(data))
        data += b"%d 0 obj\n%s\nendobj\n" % (number, each)
    table = b"".join(b"%010d 00000 n \n" % place for place in places)
    start = len(data)
    opening = b"xref\n0 %d\n0000000000 65535 f \n" % (len(objects) + 1)
    return data + opening + table + b"trailer\n<< /Root 1 0 R >>\nstartxref\n%d\n%%%%EOF\n" % start


LEVELS = np.arange(2 * 3 * 3, dtype=np.uint8).reshape(2, 3, 3)


def read(path: Path, data: bytes) -> tuple[Page, list[Placed]]:
    path.write_bytes(data)
    (page,) = read_pages(path)
    with whole(path):
        return page, list(page.pictures())


def test_pictures_stand_where_matrices_lay_them(tmp_path: Path) -> None:
    drawn = rb"q 2 0 0 2 10 0 cm (a \(Do\) ) Tj q 30 0 0 40 5 6 cm /Im Do Q Q q -30 0 0 40 50 6 cm /Im Do Q"
    page, (first, second) = read(tmp_path / "a.pdf", written(drawn, LEVELS))
    assert (page.width_mm * POINTS, page.height_mm * POINTS) == pytest.approx((200, 100.5))
    assert np.array_equal(first.levels, LEVELS)
    found = np.array([first.left_mm, first.bottom_mm, first.width_mm, first.height_mm]) * POINTS
    assert found == pytest.approx([20, 12, 60, 80])
    assert (first.is_mirrored, second.is_mirrored) == (False, True)
    assert second.left_mm * POINTS == pytest.approx(20)


def test_a_picture_on_its_head_is_read_from_the_top(tmp_path: Path) -> None:
    _, (found,) = read(tmp_path / "a.pdf", written(b"q 30 0 0 -40 5 46 cm /Im Do Q", LEVELS))
    assert np.array_equal(found.levels, LEVELS[::-1])
    assert found.bottom_mm * POINTS == pytest.approx(6)


GOOD = written(b"q 30 0 0 40 5 6 cm /Im Do Q", LEVELS)
BAD = {
    "another thing": b"GIF89a" + bytes(100),
    "nothing": b"",
    "cut": GOOD[: len(GOOD) // 2],
    "no table": GOOD.replace(b"xref", b"yref", 1),
    "moved": GOOD.replace(b"%PDF-1.4\n", b"%PDF-1.4\nmore bytes than there were"),
    "turned": written(b"q 0 30 -40 0 5 6 cm /Im Do Q", LEVELS),
    "more than it says": written(b"q 30 0 0 40 5 6 cm /Im Do Q", np.zeros((900, 900, 3), np.uint8)).replace(
        b"/Height 900", b"/Height 899"
    ),
    "less than it says": GOOD.replace(b"/Height 2 ", b"/Height 3 "),
    "huge": GOOD.replace(b"/Width 3 ", b"/Width 99999999999 "),
    "indexed": written(b"q 30 0 0 40 5 6 cm /Im Do Q", LEVELS, space="Indexed"),
    "masked": written(b"q 30 0 0 40 5 6 cm /Im Do Q", LEVELS, more="/SMask 4 0 R "),
    "packed otherwise": GOOD.replace(b"FlateDecode", b"LZWDecode12"),
    "its own parent": GOOD.replace(b"/Kids [ 3 0 R ]", b"/Kids [ 2 0 R ]"),
    "too many Q": written(b"Q Q 30 0 0 40 5 6 cm /Im Do", LEVELS),
    "lists in lists": GOOD.replace(b"trailer\n<<", b"trailer\n" + b"[" * 20_000),
}


@pytest.mark.parametrize("which", BAD)
def test_what_is_anothers_or_damaged_is_told_in_a_sentence(tmp_path: Path, which: str) -> None:
    with pytest.raises(InputError, match="no PDF that lightcube wrote"):
        read(tmp_path / "a.pdf", BAD[which])
