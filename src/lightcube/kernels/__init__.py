"""Numba loops; they import numpy and numba only."""

import os

TYPE_CHECKING = False  # this loads with the package itself, which leaves out even `typing`
if TYPE_CHECKING:
    from collections.abc import Callable

# Of a number of threads that is none, numba makes an error that says nothing to anybody; `lightcube.cores` has words.
_said = os.environ.get("NUMBA_NUM_THREADS", "1")
if not (_said.isdigit() and int(_said)):
    del os.environ["NUMBA_NUM_THREADS"]
    try:
        import numba  # noqa: F401
    finally:
        os.environ["NUMBA_NUM_THREADS"] = _said

#: How many threads a loop has where nobody said so; None = one. Set by what knows the machine, which stands above.
default_threads: "Callable[[], int] | None" = None
