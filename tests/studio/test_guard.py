"""Who gets into the studio: the token, the names of this machine, the page's own origin, and how much at once."""

from pathlib import Path

import pytest

pytest.importorskip("fastapi", reason="the studio's extra is not installed")
pytest.importorskip("httpx2", reason="httpx2 is not installed")

from fastapi.testclient import TestClient

from lightcube.studio import guard
from tests.helpers.studios import TOKEN, opened


@pytest.fixture
def client(tmp_path: Path) -> TestClient:
    return opened(tmp_path / "project")


def test_without_the_token_nothing_is_told(client: TestClient) -> None:
    del client.headers[guard.HEADER]
    for path in ("/", "/api/state", "/api/events", "/web/studio.js", "/viewer/style.css", "/nothing"):
        answer = client.get(path)
        assert answer.status_code == 403
        assert "address that the terminal shows" in answer.json()["sentence"]
    assert client.get("/?token=guessed").status_code == 403


def test_the_address_gives_a_cookie_that_scripts_cannot_read_and_loses_the_token(client: TestClient) -> None:
    del client.headers[guard.HEADER]
    answer = client.get(f"/?token={TOKEN}", follow_redirects=False)
    assert (answer.status_code, answer.headers["location"]) == (303, "/")
    assert "HttpOnly" in answer.headers["set-cookie"]
    assert "SameSite=Strict" in answer.headers["set-cookie"]
    assert client.get("/").status_code == 200


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example", "[::1", "", "127.0.0.1@evil.example"])
def test_names_of_other_machines_are_refused(client: TestClient, host: str) -> None:
    assert client.get("/api/state", headers={"host": host}).status_code == 403


@pytest.mark.parametrize(
    "headers",
    [
        {"origin": "http://evil.example"},
        {"origin": "null"},
        {"origin": "http://127.0.0.1:1"},
        {"sec-fetch-site": "cross-site"},
        {"sec-fetch-site": "same-site"},
    ],
    ids=str,
)
def test_other_pages_are_refused(client: TestClient, headers: dict[str, str]) -> None:
    assert client.get("/api/state").status_code == 200
    assert client.get("/api/state", headers=headers).status_code == 403
    assert client.post("/api/undo", headers=headers).status_code == 403


def test_the_page_runs_its_own_scripts_only(client: TestClient) -> None:
    for path in ("/", "/api/state", "/nothing"):
        policy = client.get(path).headers["content-security-policy"]
        assert "default-src 'none'; script-src 'self'; style-src 'self'" in policy
        assert "unsafe" not in policy
    text = client.get("/").text
    assert "style=" not in text
    assert "<script>" not in text


def test_more_than_is_taken_is_refused_whether_it_says_so_or_not(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(guard, "MOST_TEXT", 1000)
    said = client.patch("/api/settings", content=b" " * 1001)
    flowing = client.patch("/api/settings", content=(b" " * 100 for _ in range(11)))
    for answer in (said, flowing):
        assert answer.status_code == 413
        assert "larger than 0.001 MB" in answer.json()["sentence"]


@pytest.mark.parametrize(
    "path",
    ["/web/../studio.html", "/web/%2e%2e/app.py", "/web/..%2fapp.py", "/web/parts%5c..", "/viewer/.x.js"],
)
def test_no_path_leads_out_of_the_pages_folder(client: TestClient, path: str) -> None:
    assert client.get(path).status_code == 404


def test_who_looks_is_told_on_a_page_and_who_asks_in_json(client: TestClient) -> None:
    del client.headers[guard.HEADER]
    page = client.get("/", headers={"sec-fetch-dest": "document"})
    assert (page.status_code, page.headers["content-type"]) == (403, "text/html")
    assert "Open the address that the terminal shows: it holds the key to this studio." in page.text
    policy = page.headers["content-security-policy"]
    assert policy.startswith("default-src 'none'; style-src 'sha256-")
    assert client.get("/", headers={"sec-fetch-dest": "empty"}).json()["sentence"]


def test_an_old_tab_is_told_that_the_studio_was_started_again(client: TestClient) -> None:
    del client.headers[guard.HEADER]
    old = {"cookie": f"{guard.cookie_of('another')}=another"}
    assert "was started again" in client.get("/api/state", headers=old).json()["sentence"]
    page = client.get("/", headers={**old, "sec-fetch-dest": "document"}).text
    assert "The studio was started again, and has another key now" in page


def test_cookies_of_other_programs_do_not_hide_the_token(client: TestClient) -> None:
    del client.headers[guard.HEADER]
    cookies = f'theirs={{"a b": "c"}}; {guard.cookie_of(TOKEN)}={TOKEN}'
    assert client.get("/api/state", headers={"cookie": cookies}).status_code == 200


def test_a_length_that_is_no_number_does_no_harm(client: TestClient) -> None:
    assert client.patch("/api/settings", content=b"{}", headers=[(b"content-length", b"\xb2")]).status_code < 500
