"""What tests of the studio's parts share: an open project, and what asks of one part alone."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest


@pytest.fixture
def desk(tmp_path: Path) -> Iterator[Any]:
    from lightcube.studio.desk import Desk
    from lightcube.studio.project import Project

    opened = Desk(Project(tmp_path))
    yield opened
    opened.close()


@pytest.fixture
def client(desk: Any, request: pytest.FixtureRequest) -> Any:
    """Asks the part that the test's module is about: its `PART`, without guard."""
    from fastapi import FastAPI
    from fastapi.testclient import TestClient

    from lightcube.studio.app import speak

    app = FastAPI()
    app.include_router(request.module.PART.router(desk))
    speak(app)
    return TestClient(app)
