"""Loops over tasks, run by several threads: each task owns what it writes, so their number decides no bit.

A loop is a compiled function of ``(first, last, ...)`` that does the tasks from `first` to before `last`. The thread
that calls takes part after part of it, as do the helpers: plain threads that sleep until there is something to do. It
never waits for a helper to come, only for those that came to end their parts. So a busy machine, several callers at
once, and a helper that cannot be had cost nothing but the help.
"""

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from queue import SimpleQueue
from typing import Any

from numba import config

from lightcube import kernels
from lightcube.kernels.compiled import say_what_is_forgotten

#: Steps of work, about a nanosecond each, that a part of a loop has at least: it is worth waking a thread for.
LEAST_WORK = 50_000
#: Parts of a loop for each thread at most: what is left of one when the others have ended is short, and so is the time
#: that Ctrl-C takes.
_PARTS = 64


class _Loop:
    """A loop whose parts are taken by whoever comes."""

    def __init__(self, kernel: Callable[..., None], count: int, part: int, arguments: tuple[Any, ...]) -> None:
        self._kernel, self._arguments = kernel, arguments
        self._count, self._part, self._next = count, part, 0
        self._lock = threading.Lock()
        self._helpers = 0
        self._ended = threading.Lock()  # held until the last helper has gone
        self._ended.acquire()
        self._error: BaseException | None = None

    def run(self) -> None:
        """Do all of it, with whoever helps."""
        try:
            while self._do_part():
                pass
        except BaseException as error:  # Ctrl-C too
            self._stop(error)
        while self._helpers:
            try:
                self._ended.acquire()
            except KeyboardInterrupt as error:
                self._stop(error)
        self._arguments = ()  # a helper that comes too late need not keep them
        if self._error is not None:
            raise self._error

    def help(self) -> None:
        """Do parts of it until none is left."""
        with self._lock:
            if self._next >= self._count:
                return
            self._helpers += 1
        try:
            while self._do_part():
                pass
        except BaseException as error:  # whoever called raises it
            self._stop(error)
        with self._lock:
            self._helpers -= 1
            if self._helpers == 0:  # for good: there are no parts left
                self._ended.release()

    def _do_part(self) -> bool:
        """Do the next part; False if there is none."""
        with self._lock:
            first = self._next
            self._next = first + self._part
        if first >= self._count:
            return False
        self._kernel(first, min(first + self._part, self._count), *self._arguments)
        return True

    def _stop(self, error: BaseException) -> None:
        """Leave out all parts that nobody has taken."""
        with self._lock:
            self._next = self._count
            self._error = self._error or error


class _Helpers:
    """Threads that help with loops, made when they are first needed."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._count = 0
        self._loops: SimpleQueue[_Loop] = SimpleQueue()

    def call(self, count: int, loop: _Loop) -> None:
        """Let so many help with a loop, if they find anything left to do."""
        with self._lock, suppress(RuntimeError):  # the system gives no more threads
            while self._count < count:
                threading.Thread(target=self._help, name=f"lightcube-{self._count + 1}", daemon=True).start()
                self._count += 1
        for _ in range(min(count, self._count)):
            self._loops.put(loop)

    def _help(self) -> None:
        while True:
            self._loops.get().help()  # and keep no loop: its arrays are large


_helpers = _Helpers()
_threads: int | None = None


def threads() -> int:
    """How many threads work on a loop."""
    global _threads
    if _threads is None:
        _threads = 1 if kernels.default_threads is None else kernels.default_threads()
    return _threads


def set_threads(count: int) -> None:
    """Let so many threads work on a loop, from the next one on."""
    global _threads
    _threads = count


@contextmanager
def using(count: int) -> Iterator[None]:
    """Let so many threads work on each loop meanwhile."""
    before = threads()
    set_threads(count)
    try:
        yield
    finally:
        set_threads(before)


def run(kernel: Callable[..., None], count: int, work: int, *arguments: Any) -> None:
    """Do ``kernel(first, last, *arguments)`` for all of `count` tasks, in parts and by several threads if it is long.

    Parameters
    ----------
    kernel
        A compiled loop over the tasks `first` to before `last`.
    count
        Tasks.
    work
        Steps that all of them take, about a nanosecond each.
    """
    say_what_is_forgotten()
    most = 1 if config.DISABLE_JIT else threads()  # type: ignore[attr-defined]
    part = max(-(-count * LEAST_WORK // max(work, 1)), -(-count // (_PARTS * most)))
    if part >= count:
        if count:
            kernel(0, count, *arguments)
        return
    loop = _Loop(kernel, count, part, arguments)
    helpers = min(most, -(-count // part)) - 1
    if helpers:
        _helpers.call(helpers, loop)
    loop.run()


def _forget() -> None:
    """Begin anew: threads do not live on in a process that was forked."""
    global _helpers
    _helpers = _Helpers()


if hasattr(os, "register_at_fork"):  # not on Windows
    os.register_at_fork(after_in_child=_forget)
