"""The command `lightcube carve`."""

from typing import Annotated

import typer

from lightcube.cli.console import done, out, telling
from lightcube.cli.hull import CARVE, DEEP, DRAIN, OUTS, shape_files
from lightcube.cli.options import JSON, OVERWRITE, threaded
from lightcube.events import Progress
from lightcube.solids.carving import Carving
from lightcube.verbs import carving

#: Steps that are told of: to have carved, to have written, to have cast it again.
_CARVED, _WRITTEN, _STEPS = 6, 8, 10


@threaded
def carve(
    shape: Annotated[str, typer.Argument(help="A shape that hull or carve wrote (.shape.zarr).")],
    outputs: Annotated[list[str], OUTS],
    carve: Annotated[Carving, CARVE] = "none",
    wall: Annotated[float, typer.Option(help="How thick a shell is, mm.", rich_help_panel="Material")] = 1.2,
    keep_deep: Annotated[int, DEEP] = 3,
    drain: Annotated[float, DRAIN] = 3.0,
    where: Annotated[
        str | None,
        typer.Option(
            help="A brush: only there may material be taken. A mesh that lies over the shape's own mesh file, or .npy "
            "with a number for each voxel (z, y, x), 0 where all stays.",
            rich_help_panel="Material",
        ),
    ] = None,
    ray: Annotated[
        list[str] | None,
        typer.Option(
            help="VIEW,ROW,COLUMN: take out what the ray of this pixel does not need; rows and columns count from 0. "
            "It may be said several times.",
            rich_help_panel="Material",
        ),
    ] = None,
    undo_to: Annotated[
        carving.Undo | None,
        typer.Option(help="Give back first what was taken out: the whole hull.", rich_help_panel="Material"),
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what would be taken, no more.", rich_help_panel="Output")
    ] = False,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Take material out of a finished shape, all over or where a brush or a ray says; its shadows stay."""
    files = shape_files(outputs, overwrite=overwrite)
    with telling("carve", as_json=as_json) as tell:
        found = carving.carved(
            shape, carve, wall_mm=wall, drain_mm=drain, deep=keep_deep, where=where, rays=ray or (), undo=undo_to
        )
        tell(Progress(_CARVED, _STEPS))
        if not dry_run:
            for file in files:
                file.write(found.shape)
            tell(Progress(_WRITTEN, _STEPS))
            cast, kept = carving.certified(outputs[0], found)
            tell(Progress(_STEPS, _STEPS))
    if dry_run:
        lines = "; ".join(found.lines)
        done(as_json, f"nothing is written: this was a dry run; {lines}", **found.facts)
        return
    same = {"overlap_with_before_min": float(kept.overlap.min()), "bad_edges": found.shape.mesh.bad_edges}
    done(as_json, f"{' and '.join(outputs)} {'is' if len(outputs) == 1 else 'are'} ready",
         out=outputs[0], outs=outputs, **found.facts, **same, **cast.facts)  # fmt: skip
    if not as_json:
        for line in carving.words(found, cast, kept):
            out.print(line)
