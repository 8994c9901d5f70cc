"""Plots say what is true: numbers on axes, pictures on sheets, and where everything stands."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.optics.transfer import to_uint8
from lightcube.optics.views import spread_angles
from lightcube.pictures.fitting import as_levels
from lightcube.pictures.targets import Targets
from lightcube.scoring.metrics import score

pytest.importorskip("matplotlib", reason="matplotlib is not installed")

from lightcube.drawing.plots import capacity_plot, geometry_plot, sheet_plot
from tests.helpers.wall import play

SHAPE, MM = (3, 5, 7), 2.0
GRID = Grid(SHAPE, MM)
Reals = NDArray[np.float64]


def turning(count: int = 3, elevation_deg: float = 35.0) -> Cube:
    angles_deg = spread_angles(count, elevation_deg=elevation_deg)
    rig = turntable(GRID, angles_deg, elevation_deg=elevation_deg, picture_shape=(3, 5))
    extinction = np.random.default_rng(3).uniform(0, 0.2, (3, *SHAPE)).astype(np.float32)
    return Cube(extinction, GRID, rig, lamp_powers=np.random.default_rng(4).uniform(0.5, 2, (count, 3)))


def wanted(cube: Cube, seed: int = 5) -> Targets:
    shown = play(cube)
    off = np.random.default_rng(seed).uniform(0.6, 1.0, shown.shape)
    return Targets((shown * off).astype(np.float32), cube.rig)


def staged() -> Cube:
    """A bulb that lights the wall at stop 0, and one above that lights the floor at stop 1."""
    stage = Stage(
        GRID,
        (Lamp("bulb", position_mm=(-40.0, 6.0, 9.0)), Lamp("above", direction=(0.0, 0.0, -1.0))),
        (
            Screen("wall", (50.0, 0.0, -4.0), (12.0, 8.0), 2.0, (-1.0, 0.0, 0.0)),
            Screen("floor", (1.0, 2.0, -30.0), (10.0, 6.0), 2.0, (0.0, 0.0, 1.0), up=(1.0, 0.0, 0.0)),
        ),
        (Shot("a", "wall", ("bulb",), 0), Shot("b", "floor", ("above",), 1)),
        stops_deg=(10.0, 130.0),
    )
    rig = stage.rig()
    extinction = np.random.default_rng(3).uniform(0, 0.2, (3, *SHAPE)).astype(np.float32)
    return Cube(extinction, GRID, rig)


def segments(axes: Any) -> Reals:
    """``(n, 2, 2)``: first and last point of every line of two points that is drawn."""
    lines = [np.asarray(line.get_xydata()) for line in axes.lines]
    return np.array([line for line in lines if line.shape == (2, 2)])


def polygons(axes: Any) -> list[Reals]:
    """The corners of every area that is drawn, the first one again at the end."""
    return [np.asarray(patch.get_xy()) for patch in axes.patches]


def ends_at(axes: Any, start: Reals | None, end: Reals) -> bool:
    """Whether a line runs from one place to the other (or from anywhere)."""
    return any(
        np.allclose(line[1], end, atol=1e-6) and (start is None or np.allclose(line[0], start, atol=1e-6))
        for line in segments(axes)
    )


@pytest.mark.parametrize(("elevation_deg", "angle_deg"), [(0.0, None), (35.0, 77.0)])
def test_a_turntables_light_runs_along_its_elevation_through_the_pictures_edges(
    elevation_deg: float, angle_deg: float | None
) -> None:
    above, side = geometry_plot(turning(elevation_deg=elevation_deg), angle_deg).axes
    rows, columns = 3, 5
    tangent = np.tan(np.radians(elevation_deg))
    for across in (-1, 1):
        level = [line for line in segments(above) if np.allclose(line[:, 1], across * columns / 2 * MM)]
        assert any(line[0, 0] < -7 * MM / 2 and line[1, 0] > 7 * MM / 2 for line in level)
        edge = across * rows / 2 * MM
        falling = [line for line in segments(side) if np.allclose(line[:, 1], edge - tangent * line[:, 0], atol=1e-6)]
        assert any(line[0, 0] < 0 < line[1, 0] for line in falling)


def test_both_panels_have_one_scale() -> None:
    for axes in geometry_plot(staged()).axes:
        assert axes.get_aspect() == 1
        low, high = axes.get_xlim()
        assert (low, high) == geometry_plot(staged()).axes[0].get_xlim()


def test_only_lamps_that_shine_at_that_angle_light_their_screens_corners() -> None:
    wall = np.array([(50.0, y, z) for y in (-6.0, 6.0) for z in (-8.0, 0.0)])
    floor = np.array([(x, y, -30.0) for x in (-2.0, 4.0) for y in (-3.0, 7.0)])
    bulb = np.array([-40.0, 6.0, 9.0])
    for angle_deg, lit in ((10.0, True), (130.0, False)):
        for axes, plane in zip(geometry_plot(staged(), angle_deg).axes, ([0, 1], [0, 2]), strict=True):
            assert all(ends_at(axes, bulb[plane], corner[plane]) for corner in wall) == lit
            if plane == [0, 2]:  # light from above has no length there
                assert all(ends_at(axes, None, corner[plane]) for corner in floor) != lit


def test_names_stand_in_the_drawing_of_the_setup() -> None:
    for axes in geometry_plot(staged()).axes:
        assert sorted(text.get_text() for text in axes.texts) == ["above", "bulb", "floor", "wall"]


def test_there_is_a_tick_for_every_stop_and_the_pointer_is_at_the_angle() -> None:
    cube = turning(5)
    above = geometry_plot(cube, 140.0).axes[0]
    radii = np.linalg.norm(segments(above), axis=2)
    ticks = segments(above)[np.isclose(radii[:, 0] / radii[:, 1], 0.94)]
    degrees = np.degrees(np.arctan2(ticks[:, 1, 1], ticks[:, 1, 0])) % 360
    np.testing.assert_allclose(np.sort(degrees), cube.angles_deg)
    tips = [corners[0] for corners in polygons(above) if len(corners) == 4]
    assert any(np.isclose(np.degrees(np.arctan2(y, x)) % 360, 140.0) for x, y in tips)


def test_the_cube_is_drawn_as_it_has_turned() -> None:
    for angle_deg, spans in ((0.0, (14.0, 10.0)), (90.0, (10.0, 14.0))):
        squares = [corners for corners in polygons(geometry_plot(turning(), angle_deg).axes[0]) if len(corners) == 5]
        assert any(np.allclose(np.ptp(corners, axis=0), spans) for corners in squares)


@pytest.mark.parametrize("cube", [turning(), staged()], ids=["turntable", "stage"])
def test_a_sheet_shows_what_was_wanted_above_what_is_shown(cube: Cube) -> None:
    targets, shown = wanted(cube), play(cube)
    weights = np.random.default_rng(6).integers(0, 2, targets.weight.shape).astype(np.float32)
    weights[:, 0, 0] = 1
    targets = replace(targets, weights=weights)
    figure = sheet_plot(cube, targets)
    scores, panels = score(cube, targets)["pictures"], [axes for axes in figure.axes if axes.images]
    assert len(panels) == len(targets)
    rows = targets.rig.picture_shape[0]
    for view, axes in enumerate(panels):
        drawn = np.asarray(axes.images[0].get_array())
        counted = weights[view] > 0
        np.testing.assert_array_equal(drawn[:rows][counted], to_uint8(targets.pictures[view])[counted])
        np.testing.assert_array_equal(drawn[rows + 1 :][:rows][counted], to_uint8(shown[view])[counted])
        assert f"{scores[view]['psnr']:.1f} dB" in axes.get_title()


def test_a_sheet_takes_the_targets_that_the_cube_keeps() -> None:
    cube = turning()
    with pytest.raises(InputError, match="give the pictures"):
        sheet_plot(cube)
    keeping = replace(cube, targets=as_levels(wanted(cube)))
    psnr = [f"{view['psnr']:.1f} dB" for view in score(keeping)["pictures"]]
    assert [axes.get_title().split()[-2] + " dB" for axes in sheet_plot(keeping).axes] == psnr


def test_targets_of_another_cube_are_refused() -> None:
    with pytest.raises(InputError, match="do not fit the cube"):
        sheet_plot(turning(3), wanted(turning(4)))


def test_of_many_pictures_a_sheet_shows_32() -> None:
    cube = turning(40)
    assert sum(bool(axes.images) for axes in sheet_plot(cube, wanted(cube)).axes) == 32


def test_capacity_is_drawn_as_it_was_given_and_the_strongest_lamp_comes_first() -> None:
    curves = {4.0: [(6.0, 30.0), (2.0, 60.0)], 16: [(2.0, 70.0), (6.0, 40.0)]}
    figure = capacity_plot(curves, {"n = 32": [(3.0, 50.0)]}, elevation_deg=35.0)
    axes: Any = figure.axes[0]
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels == ["lamp power up to 16", "lamp power up to 4", "n = 32"]
    drawn = {line.get_label(): np.asarray(line.get_xydata()).tolist() for line in axes.lines}
    assert drawn["lamp power up to 4"] == [[2.0, 60.0], [6.0, 30.0]]
    assert drawn["lamp power up to 16"] == [[2.0, 70.0], [6.0, 40.0]]
    assert drawn["n = 32"] == [[3.0, 50.0]]
    assert "area" in axes.get_xlabel()
    assert "width" in capacity_plot(curves).axes[0].get_xlabel()
    assert [tick.get_text() for tick in axes.get_xticklabels()] == ["2", "3", "4", "5", "6"]


def test_a_lamp_has_the_same_colour_in_every_plot_of_capacity() -> None:
    points = [(1.0, 50.0), (2.0, 40.0)]
    both = capacity_plot({16: points, 4: points}).axes[0].lines
    alone = capacity_plot({4: points}).axes[0].lines
    assert both[1].get_color() == alone[0].get_color() != both[0].get_color()
