"""Tiles of the gallery: each script of examples/gallery runs once, and what it makes is kept.

    python docs/_ext/tiles.py [NAME ...]

makes tiles (all of them, or these), and keeps their thumbnails in docs/pictures/gallery, for sites that are built
without running the scripts. What a script makes stays in out/gallery, and is made anew when the script, what it reads,
or the package has changed.
"""

import ast
import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from kept import PACKAGE, once

ROOT = Path(__file__).parents[2]
SCRIPTS, MADE, KEPT = ROOT / "examples" / "gallery", ROOT / "out" / "gallery", ROOT / "docs" / "pictures" / "gallery"
#: What scripts share and read, beside themselves and the package.
SHARED, READ = "tile", tuple(ROOT / "examples" / each for each in ("letters.py", "stages", "films"))


class Tile(NamedTuple):
    """A script as its docstring tells of it."""

    name: str
    title: str
    told: str
    commands: str


def names() -> list[str]:
    """Of all tiles."""
    return sorted(path.stem for path in SCRIPTS.glob("*.py") if path.stem != SHARED)


def tile(name: str) -> Tile:
    """A title, paragraphs, and the commands that do the same, which are indented."""
    title, *rest = (ast.get_docstring(ast.parse((SCRIPTS / f"{name}.py").read_text())) or "").splitlines()
    told = [line for line in rest if not line.startswith("    ")]
    commands = [line.removeprefix("    ") for line in rest if line.startswith("    ")]
    return Tile(name, title, "\n".join(told).strip(), "\n".join(commands))


def make(name: str) -> Path:
    """The folder of what a script made; it runs where that is not there, or something that decides it has changed."""
    script = SCRIPTS / f"{name}.py"
    once(MADE / name, [script, SCRIPTS / f"{SHARED}.py", *READ], lambda folder: _run(script, folder))
    return MADE / name


def _run(script: Path, folder: Path) -> None:
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE.parent)}
    command = [sys.executable, str(script), str(folder)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)  # noqa: S603
    if done.returncode:
        raise RuntimeError(f"{script.name} of the gallery failed: {done.stderr.strip()}")
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    (folder / "seconds.txt").write_text(f"{seconds:.0f}")


def seconds_of(folder: Path) -> str:
    """Of a processor, that a script took."""
    return (folder / "seconds.txt").read_text()


if __name__ == "__main__":
    for chosen in sys.argv[1:] or names():
        made = make(chosen)
        shutil.copy(made / "thumbnail.webp", KEPT / f"{chosen}.webp")
        print(f"{chosen}: {seconds_of(made)} s of a processor", flush=True)  # noqa: T201
