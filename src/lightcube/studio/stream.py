"""The hub of events: what happens is told to every tab, and who comes back hears what was missed."""

from __future__ import annotations

import asyncio
import json
import secrets
import threading
from collections import deque
from collections.abc import AsyncIterator, Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

#: So many events are kept for who comes back, of so many letters in all; who missed more is told how all stands.
_KEPT, _LETTERS = 400, 20_000_000


@dataclass(frozen=True)
class Event:
    """Something that happened: a number that grows, what it is, and its facts as JSON."""

    number: int
    name: str
    text: str


class Hub:
    """Tells events to all who follow.

    Parameters
    ----------
    whole
        Makes what one is told who begins to follow, or missed too much: how all stands.
    """

    def __init__(self, whole: Callable[[], Any]) -> None:
        self._whole, self._run = whole, secrets.token_hex(4)
        self._lock, self._events, self._number, self._letters = threading.Lock(), deque[Event](), 0, 0
        self._followers: dict[asyncio.Queue[Event | None], asyncio.AbstractEventLoop] = {}
        self._closed = False

    def tell(self, name: str, facts: Any) -> None:
        """Tell all followers, from whichever thread."""
        text = json.dumps(facts, allow_nan=False)
        with self._lock:
            self._add(name, text)

    def tell_whole(self) -> Any:
        """Tell all followers how all stands, and return it: as it is now, and not as it was before the last event."""
        while True:
            number = self._number
            facts = self._whole()
            text = json.dumps(facts, allow_nan=False)
            with self._lock:
                if number == self._number:
                    self._add("state", text)
                    return facts

    def id_of(self, event: Event) -> str:
        """What a browser sends back of the last event that it heard; a studio that was started anew knows it not."""
        return f"{self._run}-{event.number}"

    async def follow(self, last: str | None = None) -> AsyncIterator[Event]:
        """Yield what one has missed after the event of id `last`, or how all stands, and then all that happens."""
        queue: asyncio.Queue[Event | None] = asyncio.Queue()
        with self._lock:
            number, missed = self._number, self._missed(last)
            if self._closed:
                return
            self._followers[queue] = asyncio.get_running_loop()
        try:
            if missed is None:
                yield Event(number, "state", json.dumps(await asyncio.to_thread(self._whole), allow_nan=False))
            for event in missed or ():
                yield event
            while (told := await queue.get()) is not None:
                yield told
        finally:
            with self._lock:
                self._followers.pop(queue, None)

    def close(self) -> None:
        """Let all followers go."""
        with self._lock:
            self._closed = True
            self._put(None)

    def _add(self, name: str, text: str) -> None:
        """Keep an event and hand it on."""
        self._number += 1
        event = Event(self._number, name, text)
        self._events.append(event)
        self._letters += len(text)
        while len(self._events) > _KEPT or (self._letters > _LETTERS and len(self._events) > 1):
            self._letters -= len(self._events.popleft().text)
        self._put(event)

    def _put(self, event: Event | None) -> None:
        """Hand something to all followers; who takes nothing any more is let go, and may come back."""
        for queue, loop in list(self._followers.items()):
            is_late = queue.qsize() >= _KEPT
            with suppress(RuntimeError):  # its loop is closed
                loop.call_soon_threadsafe(queue.put_nowait, None if is_late else event)
            if is_late:
                del self._followers[queue]

    def _missed(self, last: str | None) -> list[Event] | None:
        """Events after one; None where that is not known, or too long ago."""
        run, _, number = (last or "").partition("-")
        if run != self._run or not number.isascii() or not number.isdigit():
            return None
        later = [event for event in self._events if event.number > int(number)]
        return later if len(later) == self._number - int(number) else None
