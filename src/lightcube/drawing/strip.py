"""What a cube shows at its stops as one small picture, for where it cannot be turned."""

import base64
from io import BytesIO
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from lightcube.forward.casting import cast
from lightcube.optics.cube import Cube
from lightcube.optics.stack import Stack
from lightcube.optics.transfer import to_uint8
from lightcube.wording import counted

#: Pictures in all and side by side, shorter side that they are enlarged to by whole pixels, gap, line height; pixels.
_MOST, _PER_LINE, _SIDE, _GAP, _LINE = 16, 8, 96, 6, 30
#: Height of the letters, pixels.
_LETTERS = 17
_PAPER, _INK = (252, 251, 248), (35, 38, 41)


def still(cube: Cube) -> dict[str, Any]:
    """A cube by MIME type: a line of text, and a picture of `thumbnails` where it has 1 or 3 colours."""
    text = {"text/plain": repr(cube)}
    if len(cube.extinction) not in (1, 3):
        return text
    return {"image/png": base64.b64encode(thumbnails(cube)).decode(), **text}


def thumbnails(cube: Cube) -> bytes:
    """What a cube shows at its stops (of more than 16, 16), with a line of facts: a PNG."""
    count = len(cube.names)
    chosen = np.unique(np.linspace(0, count - 1, min(count, _MOST)).round().astype(int))
    rig = cube.rig.take(chosen)
    shown = cast(cube, rig, cube.powers[np.isin(cube.rig.pairs[:, 0], chosen)])
    tiles = []
    for picture, (rows, columns) in zip(shown, rig.stops.window, strict=True):
        levels = to_uint8(picture[:rows, :columns], cube.transfer)
        scale = max(1, round(_SIDE / min(rows, columns)))
        image = Image.fromarray(np.ascontiguousarray(np.broadcast_to(levels, (rows, columns, 3))))
        tiles.append(image.resize((columns * scale, rows * scale), Image.Resampling.NEAREST))
    return _encoded(_strip(tiles, _facts(cube)))


def _strip(tiles: list[Image.Image], facts: str) -> Image.Image:
    """Pictures side by side, in several lines if there are many, and a line of text below."""
    lines = -(-len(tiles) // _PER_LINE)
    across = -(-len(tiles) // lines)
    wide, high = max(tile.width for tile in tiles) + _GAP, max(tile.height for tile in tiles) + _GAP
    font = ImageFont.load_default(_LETTERS)
    width = max(across * wide + _GAP, int(font.getlength(facts)) + 2 * _GAP)
    strip = Image.new("RGB", (width, lines * high + _GAP + _LINE), _PAPER)
    for number, tile in enumerate(tiles):
        line, place = divmod(number, across)
        strip.paste(tile, (_GAP + place * wide, _GAP + line * high))
    ImageDraw.Draw(strip).text((_GAP, lines * high + _GAP + 2), facts, _INK, font)
    return strip


def _facts(cube: Cube) -> str:
    """Size, pictures and quality, in one line."""
    nz, ny, nx = cube.grid.shape
    rows, columns = cube.rig.picture_shape
    count = len(cube.names)
    at_most = " at most" if np.ptp(cube.rig.stops.window, axis=0).any() else ""
    many = f"{counted(count, 'picture')} of{at_most}"
    is_stack = isinstance(cube.grid, Stack)
    cells = f"{counted(nz, 'film')} of {nx} x {ny} cells" if is_stack else f"{nx} x {ny} x {nz} voxels"
    facts = [f"{cells} of {cube.grid.sides_in_words}", f"{many} {columns} x {rows}"]
    if "psnr_mean" in cube.scores:
        facts.append(f"PSNR {cube.scores['psnr_mean']:.1f} dB")
    if cube.status != "complete":
        facts.append(cube.status)
    return ("stack: " if is_stack else "light cube: ") + ", ".join(facts)


def _encoded(image: Image.Image) -> bytes:
    stream = BytesIO()
    image.save(stream, "PNG", optimize=True)
    return stream.getvalue()
