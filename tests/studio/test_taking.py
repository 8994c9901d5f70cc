"""Take away: what is made of a cube is whole, says what it is worth, and is told of; what cannot be is a sentence."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import pytest

pytest.importorskip("fastapi", reason="the studio's extra is not installed")
from fastapi.testclient import TestClient

import lightcube as lc
from lightcube.events import Progress, Said
from lightcube.fabrication.resins import ConvertedCube
from lightcube.studio import taking
from lightcube.studio.away_cubes import OF_CUBES
from lightcube.studio.desk import Desk
from lightcube.studio.offered import THINGS, Order
from lightcube.studio.project import MADE
from lightcube.viewer.label import Label
from tests.helpers.made import a_cube

#: What the `client` asks.
PART = taking
CUBE = "cube.zarr"


def with_cube(desk: Desk) -> None:
    lc.save(a_cube((8, 8, 8)), desk.project.path(MADE, CUBE))


def finished(client: TestClient, name: str) -> dict[str, Any]:
    until = time.monotonic() + 60
    while time.monotonic() < until:
        state = client.get("/api/taking").json()
        if state["doing"] is None:
            return next(thing for thing in state["things"] if thing["name"] == name)
        time.sleep(0.02)
    raise AssertionError(f"{name} does not end")


def test_how_it_stands_is_told_without_what_makes_files(tmp_path: Path) -> None:
    """That takes a third of a second to load, and the page's first paint waits for how all stands."""
    asked = (
        "import sys; from pathlib import Path; from tests.helpers.studios import opened; "
        "assert opened(Path(sys.argv[1])).get('/api/state').json()['taking']['things']; "
        "print([each for each in sys.modules if each in ('lightcube.studio.away', 'lightcube.drawing.films')])"
    )
    done = subprocess.run(
        [sys.executable, "-c", asked, str(tmp_path / "p")], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"


def test_without_a_cube_nothing_is_made(client: TestClient) -> None:
    assert client.get("/api/taking").json()["has_cube"] is False
    refused = client.post("/api/taking/page", json={})
    assert (refused.status_code, refused.json()["sentence"]) == (400, "the cube is not made yet: make it first")


@pytest.mark.parametrize("name", ["page", "sheet", "shell", "points", "volume", "schedule"])
def test_what_is_made_says_what_it_is_worth(tmp_path: Path, name: str) -> None:
    source, target = tmp_path / "cube.npz", tmp_path / f"thing.{THINGS['cubes'][name].suffix}"
    lc.save(a_cube((8, 8, 8)), source)
    said = OF_CUBES[name](Order(lc.load(source), source, target, Label("Sea"), False, lambda _: False))
    assert all(said)
    assert target.stat().st_size > 0


def test_slices_are_packed_whole_and_tell_of_every_step(tmp_path: Path) -> None:
    heard: list[Progress | Said] = []
    cube, target = a_cube((4, 5, 6)), tmp_path / "sea.zip"
    with pytest.warns(ConvertedCube):
        OF_CUBES["slices"](Order(cube, tmp_path, target, Label("Sea"), False, heard.append))
    with ZipFile(target) as packed:
        slices = [name for name in packed.namelist() if name.endswith(".png")]
    steps = [event.done / event.of for event in heard if isinstance(event, Progress)]
    assert steps[: len(slices)] == [(number + 1) / len(slices) for number in range(len(slices))]
    assert [event.sentence for event in heard if isinstance(event, Said)] == ["looking at what it casts", "packing"]
    assert {path.name for path in tmp_path.iterdir()} == {"sea.zip"}


def test_it_is_made_in_a_process_told_of_and_saved_under_its_title(client: TestClient, desk: Desk) -> None:
    with_cube(desk)
    told: list[Any] = []
    desk.hub.tell = lambda name, facts: told.append(facts)  # type: ignore[method-assign]
    desk.project.change(lambda before: before.model_copy(update={"title": '../Zoë & "we"'}))
    assert client.post("/api/taking/schedule", json={"by": "me"}).status_code == 200
    thing = finished(client, "schedule")
    assert thing["failed"] == ""
    assert thing["made"]["said"]
    saved = client.get("/api/taking/schedule/file")
    assert len(saved.content) == thing["made"]["bytes"] > 0
    assert thing["made"]["file"] == "Zoë-we-schedule.csv"
    assert [path.name for path in desk.project.path(MADE, "away").iterdir()] == ["cube"]
    left = {path.name for path in desk.project.path(MADE, "away", "cube").iterdir()}
    assert left == {"Zoë-we-schedule.csv", "Zoë-we-schedule.csv.json"}
    assert "getting ready" in [facts["doing"]["sentence"] for facts in told if facts["doing"]]
    assert {path.name for path in desk.project.folder.iterdir() if not path.name.startswith(".")} <= {
        *("dropped", "pictures", "made", "project.toml", "history.json")
    }


def test_what_is_made_of_another_kind_of_thing_goes_on_without_a_name(client: TestClient, desk: Desk) -> None:
    with_cube(desk)
    client.post("/api/taking/page", json={})
    desk.project.change(lambda before: before.model_copy(update={"kind": "films"}))
    told: list[Any] = []
    desk.hub.tell = lambda name, facts: told.append(facts["doing"])  # type: ignore[method-assign]
    assert finished(client, "page")["made"] is None  # of films there is a page, too
    assert {doing["name"] for doing in told if doing} == {""}
    desk.project.change(lambda before: before.model_copy(update={"kind": "cube"}))
    assert finished(client, "page")["made"]["said"]


@pytest.mark.skipif(os.name != "posix", reason="processes are killed by signals")
def test_a_process_that_is_killed_is_told_of_and_leaves_nothing(client: TestClient, desk: Desk) -> None:
    with_cube(desk)
    client.post("/api/taking/page", json={})
    os.kill(desk.closing[0].__self__._worker.process.pid, signal.SIGKILL)  # type: ignore[attr-defined]
    assert "ended from outside" in finished(client, "page")["failed"]
    assert not list(desk.project.path(MADE, "away").iterdir())


def test_what_was_made_is_known_when_the_studio_is_started_again_and_when_it_is_old(
    client: TestClient, desk: Desk
) -> None:
    with_cube(desk)
    client.post("/api/taking/cube", json={})
    finished(client, "cube")
    again = taking.Taking(desk)
    (thing,) = (each for each in again.state()["things"] if each["name"] == "cube")
    assert thing["made"]["is_old"] is False
    lc.save(a_cube((8, 8, 8), seed=3), desk.project.path(MADE, CUBE), overwrite=True)
    (thing,) = (each for each in again.state()["things"] if each["name"] == "cube")
    assert thing["made"]["is_old"] is True


def test_what_is_stopped_leaves_nothing(client: TestClient, desk: Desk) -> None:
    with_cube(desk)
    client.post("/api/taking/wide", json={})
    assert client.post("/api/taking/page", json={}).json()["sentence"].startswith("a wide movie is being made")
    client.post("/api/taking/stop")
    thing = finished(client, "wide")
    assert (thing["made"], thing["failed"]) == (None, "")
    assert not list(desk.project.path(MADE, "away").iterdir())


@pytest.mark.parametrize("name", ["nothing", "..", "page.html", "%2e%2e"])
def test_no_other_file_is_made_or_given(client: TestClient, desk: Desk, name: str) -> None:
    with_cube(desk)
    assert client.post(f"/api/taking/{name}", json={}).status_code in (400, 404, 405)
    assert client.get(f"/api/taking/{name}/file").status_code in (400, 404)


def test_what_fails_says_why(client: TestClient, desk: Desk) -> None:
    with_cube(desk)
    next(desk.project.path(MADE, CUBE).rglob("c/*/*/*/*")).write_bytes(b"no")
    client.post("/api/taking/sheet", json={})
    thing = finished(client, "sheet")
    assert thing["made"] is None
    assert thing["failed"]
