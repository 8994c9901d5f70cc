"""Kernels that run on all threads, one at a time.

Numba's simplest threading layer, which is there on every machine, ends the program where a second call comes in before
the first is done; and two calls at once would not be faster than one after the other.
"""

import functools
import threading
from collections.abc import Callable
from typing import TypeVar

from numba import njit

Kernel = TypeVar("Kernel", bound=Callable[..., object])
_one_at_a_time = threading.RLock()


def parallel(kernel: Kernel) -> Kernel:
    """Compile a function as ``numba.njit(cache=True, parallel=True)`` does; calls wait for each other."""
    compiled = njit(cache=True, parallel=True)(kernel)

    @functools.wraps(kernel)
    def call(*arguments: object) -> object:
        with _one_at_a_time:
            try:
                return compiled(*arguments)
            except SystemError as error:  # what numba makes of Ctrl-C
                cause: BaseException | None = error
                while isinstance(cause, SystemError):
                    cause = cause.__cause__
                if isinstance(cause, KeyboardInterrupt):
                    raise cause from None
                raise

    return call  # type: ignore[return-value]
