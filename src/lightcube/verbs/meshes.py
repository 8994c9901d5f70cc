"""What `score` finds of a mesh by itself: what it casts beside silhouettes, wherever it was moved, and what it is."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from lightcube import io
from lightcube.errors import InputError
from lightcube.optics.arrays import Reals, locked
from lightcube.optics.grid import Grid
from lightcube.solids.certificate import Certificate, certify
from lightcube.solids.field import hull_field
from lightcube.solids.mesh import Mesh
from lightcube.solids.printing import stands
from lightcube.solids.silhouettes import Silhouettes
from lightcube.solids.surface import surface
from lightcube.verbs import hulls
from lightcube.verbs.options import Options
from lightcube.wording import counted

#: A mirrored copy overlaps by so much more, at least; a mesh that is scaled by less is as large as it is.
_BETTER, _AS_LARGE = 0.01, 0.002


@dataclass(frozen=True)
class MeshScore:
    """A mesh beside silhouettes.

    Parameters
    ----------
    mesh
        As it was read.
    names
        Of the silhouettes.
    found
        What it casts where it fits best.
    scale, moved_mm
        How it was scaled for that, and then moved.
    mirrored
        What its mirror image casts where that fits best.
    """

    mesh: Mesh
    names: tuple[str, ...]
    found: Certificate
    scale: float
    moved_mm: Reals
    mirrored: Certificate

    @property
    def is_mirrored(self) -> bool:
        """Whether its mirror image casts the silhouettes better."""
        return float(self.mirrored.overlap.mean()) > float(self.found.overlap.mean()) + _BETTER

    @property
    def facts(self) -> dict[str, Any]:
        """All of it, for JSON."""
        return {
            "pieces": bodies(self.mesh),
            "watertight": self.mesh.is_watertight,
            "bad_edges": self.mesh.bad_edges,
            "volume_mm3": self.mesh.volume_mm3,
            "size_mm": list(self.mesh.size_mm),
            "stands": stands(self.mesh),
            "scaled": self.scale,
            "moved_mm": self.moved_mm.tolist(),
            "mirrored": self.is_mirrored,
            "mirrored_overlap_mean": float(self.mirrored.overlap.mean()),
            "names": list(self.names),
            **self.found.facts,
        }

    @property
    def lines(self) -> list[str]:
        """The same for people."""
        x, y, z = self.mesh.size_mm
        edges = "watertight" if self.mesh.is_watertight else counted(self.mesh.bad_edges, "bad edge")
        volume = f", {self.mesh.volume_mm3 / 1000:.3g} cm³" if self.mesh.is_watertight else ""
        said = [f"{x:.4g} x {y:.4g} x {z:.4g} mm{volume}, {edges}, {counted(bodies(self.mesh), 'piece')}"]
        if abs(self.scale - 1) > _AS_LARGE:
            said.append(f"it is moved, and scaled by {self.scale:.3g}, to where it fits the silhouettes best")
        for number, name in enumerate(self.names):
            overlap, missing, beyond = (
                float(each[number]) for each in (self.found.overlap, self.found.missing, self.found.beyond)
            )
            said.append(f"{name}: overlap {overlap:.1%}; {missing:.1%} not cast, {beyond:.1%} cast beside it")
        said.append(f"overlap {self.found.overlap.mean():.2%}, the worst {self.found.overlap.min():.2%}")
        if self.is_mirrored:
            better = f"{self.mirrored.overlap.mean():.1%}"
            said.append(f"it is a mirrored copy, and its mirror image overlaps by {better}: mirror the mesh")
        return said


def read(sources: Sequence[str], options: Options, how: hulls.Cutting) -> tuple[Silhouettes, Grid]:
    """The silhouettes that a mesh is held beside, and their block: those of a shape, or of pictures as `hull` reads."""
    if any(io.is_shape(source) for source in sources):
        if len(sources) > 1 or how != hulls.Cutting():
            raise InputError(f"{sources[0]} is a shape, which says all there is: leave out all else")
        shape = io.read_shape(sources[0])
        return shape.silhouettes, shape.grid
    wanted = hulls.read(sources, options, how)
    return wanted.silhouettes, wanted.grid


def score(path: str, silhouettes: Silhouettes, grid: Grid) -> MeshScore:
    """Hold a mesh's file beside silhouettes, where and as large as it fits them best."""
    mesh = io.read_solid(path)
    field = hull_field(silhouettes, grid)
    box = surface(field, grid).vertices_mm if np.any(field < 0) else np.array([-1, 1])[:, None] * grid.size_mm[::-1] / 2
    found, scale, moved = _best(mesh, box, silhouettes)
    corners = mesh.vertices_mm * (-1.0, 1.0, 1.0)
    mirrored, _, _ = _best(Mesh(locked(corners), locked(mesh.faces[:, ::-1].copy())), box, silhouettes)
    return MeshScore(mesh, silhouettes.names, found, scale, moved, mirrored)


def _best(mesh: Mesh, box: Reals, silhouettes: Silhouettes) -> tuple[Certificate, float, Reals]:
    """What a mesh casts where it fits best, its scale and its way there."""
    tried = []
    for scale, moved in _places(mesh, box):
        placed = Mesh(locked(scale * mesh.vertices_mm + moved), mesh.faces)
        tried.append((certify(placed, silhouettes), scale, moved))
    return max(tried, key=lambda each: float(each[0].overlap.mean()))


def _places(mesh: Mesh, box: Reals) -> Iterator[tuple[float, Reals]]:
    """Where a mesh may stand: as its file says, but as high as the hull; in the hull's middle; and as large too."""
    low, high = mesh.vertices_mm.min(axis=0), mesh.vertices_mm.max(axis=0)
    least, most = box.min(axis=0), box.max(axis=0)
    yield 1.0, np.array([0.0, 0.0, least[2] - low[2]])
    yield 1.0, (least + most - low - high) / 2
    scale = float(np.linalg.norm(most - least) / np.linalg.norm(high - low))
    yield scale, (least + most - scale * (low + high)) / 2


def bodies(mesh: Mesh) -> int:
    """How many pieces a mesh has: surfaces that share no corner, without those that bound a cavity."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(mesh.vertices_mm)
    pairs = np.concatenate([mesh.faces[:, (0, 1)], mesh.faces[:, (1, 2)]])
    joined = coo_array((np.ones(len(pairs), np.int8), (pairs[:, 0], pairs[:, 1])), (count, count))
    number, labels = connected_components(joined, directed=False)
    a, b, c = mesh.vertices_mm[mesh.faces.T]
    volumes = np.bincount(labels[mesh.faces[:, 0]], np.einsum("ij,ij->i", a, np.cross(b, c)), number)
    faces = np.bincount(labels[mesh.faces[:, 0]], minlength=number)
    return int(np.count_nonzero((volumes > 0) & (faces > 0))) or 1
