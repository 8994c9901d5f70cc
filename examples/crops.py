"""The picture of docs/making.md that shows crops: `lightcube check --sheet` of photographs as cameras took them.

    python examples/crops.py [FOLDER]

A few seconds; the picture goes to docs/pictures, or FOLDER.
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import skimage.data
from PIL import Image

from lightcube.cli.main import run

#: An upright one decides the shape of all: of the others much is cut off.
PHOTOGRAPHS = ("retina", "rocket", "chelsea", "coffee", "astronaut", "coins")
UPRIGHT = (206, 40, 1206, 1373)


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "docs" / "pictures"
    with TemporaryDirectory() as photos:
        for number, name in enumerate(PHOTOGRAPHS):
            image = Image.fromarray(getattr(skimage.data, name)())
            (image.crop(UPRIGHT) if name == "retina" else image).save(Path(photos, f"{number}-{name}.png"))
        sheet = str(folder / "wanted.png")
        sys.exit(run(["check", photos, "--n", "64", "--focus", "0.6,0.5", "--sheet", sheet, "--overwrite"]))


if __name__ == "__main__":
    main()
