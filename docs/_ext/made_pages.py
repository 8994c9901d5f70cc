"""Writes the pages of the reference that are made of the program itself, before the others are read."""

from pathlib import Path

import commands
import names
import schemas
import sentences
from sphinx.application import Sphinx

#: Where they are written, below the docs; nothing here is kept.
FOLDER = Path("reference", "made")


def write(app: Sphinx) -> None:
    """Write those that have changed, and take away those that are no more: what is as it was is not read again."""
    folder = Path(app.srcdir) / FOLDER
    pages = {**names.pages(), **commands.pages(), **schemas.pages(), **sentences.pages()}
    for name, text in pages.items():
        file = folder / name
        if not file.is_file() or file.read_text() != text:
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
    for file in folder.rglob("*.*"):
        if file.relative_to(folder).as_posix() not in pages:
            file.unlink()


def setup(app: Sphinx) -> dict[str, bool]:
    """Write them before any page is looked for."""
    app.connect("builder-inited", write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
