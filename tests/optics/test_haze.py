"""What haze does, estimated: the measured veils, what lies between them, and what is told of it."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lightcube as lc
from lightcube.errors import InputError
from lightcube.io.materials import as_toml
from lightcube.optics.dyes import Dyes
from lightcube.optics.haze import MEASURED_MM, VEILS, Phase, phase_of, veil_part
from lightcube.verbs.materials import clearest

PHASES: list[Phase] = ["isotropic", "forward"]
GRID = lc.Grid((8, 20, 10), 2.0)


@pytest.mark.parametrize(("at", "part"), VEILS.items())
def test_the_veil_is_as_it_was_measured(at: tuple[Phase, float], part: float) -> None:
    phase, scattering = at
    assert veil_part(scattering * MEASURED_MM, phase) == pytest.approx(part, rel=1e-12)


@pytest.mark.parametrize("phase", PHASES)
def test_more_haze_is_more_veil_from_none_to_all(phase: Phase) -> None:
    parts = [veil_part(thickness, phase) for thickness in (0, *np.geomspace(1e-4, 50, 60))]
    assert parts[0] == 0
    few = parts[: 1 + int(np.argmax(np.array(parts) == parts[-1]))]
    assert np.all(np.diff(few) > 0)
    assert parts[-1] < 1
    assert veil_part(0.1, "forward") > 10 * veil_part(0.1, "isotropic")


def test_which_way_haze_throws() -> None:
    assert [phase_of(g) for g in (-0.3, 0.0, 0.49, 0.5, 0.95)] == ["isotropic"] * 3 + ["forward"] * 2


def hazy(**given: Any) -> Dyes:
    return Dyes(
        ("red", "blue"), np.array([[0.1, 2.0, 2.0], [2.0, 1.0, 0.1]]), base=np.array([0.02, 0.03, 0.04]), **given
    )


def test_a_material_keeps_its_haze_in_its_file_and_in_plain_values(tmp_path: Path) -> None:
    dyes = hazy(haze=0.02, g=0.85)
    (tmp_path / "resin.toml").write_text(as_toml(dyes), encoding="utf-8")
    assert lc.read_dyes(tmp_path / "resin.toml") == dyes
    assert dyes != hazy(haze=0.02)
    assert "haze" not in as_toml(hazy())


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"haze": 0.021}, "base takes less than 0.021 per mm"),
        ({"haze": -0.01}, "haze is a number per mm of at least 0"),
        ({"haze": 1e308}, "base takes less"),
        ({"haze": float("nan")}, "nan"),
        ({"g": 1.5}, "mean cosine"),
        ({"haze": 0.01, "kind": "ink"}, "haze is of blocks"),
    ],
)
def test_haze_that_cannot_be_is_refused(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        hazy(**given)


def test_it_is_told_what_the_clear_material_will_do() -> None:
    """Of a block of 40 mm, by its longest side."""
    assert clearest(lc.Material(), GRID) == []
    (line,) = clearest(lc.Material(clear=(0.0, 0.02, 0.01)), GRID)
    assert "up to 55% of the light along 40 mm" in line
    assert "2.7% of all light if thrown to all sides" in line
    (line,) = clearest(lc.Material(dyes=hazy()), GRID)
    assert line == f"clear material takes up to {1 - math.exp(-1.6):.0%} of the light along 40 mm"
    assert "33% aside, mostly ahead" in clearest(lc.Material(dyes=hazy(haze=0.01, g=0.9)), GRID)[1]
    assert clearest(lc.Material(dyes=hazy(haze=0.01, g=0.9)), GRID)[1].endswith("31.0% of all light: they get pale")
    assert clearest(lc.Material(dyes=hazy(haze=0.01)), GRID)[1].endswith("1.0% of all light: hardly seen")
