"""Servers that do not answer or refuse, and who asks them: what is said of it, and that no password is."""

import socket
import threading
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import pytest

from lightcube.cli import console
from lightcube.errors import InputError, shown
from lightcube.io import read_pictures, save
from lightcube.jobs.reading import load
from tests.hostile.bombs import CUBE

pytest.importorskip("fsspec", reason="URLs need the extra remote")


@pytest.fixture(scope="module")
def answering() -> Iterator[Callable[[int], str]]:
    """URL of a server on this machine that answers everything with one status."""

    class Handler(BaseHTTPRequestHandler):
        def answer(self) -> None:
            self.send_error(int(self.path.split("/")[1]))

        do_GET = do_HEAD = do_PUT = do_POST = answer  # noqa: N815 - as the library calls them

        def log_message(self, *_: Any) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield lambda status: f"http://127.0.0.1:{server.server_port}/{status}"
        server.shutdown()


def silent_port() -> int:
    """A port of this machine that nobody listens at."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


ASKED: list[Callable[[str], object]] = [load, read_pictures, lambda url: save(CUBE, url)]


@pytest.mark.parametrize("scheme", ["http", "ftp"])
@pytest.mark.parametrize("name", ["a.npz", "a.zarr", "a.zarr.zip"])
def test_a_server_that_does_not_answer_is_told(scheme: str, name: str) -> None:
    if scheme == "http":
        pytest.importorskip("aiohttp", reason="HTTP needs the extra remote")
    url = f"{scheme}://127.0.0.1:{silent_port()}/{name}"
    for ask in ASKED:
        with pytest.raises(InputError, match=rf"^the server of {url} does not answer \(.*\): check the URL and your"):
            ask(url)


@pytest.mark.parametrize("status", [401, 403, 404, 410, 500, 503])
def test_only_what_is_not_there_is_not_there(status: int, answering: Callable[[int], str]) -> None:
    pytest.importorskip("aiohttp", reason="HTTP needs the extra remote")
    for ask in ASKED[:2]:
        with pytest.raises(InputError) as refused:
            ask(f"{answering(status)}/a.npz")
        assert str(refused.value).startswith("there is no") == (status in (404, 410))


@pytest.mark.parametrize(
    "login", ["user:secret@", "secret@", "user:sec@ret@", ":secret@", "user:secret/secret@", "us%40er:secret%2f@"]
)
@pytest.mark.parametrize(
    "url", ["http://{}127.0.0.1:9/a.npz", "nobody://{}x/a.npz", "s3://{}x/a.tar", "zip://a::http://{}x"]
)
def test_passwords_in_urls_are_never_said(url: str, login: str) -> None:
    for ask in ASKED:
        with pytest.raises(InputError) as refused:
            ask(url.format(login))
        assert "sec" not in str(refused.value)
        assert "://***@" in str(refused.value)
    assert "sec" not in shown(f"note: {url.format(login)} and {url.format(login)}")


def test_an_at_sign_in_a_path_is_no_login() -> None:
    for text in ("s3://bucket/a@b.zarr", "http://host:8080/a@b.zarr", "a@b: c://d"):
        assert shown(text) == text


@pytest.mark.parametrize(
    "query", ["sig=secret", "X-Amz-Credential=secret%2Fa&X-Amz-Signature=secret", "a=1:secret", "?secret"]
)
@pytest.mark.parametrize(
    "url", ["http://127.0.0.1:9/a.npz?{}", "nobody://x/a.npz?{}", "https://127.0.0.1:9/a.zarr.zip?{}"]
)
def test_what_signs_a_url_is_never_said(url: str, query: str) -> None:
    for ask in ASKED:
        with pytest.raises(InputError) as refused:
            ask(url.format(query))
        assert "secret" not in str(refused.value)
        assert url.format("***") in str(refused.value)
    text = "there is no {}: give another, not '{}' (nor {}), or"
    assert shown(text.format(*[url.format(query)] * 3)) == text.format(*[url.format("***")] * 3)


def test_json_says_no_password(capsys: pytest.CaptureFixture[str]) -> None:
    url = "https://user:secret@host/a.zarr?sig=secret"
    console.json_line("published", path=url, more={"paths": [url]})
    console.json_document({"path": url})
    said = capsys.readouterr().out
    assert said.count('https://***@host/a.zarr?***"') == 3
    assert "secret" not in said
