"""Draw docs/pictures/movie.png and movie-eye.png: frames of movies of a cube, resting, and on the way to the lamp.

python examples/movie.py CUBE [FOLDER]
"""

import sys
from collections.abc import Iterable
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

import lightcube as lc
from lightcube.drawing import films

RESTS, WAY = (0, 19, 24, 29, 37, 46, 51, 56, 74, 148), (0, 7, 42, 52, 60, 68, 76, 86, 98, 142)


def main(cube: str, folder: Path) -> None:
    whole = lc.load(cube)
    tiles = chosen(lc.film(whole, format="square", captions=True), RESTS, (216, 216))
    lc.save(sheet(tiles), folder / "movie.png", overwrite=True)
    style = films.Style((270, 480), view="eye")
    tiles = chosen(films.to_the_lamp(whole, style, whole.angles_deg[:1]), WAY, (216, 384))
    lc.save(sheet(tiles), folder / "movie-eye.png", overwrite=True)


def chosen(film: Iterable[object], numbers: tuple[int, ...], size: tuple[int, int]) -> list[NDArray[np.uint8]]:
    """Some frames of a film, smaller."""
    frames = (np.asarray(frame, np.uint8) for frame in islice(film, numbers[-1] + 1))
    images = [Image.fromarray(frame) for number, frame in enumerate(frames) if number in numbers]
    return [np.asarray(image.resize(size[::-1])) for image in images]


def sheet(tiles: list[NDArray[np.uint8]]) -> NDArray[np.uint8]:
    """Two lines of five."""
    return np.concatenate([np.concatenate(tiles[start : start + 5], axis=1) for start in (0, 5)], axis=0)


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]) if len(sys.argv) > 2 else Path())
