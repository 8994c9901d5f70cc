"""What the scripts of the gallery share: photographs by name, and what each of them leaves in a folder.

    python examples/gallery/stained_glass.py [FOLDER]

Without a folder it is `out/gallery` and the name of the script. There stand `page.html`, the thing alive;
`thumbnail.webp`; `pictures.webp`, what was wanted beside what is shown; `told.json`, how good it is; and whatever else
a script writes.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageOps

import lightcube as lc
from lightcube.drawing.relief_sheet import relief_preview, relief_sheet
from lightcube.drawing.sheet import contact_sheet
from lightcube.drawing.tableau import tableau
from lightcube.optics.transfer import to_uint8
from lightcube.pictures import samples

sys.path.append(str(Path(__file__).parents[1]))
from letters import body, letter, picture

__all__ = ["body", "letter", "picture"]

Levels = NDArray[np.uint8]

FOLDER = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out/gallery") / Path(sys.argv[0]).stem
#: Width and height of a thumbnail; of the picture that it is made of; the widest that a sheet is kept.
THUMBNAIL, DRAWN, WIDEST = (480, 320), (960, 640), 1600
#: Dark pixels around each of several pictures; side of a point of a thing that is drawn.
GAP, SPOT = 3, 3
#: Bytes that a thumbnail may take, and how carefully it is packed at first.
MOST_BYTES, FINE = 15_000, 82


def photographs(*names: str) -> lc.Pictures:
    """Photographs that come with scikit-image."""
    known = samples.photographs(16)
    return lc.Pictures(tuple(known.images[known.names.index(name)] for name in names), names)


def show(
    doc: str | None,
    thing: lc.Cube | lc.Shape | lc.Relief,
    targets: lc.Targets | None = None,
    *,
    stop: int = 0,
    seen: Levels | None = None,
    note: str = "",
) -> None:
    """Write the page of a thing, its thumbnail, and its pictures; titles are the first line of the script.

    Parameters
    ----------
    targets
        What was wanted of a cube: it is scored, and drawn beside what the wall shows.
    stop
        At which stop the room is seen on the thumbnail.
    seen
        What is seen there instead.
    note
        A dedication on the page.
    """
    title = (doc or "").split("\n", 1)[0].rstrip(".")
    FOLDER.mkdir(parents=True, exist_ok=True)
    shown = lc.as_cube(thing) if isinstance(thing, lc.Shape) else thing
    lc.save(lc.page(shown, lc.Label(title, note=note)), FOLDER / "page.html", overwrite=True)
    if isinstance(shown, lc.Relief):
        scores = lc.score_relief(shown)
        _keep(relief_sheet(shown, scores, title), "pictures.webp")
        seen = relief_preview(shown) if seen is None else seen
    else:
        scores = {} if targets is None else lc.score(shown, targets)
        if targets is not None:
            told = [picture["psnr"] for picture in scores["pictures"]]
            _keep(contact_sheet(lc.play(shown, picture_only=True), targets, told, title), "pictures.webp")
        seen = room(shown, stop) if seen is None else seen
    figures: dict[str, float] = {name: scores[name] for name in ("psnr_mean", "psnr_min") if name in scores}
    lc.save(figures, FOLDER / "told.json", overwrite=True)
    _thumbnail(seen)


def room(cube: lc.Cube, stop: int = 0) -> Levels:
    """The room of a cube at one of its stops."""
    return to_uint8(tableau(cube, float(cube.angles_deg[stop]), DRAWN[::-1]), cube.transfer)


def beside(pictures: Sequence[NDArray[np.floating]], across: int) -> Levels:
    """Pictures in linear light, ``(row, column, 3)``, in rows of so many, enlarged as far as a thumbnail has room."""
    scale = max(1, DRAWN[0] // (across * pictures[0].shape[1]))
    large = [to_uint8(each).repeat(scale, 0).repeat(scale, 1) for each in pictures]
    framed = [np.pad(each, ((GAP, GAP), (GAP, GAP), (0, 0))) for each in large]
    rows = [np.concatenate(framed[k : k + across], axis=1) for k in range(0, len(framed), across)]
    return np.concatenate(rows)


def _keep(picture: Levels, name: str) -> None:
    image = Image.fromarray(picture)
    image.thumbnail((WIDEST, 4 * WIDEST))
    image.save(FOLDER / name, quality=FINE)


def _thumbnail(seen: Levels) -> None:
    """As carefully packed as there is room for."""
    drawn, quality = Image.fromarray(seen), FINE
    if drawn.width > drawn.height:
        image = ImageOps.fit(drawn, THUMBNAIL, Image.Resampling.LANCZOS)
    else:  # what is no wider than high is not cut off
        image = ImageOps.pad(drawn, THUMBNAIL, Image.Resampling.LANCZOS, tuple(seen[0, 0].tolist()))
    while quality > 0:
        image.save(FOLDER / "thumbnail.webp", quality=quality, method=6)
        if (FOLDER / "thumbnail.webp").stat().st_size <= MOST_BYTES:
            return
        quality -= 6


def scattered(points: NDArray[np.floating], looks: NDArray[np.floating]) -> Levels:
    """Points in space before a dark ground, seen from the front, the right and above; the nearest hide the others."""
    right, up, toward = np.array([(0.76, 0.65, 0.0), (-0.24, 0.28, 0.93), (0.6, -0.7, 0.37)])
    scale = 0.62 * DRAWN[1] / np.ptp(points, axis=0).max()
    column = np.rint(DRAWN[0] / 2 + scale * points @ right).astype(int)
    row = np.rint(DRAWN[1] / 2 - scale * points @ up).astype(int)
    order = np.argsort(points @ toward, kind="stable")
    canvas = np.full((DRAWN[1], DRAWN[0], 3), 0.07)
    for down, aside in np.ndindex(SPOT, SPOT):
        canvas[(row + down)[order], (column + aside)[order]] = looks[order]
    return np.rint(255 * canvas).astype(np.uint8)
