"""The whole API, asked whatever its schema allows and more: never an error of the studio's own."""

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("fastapi", reason="the studio's extra is not installed")
pytest.importorskip("httpx2", reason="httpx2 is not installed")
pytest.importorskip("schemathesis", reason="schemathesis is not installed")

import schemathesis
from hypothesis import HealthCheck, given, settings

from lightcube.studio.guard import HEADER
from lightcube.studio.making import Making
from tests.helpers.studios import TOKEN, opened


def test_whatever_is_asked_is_answered_by_more_than_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lightcube.studio.solving.Solving._begin", lambda *_: None)  # nothing is solved
    for deed in ("begin", "ask"):  # and nothing foretold, by a process for each question
        monkeypatch.setattr(f"lightcube.studio.forecast.Forecast.{deed}", lambda _: None)
    app: Any = opened(tmp_path / "project").app
    document = app.openapi()
    del document["paths"]["/api/events"]  # it never ends
    schema: Any = schemathesis.openapi.from_dict(document)
    schema.app = app
    operations = [found.ok() for found in schema.get_all_operations()]
    assert len(operations) > 10
    for operation in operations:

        @settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
        @given(case=operation.as_strategy())
        def ask(case: Any) -> None:
            answer = case.call(headers={HEADER: TOKEN, "host": "127.0.0.1"}, base_url="http://127.0.0.1", timeout=300)
            assert answer.status_code < 500, answer.content
            if answer.status_code >= 400:
                assert answer.json()["sentence"]

        ask()


@pytest.mark.parametrize("method", ["GET", "POST", "PUT", "PATCH", "DELETE"])
def test_what_there_is_not_is_a_sentence(method: str, tmp_path: Path) -> None:
    client = opened(tmp_path / "project")
    for path in ("/api/nothing", "/api/pictures/x", "/api/state", "/nothing", "/api/settings"):
        answer = client.request(method, path, content=b"{]")
        assert answer.status_code < 500
        assert answer.status_code == 200 or answer.json()["sentence"]


@pytest.mark.parametrize(
    "change",
    [
        {"making": {"cls": 1}},
        {"making": {"_fields_set": 5}},
        {"kind": "nothing"},
        {"making": {"voxels": 10**400}},
        {"magic": 1},
        {"part": "rooms", "kept": {"lamps": [{"name": "a", "x": 0, "y": 0, "z": 0}]}},
    ],
    ids=str,
)
def test_settings_of_no_meaning_are_a_sentence_or_kept(change: dict[str, Any], tmp_path: Path) -> None:
    client = opened(tmp_path / "project")
    answer = client.patch("/api/settings", json=change)
    assert answer.status_code in (400, 422) or "part" in change
    assert answer.status_code == 200 or answer.json()["sentence"]
    assert client.get("/api/state").json()["settings"]["making"] == Making().model_dump(mode="json")


@pytest.mark.parametrize("depth", [100, 400, 1000, 100_000])
def test_what_is_said_too_deeply_is_a_sentence_or_kept(depth: int, tmp_path: Path) -> None:
    text = '{"part": "rooms", "kept": ' + "[" * depth + "]" * depth + "}"
    client = opened(tmp_path / "project")
    answer = client.patch("/api/settings", content=text, headers={"content-type": "application/json"})
    assert answer.status_code == 200 or answer.json()["sentence"]
    assert client.get("/api/state").status_code == 200
