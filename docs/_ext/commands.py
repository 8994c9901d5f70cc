"""The pages of the command line: a page for each command, with all that its help says."""

from collections.abc import Iterator
from typing import Any

from marked import hidden, plain, table
from typer.main import get_command

from lightcube.cli.help import EXAMPLES, GROUPS, group_of
from lightcube.cli.main import COMMANDS, application

#: What stands in a page's head for options that are in no group.
_OWN = "Options"


def pages() -> dict[str, str]:
    """The pages, and what the page of all includes, by the names of their files."""
    return {**{f"commands/{name}.md": page(name) for name in COMMANDS}, "commands.txt": _index()}


def page(name: str) -> str:
    """All that is to be known of a command."""
    program: Any = get_command(application([name]))
    command = program.commands[name]
    context = command.make_context(f"lightcube {name}", [], resilient_parsing=True)
    usage = command.get_usage(context).removeprefix("Usage: ")
    parts = [f"# {name}", plain(COMMANDS[name]), f"```text\n{' '.join(usage.split())}\n```", *_examples(name)]
    groups = dict(_groups(command, context))
    for group in (each for each in ("Arguments", _OWN, *GROUPS) if each in groups):
        parts += [f"## {group}", *groups[group]]
    return f"```{{program}} lightcube {name}\n```\n\n" + "\n\n".join(parts) + "\n"


def _groups(command: Any, context: Any) -> Iterator[tuple[str, list[str]]]:
    """Groups of what may be said, each with an entry for every option."""
    found: dict[str, list[str]] = {}
    for parameter in command.get_params(context):
        record = parameter.get_help_record(context)
        if record is None or parameter.name == "help":
            continue
        words, said = record
        is_option = parameter.param_type_name == "option"
        entry = f":::{{option}} {words}\n{plain(said)}\n:::" if is_option else f"`{words}`\n: {plain(said)}"
        found.setdefault(group_of(parameter) if is_option else "Arguments", []).append(entry)
    yield from found.items()


def _examples(name: str) -> list[str]:
    lines = "\n".join(f"# {said}\n{typed}" for typed, said in EXAMPLES.get(name, ()))
    return [f"```bash\n{lines}\n```"] if lines else []


def _index() -> str:
    """What the page of all commands includes."""
    rows = [(f"[{name}](made/commands/{name}.md)", plain(said)) for name, said in COMMANDS.items()]
    listed = hidden([f"made/commands/{name}" for name in COMMANDS])
    return f"{table(('command', 'does'), rows)}\n\n{listed}\n"
