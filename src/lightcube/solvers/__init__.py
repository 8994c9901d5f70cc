"""Methods for the backward computation, all on the one signature of `lightcube.solvers.contract.Solver`.

A method is one of the package's own, one that an installed package registers under the entry point
``lightcube.methods``, or any function: `find_method` is the one place that knows them all.
"""

import importlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from types import MappingProxyType
from typing import Any

from lightcube.errors import InputError
from lightcube.solvers.contract import Operator, Result, Solver, Wanted
from lightcube.solvers.method import Method

_GROUP = "lightcube.methods"


@dataclass(frozen=True)
class _Later:
    """A solver of this package: its module, and the compiler with it, loads when it is first called."""

    module: str
    function: str

    @property
    def loaded(self) -> Solver:
        """The function itself."""
        solver: Solver = getattr(importlib.import_module(f"{__name__}.{self.module}"), self.function)
        return solver

    def __call__(self, A: Operator, wanted: Wanted, **options: Any) -> Result:
        return self.loaded(A, wanted, **options)


#: The package's own methods by name; how much memory they take was measured.
OWN: Mapping[str, Method] = MappingProxyType(
    {
        "display": Method(
            _Later("display", "display_values"),
            "display",
            chooses_lamps=True,
            takes_sums=True,
            residual="display",
            passes=200,
            arrays=(4.3, 6.5),
        ),
        "gauss-seidel": Method(
            _Later("gauss_seidel", "gauss_seidel"),
            "gauss-seidel",
            coarse_to_fine=False,
            residual="norm",
            holds_matrix=True,
            arrays=(5.0, 11.0),
        ),
        "row-reduction": Method(
            _Later("row_reduction", "row_reduction"),
            "row-reduction",
            coarse_to_fine=False,
            residual="norm",
            passes=None,
            holds_matrix=True,
            arrays=(5.0, 11.0),
        ),
        "sirt": Method(_Later("sirt", "sirt"), "sirt", coarse_to_fine=False, residual="norm", arrays=(7.7, 9.0)),
        "cgls": Method(_Later("cgls", "cgls"), "cgls", coarse_to_fine=False, residual="norm", arrays=(16.0, 10.5)),
    }
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

    def __repr__(self) -> str:
        return f"<methods {', '.join(self)}>"


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
        if not callable(method):
            raise InputError(f"a method is a name or a function, not {method!r}: use one of {', '.join(METHODS)}")
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
        raise InputError(f"method {name} is {type(found).__name__} and no function: name one")
    return Method(found, name)
