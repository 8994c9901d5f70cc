"""From pictures to targets: sizes, resampling, angles, and what is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid, picture_shape
from lightcube.optics.setups import turntable
from lightcube.optics.transfer import to_uint16
from lightcube.optics.views import distinct_angles, spread_angles
from lightcube.pictures.fitting import Fit, as_levels, cut_off, fit, fit_report, targets_of
from lightcube.pictures.pictures import Pictures
from lightcube.pictures.targets import Targets
from tests.helpers.recipes import fitted

GRID = Grid((12, 16, 14))
FITS: tuple[Fit, ...] = ("crop", "pad", "stretch")
Plane = NDArray[np.float64]


def pictures(*sizes: tuple[int, int], seed: int = 23) -> Pictures:
    """Noise of the given sizes (rows, columns), values from 0.1 to 0.9."""
    random = np.random.default_rng(seed)
    images = tuple(random.uniform(0.1, 0.9, (*size, 3)).astype(np.float32) for size in sizes)
    return Pictures(images, tuple(f"p{index}" for index in range(len(images))))


def lanczos(values: Plane, size: int, start: float, stop: float) -> Plane:
    """Axis 0 of `values` from `start` to `stop` at `size` samples: a windowed sinc, widened when shrinking."""
    step = (stop - start) / size
    wide = max(step, 1.0)
    result = []
    for index in range(size):
        centre = start + (index + 0.5) * step
        total, weights = np.zeros(values.shape[1:]), 0.0
        for source in range(len(values)):
            x = (source + 0.5 - centre) / wide
            weight = float(np.sinc(x) * np.sinc(x / 3)) if abs(x) < 3 else 0.0
            total = total + weight * values[source]
            weights += weight
        result.append(total / weights)
    return np.array(result)


def plain_resize(image: NDArray[np.float32], rows: int, columns: int, box: tuple[float, ...]) -> Plane:
    """Both axes, clipped to the range of each channel."""
    left, top, right, bottom = box
    across = lanczos(image.astype(float).transpose(1, 0, 2), columns, left, right).transpose(1, 0, 2)
    both = lanczos(across, rows, top, bottom)
    return np.clip(both, image.min(axis=(0, 1)), image.max(axis=(0, 1)))


@pytest.mark.parametrize("mode", FITS)
@pytest.mark.parametrize("elevation_deg", [0.0, 30.0])
@pytest.mark.parametrize("shape", [(12, 16), (6, 8), (10, 14), (12, 6)])
def test_at_the_targets_size_pictures_are_not_touched(mode: Fit, elevation_deg: float, shape: tuple[int, int]) -> None:
    read = pictures(shape, shape, shape)
    targets = fitted(read, GRID, elevation_deg=elevation_deg, picture_width=shape[1] / 16, fit_mode=mode)
    assert targets.rig.picture_shape == shape
    np.testing.assert_array_equal(targets.pictures.view(np.uint32), np.stack(read.images).view(np.uint32))
    np.testing.assert_array_equal(targets.weight, 1)
    assert targets.names == read.names


@pytest.mark.parametrize("size", [(14, 18), (22, 26), (18, 22), (49, 47), (61, 59)])
def test_rounding_of_the_aspect_touches_nothing(size: tuple[int, int]) -> None:
    read = pictures(size, size)
    targets = fitted(read, Grid((size[0], size[1], size[1])))
    np.testing.assert_array_equal(targets.pictures, np.stack(read.images))


@pytest.mark.parametrize("first", [(9, 12), (30, 40), (45, 60), (31, 40)])
def test_crop_is_a_centred_lanczos_of_the_part_with_the_right_aspect(first: tuple[int, int]) -> None:
    read = pictures(first, (40, 30), (11, 60), (12, 17))
    targets = fitted(read, GRID)
    rows, columns = picture_shape(GRID, 1.0, first[1] / first[0])
    assert targets.rig.picture_shape == (rows, columns)
    for image, frame in zip(read.images, targets.pictures, strict=True):
        high, wide = image.shape[:2]
        aspect = columns / rows
        if wide > high * aspect:
            rest = (wide - high * aspect) / 2
            box = (rest, 0, wide - rest, high)
        else:
            rest = (high - wide / aspect) / 2
            box = (0, rest, wide, high - rest)
        np.testing.assert_allclose(frame, plain_resize(image, rows, columns, box), atol=2e-5)


def test_stretch_takes_all_of_each_picture() -> None:
    read = pictures((9, 12), (40, 30), (5, 60))
    targets = fitted(read, GRID, fit_mode="stretch")
    for image, frame in zip(read.images, targets.pictures, strict=True):
        high, wide = image.shape[:2]
        np.testing.assert_allclose(frame, plain_resize(image, 12, 16, (0, 0, wide, high)), atol=2e-5)


@pytest.mark.parametrize(
    ("size", "inside"),
    [
        ((24, 16), (12, 8)),
        ((12, 8), (12, 8)),
        ((8, 32), (4, 16)),
        ((12, 16), (12, 16)),
        ((1, 100), (2, 16)),
        ((23, 16), (12, 8)),
    ],
)
def test_pad_keeps_all_and_does_not_care_about_the_rest(size: tuple[int, int], inside: tuple[int, int]) -> None:
    read = pictures((24, 32), size)
    targets = fitted(read, GRID, fit_mode="pad")
    assert targets.rig.picture_shape == (12, 16)
    top, left = (12 - inside[0]) // 2, (16 - inside[1]) // 2
    window = (slice(top, top + inside[0]), slice(left, left + inside[1]))
    wanted = plain_resize(read.images[1], *inside, (0, 0, size[1], size[0]))
    np.testing.assert_allclose(targets.pictures[1][window], wanted, atol=2e-5)
    if size == inside:
        np.testing.assert_array_equal(targets.pictures[1][window], read.images[1])
    outside = np.ones((12, 16), bool)
    outside[window] = False
    np.testing.assert_array_equal(targets.weight[1], ~outside)
    np.testing.assert_array_equal(targets.pictures[1][outside], 1)
    np.testing.assert_array_equal(targets.weight[0], 1)


def test_pad_never_loses_a_picture_altogether() -> None:
    for grid in (Grid((3, 5, 7)), Grid((4, 6, 6)), Grid((1, 1, 1)), Grid((2, 2, 2))):
        targets = fitted(pictures((20, 20), (1, 300), (300, 1)), grid, fit_mode="pad")
        assert np.all(targets.weight.max(axis=(1, 2)) == 1)


@settings(max_examples=60)
@given(
    sizes=st.lists(st.tuples(st.integers(1, 20), st.integers(1, 20)), min_size=2, max_size=4),
    shape=st.tuples(*[st.integers(1, 9)] * 3),
    mode=st.sampled_from(FITS),
    picture_width=st.floats(0.2, 1.0),
    elevation_deg=st.sampled_from([0.0, 35.0, -20.0]),
)
def test_laws_of_any_fit(
    sizes: list[tuple[int, int]], shape: tuple[int, int, int], mode: Fit, picture_width: float, elevation_deg: float
) -> None:
    read = pictures(*sizes)
    grid = Grid(shape)
    try:
        targets = fitted(read, grid, picture_width=picture_width, elevation_deg=elevation_deg, fit_mode=mode)
    except InputError as error:
        assert "wider than the cube's screen" in str(error)  # noqa: PT017 - any other exception fails the test
        return
    first = read.images[0].shape
    assert targets.rig.picture_shape == picture_shape(grid, picture_width, first[1] / first[0], elevation_deg)
    assert targets.pictures.dtype == np.float32
    for image, frame, weight in zip(read.images, targets.pictures, targets.weight, strict=True):
        assert set(np.unique(weight)) <= {0, 1}
        assert weight.max() == 1
        inside = frame[weight > 0]
        assert np.all(inside >= image.min(axis=(0, 1)))
        assert np.all(inside <= image.max(axis=(0, 1)))
        np.testing.assert_array_equal(frame[weight == 0], 1)
    flat = replace(read, images=tuple(image * 0 + np.float32(0.3) for image in read.images))
    same = fitted(flat, grid, picture_width=picture_width, elevation_deg=elevation_deg, fit_mode=mode)
    np.testing.assert_array_equal(same.pictures[same.weight > 0], np.float32(0.3))
    mirrored = replace(read, images=tuple(image[::-1, ::-1] for image in read.images))
    turned = fitted(mirrored, grid, picture_width=picture_width, elevation_deg=elevation_deg, fit_mode=mode)
    np.testing.assert_allclose(turned.pictures, targets.pictures[:, ::-1, ::-1], atol=2e-5)
    np.testing.assert_array_equal(turned.weight, targets.weight[:, ::-1, ::-1])


def test_shrinking_keeps_the_light() -> None:
    """A fine checker of black and white becomes half the light, not half the display value."""
    checker = np.indices((96, 128)).sum(axis=0) % 2
    image = np.repeat(checker[:, :, None].astype(np.float32), 3, axis=2)
    targets = fitted(Pictures((image, image), ("a", "b")), GRID)
    np.testing.assert_allclose(targets.pictures, 0.5, atol=1e-3)


class TestAngles:
    def test_those_asked_for_win(self) -> None:
        read = replace(pictures((12, 16), (12, 16)), angles_deg=np.array([1.0, 2.0]), elevation_deg=10.0)
        targets = fitted(read, GRID, angles_deg=[30, -40], elevation_deg=20)
        np.testing.assert_allclose(targets.rig.views.angles_deg, [30, 320])
        np.testing.assert_allclose(targets.rig.views.elevations_deg, 20)

    def test_then_a_span(self) -> None:
        read = replace(pictures((12, 16), (12, 16)), angles_deg=np.array([1.0, 2.0]))
        np.testing.assert_allclose(fitted(read, GRID, span_deg=90).angles_deg, spread_angles(2, 90))

    def test_then_those_of_the_pictures(self) -> None:
        read = replace(pictures((12, 16), (12, 16)), angles_deg=np.array([1.0, 2.0]), elevation_deg=10.0)
        targets = fitted(read, GRID)
        np.testing.assert_allclose(targets.rig.views.angles_deg, [1, 2])
        np.testing.assert_allclose(targets.rig.views.elevations_deg, 10)
        np.testing.assert_allclose(fitted(read, GRID, elevation_deg=0).rig.views.elevations_deg, 0)

    @pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
    def test_else_spread_evenly(self, elevation_deg: float) -> None:
        targets = fitted(pictures(*[(12, 16)] * 5), GRID, elevation_deg=elevation_deg)
        np.testing.assert_allclose(targets.rig.views.angles_deg, spread_angles(5, elevation_deg=elevation_deg))

    @pytest.mark.parametrize("angles_deg", [[0, 360], [10, -350], [5, 5], [-1e-12, 0], [359.9999999999, 0]])
    def test_the_same_view_twice_is_refused(self, angles_deg: list[float]) -> None:
        with pytest.raises(InputError, match=r"number 1 and 2 .* are the same view"):
            fitted(pictures((12, 16), (12, 16)), GRID, angles_deg=angles_deg)
        with pytest.raises(InputError, match=r"number 1 and 2 .* are the same view"):
            distinct_angles(angles_deg)

    @settings(max_examples=100)
    @given(angles_deg=st.lists(st.integers(-2000, 2000), min_size=1, max_size=6))
    def test_distinct_angles_are_those_with_distinct_remainders(self, angles_deg: list[int]) -> None:
        if len({angle_deg % 360 for angle_deg in angles_deg}) == len(angles_deg):
            np.testing.assert_array_equal(distinct_angles(angles_deg), angles_deg)
        else:
            with pytest.raises(InputError, match="same view"):
                distinct_angles(angles_deg)


class TestRefused:
    @pytest.mark.parametrize("bad", [math.nan, math.inf])
    def test_angles_that_are_not_finite(self, bad: float) -> None:
        with pytest.raises(InputError, match="angle number 2"):
            fitted(pictures((12, 16), (12, 16)), GRID, angles_deg=[0, bad])

    def test_another_number_of_angles(self) -> None:
        with pytest.raises(InputError, match="3 angles for 2 pictures"):
            fitted(pictures((12, 16), (12, 16)), GRID, angles_deg=[10, 20, 30])

    def test_angles_and_span(self) -> None:
        with pytest.raises(InputError, match="use one of the two"):
            fitted(pictures((12, 16), (12, 16)), GRID, angles_deg=[1, 2], span_deg=90)

    @pytest.mark.parametrize("span_deg", [0, 361, math.nan])
    def test_spans(self, span_deg: float) -> None:
        with pytest.raises(InputError, match="span"):
            fitted(pictures((12, 16), (12, 16)), GRID, span_deg=span_deg)

    @pytest.mark.parametrize("elevation_deg", [90, -90, math.nan, math.inf])
    def test_elevations(self, elevation_deg: float) -> None:
        with pytest.raises(InputError, match="elevation"):
            fitted(pictures((12, 16), (12, 16)), GRID, elevation_deg=elevation_deg)

    @pytest.mark.parametrize("count", [0, 1])
    def test_fewer_than_two_pictures(self, count: int) -> None:
        with pytest.raises(InputError, match=f"^{count} picture{'s' if count != 1 else ''} cannot"):
            fitted(pictures(*[(12, 16)] * count), GRID)

    def test_pictures_wider_than_the_screen(self) -> None:
        with pytest.raises(InputError, match="wider than its screen"):
            fitted(pictures((12, 16), (12, 16)), GRID, picture_width=2)

    @pytest.mark.parametrize("picture_width", [0, -1, math.nan, math.inf])
    def test_widths(self, picture_width: float) -> None:
        with pytest.raises(InputError, match=r"picture.width"):
            fitted(pictures((12, 16), (12, 16)), GRID, picture_width=picture_width)

    def test_unknown_fits(self) -> None:
        with pytest.raises(InputError, match="crop, pad, stretch"):
            fitted(pictures((12, 16), (12, 16)), GRID, fit_mode="squeeze")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("sizes", "mode", "line"),
    [
        ([(12, 16)] * 3, "crop", "3 pictures of 16 x 12 pixels, not resampled"),
        ([(24, 32)] * 3, "crop", "3 pictures, scaled from 32 x 24 pixels to 16 x 12 pixels"),
        ([(24, 32), (48, 64)], "pad", "2 pictures, scaled from 32 x 24 pixels and 1 other size to 16 x 12 pixels"),
        ([(23, 31)] * 2, "crop", "2 pictures, scaled from 31 x 23 pixels to 16 x 12 pixels"),
        ([(100, 149)] * 2, "crop", "2 pictures, scaled from 149 x 100 pixels to 16 x 10 pixels"),
        (
            [(24, 32), (30, 32), (9, 9)],
            "crop",
            (
                "3 pictures, scaled from 32 x 24 pixels and 2 other sizes to 16 x 12 pixels, cropped to the shape of "
                "{}, 4:3"
            ),
        ),
        (
            [(100, 149), (30, 32)],
            "pad",
            (
                "2 pictures, scaled from 149 x 100 pixels and 1 other size to 16 x 10 pixels, padded to the shape of "
                "{}, about 3:2"
            ),
        ),
        (
            [(32, 32), (48, 32), (32, 32)],
            "stretch",
            (
                "3 pictures, scaled from 32 x 32 pixels and 1 other size to 16 x 16 pixels, stretched to the shape of "
                "{}, a square"
            ),
        ),
        (
            [(100, 103), (30, 60)],
            "crop",
            (
                "2 pictures, scaled from 103 x 100 pixels and 1 other size to 16 x 16 pixels, cropped to the shape of "
                "{}, 1.03:1"
            ),
        ),
    ],
)
def test_the_report_says_what_was_done(sizes: list[tuple[int, int]], mode: Fit, line: str) -> None:
    read = pictures(*sizes)
    assert fit_report(read, fitted(read, GRID, fit_mode=mode), mode) == line.format(read.names[0])


@pytest.mark.parametrize("focus", [(0.5, 0.5), (0, 1)])
def test_a_cropped_picture_loses_what_its_shape_has_too_much(focus: tuple[float, float]) -> None:
    read = replace(pictures((24, 32), (24, 64), (96, 32), (12, 16)), focus=focus)
    assert cut_off(read, fitted(read, GRID)) == pytest.approx([0, 1 / 2, 3 / 4, 0])


class TestTargets:
    def targets(self) -> Targets:
        random = np.random.default_rng(24)
        light = random.uniform(0, 1.2, (2, 3, 5, 3)).astype(np.float32)
        weights = random.uniform(0.001, 4, (2, 3, 5)).astype(np.float32)
        weights[0, 0] = 0
        weights[1, 2, 4] = 4
        weights[0, 1, 1] = 1e-6
        return Targets(light, turntable(Grid((3, 5, 7)), [1, 2], picture_shape=(3, 5)), weights, ("a", "b"), "linear")

    def test_levels_and_scaled_weights(self) -> None:
        targets = self.targets()
        made = as_levels(targets)
        assert made.dtype == np.uint16
        np.testing.assert_array_equal(made[..., :3], to_uint16(targets.pictures, "linear"))
        np.testing.assert_array_equal(made[..., 3] == 0, targets.weight == 0)
        assert made[1, 2, 4, 3] == 65535
        assert made[0, 1, 1, 3] == 1
        np.testing.assert_allclose(made[..., 3] / 65535 * 4, targets.weight, atol=4 / 65535)

    def test_a_picture_of_no_weight_is_refused(self) -> None:
        weights = self.targets().weight.copy()
        weights[1] = 0
        with pytest.raises(InputError, match="picture 'b' has no pixel"):
            replace(self.targets(), weights=weights)

    @settings(max_examples=30)
    @given(seed=st.integers(0, 2**32 - 1), transfer=st.sampled_from(["srgb", "linear"]))
    def test_a_cube_gives_its_targets_back(self, seed: int, transfer: str) -> None:
        grid = Grid((3, 5, 7))
        rig = turntable(grid, [1, 2], picture_shape=(3, 5))
        levels = np.random.default_rng(seed).integers(0, 65536, (2, 3, 5, 4), dtype=np.uint16)
        levels[:, 0, 0, 3] = 65535
        cube = Cube(
            np.zeros((3, 3, 5, 7), np.float32),
            grid,
            rig,
            targets=levels,
            names=("a", "b"),
            transfer=transfer,  # type: ignore[arg-type]
        )
        targets = targets_of(cube)
        np.testing.assert_array_equal(as_levels(targets), levels)
        assert targets.names == ("a", "b")
        assert targets.transfer == transfer
        assert targets.rig is rig

    def test_a_cube_without_targets_is_refused(self) -> None:
        grid = Grid((3, 5, 7))
        cube = Cube(np.zeros((3, 3, 5, 7), np.float32), grid, turntable(grid, [1]))
        with pytest.raises(InputError, match="no targets"):
            targets_of(cube)


@pytest.mark.parametrize(("focus", "kept"), [(0.0, 0), (0.1, 0), (0.4, 12), (0.5, 18), (0.9, 36), (1.0, 36)])
def test_crops_follow_the_focus_as_far_as_the_picture_goes(focus: float, kept: int) -> None:
    """As if the picture had been cut by hand, but for the edges, where the filter sees what was cut off."""
    (wide,) = pictures((24, 60)).images
    rig = turntable(GRID, [10.0], picture_shape=(12, 12))
    by_hand = fit(Pictures((np.ascontiguousarray(wide[:, kept : kept + 24]),), ("a",)), rig)
    across = fit(Pictures((wide,), ("a",), focus=(focus, 0.3)), rig)
    inner = (slice(None), slice(None), slice(3, -3))
    np.testing.assert_allclose(across.pictures[inner], by_hand.pictures[inner], atol=2e-6)
    high = np.ascontiguousarray(wide.transpose(1, 0, 2))
    down = fit(Pictures((high,), ("a",), focus=(0.8, focus)), rig)
    np.testing.assert_allclose(down.pictures.transpose(0, 2, 1, 3)[inner], by_hand.pictures[inner], atol=2e-6)


@pytest.mark.parametrize("focus", [(-0.1, 0.5), (0.5, 1.1), (float("nan"), 0.5)])
def test_a_focus_outside_the_picture_is_refused(focus: tuple[float, float]) -> None:
    with pytest.raises(InputError, match=r"outside the picture|not \(nan|nan"):
        Pictures((np.ones((4, 5, 3), np.float32),), ("a",), focus=focus)
