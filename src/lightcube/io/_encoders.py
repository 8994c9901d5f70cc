"""One function per kind of movie: 8-bit pictures in, a file out, one picture in memory at a time."""

import io
import math
import tempfile
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import IO, TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from lightcube.errors import InputError
from lightcube.io._frames import AVERAGING, BT709, FULL, NARROW

if TYPE_CHECKING:
    import av

Levels = NDArray[np.uint8]

#: Called with the file to write, the pictures ``(row, column, 3)``, and pictures per second.
Encoder = Callable[[Path, Iterable[Levels], Fraction], None]

#: The code of ITU-T H.273 for the sRGB curve.
_SRGB_CURVE = 13

#: Without it a file would hold a random number and the library's version.
_SAME_BYTES = {"fflags": "+bitexact"}

#: A delay of less than two hundredths of a second makes browsers play at a tenth of the speed.
_MOST_GIF_RATE = 50
#: A delay is at most so many hundredths of a second.
_LEAST_GIF_RATE = Fraction(100, 65535)
_MOST_WEBP = 16383
#: Pictures that are made smaller keep more than so many pixels a side.
_TINY = 64
#: Pixels that a palette is chosen from, at most.
_PALETTE_SAMPLE = 1 << 17
_PALETTE = 256


@dataclass(frozen=True)
class _Codec:
    """What PyAV needs to know of one kind of file."""

    container: str
    name: str
    pixels: str
    codec_options: dict[str, str]
    container_options: dict[str, str]


_MP4 = _Codec("mp4", "libx264", "yuv444p", {"crf": "4", "preset": "medium"}, {"movflags": "+faststart"})
#: The same with half the colour resolution, which every player knows.
_MP4_COMMON = replace(_MP4, pixels="yuv420p")
#: For sending: hardly less to see, and 4.4 Mbit a second at most (0.55 MB), with a little more in the first: of
#: nothing but noise one second has 0.61 MB, and three have 0.58 each.
_MP4_SHARED = replace(
    _MP4_COMMON, codec_options={"crf": "17", "preset": "veryfast", "maxrate": "4400k", "bufsize": "1500k"}
)
_WEBM = _Codec("webm", "libvpx-vp9", "gbrp", {"lossless": "1", "row-mt": "1", "cpu-used": "4"}, {})
_APNG = _Codec("apng", "apng", "rgb24", {"pred": "mixed"}, {"plays": "0"})
_GIF = _Codec("gif", "gif", "pal8", {"gifflags": "0"}, {"loop": "0"})


def encode_mp4(path: Path, pictures: Iterable[Levels], fps: Fraction) -> None:
    """H.264 (BT.709), visually lossless, 4:4:4."""
    _encode(path, (_coded_frame(picture, _MP4) for picture in pictures), fps, _MP4)


def encode_doubled_mp4(path: Path, pictures: Iterable[Levels], fps: Fraction) -> None:
    """Squares of 2 x 2 pixels alike, without loss at half the colour resolution, 4:2:0, which every player knows."""
    _encode(path, (_coded_frame(picture, _MP4_COMMON) for picture in pictures), fps, _MP4_COMMON)


def encode_shared_mp4(path: Path, pictures: Iterable[Levels], fps: Fraction) -> None:
    """H.264 (BT.709), 4:2:0, of even width and height, at most 0.7 MB a second."""
    even = (np.pad(p, [(0, size % 2) for size in p.shape[:2]] + [(0, 0)], "edge") for p in pictures)
    _encode(path, (_coded_frame(picture, _MP4_SHARED) for picture in even), fps, _MP4_SHARED)


def _coded_frame(picture: Levels, codec: _Codec) -> "av.VideoFrame":
    """A picture as brightness and two colours, which says what they mean."""
    plain = _rgb_frame(picture)
    frame = plain.reformat(
        format=codec.pixels,
        src_colorspace=BT709,
        dst_colorspace=BT709,
        interpolation=AVERAGING,
        src_color_range=FULL,
        dst_color_range=NARROW,
    )
    frame.colorspace, frame.color_range = BT709, NARROW
    frame.color_primaries, frame.color_trc = plain.color_primaries, plain.color_trc
    return frame


def encode_webm(path: Path, pictures: Iterable[Levels], fps: Fraction) -> None:
    """VP9 in RGB, lossless."""
    _encode(path, map(_rgb_frame, pictures), fps, _WEBM)


def encode_apng(path: Path, pictures: Iterable[Levels], fps: Fraction) -> None:
    """Animated PNG, lossless, looping."""
    _encode(path, map(_rgb_frame, pictures), fps, _APNG)


def encode_gif(path: Path, pictures: Iterable[Levels], fps: Fraction) -> None:
    """GIF, looping, with one palette for all: exact up to 256 colours, else chosen from all and dithered."""
    _check_gif(fps)
    with tempfile.TemporaryFile(dir=path.parent) as spool:
        spooled = _Spooled(spool, pictures)
        colours = _few_colours(spooled)
        palette = _chosen_colours(spooled) if colours is None else colours
        indices = _dithered(spooled, palette) if colours is None else _looked_up(spooled, palette)
        _encode(path, (_palette_frame(index, palette) for index in indices), fps, _GIF)


def encode_shared_gif(
    path: Path, pictures: Iterable[Levels], fps: Fraction, most_bytes: int
) -> tuple[tuple[int, int], tuple[int, int]]:
    """GIF, looping, of so many bytes at most: the pictures become smaller until it is, or until they are tiny.

    Each picture has a palette of its own, and is not dithered, which is smaller and smoother. What stands still is one
    picture that stays.

    Returns
    -------
    Rows and columns that were given, and that were written.
    """
    _check_gif(fps)
    with tempfile.TemporaryFile(dir=path.parent) as spool:
        spooled = _Spooled(spool, pictures)
        rows, columns, _ = spooled.shape
        size = rows, columns
        while True:
            _encode(path, _own_palettes(spooled, size, fps), fps, _GIF)
            if path.stat().st_size <= most_bytes or min(size) <= _TINY:
                return (rows, columns), size
            part = min(0.95, 0.98 * (most_bytes / path.stat().st_size) ** 0.5)
            size = max(1, round(part * size[0])), max(1, round(part * size[1]))


def _check_gif(fps: Fraction) -> None:
    """Raise `InputError` where a GIF cannot be so fast or slow."""
    if fps > _MOST_GIF_RATE:
        raise InputError(f"a GIF shows at most {_MOST_GIF_RATE} pictures a second, not {float(fps):g}: lower the rate")
    if fps < _LEAST_GIF_RATE:
        raise InputError(f"a GIF shows a picture for at most 655 seconds, not {float(1 / fps):g}: raise the rate")


def _own_palettes(spooled: "_Spooled", size: tuple[int, int], fps: Fraction) -> Iterator["av.VideoFrame"]:
    """Each picture that differs from the one before, in its own colours, at its time."""
    time = 0
    for picture, times in spooled.runs():
        image = Image.fromarray(picture).resize(size[::-1], Image.Resampling.BOX)
        own = image.quantize(_PALETTE, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
        frame = _palette_frame(np.asarray(own), np.array(own.getpalette("RGB"), np.uint8).reshape(-1, 3))
        frame.pts, frame.time_base = time, 1 / fps
        yield frame
        time += times


class _Spooled:
    """Pictures that can be gone through again and again, on the disk; one that is like the one before is there once."""

    def __init__(self, spool: IO[bytes], pictures: Iterable[Levels]) -> None:
        self._spool, self._times = spool, list[int]()
        self.shape: tuple[int, ...] = ()
        last: bytes | None = None
        for picture in pictures:
            self.shape, now = picture.shape, picture.tobytes()
            if now == last:
                self._times[-1] += 1
            else:
                spool.write(now)
                self._times.append(1)
            last = now

    def runs(self) -> Iterator[tuple[Levels, int]]:
        """Yield each picture that differs from the one before, and how many times it comes."""
        self._spool.seek(0)
        for times in self._times:
            data = self._spool.read(math.prod(self.shape))
            yield np.frombuffer(data, np.uint8).reshape(self.shape), times

    def __iter__(self) -> Iterator[Levels]:
        """Yield all pictures."""
        for picture, times in self.runs():
            for _ in range(times):
                yield picture


def png(picture: Levels) -> memoryview:
    """Return the file of one picture ``(row, column, 3)``, which says that it is sRGB."""
    said = PngInfo()
    said.add(b"sRGB", b"\0")
    file = io.BytesIO()
    Image.fromarray(picture).save(file, "PNG", pnginfo=said)
    return file.getbuffer()


def encode_webp(path: Path, pictures: Iterable[Levels], fps: Fraction) -> None:
    """Animated WebP, lossless, looping.

    The container is written here (RFC 9649): libwebp's own animation encoder drops a picture that is like the
    one before.
    """
    with path.open("wb") as file:
        file.write(b"RIFF\0\0\0\0WEBP")
        for index, picture in enumerate(pictures):
            if not index:
                rows, columns, _ = picture.shape
                if max(rows, columns) > _MOST_WEBP:
                    raise InputError(f"a WebP is at most {_MOST_WEBP} pixels wide and high: use another suffix")
                canvas = _int24(columns - 1) + _int24(rows - 1)
                _write_chunk(file, b"VP8X", b"\x02\0\0\0" + canvas)
                _write_chunk(file, b"ANIM", b"\xff\xff\xff\xff\0\0")
            still = io.BytesIO()
            Image.fromarray(picture).save(still, "WEBP", lossless=True, quality=60, method=3)
            # Whole milliseconds that add up to the right length.
            delay = round((index + 1) * 1000 / fps) - round(index * 1000 / fps)
            # Placed at the corner, opaque, not blended (flag 2); behind the 12 bytes of its own header.
            frame = _int24(0) + _int24(0) + canvas + _int24(delay) + b"\x02" + still.getbuffer()[12:]
            _write_chunk(file, b"ANMF", frame)
        length = file.tell() - 8
        file.seek(4)
        file.write(length.to_bytes(4, "little"))


def _int24(value: int) -> bytes:
    return value.to_bytes(3, "little")


def _write_chunk(file: io.BufferedWriter, name: bytes, data: bytes) -> None:
    """Write a RIFF chunk of an even length."""
    file.write(name + len(data).to_bytes(4, "little") + data)


def _encode(path: Path, frames: Iterator["av.VideoFrame"], fps: Fraction, codec: _Codec) -> None:
    """Encode `frames` into one video stream."""
    import av

    stream = None
    options = {**_SAME_BYTES, **codec.container_options}
    with av.open(str(path), "w", format=codec.container, options=options) as container:
        for frame in frames:
            if stream is None:
                stream = cast("av.VideoStream", container.add_stream(codec.name, rate=fps, options=codec.codec_options))
                stream.width, stream.height, stream.pix_fmt = frame.width, frame.height, codec.pixels
                context = stream.codec_context
                context.colorspace, context.color_range = frame.colorspace, frame.color_range
                context.color_primaries, context.color_trc = frame.color_primaries, frame.color_trc
            container.mux(stream.encode(frame))
        if stream is not None:
            container.mux(stream.encode())


def _rgb_frame(picture: Levels) -> "av.VideoFrame":
    """A picture ``(row, column, 3)``, which says that it is sRGB."""
    import av

    frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
    frame.color_primaries, frame.color_trc = BT709, _SRGB_CURVE
    return frame


def _palette_frame(index: Levels, palette: Levels) -> "av.VideoFrame":
    """Indices ``(row, column)`` into a palette ``(colours, 3)``."""
    import av

    opaque = np.full((_PALETTE, 4), 255, np.uint8)
    opaque[:, 1:] = palette[-1]
    opaque[: len(palette), 1:] = palette
    return av.VideoFrame.from_ndarray((index, opaque), format="pal8")  # type: ignore[arg-type]  # PyAV wants a pair


def _packed(picture: Levels) -> NDArray[np.uint32]:
    """Each pixel's colour as one number."""
    red, green, blue = np.moveaxis(picture.astype(np.uint32), -1, 0)
    packed: NDArray[np.uint32] = red << 16 | green << 8 | blue
    return packed


def _few_colours(pictures: Iterable[Levels]) -> Levels | None:
    """All colours ``(count, 3)`` in ascending order, or None where there are more than a palette holds."""
    found = np.empty(0, np.uint32)
    for picture in pictures:
        found = np.union1d(found, _packed(picture))
        if len(found) > _PALETTE:
            return None
    return np.stack([found >> 16, (found >> 8) & 255, found & 255], axis=1).astype(np.uint8)


def _looked_up(pictures: Iterable[Levels], palette: Levels) -> Iterator[Levels]:
    """Index of each pixel's colour in a sorted `palette` that has them all."""
    known = _packed(palette)
    for picture in pictures:
        yield np.searchsorted(known, _packed(picture)).astype(np.uint8)


def _chosen_colours(pictures: Iterable[Levels]) -> Levels:
    """256 colours ``(256, 3)`` for all pictures, from an even sample of their pixels (median cut, then k-means)."""
    every = -(-sum(picture.size // 3 for picture in pictures) // _PALETTE_SAMPLE)
    sample = np.concatenate([picture.reshape(-1, 3)[index % every :: every] for index, picture in enumerate(pictures)])
    cut = Image.fromarray(sample[None]).quantize(_PALETTE, Image.Quantize.MEDIANCUT, kmeans=1)
    return np.array(cut.getpalette("RGB"), np.uint8).reshape(-1, 3)


def _dithered(pictures: Iterable[Levels], palette: Levels) -> Iterator[Levels]:
    """Index into `palette` of each pixel, Floyd–Steinberg dithered."""
    colours = Image.new("P", (1, 1))
    colours.putpalette(palette.tobytes())
    for picture in pictures:
        yield np.asarray(Image.fromarray(picture).quantize(palette=colours, dither=Image.Dither.FLOYDSTEINBERG))
