"""What `--help` says: every option in a group and with its unit, and examples that can be typed."""

import re
from typing import Any, get_args

import pytest
import typer

from lightcube.cli import main
from lightcube.cli.help import EXAMPLES, GROUPS, group_of
from lightcube.verbs.options import Group

#: What numbers are of; one of these stands in the text of each option that takes one.
UNITS = r"\b(mm|degrees?|voxels?|pixels?|passes|seconds?|pictures?|points?|widths?|EV|1/mm|part of)\b"
#: How an option's name ends that says its unit itself.
NAMED = {"-deg": "degree", "-mm": "mm", "-s": "second"}


def command(name: str) -> Any:
    """A command of the program."""
    return typer.main.get_command(main.application([name])).commands[name]  # type: ignore[attr-defined]


def options(name: str) -> list[Any]:
    return [each for each in command(name).params if each.param_type_name == "option"]


def test_the_groups_of_a_cubes_options_are_shown_in_their_order() -> None:
    assert ("Output", *get_args(Group), "Machine") == GROUPS


@pytest.mark.parametrize("name", ["solve", "check"])
def test_every_option_of_a_cube_is_in_a_group(name: str) -> None:
    assert {group_of(each) for each in options(name)} <= set(GROUPS)
    assert len({group_of(each) for each in options("solve")}) == len(GROUPS)


@pytest.mark.parametrize("name", ["solve", "check", "trace", "draw", "score"])
def test_numbers_say_what_they_are_of(name: str) -> None:
    context = command(name).make_context("lightcube", [], resilient_parsing=True)
    for each in options(name):
        if re.search("<(int|float)", each.get_help_record(context)[0]):
            assert re.search(UNITS, each.help, re.IGNORECASE), each.name
        for end, unit in NAMED.items():
            assert not each.opts[-1].endswith(end) or unit in each.help.lower(), each.name


def test_groups_stand_in_their_order_and_help_comes_last(capsys: pytest.CaptureFixture[str]) -> None:
    assert main.run(["solve", "--help"]) == 0
    told = capsys.readouterr().out
    assert re.findall(r"^(\w+):$", told, re.MULTILINE) == ["Arguments", *GROUPS, "Examples"]
    assert told.index("--threads") < told.index("--help") < told.index("Examples:")
    for each in options("solve"):
        assert told.count(f"  {', '.join(sorted(each.opts, key=len))} ") >= 1, each.name


def test_options_in_no_group_stand_together_with_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert main.run(["info", "--help"]) == 0
    told = capsys.readouterr().out
    assert re.findall(r"^(\w+):$", told, re.MULTILINE) == ["Arguments", "Output", "Material"]
    assert told.index("--json") < told.index("--help")


@pytest.mark.parametrize("name", main.COMMANDS)
def test_where_a_word_lacks_an_example_has_it(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    needed = [each.opts[0] for each in options(name) if each.required]
    if needed:
        example = EXAMPLES[name][0][0]
        arguments = [each for each in command(name).params if each.param_type_name == "argument" and each.required]
        assert main.run([name, *example.split()[2 : 2 + len(arguments)]]) == 2
        said = capsys.readouterr().err
        assert said == f"lightcube: Missing option '-o' / '--out': give it, as in {example}\n"
        assert set(needed) <= set(example.split())


def test_commands_that_write_say_where_to() -> None:
    needing = [name for name in main.COMMANDS if any(each.required for each in options(name))]
    assert needing == ["trace", "solve", "hull", "carve", "relief", "play", "draw", "export", "calibrate"]


@pytest.mark.parametrize(("name", "typed"), [(name, typed) for name, all_ in EXAMPLES.items() for typed, _ in all_])
def test_examples_can_be_typed(name: str, typed: str) -> None:
    program, verb, *words = typed.split()
    assert (program, verb) == ("lightcube", name)
    command(name).make_context("lightcube", words)  # raises where an option is unknown or its value cannot be
