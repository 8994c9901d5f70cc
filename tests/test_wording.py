"""Numbers as people say them."""

import math
import re
from pathlib import Path

import pytest

import lightcube
from lightcube.wording import counted, in_ev

SOURCES = sorted(Path(str(lightcube.__file__)).parent.rglob("*.py"))


def test_one_is_one_and_all_others_are_many() -> None:
    assert [counted(count, "picture") for count in (0, 1, 2)] == ["0 pictures", "1 picture", "2 pictures"]
    assert [counted(count, "pass") for count in (1, 200)] == ["1 pass", "200 passes"]


def test_twice_the_light_is_one_stop_more() -> None:
    for power in (1e-4, 0.3, 1.0, 16.0, 1e6):
        assert math.isclose(float(in_ev(2 * power)[:-3]), float(in_ev(power)[:-3]) + 1)
    assert [in_ev(power) for power in (0.5, 0.999, 1, 16)] == ["-1 EV", "0 EV", "0 EV", "+4 EV"]


@pytest.mark.parametrize("file", SOURCES, ids=lambda file: file.stem)
def test_sentences_count_with_the_one_helper(file: Path) -> None:
    """What is said of a number of things goes on right where there is only one."""
    if file.parent.name == "bench":
        return
    many = r"f\".*\{(len\([^{}]*\)|count|units|pictures|views)\} (pictures|views|stops|lamps|screens|units|passes)\b"
    assert not re.findall(many, file.read_text())
