"""The pictures of docs/relief.md: four photographs in one plate, and one photograph in colour.

    python examples/plate.py [FOLDER]

About a minute; the pictures go to docs/pictures, or FOLDER.
"""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

import lightcube as lc
from lightcube.drawing.relief_sheet import as_seen, relief_sheet
from lightcube.drawing.sheet import PAPER
from lightcube.optics.transfer import to_uint8
from lightcube.pictures import samples
from lightcube.solids.relief import side_of
from lightcube.solids.relief_light import shown

CHOSEN = ("camera", "astronaut", "coins", "cat")
#: Display pixels of a column, and what stays free between pictures; and of letters.
SCALE, GAP, LETTERS = 2, 12, 22


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "docs" / "pictures"
    known = samples.photographs(16)
    images = dict(zip(known.names, known.images, strict=True))
    images["astronaut"] = images["astronaut"][:260, 90:350]
    plate = lc.relief(lc.Pictures(tuple(images[name] for name in CHOSEN), CHOSEN))
    sheet = relief_sheet(plate, lc.score_relief(plate), "Four photographs in one plate")
    lc.save(sheet, folder / "relief.png", overwrite=True)
    lc.save(round_the_plate(plate), folder / "relief-round.png", overwrite=True)
    colour = lc.relief(lc.Pictures((images["astronaut"],), ("astronaut",)), colour=True)
    sheet = relief_sheet(colour, lc.score_relief(colour), "One photograph by three coloured lamps")
    lc.save(sheet, folder / "relief-colour.png", overwrite=True)


def round_the_plate(plate: lc.Relief) -> NDArray[np.uint8]:
    """The heights, what lamps show as they go round, and what one shows between two pictures."""
    heights = np.repeat((plate.heights_px / plate.heights_px.max())[..., None], 3, axis=2) ** 2.2
    seen = list(as_seen(plate, shown(plate)))
    between = as_seen(plate, lc.relief_shadow(plate, 45.0)[None])[0]
    tiles = [("heights", heights), *((f"lamp {side_of(deg)}", seen[k]) for k, deg in enumerate(plate.azimuths_deg))]
    tiles.append(("between two lamps", between))
    side = SCALE * len(heights)
    step, high = side + GAP, side + 2 * GAP + LETTERS
    made = Image.new("RGB", (3 * step + GAP, 2 * high + GAP), PAPER)
    draw, font = ImageDraw.Draw(made), ImageFont.load_default(LETTERS)
    for number, (name, light) in enumerate(tiles):
        row, column = divmod(number, 3)
        at = GAP + column * step, GAP + row * high
        tile = Image.fromarray(to_uint8(light.astype(np.float32))).resize((side, side), Image.Resampling.NEAREST)
        made.paste(tile, at)
        draw.text((at[0], at[1] + side + 2), name, (35, 38, 41), font)
    return np.asarray(made)


if __name__ == "__main__":
    main()
