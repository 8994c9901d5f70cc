"""A process that works tells how it goes on, can be told to stop, and whatever goes wrong in it is a sentence."""

import threading
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import Any

import pytest

from lightcube.errors import InputError
from lightcube.events import Progress, Said
from lightcube.studio.worker import Told, Worker, why


def count_until_told(pipe: Connection, most: int) -> None:
    """Work that is as cheap to start as can be."""
    told = Told(pipe)
    for number in range(most):
        told("counted", number=number)
        if told.stopping.wait(0.01):
            told("stopped")
            return
    told("done")


class Listener:
    """What was heard of a worker, and how it ended."""

    def __init__(self, run: Any, *given: Any) -> None:
        self.heard: list[tuple[str, dict[str, Any]]] = []
        self.begun, self.ended, self.last = threading.Event(), threading.Event(), ""
        self.worker = Worker(threading.RLock(), run, given, self.hear, self.end)

    def hear(self, what: str, facts: dict[str, Any]) -> None:
        self.heard.append((what, facts))
        self.begun.set()

    def end(self, last: str) -> None:
        self.last = last
        self.ended.set()


@pytest.mark.parametrize("way", ["to its end", "stopped", "killed", "closed"])
def test_how_it_ends_is_heard(way: str) -> None:
    listener = Listener(count_until_told, 3 if way == "to its end" else 10_000)
    assert listener.begun.wait(60)
    if way == "stopped":
        listener.worker.stop()
    elif way == "killed":
        listener.worker.process.kill()
    elif way == "closed":
        listener.worker.close()
        heard = len(listener.heard)
        assert not listener.worker.process.is_alive()
        assert not listener.ended.wait(0.2)
        assert len(listener.heard) == heard
        return
    assert listener.ended.wait(60)
    assert listener.last == {"to its end": "done", "stopped": "stopped", "killed": "counted"}[way]
    numbers = [facts["number"] for what, facts in listener.heard if what == "counted"]
    assert numbers == list(range(len(numbers)))


def test_who_does_not_stop_is_killed() -> None:
    listener = Listener(deaf)
    assert listener.begun.wait(60)
    listener.worker.stop(0.1)
    assert listener.ended.wait(60)
    assert (listener.last, listener.worker.is_stopping) == ("deaf", True)


def deaf(pipe: Connection) -> None:
    """Work that minds nothing."""
    pipe.send(("deaf", {}))
    threading.Event().wait()


def test_what_long_work_tells_is_passed_on() -> None:
    ours, theirs = Pipe()
    told = Told(theirs)
    assert not told.pass_on(Progress(2, 5, {"PSNR": 31.5}, 4.0))
    assert ours.recv() == ("progress", {"done": 2, "of": 5, "psnr": 31.5, "left_s": 4.0})
    assert not told.pass_on(Said("packing", "packing"))
    assert ours.recv() == ("said", {"sentence": "packing"})
    ours.close()  # nobody is there any more
    assert told.stopping.wait(10)
    assert told.pass_on(Progress(3, 5))


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (InputError("the cube is clear"), "the cube is clear"),
        (MemoryError(), "not enough memory"),
        (OSError(28, "No space left on device"), "No space left on device"),
        (ZeroDivisionError("division by zero"), "a fault of lightcube (ZeroDivisionError)"),
    ],
    ids=lambda given: type(given).__name__,
)
def test_whatever_goes_wrong_is_a_sentence(error: Exception, said: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert said in why(error)
    assert "\n" not in why(error)
    assert ("fault" in said) == bool(capfd.readouterr().err)  # who mends it sees where


def test_nobody_waits_for_a_process_that_is_busy() -> None:
    """What is sent is taken at once, however much of it, while whoever would hear is kept waiting: no deadlock."""
    listener = Listener(busy)
    assert listener.begun.wait(60)
    with listener.worker._lock:
        for _ in range(50):
            listener.worker.send(b"x" * 100_000)
    listener.worker.send("stop")
    assert listener.ended.wait(60)
    assert [what for what, _ in listener.heard] == ["busy", *["answered"] * 51]


def busy(pipe: Connection) -> None:
    """Work that answers all it is told, at length."""
    pipe.send(("busy", {}))
    while True:
        told = pipe.recv()
        pipe.send(("answered", {"at length": b"x" * 100_000}))
        if told == "stop":
            return


def test_a_process_that_cannot_be_started_is_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_: Any) -> None:
        raise OSError(11, "Resource temporarily unavailable")

    monkeypatch.setattr("multiprocessing.context.SpawnProcess.start", full)
    with pytest.raises(InputError, match="the system starts no process for this"):
        Listener(deaf)
