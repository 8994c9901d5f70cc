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
    from fastapi import FastAPI, Request
    from fastapi.responses import JSONResponse
    from fastapi.testclient import TestClient

    from lightcube.errors import InputError

    app = FastAPI()
    app.include_router(request.module.PART.router(desk))

    @app.exception_handler(InputError)
    async def refused(_: Request, error: Exception) -> JSONResponse:
        return JSONResponse({"sentence": f"{error}"}, status_code=400)

    return TestClient(app)
