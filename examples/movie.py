"""Draw docs/pictures/movie.png: frames of a movie of a cube, from the dark to the dark.

python examples/movie.py CUBE [OUT.png]
"""

import sys
from itertools import islice

import numpy as np
from PIL import Image

import lightcube as lc

FRAMES, SIDE = (0, 5, 10, 16, 30, 52, 58, 64, 72, 104), 216


def main(cube: str, out: str) -> None:
    film = lc.film(lc.load(cube), format="square", captions=True)
    frames = (np.asarray(frame, np.uint8) for frame in islice(film, FRAMES[-1] + 1))
    tiles = [np.asarray(Image.fromarray(f).resize((SIDE, SIDE))) for number, f in enumerate(frames) if number in FRAMES]
    lines = [np.concatenate(tiles[start : start + 5], axis=1) for start in (0, 5)]
    lc.save(np.concatenate(lines, axis=0), out, overwrite=True)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "movie.png")
