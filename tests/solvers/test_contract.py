"""What is wanted of a solver checks itself when it is made."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lightcube.errors import InputError
from lightcube.optics.law import Mixture
from lightcube.solvers.contract import Lighting, Wanted

ONE = np.ones((1, 1))


@pytest.mark.parametrize(
    ("match", "changes"),
    [
        (r"light wanted must be .*, not float64 of shape \(77,\)", {"light": np.ones(77)}),
        (r"light wanted must be .*, not float64 of shape \(77, 0\)", {"light": np.ones((77, 0))}),
        ("must be float32 or float64 .*, not int64", {"light": np.ones((77, 2), np.int64)}),
        ("light must be positive and finite", {"light": np.zeros((77, 2))}),
        ("light must be positive and finite", {"light": np.full((77, 2), np.nan)}),
        ("light of 77 rows does not fit 2 pictures", {"lighting": Lighting(np.arange(2))}),
        (r"weights of shape \(76, 2\) do not fit light", {"weights": np.ones((76, 2))}),
        ("weights must be finite and at least 0", {"weights": np.full((77, 1), -1.0)}),
        ("weights must be finite and at least 0", {"weights": np.full((77, 1), np.nan)}),
        ("weights must be finite and at least 0", {"weights": np.full((77, 1), np.inf)}),
        (
            "views name 3 lamps, but there are powers for 1",
            {"lighting": Lighting(np.full(7, 2)), "lamp_bounds": (ONE, ONE)},
        ),
        ("lamp powers must be positive", {"lamp_bounds": (0 * ONE, 0 * ONE)}),
        ("lamp powers must be positive", {"lamp_bounds": (ONE, np.inf * ONE)}),
        ("lamp powers must be positive", {"lamp_bounds": (np.ones(3), np.ones(3))}),
        ("lamp powers must be positive", {"lamp_bounds": (ONE, np.ones((1, 2)))}),
        ("unknown transfer 'gamma': use one of", {"transfer": "gamma"}),
        ("above the upper one: swap them", {"lamp_bounds": (2 * ONE, ONE)}),
    ],
)
def test_what_cannot_be_wanted_is_refused_with_a_sentence(match: str, changes: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=match):
        Wanted(**{"light": np.full((77, 2), 0.5), **changes})


@settings(max_examples=25)
@given(st.tuples(st.integers(0, 3), st.integers(0, 3)).filter(lambda shape: shape not in {(1, 1), (1, 2)}))
def test_weights_of_any_other_shape_are_refused(shape: tuple[int, int]) -> None:
    with pytest.raises(InputError, match="weights"):
        Wanted(np.full((77, 2), 0.5), np.ones(shape))


@settings(max_examples=25)
@given(
    where=st.tuples(st.integers(0, 76), st.integers(0, 1)),
    value=st.sampled_from([np.nan, np.inf, -np.inf, 0.0, -1e-30, -5.0]),
)
def test_light_that_is_none_is_refused_wherever_it_stands(where: tuple[int, int], value: float) -> None:
    light = np.full((77, 2), 0.5)
    light[where] = value
    with pytest.raises(InputError, match="light must be positive and finite"):
        Wanted(light)


@pytest.mark.parametrize("lamp", [np.zeros(3), np.zeros((3, 1), int), np.zeros(0, int), np.array([0, -1])])
def test_lamps_that_are_no_numbers_of_views_are_refused(lamp: Any) -> None:
    with pytest.raises(InputError, match=r"whole numbers, one per view|count from 0, not from -1"):
        Lighting(lamp)


def some_mixture(pixels: int = 6) -> Mixture:
    """Two pictures, of two views and of one, in 2 channels."""
    return Mixture(np.array([0, 2, 3]), np.ones((3, 2)), np.ones((3, pixels)), np.ones((3, pixels)))


@pytest.mark.parametrize(
    ("match", "changes"),
    [
        ("light of 5 rows does not fit 2 pictures", {"light": np.ones((5, 4))}),
        ("views of 6 pixels, .* do not fit light of shape", {"light": np.ones((6, 8))}),
        ("views of 6 pixels, .* do not fit light of shape", {"lamp_bounds": (np.ones((3, 1)), np.ones((3, 1)))}),
        (
            "views of 1 pixels, .* do not fit light of shape",
            {"light": np.ones((6, 3)), "lighting": Lighting(np.arange(3), some_mixture(1))},
        ),
        ("views name 3 lamps, but there are powers for 2", {"lamp_bounds": (np.ones((2, 2)), np.ones((2, 2)))}),
    ],
)
def test_what_does_not_fit_the_sums_is_refused(match: str, changes: dict[str, Any]) -> None:
    lamps = np.ones((3, 2)), np.ones((3, 2))
    given = {"light": np.ones((6, 4)), "lighting": Lighting(np.arange(3), some_mixture()), "lamp_bounds": lamps}
    with pytest.raises(InputError, match=match):
        Wanted(**{**given, **changes})
    with pytest.raises(InputError, match="lamps are named of 2 views, but 3 add up"):
        Lighting(np.arange(2), some_mixture())


def test_what_is_wanted_knows_its_equations_lamps_and_absorbance() -> None:
    powers = np.array([[1.0, 2.0], [3.0, 4.0]])
    light = np.random.default_rng(0).uniform(0.1, 1, (6, 4)).astype(np.float32)
    wanted = Wanted(light, np.float32(0.5) * np.ones((6, 1)), Lighting(np.array([1, 0, 1])), (powers, powers))
    assert (wanted.equations, wanted.channels, wanted.has_fixed_lamps) == (6, 2, True)
    assert wanted.weights.dtype == np.float32
    assert wanted.weights.shape == light.shape
    assert wanted.lighting.lamp_of_row(6).tolist() == [1, 1, 0, 0, 1, 1]
    lamp = powers[[1, 1, 0, 0, 1, 1]][:, [0, 1, 0, 1]]
    assert wanted.absorbance().dtype == np.float32
    np.testing.assert_allclose(wanted.absorbance(), np.log(lamp / light), rtol=1e-5)
    for pixels in (1, 6):
        lighting = Lighting(np.arange(3), some_mixture(pixels))
        assert Wanted(light, lighting=lighting, lamp_bounds=(np.ones((3, 2)), np.full((3, 2), 2.0))).equations == 9
