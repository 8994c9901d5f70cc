"""Methods for the backward computation, all on the one signature of `lightcube.solvers.contract.Solver`."""

from collections.abc import Iterator, Mapping
from importlib import import_module

from lightcube.solvers.contract import Solver

_PLACES = {
    "display": ("display", "display_values"),
    "gauss-seidel": ("gauss_seidel", "gauss_seidel"),
    "row-reduction": ("row_reduction", "row_reduction"),
    "sirt": ("sirt", "sirt"),
    "cgls": ("cgls", "cgls"),
}


class _Methods(Mapping[str, Solver]):
    """Methods by name: the module of one is loaded when it is asked for, and the compiler with it."""

    def __getitem__(self, name: str) -> Solver:
        module, function = _PLACES[name]
        method: Solver = getattr(import_module(f"{__name__}.{module}"), function)
        return method

    def __contains__(self, name: object) -> bool:
        return name in _PLACES

    def __iter__(self) -> Iterator[str]:
        return iter(_PLACES)

    def __len__(self) -> int:
        return len(_PLACES)


#: Every method by its name on the command line.
METHODS: Mapping[str, Solver] = _Methods()
