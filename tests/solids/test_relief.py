"""Laws of reliefs: what a recipe refuses, the law of the floor, the two methods, light from anywhere, meshes."""

import math
import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.events import Interrupted
from lightcube.optics.transfer import decode
from lightcube.pictures.pictures import Pictures
from lightcube.scoring.reliefs import score_relief
from lightcube.solids import relief_annealing as annealing
from lightcube.solids import relief_light, relief_local
from lightcube.solids.mesh import Mesh
from lightcube.solids.relief import LAMPS_DEG, Relief, ReliefRecipe, darkest, display
from lightcube.solids.relief_light import bounced, relief_shadow, shown, unbounced
from lightcube.solids.relief_making import relief
from lightcube.solids.relief_mesh import relief_mesh
from lightcube.solids.relief_pictures import CroppedPictures, DarkPictures
from tests.conftest import INTERPRETED
from tests.helpers.reliefs import cast_by_triangles, marched, plain_light

SIDE = 12
QUICK = ReliefRecipe(side=SIDE, relief_px=4.0, sweeps=3)


def ramps(count: int, shape: tuple[int, int] = (20, 20)) -> Pictures:
    """Pictures that grow lighter in different directions."""
    y, x = np.indices(shape) / (np.array(shape)[:, None, None] - 1)
    tones = [x, y, (x + y) / 2, (1 - x) * y][:count] + [1 - x] * max(0, count - 4)
    images = tuple(decode(np.repeat(tone[..., None], 3, axis=2)).astype(np.float32) for tone in tones)
    return Pictures(images, tuple("abcdefgh"[:count]))


def plate(heights: Any, count: int = 1, **recipe: Any) -> Relief:
    """A relief of given heights."""
    heights = np.asarray(heights, np.float64)
    return Relief(heights, np.full((count, *heights.shape), 0.5), ReliefRecipe(**recipe))


def some_plate(shape: tuple[int, int] = (9, 13), most: float = 6.0, **recipe: Any) -> Relief:
    return plate(np.random.default_rng(3).uniform(0, most, shape), **recipe)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"side": 4}, "8 to 2048 columns a side, not 4"),
        ({"side": 4000}, "not 4000"),
        ({"relief_px": 0.1}, "0.5 to 200 columns high"),
        ({"relief_px": math.nan}, "relief_px"),
        ({"black": 1.2}, "from 0 to 0.95, not 1.2"),
        ({"pitch_mm": 0.01}, "columns of 0.01 mm cannot be made"),
        ({"pitch_mm": math.inf}, "columns of inf mm"),
        ({"tolerance_deg": -1.0}, "cannot stand -1 degrees off"),
        ({"elevation_deg": 3.0}, "5 to 80 degrees high, not 0 to 6"),
        ({"elevation_deg": 79.0}, "not 76 to 82"),
        ({"layer_mm": 0.0}, "layers of 0 mm"),
        ({"layer_mm": 9.0}, "a relief 8 mm high"),
        ({"steepest_px": 0.0}, "give more than 0"),
        ({"smooth": -1.0}, "0 to 10"),
        ({"sweeps": 0}, "1 to 100000 times"),
        ({"seed": -1}, "a seed is a whole number from 0 on, not -1"),
        ({"base_mm": 0.0}, "0.1 to 1000 mm thick"),
        ({"frame_mm": -2.0}, "0 to 1000 mm wide"),
        ({"method": "magic"}, "use one of global, local"),
    ],
)
def test_a_recipe_refuses_what_cannot_be(wrong: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        ReliefRecipe(**wrong)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"heights_px": np.full((2, 3), -1.0)}, "negative or non-finite"),
        ({"heights_px": np.full((2, 3), np.nan)}, "negative or non-finite"),
        ({"heights_px": np.zeros((3, 3))}, "do not fit pictures of 2 x 3"),
        ({"wanted": np.zeros((5, 2, 3))}, "1 to 4 pictures"),
        ({"wanted": np.full((1, 2, 3), 2.0)}, "from 0 to 1 at every pixel"),
        ({"is_colour": True}, "three colours"),
        ({"names": ("a", "b")}, "give one per picture"),
        ({"cell": 2}, "do not fit pictures of 4 x 6"),
    ],
)
def test_a_relief_refuses_what_does_not_fit(wrong: dict[str, Any], said: str) -> None:
    right: dict[str, Any] = {"heights_px": np.zeros((2, 3)), "wanted": np.zeros((1, 2, 3)), "recipe": ReliefRecipe()}
    Relief(**right)
    with pytest.raises(InputError, match=said):
        Relief(**{**right, **wrong})


def test_sizes_are_those_of_the_plate() -> None:
    made = plate([[0, 1, 0], [0, 0, 2]], pitch_mm=0.5, elevation_deg=60.0, base_mm=3.0, frame_mm=4.0)
    assert made.heights_mm.max() == pytest.approx(2 * 0.5 * math.sqrt(3))
    assert made.size_mm == pytest.approx((9.5, 9.0, 3 + math.sqrt(3)))
    assert repr(made) == "<Relief of 1 picture, 3 x 2 columns, 1.73 mm>"


@given(st.integers(1, 9), st.integers(0, 1000))
@settings(max_examples=40)
def test_no_heights_are_darker_than_the_law_of_the_floor(most: int, seed: int) -> None:
    heights = np.random.default_rng(seed).uniform(0, most, (4, 17)) ** 3 / most**2
    for lamp in (0, 1):
        assert plain_light(heights, lamp).mean(axis=1).min() >= darkest(most) - 1e-12


def test_a_comb_is_as_dark_as_the_law_of_the_floor() -> None:
    heights = np.zeros((2, 24))
    heights[:, 3::4] = 3.0
    assert plain_light(heights, 0)[:, :20].mean() == pytest.approx(darkest(3.0))


@pytest.mark.parametrize(("relief_px", "tolerance_deg"), [(10.0, 0.0), (10.0, 3.0), (4.0, 5.0)])
def test_black_keeps_the_law_of_the_floor_where_nothing_is_said(relief_px: float, tolerance_deg: float) -> None:
    recipe = ReliefRecipe(relief_px=relief_px, tolerance_deg=tolerance_deg)
    shortest = relief_px / max(recipe.slopes)
    assert display(darkest(shortest)) < recipe.black_level < display(2 * darkest(shortest))


def test_a_darker_black_than_can_be_is_told() -> None:
    with pytest.warns(DarkPictures, match=r"black 0.1 is darker than a relief of 4 columns can show"):
        made = relief(ramps(1), replace(QUICK, black=0.1))
    assert made.recipe.black == 0.1


def test_pictures_are_stretched_from_black_to_white() -> None:
    made = relief(ramps(2), replace(QUICK, black=0.6))
    for picture in made.wanted:
        assert picture.min() == pytest.approx(float(decode(np.array([0.6]))[0]))
        assert picture.max() == pytest.approx(1)
    assert np.all(np.diff(made.wanted[0], axis=1) >= -1e-6)
    assert np.ptp(made.wanted[0], axis=0).max() < 1e-6


def test_pictures_that_are_no_squares_are_cropped_and_it_is_told() -> None:
    with pytest.warns(CroppedPictures, match=r"a \(31 x 20\) cropped to 20 x 20: a relief is a square"):
        made = relief(ramps(1, (20, 31)), QUICK)
    assert made.wanted.shape == (1, SIDE, SIDE)


@pytest.mark.parametrize(("tone", "called"), [(0.0, "black"), (1.0, "white"), (0.3, "of one tone")])
def test_an_even_picture_is_refused(tone: float, called: str) -> None:
    even = Pictures((np.full((9, 9, 3), tone, np.float32),), ("dull",))
    with pytest.raises(InputError, match=f"picture dull is all {called}"):
        relief(even, QUICK)


def test_a_few_pixels_on_an_even_ground_are_a_picture() -> None:
    light = np.ones((24, 24, 3), np.float32)
    light[7, :3] = 0.0
    made = relief(Pictures((light,), ("specks",)), replace(QUICK, side=24))
    assert np.ptp(made.wanted) > 0.5


def test_too_many_pictures_none_and_nan_are_refused() -> None:
    with pytest.raises(InputError, match="1 to 4 pictures, not 5"):
        relief(ramps(5), QUICK)
    with pytest.raises(InputError, match="give a picture"):
        relief(Pictures((), ()), QUICK)
    with pytest.raises(InputError, match="one colour picture, not 2"):
        relief(ramps(2), QUICK, colour=True)
    broken = np.full((9, 9, 3), np.nan, np.float32)
    with pytest.raises(InputError, match="picture holes holds NaN"):
        relief(Pictures((broken,), ("holes",)), QUICK)


def test_four_pictures_come_nearer_than_a_bare_plate() -> None:
    made = relief(ramps(4), replace(QUICK, sweeps=3 if INTERPRETED else 30))
    bare = replace(made, heights_px=np.zeros((SIDE, SIDE)))
    found, before = score_relief(made), score_relief(bare)
    assert found["psnr_mean"] > before["psnr_mean"] + (1 if INTERPRETED else 6)
    assert [each["azimuth_deg"] for each in found["pictures"]] == list(LAMPS_DEG)
    assert made.heights_px.max() <= 4


def test_one_colour_picture_is_three_greys() -> None:
    image = np.random.default_rng(0).random((SIDE, SIDE, 3), dtype=np.float32)
    made = relief(Pictures((image,), ("rose",)), QUICK, colour=True)
    assert made.names == ("rose red", "rose green", "rose blue")
    assert relief_light.coloured(made, made.wanted).shape == (1, SIDE, SIDE, 3)
    for plane, wanted in zip(np.moveaxis(image, 2, 0), made.wanted, strict=True):
        assert np.corrcoef(plane.ravel(), wanted.ravel())[0, 1] > 0.9


def test_work_stops_where_it_is_told_to() -> None:
    heard = []

    def tell(event: Any) -> bool:
        heard.append((event.done, event.of))
        return event.done == 2

    with pytest.raises(Interrupted):
        relief(ramps(1), replace(QUICK, sweeps=9), tell=tell)
    assert heard == [(1, 9), (2, 9)]


def test_heights_are_whole_layers() -> None:
    made = relief(ramps(2), replace(QUICK, layer_mm=0.3))
    layers = made.heights_mm / 0.3
    np.testing.assert_allclose(layers, np.rint(layers), atol=1e-9)
    assert np.unique(np.rint(layers)).size > 3


# The local method


def flat_pictures(count: int, shape: tuple[int, int] = (5, 7), width: int = 4) -> NDArray[np.float64]:
    return np.random.default_rng(4).uniform(darkest(width), 1, (count, *shape))


@pytest.mark.parametrize(("count", "width"), [(1, 4), (2, 4), (2, 1), (2, 7)])
def test_walls_and_floors_show_the_very_pictures(count: int, width: int) -> None:
    wanted = flat_pictures(count, width=width)
    heights, drift = relief_local.walled(wanted, width)
    pixels = wanted.shape[2] * (width + 1)
    for lamp, picture in enumerate(wanted):
        light = plain_light(heights, lamp)[:, :pixels]
        np.testing.assert_allclose(relief_light.in_cells(light, width + 1), picture, atol=1e-9)
    walls = heights[:: width + 1, :: width + 1]
    assert drift == pytest.approx(np.ptp(walls, axis=1).max())
    assert heights.min() == pytest.approx(0)
    assert (drift < 1e-9) == (count == 1)


def test_a_local_relief_is_refused_where_it_would_be_too_high() -> None:
    recipe = replace(QUICK, method="local", side=60, relief_px=40.0)
    made = relief(ramps(2), recipe)
    assert (made.cell, made.wanted.shape, made.heights_px.shape) == (5, (2, 12, 12), (60, 61))
    high = made.heights_px.max()
    assert made.provenance["drift_px"] <= high <= 40
    np.testing.assert_allclose(
        [relief_light.in_cells(plain_light(made.heights_px, lamp)[:, :60], 5) for lamp in (0, 1)],
        made.wanted,
        atol=1e-9,
    )
    assert score_relief(made)["near_psnr_min"] > 40
    with pytest.raises(
        InputError, match=rf"need a relief {high:.1f} columns high.*walls drift.*allow {math.ceil(high)}"
    ):
        relief(ramps(2), replace(recipe, relief_px=high - 0.5))


def test_the_local_method_has_two_sides_and_enough_columns() -> None:
    for pictures, colour, said in ((ramps(3), False, "3 pictures"), (ramps(1), True, "three colours")):
        with pytest.raises(InputError, match=f"two sides of a wall.*{said}"):
            relief(pictures, replace(QUICK, method="local"), colour=colour)
    with pytest.raises(InputError, match="pixels of 5 columns for such a black do not fit 9 columns"):
        relief(ramps(2), replace(QUICK, method="local", side=9))


def test_a_darker_black_takes_wider_floors() -> None:
    widths = [relief_local.width_of(ReliefRecipe(black=black)) for black in (0.7, 0.5, 0.4, None)]
    assert widths == [2, 4, 7, 4]
    for black, width in zip((0.7, 0.5, 0.4), widths, strict=False):
        assert display(darkest(width)) <= black


# Light


@pytest.mark.parametrize("lamp", range(4))
def test_light_under_the_lamps_is_what_is_solved_for(lamp: int) -> None:
    made = some_plate()
    off = relief_shadow(made, LAMPS_DEG[lamp]) - plain_light(made.heights_px, lamp)
    assert np.sqrt(np.mean(off**2)) < 0.01
    off = relief_shadow(made, LAMPS_DEG[lamp], 50.0) - plain_light(made.heights_px, lamp, math.tan(math.radians(50)))
    assert np.sqrt(np.mean(off**2)) < 0.01


@pytest.mark.parametrize(("azimuth_deg", "elevation_deg"), [(0, 45), (90, 48), (202, 45), (317, 31), (45, 60)])
def test_light_from_anywhere_is_what_small_steps_find(azimuth_deg: float, elevation_deg: float) -> None:
    made = some_plate()
    found = marched(made.heights_px, azimuth_deg, math.tan(math.radians(elevation_deg)), 12)
    assert np.sqrt(np.mean((relief_shadow(made, azimuth_deg, elevation_deg) - found) ** 2)) < 0.035
    assert 0.1 < found.mean() < 0.9


def test_heights_are_for_the_elevation_that_a_relief_is_made_for() -> None:
    low, high = (some_plate(elevation_deg=deg) for deg in (30.0, 60.0))
    np.testing.assert_array_equal(relief_shadow(low, 20.0), relief_shadow(high, 20.0))
    assert high.heights_mm.max() == pytest.approx(3 * low.heights_mm.max())


@pytest.mark.parametrize("wrong", [0.0, 90.0, -5.0])
def test_a_lamp_stands_above_the_plate_and_aside(wrong: float) -> None:
    with pytest.raises(InputError, match="0 to 90 degrees high"):
        relief_shadow(some_plate(), 0.0, wrong)


def test_lamps_that_stand_wrong_are_cast_as_such() -> None:
    made = replace(some_plate(), wanted=np.full((2, 9, 13), 0.5), names=())
    np.testing.assert_array_equal(shown(made, (10.0, -5.0))[1], relief_shadow(made, 190.0, 40.0))


# Meshes


@pytest.mark.parametrize("frame_mm", [0.0, 3.0])
def test_a_mesh_is_closed_whatever_the_heights_are(frame_mm: float) -> None:
    for heights in ([[5, 0, 2], [0, 5, 2]], np.zeros((2, 3)), some_plate().heights_px):
        made = plate(heights, frame_mm=frame_mm)
        mesh = relief_mesh(made)
        assert mesh.is_watertight
        assert Mesh.of_triangles(mesh.triangles.astype(np.float32).astype(np.float64)).is_watertight
        assert mesh.size_mm == pytest.approx(made.size_mm)
        assert mesh.vertices_mm.min(axis=0) == pytest.approx(np.zeros(3))
        pitch, columns = made.recipe.pitch_mm, made.heights_px.size
        whole = made.size_mm[0] * made.size_mm[1] * made.recipe.base_mm
        above = mesh.volume_mm3 - whole
        assert above == pytest.approx(made.heights_mm.mean() * columns * pitch**2, rel=0.05, abs=1e-6)


def test_a_mesh_throws_the_shadows_of_its_columns() -> None:
    """Rays from the tops that columns have, past all triangles."""
    made = some_plate((6, 7) if INTERPRETED else (12, 14), pitch_mm=0.5, elevation_deg=40.0, frame_mm=1.0)
    mesh, recipe = relief_mesh(made), made.recipe
    rows, columns = made.heights_px.shape
    over = 4
    y, x = (np.arange(side * over) + 0.5 for side in (rows, columns))
    at_y, at_x = np.meshgrid(y / over, x / over, indexing="ij")
    tops = recipe.base_mm + made.heights_mm[at_y.astype(int), at_x.astype(int)]
    points = np.stack([1 + at_x * recipe.pitch_mm, 1 + (rows - at_y) * recipe.pitch_mm, tops + 1e-6], axis=-1).reshape(
        -1, 3
    )
    for azimuth_deg in (0.0, 90.0, 200.0):
        azimuth, high = math.radians(azimuth_deg), math.radians(40.0)
        to_lamp = np.array([math.cos(azimuth) * math.cos(high), math.sin(azimuth) * math.cos(high), math.sin(high)])
        lit = cast_by_triangles(mesh, points, to_lamp).reshape(rows, over, columns, over).mean(axis=(1, 3))
        off = lit - relief_shadow(made, azimuth_deg)
        assert np.sqrt(np.mean(off**2)) < 0.06
        assert abs(off.mean()) < 0.02


def test_nothing_is_said_of_pictures_that_fit() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        relief(ramps(1), QUICK)
    assert annealing.reach(QUICK) == 10


def test_a_plate_throws_a_part_of_its_mean_light_into_its_shadows() -> None:
    heights, wanted = np.random.default_rng(3).uniform(0, 5, (9, 11)), np.full((1, 9, 11), 0.6)
    plain, bright = (Relief(heights, wanted, ReliefRecipe(black=0.5, bounce=bounce)) for bounce in (0.0, 0.2))
    for azimuth in (0.0, 130.0):
        lit, shown_ = relief_shadow(plain, azimuth), relief_shadow(bright, azimuth)
        np.testing.assert_allclose(shown_, lit + 0.2 * (1 - lit) * lit.mean(), rtol=1e-12)
        assert shown_.max() == 1.0
        assert shown_.min() > lit.min()


@pytest.mark.parametrize("bounce", [0.0, 0.05, 0.3, 0.5])
def test_what_is_unbounced_bounces_back(bounce: float) -> None:
    shown_ = np.random.default_rng(4).uniform(0.35, 1, (3, 8, 5))
    lit = unbounced(shown_, bounce)
    np.testing.assert_allclose(bounced(lit, bounce), shown_, rtol=1e-9)
    assert bool(np.all(lit < shown_)) == (bounce > 0)
    assert unbounced(np.zeros((1, 4, 4)), bounce).min() == 0  # darker than such a plate can be


def test_who_knows_that_light_bounces_comes_nearer() -> None:
    pictures = ramps(2)
    asked = ReliefRecipe(side=24, relief_px=6, sweeps=40, black=0.55, bounce=0.3)
    blind = relief(pictures, replace(asked, bounce=0.0))
    knows = relief(pictures, asked)
    under = replace(blind, recipe=asked)
    assert score_relief(knows)["psnr_mean"] > score_relief(under)["psnr_mean"] + 1


def test_black_is_lighter_where_light_bounces() -> None:
    levels = [ReliefRecipe(bounce=bounce).black_level for bounce in (0.0, 0.1, 0.3)]
    assert levels == sorted(set(levels))
    with pytest.raises(InputError, match=r"throws 0 to 0\.5 of its light into its shadows, not 0\.6"):
        ReliefRecipe(bounce=0.6)
