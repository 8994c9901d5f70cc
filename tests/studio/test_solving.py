"""A cube is solved in a process of its own: paused, kept, gone on with, also when everything was killed."""

import gzip
import json
import os
import signal
import time
from base64 import b64decode
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

pytest.importorskip("fastapi", reason="the studio's extra is not installed")
pytest.importorskip("httpx2", reason="httpx2 is not installed")

import httpx2
from fastapi.testclient import TestClient
from typer.testing import CliRunner

from lightcube import io
from lightcube.cli import main
from lightcube.errors import InputError
from lightcube.studio.forecast import Forecast
from lightcube.studio.serving import serve
from lightcube.studio.solving import Solving
from tests.helpers.studios import entered, opened, started

pytestmark = pytest.mark.skipif(
    os.environ.get("NUMBA_DISABLE_JIT", "0") != "0",
    reason="a process is the same without a compiler",
)
#: Small enough to be solved in a second; and so many passes that one can interfere.
SMALL = {"voxels": 16, "quality": "draft", "hold_deg": 0.0}
LONG = {"voxels": 32, "quality": "best", "width": 0.9, "hold_deg": 0.0}
PATIENCE_S = 300.0


def until(asked: Callable[[], Any]) -> Any:
    """What is asked, as soon as it is so."""
    began = time.monotonic()
    while time.monotonic() - began < PATIENCE_S:
        if found := asked():
            return found
        time.sleep(0.05)
    raise AssertionError("it never came to that")


def status(client: httpx2.Client) -> str:
    return str(client.get("/api/solving").json()["status"])


def begun(client: httpx2.Client) -> bool:
    """Whether there is something to go on with."""
    partial = Path(client.get("/api/state").json()["folder"]) / "made" / "cube.zarr.partial"
    return partial.is_dir() and any(each.name.startswith("unit") for each in partial.iterdir())


@pytest.fixture
def client(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[TestClient]:
    monkeypatch.setattr(Forecast, "begin", lambda _: None)
    monkeypatch.setattr(Forecast, "ask", lambda _: None)
    with opened(tmp_path / "project") as made:
        made.post("/api/samples/letters")
        yield made


def test_a_cube_is_made_that_is_the_commands_cube_and_can_be_turned(client: TestClient) -> None:
    client.patch("/api/settings", json={"making": SMALL})
    assert client.get("/api/cube").status_code == 204
    assert client.post("/api/solving/start").json()["status"] == "running"
    assert client.post("/api/solving/start").status_code == 400
    until(lambda: status(client) == "done")
    state = client.get("/api/solving").json()
    assert [each["name"] for each in state["pictures"]] == list("LINEA")
    assert all(each["psnr"] > 10 for each in state["pictures"])
    assert len(state["wall"]["pictures"]) == 5
    viewed = client.get("/api/cube").json()
    assert json.loads(gzip.decompress(b64decode(viewed["scene"])))["title"] == "Light cube"
    assert b64decode(viewed["voxels"])[:2] == b"\x1f\x8b"
    made = io.read_cube(Path(client.get("/api/state").json()["folder"]) / "made" / "cube.zarr")
    words = state["command"].split()
    other = Path(client.get("/api/state").json()["folder"]).parent / "other.npz"
    words[words.index("-o") + 1] = str(other)
    assert CliRunner().invoke(main.application(["solve"]), words[1:]).exit_code == 0
    np.testing.assert_array_equal(io.read_cube(other).extinction, made.extinction)
    client.patch("/api/settings", json={"making": {"width": 0.7}})
    assert client.get("/api/solving").json()["changed"]


@pytest.mark.skipif(os.name != "posix", reason="processes are killed by signals")
def test_paused_or_killed_it_goes_on_and_stopped_it_is_kept(client: TestClient) -> None:
    client.patch("/api/settings", json={"making": LONG})
    client.post("/api/solving/start")
    until(lambda: begun(client))
    client.post("/api/solving/pause")
    until(lambda: status(client) == "paused")
    assert client.post("/api/solving/pause").status_code == 400
    client.patch("/api/settings", json={"making": SMALL})  # what goes on is what was begun
    assert client.post("/api/solving/resume").json()["status"] == "running"
    until(lambda: client.get("/api/solving").json()["done"])
    app: Any = client.app
    owner = next(each.__self__ for each in app.state.desk.closing if hasattr(each.__self__, "curve"))
    os.kill(owner._worker.process.pid, signal.SIGKILL)
    until(lambda: status(client) == "paused")
    assert "nothing is lost" in client.get("/api/solving").json()["sentence"]
    client.post("/api/solving/keep")
    until(lambda: status(client) == "kept")
    cube = io.read_cube(Path(client.get("/api/state").json()["folder"]) / "made" / "cube.zarr")
    assert (cube.status, max(cube.grid.shape)) == ("interrupted", LONG["voxels"])
    assert client.post("/api/solving/discard").status_code == 400  # what was kept is not thrown away


class Quick:
    """A process that does nothing by itself: a test says what it tells, and when it ends."""

    every: ClassVar[list["Quick"]] = []

    def __init__(self, lock: Any, run: Any, given: Any, heard: Any, ended: Any) -> None:
        self.deed, self.heard, self.ended, self.told = given[1], heard, ended, list[str]()
        Quick.every.append(self)

    def stop(self) -> None:
        self.told.append("stop")

    def close(self, _: float = 0.0) -> None:
        self.told.append("close")


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> list[Quick]:
    """All that is begun, without a process."""
    monkeypatch.setattr("lightcube.studio.solving.Worker", Quick)
    monkeypatch.setattr(Solving, "_is_begun", lambda self: self._kind.can_pause)
    monkeypatch.setattr(Quick, "every", [])
    return Quick.every


def become(client: TestClient, kind: str) -> Any:
    return client.patch("/api/settings", json={"kind": kind}).json()


def test_one_thing_is_made_at_a_time_and_the_other_goes_on_when_it_is_chosen_again(
    client: TestClient, quick: list[Quick]
) -> None:
    client.post("/api/solving/start")
    assert become(client, "films")["resting"] == ["cube"]
    assert quick[0].told == ["stop"]
    quick[0].ended("stopped")
    client.post("/api/solving/start")
    assert [each.deed for each in quick] == ["start", "start"]
    state = client.post("/api/undo").json()  # undone is also that it rests
    assert (state["settings"]["kind"], state["solving"]["status"], state["resting"]) == ("cube", "running", ["films"])
    assert [each.deed for each in quick] == ["start", "start", "resume"]
    client.post("/api/solving/pause")
    become(client, "films")
    quick[2].ended("stopped")
    quick[1].ended("stopped")
    assert quick[-1].deed == "resume"  # the films go on
    assert become(client, "cube")["solving"]["status"] == "paused"  # and what was paused stays so


def test_what_is_chosen_again_before_it_has_come_to_rest_goes_on(client: TestClient, quick: list[Quick]) -> None:
    client.post("/api/solving/start")
    become(client, "films")
    assert become(client, "cube")["solving"]["status"] == "resting"
    assert len(quick) == 1
    quick[0].ended("stopped")
    assert (status(client), quick[1].deed) == ("running", "resume")
    become(client, "films")
    quick[1].heard("done", {"pictures": [], "psnr": 40.0})  # it was quicker than to rest
    quick[1].ended("done")
    assert become(client, "cube")["solving"]["status"] == "done"
    assert len(quick) == 2


def test_what_rests_rests_when_the_studio_is_started_again(client: TestClient, quick: list[Quick]) -> None:
    client.post("/api/solving/start")
    folder = Path(become(client, "plate")["folder"])
    app: Any = client.app
    app.state.desk.close()
    with opened(folder) as again:
        assert again.get("/api/state").json()["resting"] == ["cube"]
        assert len(quick) == 1
        assert become(again, "cube")["solving"]["status"] == "running"
        assert quick[1].deed == "resume"


def test_what_cannot_pause_begins_anew_and_is_then_as_it_was(client: TestClient, quick: list[Quick]) -> None:
    become(client, "plate")
    client.post("/api/solving/start")
    quick[0].heard("done", {"pictures": [], "psnr": None, "said": ["the first"]})
    quick[0].ended("done")
    client.post("/api/solving/start")
    become(client, "cube")
    quick[1].ended("stopped")
    assert become(client, "plate")["solving"]["status"] == "running"
    assert quick[2].deed == "start"
    client.post("/api/solving/stop")
    quick[2].ended("stopped")
    state = client.get("/api/solving").json()
    assert (state["status"], state["said"]) == ("done", ["the first"])


def test_what_is_thrown_away_leaves_what_was_there_before(client: TestClient, quick: list[Quick]) -> None:
    client.post("/api/solving/start")
    quick[0].heard("done", {"pictures": [], "psnr": 40.0})
    quick[0].ended("done")
    client.post("/api/solving/start")
    client.post("/api/solving/pause")
    quick[1].ended("stopped")
    state = client.post("/api/solving/discard").json()
    assert (state["status"], state["psnr"]) == ("done", 40.0)


def test_a_process_that_cannot_be_started_is_told_of(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: Any) -> None:
        raise InputError("the system starts no process")

    monkeypatch.setattr("lightcube.studio.solving.Worker", full)
    state = client.post("/api/solving/start").json()
    assert (state["status"], state["sentence"]) == ("failed", "the system starts no process")
    assert "start" in state["can"]


def test_a_plate_is_stopped_and_what_was_there_stays(client: TestClient) -> None:
    client.patch("/api/settings", json={"kind": "plate", "plate": {"columns": 32, "quality": "draft"}})
    assert client.post("/api/solving/start").json()["status"] == "running"
    until(lambda: status(client) == "done")
    made = client.get("/api/solving").json()
    assert (len(made["pictures"]), made["psnr"]) == (4, None)
    assert any("lamp on the right" in each for each in made["said"])
    assert client.get("/api/taking").json()["has_cube"]
    client.patch("/api/settings", json={"plate": {"columns": 256, "quality": "best"}})
    assert client.post("/api/solving/start").json()["can"] == ["stop"]
    until(lambda: client.get("/api/solving").json()["done"])
    assert client.post("/api/solving/pause").status_code == 400
    client.post("/api/solving/stop")
    until(lambda: status(client) == "done")
    assert client.get("/api/solving").json()["changed"]
    plate = io.read_relief(Path(client.get("/api/state").json()["folder"]) / "made" / "plate.relief.zarr")
    assert plate.heights_px.shape == (32, 32)
    client.patch("/api/settings", json={"kind": "cube"})
    assert status(client) == "idle"
    assert not client.get("/api/taking").json()["has_cube"]


@pytest.mark.skipif(os.name != "posix", reason="processes are killed by signals")
def test_a_studio_that_is_killed_goes_on_where_it_was(tmp_path: Path) -> None:
    with started(tmp_path / "project") as (process, address), entered(address) as client:
        client.post("/api/samples/letters")
        client.patch("/api/settings", json={"making": LONG})
        client.post("/api/solving/start")
        until(lambda: begun(client))
        process.kill()
    with started(tmp_path / "project") as (process, address), entered(address) as client:
        state = client.get("/api/state").json()
        assert [each["name"] for each in state["settings"]["pictures"]] == list("LINEA")
        assert state["solving"]["status"] == "running"
        until(lambda: client.get("/api/solving").json()["done"])
        process.kill()


def test_a_port_that_is_taken_and_a_folder_that_is_open_are_sentences(client: TestClient, tmp_path: Path) -> None:
    import socket

    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(InputError, match=f"port {port} cannot be had .*: name another one with --port"):
            serve(tmp_path / "another", port, lambda _: None)
    assert not (tmp_path / "another").exists()
    with pytest.raises(InputError, match="open in another studio already"):
        serve(tmp_path / "project", 0, lambda _: None)


@pytest.mark.parametrize("deed", ["pause", "resume", "keep", "discard"])
def test_what_cannot_be_done_now_is_a_sentence(client: TestClient, deed: str) -> None:
    answer = client.post(f"/api/solving/{deed}")
    assert answer.status_code == 400
    assert "the cube is not begun" in answer.json()["sentence"]


def test_one_picture_is_no_cube(client: TestClient) -> None:
    client.put("/api/pictures", json={"keys": []})
    assert "at least 2 pictures, and there is none" in client.post("/api/solving/start").json()["sentence"]
