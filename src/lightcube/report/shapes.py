"""The report of an opaque shape: given, cast, and what is wanting; what can be built; walls; what a print takes."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from lightcube.drawing import charts
from lightcube.drawing.blame import COLOURS, blame_maps
from lightcube.drawing.overlay import tile
from lightcube.optics.arrays import Flags, Reals
from lightcube.report.html import element, figure, image, number, pairs, sideways, table, text
from lightcube.report.opening import Heading, headed
from lightcube.report.page import Origin, document, read_files, recorded
from lightcube.report.printed import print_tiles
from lightcube.scoring.wall_shares import wall_shares
from lightcube.solids.certificate import Certificate, cast_mesh, certify
from lightcube.solids.printing import stands, thickest_wall_mm
from lightcube.solids.reach import Reach, count_pieces, reach
from lightcube.solids.shape import Shape
from lightcube.solids.silhouettes import FINE
from lightcube.wording import counted

#: What is measured, one after the other.
_STEPS = 5


@dataclass(frozen=True, eq=False)
class ShapeFindings:
    """All that was measured of a shape.

    Parameters
    ----------
    shape, cast, certificate
        The shape, what its mesh casts, in small pixels, and how far that is what was given.
    reach
        What can be built of its silhouettes.
    pieces, wall_mm, stands
        How many pieces it has, how thick its walls can be, and whether it stands.
    walls
        As `lightcube.scoring.wall_shares.wall_shares`.
    """

    shape: Shape
    cast: Flags
    certificate: Certificate
    reach: Reach
    pieces: int
    wall_mm: float
    stands: bool
    walls: tuple[Reals, Reals]


def measure_shape(shape: Shape, callback: Callable[[int, int], None]) -> ShapeFindings:
    """Measure all that a report says of a shape; `callback` is told how many of how many steps are done."""
    cast = cast_mesh(shape.mesh, shape.rig)
    certificate = certify(shape.mesh, shape.silhouettes)
    callback(1, _STEPS)
    known = reach(shape.silhouettes, shape.grid)
    callback(2, _STEPS)
    wall_mm = thickest_wall_mm(shape)
    callback(3, _STEPS)
    walls = wall_shares(shape)
    callback(4, _STEPS)
    pieces, stood = count_pieces(shape.inside), stands(shape.mesh)
    callback(5, _STEPS)
    return ShapeFindings(shape, cast, certificate, known, pieces, wall_mm, stood, walls)


def shape_page(found: ShapeFindings, heading: Heading, origins: Sequence[Origin]) -> str:
    """The text of a shape's report."""
    parts = {
        "Shadows": _shadows(found),
        "What can be built": _built(found),
        "Walls": _walls(found),
        "The print": _print(found),
        "How it was made": "\n".join([*recorded(found.shape.provenance, "shape"), *read_files(origins)]),
    }
    return document(heading.title, _head(found, heading), parts)


def _head(found: ShapeFindings, heading: Heading) -> str:
    """Title, what it is, and its figures."""
    shape, cast = found.shape, found.certificate
    nz, ny, nx = shape.grid.shape
    lead = (
        f"A solid stands in the light; its shadows are {counted(len(shape.names), 'picture')}. It was carved out of "
        f"{nx} × {ny} × {nz} voxels, and its mesh, cast triangle by triangle, overlaps what it was made for by "
        f"{cast.overlap.mean():.2%}."
    )
    return "\n".join(headed("Shape", heading, lead))


def _shadows(found: ShapeFindings) -> str:
    """Given, cast and difference of each picture, and their figures."""
    note = (
        "Of each picture what was given, what the mesh casts, and both: dark is given and cast, orange given and not "
        "cast, blue cast beside it."
    )
    cards = "".join(_card(found, index) for index in range(len(found.shape.names)))
    rows = [
        (index + 1, name, f"{overlap:.2%}", f"{missing:.2%}", f"{beyond:.2%}")
        for index, (name, overlap, missing, beyond) in enumerate(
            zip(
                found.shape.names,
                found.certificate.overlap,
                found.certificate.missing,
                found.certificate.beyond,
                strict=True,
            )
        )
    ]
    heads = ("no.", "picture", "overlap", "given, not cast", "cast beside it")
    return "\n".join(
        [
            text("p", note, class_="note"),
            element("div", cards, class_="sheet"),
            sideways(table("Every picture", heads, rows, "figures"), "The figures"),
        ]
    )


def _card(found: ShapeFindings, index: int) -> str:
    """Three pictures of one silhouette, side by side."""
    rows, columns = FINE * found.shape.rig.stops.window[index]
    given, cast = (each[index, :rows, :columns] for each in (found.shape.silhouettes.inside, found.cast))
    name = found.shape.names[index]
    three = (("given", given, given), ("cast", cast, cast), ("difference", given, cast))
    drawn = (image(np.asarray(tile(one, other)), f"{what}: {name}") for what, one, other in three)
    caption = f"{index + 1} {text('b', name)} {found.certificate.overlap[index]:.2%}"
    return figure(element("div", "".join(drawn), class_="three"), caption, class_="card")


def _built(found: ShapeFindings) -> str:
    """Maps of what no solid casts of these silhouettes, and pieces."""
    known, names = found.reach, found.shape.names
    cards = "".join(
        figure(
            image(levels, f"what can be cast of {name}"), f"{text('b', name)} {share:.2%} out of reach", class_="card"
        )
        for levels, name, share in zip(blame_maps(known), names, known.shares, strict=True)
    )
    colours = [f"{colour} {name}" for (colour, _), name in zip(COLOURS, names, strict=False)]
    said = (
        "Dark can be cast; in colour is what no solid casts, in that of the picture that is in the way: "
        f"{', '.join(colours)}. The stronger, the deeper."
    )
    gap = "" if known.gap is None else f": silhouettes that were {known.gap:.1f} voxels wider would"
    facts = {
        "Pieces of the shape": found.pieces,
        "One piece of the hull casts all that it does": "yes" if known.is_one_piece else f"no{gap}",
        "Edges not shared by two faces": found.shape.mesh.bad_edges,
    }
    return "\n".join([text("p", said, class_="note"), element("div", cards, class_="sheet"), pairs(facts)])


def _walls(found: ShapeFindings) -> str:
    """How thick walls are."""
    edges, parts = found.walls
    said = (
        f"Which part of the shape has walls of which thickness: at each place that of the largest ball inside that "
        f"reaches it. Walls may be {found.wall_mm:.2g} mm thick everywhere and lose half a per cent of the shadows."
    )
    drawn = charts.shares(edges, 100 * parts, ("thickness, mm", "part of the volume, %"), said)
    return figure(sideways(drawn, "Thickness of walls"), escape(said))


def _print(found: ShapeFindings) -> str:
    """What a print takes, and whether it stands."""
    return "\n".join([print_tiles(found.shape.mesh.volume_mm3, found.shape.mesh.size_mm), *_standing(found)])


def _standing(found: ShapeFindings) -> Iterator[str]:
    """Whether it stands by itself."""
    voxel = number(found.shape.grid.voxel_mm, 3)
    yield text("p", f"Voxels are {voxel} mm wide: nothing finer is in the mesh.")
    if found.stands:
        yield text("p", "It stands: its centre of mass lies over what touches the table.")
    else:
        yield text("p", "It tips over where it stands: lay it down, or glue it to a foot that no lamp sees.")
