"""A closed surface of triangles, as it is printed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Integers, Reals, keep, locked
from lightcube.optics.checks import check_fields
from lightcube.wording import counted

#: No corner is further from the origin, mm.
_FURTHEST_MM = 1e9


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles around a solid, their corners counter-clockwise as seen from outside.

    Parameters
    ----------
    vertices_mm
        ``(vertices, 3)``: x, y, z in mm, z up.
    faces
        ``(faces, 3)``: three different vertices each, by their numbers.

    Raises
    ------
    InputError
        Where there is no face, a number is not finite, or a face names a vertex that is not there, or one twice.

    Examples
    --------
    >>> import lightcube as lc
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> wedge = lc.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> wedge
    <mesh of 4 faces, watertight, 1 x 1 x 1 mm>
    >>> round(wedge.volume_mm3, 6)
    0.166667
    """

    vertices_mm: Reals
    faces: Integers

    def __post_init__(self) -> None:
        check_fields(self)
        keep(self, vertices_mm=np.float64, faces=np.int64)
        for name, array in (("vertices_mm", self.vertices_mm), ("faces", self.faces)):
            if array.ndim != 2 or array.shape[1] != 3 or not len(array):
                raise InputError(f"{name} of a mesh must be numbers of shape (count, 3), not {array.shape}")
        if not np.all(np.abs(self.vertices_mm) <= _FURTHEST_MM):  # NaN neither
            raise InputError(f"a mesh holds vertices that are not finite or beyond {_FURTHEST_MM:g} mm: mend it")
        if self.faces.min() < 0 or self.faces.max() >= len(self.vertices_mm):
            raise InputError(f"faces of a mesh name vertices that are not among its {len(self.vertices_mm)}: mend it")
        if np.any(self.faces == np.roll(self.faces, 1, axis=1)):
            raise InputError("a face of a mesh names a vertex twice: leave it out")

    @classmethod
    def of_triangles(cls, triangles: Reals) -> Mesh:
        """Triangles ``(count, 3, 3)`` whose corners at the very same place are one vertex."""
        vertices, numbers = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
        return cls(locked(vertices), locked(numbers.reshape(-1, 3).astype(np.int64)))

    def __len__(self) -> int:
        return len(self.faces)

    def __repr__(self) -> str:
        closed = "watertight" if self.is_watertight else "open"
        size = " x ".join(f"{length:.4g}" for length in self.size_mm)
        return f"<mesh of {counted(len(self), 'face')}, {closed}, {size} mm>"

    @property
    def triangles(self) -> Reals:
        """``(faces, 3, 3)``: the corners of each face."""
        return np.asarray(self.vertices_mm[self.faces])

    @property
    def size_mm(self) -> tuple[float, float, float]:
        """Lengths along x, y and z."""
        x, y, z = np.ptp(self.vertices_mm, axis=0).tolist()
        return x, y, z

    @cached_property
    def volume_mm3(self) -> float:
        """What it holds; negative where it is inside out."""
        a, b, c = (self.vertices_mm - self.vertices_mm[0])[self.faces.T]
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)

    @cached_property
    def bad_edges(self) -> int:
        """How many edges are not run through just once in each direction: 0 where the mesh is closed."""
        tail, head = self.faces.ravel(), np.roll(self.faces, -1, axis=1).ravel()
        count = len(self.vertices_mm)
        edges, times = np.unique(np.minimum(tail, head) * count + np.maximum(tail, head), return_inverse=True)
        forth, back = (np.bincount(times[way], minlength=len(edges)) for way in (tail < head, tail > head))
        return int(np.count_nonzero((forth != 1) | (back != 1)))

    @property
    def is_watertight(self) -> bool:
        """Whether every edge is shared by just two faces, which run through it in opposite directions."""
        return self.bad_edges == 0

    def standing(self) -> Mesh:
        """The same moved up or down to stand on z = 0."""
        down = np.array([0.0, 0.0, self.vertices_mm[:, 2].min()])
        return Mesh(locked(self.vertices_mm - down), self.faces)
