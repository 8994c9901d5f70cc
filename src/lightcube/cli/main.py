"""The command line: parses, calls, prints."""

import sys

import typer

from lightcube.cli import bench, check, demo, draw, play, report, score, solve, trace, view
from lightcube.cli.console import Stopped, err, plain_warnings, prepare
from lightcube.cli.options import threaded
from lightcube.errors import InputError

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Pictures in, a cube of coloured shadows out.",
)

for command in (
    *(trace.trace, check.check, solve.solve, play.play, score.score, view.view, report.report, draw.draw),
    *(score.info, solve.publish, bench.bench, demo.demo),
):
    computes = command not in (draw.draw, score.info, solve.publish)
    app.command()(threaded(command) if computes else command)

#: The exit code after Ctrl-C.
_INTERRUPTED = 130


def main() -> None:
    """Run the command line: exit code 0, 2 for what the user can mend, 130 for Ctrl-C."""
    prepare()
    code: int | None = None
    try:
        with plain_warnings():
            code = app(args=sys.argv[1:] or ["--help"], standalone_mode=False)
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
        err.print(f"lightcube: {error.filename or 'the system'}: {error.strerror or error}")
        code = 2
    except MemoryError:
        err.print("lightcube: the machine has not enough memory for this: use a smaller cube or fewer pictures")
        code = 2
    sys.exit(code or 0)
