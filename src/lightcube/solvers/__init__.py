"""Methods for the backward computation, all on the one signature of `lightcube.solvers.contract.Solver`."""

from collections.abc import Mapping
from types import MappingProxyType

from lightcube.solvers.cgls import cgls
from lightcube.solvers.contract import Solver
from lightcube.solvers.display import display_values
from lightcube.solvers.gauss_seidel import gauss_seidel
from lightcube.solvers.row_reduction import row_reduction
from lightcube.solvers.sirt import sirt

#: Every method by its name on the command line.
METHODS: Mapping[str, Solver] = MappingProxyType(
    {
        "display": display_values,
        "gauss-seidel": gauss_seidel,
        "row-reduction": row_reduction,
        "sirt": sirt,
        "cgls": cgls,
    }
)
