"""What `carve` does: a brush and rays as they are said, a finished shape with less in it, and what that casts still."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from lightcube import io
from lightcube.errors import InputError
from lightcube.optics.arrays import Flags, locked
from lightcube.solids.carving import Carving, carve
from lightcube.solids.certificate import Certificate, cast_mesh
from lightcube.solids.filling import held_by
from lightcube.solids.mesh import Mesh
from lightcube.solids.reach import count_pieces
from lightcube.solids.shape import Shape
from lightcube.solids.silhouettes import Silhouettes
from lightcube.verbs import hulls
from lightcube.wording import counted

#: What a shape can be put back to.
Undo = Literal["hull"]
_NUMPY = ".npy"


@dataclass(frozen=True)
class Carved:
    """A shape before and after, and the brush's voxels, where there was one."""

    given: Shape
    shape: Shape
    brush: Flags | None

    @property
    def facts(self) -> dict[str, Any]:
        """What was taken, for JSON."""
        before, after = self.given.inside, self.shape.inside
        return {
            "voxels_before": int(np.count_nonzero(before)),
            "voxels": int(np.count_nonzero(after)),
            "voxels_taken": int(np.count_nonzero(before & ~after)),
            "voxels_given_back": int(np.count_nonzero(after & ~before)),
            "brush": None if self.brush is None else int(np.count_nonzero(self.brush & before)),
            "volume_before_mm3": self.given.mesh.volume_mm3,
            "volume_mm3": self.shape.mesh.volume_mm3,
            "pieces_before": count_pieces(before),
            "pieces": count_pieces(after),
        }

    @property
    def lines(self) -> list[str]:
        """The same for people."""
        before, after = self.given.mesh.volume_mm3, self.shape.mesh.volume_mm3
        said = [f"{after / 1000:.3g} cm³ are left of {before / 1000:.3g}"]
        if self.brush is not None and not np.any(self.brush & self.given.inside):
            said.append("nothing of the shape is under the brush: lay it over the shape, which stands on z = 0")
        elif np.array_equal(self.given.field, self.shape.field):
            said.append("nothing there can go while all shadows stay and nothing falls apart: it is as it was")
        return said


def carved(
    path: str,
    how: Carving,
    *,
    wall_mm: float,
    drain_mm: float,
    deep: int,
    where: str | None,
    rays: Sequence[str],
    undo: Undo | None,
) -> Carved:
    """A shape of a file after its material was taken out."""
    shape = io.read_shape(path)
    brush = None if where is None else _brush(where, shape)
    pixels = [_pixel(text, shape) for text in rays]
    made = carve(
        shape, how, wall_mm=wall_mm, drain_mm=drain_mm, deep=deep, where=brush, rays=pixels, anew=undo is not None
    )
    provenance = {**shape.provenance, "command": "carve", "carving": how}
    return Carved(shape, replace(made, provenance=provenance), brush)


def certified(output: str, done: Carved) -> tuple[Certificate, Certificate]:
    """What the mesh of a file that was written casts, beside the silhouettes, and beside what was cast before."""
    before = Silhouettes(locked(cast_mesh(done.given.mesh, done.given.rig)), done.given.rig, done.given.names)
    return hulls.certificate(output, done.shape), hulls.certificate(output, replace(done.shape, silhouettes=before))


def _brush(path: str, shape: Shape) -> Flags:
    """The voxels under a brush: numbers for each voxel, or a mesh that lies over the shape as it stands on z = 0."""
    if path.lower().endswith(_NUMPY):
        return io.read_mask(path)
    low = float(shape.mesh.vertices_mm[:, 2].min())
    mesh = io.read_solid(path)
    try:
        return held_by(Mesh(locked(mesh.vertices_mm + np.array([0.0, 0.0, low])), mesh.faces), shape.grid)
    except InputError as error:
        raise InputError(f"--where {path}: {error}") from error


def _pixel(text: str, shape: Shape) -> tuple[int, int, int]:
    """Picture, row and column of a text VIEW,ROW,COLUMN; a view is said by its name, or its number from 1."""
    said = text.rsplit(",", 2)
    places = [part.strip() for part in said[1:]]
    if len(said) != 3 or not all(part.isascii() and part.isdigit() and len(part) < 10 for part in places):
        raise InputError(f"--ray {text}: give a picture, a row and a column from 0, such as {shape.names[0]},12,34")
    name = said[0].strip()
    if name in shape.names:
        return shape.names.index(name), int(places[0]), int(places[1])
    if name.isascii() and name.isdigit() and len(name) < 10 and 0 < int(name) <= len(shape.names):
        return int(name) - 1, int(places[0]), int(places[1])
    known = ", ".join(shape.names)
    raise InputError(f"--ray {text}: there is no picture {name}: name one of {known}, or 1 to {len(shape.names)}")


def words(done: Carved, found: Certificate, kept: Certificate) -> list[str]:
    """What was done and what the file casts, for people."""
    same = f"{kept.overlap.mean():.2%}, the worst by {kept.overlap.min():.2%}"
    pieces = counted(count_pieces(done.shape.inside), "piece")
    closed = "watertight" if done.shape.mesh.is_watertight else counted(done.shape.mesh.bad_edges, "bad edge")
    cast = f"shadows of the file overlap those of before by {same}, and its silhouettes by {found.overlap.mean():.2%}"
    return [*done.lines, f"{pieces}, {closed}; {cast}"]
