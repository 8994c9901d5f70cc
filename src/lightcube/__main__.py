"""The program's entry: a guard against Ctrl-C, set before anything that takes long to import."""

import os
import signal
import sys

#: The exit code after Ctrl-C.
_INTERRUPTED = 130


def main() -> None:
    """Run the command line; Ctrl-C is one line and exit code 130 from here on.

    While modules load nothing is there to be cleaned up, and an exception would come out of whatever is half imported:
    the program ends at once. Commands then hear of Ctrl-C by `KeyboardInterrupt`. When they are through, it is ignored.
    """
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # else whoever started the program ignores it
        signal.signal(signal.SIGINT, _stop)
    try:
        from lightcube.cli.main import run

        code = run(sys.argv[1:])
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        exec("")  # noqa: S102 - where Ctrl-C came out of an exec, Python would end by that signal, not by the code
        sys.exit(code)
    except KeyboardInterrupt:  # a second one, while the first is answered
        _stop()


def _stop(*_: object) -> None:
    """End the program at once; nothing was begun."""
    os.write(2, b"interrupted: no file was finished\n")
    os._exit(_INTERRUPTED)


if __name__ == "__main__":
    main()
