"""What all tests share."""

import os

import pytest

from tests.browser import bare_browser, browser, evaluate, launch

__all__ = ["bare_browser", "browser", "evaluate", "launch"]

INTERPRETED = os.environ.get("NUMBA_DISABLE_JIT", "0") != "0"


@pytest.fixture(autouse=True)
def short_rehearsals(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where kernels run interpreted, whole commands rehearse and draft briefly; the compiled run does all of it."""
    module = request.module.__name__.split(".")[-1]
    if INTERPRETED and module.startswith(("test_cli", "test_docs", "test_resume", "test_cluster", "test_report")):
        monkeypatch.setattr("lightcube.prediction.PASSES", 2)
        monkeypatch.setattr("lightcube.conditioning._PASSES", 1)
        monkeypatch.setattr("lightcube.conditioning._WALKS", 1)
        monkeypatch.setattr("lightcube.conditioning._SWAPS", 1)
        monkeypatch.setattr("lightcube.planning.WIDTHS", (0.5, 1.0))
