"""What a method is, beside the function that solves: what it can choose, what its figures mean, what it needs."""

from __future__ import annotations

import inspect
from dataclasses import dataclass
from typing import Literal

from lightcube.errors import InputError
from lightcube.solvers.contract import Result, Solver

#: What a method's residuals are: half the weighted squares of display values (those too dark linearised), of which it
#: can be told how many dB they are; another sum over columns that it minimises; or a 2-norm over columns.
Residual = Literal["display", "sum", "norm"]


@dataclass(frozen=True)
class Method:
    """A solver and what is to be known of it; the defaults are what a plain function is taken for.

    Parameters
    ----------
    solve
        The function, of the signature of `lightcube.solvers.contract.Solver`.
    name
        What cubes say that they were made by; default ``"package.module:function"``.
    chooses_lamps
        Whether it finds lamp powers within bounds. If not it gets one power for each lamp.
    takes_sums
        Whether it can do with views that add up to a picture (`lightcube.optics.law.Mixture`).
    coarse_to_fine
        Whether large cubes start from the solution at half the size.
    residual
        What its residuals are.
    passes
        At most so many where nothing is said; None where it is direct and does not count them.
    holds_matrix
        Whether it asks for the sparse matrix, which takes much memory.
    arrays
        Arrays as large as the unknowns, and as the pictures' beams, that there are at its peak, what poses the problem
        included: from this the memory of a job is reckoned.

    Raises
    ------
    InputError
        Where the function does not take what solvers are given.
    """

    solve: Solver
    name: str = ""
    chooses_lamps: bool = False
    takes_sums: bool = False
    coarse_to_fine: bool = True
    residual: Residual = "sum"
    passes: int | None = 100
    holds_matrix: bool = False
    arrays: tuple[float, float] = (8.0, 11.0)

    def __post_init__(self) -> None:
        if not self.name:
            object.__setattr__(self, "name", _name_of(self.solve))
        try:
            given = dict.fromkeys(("x0", "bounds", "iterations", "callback", "state"))
            inspect.signature(self.solve).bind(None, None, **given)
        except (TypeError, ValueError) as error:
            raise InputError(
                f"method {self.name} does not take what a solver is given, (A, wanted, *, x0, bounds, iterations, "
                f"callback, state): {error}"
            ) from error

    @classmethod
    def named(cls, name: str) -> Method:
        """A method of which nothing but the name is known: it may be told, and not used."""

        def refuse(*_: object, **__: object) -> Result:
            raise InputError(f"method {name} is known by its name only: name it where it is to be used")

        return cls(refuse, name, chooses_lamps=True, takes_sums=True)


def _name_of(function: object) -> str:
    module, name = (getattr(function, each, None) for each in ("__module__", "__qualname__"))
    return f"{module}:{name or type(function).__qualname__}"
