"""A cube is solved in a process of its own: paused, kept, gone on with, also when everything was killed."""

import os
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

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
from lightcube.studio.guard import HEADER
from lightcube.studio.serving import serve
from tests.helpers.studios import opened, started

pytestmark = pytest.mark.skipif(
    os.environ.get("NUMBA_DISABLE_JIT", "0") != "0",
    reason="a process is the same without a compiler",
)
#: Small enough to be solved in a second; and so many passes that one can interfere.
SMALL = {"voxels": 16, "quality": "draft", "hold_deg": 0.0}
LONG = {"voxels": 32, "quality": "best", "width": 0.9, "hold_deg": 0.0}
PATIENCE_S = 90.0


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
    assert client.get("/api/cube/scene").status_code == 204
    assert client.post("/api/solving/start").json()["status"] == "running"
    assert client.post("/api/solving/start").status_code == 400
    until(lambda: status(client) == "done")
    state = client.get("/api/solving").json()
    assert [each["name"] for each in state["pictures"]] == list("LINEA")
    assert all(each["psnr"] > 10 for each in state["pictures"])
    assert len(state["wall"]["pictures"]) == 5
    assert client.get("/api/cube/scene").content[:2] == b"\x1f\x8b"
    assert client.get("/api/cube/voxels").content[:2] == b"\x1f\x8b"
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
    assert client.post("/api/solving/discard").json()["status"] == "idle"
    assert not begun(client)


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


def entered(address: str) -> httpx2.Client:
    """Who asks a studio that runs."""
    root, _, token = address.partition("/?token=")
    return httpx2.Client(base_url=root, headers={HEADER: token})


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
