"""Pictures of a video file, through PyAV."""

from collections.abc import Iterator
from fractions import Fraction
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, cast

from lightcube.errors import InputError
from lightcube.io._bounds import MOST_PICTURES, Budget, check_file
from lightcube.io._decode import Take, decoding, refuse_cut_short
from lightcube.io._excerpt import Excerpt, Read
from lightcube.io._frames import Levels, is_known, levels_of, matrix_of, square, turned
from lightcube.io._hdr import converted, curve_of, ordinary
from lightcube.wording import counted

if TYPE_CHECKING:
    import av

#: Containers that are read; a playlist under a video's name would make the reader open other files.
_FORMATS = "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi"

#: Decoders of codecs whose opacity FFmpeg's own leave out.
_WITH_OPACITY = {"vp8": "libvpx", "vp9": "libvpx-vp9"}

#: Pictures of a film that are looked through where not all are read, and their pixels: 10 minutes of the largest films.
_MOST_FRAMES, _MOST_SEEN = 100_000, 200_000_000_000

#: Both fields of an interlaced frame as one picture of one moment; frames that are not interlaced pass.
_WEAVER = ("bwdif", "mode=send_frame:deint=interlaced")


def read_video(path: Path, budget: Budget, take: Take, excerpt: Excerpt) -> Read:
    """Give the chosen pictures of the film in `path` to `take`: upright, their pixels square, in sRGB.

    What is chosen depends on how many there are: if not all are, they are counted first, all of them decoded.

    Raises
    ------
    InputError
        Where the file is damaged or cut short, has no video in it, or nothing of it is chosen.
    """
    notes: dict[str, None] = {}
    with decoding(path):
        refuse_cut_short(check_file(path))
        read = None if excerpt.is_whole else excerpt.numbers(path, _times(path, budget, excerpt))
        wanted, count = None if read is None else set(read[0]), 0
        for number, (frame, aspect, _) in enumerate(_frames(path, notes, None if read else budget)):
            if wanted is None or number in wanted:
                shape = square(frame, aspect)
                budget.spend(path, *shape)
                if not is_known(frame):
                    raise InputError(f"{path} has colours of a kind that is not read (YCgCo, ICtCp): convert it first")
                take(turned(_levels(frame, shape, notes), frame))
                count += 1
            if wanted is not None and count == len(wanted):
                break  # what follows is not read
    numbers, of = read or (range(count), count)
    return Read(numbers, of, list(notes))


def _times(path: Path, budget: Budget, excerpt: Excerpt) -> list[float | None]:
    """When each picture of a film is shown, seconds from the first one on, to the end of an excerpt."""
    times: list[float | None] = []
    pixels, began = 0, None
    for frame, _, time in _frames(path, {}, None):
        size = frame.height, frame.width
        budget.check(path, size)
        pixels += size[0] * size[1]
        if len(times) == _MOST_FRAMES or pixels > _MOST_SEEN:
            raise InputError(f"{path} is too long to look through: cut out the part that you want")
        if began is None:
            began = time
        now = None if time is None or began is None else time - began
        if now is not None and excerpt.to_s is not None and now >= excerpt.to_s:
            break
        times.append(now)
    return times


def _frames(
    path: Path, notes: dict[str, None], budget: Budget | None
) -> Iterator[tuple["av.VideoFrame", Fraction | None, float | None]]:
    """Every frame of a film, the aspect of its pixels, and its second; `budget` bounds those that the film states."""
    import av

    with path.open("rb") as file, av.open(file, "r", options={"format_whitelist": _FORMATS}) as container:
        stream = _film(path, container)
        if budget is not None:
            context = stream.codec_context
            size = (context.height, context.width) if context else (0, 0)
            told = 0 if container.format.name == "avi" else stream.frames  # an AVI through a pipe states anything
            budget.check(path, *[size] * min(told, MOST_PICTURES + 1))
        for frame in _unwoven(_decoded(path, container, stream, notes), notes):
            base = frame.time_base or stream.time_base  # the last that a decoder gives have lost their own
            time = None if frame.pts is None or base is None else float(frame.pts * base)
            yield frame, stream.sample_aspect_ratio, time


def _film(path: Path, container: "av.container.InputContainer") -> "av.VideoStream":
    """The first video stream that is no cover and no preview."""
    from av.stream import Disposition

    stills = Disposition.attached_pic | Disposition.timed_thumbnails
    for stream in container.streams.video:
        if not stream.disposition & stills:
            return stream
    raise InputError(f"{path} has no video in it: give a video, an animation or a folder of pictures")


def _decoded(
    path: Path, container: "av.container.InputContainer", stream: "av.VideoStream", notes: dict[str, None]
) -> Iterator["av.VideoFrame"]:
    """Frames of a stream; `InputError` where a part of it is known to be missing, a note where it may be."""
    import av

    context = stream.codec_context
    if context is None:
        raise InputError(f"{path} cannot be read, its video is packed in an unknown way: make it H.264 first")
    says = {key.lower(): value for key, value in stream.metadata.items()}
    if says.get("alpha_mode") == "1" and context.name in _WITH_OPACITY:
        context = cast("av.VideoCodecContext", av.CodecContext.create(_WITH_OPACITY[context.name], "r"))
    context.options = {"err_detect": "explode"}
    context.thread_type = "AUTO"
    shown = 0
    for packet in container.demux(stream):
        if packet.is_corrupt:
            raise InputError(f"{path} is cut short, its end is missing: copy it or make it again")
        for frame in context.decode(packet if packet.size else None):
            if frame.is_corrupt:
                raise InputError(f"{path} is damaged, parts of its pictures are missing: copy it or make it again")
            shown += 1
            yield frame
    if "mp4" in container.format.name and shown < stream.frames:  # others count what is no picture of its own too
        notes[f"counts {counted(stream.frames, 'picture')} and shows {shown}: it was trimmed, or it is damaged"] = None


def _unwoven(frames: Iterator["av.VideoFrame"], notes: dict[str, None]) -> Iterator["av.VideoFrame"]:
    """The same frames, from the first one on that is interlaced with fields of one moment."""
    for frame in frames:
        if not frame.interlaced_frame:
            yield frame
            continue
        notes["is interlaced: of every picture one field was kept, and the lines between were filled in"] = None
        yield from _woven_anew(frame, frames)


def _woven_anew(first: "av.VideoFrame", others: Iterator["av.VideoFrame"]) -> Iterator["av.VideoFrame"]:
    """Frames through the filter, which wants to see the next one before it gives one back."""
    import av

    graph = av.filter.Graph()
    ticks = first.time_base or Fraction(1, 1000)  # which the filter asks for and has no use for
    source = graph.add_buffer(width=first.width, height=first.height, format=first.format, time_base=ticks)
    weaver, sink = graph.add(*_WEAVER), graph.add("buffersink")
    source.link_to(weaver)
    weaver.link_to(sink)
    graph.configure()
    for frame in chain([first], others, [None]):
        graph.push(frame)
        while True:
            try:
                yield graph.vpull()
            except (av.BlockingIOError, av.EOFError):
                break


def _levels(frame: "av.VideoFrame", shape: tuple[int, int], notes: dict[str, None]) -> Levels:
    """Levels of a frame in sRGB."""
    deep = frame.format.components[0].bits > 8
    curve = curve_of(frame.color_trc, matrix_of(frame), frame.color_primaries, deep=deep)
    primaries = frame.color_primaries
    levels = levels_of(frame, shape)
    if note := converted(curve, primaries):
        notes[note] = None
        return ordinary(levels, curve, primaries)
    return levels
