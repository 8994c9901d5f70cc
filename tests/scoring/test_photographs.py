"""A photograph of a wall: found, straightened, exposed as promised, or refused."""

import numpy as np
import pytest

from lightcube.errors import InputError
from lightcube.optics.transfer import encode
from lightcube.pictures.projective import homography, projected
from lightcube.scoring.photographs import photographed, straightened

SHAPE = (12, 16)
#: A camera that stands a little aside and aslant.
CORNERS = np.array([[95.0, 60.0], [330.0, 82.0], [310.0, 241.0], [80.0, 262.0]])
#: Half a pixel of the picture, as the camera sees it.
HALF = 7.5


def promised(seed: int = 0) -> np.ndarray:
    """Smooth colours with some detail, in linear light."""
    random = np.random.default_rng(seed)
    rows, columns = SHAPE
    y, x = np.mgrid[0:rows, 0:columns] / (rows, columns)[0]
    waves = [0.35 + 0.25 * np.sin(a * x + b * y + c) for a, b, c in random.uniform(1, 7, (3, 3))]
    return np.clip(np.stack(waves, axis=-1) + random.uniform(0, 0.3, (*SHAPE, 3)), 0.01, 0.95).astype(np.float32)


def taken(picture: np.ndarray, corners: np.ndarray = CORNERS, noise: float = 0.0) -> np.ndarray:
    """The photograph of a lit picture in a dark room, pixel by pixel."""
    photo = np.full((320, 420, 3), 0.004, np.float32)
    rows, columns = picture.shape[:2]
    back = homography(corners, np.array([[0, 0], [columns, 0], [columns, rows], [0, rows]], np.float64))
    y, x = np.mgrid[0:320, 0:420] + 0.5
    at = projected(back, np.stack([x, y], axis=-1))
    inside = np.all((at >= 0) & (at < (columns, rows)), axis=-1)
    photo[inside] = picture[at[inside][:, 1].astype(int), at[inside][:, 0].astype(int)]
    random = np.random.default_rng(1)
    return np.clip(photo + noise * random.standard_normal(photo.shape), 0, 1).astype(np.float32)


def test_straightened_is_what_was_photographed() -> None:
    picture = promised()
    seen = straightened(taken(picture), CORNERS, SHAPE)
    assert np.abs(encode(seen) - encode(picture)).max() < 0.1
    assert np.abs(encode(seen) - encode(picture)).mean() < 0.01


def test_a_picture_is_found_in_the_dark_and_exposed_as_promised() -> None:
    picture = promised()
    exposed = (picture * (0.5, 0.7, 0.4)).astype(np.float32)
    found = photographed(taken(exposed, noise=0.004), picture)
    np.testing.assert_allclose(found.corners_px, CORNERS, atol=HALF)
    np.testing.assert_allclose(found.exposure, 1 / np.array([0.5, 0.7, 0.4]), rtol=0.03)
    figures = found.figures(picture, promised(5), np.ones(SHAPE, np.float32), "srgb")
    assert figures["promised"]["psnr"] > 32
    assert figures["wanted"]["psnr"] < 25
    assert not figures["mirrored"]
    np.testing.assert_allclose(figures["exposure_ev"], np.log2([0.5, 0.7, 0.4]), atol=0.05)


def test_rough_corners_are_enough() -> None:
    picture = promised()
    rough = CORNERS + np.array([[9, -7], [-8, 6], [5, 9], [-6, -8]])
    found = photographed(taken(picture), picture, rough)
    np.testing.assert_allclose(found.corners_px, CORNERS, atol=HALF)


@pytest.mark.parametrize("turn", [0, 1, 3])
def test_turned_and_mirrored_photographs_are_told(turn: int) -> None:
    picture = promised()
    corners = np.roll(CORNERS[::-1], turn, axis=0)
    found = photographed(taken(picture, corners), picture)
    assert found.is_mirrored
    np.testing.assert_allclose(found.corners_px, corners, atol=HALF)


def test_too_much_light_is_told() -> None:
    picture = promised()
    found = photographed(taken(np.minimum(2 * picture, 1.0)), picture)
    assert found.clipped > 0.2
    assert photographed(taken(picture), picture).clipped == 0


def test_another_picture_is_not_found() -> None:
    with pytest.raises(InputError, match="was not found in the photograph"):
        photographed(taken(promised(3)), promised(8), CORNERS)


@pytest.mark.parametrize(
    ("corners", "said"),
    [
        (CORNERS[:3], "four corners"),
        (CORNERS * np.nan, "four corners"),
        (CORNERS + 300, "outside the photograph"),
        (CORNERS[[0, 2, 1, 3]], "round the picture"),
    ],
)
def test_corners_that_are_none_are_refused(corners: np.ndarray, said: str) -> None:
    with pytest.raises(InputError, match=said):
        photographed(taken(promised()), promised(), corners)


def test_a_dark_photograph_and_one_without_colours_are_refused() -> None:
    with pytest.raises(InputError, match="nothing is lit"):
        photographed(np.zeros((9, 9, 3), np.float32), promised())
    with pytest.raises(InputError, match="other colours"):
        photographed(np.ones((9, 9, 1), np.float32), promised())
