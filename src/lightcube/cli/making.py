"""The movie of how a cube is made, which `lightcube solve` writes once the cube is, or not at all."""

from lightcube import io
from lightcube.backward.job import Job
from lightcube.cli import arguments
from lightcube.cli.console import counting, progress
from lightcube.drawing.films import ROOM, frames_of
from lightcube.drawing.making import MakingOf
from lightcube.drawing.poster import Format
from lightcube.errors import InputError
from lightcube.optics.cube import Cube
from lightcube.wording import counted


class Movie:
    """What `--making-of` asks for.

    Attributes
    ----------
    making
        What looks on while a cube is solved; None where there is no movie.
    """

    making: MakingOf | None = None

    def __init__(self, path: str | None, shape: Format | None, *, overwrite: bool) -> None:
        self._path, self._shape = path or "", shape
        self._output = io.Output(self._path, "pictures", overwrite)

    def check(self, *, elsewhere: bool) -> None:
        """Raise `InputError` where it cannot be written, or the cube is solved `elsewhere`, or in parts."""
        if not self._path:
            if self._shape is not None:
                raise InputError("--format is that of a movie: give --making-of too, or leave it out")
            return
        if not arguments.is_movie(self._path):
            raise InputError(f"--making-of {self._path} is no movie: end it in .mp4, .webm, .webp or .gif")
        if elsewhere:
            raise InputError("--making-of looks on while a whole cube is solved here: leave out --unit and --scheduler")
        self._output.check()

    def check_job(self, job: Job) -> None:
        """Raise `InputError` where the cube is solved in parts."""
        if self._path and job.units > 1:
            raise InputError(
                f"--making-of looks on while a whole cube is solved, and this one is solved in {job.units} units: "
                "allow more --memory, or leave it out"
            )

    def begin(self, job: Job) -> None:
        """Look on from now."""
        if self._path:
            size, fps = frames_of(self._path, self._shape)
            self.making = MakingOf(job.targets, job.grid, size or ROOM, fps)

    def write(self, cube: Cube, *, as_json: bool) -> list[str]:
        """Write it, and return what is to be said of it."""
        if self.making is None:
            return []
        film = self.making.film(cube)
        with progress("making of", as_json=as_json) as advance:
            self._output.write(
                counting(film, len(film), advance),
                count=len(film),
                transfer=film.transfer,
                fps=film.fps,
                shared=True,
            )
        return [f"{counted(len(film), 'picture')} in {self._path}: {film.said}"]
