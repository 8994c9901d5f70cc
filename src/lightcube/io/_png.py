"""PNG pictures with all their bits, and animated ones put together as the specification says."""

import struct
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image

from lightcube.errors import InputError
from lightcube.io._bounds import MOST_PICTURES, Budget, crowded, unpacks_beyond
from lightcube.io._decode import Take, damaged, levels_of_image, orientation_of, upright
from lightcube.io._frames import Levels, levels_of
from lightcube.io._samples import full_of, with_opacity
from lightcube.io._spaces import Space, space_of_cicp, space_of_gamma, space_of_profile

PNG_START = b"\x89PNG\r\n\x1a\n"

_BIT_DEPTH = 24  # bytes from the start
#: What the pixels of each frame of an animation are made with.
_OF_EACH_FRAME = (b"PLTE", b"tRNS")
#: So many chunks are always read, and one more for so many bytes: encoders write some thousands of bytes into each.
_CHUNKS, _BYTES_PER_CHUNK = 4 * MOST_PICTURES, 512
#: Samples of a pixel by the kind of its colours; and what encoders may leave behind the last row.
_SAMPLES, _SLACK = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}, 1 << 16
_CLEARED, _AS_BEFORE = 1, 2
_OVER = 1


@dataclass(frozen=True)
class _Frame:
    """One picture of an animation: a PNG of its own, and where and how it comes onto the canvas."""

    png: bytes
    rows: slice
    columns: slice
    disposal: int
    blending: int


def read_png(path: Path, budget: Budget, take: Take, *, single: bool) -> None:
    """Give the picture of a PNG, or every picture of an animated one, to `take`; `single` refuses animations.

    Raises
    ------
    InputError
        Where the file is damaged.
    """
    data = path.read_bytes()
    _refuse_crumbs(path, data)
    with Image.open(BytesIO(data)) as image:
        columns, rows = image.size
        budget.check(path, (rows, columns))
        image.load()  # checks the whole file, and reads metadata behind the pixels
        orientation = orientation_of(image)
        before = dict(_chunks(path, data, until=b"IDAT"))
        space = _space(before, image.info.get("icc_profile"))
        if b"acTL" not in before:
            budget.spend(path, rows, columns)
            levels = _levels(path, data, image)
            image.close()  # what it has loaded is no longer needed, and much of a large one
            take(upright(levels, orientation), space)
            return
    stated = int.from_bytes(before[b"acTL"][:4], "big")
    if single and stated > 1:
        raise InputError(f"{path} is an animation inside a folder of pictures: give that file itself, or move it")
    if stated > MOST_PICTURES:
        raise crowded(path)
    budget.check(path, *[(rows, columns)] * stated)
    for canvas in _composed(path, _frames(path, data, rows, columns), rows, columns, budget):
        take(upright(canvas, orientation), space)


def _space(before: dict[bytes, bytes], profile: bytes | None) -> Space | None:
    """Colours of a PNG by the chunk before its pixels that goes before the others (third edition, 4.3)."""
    if b"cICP" in before:
        return space_of_cicp(before[b"cICP"])
    if profile or b"sRGB" in before:
        return space_of_profile(profile)
    return space_of_gamma(before.get(b"gAMA"), before.get(b"cHRM"))


def _levels(path: Path, data: bytes, image: Image.Image) -> Levels:
    """Levels of a PNG, through PyAV where Pillow would drop bits or what is transparent."""
    if data[_BIT_DEPTH] < 16:
        return levels_of_image(path, image)
    packed = b"".join(content for name, content in _chunks(path, data) if name == b"IDAT")
    columns, rows = image.size
    row = 2 * columns * _SAMPLES.get(data[_BIT_DEPTH + 1], 4) + 1
    if unpacks_beyond(packed, row * rows + 8 * (rows + columns) + _SLACK):  # FFmpeg would unpack it to its end
        raise damaged(path)
    import av

    with av.open(BytesIO(data), "r", format="png_pipe") as container:
        return levels_of(next(iter(container.decode(video=0))))


def _refuse_crumbs(path: Path, data: bytes) -> None:
    """Raise `InputError` where a file is made of more chunks than any encoder makes: each takes time to read."""
    at, left = len(PNG_START), _CHUNKS + len(data) // _BYTES_PER_CHUNK
    while at < len(data) and left:
        at += 12 + int.from_bytes(data[at : at + 4], "big")
        left -= 1
    if not left:
        raise damaged(path)


def _chunks(path: Path, data: bytes, until: bytes = b"IEND") -> Iterator[tuple[bytes, bytes]]:
    """Name and content of each chunk, up to the first that is called `until`."""
    at, name = len(PNG_START), b""
    while name != until:
        length, name = struct.unpack(">I4s", data[at : at + 8].ljust(8, b"\0"))
        content = data[at + 8 : at + 8 + length]
        if len(data) < at + 12 + length:
            raise InputError(f"{path} is cut short, its end is missing: copy it or make it again")
        if zlib.crc32(name + content) != int.from_bytes(data[at + 8 + length : at + 12 + length], "big"):
            raise damaged(path)
        yield name, content
        at += 12 + length


def _frames(path: Path, data: bytes, rows: int, columns: int) -> Iterator[_Frame]:
    """Yield the pictures of an animated PNG; the still one that stands for them elsewhere is left out."""
    header, before, pixels, control, count = b"", b"", bytearray(), b"", 0
    for name, content in _chunks(path, data):
        if name == b"IHDR":
            header = content
        elif name == b"acTL":
            count = int.from_bytes(content[:4], "big")
        elif name in (b"IDAT", b"fdAT"):
            pixels += _chunk(b"IDAT", content if name == b"IDAT" else content[4:]) if control else b""
        elif not control and name in _OF_EACH_FRAME:
            before += _chunk(name, content)
        if control and pixels and name in (b"fcTL", b"IEND"):
            yield _frame(path, header, before + bytes(pixels), control, (rows, columns))
            pixels, count = bytearray(), count - 1
        if name == b"fcTL":
            control = content
    if count:
        raise InputError(f"{path} lacks some of its pictures, it is damaged: copy it or make it again")


def _frame(path: Path, header: bytes, body: bytes, control: bytes, size: tuple[int, int]) -> _Frame:
    """Make one picture of an animation, of what its control chunk says."""
    if len(control) != 26:
        raise damaged(path)
    _, columns, rows, left, top, _, _, disposal, blending = struct.unpack(">IIIIIHHBB", control)
    if not rows or not columns or top + rows > size[0] or left + columns > size[1]:
        raise damaged(path)
    png = PNG_START + _chunk(b"IHDR", struct.pack(">II", columns, rows) + header[8:]) + body + _chunk(b"IEND", b"")
    return _Frame(png, slice(top, top + rows), slice(left, left + columns), disposal, blending)


def _chunk(name: bytes, content: bytes) -> bytes:
    """Bytes of one chunk."""
    return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))


def _composed(path: Path, frames: Iterable[_Frame], rows: int, columns: int, budget: Budget) -> Iterator[Levels]:
    """Yield what the canvas shows after each of `frames`."""
    canvas: Levels | None = None
    for frame in frames:
        budget.spend(path, rows, columns)
        with Image.open(BytesIO(frame.png)) as image:
            levels = _levels(path, frame.png, image)
        if levels.shape[2] == 3:
            levels = with_opacity(levels, np.full_like(levels[..., :1], full_of(levels)), multiplied=False)
        if canvas is None:
            canvas = np.zeros((rows, columns, 4), levels.dtype)
        part = canvas[frame.rows, frame.columns]
        before = part.copy() if frame.disposal == _AS_BEFORE else np.zeros_like(part)
        part[:] = _over(part, levels) if frame.blending == _OVER else levels
        yield canvas.copy()
        if frame.disposal in (_CLEARED, _AS_BEFORE):
            part[:] = before


def _over(below: Levels, above: Levels) -> Levels:
    """Levels with opacity laid over others, in display values as browsers do it."""
    full = full_of(above)
    covered, seen = above[..., 3:] / full, below[..., 3:] / full * (1 - above[..., 3:] / full)
    opacity = covered + seen
    colours = (above[..., :3] * covered + below[..., :3] * seen) / np.where(opacity, opacity, 1)
    return np.rint(np.concatenate([colours, opacity * full], axis=2)).astype(above.dtype)
