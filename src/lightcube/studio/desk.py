"""What the parts of the studio share: the project, the stream of events, and who minds when something changes."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

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
        Scene or voxels of a small cube, which can be turned before there is another one.
    starting, closing
        Called when the studio begins to be served, and when it ends.
    """

    def __init__(self, project: Project) -> None:
        self.project = project
        self.hub = Hub(self.state)
        self.parts: dict[str, Callable[[], Any]] = {}
        self.minding: list[Callable[[], None]] = []
        self.closing: list[Callable[[], None]] = []
        self.starting: list[Callable[[], None]] = []
        self.first_cube: Callable[[str], bytes | None] = lambda _: None
        self.is_started = False
        self._lock = threading.Lock()

    def state(self) -> dict[str, Any]:
        """How all stands, as plain JSON."""
        with self._lock:
            return self.project.described() | {name: part() for name, part in self.parts.items()}

    def change(self, change: Callable[[Settings], Settings], moving: str = "") -> dict[str, Any]:
        """Change the settings, keep them, and tell everybody; as `Project.change`."""
        self.project.change(change, moving)
        return self.changed()

    def start(self) -> None:
        """Begin what goes on by itself."""
        self.is_started = True
        for start in self.starting:
            start()

    def changed(self) -> dict[str, Any]:
        """Tell everybody how the project stands now, and return it."""
        for mind in self.minding:
            mind()
        state = self.state()
        self.hub.tell("state", state)
        return state

    def close(self) -> None:
        """End what goes on, and let go of the folder."""
        self.hub.close()
        for close in self.closing:
            close()
        self.project.close()
