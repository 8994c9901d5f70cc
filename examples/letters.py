"""Three letters for three walls: draws docs/pictures/letters.png, an object and its shadows, and why.png.

    python examples/letters.py [FOLDER]

A few seconds. Letters are DejaVu Sans Bold, which comes with matplotlib (extra `plot`); the pictures go to
docs/pictures, or FOLDER. `why.png` maps what no object casts of a word that cannot be built, `bent.png` how that was
bent until one casts it, and `hut.png` shows that, whole and as a lace.
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib import font_manager
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

import lightcube as lc
from lightcube.drawing.blame import blame_maps
from lightcube.drawing.overlay import overlays
from lightcube.solids.certificate import cast_mesh
from lightcube.solids.walls import block

Array = NDArray[np.floating]

#: Pixels of the picture, and as how many it is drawn before it is made smaller.
SIZE, FINER = 560, 2
#: Voxels along the block, mm of its longest side and of the room's.
VOXELS, SIDE_MM, ROOM_MM = 128, 100.0, 170.0
#: Faces of a body are this bright at least; shadows on the walls are, and walls.
DARKEST, SHADOW, WALL = 0.25, 0.28, (0.98, 0.9, 0.82)
COLOUR = np.array([0.95, 0.55, 0.2])


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "docs" / "pictures"
    given, grid = on_walls("GEB")
    shape = lc.hull(given, grid)
    print("GEB", shape, shape.mesh, lc.certify(shape.mesh, given), lc.reach(given, grid))
    lc.save(picture(shape), folder / "letters.png", overwrite=True)
    found = lc.reach(*on_walls("HUT"))
    print("HUT", found, found.shares)
    lc.save(beside(list(blame_maps(found))), folder / "why.png", overwrite=True)
    grid = lc.Grid((VOXELS,) * 3, SIDE_MM / VOXELS)
    cuts = lc.cut(lc.Pictures(tuple(map(letter, "HUT")), ("H", "U", "T")))
    free = lc.silhouettes(cuts, lc.walls(grid).rig(), "stretch")  # with room around them
    bent = lc.repair(free, grid, wall_px=1.0)
    print("HUT", bent, bent.warped, lc.reach(bent.shape.silhouettes, grid))
    lc.save(overlays(bent), folder / "bent.png", overwrite=True)
    lace = lc.carve(bent.shape, "lace")
    print("HUT", lace.mesh, lace.inside.sum() / bent.shape.inside.sum(), lc.certify(lace.mesh, lace.silhouettes))
    rows = [picture(bent.shape), picture(lace)]
    lc.save(np.concatenate(rows, axis=1), folder / "hut.png", overwrite=True)


def on_walls(word: str) -> tuple[lc.Silhouettes, lc.Grid]:
    """Three letters on the walls of the block that they fill."""
    cuts = lc.cut(lc.Pictures(tuple(map(letter, word)), tuple(word)))
    grid, _ = block(cuts, VOXELS, SIDE_MM)
    return lc.silhouettes([one.trimmed() for one in cuts], lc.walls(grid).rig(), "stretch"), grid


def beside(maps: list[NDArray[np.uint8]]) -> NDArray[np.uint8]:
    """Pictures in a row, enlarged, with paper around each."""
    framed = [np.pad(each, ((6, 6), (6, 6), (0, 0)), constant_values=255) for each in maps]
    return np.concatenate(framed, axis=1).repeat(2, axis=0).repeat(2, axis=1)


def letter(text: str) -> NDArray[np.float32]:
    """A black letter on white, ``(row, column, 3)``."""
    font = ImageFont.truetype(font_manager.findfont("DejaVu Sans:bold"), 300)
    left, top, right, bottom = font.getbbox(text)
    image = Image.new("L", (int(right - left) + 80, int(bottom - top) + 80), 255)
    ImageDraw.Draw(image).text((40 - left, 40 - top), text, font=font, fill=0)
    grey = np.asarray(image, np.float32) / 255
    return np.repeat(grey[:, :, None], 3, axis=2)


def picture(shape: lc.Shape) -> NDArray[np.uint8]:
    """The object between its three walls, seen from the front, the right and above, far away."""
    points, colours = (np.concatenate(each) for each in zip(body(shape.mesh), *walls(shape), strict=True))
    toward = np.array([0.62, -0.72, 0.5])
    toward /= np.linalg.norm(toward)
    right = np.cross((0.0, 0.0, 1.0), toward)
    right /= np.linalg.norm(right)
    up = np.cross(toward, right)
    side = SIZE * FINER
    scale = side / (1.72 * ROOM_MM)
    column = np.rint(side / 2 + scale * points @ right).astype(int)
    row = np.rint(side / 2 - scale * points @ up).astype(int)
    seen = (column >= 0) & (column < side) & (row >= 0) & (row < side)
    order = np.argsort(points[seen] @ toward, kind="stable")  # what is nearest comes last, and stays
    canvas = np.ones((side, side, 3))
    canvas[row[seen][order], column[seen][order]] = colours[seen][order]
    levels = Image.fromarray(np.rint(255 * canvas).astype(np.uint8))
    return np.asarray(levels.resize((SIZE, SIZE), Image.Resampling.BOX))


def body(mesh: lc.Mesh, colour: Array = COLOUR) -> tuple[Array, Array]:
    """Points all over a mesh of one colour, and theirs under a lamp over the right shoulder."""
    weights = np.array([(a, b, 3 - a - b) for a in range(4) for b in range(4 - a)]) / 3
    points = np.einsum("pk,fkc->fpc", weights, mesh.triangles).reshape(-1, 3)
    a, b, c = mesh.triangles.transpose(1, 0, 2)
    around = np.zeros_like(mesh.vertices_mm)
    np.add.at(around, mesh.faces, np.cross(b - a, c - a)[:, None])  # small faces at a corner count for little
    normals = np.einsum("pk,fkc->fpc", weights, around[mesh.faces]).reshape(-1, 3)
    lit = normals @ np.array([0.45, -0.5, 0.74]) / np.linalg.norm(normals, axis=1)
    bright = DARKEST + (1 - DARKEST) * np.clip(lit, 0, 1)
    return points, bright[:, None] * colour


def walls(shape: lc.Shape) -> list[tuple[Array, Array]]:
    """Points all over the three walls of a room, with the shadows that the mesh casts there."""
    cast = cast_mesh(shape.mesh, shape.rig)
    half = ROOM_MM / 2
    made = []
    z_mm, y_mm, x_mm = shape.grid.size_mm
    count = int(SIZE * FINER * 0.9)
    down, along = np.meshgrid(*[np.linspace(half, -half, count), np.linspace(-half, half, count)], indexing="ij")
    fixed = np.full_like(along, half)
    places = (
        (np.stack([along, fixed, down], axis=2), (z_mm, x_mm)),  # seen from the front
        (np.stack([-fixed, along, down], axis=2), (z_mm, y_mm)),  # from the right
        (np.stack([along, down, -fixed], axis=2), (y_mm, x_mm)),  # from above
    )
    fine = shape.grid.voxel_mm / (cast.shape[1] / shape.rig.picture_shape[0])
    for picture, light, (place, (high, wide)) in zip(cast, WALL, places, strict=True):
        row, column = np.floor((high / 2 - down) / fine).astype(int), np.floor((along + wide / 2) / fine).astype(int)
        on = (row >= 0) & (row < picture.shape[0]) & (column >= 0) & (column < picture.shape[1])
        dark = np.zeros(on.shape, bool)
        dark[on] = picture[row[on], column[on]]
        shade = np.where(dark, SHADOW, light)[..., None] * np.array([1.0, 1.0, 1.02])
        made.append((place.reshape(-1, 3), np.clip(shade, 0, 1).reshape(-1, 3)))
    return made


if __name__ == "__main__":
    main()
