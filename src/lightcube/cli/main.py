"""The command line: parses, calls, prints."""

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import Annotated

import typer

from lightcube.cli.console import Stopped, err, out, plain_warnings, prepare
from lightcube.errors import InputError

#: The commands, each in a module of its name, and what they say of themselves: only the one that is named is loaded.
COMMANDS: Mapping[str, str] = {
    "studio": (
        "Open the studio in a browser: drop pictures, see what will come, watch it become, turn it, take it away."
    ),
    "trace": "Ray-trace a moving scene: a folder of PNGs, or a movie by suffix.",
    "check": (
        "Say before solving what can be known: how good it will be, what contradicts itself, or on a stage cannot be."
    ),
    "solve": "Compute the cube whose shadows are the pictures; what was stopped or killed goes on where it was.",
    "hull": "Carve the largest solid whose shadows stay within silhouettes: a mesh to print, or a shape, by suffix.",
    "carve": "Take material out of a finished shape, all over or where a brush or a ray says; its shadows stay.",
    "relief": "Make one relief that shows a picture under each of up to four low lamps.",
    "play": "Cast the cube's shadows: a movie, a folder of PNGs, or .npy, by suffix.",
    "score": "Compare what a cube, a shape, a relief or a mesh really casts with what was wanted.",
    "view": (
        "Write a page in which the cube, or a relief's lamp, is turned by hand: one HTML file, to keep or to mail."
    ),
    "report": (
        "Write all that is known of a cube into one HTML file, to keep and to print: pictures, curves, how it was made."
    ),
    "draw": "Draw a stage from above and from the side, with its beams, or the room of a cube in perspective.",
    "info": "Say what is in the file of a cube, a shape or a relief.",
    "export": "Write a cube for printers, lasers and other programs, with all that is to be known beside it.",
    "materials": (
        "Say what inks, resins and filaments there are, and what each absorbs; import those of other programs."
    ),
    "calibrate": "Print a page of patches, photograph it, and know your own inks.",
    "publish": "Make a cube of what there is of an unfinished one, and say whether it is whole.",
    "bench": "Measure this machine and what lightcube makes of it, beside others: tables in Markdown.",
    "demo": "Make three small cubes to be turned by hand, and one page that shows them, into a folder.",
}
#: The exit code after Ctrl-C.
_INTERRUPTED = 130


def application(words: Sequence[str]) -> typer.Typer:
    """The program as far as it takes to run the command that `words` name: of the others there is the name alone."""
    app = typer.Typer(
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,
        context_settings={"help_option_names": ["-h", "--help"]},
        help="Pictures in, a cube of coloured shadows out.",
    )
    app.callback()(_options)
    wanted = next((word for word in words if not word.startswith("-")), None)
    for name, said in COMMANDS.items():
        if name == wanted:
            from lightcube.cli.help import Laid  # here: only a command that is named has a help of its own

            app.command(name, cls=Laid)(_loaded(name))
        else:
            app.command(name, help=said)(_elsewhere)
    return app


def run(words: Sequence[str]) -> int:
    """Run the command that `words` name and return the exit code: 0, 2 for what the user can mend, 130 for Ctrl-C."""
    app = application(words)
    prepare()
    code: int | None = None
    try:
        with plain_warnings():
            code = app(args=list(words) or ["--help"], prog_name="lightcube", standalone_mode=False)
        if code == _INTERRUPTED:  # what typer makes of Ctrl-C
            err.print("interrupted: no file was finished")
    except InputError as error:
        err.print(f"lightcube: {error}")
        code = 2
    except Stopped as stop:
        err.print(stop)
        code = _INTERRUPTED
    except (KeyboardInterrupt, typer.Abort):
        err.print("interrupted: no file was finished")
        code = _INTERRUPTED
    except typer.TyperException as error:
        err.print(f"lightcube: {error.format_message()}".replace("Value error, ", ""))
        code = 2
    except OSError as error:
        err.print(f"lightcube: {_sentence(error)}")
        code = 2
    except MemoryError:
        err.print("lightcube: the machine has not enough memory for this: use a smaller cube or fewer pictures")
        code = 2
    return code or 0


def _sentence(error: OSError) -> str:
    """What the system refused."""
    from lightcube.io._files import refuse_gone_folder  # here: only what fails pays for it

    try:
        refuse_gone_folder(error)
    except InputError as gone:
        return str(gone)
    return f"{error.filename or 'the system'}: {error.strerror or error}"


def _loaded(name: str) -> Callable[..., None]:
    """The function that is a command."""
    found: Callable[..., None] = getattr(import_module(f"lightcube.cli.{name}"), name)
    return found


def _elsewhere() -> None:
    """A command that is not the one asked for."""


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        out.print(f"lightcube {version('lightcube')}")
        raise typer.Exit


def _options(
    _: Annotated[
        bool,
        typer.Option("--version", help="Show the version and exit.", callback=_print_version, is_eager=True),
    ] = False,
) -> None:
    """What can be said before a command."""
