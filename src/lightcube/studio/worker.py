"""Long work in a process of its own: what it tells is heard, it can be told to stop, and a fault is a sentence."""

from __future__ import annotations

import multiprocessing
import queue
import signal
import threading
import traceback
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection, wait
from typing import Any

from lightcube.errors import InputError
from lightcube.events import Interrupted, Progress, Said


class Worker:
    """A process that does one thing, and ends; who kills it loses what it has not kept.

    Parameters
    ----------
    lock
        Of who begins it: is held while something is heard.
    run
        Is called in the process with a pipe and what is `given`: a function of a module that is cheap to import.
    heard
        Called with each thing that it tells: what it is, its facts.
    ended
        Called when the process is gone by itself, with what it told last.
    """

    def __init__(
        self,
        lock: threading.RLock,
        run: Callable[..., None],
        given: tuple[Any, ...],
        heard: Callable[[str, dict[str, Any]], None],
        ended: Callable[[str], None],
    ) -> None:
        context = multiprocessing.get_context("spawn")
        name = run.__module__.replace(".", "-")
        try:
            self._pipe, theirs = context.Pipe()
            self.process = context.Process(target=run, args=(theirs, *given), daemon=True, name=name)
            self.process.start()
        except OSError as error:
            raise InputError(
                f"the system starts no process for this ({error.strerror or error}): end other programs, and try again"
            ) from error
        theirs.close()
        self._lock, self._heard, self._ended = lock, heard, ended
        self._reaping = threading.Lock()
        self._outbox: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self.is_stopping = self._is_closed = False
        self._posting = threading.Thread(target=self._post, daemon=True)
        self._posting.start()
        threading.Thread(target=self._hear, daemon=True).start()

    def send(self, what: Any) -> None:
        """Tell it something, soon: nobody waits for a process that is busy. Where it is gone, `ended` says so."""
        self._outbox.put(what)

    def stop(self, patience_s: float | None = None) -> None:
        """Tell it to stop at its next step; it is killed where that takes longer than somebody waits."""
        self.is_stopping = True
        self.send("stop")
        if patience_s is not None:
            impatient = threading.Timer(patience_s, self.process.kill)
            impatient.daemon = True
            impatient.start()

    def close(self, patience_s: float = 0.0) -> None:
        """Have it end, by itself where somebody waits, and else at once; nothing of it is heard any more."""
        with self._lock:
            self._is_closed = True
        if patience_s:
            self.send("stop")
            self._join(patience_s)
        self.process.kill()
        self._join()

    def _hear(self) -> None:
        """Hear what it tells until it ends."""
        last = ""
        with suppress(EOFError, OSError):
            while True:
                last, facts = self._pipe.recv()
                self._tell(self._heard, last, facts)
        self._join()
        self.send(None)
        self._posting.join()
        self._pipe.close()
        self._tell(self._ended, last)

    def _post(self) -> None:
        """Send what there is to be sent, until it is gone."""
        with suppress(OSError):
            while (what := self._outbox.get()) is not None:
                self._pipe.send(what)

    def _join(self, patience_s: float | None = None) -> None:
        """Wait until it is gone; of two threads that ask the system for one child at once, one is told nothing."""
        if wait([self.process.sentinel], patience_s):
            with self._reaping:
                self.process.join()

    def _tell(self, whom: Callable[..., None], *what: Any) -> None:
        with self._lock:
            if not self._is_closed:
                whom(*what)


class Told:
    """What a process tells; nobody at the other end is as good as being told to stop."""

    def __init__(self, pipe: Connection) -> None:
        self._pipe, self._lock = pipe, threading.Lock()
        self.stopping = threading.Event()
        threading.Thread(target=self._listen, daemon=True).start()

    def __call__(self, what: str, **facts: Any) -> None:
        """Tell what happens, and its facts."""
        try:
            with self._lock:
                self._pipe.send((what, facts))
        except OSError:
            self.stopping.set()

    def pass_on(self, event: Progress | Said) -> bool:
        """Tell what long work tells; True where it is to stop."""
        if isinstance(event, Progress):
            psnr = event.figures.get("PSNR")
            self("progress", done=event.done, of=event.of, psnr=psnr, left_s=event.left_s)
        else:
            self("said", sentence=event.sentence)
        return self.stopping.is_set()

    def _listen(self) -> None:
        with suppress(EOFError, OSError):
            self._pipe.recv()
        self.stopping.set()


@contextmanager
def telling(pipe: Connection) -> Iterator[Told]:
    """Tell through a pipe how work goes on; whatever it raises is told last: ``stopped``, or ``failed`` and why."""
    from lightcube.kernels.compiled import when_compiling  # here: the compiler comes with it

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever began this says when it ends
    warnings.simplefilter("ignore")
    told = Told(pipe)
    told("said", sentence="getting ready")
    try:
        with when_compiling(lambda: told("said", sentence="compiling, once: about half a minute")):
            yield told
    except Interrupted:
        told("stopped")
    except Exception as error:
        told("failed", sentence=why(error))


def why(error: Exception) -> str:
    """What went wrong, as a sentence; a fault of the program is also shown in the terminal, for who mends it."""
    if isinstance(error, InputError):
        return f"{error}"
    if isinstance(error, MemoryError):
        return "the machine has not enough memory for this: make it smaller"
    if isinstance(error, OSError):
        return f"the system refused it ({error.strerror or error}): make room on the disk, and do it again"
    traceback.print_exception(error)
    return f"this is a fault of lightcube ({type(error).__name__}): the terminal shows where; nothing else is lost"
