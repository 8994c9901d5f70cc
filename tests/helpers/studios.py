"""The studio's application, asked without a network, and a studio that runs as people start it."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx2
from fastapi.testclient import TestClient

from lightcube.studio.app import make_app
from lightcube.studio.guard import HEADER
from lightcube.studio.project import Project

TOKEN = "a-token-for-tests"  # noqa: S105 - nothing is kept behind it


def opened(folder: Path) -> TestClient:
    """A client of the studio of a folder, who has the token."""
    app = make_app(Project(folder), TOKEN)
    return TestClient(app, base_url="http://127.0.0.1", headers={HEADER: TOKEN})


@contextmanager
def started(folder: Path, *more: str) -> Iterator[tuple["subprocess.Popen[str]", str]]:
    """The process of a studio, and its address; it is ended as by Ctrl-C in the end."""
    command = [sys.executable, "-m", "lightcube", "studio", str(folder), "--no-browser", *more]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        assert process.stdout is not None
        yield process, process.stdout.readline().strip()
        process.terminate()


def entered(address: str) -> httpx2.Client:
    """Who asks a studio that runs."""
    root, _, token = address.partition("/?token=")
    return httpx2.Client(base_url=root, headers={HEADER: token})


def is_bad(said: Any) -> bool:
    """Whether a page complains of itself; that the studio refused something is said in the page."""
    return said.type == "error" and "status of 400" not in said.text
