"""Methods for the backward computation, all on the one signature of `lightcube.solvers.contract.Solver`.

A method is one of the package's own, one that an installed package registers under the entry point
``lightcube.methods``, or any function: `find_method` is the one place that knows them all.
"""

import importlib
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from types import MappingProxyType

from lightcube.errors import InputError
from lightcube.solvers.cgls import CGLS
from lightcube.solvers.contract import Solver
from lightcube.solvers.display import DISPLAY
from lightcube.solvers.gauss_seidel import GAUSS_SEIDEL
from lightcube.solvers.method import Method
from lightcube.solvers.row_reduction import ROW_REDUCTION
from lightcube.solvers.sirt import SIRT

_GROUP = "lightcube.methods"
#: The package's own methods by name.
OWN: Mapping[str, Method] = MappingProxyType(
    {method.name: method for method in (DISPLAY, GAUSS_SEIDEL, ROW_REDUCTION, SIRT, CGLS)}
)


class _Methods(Mapping[str, Method]):
    """The package's own methods, whose names are theirs, and those of installed packages, loaded when asked for.

    One that cannot be loaded is not among them; asked for by its name it raises `InputError` that says why.
    """

    def __getitem__(self, name: str) -> Method:
        return OWN[name] if name in OWN else _load(_registered()[name])

    def __iter__(self) -> Iterator[str]:
        yield from OWN
        yield from (name for name, entry in _registered().items() if _loads(entry))

    def __contains__(self, name: object) -> bool:
        return name in OWN or name in _registered()

    def __len__(self) -> int:
        return sum(1 for _ in self)


#: Every method by its name on the command line; to list them loads what other packages bring.
METHODS: Mapping[str, Method] = _Methods()


def find_method(method: str | Solver | Method) -> Method:
    """Return the method that is meant.

    Parameters
    ----------
    method
        A name in `METHODS`, the place of a function or a `Method` as ``"package.module:name"``, a function of the
        signature of `lightcube.solvers.contract.Solver`, or a `Method`.

    Raises
    ------
    InputError
        Where there is none of this name, it cannot be loaded, or it does not take what solvers are given.
    """
    if isinstance(method, Method):
        return method
    if not isinstance(method, str):
        return Method(method)
    if method in METHODS:
        return METHODS[method]
    if ":" in method:
        return _imported(method)
    raise InputError(f"unknown method {method!r}: use one of {', '.join(METHODS)}")


def check_lasting(method: Method) -> None:
    """Raise `InputError` unless another program finds the same method by its name, as unfinished work needs it to."""
    with_name = "put it at the top of a module that can be imported, and name it as package.module:name"
    try:
        found = None if method.name.startswith("__main__:") else find_method(method.name)
    except InputError as error:
        raise InputError(f"an unfinished cube cannot go on by its method: {error}; {with_name}") from error
    if found != method:
        raise InputError(
            f"an unfinished cube cannot go on by method {method.name}, which no name leads to: {with_name}"
        )


def _imported(place: str) -> Method:
    module, _, name = place.partition(":")
    try:
        found = importlib.import_module(module)
        for part in name.split("."):
            found = getattr(found, part)
    except Exception as error:
        raise InputError(
            f"method {place} cannot be imported ({error}): check its name and where it is installed"
        ) from error
    return _described(found, place)


@cache
def _registered() -> Mapping[str, EntryPoint]:
    """Entry points by name, the package's own names left out; of several with one name the first."""
    found: dict[str, EntryPoint] = {}
    for entry in entry_points(group=_GROUP):
        if entry.name not in OWN:
            found.setdefault(entry.name, entry)
    return found


@cache
def _load(entry: EntryPoint) -> Method:
    try:
        return _described(entry.load(), entry.name)
    except Exception as error:
        raise InputError(
            f"method {entry.name} ({entry.value}) cannot be loaded ({error}): mend or remove the package that has it"
        ) from error


def _loads(entry: EntryPoint) -> bool:
    try:
        _load(entry)
    except InputError:
        return False
    return True


def _described(found: object, name: str) -> Method:
    if isinstance(found, Method):
        return replace(found, name=name)
    if not callable(found):
        raise InputError(f"method {name} is {type(found).__name__} and no function")
    return Method(found, name)
