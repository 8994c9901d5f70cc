"""Time a pass (forward + adjoint) of the projector against scipy's sparse matrix in the same run.

    python benchmarks/passes.py [n ...]

Prints, for n views of an n-cube in RGB at elevations 0 and 35: seconds per pass, multiply-adds per second, and at
elevation 0 the ratio to scipy's CSR product over blocks of 16 columns on one thread.
"""

import sys
import time
from collections.abc import Callable

import numpy as np

from lightcube.geometry import Grid, spread_angles, turntable
from lightcube.projector import Projector


def best_of(work: Callable[[], object], repeats: int = 3) -> float:
    work()
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        work()
        times.append(time.perf_counter() - began)
    return min(times)


def scipy_pass(matrix: Projector, x: np.ndarray) -> float:
    sparse = matrix.to_sparse().astype(np.float32)
    block = np.ascontiguousarray(x[:, :16])
    b = sparse @ block
    one_block = best_of(lambda: sparse @ block) + best_of(lambda: sparse.T @ b)
    return one_block * x.shape[1] / 16


def main() -> None:
    for n in [int(argument) for argument in sys.argv[1:]] or [64, 128]:
        for elevation in (0.0, 35.0):
            grid = Grid((n, n, n))
            views = turntable(grid, spread_angles(n, elevation=elevation), elevation=elevation)
            matrix = Projector(grid, views)
            columns = 3 * n * n * n // matrix.shape[1]
            x = np.random.default_rng(0).random((matrix.shape[1], columns)).astype(np.float32)
            b = matrix.forward(x)
            there, back = best_of(lambda: matrix.forward(x)), best_of(lambda: matrix.adjoint(b))  # noqa: B023
            line = f"n = {n}, {elevation:.0f} degrees: forward {there:.3f} s, adjoint {back:.3f} s"
            line += f", pass {there + back:.3f} s"
            if elevation == 0:
                products = matrix.to_sparse().nnz * x.shape[1]
                line += f", {2 * products / (there + back) / 1e9:.2f} G multiply-adds/s"
                line += f", {scipy_pass(matrix, x) / (there + back):.1f} x faster than scipy CSR (1 thread)"
            print(line)


if __name__ == "__main__":
    main()
