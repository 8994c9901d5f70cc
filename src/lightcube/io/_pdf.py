"""Pages of a PDF file that this package wrote: how large they are, and which pictures stand where on them.

No reader of PDF in general: one table of objects, streams that are deflated or plain, pictures of 8 bits a colour that
are neither turned nor masked. Everything else is another program's.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError

#: Points of PDF in a mm.
POINTS = 72 / 25.4
#: More pages, objects, or bytes of a page's text than this package writes.
_MOST_PAGES, _MOST_OBJECTS, _MOST_TEXT = 1000, 100_000, 16 << 20
#: Bytes of a picture, at most: one dot of four inks on A0 at 600 dpi is less.
MOST_BYTES = 3 << 30
#: Numbers of a picture's dot by colour space, and how Pillow calls it.
_SPACES = {"DeviceGray": 1, "DeviceRGB": 3, "DeviceCMYK": 4}
#: What a page or an object is told by, piece by piece.
_TOKEN = re.compile(
    rb"<<|>>|[\[\]]|/[^\s/<>\[\]()%{}]*|\((?:\\[\s\S]|[^\\()])*\)|<[0-9A-Fa-f\s]*>|%[^\r\n]*|[^\s/<>\[\]()%{}]+"
)
_NUMBER = re.compile(rb"[+-]?(?:\d+\.?\d*|\.\d+)")


class _Reference(NamedTuple):
    number: int


@dataclass(frozen=True, eq=False)
class Placed:
    """A picture on a page.

    Parameters
    ----------
    left_mm, bottom_mm, width_mm, height_mm
        Where it stands, from the page's lower left corner; as seen, so that no size is negative.
    is_mirrored
        Whether its left is seen on the right.
    levels
        ``(row, column, colour)``: from the top as seen, and from its own left.
    """

    left_mm: float
    bottom_mm: float
    width_mm: float
    height_mm: float
    is_mirrored: bool
    levels: NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Page:
    """A page, and where its pictures stand.

    Parameters
    ----------
    width_mm, height_mm
        Of the page.
    count
        How many pictures there are on it.
    """

    width_mm: float
    height_mm: float
    count: int
    _file: _File
    _uses: tuple[tuple[tuple[float, ...], Any], ...]

    def pictures(self) -> Iterator[Placed]:
        """Its pictures, each unpacked when it is asked for."""
        for (a, b, c, d, e, f), reference in self._uses:
            if max(abs(b), abs(c)) > 1e-6 * max(abs(a), abs(d)) or a == 0 or d == 0:
                raise ValueError("a picture that is turned")
            levels = self._file.levels(reference)
            left, bottom = min(e, e + a) / POINTS, min(f, f + d) / POINTS
            yield Placed(left, bottom, abs(a) / POINTS, abs(d) / POINTS, a < 0, levels if d > 0 else levels[::-1])


def read_pages(path: Path) -> list[Page]:
    """Read the pages of a PDF that this package wrote; `InputError` where it is another's, or damaged."""
    with whole(path):
        return _File(path.read_bytes()).pages()


class whole:  # noqa: N801 - used as a function is
    """Tell a file that cannot be read as this package wrote it in one sentence."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def __enter__(self) -> None:
        """Nothing yet."""

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: object) -> None:
        """Raise `InputError` of what a file that is another's leads to."""
        if isinstance(error, ValueError | KeyError | IndexError | TypeError | AttributeError | zlib.error):
            raise InputError(
                f"{self._path} is no PDF that lightcube wrote, or it was saved anew by another program: export it again"
            ) from error


class _File:
    """Objects of a PDF by their numbers."""

    def __init__(self, data: bytes) -> None:
        if not data.startswith(b"%PDF-"):
            raise ValueError("no PDF")
        self._data = data
        start = int(re.findall(rb"startxref\s+(\d+)", data[-1024:])[-1])
        table = re.compile(rb"\s*xref\s+0 (\d+)\s+").match(data, start)
        if table is None or int(table[1]) > _MOST_OBJECTS:
            raise ValueError("no table of objects")
        rows = [data[at : at + 20] for at in range(table.end(), table.end() + 20 * int(table[1]), 20)]
        self._places = {number: int(row[:10]) for number, row in enumerate(rows) if row[17:18] == b"n"}
        trailer, _ = _parsed(data, data.index(b"trailer", start) + len(b"trailer"))
        self._root = self.found(trailer["Root"])

    def found(self, value: Any) -> Any:
        """What a reference leads to; anything else as it is."""
        return self._object(value)[0] if isinstance(value, _Reference) else value

    def _object(self, reference: _Reference) -> tuple[Any, int]:
        """An object, and where its bytes begin, if it has any."""
        opening = re.compile(rb"\s*%d 0 obj" % reference.number).match(self._data, self._places[reference.number])
        if opening is None:
            raise ValueError("an object is not where it should be")
        return _parsed(self._data, opening.end())

    def _stream(self, reference: _Reference, most: int) -> bytes:
        """The bytes of an object, unpacked; no more than `most`."""
        said, at = self._object(reference)
        if self._data[at : at + 6] != b"stream":
            raise ValueError("no stream")
        at += 8 if self._data[at + 6 : at + 8] == b"\r\n" else 7
        packed = self._data[at : at + self.found(said["Length"])]
        filters = self.found(said.get("Filter", []))
        filters = filters if isinstance(filters, list) else [filters]
        if filters not in ([], ["FlateDecode"]) or "DecodeParms" in said:
            raise ValueError("packed in another way")
        if not filters:
            return packed
        unpacker = zlib.decompressobj()
        data = unpacker.decompress(packed, most + 1)
        if len(data) > most or not unpacker.eof:
            raise ValueError("longer than it says")
        return data

    def levels(self, reference: _Reference) -> NDArray[np.uint8]:
        """``(row, column, colour)`` of a picture."""
        said = self.found(reference)
        shape = int(said["Height"]), int(said["Width"]), _SPACES[said["ColorSpace"]]
        plain = said["BitsPerComponent"] == 8 and not {"Decode", "Mask", "SMask"} & set(said)
        if not plain or min(shape) < 1 or int(np.prod(shape, dtype=object)) > MOST_BYTES:
            raise ValueError("another kind of picture")
        return np.frombuffer(self._stream(reference, int(np.prod(shape))), np.uint8).reshape(shape)

    def pages(self) -> list[Page]:
        """All pages in order."""
        pages: list[Page] = []
        waiting: list[tuple[Any, dict[str, Any]]] = [(self._root["Pages"], {})]
        for _ in range(_MOST_PAGES):
            if not waiting:
                return pages
            reference, inherited = waiting.pop()
            said = {**inherited, **self.found(reference)}
            if said["Type"] == "Pages":
                kept = {name: said[name] for name in ("MediaBox", "Resources", "Rotate") if name in said}
                waiting += [(kid, kept) for kid in reversed(self.found(said["Kids"]))]
            else:
                pages.append(self._page(said))
        raise ValueError("too many pages")

    def _page(self, said: Mapping[str, Any]) -> Page:
        """A page of what is said of it."""
        left, bottom, right, top = (float(each) for each in self.found(said["MediaBox"]))
        if (left, bottom) != (0, 0) or said.get("Rotate", 0) != 0:
            raise ValueError("a page that is turned")
        texts = said["Contents"] if isinstance(said["Contents"], list) else [said["Contents"]]
        drawn = b"\n".join(self._stream(each, _MOST_TEXT) for each in texts[:_MOST_PAGES])
        known = self.found(self.found(said["Resources"]).get("XObject", {}))
        is_picture = {name: self.found(each)["Subtype"] == "Image" for name, each in known.items()}
        uses = tuple((matrix, known[name]) for matrix, name in _used(drawn) if is_picture[name])
        return Page(right / POINTS, top / POINTS, len(uses), self, uses)


def _used(drawn: bytes) -> Iterator[tuple[tuple[float, ...], str]]:
    """Where a page's text puts what, as the matrix of the unit square and a name."""
    matrix, kept = np.eye(3), list[NDArray[np.float64]]()
    given: list[bytes] = []
    for found in _TOKEN.finditer(drawn):
        token = found[0]
        if token == b"q":
            kept.append(matrix)
        elif token == b"Q":
            matrix = kept.pop()
        elif token == b"cm":
            a, b, c, d, e, f = (float(each) for each in given[-6:])
            matrix = np.array([[a, b, 0], [c, d, 0], [e, f, 1]]) @ matrix
        elif token == b"Do":
            yield tuple(matrix[:, :2].ravel().tolist()), given[-1][1:].decode("ascii")
        else:
            given = [*given[-5:], token]


def _parsed(data: bytes, at: int) -> tuple[Any, int]:
    """The first object that begins at a place: a dictionary, a list, a number, a name; and where what follows begins.

    Lists in lists are kept track of, not gone into: a file cannot lead deeper than there is room.
    """
    open_lists: list[list[Any]] = [[]]
    for found in _TOKEN.finditer(data, at):
        token = found[0]
        if token in (b"endobj", b"stream", b"startxref"):
            return open_lists[0][0], found.start()
        if token in (b"<<", b"["):
            open_lists.append([])
        elif token in (b">>", b"]"):
            items = open_lists.pop()
            is_list = token == b"]"
            open_lists[-1].append(items if is_list else dict(zip(items[::2], items[1::2], strict=True)))
        elif token == b"R":
            _, number = open_lists[-1].pop(), open_lists[-1].pop()
            open_lists[-1].append(_Reference(number))
        elif not token.startswith(b"%"):
            open_lists[-1].append(_value(token))
    raise ValueError("an object without an end")


def _value(token: bytes) -> Any:
    """A number, a name, or anything else as it stands."""
    if _NUMBER.fullmatch(token):
        return float(token) if b"." in token else int(token)
    return token[1:].decode("latin-1") if token.startswith(b"/") else token
