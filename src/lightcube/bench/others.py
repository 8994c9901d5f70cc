"""The same pass by others, one thread each, on a slice of the work."""

import warnings
from collections.abc import Callable
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from lightcube.bench.clock import seconds
from lightcube.bench.products import columns_of, traced
from lightcube.projection.projector import Projector

#: Columns of a block, the number that served the sparse matrices best.
BLOCK = 16
Times = tuple[dict[str, float], dict[str, float]]


def peers(matrix: Projector, ours: float, repeats: int, say: Callable[[str], None]) -> list[dict[str, Any]]:
    """Seconds of a pass by each peer, extrapolated from its slice, and how many times `ours` that is.

    `ours` are the seconds of one pass of `matrix`, level, with one thread. A peer that is not installed has none.
    """
    columns = columns_of(matrix)
    found = []
    for name, package, measured, part, run in _PEERS:
        say(f"peer: {name}")
        peer: dict[str, Any] = {"name": name, "package": package, "measured": measured, "parts": columns / part}
        try:
            there, back = run(matrix, repeats)
        except ImportError:
            found.append({**peer, "version": None})
            continue
        took = {key: (there[key] + back[key]) * columns / part for key in there}
        one_way = {"forward": there["seconds"] * columns / part, "adjoint": back["seconds"] * columns / part}
        found.append({**peer, "version": version(package), **one_way, **took, "ratio": took["seconds"] / ours})
    return found


def _warm(work: Callable[[], object], repeats: int) -> dict[str, float]:
    work()
    return seconds(work, repeats)


def _sparse(matrix: Projector) -> csr_array:
    offsets, voxels, _, lengths = traced(matrix)
    return csr_array((lengths, voxels, offsets.astype(np.int32)), shape=matrix.shape)


def _block(rows: int) -> NDArray[np.float32]:
    return np.random.default_rng(0).random((rows, BLOCK), dtype=np.float32)


def _scipy(matrix: Projector, repeats: int) -> Times:
    a = _sparse(matrix)
    x, b = _block(a.shape[1]), _block(a.shape[0])
    return _warm(lambda: a @ x, repeats), _warm(lambda: a.T @ b, repeats)


def _torch(matrix: Projector, repeats: int) -> Times:
    import torch

    def tensor(sparse: csr_array) -> Any:
        ends, indices, data = (torch.from_numpy(part) for part in (sparse.indptr, sparse.indices, sparse.data))
        return torch.sparse_csr_tensor(ends, indices, data, sparse.shape)

    a = _sparse(matrix)
    x, b = torch.from_numpy(_block(a.shape[1])), torch.from_numpy(_block(a.shape[0]))
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that sparse tensors are young
            forward, adjoint = tensor(a), tensor(a.T.tocsr())
        return _warm(lambda: forward @ x, repeats), _warm(lambda: adjoint @ b, repeats)
    finally:
        torch.set_num_threads(before)


def _astra(matrix: Projector, repeats: int) -> Times:
    import astra

    _, ny, nx = matrix.grid.shape
    volume = astra.create_vol_geom(ny, nx)
    screen = astra.create_proj_geom(
        "parallel", 1.0, matrix.views.picture_shape[1], np.radians(np.sort(matrix.views.angles_deg))
    )
    try:
        line = astra.create_projector("line", screen, volume)
        x = astra.data2d.create("-vol", volume, 1.0)
        b = astra.data2d.create("-sino", screen, 1.0)
        times = []
        for kind, to in (("FP", "VolumeDataId"), ("BP", "ReconstructionDataId")):
            settings = astra.astra_dict(kind)
            settings.update({"ProjectorId": line, "ProjectionDataId": b, to: x})
            algorithm = astra.algorithm.create(settings)
            times.append(_warm(lambda: astra.algorithm.run(algorithm), repeats))  # noqa: B023
        return times[0], times[1]
    finally:
        astra.clear()


#: Name, package, what is measured, how many columns that are, and how.
_PEERS: list[tuple[str, str, str, int, Callable[[Projector, int], Times]]] = [
    ("scipy CSR @ dense", "scipy", f"one block of {BLOCK} columns", BLOCK, _scipy),
    ("torch CSR @ dense", "torch", f"one block of {BLOCK} columns, transposed matrix at hand", BLOCK, _torch),
    ("ASTRA line projector", "astra-toolbox", "one slice of one colour", 1, _astra),
]
