"""A horse, a heart and a star in one solid: draws docs/pictures/horse.png, the solid between its walls.

    python examples/horse.py [FOLDER]

A few seconds. The outlines are curves that are drawn here; the pictures go to docs/pictures, or FOLDER: horse.png, and
horse-bent.png, what is cast over what was drawn.
"""

import math
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from letters import picture
from numpy.typing import NDArray
from PIL import Image, ImageDraw

import lightcube as lc
from lightcube.drawing.overlay import overlays
from lightcube.verbs import hulls, making
from lightcube.verbs.options import Options

#: Pixels of an outline's side.
PIXELS = 512
#: Places between two corners of a curve.
STEPS = 16

Points = list[tuple[float, float]]

#: A standing horse that looks to the left: corners in per cent, of which a smooth curve goes through all.
HORSE: Points = [
    (6, 30), (10, 26), (17, 20), (22, 13), (24, 5), (28, 12), (34, 15), (41, 22), (47, 31), (56, 35),
    (68, 34), (79, 32), (86, 34), (92, 40), (96, 52), (96, 66), (92, 60), (90, 50), (87, 46),
    (87, 55), (84, 62), (86, 70), (84, 82), (86, 94), (86, 98), (77, 98), (78, 92), (77, 80), (73, 70), (68, 64),
    (58, 66), (48, 66), (44, 68), (43, 80), (45, 94), (46, 98), (37, 98), (37, 90), (35, 78), (33, 64),
    (28, 54), (26, 44), (24, 36), (18, 37), (12, 39), (8, 37),
]  # fmt: skip


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "docs" / "pictures"
    drawn = {"horse": smooth(HORSE), "heart": heart(), "star": star()}
    with tempfile.TemporaryDirectory() as place:
        paths = [lc.save(outline(points), f"{place}/{name}.png") for name, points in drawn.items()]
        wanted = hulls.read(paths, Options(), hulls.Cutting(is_walls=True))
    print("given", lc.reach(wanted.silhouettes, wanted.grid), f"stretched by {wanted.stretched:.1%}")
    began = time.process_time()
    made = making.make(wanted, making.Making())
    print(f"{time.process_time() - began:.1f} s of one core or more")
    print("bent", made, made.warped, made.kept_forms, f"outlines moved by {made.moved_px:.2f} px")
    print("cast", lc.reach(made.shape.silhouettes, made.shape.grid), made.shape.mesh)
    print(lc.certify(made.shape.mesh, made.shape.silhouettes), "base", made.shape.provenance["base_mm"], "mm")
    lc.save(picture(made.shape), folder / "horse.png", overwrite=True)
    lc.save(overlays(made), folder / "horse-bent.png", overwrite=True)


def smooth(corners: Points) -> Points:
    """A closed curve through corners (E. Catmull and R. Rom, 1974)."""
    found = []
    for number in range(len(corners)):
        a, b, c, d = (np.array(corners[(number + k - 1) % len(corners)]) for k in range(4))
        for t in np.arange(STEPS) / STEPS:
            place = b + t * (c - a) / 2 + t * t * (a - 2.5 * b + 2 * c - d / 2) + t**3 * (d - a + 3 * (b - c)) / 2
            found.append((float(place[0]), float(place[1])))
    return found


def heart() -> Points:
    """The sixth-degree curve that everybody draws."""
    turn = np.linspace(0, 2 * math.pi, 400, endpoint=False)
    across = 16 * np.sin(turn) ** 3
    up = 13 * np.cos(turn) - 5 * np.cos(2 * turn) - 2 * np.cos(3 * turn) - np.cos(4 * turn)
    return list(zip((50 + 2.9 * across).tolist(), (47 - 2.9 * up).tolist(), strict=True))


def star() -> Points:
    """Five points, not too sharp."""
    turns = -math.pi / 2 + np.arange(10) * math.pi / 5
    far = np.where(np.arange(10) % 2, 22.0, 48.0)
    return list(zip((50 + far * np.cos(turns)).tolist(), (52 + far * np.sin(turns)).tolist(), strict=True))


def outline(points: Points) -> NDArray[np.uint8]:
    """A black shape on white, ``(row, column, 3)`` levels."""
    times, room = 4 * PIXELS / 120, 10
    image = Image.new("L", (4 * PIXELS, 4 * PIXELS), 255)
    ImageDraw.Draw(image).polygon([((x + room) * times, (y + room) * times) for x, y in points], fill=0)
    return np.asarray(image.resize((PIXELS, PIXELS), Image.Resampling.BOX).convert("RGB"))


if __name__ == "__main__":
    main()
