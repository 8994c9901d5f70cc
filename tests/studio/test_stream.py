"""Every follower hears all that happens, and who comes back hears what was missed."""

import asyncio
import json
from collections.abc import AsyncIterator, Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

pytest.importorskip("fastapi", reason="the studio's extra is not installed")

from lightcube.studio import stream
from lightcube.studio.stream import Event, Hub


def to_the_end(story: Coroutine[Any, Any, None]) -> None:
    """Run a story in a thread of its own: a browser of other tests keeps this one's loop."""
    with ThreadPoolExecutor(1) as alone:
        alone.submit(asyncio.run, story).result()


async def heard(following: AsyncIterator[Event], count: int) -> list[tuple[str, Any]]:
    """The next so many events, by name and facts."""
    return [(event.name, json.loads(event.text)) for event in [await anext(following) for _ in range(count)]]


def test_two_tabs_hear_the_same_after_how_all_stands() -> None:
    async def run() -> None:
        hub = Hub(lambda: {"all": 1})
        tabs = [hub.follow(), hub.follow()]
        for tab in tabs:
            assert await heard(tab, 1) == [("state", {"all": 1})]
        for number in range(3):
            hub.tell("count", number)
        for tab in tabs:
            assert await heard(tab, 3) == [("count", 0), ("count", 1), ("count", 2)]

    to_the_end(run())


def test_who_comes_back_hears_what_was_missed_and_nothing_twice() -> None:
    async def run() -> None:
        hub = Hub(lambda: "all")
        tab = hub.follow()
        await anext(tab)
        for number in range(5):
            hub.tell("count", number)
        last = [await anext(tab) for _ in range(2)][-1]
        await tab.aclose()  # type: ignore[attr-defined]
        hub.tell("count", 5)
        assert await heard(hub.follow(hub.id_of(last)), 4) == [("count", number) for number in range(2, 6)]

    to_the_end(run())


@pytest.mark.parametrize("last", ["", "another-3", "-", "x", "{run}-", "{run}-x", "{run}--1", "{run}-999", "{run}-²"])
def test_whoever_is_not_known_hears_how_all_stands(last: str) -> None:
    async def run() -> None:
        hub = Hub(lambda: "all")
        hub.tell("count", 0)
        run_of = hub.id_of(Event(0, "", "")).partition("-")[0]
        following = hub.follow(last.format(run=run_of))
        assert await heard(following, 1) == [("state", "all")]

    to_the_end(run())


def test_who_missed_too_much_hears_how_all_stands(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream, "_KEPT", 3)

    async def run() -> None:
        hub = Hub(lambda: "all")
        for number in range(5):
            hub.tell("count", number)
        assert (await heard(hub.follow(hub.id_of(Event(1, "", ""))), 1))[0] == ("state", "all")
        assert await heard(hub.follow(hub.id_of(Event(2, "", ""))), 3) == [("count", 2), ("count", 3), ("count", 4)]

    to_the_end(run())


def test_when_the_studio_ends_followers_are_let_go() -> None:
    async def run() -> None:
        hub = Hub(lambda: "all")
        following = hub.follow()
        await anext(following)
        hub.close()
        assert [event async for event in following] == []
        assert [event async for event in hub.follow()] == []

    to_the_end(run())
