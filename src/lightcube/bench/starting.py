"""Start-up: how long one waits for a command that has little to do."""

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from lightcube import io
from lightcube.bench.clock import seconds
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable


def starts() -> list[dict[str, Any]]:
    """Seconds of the second start of `lightcube --help`, and of `info` and `play` of a tiny cube."""
    grid = Grid((3, 3, 3))
    cube = Cube(np.ones((3, 3, 3, 3), np.float32), grid, turntable(grid, [10.0]))
    with tempfile.TemporaryDirectory() as folder:
        kept, shown = Path(folder) / "cube.zarr", Path(folder) / "shown.npy"
        io.save(cube, kept)
        commands = [
            ["--help"],
            ["info", str(kept)],
            ["play", str(kept), "-o", str(shown), "--angles-deg", "10", "--overwrite"],
        ]
        return [{"command": words[0], "seconds": _second(words)} for words in commands]


def _second(words: list[str]) -> float:
    """Run a command twice; return the seconds of the second time, when everything compiled is on the disk."""
    command = [sys.executable, "-m", "lightcube", *words]

    def run() -> None:
        subprocess.run(command, check=True, capture_output=True)  # noqa: S603

    run()
    return seconds(run, 1)["seconds"]
