"""What is said of silhouettes before they become a solid, and of the solid and its file."""

import numpy as np

from lightcube.optics.arrays import Counts
from lightcube.optics.rig import Rig
from lightcube.solids.certificate import Certificate
from lightcube.solids.cutting import plain_ground
from lightcube.solids.likeness import is_along_one_axis, pairs
from lightcube.solids.printing import Thin, stands, thin_places
from lightcube.solids.shape import Shape
from lightcube.solids.walls import WALLS
from lightcube.verbs.hulls import Wanted
from lightcube.wording import counted

#: Pictures stretched by less than this part are not worth a word.
_STRETCHED = 0.005
#: Parts of pictures that are worth a word: near the threshold, in strokes that are too thin.
_MANY_NEAR, _MANY_THIN = 0.02, 0.01
#: So much of a volume that no ball of a wall's width reaches is edges.
_EDGES = 0.005
#: Pictures along the same lines agree where they share so much: edges are of less than a pixel.
_ALIKE = 0.95


def doubts(wanted: Wanted) -> list[str]:
    """What may be wrong with the pictures, a sentence each."""
    said = []
    for name, one, thin in zip(wanted.silhouettes.names, wanted.cuts, wanted.thin, strict=True):
        if not plain_ground(one):
            other = "leave out --invert" if one.by == "light" else "--invert takes the other"
            said.append(f"{name}: its shape covers {one.border:.0%} of its border, so it may be the ground: {other}")
        elif one.border:
            said.append(f"{name}: its shape touches the border of its picture, and may be cut off there")
        if one.near > _MANY_NEAR:
            said.append(
                f"{name}: {one.near:.0%} of its pixels lie near the threshold of {one.threshold:.2f}: edges are soft"
            )
        if one.specks:
            said.append(f"{name}: {counted(one.specks, 'speck')} removed")
        if thin > _MANY_THIN:
            said.append(f"{name}: {thin:.0%} of its shape is thinner than two voxels, and may be lost: take more (--n)")
    return [*said, *_emptied(wanted), *_alike(wanted)]


def _alike(wanted: Wanted) -> list[str]:
    """Pictures that are seen along the same lines and are not what each other asks for, or all along one."""
    given = wanted.silhouettes
    said = []
    for pair in pairs(given, wanted.grid):
        if pair.overlap < _ALIKE:
            one, other = given.names[pair.first], given.names[pair.second]
            side, must = ("opposite sides", "mirror images") if pair.is_opposite else ("the same side", "alike")
            said.append(
                f"{one} and {other} are seen from {side}, and must be {must}, but share {pair.overlap:.0%}: "
                "give one of them another side, or leave it out"
            )
    if is_along_one_axis(given):
        said.append(
            "all pictures are seen along one line, and none says how deep the object is, so it fills the block: "
            "add one from another side"
        )
    return said


def _emptied(wanted: Wanted) -> list[str]:
    """Pictures that wipe out rows of others: those in which a height is empty at which others have something."""
    given, heights = wanted.silhouettes, _heights(wanted.silhouettes.rig)
    if heights is None or len(heights) < 2:
        return []
    held = np.asarray(given.pixels()[heights].any(axis=2))
    said = []
    for number, own in zip(heights, held, strict=True):
        wiped = float(np.mean(held.any(axis=0) & ~own) / max(np.mean(held.any(axis=0)), 1e-9))
        if wiped > _MANY_THIN:
            said.append(
                f"{given.names[number]}: it is empty over {wiped:.0%} of the height that others fill, "
                "and nothing can stand there: make shapes as high as each other"
            )
    return said


def _heights(rig: Rig) -> Counts | None:
    """The pictures whose rows are heights, under level light on upright screens; None where their rows differ."""
    views = rig.views
    level = (views.lamps[:, 3] == 0) & (np.abs(views.lamps[:, 2]) < 1e-9)
    upright = np.all(np.abs(views.row_steps_mm[:, :2]) < 1e-9, axis=1)
    (chosen,) = np.nonzero(level & upright)
    places = np.column_stack([views.row_steps_mm[chosen, 2], views.origins_mm[chosen, 2]])
    return chosen if len(chosen) and np.allclose(places, places[0]) else None


def in_short(wanted: Wanted) -> list[str]:
    """How the pictures were read and where they stand, for people."""
    said = []
    for by, words in (("dark", "dark on light"), ("light", "light on dark"), ("opacity", "cut by their transparency")):
        at = [one.threshold for one in wanted.cuts if one.by == by]
        if at:
            bounds = f"{min(at):.2f}" if max(at) - min(at) < 0.005 else f"{min(at):.2f} to {max(at):.2f}"
            said.append(f"{counted(len(at), 'shape')} {words}, threshold {bounds}")
    if wanted.placed:
        said.append(f"placed as {wanted.placed}")
    nz, ny, nx = wanted.grid.shape
    size = " x ".join(f"{length:.4g}" for length in wanted.grid.size_mm)
    said.append(f"block of {nz} x {ny} x {nx} voxels, {size} mm (z, y, x)")
    if wanted.stretched >= _STRETCHED:
        said.append(f"pictures are stretched by {wanted.stretched:.0%} so that they share this block")
    return said


def _promised(shape: Shape) -> str:
    """What a shape's silhouettes are."""
    repair = shape.provenance.get("repair")
    way = repair.get("way") if isinstance(repair, dict) else None
    return {"warp": "the bent pictures", "grow": "the pictures with what was added"}.get(str(way), "what was given")


def thin_of(shape: Shape) -> Thin | None:
    """Where a shape is thinner than the walls that it was made with; None where nobody knows of walls."""
    wall_mm = shape.provenance.get("wall_mm")
    return thin_places(shape, float(wall_mm)) if isinstance(wall_mm, int | float) and wall_mm > 0 else None


def _thin(shape: Shape) -> list[str]:
    """The same in words, where it is more than edges, in mm of the mesh's file."""
    found = thin_of(shape)
    if found is None or found.share <= _EDGES or not found.places_mm:
        return []
    low = float(shape.mesh.vertices_mm[:, 2].min())
    places = ", ".join(f"({x:.3g}, {y:.3g}, {z - low:.3g})" for (x, y, z), _ in found.places_mm)
    wall_mm = shape.provenance["wall_mm"]
    return [f"{found.share:.1%} of it is thinner than {wall_mm:g} mm, most of that around {places} mm: look there"]


def results(shape: Shape, found: Certificate, pieces: int) -> list[str]:
    """What a hull is and what its file casts, for people."""
    mesh = shape.mesh
    x, y, z = mesh.size_mm
    closed = "watertight" if mesh.is_watertight else f"{counted(mesh.bad_edges, 'bad edge')}"
    size = f"{x:.4g} x {y:.4g} x {z:.4g} mm, {mesh.volume_mm3 / 1000:.3g} cm³"
    overlap = f"{found.overlap.mean():.2%}, the worst by {found.overlap.min():.2%}"
    said = [
        f"{size}, {counted(len(mesh), 'face')}, {closed}, {counted(pieces, 'piece')}",
        f"shadows of the file overlap {_promised(shape)} by {overlap}",
    ]
    said += _thin(shape)
    if not stands(mesh):
        said.append("it tips over where it stands: lay it down, or glue it to a foot that no lamp sees")
    worst = int(np.argmax(found.missing))
    if found.missing[worst] > 0.005:
        better = ", and which placement is better" if shape.rig.screens.names == WALLS else ""
        said.append(
            f"no object casts {found.missing[worst]:.1%} of {shape.names[worst]} while it keeps to the others: "
            f"lightcube check --opaque says where and why{better}"
        )
    return said
