"""A second engine for tests: Firefox, spoken to in its own protocol, which needs no driver beside it."""

import json
import os
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import pytest

NAMES = ("firefox", "firefox-esr")
#: Seconds that it has to open.
PATIENCE_S = 120.0


class Firefox:
    """A Firefox that is open."""

    def __init__(self, port: int) -> None:
        self._line = socket.create_connection(("127.0.0.1", port), PATIENCE_S)
        self._heard = self._line.makefile("rb")
        self._count = 0
        self._message()  # it says who it is
        self._call("WebDriver:NewSession")

    def close(self) -> None:
        """Hang up."""
        self._heard.close()
        self._line.close()

    def open(self, path: Path) -> None:
        """Load a file, to its end."""
        self._call("WebDriver:Navigate", url=path.as_uri())

    def evaluate(self, expression: str) -> Any:
        """What an expression is in the page."""
        return self._call("WebDriver:ExecuteScript", script=f"return {expression};", args=[])["value"]

    def until(self, expression: str) -> None:
        """Wait until an expression is true in the page."""
        last = time.monotonic() + PATIENCE_S
        while not self.evaluate(expression):
            assert time.monotonic() < last, expression
            time.sleep(0.1)

    def _call(self, name: str, **given: Any) -> Any:
        self._count += 1
        said = json.dumps([0, self._count, name, given]).encode()
        self._line.sendall(b"%d:%s" % (len(said), said))
        _, _, error, found = self._message()
        assert error is None, error
        return found

    def _message(self) -> Any:
        length = b""
        while (letter := self._heard.read(1)) != b":":
            length += letter
        return json.loads(self._heard.read(int(length)))


@contextmanager
def firefox(folder: Path) -> Iterator[Firefox]:
    """Yield a Firefox with a profile in a folder; skips with a reason where there is none."""
    program = os.environ.get("LIGHTCUBE_FIREFOX") or next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        pytest.skip("there is no Firefox: install one, or name it in LIGHTCUBE_FIREFOX")
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    coarse = 'user_pref("layout.css.devPixelsPerPx", "0.25");\n'  # rooms may be drawn in software
    (folder / "user.js").write_text(f'user_pref("marionette.port", {port});\n{coarse}')
    command = [program, "--headless", "--no-remote", "--marionette", "--profile", str(folder)]
    small = {**os.environ, "MOZ_HEADLESS_WIDTH": "320", "MOZ_HEADLESS_HEIGHT": "200"}
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=small) as running:
        try:
            with closing(opened(port)) as found:
                yield found
        finally:
            running.terminate()


def opened(port: int) -> Firefox:
    """Firefox, as soon as it listens."""
    last = time.monotonic() + PATIENCE_S
    while True:
        try:
            return Firefox(port)
        except ConnectionError:
            if time.monotonic() > last:
                raise
            time.sleep(0.1)
