"""Pictures are taken in any format, kept small, cropped, named and ordered, and lie where commands read them."""

import errno
import json
import zlib
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("fastapi", reason="the studio's extra is not installed")
pytest.importorskip("httpx2", reason="httpx2 is not installed")

from fastapi.testclient import TestClient
from PIL import Image

from lightcube import io
from lightcube.studio import project
from tests.helpers.studios import opened
from tests.studio.test_project import NAMES


@pytest.fixture
def client(tmp_path: Path) -> TestClient:
    return opened(tmp_path / "project")


def picture(
    rows: int = 12, columns: int = 20, colour: tuple[int, int, int] = (200, 100, 50), kind: str = "png"
) -> bytes:
    stream = BytesIO()
    Image.new("RGB", (columns, rows), colour).save(stream, kind)
    return stream.getvalue()


def drop(client: TestClient, data: bytes, name: str, **more: Any) -> Any:
    return client.post("/api/uploads", params={"name": name, **more}, content=data)


def names(state: dict[str, Any]) -> list[str]:
    return [each["name"] for each in state["settings"]["pictures"]]


def read(client: TestClient) -> Any:
    """The pictures as a command reads them."""
    return io.read_pictures(Path(client.get("/api/state").json()["folder"]) / "pictures", least=1)


@pytest.mark.parametrize("kind", ["png", "jpeg", "webp", "tiff", "gif", "avif"])
def test_files_of_all_kinds_are_taken(client: TestClient, kind: str) -> None:
    answer = drop(client, picture(kind=kind), f"sea.{kind}")
    assert answer.status_code == 200, answer.text
    assert names(answer.json()) == ["sea"]
    shown = read(client)
    assert shown.names == ("sea",)
    np.testing.assert_allclose(255 * shown.images[0].mean(axis=(0, 1)) ** (1 / 2.2), (200, 100, 50), atol=8)


def test_an_animation_becomes_its_pictures_and_a_part_of_them(client: TestClient) -> None:
    stream = BytesIO()
    frames = [Image.new("RGB", (8, 6), (40 * number, 0, 0)) for number in range(6)]
    frames[0].save(stream, "gif", save_all=True, append_images=frames[1:], duration=100)
    assert names(drop(client, stream.getvalue(), "walk.gif").json()) == [f"walk {number}" for number in range(1, 7)]
    client.put("/api/pictures", json={"keys": []})
    assert len(names(drop(client, stream.getvalue(), "walk.gif", every=2).json())) == 3


def test_a_large_picture_is_kept_small_and_keeps_its_mean_light(client: TestClient) -> None:
    board = np.zeros((900, 1300, 3), np.uint8)
    board[::2, ::2] = board[1::2, 1::2] = 255
    stream = BytesIO()
    Image.fromarray(board).save(stream, "png")
    drop(client, stream.getvalue(), "board.png")
    (kept,) = read(client).images
    assert max(kept.shape) == 640
    np.testing.assert_allclose(kept.mean(), 0.5, atol=0.01)


@pytest.mark.parametrize(
    ("data", "name", "said"),
    [
        (b"no picture", "a.png", "a.png"),
        (picture()[:60], "cut.png", "cut.png"),
        (b"", "none.jpg", "none.jpg"),
        (b"text", "a.txt", "a.txt is no picture, animation or video"),
        (b"text", "project.toml", "is no picture"),
        (b"text", "../../a", "is no picture"),
        (b"x", "film.mp4", "film.mp4"),
    ],
)
def test_what_is_no_picture_is_one_sentence_with_its_own_name(
    client: TestClient, data: bytes, name: str, said: str
) -> None:
    answer = drop(client, data, name)
    assert answer.status_code == 400
    assert said in answer.json()["sentence"]
    assert ".incoming" not in answer.json()["sentence"]
    folder = Path(client.get("/api/state").json()["folder"])
    assert not [each for each in folder.iterdir() if each.name.startswith(".incoming")]
    assert names(client.get("/api/state").json()) == []


def test_a_photo_of_300_megapixels_is_one_sentence(client: TestClient) -> None:
    header = bytearray(picture())
    header[16:24] = (20_000).to_bytes(4, "big") + (15_000).to_bytes(4, "big")
    header[29:33] = zlib.crc32(bytes(header[12:29])).to_bytes(4, "big")
    answer = drop(client, bytes(header), "huge.png")
    assert answer.status_code == 400
    assert "250 megapixels" in answer.json()["sentence"]


def test_more_pictures_than_a_project_has_are_one_sentence(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lightcube.studio.pictures.MOST_PICTURES", 3)
    for number in range(3):
        assert drop(client, picture(), f"{number}.png").status_code == 200
    answer = drop(client, picture(), "4.png")
    assert answer.status_code == 400
    assert "at most 3 pictures" in answer.json()["sentence"]
    assert client.post("/api/samples/ball").status_code == 400


@pytest.mark.parametrize("name", NAMES)
def test_hostile_names_do_no_harm(client: TestClient, name: str) -> None:
    key = drop(client, picture(), "a.png").json()["settings"]["pictures"][0]["key"]
    assert client.patch(f"/api/pictures/{key}", json={"name": name}).status_code == 200
    assert len(read(client)) == 1
    answer = drop(client, picture(), f"{name}.png")
    assert answer.status_code in (200, 422)
    folder = Path(client.get("/api/state").json()["folder"])
    assert {each.name for each in (folder / "pictures").iterdir()} <= {"0001.png", "0002.png", "views.toml"}
    assert {each.name for each in folder.parent.iterdir()} == {"project"}


def test_crop_order_count_and_removal_are_what_commands_read(client: TestClient) -> None:
    for number, colour in enumerate([(255, 0, 0), (0, 255, 0), (0, 0, 255)]):
        state = drop(client, picture(colour=colour), f"{number}.png").json()
    keys = [each["key"] for each in state["settings"]["pictures"]]
    client.put("/api/pictures", json={"keys": keys[::-1]})
    client.patch(f"/api/pictures/{keys[2]}", json={"crop": {"left": 0.5, "width": 0.25, "top": 0.5, "height": 0.5}})
    shown = read(client)
    assert shown.names == ("2", "1", "0")
    assert shown.images[0].shape == (6, 5, 3)
    assert shown.images[0][0, 0].argmax() == 2
    client.patch("/api/settings", json={"making": {"count": 2}})
    assert read(client).names == ("2", "1")
    client.delete(f"/api/pictures/{keys[1]}")
    assert read(client).names == ("2", "0")
    client.post("/api/undo")
    assert read(client).names == ("2", "1")
    for _ in range(20):
        client.post("/api/undo")
    assert client.get("/api/state").json()["settings"]["pictures"] == []


def test_pictures_that_vanish_are_told_and_not_solved_for(client: TestClient) -> None:
    state = client.post("/api/samples/letters").json()
    key, name = state["settings"]["pictures"][1]["key"], state["settings"]["pictures"][1]["name"]
    (Path(state["folder"]) / "dropped" / f"{key}.png").unlink()
    assert client.get("/api/state").json()["pictures"]["missing"] == [key]
    assert client.get(f"/api/pictures/{key}").status_code == 404
    answer = client.post("/api/solving/start")
    assert answer.status_code == 400
    assert f"1 picture vanished from the folder ({name})" in answer.json()["sentence"]


def test_the_sets_to_try_are_pictures_of_different_content(client: TestClient) -> None:
    for name, count in (("photographs", 6), ("letters", 5), ("ball", 8)):
        client.put("/api/pictures", json={"keys": []})
        state = client.post(f"/api/samples/{name}").json()
        images = [image.tobytes() for image in read(client).images]
        assert len(names(state)) == count
        assert len(set(images)) == count


def test_what_nobody_can_come_back_to_is_cleared_and_undo_still_works(client: TestClient) -> None:
    folder = Path(drop(client, picture(), "0.png").json()["folder"])
    for number in range(1, 4):
        drop(client, picture(), f"{number}.png")
    client.post("/api/undo")
    client.post("/api/undo")
    drop(client, picture(), "other.png")  # the last two cannot come back
    (folder / ".incoming-abc").mkdir()
    (folder / ".incoming-abc" / "file.png").write_bytes(b"half")
    for name in (f".{'0' * 16}.png.7.half-written", "mine.png", f"{'1' * 16}.jpg"):
        (folder / "dropped" / name).write_bytes(b"x")
    kept = client.get("/api/state").json()["settings"]["pictures"]
    client.put("/api/pictures", json={"keys": []})
    client.app.state.desk.close()  # type: ignore[attr-defined]
    with opened(folder) as again:
        left = {each.name for each in (folder / "dropped").iterdir()}
        assert left == {*(f"{each['key']}.png" for each in kept), "mine.png", f"{'1' * 16}.jpg"}
        assert not (folder / ".incoming-abc").exists()
        assert again.post("/api/undo").json()["pictures"]["missing"] == []
        assert len(read(again)) == 3


def test_dropped_pictures_do_not_pile_up_while_the_studio_runs(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("lightcube.studio.pictures._MANY", 2)
    monkeypatch.setattr("lightcube.studio.pictures._FRESH_S", -1.0)
    for number in range(5):
        state = drop(client, picture(), f"{number}.png").json()
        client.post("/api/undo")
    assert len(list((Path(state["folder"]) / "dropped").iterdir())) == 3


def test_a_crop_that_cannot_be_is_one_sentence(client: TestClient) -> None:
    key = drop(client, picture(), "a.png").json()["settings"]["pictures"][0]["key"]
    for crop in ({"left": 0.9, "width": 0.5}, {"width": 0}, {"left": -1}, {"left": 1e308}, {"magic": 1}):
        answer = client.patch(f"/api/pictures/{key}", content=json.dumps({"crop": crop}))
        assert answer.status_code == 422, crop
        assert answer.json()["sentence"]
    assert project.Crop().model_dump() == client.get("/api/state").json()["settings"]["pictures"][0]["crop"]


def test_what_vanishes_of_what_the_command_reads_is_written_again(client: TestClient) -> None:
    folder = Path(client.post("/api/samples/letters").json()["folder"]) / "pictures"
    before = {each.name: each.read_bytes() for each in folder.iterdir()}
    for name in ("0002.png", "views.toml"):
        (folder / name).unlink()
    client.patch("/api/settings", json={"title": "anything"})
    assert {each.name: each.read_bytes() for each in folder.iterdir()} == before


def test_a_damaged_picture_is_a_sentence_and_everybody_is_told_of_the_change(client: TestClient) -> None:
    state = client.post("/api/samples/letters").json()
    key = state["settings"]["pictures"][0]["key"]
    (Path(state["folder"]) / "dropped" / f"{key}.png").write_bytes(b"no picture")
    desk: Any = client.app.state.desk  # type: ignore[attr-defined]
    told: list[Any] = []
    desk.hub._put = told.append
    answer = client.patch(f"/api/pictures/{key}", json={"crop": {"width": 0.5}})
    assert answer.status_code == 400
    assert f"reading {state['folder']}/dropped/{key}.png failed" in answer.json()["sentence"]
    assert [event.name for event in told] == ["state"]
    assert client.get("/api/state").json()["settings"]["pictures"][0]["crop"]["width"] == 0.5
    desk.close()
    with opened(Path(state["folder"])) as again:  # it is open all the same, and says what is wrong
        assert "dropped" in again.get("/api/state").json()["trouble"]


def test_a_disk_that_is_full_is_said_with_the_files_own_name(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    written = Path.open

    def full(path: Path, *how: Any, **more: Any) -> Any:
        if path.name.startswith("file"):
            raise OSError(errno.ENOSPC, "No space left on device")
        return written(path, *how, **more)

    monkeypatch.setattr(Path, "open", full)
    said = drop(client, picture(), "../my sea.png").json()["sentence"]
    assert "no space is left on the disk" in said
    assert "writing my sea.png" in said
