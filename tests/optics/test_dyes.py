"""Dyes: what they refuse, what they make of amounts, and coverages there and back."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lightcube.errors import InputError
from lightcube.optics.cube import Cube
from lightcube.optics.dyes import Dyes
from lightcube.optics.grid import Grid
from lightcube.optics.material import Material
from lightcube.optics.setups import turntable

E = np.array([[3.0, 0.5, 0.1], [0.2, 2.0, 0.9], [0.1, 0.2, 4.0], [2.0, 2.0, 2.0]])
NAMES = ("cyan", "magenta", "yellow", "black")
CURVE = np.array([[0, 0], [0.3, 0.42], [0.6, 0.71], [1, 1]])
DYES = Dyes(NAMES, E, limit=np.array([1, 0.8, 1, 0.3]), base=np.array([0.01, 0.02, 0.03]), kind="resin")
INKS = Dyes(NAMES, E, kind="ink", gain=(CURVE, None, CURVE, None), base=np.array([0.1, 0.2, 0.3]))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"extinction": np.where(np.arange(4)[:, None] == 1, 0, E)}, "'magenta' absorbs nothing"),
        ({"extinction": -E}, "'cyan' absorbs -3, which is not from 0"),
        ({"extinction": np.where(E == 2.0, np.nan, E)}, "absorbs nan"),
        ({"extinction": np.where(E == 2.0, 1e308, E)}, r"absorbs 1e\+308"),
        ({"extinction": np.outer(np.arange(1, 5), E[0])}, "absorb all colours alike"),
        ({"extinction": E[:3]}, r"the extinction of 4 dyes has shape \(3, 3\)"),
        ({"names": ("a", "b", "c", "a")}, "two dyes are called 'a'"),
        ({"names": ("a", "b", "c", " ")}, "' ' is no name of a dye"),
        ({"limit": np.array([1, 1, 0, 1])}, "the limit of a dye lies above 0 and up to 1, not at 0"),
        ({"limit": np.array([1, 1, 1.5, 1])}, "not at 1.5"),
        ({"limit": np.ones(3)}, "the limit of a material must be 4 numbers"),
        ({"base": np.array([0, 0, np.inf])}, "the base of a material must be numbers from 0"),
        ({"label": np.full((4, 3), 256)}, "three levels from 0 to 255"),
        ({"gain": (None,)}, "4 dyes with 1 dot gain"),
        ({"gain": (CURVE[::-1], None, None, None)}, r"the dot gain of 'cyan' must rise"),
        ({"gain": (CURVE[:-1], None, None, None)}, r"the dot gain of 'cyan' must rise"),
    ],
)
def test_what_cannot_be_is_one_sentence(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said) as refused:
        Dyes(**{"names": NAMES, "extinction": E, **given})
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("dyes", [DYES, INKS, Dyes(("a", "b"), E[:2, :2])])
def test_plain_numbers_make_the_same_dyes_again(dyes: Dyes) -> None:
    again = Dyes(**dyes.plain())
    assert again == dyes
    assert hash(again) == hash(dyes)
    assert replace(again, extinction=2 * again.extinction) != dyes


@pytest.mark.parametrize("dyes", [DYES, INKS])
def test_coverage_and_amount_undo_each_other(dyes: Dyes) -> None:
    amounts = np.random.default_rng(0).random((4, 5, 7))
    amounts[:, 0, :2] = [0, 1]
    sent = dyes.coverage(amounts)
    np.testing.assert_allclose(dyes.amount(sent), amounts, atol=2e-6)
    assert np.all(np.diff(dyes.coverage(np.linspace(0, 1, 50) * np.ones((4, 1))), axis=1) > 0)


def test_a_covered_part_of_a_film_keeps_that_part_of_the_light() -> None:
    """Murray and Davies, where the ink absorbs most; and more is printed than was sent."""
    amounts = INKS.amount(np.full((4, 1), 0.3))[:, 0]
    for dye, covered in enumerate([0.42, 0.3, 0.42, 0.3]):
        most = E[dye].max()
        assert math.exp(-most * amounts[dye]) == pytest.approx(1 - covered * (1 - math.exp(-most)), abs=1e-9)


def test_what_is_mixed_is_the_sum_of_its_dyes() -> None:
    amounts = np.random.default_rng(1).random((4, 2, 3, 5)).astype(np.float32)
    expected = np.einsum("dc,dzyx->czyx", E, amounts) + DYES.base[:, None, None, None]
    np.testing.assert_allclose(DYES.mixed(amounts), expected, rtol=1e-5)


def test_a_film_for_each_slice_absorbs_what_the_film_does() -> None:
    """Through a block of any slices a level film's absorbance is what light upwards loses in its slice."""
    grid = Grid((3, 4, 5), 0.5, tall=4)
    block = INKS.in_block(grid)
    np.testing.assert_allclose(block.extinction * grid.slice_mm, E)
    np.testing.assert_allclose(block.base * grid.slice_mm, INKS.base)
    assert block.in_block(grid) == block


def test_a_cube_is_of_its_dyes_or_refused() -> None:
    grid = Grid((2, 3, 5), 0.5)
    rig = turntable(grid, [20, 70], picture_shape=(2, 3))
    amounts = 0.3 * np.random.default_rng(2).random((4, 2, 3, 5)).astype(np.float32)
    for dyes in (DYES, INKS):
        mixed = dyes.in_block(grid).mixed(amounts)
        cube = Cube(mixed, grid, rig, amounts=amounts, dyes=dyes)
        np.testing.assert_array_equal(cube.amounts, amounts)
        wrong: list[tuple[dict[str, Any], str]] = [
            ({"amounts": None}, "give both, or neither"),
            ({"amounts": amounts[:3]}, "have shape"),
            ({"amounts": -amounts}, "between 0 and the limit"),
            ({"amounts": amounts + np.float32(0.8)}, "between 0 and the limit"),
            ({"amounts": 0.9 * amounts}, "is not that of its amounts"),
        ]
        for given, said in wrong:
            with pytest.raises(InputError, match=said):
                replace(cube, **given)


def test_a_material_of_dyes_is_bounded_by_their_limits() -> None:
    grid = Grid((3, 4, 5), 0.5, tall=4)
    assert Material(dyes=DYES).most(grid) == pytest.approx((DYES.base + DYES.limit @ E).max())
    assert Material(dyes=INKS).most(grid) == pytest.approx((INKS.base + E.sum(0)).max() / 2)
    assert Material(dyes=INKS).of_any_size(grid).most(Grid((3, 4, 5), 7)) == Material(dyes=INKS).most(grid)
    with pytest.raises(InputError, match="leave the largest extinction out"):
        Material(3.0, dyes=DYES)


def test_doubts_are_told() -> None:
    weak = replace(INKS, extinction=0.2 * E, calibration="measured", scattering=np.ones(4))
    assert [each.split(":")[0] for each in INKS.doubts] == ["these inks are provisional"]
    assert weak.doubts[0].startswith("a film gets no darker than density 0.35") is False
    faint = replace(weak, extinction=0.1 * E)
    assert faint.doubts == [
        "a film gets no darker than density 0.17: pictures need 0.3 at least",
        "scattering is told in the file, and nothing here reckons with it",
    ]
