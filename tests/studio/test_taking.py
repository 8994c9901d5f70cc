"""Take away: what is made of a cube is whole, says what it is worth, and is told of; what cannot be is a sentence."""

import time
from typing import Any

import pytest

pytest.importorskip("fastapi", reason="the studio's extra is not installed")
from fastapi.testclient import TestClient

import lightcube as lc
from lightcube.studio import away, taking
from lightcube.studio.desk import Desk
from lightcube.studio.project import MADE
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


def test_without_a_cube_nothing_is_made(client: TestClient) -> None:
    assert client.get("/api/taking").json()["has_cube"] is False
    refused = client.post("/api/taking/page", json={})
    assert (refused.status_code, refused.json()["sentence"]) == (400, "there is none of the cube yet: make it first")


@pytest.mark.parametrize("name", ["page", "sheet", "cube", "shell", "points", "volume", "schedule"])
def test_what_is_made_says_what_it_is_worth_and_is_saved(client: TestClient, desk: Desk, name: str) -> None:
    with_cube(desk)
    desk.project.change(lambda before: before.model_copy(update={"title": '../Zoë & "we"'}))
    assert client.post(f"/api/taking/{name}", json={"by": "me"}).status_code == 200
    thing = finished(client, name)
    assert thing["failed"] == ""
    assert thing["made"]["said"]
    saved = client.get(f"/api/taking/{name}/file")
    assert len(saved.content) == thing["made"]["bytes"] > 0
    assert thing["made"]["file"] == f"Zoë-we-{name}.{away.things('cubes')[name].suffix}"
    assert {path.name for path in desk.project.folder.iterdir() if not path.name.startswith(".")} <= {
        *("dropped", "pictures", "made", "project.toml", "history.json")
    }


def test_what_was_made_is_known_when_the_studio_is_started_again_and_when_it_is_old(desk: Desk) -> None:
    with_cube(desk)
    first = taking.Taking(desk)
    first.begin("cube", taking._Asked(by="", note=""))
    assert first._thread is not None
    first._thread.join(60)
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
    assert not list(desk.project.path(MADE, "away").rglob("*.*"))


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
