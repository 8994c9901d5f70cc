"""A program that runs commands in children of its own, and kills one of them at an event of the file system.

It reads commands as lines of JSON, ``[words, at]``, and answers each with ``[exit code, events]``. The children are
forked from what has loaded and compiled all that they need, so each takes a fraction of a second.
"""

import json
import os
import signal
import sys

from lightcube.cli import main
from lightcube.report import measuring
from lightcube.verbs import drawing

measuring.ROOM = drawing.ROOM = (27, 48)  # it is written as larger ones are, and sooner

#: What asks the file system for something, before it is done; `at` counts them from 1.
EVENTS = {"open", *(f"os.{name}" for name in ("link", "mkdir", "remove", "rename", "rmdir", "symlink", "truncate"))}


def forked(words: list[str], at: int | None) -> tuple[int, int]:
    """Run a command in a child and return its exit code and how many events there were; kill it at event `at`."""
    told, tell = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(told)
        os._exit(counted(words, at, tell))
    os.close(tell)
    with os.fdopen(told) as reading:
        events = reading.read()
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), int(events or 0)


def counted(words: list[str], at: int | None, tell: int) -> int:
    """Run a command and count the events."""
    count = 0

    def hear(event: str, _: object) -> None:
        nonlocal count
        if event in EVENTS:
            count += 1
            if count == at:
                os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(hear)
    code = main.run(words)
    os.write(tell, str(count).encode())
    return code


def serve() -> None:
    """Answer line after line; what the children say goes to standard error."""
    answers = os.dup(1)
    os.dup2(2, 1)
    for line in sys.stdin:
        words, at = json.loads(line)
        answer = [main.run(words), 0] if at == "here" else forked(words, at)
        os.write(answers, f"{json.dumps(answer)}\n".encode())


if __name__ == "__main__":
    serve()
