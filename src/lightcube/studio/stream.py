"""The hub of events: what happens is told to every tab, and who comes back hears what was missed."""

from __future__ import annotations

import asyncio
import json
import secrets
import threading
from collections import deque
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass
from typing import Any

#: So many events are kept for who comes back; who missed more is told how all stands.
_KEPT = 400


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
        self._lock, self._events, self._number = threading.Lock(), deque[Event](maxlen=_KEPT), 0
        self._followers: dict[asyncio.Queue[Event | None], asyncio.AbstractEventLoop] = {}
        self._closed = False

    def tell(self, name: str, facts: Any) -> None:
        """Tell all followers, from whichever thread."""
        text = json.dumps(facts, allow_nan=False)
        with self._lock:
            self._number += 1
            event = Event(self._number, name, text)
            self._events.append(event)
            for queue, loop in self._followers.items():
                loop.call_soon_threadsafe(queue.put_nowait, event)

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
            for queue, loop in self._followers.items():
                loop.call_soon_threadsafe(queue.put_nowait, None)

    def _missed(self, last: str | None) -> list[Event] | None:
        """Events after one; None where that is not known, or too long ago."""
        run, _, number = (last or "").partition("-")
        if run != self._run or not number.isascii() or not number.isdigit():
            return None
        later = [event for event in self._events if event.number > int(number)]
        return later if len(later) == self._number - int(number) else None
