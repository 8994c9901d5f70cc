"""Looks whether every link of a finished site leads somewhere, in plain HTML too, which Sphinx does not follow."""

import re
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

from sphinx.application import Sphinx
from sphinx.util.logging import getLogger

_LOGGER = getLogger(__name__)
#: What stands in pages of their own, which are not the site's.
_APART = {"_static", "_gallery", "_downloads"}


def dead(site: Path) -> Iterator[str]:
    """Every link within a site that leads nowhere, and the page that has it."""
    texts = {
        file.resolve(): file.read_text(encoding="utf-8")
        for file in sorted(site.rglob("*.html"))
        if not _APART & set(file.relative_to(site).parts)
    }
    names = {file: set(re.findall(r'\bid="([^"]+)"', text)) for file, text in texts.items()}
    for file, text in texts.items():
        for link in re.findall(r'(?:href|src)="([^"]*)"', text):
            if re.match(r"\w+:", link):
                continue
            path, _, name = unquote(link).partition("#")
            target = (file.parent / path.split("?")[0]).resolve() if path else file
            if not target.exists() or (name and name not in names.get(target, {name})):
                yield f"{file.relative_to(site.resolve())}: {link}"


def look(app: Sphinx, failed: Exception | None) -> None:
    """Let a build fail that has dead links."""
    if failed is None and app.builder.format == "html":
        for link in dead(Path(app.outdir)):
            _LOGGER.warning("a link leads nowhere: %s", link)
            app.statuscode = 1


def setup(app: Sphinx) -> dict[str, bool]:
    """Look last, when all is there."""
    app.connect("build-finished", look, priority=900)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
