"""Follows the tutorials at full size, as a reader does, and takes their pictures.

    python examples/guides.py [FOLDER] [TUTORIAL ...]

Some ten minutes; the pictures go to docs/pictures, or FOLDER. `follow` is what the tests do too, with smaller cubes.
"""

import contextlib
import io
import re
import shlex
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from runpy import run_path
from tempfile import TemporaryDirectory
from typing import Any

from PIL import Image

import lightcube as lc
from lightcube.cli.main import run

DOCS = Path(__file__).parents[1] / "docs"
#: What each tutorial makes, and the picture of the docs that it becomes.
PICTURES: Mapping[str, Mapping[str, str]] = {
    "ten-photos": {"sheet.png": "tutorial-ten.webp"},
    "present": {"present.png": "tutorial-present.webp", "wanted.png": "tutorial-wanted.webp"},
    "three-letters": {"bent.png": "tutorial-bent.webp", "word.shape.zarr": "tutorial-letters.webp"},
    "film-stack": {"room.png": "tutorial-films.webp"},
    "stage-with-two-walls": {"room.png": "tutorial-walls.webp", "room.svg": "tutorial-walls.svg"},
    "your-own-solver": {"gems.png": "tutorial-solver.webp"},
}
WIDTH, QUALITY = 1200, 88


def main() -> None:
    chosen = [word for word in sys.argv[1:] if word in PICTURES]
    others = [word for word in sys.argv[1:] if word not in PICTURES]
    folder = Path(others[0]).resolve() if others else DOCS / "pictures"
    for name in chosen or PICTURES:
        with TemporaryDirectory() as here, contextlib.chdir(here):
            follow(DOCS / "tutorials" / f"{name}.md")
            for made, picture in PICTURES[name].items():
                keep(Path(made), folder / picture)


def keep(made: Path, picture: Path) -> None:
    """A picture for a page: as wide as one reads it."""
    if made.suffix == ".svg":
        picture.write_bytes(made.read_bytes())
        return
    if made.name.endswith(".shape.zarr"):
        drawn = run_path(str(Path(__file__).with_name("letters.py")))["picture"](lc.read_shape(made))
        image = Image.fromarray(drawn)
    else:
        image = Image.open(made).convert("RGB")
    if image.width > WIDTH:
        image = image.resize((WIDTH, round(image.height * WIDTH / image.width)), Image.Resampling.LANCZOS)
    image.save(picture, quality=QUALITY, method=6)


def fences(page: Path) -> list[tuple[str, str]]:
    """The blocks of a page in order, each with its language."""
    return re.findall(r"^```(\w*)\n(.*?)^```$", page.read_text(), re.DOTALL | re.MULTILINE)


def follow(page: Path, command: Callable[[str], str] = str, written: Callable[[str], str] = str) -> None:
    """Do in this folder what a page says, from top to bottom.

    Commands (`bash`) and Python run in order; what begins with a file's name (`toml`) is written to it; what Python
    prints is what stands below it (`text`), or this says where not.

    Parameters
    ----------
    page
        In Markdown.
    command, written
        Changes a command before it runs, and what is written: to smaller cubes.
    """
    names: dict[str, Any] = {"__name__": "guide"}
    printed = ""
    for language, text in fences(page):
        if language == "text" and printed and printed != text:
            raise SystemExit(f"{page} says\n{text}where this came:\n{printed}")
        printed = ""
        if language == "python":
            with contextlib.redirect_stdout(io.StringIO()) as out:
                exec(compile(text, str(page), "exec"), names)  # noqa: S102
            printed = out.getvalue()
        elif language == "toml" and (named := re.match(r"# (\S+\.toml)\n", text)):
            Path(named[1]).write_text(written(text))
        elif language == "bash":
            for line in text.splitlines():
                if run(shlex.split(command(line), comments=True)[1:]):
                    raise SystemExit(f"{page}: {line}: see above")


if __name__ == "__main__":
    main()
