"""The drawing of how films are put together: to scale where it can be, with every name, place and slide."""

from xml.etree import ElementTree

import numpy as np
import pytest

import lightcube as lc
from lightcube.drawing.assembly import assembly
from lightcube.optics.stage import Lamp, Stage
from tests.helpers.films import stack_of

SVG = "{http://www.w3.org/2000/svg}"


def drawn(stage: Stage) -> ElementTree.Element:
    text = assembly(stack_of(stage), stage.rig(), [shot.name for shot in stage.shots])
    return ElementTree.fromstring(text)  # noqa: S314 - the project's own drawing


def words(root: ElementTree.Element) -> list[str]:
    return [each.text or "" for each in root.iter(f"{SVG}text")]


def lines(root: ElementTree.Element, kind: str) -> list[np.ndarray]:
    found = [each for each in root.iter(f"{SVG}polyline") if each.get("class") == kind]
    return [np.array([point.split(",") for point in each.attrib["points"].split()], float) for each in found]


@pytest.mark.parametrize("heights", [(-60.0, -10.0, 55.0), (-40.0, 0.0, 30.0, 80.0)])
def test_films_far_apart_are_to_the_scale_of_the_bar(heights: tuple[float, ...]) -> None:
    root = drawn(lc.attenuator(["a", "b"], lc.Films(heights_mm=heights, pixels=8)))
    films = lines(root, "film")
    levels = -np.array([film[0, 1] for film in films])
    ends = [each.attrib["points"].split() for each in root if each.get("stroke-width") == "1.4"]
    (bar,) = [np.array([point.split(",") for point in points], float) for points in ends]
    length = next(float(each.split()[0]) for each in words(root)[::-1] if each.endswith(" mm"))
    scale = np.ptp(bar[:, 0]) / length
    np.testing.assert_allclose(np.diff(levels), np.diff(heights) * scale, atol=0.05)
    assert "not to scale" not in words(root)
    assert sum(each == f"{gap:.4g} mm" for each in words(root) for gap in np.diff(heights)) == len(heights) - 1


def test_films_that_touch_are_drawn_apart_and_it_is_said() -> None:
    moves = [None, lc.Move("a", shift_mm=((0, 0), (0, 0), (5, 0))), lc.Move("b", shift_mm=((0, 0), (0, -2.5), (0, 5)))]
    root = drawn(lc.attenuator(["a", "b", "c"], lc.Films(count=3, gap_mm=0, pixels=8), moves=moves))
    said = words(root)
    assert {"not to scale", "2 × touching", "film 3 slid 5 mm right", "as they are", "upright"} <= set(said)
    assert np.all(np.diff([film[0, 1] for film in lines(root, "film")]) <= -10)
    arrows = [arrow[1] - arrow[0] for arrow in lines(root, "shift")]
    ways = [tuple(np.sign(np.round(arrow, 3))) for arrow in arrows]
    assert ways == [(1, 0), (0, 1), (0, -1)]
    lengths = [float(np.hypot(*arrow)) for arrow in arrows]
    assert lengths[0] == pytest.approx(lengths[2])
    assert lengths[1] < lengths[0]


def test_each_picture_has_its_lamp_and_where_that_stands() -> None:
    lamps = [Lamp("left <&>", direction=(0.42, 0.42, -1.0)), Lamp("bulb", position_mm=(0.0, 300.0, 400.0))]
    root = drawn(lc.attenuator(["one & two", "b"], lc.Films(count=2, pixels=8, screen_mm=30), lamps=lamps))
    said = words(root)
    assert "30.7° off upright, at 7:30" in said
    assert "36.9° off upright, at 12:00, 500 mm away" in said
    assert said.count("left <&>") == 3  # in both panels and in the table
    assert "one & two" in said
    assert "30 mm" in said
    assert not any("turntable" in each or "table" in each or "stop" in each for each in said)


@pytest.mark.parametrize(("lamp", "said"), [(False, "any distance"), (True, "larger, farther")])
def test_a_sheet_of_which_nothing_is_said_may_lie_anywhere(lamp: bool, said: str) -> None:
    near = [Lamp("a", position_mm=(0.0, 0.0, 300.0)), Lamp("b", position_mm=(50.0, 0.0, 300.0))]
    root = drawn(lc.attenuator(["a", "b"], lc.Films(count=2, pixels=8), lamps=near if lamp else ()))
    assert said in words(root)


def test_many_pictures_are_not_all_listed() -> None:
    stage = lc.attenuator([f"p{number}" for number in range(30)], lc.Films(count=3, pixels=4))
    assert "and 6 more pictures" in words(drawn(stage))
