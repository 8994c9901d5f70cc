"""Laws of the scores of reliefs."""

import numpy as np
import pytest

from lightcube.scoring.reliefs import blurred, compared, score_relief
from lightcube.solids.relief import Relief, ReliefRecipe
from lightcube.solids.relief_light import shown


def a_relief(cell: int = 1) -> Relief:
    random = np.random.default_rng(5)
    heights = random.uniform(0, 4, (9 * cell, 11 * cell + (cell > 1)))
    return Relief(heights, random.uniform(0.2, 1, (3, 9, 11)), ReliefRecipe(black=0.5), cell=cell)


def test_what_is_wanted_is_perfect() -> None:
    relief = a_relief()
    assert compared(relief, relief.wanted, 1.0) == [(100.0, 1.0)] * 3


def test_a_relief_whose_pictures_are_what_it_shows_is_perfect() -> None:
    relief = a_relief()
    right = Relief(relief.heights_px, np.minimum(shown(relief), 1.0), relief.recipe)
    scores = score_relief(right, off=True)
    assert (scores["psnr_min"], scores["near_psnr_min"], scores["ssim_mean"]) == (100.0, 100.0, 1.0)
    assert max(scores["off"].values()) < 60
    assert score_relief(relief)["psnr_mean"] < 30


def test_an_eye_blurs_columns_not_pixels() -> None:
    fine, coarse = a_relief(), a_relief(5)
    light = np.zeros((1, 9, 11))
    light[0, 4, 5] = 1.0
    assert blurred(coarse, light, 1.0).max() > 0.9 > 0.2 > blurred(fine, light, 1.0).max()
    assert blurred(fine, light, 2.0).sum() == pytest.approx(1, abs=1e-2)
