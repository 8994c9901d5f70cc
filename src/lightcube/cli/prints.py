"""Pages of films that `lightcube solve` writes of a stack when it is solved, and keeps the stack beside."""

from __future__ import annotations

import shlex

from lightcube.backward.job import Job
from lightcube.cli.console import telling
from lightcube.errors import InputError
from lightcube.fabrication import exporting as fabrication
from lightcube.fabrication.films import FilmPages
from lightcube.io._places import place
from lightcube.optics.cube import Cube
from lightcube.verbs import exporting

#: What the name of pages ends with, and that of the stack beside them.
_PAGES, _STACK = ".pdf", ".zarr"


class Prints:
    """What ``-o prints.pdf`` asks for.

    Attributes
    ----------
    cube
        Where the stack or cube itself is to be kept.
    """

    cube: str

    def __init__(self, output: str, *, overwrite: bool) -> None:
        self._is_asked = output.lower().endswith(_PAGES)
        self._path, self._overwrite = output, overwrite
        self.cube = output[: -len(_PAGES)] + _STACK if self._is_asked else output

    def check(self, *, in_part: bool) -> None:
        """Raise `InputError` where pages cannot be written, or only a part of the stack is solved."""
        if not self._is_asked:
            return
        if in_part:
            raise InputError(f"{self._path} is of a whole stack, and --unit solves a part: let -o end in {_STACK}")
        fabrication.check(place(self._path), "film", overwrite=self._overwrite)

    def check_job(self, job: Job) -> None:
        """Raise `InputError` where it is no stack, or its films do not fit their pages."""
        if self._is_asked:
            FilmPages().laid_out(job.grid, job.targets.rig)

    def write(self, cube: Cube, *, as_json: bool) -> list[str]:
        """Write the pages, and return what is to be said of them."""
        if not self._is_asked:
            return []
        at = place(self._path)
        planned = fabrication.plan(cube, at, "film", {})
        with telling("writing", as_json=as_json) as tell:
            document = fabrication.write(
                cube,
                at,
                "film",
                planned,
                self._overwrite,
                tell,
                is_scored=True,
                made_from=exporting.made_from(self.cube, self._path),
            )
        told = [f"{self._path} is ready to be printed", *exporting.told(document)]
        return [*told, f"other paper, inks or dots: lightcube export film {shlex.quote(self.cube)} -o NAME.pdf"]
