"""A report as one HTML page: what is to be read first comes first, and nothing in it tells when it was written."""

import hashlib
import platform
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from importlib.resources import files

import numpy as np

from lightcube.optics.cube import Cube
from lightcube.optics.stack import Stack
from lightcube.report import sections
from lightcube.report.films import films
from lightcube.report.html import element, pairs, plain, sentences, table, text
from lightcube.report.measuring import Findings
from lightcube.report.opening import Heading, judged, opening

#: What a page may load: its own style, and pictures that it holds itself. Nothing in it is run.
POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"
#: Makes the number that `digest` does, anywhere.
_CHECK = (
    "python -c \"import hashlib, lightcube; print(hashlib.sha256(lightcube.load('CUBE').extinction.tobytes())"
    '.hexdigest())"'
)


@dataclass(frozen=True)
class Origin:
    """A file, or a folder of files, that the report is made of.

    Parameters
    ----------
    role, name
        What it is, and its name.
    count, size
        How many files, and how many bytes together.
    sha256
        Of the file; of a folder that of the list that ``sha256sum`` prints of its files, in the order of their names.
    """

    role: str
    name: str
    count: int
    size: int
    sha256: str


@dataclass
class Command:
    """What makes a cube again, bit for bit, unless there are doubts.

    Parameters
    ----------
    lines
        Commands, one after the other, each as its parts: what is to be done, and the options with their values.
    doubts
        Sentences: what is not known of the cube, or what the command line cannot say.
    """

    lines: list[list[str]] = field(default_factory=list)
    doubts: list[str] = field(default_factory=list)


def page(found: Findings, heading: Heading, compared: str, command: Command, origins: Sequence[Origin]) -> str:
    """The text of a report.

    Parameters
    ----------
    found
        What was measured.
    heading
        What the cube is called, by whom and when it was made.
    compared
        What the cube was compared with, in words.
    command
        What makes the cube again.
    origins
        The files that were read.
    """
    is_stack = isinstance(found.cube.grid, Stack)
    parts = {
        "In words": judged(found),
        "Pictures": sections.pictures(found),
        **({"Films": films(found.cube)} if is_stack else {}),
        "Figures": sections.figures(found, compared),
        "Settings": sections.settings(found),
        "Curves": sections.curves(found),
        "A set-up that is a little off": sections.disturbances(found),
        "Before solving": sections.before(found),
        "How it was made": _provenance(found.cube, command, origins),
    }
    return document(heading.title, opening(found, heading), parts)


def document(title: str, head: str, parts: Mapping[str, str]) -> str:
    """The text of a report: what stands at its head, links, and its parts by name."""
    body = [
        element("header", head),
        element("nav", "".join(_link(name) for name in parts), aria_label="Parts of this report"),
        *(element("section", text("h2", name, id=_anchor(name)) + inside) for name, inside in parts.items()),
    ]
    inside_head = [
        '<meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">',
        '<meta name="color-scheme" content="light dark">',
        text("title", f"{title} – light cube report"),
        element("style", files("lightcube.report").joinpath("style.css").read_text(encoding="utf-8")),
    ]
    lines = ["<!doctype html>", '<html lang="en">', "<head>", *inside_head, "</head>", "<body>"]
    whole = "\n".join([*lines, element("main", "\n".join(body)), "</body>", "</html>"]) + "\n"
    return whole.encode("utf-8", "replace").decode("utf-8")  # names of files may hold what is no letter


def digest(cube: Cube) -> str:
    """SHA-256 of a cube's extinction, float32 in the order channel, z, y, x: equal if the cube is, bit for bit."""
    return hashlib.sha256(np.ascontiguousarray(cube.extinction).data).hexdigest()


def _anchor(name: str) -> str:
    return name.lower().replace(" ", "-")


def _link(name: str) -> str:
    return text("a", name, href=f"#{_anchor(name)}")


def _provenance(cube: Cube, command: Command, origins: Sequence[Origin]) -> str:
    """The command, what is recorded, and the files."""
    what = "stack" if isinstance(cube.grid, Stack) else "cube"
    return "\n".join([*_again(cube, command), *recorded(cube.provenance, what), *read_files(origins)])


def _again(cube: Cube, command: Command) -> Iterator[str]:
    """The command that makes the cube again, and how to see that it did."""
    yield text("h3", "Making it again")
    if command.doubts:
        yield text("p", "This comes near the cube; what stands between it and the very same one is said below:")
    else:
        yield text("p", "With the same pictures and the same versions, this makes the same cube, bit for bit:")
    lines = (" ".join(text("span", part) for part in line) for line in command.lines)
    yield element("pre", element("code", "\n".join(lines)), id="command")
    if command.doubts:
        yield sentences(command.doubts)
    what = "cells" if isinstance(cube.grid, Stack) else "voxels"
    yield text("p", f"The numbers of its {what} have this SHA-256, whatever kind of file they are in:")
    yield element("pre", text("code", digest(cube)), id="digest")
    yield element("p", "To compare, put the cube's name in place of <code>CUBE</code>:")
    yield element("pre", text("code", _CHECK))


def recorded(provenance: Mapping[str, object], what: str = "cube") -> Iterator[str]:
    """All that a thing remembers of how it was made, as it is written in its file."""
    facts = {name: value for name, value in provenance.items() if name != "predicted"}
    if facts:
        yield text("h3", f"Recorded in the {what}")
        yield pairs({name.replace("_", " "): plain(value) for name, value in facts.items()})
    yield from written_by()


def written_by() -> Iterator[str]:
    """What wrote the report."""
    yield text("h3", "This report")
    yield pairs({"lightcube": version("lightcube"), "Python": platform.python_version(), "NumPy": np.__version__})


def read_files(origins: Sequence[Origin]) -> Iterator[str]:
    """Names, sizes and checksums of the files."""
    rows = [(each.role, each.name, each.count, f"{each.size:,}".replace(",", " "), each.sha256) for each in origins]
    if not rows:
        return
    yield table("What was read", ("what", "name", "files", "bytes", "SHA-256"), rows, "files")
    if any(each.count > 1 for each in origins):
        yield element(
            "p",
            "Of a folder it is that of the list of its files: <code>find . -type f -not -path '*/.*' | LC_ALL=C sort "
            "| xargs -d '\\n' sha256sum | sha256sum</code>",
            class_="note",
        )
