"""Serving the studio on this machine."""

from __future__ import annotations

import socket
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import uvicorn

from lightcube.errors import InputError
from lightcube.studio.app import make_app
from lightcube.studio.guard import new_token
from lightcube.studio.project import Project

#: Where the studio listens: on this machine only.
_HOST = "127.0.0.1"


class _Server(uvicorn.Server):
    """A server that says when it can be asked, and lets followers of events go before it waits for them."""

    ready: Callable[[], None]
    ending: Callable[[], None]

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        self.ready()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        self.ending()
        await super().shutdown(sockets)


def serve(folder: Path, port: int, ready: Callable[[str], None]) -> None:
    """Serve the project of a folder until Ctrl-C; `ready` is told the address when it can be opened.

    Raises
    ------
    InputError
        Where the folder or the port cannot be had.
    """
    with _listening(port) as listening:
        project, token = Project(folder), new_token()
        app = make_app(project, token)
        config = uvicorn.Config(app, log_level="error", lifespan="on", timeout_graceful_shutdown=2, access_log=False)
        server = _Server(config)
        server.ready = lambda: ready(f"http://{_HOST}:{listening.getsockname()[1]}/?token={token}")
        server.ending = app.state.desk.hub.close
        try:
            with suppress(KeyboardInterrupt):  # how a studio is ended
                server.run(sockets=[listening])
        finally:
            project.close()


def _listening(port: int) -> socket.socket:
    """A socket on a port of this machine; `InputError` where somebody has it."""
    # said by name: asyncio lets answers go at once (no Nagle) only where a socket says that it is of TCP
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((_HOST, port))
    except OSError as error:
        listening.close()
        raise InputError(
            f"port {port} cannot be had ({error.strerror or error}): name another one with --port, or leave it out"
        ) from error
    return listening
