"""Names of a package that load when they are first used (PEP 562).

This module loads before the guard against Ctrl-C is set: it leaves out even `typing`.
"""

import sys
from importlib import import_module

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any


def when_used(
    package: str, places: "Mapping[str, str]"
) -> "tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]":
    """What a package calls its ``__getattr__, __dir__, __all__``, for names that stand in modules below it.

    Parameters
    ----------
    package
        Its own name. A stub beside it, ``__init__.pyi``, says the same to type checkers.
    places
        The module of each name, relative to the package.
    """

    def load(name: str) -> "Any":
        if name not in places:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = getattr(import_module(f"{package}.{places[name]}"), name)
        setattr(sys.modules[package], name, value)  # the next time it is found at once
        return value

    return load, lambda: sorted({*vars(sys.modules[package]), *places}), sorted(places)
