"""What the parts of the studio share: the project, the stream of events, and who minds when something changes."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from lightcube.errors import InputError
from lightcube.studio.project import Project, Settings
from lightcube.studio.stream import Hub


class Desk:
    """A project on the table.

    Attributes
    ----------
    project, hub
        The folder, and who is told.
    parts
        What each part has to say of how it stands, by its name: it stands beside the settings in `state`.
    minding
        Called after every change of the settings.
    first_cube
        A small cube as the viewer takes it, in JSON, which can be turned before there is another one.
    starting, closing
        Called when the studio begins to be served, and when it ends.
    trouble
        What could not be done when it began, in a sentence; the studio is open all the same.
    """

    def __init__(self, project: Project) -> None:
        self.project = project
        self.hub = Hub(self.state)
        self.parts: dict[str, Callable[[], Any]] = {}
        self.minding: list[Callable[[], None]] = []
        self.closing: list[Callable[[], None]] = []
        self.starting: list[Callable[[], None]] = []
        self.first_cube: Callable[[], bytes] = lambda: b""
        self.is_started, self.trouble = False, ""

    def state(self) -> dict[str, Any]:
        """How all stands, as plain JSON."""
        stands = self.project.described() | {name: part() for name, part in self.parts.items()}
        return stands | {"trouble": self.trouble}

    def change(self, change: Callable[[Settings], Settings], moving: str = "") -> dict[str, Any]:
        """Change the settings, keep them, and tell everybody; as `Project.change`."""
        self.project.change(change, moving)
        return self.changed()

    def start(self) -> None:
        """Begin what goes on by itself."""
        self.is_started = True
        self.trouble = "; ".join(f"{error}" for error in _each(self.starting))

    def changed(self) -> dict[str, Any]:
        """Tell everybody how the project stands now, and return it; then `InputError` where somebody could not mind."""
        try:
            self.mind()
        finally:
            state: dict[str, Any] = self.hub.tell_whole()
        return state

    def mind(self) -> None:
        """Have everybody mind how the project stands; then `InputError` where somebody could not."""
        troubles = _each(self.minding)
        if troubles:
            raise troubles[0]

    def close(self) -> None:
        """End what goes on, and let go of the folder."""
        self.hub.close()
        for close in self.closing:
            close()
        self.project.close()


def _each(deeds: Iterable[Callable[[], None]]) -> list[InputError]:
    """Do each of them, whatever becomes of the others; returns what could not be done."""
    troubles = []
    for do in deeds:
        try:
            do()
        except InputError as error:
            troubles.append(error)
    return troubles
