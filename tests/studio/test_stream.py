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


def test_how_all_stands_is_told_as_it_is_after_the_last_event() -> None:
    """An event that comes while it is looked at makes that old: nobody is told it after the event."""

    async def run() -> None:
        stands = ["before"]

        def whole() -> str:
            found = stands[0]
            if found == "before":
                stands[0] = "after"
                hub.tell("step", "after")
            return found

        hub = Hub(whole)
        following = hub.follow(hub.id_of(Event(0, "", "")))
        first = asyncio.ensure_future(anext(following))
        await asyncio.sleep(0)
        assert hub.tell_whole() == "after"
        told = [await first, await anext(following)]
        assert [(event.name, json.loads(event.text)) for event in told] == [("step", "after"), ("state", "after")]

    to_the_end(run())


def test_what_is_kept_for_who_comes_back_is_bounded_by_its_size(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream, "_LETTERS", 100)

    async def run() -> None:
        hub = Hub(lambda: "all")
        for _ in range(5):
            hub.tell("large", "x" * 40)
        assert (await heard(hub.follow(hub.id_of(Event(2, "", ""))), 1))[0] == ("state", "all")
        assert await heard(hub.follow(hub.id_of(Event(3, "", ""))), 2) == [("large", "x" * 40)] * 2

    to_the_end(run())


def test_who_takes_nothing_any_more_is_let_go_and_comes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream, "_KEPT", 3)

    async def run() -> None:
        hub = Hub(lambda: "all")
        late = hub.follow()
        await anext(late)
        for number in range(9):
            hub.tell("count", number)
            await asyncio.sleep(0)
        assert len([event async for event in late]) == 3
        assert await heard(hub.follow(), 1) == [("state", "all")]

    to_the_end(run())


def test_a_follower_whose_loop_is_gone_keeps_nobody_from_telling() -> None:
    hub = Hub(lambda: "all")

    async def run() -> None:
        following = hub.follow()
        await anext(following)
        hub._followers = dict.fromkeys(hub._followers, closed)

    closed = asyncio.new_event_loop()
    closed.close()
    to_the_end(run())
    hub._followers[asyncio.Queue()] = closed
    hub.tell("count", 1)
