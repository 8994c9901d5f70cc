"""The studio's command says its address and opens it, and waits for no browser."""

import threading
from collections.abc import Callable
from typing import Any

import pytest

pytest.importorskip("fastapi", reason="the studio's extra is not installed")
pytest.importorskip("uvicorn", reason="the studio's extra is not installed")

from tests.cli.test_cli import run

__all__ = ["run"]


@pytest.mark.parametrize("more", [(), ("--no-browser",)], ids=str)
def test_no_browser_holds_the_studio_up(
    more: tuple[str, ...], run: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    closed, opened = threading.Event(), threading.Event()

    def browse(_: str) -> None:
        opened.set()
        closed.wait(60)  # as some do until they are closed

    monkeypatch.setattr("webbrowser.open", browse)
    monkeypatch.setattr("lightcube.studio.serving.serve", lambda folder, port, ready: ready("http://here"))
    done = run("studio", "project", *more)
    assert opened.wait(0 if more else 60) == (not more)
    closed.set()
    assert done.code == 0
    assert "http://here" in done.out
    assert ("the studio opens in your browser" in done.err) == (not more)
