"""Slides of the lessons for a projector: one HTML file each, no network, turned by arrow keys, printed a sheet each.

    python examples/slides.py [FOLDER]

They are made of docs/teach/slides/*.md, in a second, and go to out/slides, or FOLDER.
"""

import base64
import re
import sys
from pathlib import Path
from string import Template

from markdown_it import MarkdownIt

ROOT = Path(__file__).parents[1]
SOURCES = ROOT / "docs" / "teach" / "slides"
KINDS = {".png": "image/png", ".webp": "image/webp"}


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out" / "slides"
    folder.mkdir(parents=True, exist_ok=True)
    for source in sorted(SOURCES.glob("*.md")):
        made = folder / f"{source.stem}.html"
        made.write_text(slides(source))
        print(made)


def slides(source: Path) -> str:
    """The page of a lesson's slides, which are divided by lines of three dashes."""
    markdown = MarkdownIt("commonmark").enable("table")
    parts = source.read_text().split("\n---\n")
    sections = [f"<section>\n{embedded(markdown.render(part), source.parent)}</section>" for part in parts]
    page = Template(Path(__file__).with_suffix(".html").read_text())
    return page.substitute(title=parts[0].strip().splitlines()[0].lstrip("# "), sections="\n".join(sections))


def embedded(html: str, folder: Path) -> str:
    """The same with its pictures inside."""

    def inside(found: re.Match[str]) -> str:
        file = folder / found[1]
        return f'src="data:{KINDS[file.suffix]};base64,{base64.b64encode(file.read_bytes()).decode()}"'

    return re.sub(r'src="([^"]+)"', inside, html)


if __name__ == "__main__":
    main()
