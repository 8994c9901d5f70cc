"""The pictures of docs/light.md: what a wall shows of cubes that were asked for thin beams, for areas, and for a mat.

    python examples/wall.py [FOLDER]

About a minute; the pictures go to docs/pictures, or FOLDER.
"""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import lightcube as lc
from lightcube.backward.pieces import Step
from lightcube.optics.transfer import encode, to_uint8
from lightcube.pictures import samples
from lightcube.scoring.metrics import psnr

SIDE, PIXELS = 64, 32
#: Display pixels of a picture's pixel, a multiple of the parts that it is shown in.
SCALE, PARTS = 6, 6


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "docs" / "pictures"
    grid = lc.Grid((SIDE, SIDE, SIDE), 100 / SIDE)
    angles_deg = lc.spread_angles(16, elevation_deg=35)
    rig = lc.turntable(grid, angles_deg, elevation_deg=35, picture_shape=(PIXELS, PIXELS))
    targets = lc.fit(samples.photographs(16), rig)
    few = [0, 2, 4, 5]
    recipes = {
        "thin": lc.Recipe(passes=100, light=lc.Light.thin()),
        "area": lc.Recipe(passes=100),
        "smooth": lc.Recipe(passes=100, light=lc.Light(grain=0.03)),
        "mat": lc.Recipe(passes=100, mat=lc.Mat()),
        "grey": lc.Recipe(passes=100, mat=lc.Mat(0.25)),
    }
    cubes = {name: lc.solve(targets, grid, recipe).cube for name, recipe in recipes.items()}
    wanted = [encode(targets.pictures[p]) for p in few]
    rows = [wanted]
    rows += [[shown(cubes[name], p, light) for p in few] for name, light in (("thin", "thin"), ("thin", "area"))]
    rows += [[shown(cubes["area"], p, "area") for p in few]]
    save(folder / "light-area.png", [[larger(each, SCALE) for each in row] for row in rows])
    fine = [[closely(cubes[name], p) for p in few] for name in ("thin", "area", "smooth")]
    save(folder / "light-grain.png", [[larger(each, SCALE // PARTS) for each in row] for row in fine])
    screens = [lc.play(cubes[name], angles_deg[few]) for name in ("area", "mat", "grey")]
    mats = [[larger(np.minimum(encode(each), 1), 2) for each in screen] for screen in screens]
    save(folder / "light-mat.png", mats)
    save(folder / "light-db.png", [[larger(each, SCALE) for each in ladder(grid)]])


def shown(cube: lc.Cube, picture: int, light: str) -> NDArray[np.floating]:
    """A picture of a cube in display values."""
    rig = cube.rig.take([picture])
    return encode(next(lc.cast(cube, rig, cube.powers[[picture]], light="thin" if light == "thin" else "area")))


def closely(cube: lc.Cube, picture: int) -> NDArray[np.floating]:
    """A picture of a cube, each pixel in many parts."""
    return encode(next(lc.cast(cube, cube.rig.take([picture]), cube.powers[[picture]], zoom=PARTS)))


def ladder(grid: lc.Grid) -> list[NDArray[np.floating]]:
    """One photograph as it is cast at 20, 25, 30, 35 and 40 dB, while its cube is being solved, and as it is wanted."""
    angles_deg = lc.spread_angles(16, elevation_deg=35)
    rig = lc.turntable(grid, angles_deg, elevation_deg=35, picture_shape=(40, 40))
    targets = lc.fit(samples.photographs(16), rig)
    right, weight = encode(targets.pictures[4]), targets.weight[4]
    found: list[NDArray[np.floating]] = []

    def watch(step: Step) -> bool:
        if step.shown is not None:
            picture = encode(step.shown()[4])
            if psnr(picture, right, weight) >= 20 + 5 * len(found):
                found.append(picture)
        return len(found) == 5

    clear = lc.Cube(np.zeros((3, *grid.shape), np.float32), grid, rig)  # else small cubes come first, and it jumps
    lc.solve(targets, grid, lc.Recipe(passes=300), start=clear, callback=watch)
    return [*found, right]


def larger(picture: NDArray[np.floating], scale: int) -> NDArray[np.floating]:
    """Each pixel a square of so many."""
    return picture.repeat(scale, axis=0).repeat(scale, axis=1)


def save(file: Path, rows: list[list[NDArray[np.floating]]]) -> None:
    """Pictures in rows, with a little room between them."""
    high, wide = (max(each.shape[axis] for row in rows for each in row) for axis in (0, 1))
    sheet = np.ones((len(rows) * (high + 8) - 8, len(rows[0]) * (wide + 8) - 8, 3), np.float32)
    for i, row in enumerate(rows):
        for j, picture in enumerate(row):
            top, left = i * (high + 8), j * (wide + 8)
            sheet[top : top + picture.shape[0], left : left + picture.shape[1]] = picture
    lc.save(to_uint8(sheet, "linear"), file, overwrite=True)
    print(file)


if __name__ == "__main__":
    main()
