"""Wedges: pages that are told apart, found in photographs from anywhere, and inks that come back from them."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from lightcube.calibration.finding import read_wedge
from lightcube.calibration.fitting import fit_inks
from lightcube.calibration.wedge import MARKS_MM, PAGE_MM, PATCH_MM, WINDOWS_MM, Wedge, page
from lightcube.errors import InputError
from lightcube.optics.arrays import Images
from lightcube.optics.dyes import Dyes
from tests.helpers.wedges import TURNED, film, photograph

AT = np.linspace(0, 1, 16)


def inks(*names: str, base: tuple[float, ...] = (0.1, 0.12, 0.2)) -> Dyes:
    """Inks with as much dot gain as printers have, and crosstalk."""
    known = {
        "cyan": (1.52, 0.58, 0.26, 0.1),
        "magenta": (0.25, 1.40, 0.85, 0.15),
        "yellow": (0.07, 0.11, 1.15, 0.05),
        "black": (1.50, 1.45, 1.40, 0.2),
    }
    rows = np.array([known[name] for name in names])
    gain = tuple(np.stack([AT, AT + 4 * row[3] * AT * (1 - AT)], axis=1) for row in rows)
    return Dyes(names, rows[:, :3] * np.log(10), base=np.array(base), kind="ink", gain=gain)


CMYK = inks("cyan", "magenta", "yellow", "black")
WEDGE = Wedge(CMYK.names)


@cache
def usual() -> Images:
    return film(WEDGE, CMYK)


@pytest.mark.parametrize("turned", TURNED)
@pytest.mark.parametrize("mirrored", [False, True])
def test_planted_inks_come_back_from_a_noisy_photograph(turned: str, mirrored: bool) -> None:
    """Noise of 1 % of white in every pixel, light that falls off by a third, aslant."""
    found = fit_inks(read_wedge(photograph(usual(), TURNED[turned], mirrored=mirrored), WEDGE))
    np.testing.assert_allclose(found.dyes.extinction, CMYK.extinction, rtol=0.01, atol=0.01)
    np.testing.assert_allclose(np.exp(-found.dyes.base), np.exp(-CMYK.base), rtol=0.006)
    for fitted, planted in zip(found.dyes.gain, CMYK.gain, strict=True):
        assert fitted is not None
        assert planted is not None
        np.testing.assert_allclose(fitted, planted, atol=0.01)
    assert found.residual < 0.002
    assert [("other side" in sentence) for sentence in found.said] == [True] * mirrored


def test_what_is_printed_through_the_fit_is_what_was_asked_for() -> None:
    """The planted printer, asked by the fitted inks' coverage, lays down the amounts; asked without, far too much."""
    found = fit_inks(read_wedge(photograph(usual()), WEDGE)).dyes
    amounts = np.linspace(0.02, 0.98, 13) * np.ones((4, 1))
    np.testing.assert_allclose(CMYK.amount(found.coverage(amounts)), amounts, atol=0.015)
    careless = replace(found, gain=())
    assert np.abs(CMYK.amount(careless.coverage(amounts)) - amounts).max() > 0.1


@pytest.mark.parametrize(("names", "steps"), [(("cyan", "magenta"), 32), (("yellow", "cyan", "magenta"), 16)])
def test_other_pages_are_read_too(names: tuple[str, ...], steps: int) -> None:
    planted, wedge = inks(*names, base=(0.0, 0.0, 0.0)), Wedge(names, steps)
    found = fit_inks(read_wedge(photograph(film(wedge, planted, windows=False), noise=0.003), wedge))
    np.testing.assert_allclose(found.dyes.extinction, planted.extinction, rtol=0.01, atol=0.01)
    assert found.dyes.gain[0] is not None
    assert len(found.dyes.gain[0]) == steps
    assert found.said == ["no window was cut into the film: what bare film absorbs is taken as nothing"]


def test_patches_lie_apart_and_within_the_page() -> None:
    for wedge in (WEDGE, Wedge(CMYK.names, 32), Wedge(tuple("abcdef")), Wedge(("a",))):
        middles = np.array([patch.middle_mm for patch in wedge.patches])
        others = np.concatenate([middles, MARKS_MM, WINDOWS_MM])
        apart = np.abs(others[:, None] - others).max(axis=2) + 100 * np.eye(len(others))
        assert apart.min() >= PATCH_MM + 2 - 1e-9
        assert np.all(others - PATCH_MM / 2 >= 10)
        assert np.all(others + PATCH_MM / 2 <= np.array(PAGE_MM) - 9.9)
        for patch in wedge.patches:
            assert sum(other.coverages == patch.coverages for other in wedge.patches) >= 2


def test_the_page_shows_each_patch_in_its_colour() -> None:
    picture, dots = page(WEDGE, 100), 100 / 25.4
    assert picture.shape == (1169, 827, 3)
    for patch in WEDGE.patches:
        x, y = patch.middle_mm
        c, m, yellow, k = patch.coverages
        expected = 255 * (1 - np.array([c, m, yellow])) * (1 - k)
        np.testing.assert_allclose(picture[round(y * dots), round(x * dots)], expected, atol=1)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"inks": ("cyan",), "steps": 17}, "16 or 32 steps, not 17"),
        ({"inks": ("cyan", "cyan")}, "names of their own"),
        ({"inks": tuple("abcdefghij")}, "10 inks at 16 steps are more than a page takes"),
        ({"inks": ("cyan", "orange")}, "a picture has no ink called 'orange'"),
    ],
)
def test_pages_that_cannot_be_are_refused(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        page(Wedge(**given))


def test_a_photograph_that_cannot_be_read_says_which_patch() -> None:
    photo = photograph(usual())
    with pytest.raises(InputError, match=r"is as bright as the photograph can be"):
        read_wedge(photograph(usual(), exposure=1.6), WEDGE)
    with pytest.raises(InputError, match=r"four corner marks, which have 1 to 4 holes, that with \d is not found"):
        read_wedge(np.ascontiguousarray(photo[:700]), WEDGE)
    with pytest.raises(InputError, match=r"corner marks"):
        read_wedge(np.full_like(photo, 0.5), WEDGE)
    with pytest.raises(InputError, match=r"pixels a mm in the photograph, and takes 3: go nearer"):
        read_wedge(photograph(usual(), side=800, noise=0.0), WEDGE)


def test_a_patch_that_is_covered_is_named_and_left_out() -> None:
    spoilt = usual().copy()
    dirty = next(patch for patch in WEDGE.patches if patch.coverages == (0.0, 0.4, 0.0, 0.0) and patch.row > 6)
    x, y = (round(along * 6) for along in dirty.middle_mm)
    spoilt[y - 30 : y + 30, x - 30 : x + 30] = 0.05
    found = fit_inks(read_wedge(photograph(spoilt), WEDGE))
    assert found.said == [f"{WEDGE.called(dirty)} is unlike its copy and was left out: it may be dirty"]
    np.testing.assert_allclose(found.dyes.extinction, CMYK.extinction, rtol=0.015, atol=0.01)


def test_inks_that_do_not_add_up_are_told() -> None:
    readings = read_wedge(photograph(usual(), noise=0.002), WEDGE)
    both = np.array([patch.coverages == (1.0, 1.0, 0.0, 0.0) for patch in readings.patches])
    light = np.where(both[:, None], readings.light**0.7, readings.light)
    (said,) = fit_inks(replace(readings, light=light)).said
    assert said.startswith("densities do not add up: cyan over magenta has density 1.")
    assert fit_inks(readings).said == []


def test_the_wrong_page_is_told() -> None:
    with pytest.raises(InputError, match=r"is the page that of --inks( and --steps)?\?"):
        fit_inks(read_wedge(photograph(usual()), Wedge(CMYK.names, 32)))
