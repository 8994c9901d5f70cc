"""What all tests share."""

import atexit
import os
import shutil
import signal
import tempfile
from collections.abc import Iterator

import pytest
from hypothesis import settings

from lightcube.backward.recipe import QUALITIES
from lightcube.io import _3mf
from lightcube.optics import light
from lightcube.planning import prediction
from lightcube.report import measuring
from lightcube.verbs import drawing
from tests.helpers.browser import bare_browser, blank, browser, evaluate, launch

__all__ = ["bare_browser", "blank", "browser", "evaluate", "launch"]

# No test is about how long it takes on a machine that does other things too.
settings.register_profile("patient", deadline=None)
settings.load_profile("patient")

# What commands remember for each other is theirs: each worker of the suite begins without.
os.environ["XDG_CACHE_HOME"] = tempfile.mkdtemp(prefix="lightcube-suite-")
atexit.register(shutil.rmtree, os.environ["XDG_CACHE_HOME"], ignore_errors=True)

# Most of the time of a small cube's report goes into its picture of the room. Here: it may be made for a whole module.
ROOMS = {module: module.ROOM for module in (measuring, drawing)}
measuring.ROOM = drawing.ROOM = (27, 48)

INTERPRETED = os.environ.get("NUMBA_DISABLE_JIT", "0") != "0"
if INTERPRETED:
    _3mf._SIDE = 16  # each file of a mesh has a picture of it


# Whoever starts the suite in the background may have it ignore Ctrl-C, and programs inherit that; tests press it.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def large_rooms(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures of rooms are as large as people get them."""
    for module, size in ROOMS.items():
        monkeypatch.setattr(module, "ROOM", size)


def forget_points() -> None:
    """Points of pixels are chosen unlike the judge's: with another judge they are others."""
    light.lattice.cache_clear()
    light.soft_lattice.cache_clear()


@pytest.fixture(autouse=True)
def brief_where_interpreted(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Interpreted kernels take few points, short rehearsals and drafts; compiled ones have it all."""
    room, _, file = request.module.__name__.removeprefix("tests.").rpartition(".")
    few = room not in ("optics", "forward", "viewer") and file not in ("test_docstrings", "test_older")
    if INTERPRETED and few:
        forget_points()
        for name, count in (("JUDGE", 5), ("JUDGE_STEP", 3), ("JUDGE_ROW", 3), ("JUDGE_DISC", 2)):
            monkeypatch.setattr(light, name, count)
        monkeypatch.setattr(light.Light.__init__, "__defaults__", (3, 2, 0.0))
        for quality, effort in QUALITIES.items():
            monkeypatch.setitem(QUALITIES, quality, effort._replace(light=light.Light()))
        monkeypatch.setattr(prediction, "POINTS", light.Light())
    if INTERPRETED:
        monkeypatch.setattr(prediction, "AREA", prediction.AREA._replace(passes=2, work=20_000))
        monkeypatch.setattr(prediction, "_LEAST", 6)
    if INTERPRETED and (room in ("cli", "jobs", "report") or file == "test_docs"):
        monkeypatch.setattr("lightcube.planning.order._PASSES", 1)
        monkeypatch.setattr("lightcube.planning.order._WALKS", 1)
        monkeypatch.setattr("lightcube.planning.order._SWAPS", 1)
        monkeypatch.setattr("lightcube.planning.plan.WIDTHS", (0.5, 1.0))
    yield
    if INTERPRETED and few:
        forget_points()
