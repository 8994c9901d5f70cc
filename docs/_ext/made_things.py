"""Makes what pages show and takes a while: the cube on the first page, and the notebook; each once."""

import shutil
import subprocess
import sys
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

import notebook_page
from sphinx.application import Sphinx

ROOT = Path(__file__).parents[2]
#: Where it is kept: a folder for each thing, among the static files.
FOLDER = ROOT / "docs" / "_static" / "made"


def make_all(_app: Sphinx) -> None:
    """Make each of the two, unless it is of this very source."""
    once("home", ROOT / "examples" / "home.py", _home)
    once("notebook", ROOT / "examples" / "light-cube.ipynb", notebook_page.write)


def once(name: str, source: Path, make: Callable[[Path, Path], None]) -> None:
    """Make a thing of `source`, into a folder, unless that holds it; what it was made of stands beside it."""
    folder = FOLDER / name
    note, now = folder / "made-of.txt", fingerprint(source)
    if note.is_file() and note.read_text() == now:
        return
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    make(source, folder)
    note.write_text(now)


def fingerprint(source: Path) -> str:
    """What a thing depends on, as a digest: its source, what makes it, and all of the package."""
    digest = sha256(source.read_bytes() + Path(notebook_page.__file__).read_bytes())
    for file in sorted((ROOT / "src" / "lightcube").rglob("*")):
        if file.is_file() and "__pycache__" not in file.parts:
            digest.update(file.read_bytes())
    return digest.hexdigest()


def _home(script: Path, folder: Path) -> None:
    subprocess.run([sys.executable, script, folder / "page.html"], check=True)  # noqa: S603


def setup(app: Sphinx) -> dict[str, bool]:
    """Make them before static files are copied, and before pages are read."""
    app.connect("builder-inited", make_all)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
