"""How kernels are compiled: kept on disk where there is a place for it, and without Python's lock while they run."""

import functools
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar, overload

from numba import njit
from numba.core import event

Kernel = TypeVar("Kernel", bound=Callable[..., Any])

#: Whether some kernels are compiled anew in every program, and that is still to be said.
_is_forgetful = False


@overload
def compiled(kernel: Kernel) -> Kernel: ...


@overload
def compiled(
    *, inline: str = ..., fastmath: bool | set[str] = ..., error_model: str = ...
) -> Callable[[Kernel], Kernel]: ...


def compiled(kernel: Any = None, **options: Any) -> Any:
    """Compile a function by numba, with its options, if any; other threads run meanwhile."""
    global _is_forgetful
    if kernel is None:
        return functools.partial(compiled, **options)
    try:
        return njit(cache=True, nogil=True, **options)(kernel)
    except RuntimeError as error:
        if "cannot cache" not in str(error):
            raise
    _is_forgetful = True  # the package cannot be written to, nor any folder of the user's
    return njit(nogil=True, **options)(kernel)


def say_what_is_forgotten() -> None:
    """Warn, once, where compiled kernels cannot be kept."""
    global _is_forgetful
    if _is_forgetful:
        _is_forgetful = False
        warnings.warn(
            "there is no place to keep compiled kernels, which takes a minute in every program: "
            "let NUMBA_CACHE_DIR name a folder that can be written to",
            stacklevel=2,
        )


@contextmanager
def when_compiling(say: Callable[[], None]) -> Iterator[None]:
    """Call `say` once, as soon as a kernel is compiled because it is not on the disk yet."""

    class Listener(event.Listener):
        said = False

        def on_start(self, _: object) -> None:
            if not self.said:
                self.said = True
                say()

        def on_end(self, _: object) -> None:
            pass

    with event.install_listener("numba:compile", Listener()):
        yield
