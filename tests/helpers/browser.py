"""A real browser for tests, Chromium driven by Playwright; tests that need it skip where it is missing."""

import json
import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from lightcube.viewer.modules import joined

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")


def chromium() -> str | None:
    """Path of a Chromium: ``LIGHTCUBE_CHROMIUM``, or one of its usual names."""
    return os.environ.get("LIGHTCUBE_CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)


@pytest.fixture(scope="session")
def launch() -> Iterator[Callable[..., Any]]:
    """A function that starts a browser with more arguments; skips with a reason where there is none."""
    if os.environ.get("NUMBA_DISABLE_JIT", "0") != "0":
        pytest.skip("a page is the same whether kernels are compiled or not")
    api = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")
    executable = chromium()
    if executable is None:
        pytest.skip("there is no Chromium: install one, or name it in LIGHTCUBE_CHROMIUM")
    with api.sync_playwright() as playwright:  # there can be one only
        yield lambda *more: playwright.chromium.launch(executable_path=executable, args=["--no-sandbox", *more])


@pytest.fixture(scope="session")
def browser(launch: Callable[..., Any]) -> Iterator[Any]:
    """A browser with WebGL2, of the machine or computed by SwiftShader."""
    with launch("--enable-unsafe-swiftshader") as started:
        yield started


@pytest.fixture(scope="session")
def bare_browser(launch: Callable[..., Any]) -> Iterator[Any]:
    """A browser without WebGL."""
    with launch("--disable-gpu", "--disable-software-rasterizer", "--disable-3d-apis") as started:
        yield started


@pytest.fixture(scope="session")
def blank(browser: Any) -> Iterator[Any]:
    """A page that is emptied for each test: opening one takes longer than most of them."""
    with browser.new_page() as page:
        yield page


@pytest.fixture
def evaluate(blank: Any) -> Callable[..., Any]:
    """A function that runs an expression over what some of the page's modules export, in an empty page."""
    blank.goto("about:blank")

    def run(modules: tuple[str, ...], expression: str, argument: Any = None) -> Any:
        body = f"async (argument) => {{\n{joined(*modules)}\nreturn await ({expression});\n}}"
        return blank.evaluate(body, json.loads(json.dumps(argument)))

    return run


def opened(browser: Any, path: Path, *, width: int = 1280, height: int = 800, **context: Any) -> tuple[Any, list[str]]:
    """A page opened from a file, and a list that fills with what it says in its console or asks of a network."""
    context.setdefault("device_scale_factor", 0.25)  # fewer pixels: rooms may be drawn in software
    tab = browser.new_context(viewport={"width": width, "height": height}, **context).new_page()
    heard: list[str] = []
    tab.on("console", lambda said: heard.append(said.text) if said.type == "error" else None)
    tab.on("pageerror", lambda error: heard.append(str(error)))
    tab.on(
        "request",
        lambda asked: heard.append(asked.url) if not asked.url.startswith(("file:", "data:", "blob:")) else None,
    )
    tab.goto(path.as_uri())
    return tab, heard
