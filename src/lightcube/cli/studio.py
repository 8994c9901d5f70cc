"""The command `lightcube studio`."""

import threading
import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from lightcube.cli.console import err
from lightcube.errors import InputError


def studio(
    folder: Annotated[Path, typer.Argument(help="Folder of the project, made where there is none.")] = Path("my-cube"),
    port: Annotated[int, typer.Option(help="Port of this machine; 0 = one that is free.", min=0, max=65535)] = 0,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Only say the address, open no browser.")] = False,
) -> None:
    """Open the studio in a browser: drop pictures, see what will come, watch it become, turn it, take it away."""
    try:
        from lightcube.studio.serving import serve  # here: it takes what not everybody has
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("fastapi", "uvicorn", "starlette"):
            raise
        raise InputError(
            "the studio needs two packages more: install them with  pip install 'lightcube[studio]'"
        ) from error

    def ready(address: str) -> None:
        typer.echo(address)  # as it is: it holds the key
        where = "open this address in a browser" if no_browser else "the studio opens in your browser"
        err.print(f"{where}; Ctrl-C ends the studio, and nothing is lost")
        if not no_browser:  # beside: some browsers are waited for until they are closed
            threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()

    serve(folder, port, ready)
    err.print("the studio is closed; the same command opens it again where it was")
