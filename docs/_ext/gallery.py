"""The gallery: a page for each script of examples/gallery, with what it made, alive.

With `-D gallery_runs=0` nothing runs: then pages show the thumbnails that are kept, and say that they are no more.
Sphinx-Gallery runs scripts and catches their figures. What these make are whole pages, meshes and movies, with a
command beside each; so this is shorter than what would have to be taught to it.
"""

import html
import json
import shutil
from collections.abc import Sequence
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import Directive
from sphinx.application import Sphinx
from sphinx.util.display import status_iterator
from tiles import KEPT, MADE, ROOT, SHARED, Tile, make, names, seconds_of, tile

PAGES = ROOT / "docs" / "gallery"
#: What a page shows of what a script made, in a way of its own; the rest is offered as files.
OWN = {"page.html", "thumbnail.webp", "pictures.webp", "told.json", "made-of.txt", "seconds.txt"}
_UNMADE = "*A picture of it: this site was built without running the scripts. `make docs` runs them.*"
_SCRIPT = f"`{SHARED}.py` beside it has photographs by name, and writes the page, the thumbnail and the pictures."


def page_of(told: Tile, made: Path | None) -> str:
    """The text of a tile's page; where nothing was made it has a thumbnail instead of what is alive."""
    parts = [f"# {told.title}", told.told, *(_kept(told) if made is None else _alive(told, made))]
    parts += [f"## The command\n\n```console\n{told.commands}\n```"]
    if made is not None and (made / "pictures.webp").exists():
        what = '<img src="../_gallery/{}/pictures.webp" alt="What was wanted, and what is shown" loading="lazy">'
        parts += ["## The pictures", _html(what.format(told.name))]
    path = f"examples/gallery/{told.name}.py"
    parts += ["## The script", f"`{path}`. {_SCRIPT}", f"```{{literalinclude}} ../../{path}\n:language: python\n```"]
    return "\n\n".join(parts) + "\n"


def _kept(told: Tile) -> list[str]:
    picture = f'<img src="../_gallery/{told.name}.webp" width="480" height="320" alt="{html.escape(told.title)}">'
    return [_html(picture), _UNMADE]


def _alive(told: Tile, made: Path) -> list[str]:
    place = f"../_gallery/{told.name}"
    frame = f'<iframe class="alive" src="{place}/page.html" title="{html.escape(told.title)}" loading="lazy"></iframe>'
    links = [f'<a href="{place}/page.html">The page by itself</a>']
    others = sorted(path for path in made.iterdir() if path.name not in OWN)
    links += [f'<a href="{place}/{path.name}">{path.name}</a> ({path.stat().st_size / 1e6:.1f} MB)' for path in others]
    scores = json.loads((made / "told.json").read_text())
    good = f"{scores['psnr_mean']:.1f} dB on average, {scores['psnr_min']:.1f} the worst. " if scores else ""
    return [
        _html(frame),
        _html(f"<p>{' · '.join(links)}</p>"),
        f"{good}Made in {seconds_of(made)} s of one core.",
    ]


def _html(text: str) -> str:
    return f"```{{raw}} html\n{text}\n```"


class Tiles(Directive):  # type: ignore[misc]  # docutils has no types
    """Thumbnails, one for each name in its lines, that lead to their pages."""

    has_content = True

    def run(self) -> Sequence[nodes.Node]:
        """A row of links; an unknown name is an error."""
        unknown = sorted(set(self.content) - set(names()))
        if unknown:
            raise self.error(f"there is no examples/gallery/{unknown[0]}.py")
        links = [
            f'<a href="{name}.html"><img src="../_gallery/{name}.webp" width="480" height="320" alt="" loading="lazy">'
            f"<span>{html.escape(tile(name).title)}</span></a>"
            for name in self.content
        ]
        return [nodes.raw("", f'<div class="tiles">{"".join(links)}</div>', format="html")]


def write_pages(app: Sphinx) -> None:
    """Make what is to be made, and write a page for each tile; what has not changed is not touched."""
    for name in status_iterator(names(), "making the gallery... ", "brown", len(names()), app.verbosity):
        text = page_of(tile(name), make(name) if app.config.gallery_runs else None)
        path = PAGES / f"{name}.md"
        if not path.exists() or path.read_text() != text:
            path.write_text(text)


def copy_made(app: Sphinx, failed: Exception | None) -> None:
    """Put beside the pages what they show."""
    if failed is not None or app.builder.format != "html":
        return
    place = Path(app.outdir) / "_gallery"
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir()
    for name in names():
        if app.config.gallery_runs:
            shutil.copytree(MADE / name, place / name)
        thumbnail = MADE / name / "thumbnail.webp" if app.config.gallery_runs else KEPT / f"{name}.webp"
        shutil.copy(thumbnail, place / f"{name}.webp")


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive `tiles`, and when scripts run."""
    app.add_config_value("gallery_runs", True, "env", bool)
    app.add_directive("tiles", Tiles)
    app.add_css_file("gallery.css")
    app.connect("builder-inited", write_pages)
    app.connect("build-finished", copy_made)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
