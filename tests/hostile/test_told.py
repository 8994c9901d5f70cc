"""What a cube says of itself, changed by somebody: refused in a sentence or left out, and never shown raw."""

import sys
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import lightcube as lc
from lightcube.backward.recipe import recipe_of
from lightcube.cli.arguments import short
from lightcube.errors import InputError, encodable, shown
from lightcube.report.measuring import Findings, measure
from lightcube.report.opening import Heading
from lightcube.report.page import page
from lightcube.scoring.facts import facts
from lightcube.verbs.refitting import refitted
from lightcube.verbs.reproducing import reproducing
from tests.hostile.doors import LEAVES, changed_leaf, leaves
from tests.hostile.test_tampered import GRID, TARGETS

FURTHER = {
    "predicted": {"psnr_mean": 30.0, "psnr_min": 20.0, "pictures": [1.0, 2.0, 3.0]},
    "order": [0, 1, 2],
    "shift": 2,
    "fit": "crop",
}


@pytest.fixture(scope="module")
def found() -> Findings:
    cube = lc.solve(TARGETS, GRID, lc.Recipe(passes=3)).cube
    cube = replace(cube, scores=lc.score(cube, TARGETS), provenance={**cube.provenance, **FURTHER})
    return measure(cube, TARGETS)


def look(found: Findings, cube: lc.Cube) -> str:
    """A report of a cube of which all that is measured is known."""
    return page(replace(found, cube=cube), Heading("x"), "", reproducing(cube, TARGETS, None, "x.zarr"), [])


def test_an_honest_cube_is_told_whole(found: Findings) -> None:
    text = look(found, found.cube)
    assert "predicted: 30.0 dB" in text
    assert "--shift 2" in text.replace("</span> <span>", " ")


@pytest.mark.parametrize("number", range(len(LEAVES)))
def test_how_a_cube_was_made_may_be_anything(number: int, found: Findings) -> None:
    said = dict(found.cube.provenance)
    for path in leaves(said):
        cube = replace(found.cube, provenance=changed_leaf(said, path, LEAVES[number]))
        with suppress(InputError):
            assert "<script>alert" not in look(found, cube)
        for name, value in facts(cube).items():
            assert shown(f"{name} {short(value)}").replace("\xa0", " ").isprintable()


def test_a_method_that_a_cube_names_is_told_and_not_imported(
    found: Findings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "harmful.py").write_text("raise RuntimeError\n")
    monkeypatch.syspath_prepend(tmp_path)
    cube = replace(found.cube, provenance={**found.cube.provenance, "method": "harmful:solve"})
    assert "harmful:solve" in look(found, cube)
    assert lc.score(cube, TARGETS)["psnr_mean"] == lc.score(found.cube, TARGETS)["psnr_mean"]
    assert "harmful" not in sys.modules
    with pytest.raises(InputError, match="known by its name only"):
        lc.solve(TARGETS, GRID, recipe_of(cube))


@pytest.mark.parametrize("number", range(len(LEAVES)))
def test_scores_that_a_cube_keeps_may_be_anything(number: int, found: Findings, tmp_path: Any) -> None:
    said = {**found.cube.scores}
    for at, path in enumerate(leaves(said)):
        cube = replace(found.cube, scores=changed_leaf(said, path, LEAVES[number]))
        try:
            kept = lc.load(lc.save(cube, tmp_path / f"{at}.npz"))
        except InputError:
            continue
        for name, value in facts(kept).items():
            assert shown(f"{name} {short(value)}").replace("\xa0", " ").isprintable()


@pytest.mark.parametrize("order", [[0, 5, 1], [-1, 0, 1], "012", [0.5, 1, 2], {"a": 1}, 7, [0, 0, 0]])
def test_pictures_are_not_taken_in_an_order_that_is_none(order: Any, found: Findings, tmp_path: Any) -> None:
    lc.save(TARGETS.pictures, tmp_path / "pictures")
    cube = replace(found.cube, provenance={**found.cube.provenance, "order": order})
    assert len(refitted(cube, str(tmp_path / "pictures"))) == 3


@pytest.mark.parametrize(
    ("raw", "told"),
    [
        ("a\x1b[31mb", r"a\x1b[31mb"),
        ("a\nb\tc\x7f\x9b", r"a\x0ab\x09c\x7f\x9b"),
        ("\u202egnp.exe", r"\u202egnp.exe"),
        ("\u2066\u200e\u061c\u200b\ufeff", r"\u2066\u200e\u061c\u200b\ufeff"),
        ("\udcff.png", r"\xff.png"),
        ("\U000e0041", r"\U000e0041"),
        ("Bild ä \u00a0 日本 \U0001f600", "Bild ä \u00a0 日本 \U0001f600"),
    ],
)
def test_names_are_shown_without_what_leads_astray(raw: str, told: str) -> None:
    assert shown(raw) == told
    assert str(InputError(raw)) == told
    encodable(raw).encode()
