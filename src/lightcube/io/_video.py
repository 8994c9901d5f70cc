"""Pictures of a video file, through PyAV."""

from pathlib import Path

import numpy as np

from lightcube.errors import InputError
from lightcube.io._decode import Budget, Take, decoding, refuse_cut_short, video_levels

#: Containers that are read; a playlist under a video's name would make the reader open other files.
_FORMATS = "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi"


def read_video(path: Path, budget: Budget, take: Take) -> None:
    """Give every picture of the first video stream of `path` to `take`, turned as the file says.

    Raises
    ------
    InputError
        Where the file is damaged or cut short, or has no video in it.
    """
    import av

    with decoding(path):
        refuse_cut_short(path)
        with path.open("rb") as file, av.open(file, "r", options={"format_whitelist": _FORMATS}) as container:
            if not container.streams.video:
                raise InputError(f"{path} has no video in it: give a video, an animation or a folder of pictures")
            stream = container.streams.video[0]
            if stream.codec_context is None:
                raise InputError(f"{path} cannot be read, its video is packed in an unknown way: make it H.264 first")
            stream.codec_context.options = {"err_detect": "explode"}
            stream.thread_type = "AUTO"
            for frame in container.decode(stream):
                budget.spend(path, frame.height, frame.width)
                take(np.rot90(video_levels(frame), round(frame.rotation / 90)))
