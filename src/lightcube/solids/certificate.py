"""What a mesh really casts, triangle by triangle, beside the silhouettes that it was made for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lightcube.optics.arrays import Flags, Reals, keep, locked
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.rig import Rig
from lightcube.solids import projections
from lightcube.solids.mesh import Mesh
from lightcube.solids.silhouettes import FINE, Silhouettes


@dataclass(frozen=True, eq=False)
class Certificate:
    """How far shadows are the silhouettes, by small pixels: `FINE` along each side of a picture's.

    Parameters
    ----------
    overlap
        ``(picture,)``: shared part of what is cast and what was given, of all that is one of the two; 1 = the same.
    missing
        ``(picture,)``: part of the silhouette that is not cast.
    beyond
        ``(picture,)``: what is cast beside the silhouette, as a part of the silhouette.
    """

    overlap: Reals
    missing: Reals
    beyond: Reals

    def __post_init__(self) -> None:
        check_fields(self)
        keep(self, overlap=np.float64, missing=np.float64, beyond=np.float64)

    def __repr__(self) -> str:
        return f"<shadows overlap by {self.overlap.mean():.4f}, worst {self.overlap.min():.4f}>"

    @property
    def facts(self) -> dict[str, object]:
        """The figures by name, for JSON."""
        return {
            "overlap_mean": float(self.overlap.mean()),
            "overlap_min": float(self.overlap.min()),
            "missing_max": float(self.missing.max()),
            "beyond_max": float(self.beyond.max()),
            "overlap": self.overlap.tolist(),
            "missing": self.missing.tolist(),
            "beyond": self.beyond.tolist(),
        }


def cast_mesh(mesh: Mesh, rig: Rig) -> Flags:
    """``(picture, FINE * row, FINE * column)``: the small pixels whose middles the mesh shades."""
    from lightcube.kernels import hull, tasks  # here: the compiler comes with it

    rows, columns = rig.picture_shape
    out = np.zeros((len(rig), FINE * rows, FINE * columns), np.bool_)
    onto = projections.finer(projections.matrices(rig), FINE)
    work = 50 * len(rig) * len(mesh)
    tasks.run(hull.cast_triangles, len(rig), work, mesh.vertices_mm, mesh.faces, onto, out)
    return out


@checked
def certify(mesh: Mesh, silhouettes: Silhouettes) -> Certificate:
    """Cast a mesh, in mm around the block's middle, by its triangles, and compare with the silhouettes, on screens."""
    rig, given = silhouettes.rig, silhouettes.inside
    cast = cast_mesh(mesh, rig) & rig.inside.repeat(FINE, axis=1).repeat(FINE, axis=2)
    shared, wanted = (np.count_nonzero(each, axis=(1, 2)) for each in (cast & given, given))
    either = np.count_nonzero(cast | given, axis=(1, 2))
    return Certificate(locked(shared / either), locked(1 - shared / wanted), locked((either - wanted) / wanted))
