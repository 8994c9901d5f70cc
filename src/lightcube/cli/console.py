"""What the commands print and how they are stopped: sentences, progress, JSON lines, Ctrl-C."""

import io
import json
import math
import os
import signal
import sys
import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, nullcontext, suppress
from functools import cache
from types import FrameType
from typing import Any, TypeVar

from rich.console import Console
from rich.text import Text

from lightcube import events
from lightcube.errors import shown, without_secrets
from lightcube.events import Said, Tell

Thing = TypeVar("Thing")


class Plain(Console):
    """A console whose texts can hold names of files: nothing in them moves its cursor or turns its letters round."""

    def render_str(self, text: str, **how: Any) -> Text:
        """The text as it is printed, line by line."""
        return super().render_str("\n".join(map(shown, text.split("\n"))), **how)


class _Aside(Plain):
    """A console for what is no result: where it cannot be written it is lost, and the command goes on."""

    def print(self, *objects: Any, **how: Any) -> None:
        """Print, if that can be."""
        with suppress(OSError):
            super().print(*objects, **how)


#: A terminal without columns would show nothing.
_ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "COLUMNS" or value.strip("0")}

#: Results go to standard output, all else to standard error.
out: Console = Plain(soft_wrap=True, highlight=False, markup=False, emoji=False, _environ=_ENVIRONMENT)

err: Console = _Aside(soft_wrap=True, highlight=False, markup=False, emoji=False, stderr=True, _environ=_ENVIRONMENT)

#: Seconds between two lines of progress.
_BEAT = 0.5
#: After so many seconds a signal that could not be answered is looked at again.
_SOON_S = 0.02


def json_line(event: str, **fields: Any) -> None:
    """Print one line of JSON: ``{"event": event, ...}``; NaN becomes null, and no URL says its password."""
    sys.stdout.write(json.dumps({"event": event, **_plain(fields)}) + "\n")
    sys.stdout.flush()


def json_document(document: dict[str, Any]) -> None:
    """Print a document as JSON, indented; NaN becomes null."""
    sys.stdout.write(json.dumps(_plain(document), indent=2) + "\n")


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, str):
        return without_secrets(value)
    return None if isinstance(value, float) and not math.isfinite(value) else value


@contextmanager
def plain_warnings() -> Iterator[None]:
    """Print warnings as one sentence each, the same one only once."""
    said: set[str] = set()

    def show(message: Warning | str, *_: Any, **__: Any) -> None:
        if str(message) not in said:
            said.add(str(message))
            err.print(f"note: {shown(str(message))}")

    with warnings.catch_warnings():
        warnings.simplefilter("always", UserWarning)
        warnings.showwarning = show
        yield


@contextmanager
def compiling(*, as_json: bool) -> Iterator[None]:
    """Say once, unless machines listen, that kernels are compiled: numba tells where one is not on the disk yet."""
    from lightcube.kernels.compiled import when_compiling  # here: only what computes pays for it

    with nullcontext() if as_json else when_compiling(_say_compiling):
        yield


@cache
def _say_compiling() -> None:
    err.print("compiling, once: about 30 s")


@contextmanager
def progress(task: str, *, as_json: bool) -> Iterator[Callable[..., None]]:
    """Yield ``advance(done, of, **figures)``: a bar with the time left, or at most two JSON lines a second."""
    last = -math.inf
    if as_json:

        def advance(done: int, of: int, **figures: float) -> None:
            nonlocal last
            if time.monotonic() - last > _BEAT or done == of:
                last = time.monotonic()
                json_line("progress", task=task, done=done, of=of, **figures)

        yield advance
        return
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("{task.fields[figures]}"),
        TimeRemainingColumn(),
    )
    bar = Progress(*columns, console=err, transient=True, disable=not err.is_terminal)
    with compiling(as_json=False), bar:
        running = bar.add_task(task, total=None, figures="")

        def show(done: int, of: int, **figures: float) -> None:
            text = "  ".join(f"{name} {value:.4g}" for name, value in figures.items())
            bar.update(running, completed=done, total=of, figures=text or bar.tasks[0].fields["figures"])

        yield show


@contextmanager
def ctrl_c() -> Iterator[Callable[[], bool]]:
    """Yield a function that tells whether Ctrl-C was pressed; a second Ctrl-C stops at once. SIGTERM is the same."""
    pressed = False

    def handle(number: int, frame: Any) -> None:
        nonlocal pressed
        if pressed:
            interrupt(number, frame)
            return
        pressed = True
        err.print("stopping after this pass; press Ctrl-C again to stop at once")

    before = {number: signal.signal(number, handle) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield lambda: pressed
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def prepare() -> None:
    """Let no letter that the terminal lacks stop a command, and let Ctrl-C and SIGTERM clean up behind it."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")

    signal.signal(signal.SIGTERM, interrupt)
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, interrupt)


def interrupt(_: int, frame: FrameType | None) -> None:
    """Raise `KeyboardInterrupt` out of what a signal found at work, or as soon as no call back from LLVM is at work.

    Whatever such a call raises is printed and forgotten: the command would go on as if nobody had pressed Ctrl-C.
    """
    if not _in_llvm(frame) or not hasattr(signal, "setitimer"):
        raise KeyboardInterrupt
    signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, _SOON_S)


def _in_llvm(frame: FrameType | None) -> bool:
    """Whether a frame, or one that called it, is of LLVM's bindings."""
    while frame is not None:
        if frame.f_globals.get("__name__", "").startswith("llvmlite."):
            return True
        frame = frame.f_back
    return False


class Stopped(Exception):  # noqa: N818 - nothing is wrong
    """Ctrl-C, where something is kept: says what."""


def counting(things: Iterable[Thing], count: int, advance: Callable[..., None]) -> Iterator[Thing]:
    """Yield things, and tell how many of so many are done."""
    for number, thing in enumerate(things, 1):
        yield thing
        advance(number, count)


@contextmanager
def listening(task: str, *, as_json: bool) -> Iterator[Tell]:
    """Yield what long work tells: it prints, and stops the work where Ctrl-C was pressed."""
    with ctrl_c() as pressed, telling(task, as_json=as_json) as tell_it:

        def tell(event: events.Progress | Said) -> bool:
            tell_it(event)
            return pressed()

        yield tell


@contextmanager
def telling(task: str, *, as_json: bool) -> Iterator[Tell]:
    """Yield what work tells of which nothing is kept: it prints; Ctrl-C ends the work at once."""
    with progress(task, as_json=as_json) as advance:

        def tell(event: events.Progress | Said) -> None:
            if isinstance(event, Said) and as_json:
                json_line(event.what, **event.facts)
            elif isinstance(event, Said):
                err.print(event.sentence)
            else:  # the bar reckons for itself how long it takes
                left = {"left_s": event.left_s} if as_json and event.left_s is not None else {}
                advance(event.done, event.of, **event.figures, **left)

        yield tell


def done(as_json: bool, sentence: str, **fields: object) -> None:
    """Say what a command has made: a sentence, or a line of JSON."""
    if as_json:
        json_line("result", **fields)
    else:
        out.print(sentence)
