"""What `hull` does: from pictures or a stage to silhouettes, and what a shape's file casts."""

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import PurePath
from typing import Any, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from lightcube import io
from lightcube.errors import InputError
from lightcube.optics.arrays import Flags, Images, locked
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.optics.transfer import Transfer, encode
from lightcube.pictures.fitting import Fit, fill
from lightcube.pictures.pictures import Pictures
from lightcube.solids.certificate import Certificate, certify
from lightcube.solids.cutting import Cut, cut
from lightcube.solids.mesh import Mesh
from lightcube.solids.placement import Placement, best, placements
from lightcube.solids.reach import thin_part
from lightcube.solids.shape import Shape
from lightcube.solids.silhouettes import FINE, Silhouettes
from lightcube.solids.standing import held, silhouettes
from lightcube.solids.walls import WALLS, block, walls
from lightcube.verbs import solving
from lightcube.verbs.options import Options
from lightcube.wording import counted

#: Bytes that a voxel takes at most (measured at 160 voxels: field, pieces, distances to the surface, the mesh and its
#: file), and a small pixel of a silhouette: silhouettes and their distances.
_VOXEL_BYTES, _SMALL_BYTES = 48, 4
#: Around shapes on three walls is so much room on either side, in parts of the longest side.
_ROOM = 0.08
#: Whether pictures stand on three walls as they are given, or as least of them is lost.
Place = Literal["given", "best"]
#: Whatever reading gives.
Read = TypeVar("Read")


@dataclass(frozen=True)
class Cutting:
    """How shapes are cut out of pictures, as `lightcube.cut` takes it, and if they stand on walls or are fitted.

    `keep` names pictures that are not to be bent, or ``NAME=MASK``, a picture that is light where it is not to be.
    """

    threshold: float | None = None
    invert: bool | None = None
    is_walls: bool = False
    fit: Fit | None = None
    placement: Place = "given"
    keep: Sequence[str] = ()


@dataclass(frozen=True)
class Wanted:
    """What a shape is to cast.

    Parameters
    ----------
    silhouettes, grid
        On their rig, and the block.
    cuts
        What they were made of, one each.
    stretched
        By which part pictures on three walls were stretched, at most.
    placed
        Which picture stands on which of three walls, in words, where that was chosen.
    held
        ``(picture, row, column)``: what is to stay where it is when pictures are bent; None = nothing.
    """

    silhouettes: Silhouettes
    grid: Grid
    cuts: tuple[Cut, ...]
    stretched: float = 0.0
    placed: str = ""
    held: Flags | None = None

    @property
    def facts(self) -> dict[str, Any]:
        """What was read, for JSON."""
        return {
            "pictures": [
                {
                    "name": name,
                    "by": one.by,
                    "threshold": one.threshold,
                    "near": one.near,
                    "specks": one.specks,
                    "border": one.border,
                    "thin": thin,
                }
                for name, one, thin in zip(self.silhouettes.names, self.cuts, self.thin, strict=True)
            ],
            "voxels": list(self.grid.shape),
            "size_mm": list(self.grid.size_mm),
            "stretched": self.stretched,
        }

    @property
    def thin(self) -> list[float]:
        """Which part of each silhouette is thinner than two voxels."""
        return thin_part(self.silhouettes, self.grid).tolist()


def read(sources: Sequence[str], options: Options, how: Cutting) -> Wanted:
    """Read pictures, cut them out, and put them where they are cast; `InputError` for all that cannot be."""
    stages = [source for source in sources if io.is_stage(source)]
    given = {"other pictures": len(sources) > 1, "--walls": how.is_walls, "--fit": how.fit is not None}
    if stages and any(given.values()):
        other = next(name for name, is_given in given.items() if is_given)
        raise InputError(f"{stages[0]} is a stage, which says all there is: leave out {other}")
    if stages:
        return _of_stage(stages[0], options, how)
    pictures = _pictures(sources, options)
    cuts = _kept(cut(pictures, threshold=how.threshold, invert=how.invert), how.keep)
    if how.is_walls and how.fit is not None:
        raise InputError("--fit is for a turntable, and pictures for --walls are stretched to a block: leave out --fit")
    if how.placement != "given" and not how.is_walls:
        raise InputError("--placement is for three walls: leave it out, or say --walls")
    return (
        _on_walls(cuts, options, how.placement)
        if how.is_walls
        else _on_turntable(pictures, cuts, options, how.fit or "pad")
    )


def _of_stage(source: str, options: Options, how: Cutting) -> Wanted:
    """The silhouettes of a stage file."""
    solving.refuse_beside_stage(source, options)
    stage, pictures, ways = _on_white(lambda: io.read_stage(source, transfer=options.transfer))
    cuts = _kept(cut(pictures, threshold=how.threshold, invert=how.invert), how.keep)
    return _standing(cuts, stage.rig(), stage.grid, ways)


def _kept(cuts: tuple[Cut, ...], keep: Sequence[str]) -> tuple[Cut, ...]:
    """Shapes with what is to be kept of each: all of those that are named, of others what is light in a mask."""
    kept: dict[str, Images] = {}
    by_name = {one.name: one for one in cuts}
    for said in keep:
        name, _, mask = (said, "", "") if said in by_name else said.partition("=")
        if name not in by_name:
            raise InputError(f"--keep {said}: there is no such picture: name one of {', '.join(by_name)}")
        of = by_name[name].coverage.shape
        found = _mask(mask, of) if mask else np.ones(of, np.float32)
        kept[name] = np.maximum(kept[name], found) if name in kept else found
    return tuple(replace(one, kept=locked(kept[one.name])) if one.name in kept else one for one in cuts)


def _mask(path: str, of: tuple[int, ...]) -> NDArray[np.float32]:
    """How light each pixel of a mask is, in display values, 0 where it is transparent; made as large as its picture."""
    read = _read_one(path, "srgb")
    if len(read) != 1:
        raise InputError(f"--keep: {path} holds {counted(len(read), 'picture')}: give one mask")
    (image,), (rows, columns) = read.images, of
    own = image.shape[:2]
    if abs(own[0] * columns - own[1] * rows) > max(own[0], own[1], rows, columns):
        raise InputError(
            f"--keep: {path} has {own[0]} x {own[1]} pixels and its picture {rows} x {columns}: give a mask in its "
            "proportions"
        )
    grey = encode(np.clip(image, 0, 1), "srgb").mean(axis=2)
    grey *= 1 if read.opacities is None or read.opacities[0] is None else read.opacities[0]
    area = np.zeros((rows, columns, 1), np.float32)
    fill(
        area,
        np.zeros((rows, columns), np.float32),
        np.ascontiguousarray(grey[..., None], np.float32),
        "stretch",
        (0.5, 0.5),
    )
    return area[..., 0]


def _on_turntable(pictures: Pictures, cuts: tuple[Cut, ...], options: Options, fit: Fit) -> Wanted:
    """Silhouettes on a turntable, in a block of the first picture's proportions."""
    n = max(options.voxels)
    rows, columns = cuts[0].coverage.shape
    wide, high = max(1, round(n * min(1.0, columns / rows))), max(1, round(n * min(1.0, rows / columns)))
    grid = Grid((high, wide, wide), options.longest_mm / n)
    return _standing(cuts, options.turntable.rig(pictures, grid), grid, fit)


def _on_walls(cuts: tuple[Cut, ...], options: Options, placement: Place) -> Wanted:
    """Silhouettes on three walls, trimmed to their shapes, in the block that they fill."""
    said = (options.angles_deg, options.span_deg, options.elevation_deg)
    for option, value in zip(("--angles-deg", "--span-deg", "--elevation-deg"), said, strict=True):
        if value is not None:
            raise InputError(
                f"{option} is for a turntable, and --walls are front, side and top: leave out one of the two"
            )
    names = [one.name.lower() for one in cuts]
    if sorted(names) == sorted(WALLS):
        cuts = tuple(cuts[names.index(name)] for name in WALLS)
    placed = ""
    if placement == "best":
        top = best(placements(cuts))
        placed, cuts = on_which_wall(top, cuts), top.of(cuts)
    grid, stretched = block(cuts, max(options.voxels), options.longest_mm)
    made = _with_room(_standing([one.trimmed() for one in cuts], walls(grid).rig(), grid, "stretch"))
    return replace(made, cuts=cuts, stretched=stretched, placed=placed)


def on_which_wall(placed: Placement, cuts: Sequence[Cut]) -> str:
    """Which picture stands on which of three walls, and how the one on top is turned."""
    said = ", ".join(f"{wall} = {cuts[number].name}" for wall, number in zip(WALLS, placed.order, strict=True))
    ways = [" mirrored"] if placed.is_mirrored else []
    if placed.quarters:
        ways.append(("", " turned left by 90°", " turned by 180°", " turned right by 90°")[placed.quarters])
    return said + " and".join(ways)


def _with_room(wanted: Wanted) -> Wanted:
    """The same on three larger walls: there is room around shapes that have to be bent."""
    given, tight = wanted.silhouettes, wanted.grid
    more = math.ceil(_ROOM * tight.longest)
    nz, ny, nx = (count + 2 * more for count in tight.shape)
    grid = Grid((nz, ny, nx), tight.voxel_mm)
    rig = walls(grid).rig()
    rows, columns = (FINE * side for side in rig.picture_shape)
    inside = np.zeros((len(given), rows, columns), np.bool_)
    room = FINE * more
    held = None if wanted.held is None else np.zeros((len(given), *rig.picture_shape), np.bool_)
    for picture, shape, (high, wide) in zip(inside, given.inside, FINE * given.rig.stops.window, strict=True):
        picture[room : room + high, room : room + wide] = shape[:high, :wide]
    if held is not None and wanted.held is not None:
        for picture, kept, (high, wide) in zip(held, wanted.held, given.rig.stops.window, strict=True):
            around = np.pad(kept[:high, :wide], more, mode="edge")
            picture[: around.shape[0], : around.shape[1]] = around
    return Wanted(Silhouettes(locked(inside), rig, given.names), grid, wanted.cuts, held=held)


def _standing(cuts: Sequence[Cut], rig: Rig, grid: Grid, ways: Fit | Sequence[Fit]) -> Wanted:
    """Shapes put onto a rig; `InputError` where that, or the block, does not fit into the memory."""
    small = len(rig) * math.prod(rig.picture_shape) * FINE**2
    solving.check_memory(_VOXEL_BYTES * math.prod(grid.shape) + _SMALL_BYTES * small)
    return Wanted(silhouettes(cuts, rig, ways), grid, tuple(cuts), held=held(cuts, rig, ways))


def _pictures(sources: Sequence[str], options: Options) -> Pictures:
    """All pictures of several places, one behind the other."""
    if len(sources) == 1:
        read = _read_one(sources[0], options.transfer, **solving.part(sources[0], options))
        if len(read) < 2:
            raise InputError(
                f"{sources[0]} holds one picture, and a solid needs two at least, as of its front and its side: "
                "give another"
            )
        return read
    if options.is_of_a_film:
        raise InputError("--most, --every, --from and --to are for one film or animation: give one alone")
    each = [_read_one(source, options.transfer) for source in sources]
    alone = [PurePath(source).stem for source in sources]
    names = [read.names if len(read) > 1 else (one,) for one, read in zip(alone, each, strict=True)]
    return replace(
        each[0],
        images=tuple(image for read in each for image in read.images),
        opacities=tuple(opacity for read in each for opacity in read.opacities),
        names=tuple(name for some in names for name in some),
        angles_deg=None,
        elevation_deg=None,
    )


def _read_one(source: str, transfer: Transfer, **part: Any) -> Pictures:
    """Pictures of one place."""
    return _on_white(lambda: io.read_pictures(source, transfer=transfer, least=1, **part))


def _on_white(read: Callable[[], Read]) -> Read:
    """Read pictures without a word on transparent ones: their opacity is kept, and is what they are cut by."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", io.TransparentPictures)
        return read()


def certificate(output: str, shape: Shape) -> Certificate:
    """What the mesh in a file that was written really casts; it stands, or is where the shape is."""
    mesh = io.written_mesh(output)
    low = shape.mesh.vertices_mm[:, 2].min() - mesh.vertices_mm[:, 2].min()
    return certify(Mesh(locked(mesh.vertices_mm + np.array([0.0, 0.0, low])), mesh.faces), shape.silhouettes)
