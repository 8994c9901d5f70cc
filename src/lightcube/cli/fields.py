"""The fields of `lightcube.verbs.options.Options` as options of the command line."""

import inspect
from collections.abc import Callable, Mapping
from dataclasses import Field, fields
from functools import wraps
from typing import Annotated, Any, get_args

import typer

from lightcube.cli import arguments
from lightcube.io import read_dyes
from lightcube.verbs.options import Option, Options

_FIELDS = {each.name: each for each in fields(Options)}
#: Options that are called otherwise than the field.
_FLAGS = {"from_s": "from", "to_s": "to"}
#: Options that are written as a text: what it means.
_TEXTS: Mapping[str, Callable[[str], Any]] = {
    "shape": lambda text: arguments.whole_numbers(text, ",", "--shape", 3),
    "focus": lambda text: arguments.two_numbers(text, "--focus"),
    "angles_deg": lambda text: arguments.numbers(text, "--angles-deg"),
    "ior": lambda text: arguments.numbers(text, "--ior"),
    "grain": lambda text: arguments.number_or_auto(text, "--grain"),
    "clear": lambda text: arguments.colours(text, "--clear"),
    "material": read_dyes,
}


def one_by_one(command: Callable[..., None]) -> Callable[..., None]:
    """Let the command line give the fields of `Options` one by one, where a command has a parameter ``options``."""

    @wraps(command)
    def taking(**given: Any) -> None:
        said = {name: given.pop(name) for name in _FIELDS}
        values = {name: _TEXTS[name](value) for name, value in said.items() if name in _TEXTS and value is not None}
        command(options=Options(**{**said, **values}), **given)

    signature, by_name = inspect.signature(command), inspect.Parameter.KEYWORD_ONLY
    own = [
        inspect.Parameter(name, by_name, default=each.default, annotation=Annotated[_written(each), flag(name)])
        for name, each in _FIELDS.items()
    ]
    parameters = [
        one
        for name, parameter in signature.parameters.items()
        for one in (own if name == "options" else [parameter.replace(kind=by_name)])
    ]
    taking.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    return taking


def _written(field: Field[Any]) -> Any:
    """The type of an option as it is written."""
    return str | None if field.name in _TEXTS else get_args(field.type)[0]


def flag(name: str) -> typer.models.OptionInfo:
    """What makes a field of `Options` an option of the command line."""
    _, said = get_args(_FIELDS[name].type)
    assert isinstance(said, Option)  # noqa: S101 - every field says what it is
    return typer.Option(
        f"--{_FLAGS.get(name, name).replace('_', '-')}", help=said.help, min=said.least, rich_help_panel=said.group
    )
