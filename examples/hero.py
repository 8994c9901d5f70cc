"""Make docs/pictures/hero.webp, the loop at the head of the README: a wall, and the cube that turns before its lamp.

python examples/hero.py CUBE [OUT.webp]      (the cube is out/photographs.zarr of `lightcube demo`)
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image

import lightcube as lc
from lightcube.drawing import films, shows

#: So many stops of the cube, evenly, in frames of so many rows and columns, so many a second; bytes at most.
STOPS, SIZE, FPS, MOST = 4, (414, 736), 15.0, 3_000_000


def main(cube: str, out: str) -> None:
    whole = lc.load(cube)
    few = np.linspace(0, len(whole.names), STOPS, endpoint=False).astype(int)
    names, powers = tuple(whole.names[i] for i in few), whole.powers[few]
    some = replace(whole, rig=whole.rig.take(few), names=names, lamp_powers=powers, targets=None)
    style = films.Style(SIZE, fps=FPS, view="room")
    frames: list[Image.Image] = []
    shown: list[int] = []
    for frame in films.filmed(some, shows.Look(), style, some.angles_deg, even=False):
        image = Image.fromarray(np.asarray(frame, np.uint8))
        if frames and frames[-1].tobytes() == image.tobytes():
            shown[-1] += 1
        else:
            frames, shown = [*frames, image], [*shown, 1]
    lit = int(np.argmax([np.asarray(image).mean() for image in frames]))  # what does not play loops shows the first
    frames, shown = frames[lit:] + frames[:lit], shown[lit:] + shown[:lit]
    lasting = [round(1000 * count / FPS) for count in shown]
    frames[0].save(out, save_all=True, append_images=frames[1:], duration=lasting, loop=0, quality=90, method=4)
    if Path(out).stat().st_size > MOST:
        raise SystemExit(f"{out} has more than {MOST} bytes: take fewer stops, or smaller frames")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "hero.webp")
