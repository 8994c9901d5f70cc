"""Who may ask the studio: whoever has its token, from this machine, from its own page, within bounds."""

from __future__ import annotations

import hashlib
import json
import secrets
from base64 import b64encode
from collections.abc import Awaitable, Callable, MutableMapping
from contextlib import suppress
from functools import cache
from html import escape
from importlib.resources import files
from typing import Any
from urllib.parse import parse_qsl, urlsplit

from starlette.requests import cookie_parser

Scope = MutableMapping[str, Any]
Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

#: Names of this machine, by which a page of another place never calls it.
LOOPBACK = frozenset({"127.0.0.1", "localhost", "::1"})
#: Bytes that are taken of one file, and of all else that is sent.
MOST_FILE, MOST_TEXT = 300_000_000, 1_000_000
#: Where files are sent to.
_UPLOADS = "/api/uploads"
#: What the names of cookies begin with that hold a studio's token.
_OURS = "lightcube-"
_NO_KEY = "open the address that the terminal shows: it holds the key to this studio"
_OLD_KEY = "the studio was started again, and has another key now: open the address that the terminal shows"
#: A header with the token, for programs.
HEADER = "x-studio-token"
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; media-src 'self' blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_HEADERS = {
    "content-security-policy": _POLICY,
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "cache-control": "no-store",
}


def new_token() -> str:
    """A token that nobody guesses."""
    return secrets.token_urlsafe(24)


def cookie_of(token: str) -> str:
    """Name of the cookie that keeps a token: browsers send cookies of one port to all."""
    return f"{_OURS}{hashlib.sha256(token.encode()).hexdigest()[:12]}"


class _TooMuch(Exception):  # noqa: N818 - it never leaves this module
    """More was sent than is taken."""


class Guard:
    """Middleware that lets through what may come in, and sets what a browser is to mind.

    Parameters
    ----------
    app
        What is guarded.
    token
        In the address once, then in a cookie or a header.
    hosts
        Names by which this machine may be called.
    """

    def __init__(self, app: App, token: str, hosts: frozenset[str] = LOOPBACK) -> None:
        self._app, self._token, self._hosts = app, token, hosts
        self._cookie = cookie_of(token)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or hand it on."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        headers = {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in scope["headers"]}
        refused = self._refused(headers)
        if refused:
            await _answer(send, 403, refused, headers)
            return
        asked = dict(parse_qsl(scope.get("query_string", b"").decode("latin-1")))
        if scope["path"] == "/" and self._is(asked.get("token", "")):
            await self._welcome(send)
            return
        cookies = cookie_parser(headers.get("cookie", ""))
        if not self._is(headers.get(HEADER, "")) and not self._is(cookies.get(self._cookie, "")):
            had_one = any(name.startswith(_OURS) for name in cookies)
            await _answer(send, 403, _OLD_KEY if had_one else _NO_KEY, headers)
            return
        await self._bounded(scope, headers, receive, send)

    def _refused(self, headers: dict[str, str]) -> str:
        """Why a request may not come in, whoever sends it."""
        host = headers.get("host", "")
        if _name_of(f"//{host}") not in self._hosts:
            return "this studio is on this machine only: open it by 127.0.0.1"
        origin = headers.get("origin")
        if origin is not None and origin != f"http://{host}":
            return "another page asked for this: only the studio's own page may"
        if headers.get("sec-fetch-site", "none") not in ("none", "same-origin"):
            return "another page asked for this: only the studio's own page may"
        return ""

    def _is(self, given: str) -> bool:
        return secrets.compare_digest(given.encode("utf-8", "replace"), self._token.encode())

    async def _welcome(self, send: Send) -> None:
        """Keep the token in a cookie and take it out of the address."""
        cookie = f"{self._cookie}={self._token}; Path=/; HttpOnly; SameSite=Strict"
        headers = [(b"location", b"/"), (b"set-cookie", cookie.encode()), *_secured()]
        await send({"type": "http.response.start", "status": 303, "headers": headers})
        await send({"type": "http.response.body", "body": b""})

    async def _bounded(self, scope: Scope, headers: dict[str, str], receive: Receive, send: Send) -> None:
        """Hand a request on, and no more of its body than is taken."""
        most = MOST_FILE if scope["path"] == _UPLOADS else MOST_TEXT
        sentence = f"this is larger than {most / 1e6:g} MB, the most that is taken at once: make it smaller"
        length = headers.get("content-length", "0")
        if length.isdecimal() and int(length) > most:
            await _answer(send, 413, sentence, headers)
            return
        got, begun, over = 0, False, False

        async def counted() -> Message:
            nonlocal got, over
            message = await receive()
            got += len(message.get("body", b""))
            over = got > most
            if over:
                raise _TooMuch
            return message

        async def secured(message: Message) -> None:
            nonlocal begun
            if over and not begun:
                return  # whatever the application makes of a body that broke off
            if message["type"] == "http.response.start":
                begun = True
                said = {name for name, _ in message.get("headers", [])}
                more = [pair for pair in _secured() if pair[0] not in said]
                message["headers"] = [*message.get("headers", []), *more]
            await send(message)

        with suppress(_TooMuch):
            await self._app(scope, counted, secured)
        if over and not begun:
            await _answer(send, 413, sentence, headers)


def _secured() -> list[tuple[bytes, bytes]]:
    return [(name.encode(), value.encode()) for name, value in _HEADERS.items()]


def _name_of(address: str) -> str:
    """The machine's name in an address; nothing where there is none."""
    try:
        return urlsplit(address).hostname or ""
    except ValueError:
        return ""


async def _answer(send: Send, status: int, sentence: str, asked: dict[str, str]) -> None:
    """Refuse with a sentence: as a page where a person looks at it, as JSON where the page or a program asks."""
    secured = dict(_secured())
    if asked.get("sec-fetch-dest") == "document":
        page, style = _locked()
        body, kind = page.replace("{sentence}", escape(f"{sentence[0].upper()}{sentence[1:]}.")).encode(), b"text/html"
        secured[b"content-security-policy"] = f"default-src 'none'; style-src '{style}'".encode()
    else:
        body, kind = json.dumps({"sentence": sentence}).encode(), b"application/json"
    headers = [(b"content-type", kind), (b"content-length", str(len(body)).encode()), *secured.items()]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})


@cache
def _locked() -> tuple[str, str]:
    """The page of who may not come in, and what the content policy calls its style."""
    page = files("lightcube.studio").joinpath("web", "locked.html").read_text("utf-8")
    style = page.partition("<style>")[2].partition("</style>")[0]
    return page, f"sha256-{b64encode(hashlib.sha256(style.encode()).digest()).decode()}"
