"""Makes the cube on the first page, and the notebook, before pages are read; each once, until it changes."""

import subprocess
import sys
from pathlib import Path

import notebook_page
from kept import once
from sphinx.application import Sphinx

ROOT = Path(__file__).parents[2]
#: Where it is kept: a folder for each thing, among the static files.
FOLDER = ROOT / "docs" / "_static" / "made"


def make_all(_app: Sphinx) -> None:
    """Make each of the two, unless it is of this very source."""
    cube, shown = ROOT / "examples" / "home.py", ROOT / "examples" / "light-cube.ipynb"
    once(FOLDER / "home", [cube], lambda folder: _run(cube, folder / "page.html"))
    once(
        FOLDER / "notebook",
        [shown, Path(notebook_page.__file__)],
        lambda folder: notebook_page.write(shown, folder),
    )


def _run(script: Path, page: Path) -> None:
    subprocess.run([sys.executable, script, page], check=True)  # noqa: S603


def setup(app: Sphinx) -> dict[str, bool]:
    """Make them before static files are copied, and before pages are read."""
    app.connect("builder-inited", make_all)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
