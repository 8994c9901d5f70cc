"""Files of other programs: straight lines through layers, guesses of one number, and entries that say nothing."""

import colorsys
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lightcube.errors import InputError
from lightcube.io import read_dyes
from lightcube.io.palettes import read_palette
from lightcube.optics.transfer import encode
from tests.cli.test_cli import run

__all__ = ["run"]

E = {"#0000ff": (6.0, 2.4, 0.6), "#ff0088": (0.4, 6.4, 2.6), "#ffee00": (0.1, 0.7, 4.2)}
NAMES = ("Cyan[PLA]", "Magenta[PLA]", "Yellow[PLA]")


def hsl(extinction: tuple[float, ...], offset: float, layers: int, layer_mm: float) -> dict[str, float]:
    """What a camera sees of so many layers, as PIXEstL has it."""
    light = np.exp(-np.array(extinction) * layers * layer_mm - offset)
    hue, lightness, saturation = colorsys.rgb_to_hls(*encode(light))
    return {"H": 360 * hue, "S": 100 * saturation, "L": 100 * lightness}


def palette(folder: Path, layer_mm: float = 0.1, **spoilt: Any) -> str:
    entries: dict[str, Any] = {
        colour: {
            "name": name,
            "active": True,
            "layers": {str(count): hsl(row, 0.2, count, layer_mm) for count in (5, 4, 3, 1)},
        }
        for name, (colour, row) in zip(NAMES, E.items(), strict=True)
    }
    entries["#123456"] = {"name": "Unused", "active": False}
    entries["#ff0088"] |= spoilt
    (folder / "p.json").write_text(json.dumps(entries))
    return f"pixestl:{folder / 'p.json'}"


@pytest.mark.parametrize("layer_mm", [0.1, 0.2])
def test_a_palette_that_was_planted_comes_back(tmp_path: Path, layer_mm: float) -> None:
    found = read_palette(palette(tmp_path, layer_mm), layer_mm=layer_mm)
    assert found.dyes.names == NAMES
    assert (found.dyes.kind, found.dyes.calibration) == ("filament", "provisional")
    np.testing.assert_allclose(found.dyes.extinction, list(E.values()), rtol=1e-4, atol=1e-4)
    assert found.said[0] == "Cyan[PLA]: off by 0.00 (ln, rms), 0.20, 0.20, 0.20 at no thickness"
    assert found.dyes.label[0].tolist() == [0, 0, 255]


@pytest.mark.parametrize(
    ("spoilt", "said"),
    [
        ({"layers": None}, "Magenta[PLA] has 0 layers, and a line takes two"),
        ({"layers": {"1": hsl((1, 2, 3), 0, 1, 1)}}, "Magenta[PLA] has 1 layers"),
        ({"layers": {"1": {"H": 1, "S": 2}, "2": {"H": 1, "S": 2}}}, "Magenta[PLA] has layers that are no H, S and L"),
        ({"layers": {"one": hsl((1, 2, 3), 0, 1, 1)}}, "Magenta[PLA] has layers that are no H, S and L"),
        ({"layers": {"1": {"H": 1, "S": 2, "L": 300}, "2": {"H": 1, "S": 2, "L": 3}}}, "Magenta[PLA] has layers"),
        ({"layers": {"1": hsl((9, 9, 9), 0, 1, 0.1), "2": hsl((1, 1, 1), 0, 1, 0.1)}}, "Magenta[PLA] gets brighter"),
        ({"layers": {"1": hsl((1, 1, 1), 0, 1, 0.1), "2": hsl((1, 1, 1), 0, 1, 0.1)}}, "Magenta[PLA] absorbs as much"),
    ],
)
def test_a_filament_that_says_nothing_is_named_and_left_out_only_if_asked(
    tmp_path: Path, spoilt: dict[str, Any], said: str
) -> None:
    source = palette(tmp_path, **spoilt)
    with pytest.raises(InputError) as refused:
        read_palette(source)
    assert said in str(refused.value)
    assert str(refused.value).startswith("p.json: ")
    found = read_palette(source, skip=True)
    assert found.dyes.names == ("Cyan[PLA]", "Yellow[PLA]")
    assert any(sentence.startswith(f"left out: {said}") for sentence in found.said)
    assert read_palette(source, only=["yellow", "CYAN"]).dyes.names == ("Yellow[PLA]", "Cyan[PLA]")


FILAMENTS: list[dict[str, Any]] = [
    {"Brand": "B", "Name": "Cyan", "Color": "#0086D6", "Transmissivity": 2.0, "Owned": True, "Type": "PLA"},
    {"Brand": "B", "Name": "Magenta", "Color": "#EC008C", "Transmissivity": 2.8},
    {"Brand": "B", "Name": "Yellow", "Color": "F4EE2A", "Transmissivity": 4.8},
]
LIBRARY: dict[str, Any] = {"Filaments": FILAMENTS}


def library(folder: Path, document: Any, name: str = "h.json") -> str:
    (folder / name).write_text(json.dumps(document))
    return f"hueforge:{folder / name}"


def test_a_library_is_a_guess_and_says_so(tmp_path: Path) -> None:
    found = read_palette(library(tmp_path, LIBRARY)).dyes
    assert found.names == ("B Cyan", "B Magenta", "B Yellow")
    assert found.calibration == "guess"
    np.testing.assert_allclose(found.extinction.mean(axis=1), np.log(10) / np.array([2.0, 2.8, 4.8]))
    assert np.argmax(found.extinction, axis=1).tolist() == [0, 1, 2]
    assert "these filaments are guessed" in found.doubts[0]
    listed = [{"name": each["Name"], "color": each["Color"], "td": each["Transmissivity"]} for each in FILAMENTS]
    np.testing.assert_array_equal(read_palette(library(tmp_path, listed)).dyes.extinction, found.extinction)


@pytest.mark.parametrize("td", [None, "0.7", 0, -1, 100, True, float("nan")])
def test_a_number_that_is_none_is_named(tmp_path: Path, td: Any) -> None:
    tan = {"Brand": "B", "Name": "Tan", "Color": "#E8DBB7", "Transmissivity": td}
    document = {"Filaments": [*FILAMENTS, tan]}
    with pytest.raises(InputError, match=r"h.json: B Tan has the transmission distance .*leave it out by --skip"):
        read_palette(library(tmp_path, document))
    assert len(read_palette(library(tmp_path, document), skip=True).dyes.names) == 3


def test_what_is_no_palette_is_one_sentence(tmp_path: Path) -> None:
    many = [{"name": f"n{number}", "color": "#0086D6", "td": 2} for number in range(13)]
    for source, said in [
        ("photo.png", "is no palette: give pixestl:FILE or hueforge:FILE"),
        ("cura:a.json", "is no palette"),
        (library(tmp_path, many), "has 13 filaments in use, and a material 12 at most: choose by --only"),
        (library(tmp_path, {"a": 1}, "other.json"), "this is no library of HueForge"),
        (f"pixestl:{tmp_path / 'h.json'}", "this is no palette of PIXEstL"),
        (f"pixestl:{tmp_path / 'none.json'}", "none.json"),
    ]:
        with pytest.raises(InputError) as refused:
            read_palette(source)
        assert said in str(refused.value)
        assert "\n" not in str(refused.value)
    (tmp_path / "text.json").write_text("[1,")
    with pytest.raises(InputError, match="is no JSON"):
        read_palette(f"hueforge:{tmp_path / 'text.json'}")
    with pytest.raises(InputError, match="no filament in use called 'blue'"):
        read_palette(palette(tmp_path), only=["blue"])


def test_the_command_lists_shows_and_imports(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    assert "polyjet: cyan, magenta, yellow, black (resins, provisional)" in run("materials").out
    shown = run("materials", "show", "pla")
    assert "14.6, 2.4, 0.6" in shown.out
    assert "green (nearest is magenta, which takes 41% as much blue with it)" in " ".join(shown.out.split())
    assert json.loads(run("materials", "show", "pla", "--json").out)["cyan_extinction_per_mm"] == [14.6, 2.4, 0.6]
    out = tmp_path / "a.toml"
    done = run("materials", "import", palette(tmp_path), "-o", out, "--only", "Cyan,Yellow")
    assert done.code == 0, done.err
    assert read_dyes(out).names == ("Cyan[PLA]", "Yellow[PLA]")
    for words in [("list", "pla"), ("show",), ("import", "a"), ("show", "pla", "--skip"), ("show", "nothing")]:
        assert run("materials", *words).code == 2
