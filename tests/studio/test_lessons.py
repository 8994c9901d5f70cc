"""Class mode: what is drawn becomes a solid, contradictions are told, and a small cube's equations are right."""

import base64
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("fastapi", reason="the studio's extra is not installed")
from fastapi import FastAPI
from fastapi.testclient import TestClient

from lightcube import io
from lightcube.errors import InputError
from lightcube.studio import lessons
from lightcube.studio.desk import Desk
from lightcube.studio.project import Project

SIDE = lessons.SIDE


def box(inside: Callable[[int, int], bool]) -> list[str]:
    return ["".join("#" if inside(row, column) else "." for column in range(SIDE)) for row in range(SIDE)]


FULL, LOWER = box(lambda row, column: True), box(lambda row, column: row >= SIDE // 2)
DISC = box(lambda row, column: (row - 11.5) ** 2 + (column - 11.5) ** 2 < 81)


@pytest.fixture
def client(tmp_path: Path) -> TestClient:
    app = FastAPI()
    app.include_router(lessons.router(Desk(Project(tmp_path))))
    return TestClient(app)


def drawn(**boxes: Any) -> lessons.Drawn:
    return lessons.Drawn(**{"front": FULL, "side": FULL, "top": FULL, **boxes})


def test_what_agrees_is_cast_whole() -> None:
    found = lessons.solid(drawn(front=LOWER, side=LOWER))
    assert found["said"] == ["One object casts all of this."]


def test_what_a_wall_forbids_is_lost_and_blamed() -> None:
    found = lessons.solid(drawn(side=LOWER))
    assert found["shares"] == [0.5, 0.0, 0.0]
    assert found["lost"][0] == [SIDE * "1"] * (SIDE // 2) + [SIDE * "."] * (SIDE // 2)
    assert found["said"] == [
        "No object casts 50 % of the front while it stays inside the others: the side is empty there."
    ]


def test_boxes_that_do_not_count_yet_take_nothing_away() -> None:
    found = lessons.solid(drawn(side=LOWER, count=1))
    assert found["shares"] == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("way", ["trim", "grow"])
def test_after_the_repair_one_object_casts_all(way: str) -> None:
    found = lessons.solid(drawn(side=LOWER, top=DISC, way=way))
    front, side, top = found["cast"]
    again = lessons.solid(lessons.Drawn(front=front, side=side, top=top))
    assert max(again["shares"]) < 0.05 < max(lessons.solid(drawn(side=LOWER, top=DISC))["shares"])
    assert found["repaired"].startswith({"trim": "What no object casts", "grow": "What was missing"}[way])


def test_an_empty_box_is_named() -> None:
    with pytest.raises(InputError, match="the side is empty: draw something in its box"):
        lessons.solid(drawn(side=box(lambda row, column: False)))


@pytest.mark.parametrize("rows", [[], ["#"] * SIDE, ["!" * SIDE] * SIDE, None, [SIDE * "#"] * (SIDE + 1)])
def test_other_boxes_are_refused(client: TestClient, rows: Any) -> None:
    good = {"front": FULL, "side": FULL, "top": FULL}
    assert client.post("/api/lessons/hull", json=good | {"top": rows}).status_code == 422
    assert client.post("/api/lessons/hull", json=good).status_code == 200


def test_the_equations_of_the_small_cube_hold(client: TestClient) -> None:
    cube = client.get("/api/lessons/cube").json()
    lengths, light = np.array(cube["lengths"]), np.array(cube["light"])
    absorbed = np.array(cube["absorbed"]).reshape(3, 9, 3)
    for view in range(len(lengths)):
        for at in range(3):
            assert np.allclose(lengths[view] @ absorbed[at], -np.log(light[view, 2 - at]), atol=1e-6)


def test_three_pictures_say_all_of_the_small_cube_and_fewer_do_not() -> None:
    found = lessons.small_cube()["found"]
    assert [each["equations"] for each in found[:3]] == [3, 8, 13]
    assert [sum(each["right"]) for each in found] == [0, 3, *[9] * 6]
    assert found[2]["tints"] == lessons.small_cube()["tints"]


@pytest.mark.parametrize("suffix", ["stl", "3mf"])
def test_the_solid_is_a_file_to_print_and_its_shadows_are_known(
    client: TestClient, tmp_path: Path, suffix: str
) -> None:
    boxes = {"front": DISC, "side": LOWER, "top": DISC, "way": "trim"}
    found = client.post(f"/api/lessons/mesh/{suffix}", json=boxes).json()
    (tmp_path / found["name"]).write_bytes(base64.b64decode(found["data"]))
    mesh = io.read_solid(tmp_path / found["name"])
    assert mesh.is_watertight
    assert 40 < max(mesh.size_mm) < 100
    assert any("shadows of the file overlap" in each for each in found["said"])
    assert client.post("/api/lessons/mesh/exe", json=boxes).status_code == 422
