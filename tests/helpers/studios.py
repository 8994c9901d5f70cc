"""The studio's application, asked without a network."""

from pathlib import Path

from fastapi.testclient import TestClient

from lightcube.studio.app import make_app
from lightcube.studio.guard import HEADER
from lightcube.studio.project import Project

TOKEN = "a-token-for-tests"  # noqa: S105 - nothing is kept behind it


def opened(folder: Path) -> TestClient:
    """A client of the studio of a folder, who has the token."""
    app = make_app(Project(folder), TOKEN)
    return TestClient(app, base_url="http://127.0.0.1", headers={HEADER: TOKEN})
