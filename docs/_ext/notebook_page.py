"""The notebook as a page: it is run, and its cells and what they show become Markdown and pictures."""

import base64
from collections.abc import Iterator, Mapping
from logging import WARNING, getLogger
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient

#: What a front end alone understands.
_MAGIC = "%matplotlib inline\n"
#: Seconds that a cell may take.
_PATIENCE = 600


def write(source: Path, folder: Path) -> None:
    """Run a notebook, and write `notebook.txt` and its pictures into a folder."""
    run = nbformat.read(source, as_version=4)
    place, log = {"metadata": {"path": str(folder)}}, getLogger(__name__)
    log.setLevel(WARNING)
    NotebookClient(run, timeout=_PATIENCE, resources=place, log=log).execute()
    (folder / "notebook.txt").write_text(markdown(run.cells, folder))


def markdown(cells: list[Any], folder: Path) -> str:
    """The text of cells that were run; pictures go into the folder, and are named from the docs' own."""
    parts: list[str] = []
    for number, cell in enumerate(cells, 1):
        if cell.cell_type == "markdown":
            parts.append(cell.source.removeprefix("# A light cube").strip())
        else:
            parts.append(f"```python\n{cell.source.removeprefix(_MAGIC)}\n```")
            parts += _shown(cell.outputs, folder, number)
    return "\n\n".join(parts) + "\n"


def _shown(outputs: list[Any], folder: Path, number: int) -> Iterator[str]:
    """What a cell has shown: its richest form that stands on a page."""
    for output in outputs:
        if output.output_type == "stream":
            yield f"```text\n{output.text.rstrip()}\n```"
            continue
        data: Mapping[str, str] = output.data
        if "image/png" in data:
            picture = folder / f"{number}.png"
            picture.write_bytes(base64.b64decode(data["image/png"]))
            yield f"![What the cell above shows](_static/made/{folder.name}/{picture.name})"
        elif "text/plain" in data:
            yield f"```text\n{data['text/plain']}\n```"
