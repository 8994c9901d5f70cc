"""The pictures of rooms in docs/stage.md: three screens, and two, each with what stands on them.

    python examples/rooms.py [FOLDER]

A few minutes; the pictures go to docs/pictures, or FOLDER.
"""

import sys
from pathlib import Path

import lightcube as lc
from lightcube.drawing.tableau import tableau
from lightcube.optics.transfer import to_uint8

HERE = Path(__file__).parent
ROOMS, SIZE = ("three-screens", "two-screens"), (540, 960)


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE.parent / "docs" / "pictures"
    for name in ROOMS:
        stage, targets = lc.read_stage_targets(HERE / "stages" / f"{name}.toml")
        cube = lc.solve(targets, stage.grid).cube
        seen = to_uint8(tableau(cube, float(cube.angles_deg[0]), SIZE))
        print(lc.save(seen, folder / f"room-{name}.png", overwrite=True))


if __name__ == "__main__":
    main()
