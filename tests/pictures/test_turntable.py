"""What is said of a turntable."""

import warnings
from typing import Any

import pytest

import lightcube as lc
from lightcube.optics.views import DoubtfulAngles


@pytest.mark.parametrize(
    "said",
    [
        {"angles_deg": [0, 1.5708, 3.1416, 4.7124]},
        {"angles_deg": [-3.1416, -1, 0, 3.1416]},
        {"angles_deg": [7, 7.1, 7.2]},
        {"span_deg": 6.2832},
        {"span_deg": 3.1416},
    ],
)
def test_angles_that_may_be_radians_are_told(said: dict[str, Any]) -> None:
    with pytest.warns(DoubtfulAngles, match="^turntable: .* if they are radians, multiply them by 57"):
        lc.Turntable(**said)


@pytest.mark.parametrize(
    "said", [{}, {"angles_deg": [0, 3]}, {"angles_deg": [0, 3, 6, 9]}, {"span_deg": 10}, {"span_deg": 180}]
)
def test_other_angles_are_taken_as_they_are(said: dict[str, Any]) -> None:
    with warnings.catch_warnings(action="error"):
        lc.Turntable(**said)
