"""The command `lightcube bench`."""

from typing import Annotated

import typer

from lightcube.cli.console import compiling, err, json_document, out
from lightcube.cli.options import JSON, threaded
from lightcube.verbs import solving


@threaded
def bench(
    n: Annotated[int, typer.Option("--n", min=2, max=2000, help="Voxels along each side of the cube.")] = 300,
    pictures: Annotated[
        int | None, typer.Option(min=1, max=100_000, help="Number of pictures.  [default: as many as voxels]")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Time everything once only; the figures scatter.")] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Measure this machine and what lightcube makes of it, beside others: tables in Markdown."""
    from lightcube import bench as benches
    from lightcube.bench.report import markdown

    count = n if pictures is None else pictures
    solving.check_memory(benches.memory(n, count))
    with compiling(as_json=as_json):
        found = benches.measure(n, count, lambda what: err.print(f"{what} ..."), quick=quick)
    if as_json:
        json_document(found)
    else:
        out.print("\n".join(markdown(found)))
