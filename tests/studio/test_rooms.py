"""The room's editor: what cannot be is said of the things that it is about, and what is kept is the same stage."""

from typing import Any

import numpy as np
import pytest
from PIL import Image

pytest.importorskip("fastapi", reason="the studio's extra is not installed")
from fastapi.testclient import TestClient

from lightcube import io
from lightcube.studio import rooms
from lightcube.studio.desk import Desk
from lightcube.studio.project import PICTURES, Picture

#: What the `client` asks.
PART = rooms


def a_room(**change: Any) -> dict[str, Any]:
    return {
        "stops_deg": [11.25, 33.75],
        "lamps": [
            {"name": "front", "x": -150, "y": 0, "z": 105},
            {"name": "bulb", "x": 0, "y": -150, "z": 105, "far": False},
        ],
        "screens": [
            {"name": "back wall", "x": 150, "y": 0, "z": -105, "lamp": "front"},
            {"name": "side wall", "x": 0, "y": 150, "z": -105, "lamp": "bulb", "side_mm": 60},
        ],
        **change,
    }


def test_a_room_that_can_be_has_nothing_impossible(client: TestClient) -> None:
    found = client.post("/api/rooms/check", json=a_room()).json()
    assert found == {"impossible": [], "doubtful": [], "pictures": 4}


def test_a_screen_out_of_the_shadow_is_named_with_its_lamp(client: TestClient) -> None:
    room = a_room()
    room["screens"][0]["z"] = 105
    (trouble,) = client.post("/api/rooms/check", json=room).json()["impossible"]
    assert trouble["about"] == ["front", "back wall"]
    assert "miss screen 'back wall' at stops 1 and 2" in trouble["sentence"]


def test_a_lamp_inside_the_cube_is_named(client: TestClient) -> None:
    room = a_room()
    room["lamps"][1] |= {"x": 5, "y": 5, "z": 5}
    (trouble,) = client.post("/api/rooms/check", json=room).json()["impossible"]
    assert (trouble["about"], trouble["sentence"][:36]) == (["bulb"], "lamp 'bulb' stands inside the cube a")


@pytest.mark.parametrize(
    "change",
    [
        {"lamps": []},
        {"stops_deg": []},
        {"stops_deg": [1e308]},
        {"lamps": [{"name": 'a"]', "x": 1, "y": 2, "z": 3}]},
        {"lamps": [{"name": "front", "x": 1, "y": 2, "z": "3e400"}]},
        {"more": 1},
    ],
)
def test_what_is_no_room_is_refused(client: TestClient, change: dict[str, Any]) -> None:
    assert client.post("/api/rooms/check", json=a_room(**change)).status_code == 422


@pytest.mark.parametrize(
    "change",
    [
        {"lamps": [{"name": "front", "x": 0, "y": 0, "z": 0}, {"name": "bulb", "x": 9, "y": 9, "z": 90}]},
        {"lamps": [{"name": "front", "x": 1, "y": 2, "z": 3}]},
        {"lamps": [{"name": "front", "x": 9, "y": 0, "z": 99}] * 2},
    ],
)
def test_what_cannot_stand_is_a_sentence(client: TestClient, change: dict[str, Any]) -> None:
    refused = client.post("/api/rooms/check", json=a_room(**change))
    assert refused.status_code in (400, 422)
    assert refused.json()["sentence"].startswith(
        ("lamp 'front' stands in", "screen 'side wall' is lit by 'bulb'", "two ")
    )


def test_a_room_that_is_kept_makes_the_project_a_cube_for_it_and_its_file_is_the_same_stage(
    client: TestClient, desk: Desk
) -> None:
    pictures = tuple(Picture(key=f"{number:016x}", name=f"n{number}") for number in range(5))
    desk.project.change(lambda before: before.model_copy(update={"pictures": pictures}))
    for number in range(5):
        levels = np.full((8, 8, 3), 40 * number, np.uint8)
        Image.fromarray(levels).save(desk.project.path(PICTURES, f"{number + 1:04d}.png"))
    assert client.post("/api/rooms/keep", json=a_room()).status_code == 200
    assert (desk.project.settings.kind, rooms.pictures_of(desk.project.settings)) == ("room", 4)
    stage, read, _ = io.read_stage(desk.project.path(rooms.FILE))
    wanted = rooms.stage_of(rooms.Room(**a_room()), 64)
    assert (stage.grid, stage.lamps, stage.screens) == (wanted.grid, wanted.lamps, wanted.screens)
    assert [(shot.screen, shot.lamps, shot.stop) for shot in stage.shots] == [
        (shot.screen, shot.lamps, shot.stop) for shot in wanted.shots
    ]
    assert read.names == ("n0", "n1", "n2", "n3")
    assert read.images[1].mean() > read.images[0].mean()


def test_a_room_that_cannot_be_is_not_kept(client: TestClient, desk: Desk) -> None:
    room = a_room()
    room["screens"][0]["z"] = 105
    assert client.post("/api/rooms/keep", json=room).status_code == 400
    assert not desk.project.path(rooms.FILE).exists()


@pytest.mark.parametrize(
    "change",
    [{"lamps": [{"name": "front", "x": 0, "y": 0, "z": 0}]}, {"lamps": [{"name": "other", "x": 1, "y": 2, "z": 3}]}],
    ids=["a lamp in the middle", "no such lamp"],
)
def test_a_room_that_was_kept_and_is_none_does_no_harm(desk: Desk, change: dict[str, Any]) -> None:
    room = a_room(screens=[{"name": "wall", "x": 150, "y": 0, "z": -105, "lamp": "front"}], **change)
    desk.change(lambda before: before.model_copy(update={"parts": {rooms.PART: room}}))
    assert rooms.room_of(desk.project.settings) is None
    rooms.write(desk.project)
    assert not desk.project.path(rooms.FILE).exists()
