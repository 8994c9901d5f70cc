"""The drawing of a stage: XML that says every name, to scale, with beams as wide as the cube."""

import math
from itertools import combinations
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from numpy.typing import NDArray

from lightcube.drawing.bending import _PARTS
from lightcube.drawing.stage import drawing
from lightcube.drawing.svg import Labels, hull
from lightcube.optics.glass import Form, Glass
from lightcube.optics.grid import Grid
from lightcube.optics.refraction import bent
from lightcube.optics.stage import Lamp, Screen, Shot, Stage

Reals = NDArray[np.float64]
SVG = "{http://www.w3.org/2000/svg}"
SHAPES = [(3, 5, 7), (6, 4, 5)]


def stage(shape: tuple[int, int, int] = SHAPES[0], way: Any = (1.0, 0.2, -0.4), **changes: Any) -> Stage:
    far = tuple(40.0 * float(part) for part in way)
    given: dict[str, Any] = {
        "lamps": (Lamp("sun", direction=way), Lamp("bulb", position_mm=(-3.0, -40.0, 9.0), colour=(0.2, 0.4, 1.0))),
        "screens": (Screen("wall", (far[0], far[1], far[2]), (6.0, 4.0), 2.0), Screen("end", (4, 44, -9), (9, 6), 2.0)),
        "shots": (Shot("ann", "wall", ("sun",)), Shot("bob", "end", ("bulb",), 0), Shot("cat", "wall", ("sun",), 1)),
        "stops_deg": (0.0, 95.0),
    }
    return Stage(Grid(shape, 2.0), **(given | changes))


def crowd(count: int) -> Stage:
    """Lamps all round, each with a screen opposite."""
    ways = [(math.cos(turn), math.sin(turn), -0.3 - turn / 9) for turn in np.arange(count) * 2 * math.pi / count]
    return stage(
        lamps=tuple(Lamp(f"lamp {i}", direction=way) for i, way in enumerate(ways)),
        screens=tuple(
            Screen(f"screen {i}", (40 * x, 40 * y, 40 * z), (9.0, 6.0), 2.0) for i, (x, y, z) in enumerate(ways)
        ),
        shots=tuple(Shot(f"{i}", f"screen {i}", (f"lamp {i}",)) for i in range(count)),
    )


STAGES = {
    "plain": stage(),
    "one stop": stage(stops_deg=(30.0, 60.0), shots=stage().shots[:2]),
    "crowd": crowd(8),
    "about x": stage(axis=(1.0, 0.0, 0.0), cube_turns=False),
    "inside, behind, edge-on": stage(
        lamps=(Lamp("sun", direction=(0.0, 0.0, -1.0)), Lamp("bulb", position_mm=(1.0, 0.0, 0.0))),
        screens=(Screen("wall", (40.0, 0.0, 0.0), (6.0, 4.0), 2.0), Screen("end", (0.0, 0.0, 30.0), (9.0, 6.0), 2.0)),
        shots=(*stage().shots, Shot("dot", "end", ("sun",)), Shot("eve", "wall", ("bulb",))),
    ),
}


def parsed(given: Stage) -> ElementTree.Element:
    return ElementTree.fromstring(drawing(given))  # noqa: S314 - the project's own drawing


def outlines(panel: ElementTree.Element, kind: str) -> list[Reals]:
    """Points of the polygons of a class, y up."""
    found = [each.attrib["points"] for each in panel.iter(f"{SVG}polygon") if each.get("class") == kind]
    return [np.array([point.split(",") for point in points.split()], float) * (1, -1) for points in found]


def panels(given: Stage) -> list[ElementTree.Element]:
    return [each for each in parsed(given).iter(f"{SVG}g") if "clip-path" in each.attrib]


def width(points: Reals, across: Any) -> float:
    return float(np.ptp(points @ (np.array(across) / np.linalg.norm(across))))


@pytest.mark.parametrize("key", STAGES)
def test_a_drawing_is_xml_with_finite_numbers_and_all_names(key: str) -> None:
    root = parsed(STAGES[key])
    said = [text for each in root.iter() for text in (each.text or "").split("\n")]
    for name in (thing.name for things in (STAGES[key].lamps, STAGES[key].screens) for thing in things):
        assert said.count(name) >= 4, "a tooltip and a label in both panels"
    numbers = [
        number
        for each in root.iter()
        for name in ("points", "x", "y", "cx", "cy", "width", "height", "viewBox")
        for number in each.get(name, "").replace(",", " ").split()
    ]
    assert np.all(np.abs(np.array(numbers, float)) < 1e6)
    assert root.find(f"{SVG}title") is not None
    assert root.find(f"{SVG}desc") is not None


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("way", [(1.0, 0.2, -0.4), (-0.3, 1.0, -1.5), (0.5, -0.5, 0.7)])
@pytest.mark.parametrize("turn", [0.0, 33.0])
def test_parallel_light_keeps_the_cubes_width_and_a_points_light_grows(
    shape: tuple[int, int, int], way: tuple[float, float, float], turn: float
) -> None:
    for panel, (right, up) in zip(panels(stage(shape, way, stops_deg=(turn, 95.0))), ((0, 1), (0, 2)), strict=True):
        (cube,), (parallel, point) = outlines(panel, "cube"), outlines(panel, "beam")
        across = (-way[up], way[right])
        assert width(parallel, across) == pytest.approx(width(cube, across), abs=0.05)
        assert width(point, (1.0, 0.0)) > width(cube, (1.0, 0.0))


@pytest.mark.parametrize("shape", SHAPES)
def test_both_panels_are_to_the_scale_of_the_bar(shape: tuple[int, int, int]) -> None:
    wall = Screen("wall", (40.0, 8.0, -16.0), (6.0, 4.0), 2.0, normal=(-1.0, 0.0, 0.0))
    plain = stage(shape, screens=(wall,), shots=(Shot("ann", "wall", ("sun",)),))
    root = parsed(plain)
    (bar,) = [each for each in root if each.tag == f"{SVG}polyline" and len(each.attrib["points"].split()) == 4]
    corners = np.array([point.split(",") for point in bar.attrib["points"].split()], float)
    (said,) = [each.text for each in root if each.tag == f"{SVG}text" and (each.text or "").endswith(" mm")][-1:]
    scale = np.ptp(corners[:, 0]) / float(str(said).removesuffix(" mm"))
    nz, ny, nx = shape
    for panel, (wide, high), side in zip(panels(plain), ((nx, ny), (nx, nz)), (6.0, 4.0), strict=True):
        (cube,), (screen,) = outlines(panel, "cube"), outlines(panel, "screen")
        assert np.ptp(cube, axis=0) == pytest.approx(scale * 2.0 * np.array([wide, high]), abs=0.05)
        assert np.ptp(screen, axis=0) == pytest.approx([0.0, scale * side], abs=0.05)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("angle_deg", [0.0, 37.0, 90.0])
@pytest.mark.parametrize("turns", [True, False])
def test_the_cube_is_drawn_as_the_first_stop_turns_it(
    shape: tuple[int, int, int], angle_deg: float, turns: bool
) -> None:
    above, aside = (
        outlines(each, "cube")[0] for each in panels(stage(shape, stops_deg=(angle_deg, 1.0), cube_turns=turns))
    )
    cos, sin = abs(math.cos(math.radians(angle_deg * turns))), abs(math.sin(math.radians(angle_deg * turns)))
    nz, ny, nx = shape
    spans = np.array([nx * cos + ny * sin, nx * sin + ny * cos]) / nz
    assert np.ptp(above, axis=0) / np.ptp(aside[:, 1]) == pytest.approx(spans, rel=0.01)


@pytest.mark.parametrize("count", [3, 8, 20])
def test_labels_keep_off_each_other_and_on_the_card(count: int) -> None:
    labels = [each for each in parsed(crowd(count)).iter(f"{SVG}text") if each.get("class") == "label"]
    assert len(labels) == 4 * count or count > 8
    assert len(labels) > 3 * count
    boxes = [(float(each.attrib["x"]), float(each.attrib["y"]), 3.3 * len(each.text or "")) for each in labels]
    for (x, y, half), (other_x, other_y, other_half) in combinations(boxes, 2):
        assert abs(x - other_x) > half + other_half or abs(y - other_y) > 12
    assert all(half < x < 1000 - half for x, _, half in boxes)


def test_a_label_without_room_is_left_out() -> None:
    labels = Labels((0.0, 0.0, 100.0, 40.0), "#fff", "#000")
    shown = [labels.label(np.array([50.0, 20.0]), "name", 5.0) for _ in range(30)]
    assert shown[0]
    assert not shown[-1]
    assert all(0 <= left < right <= 100 and 0 <= top < bottom <= 40 for left, top, right, bottom in labels.taken)


def test_odd_names_come_back_as_they_are() -> None:
    odd = ["<b>&amp;\"quoted\" 'name'</b>", "]]> & größe " + 40 * "x"]
    named = stage(
        lamps=(Lamp(odd[0], direction=(1.0, 0.2, -0.4)),),
        screens=(Screen(odd[1], (40.0, 8.0, -16.0), (6.0, 4.0), 2.0),),
        shots=(Shot(odd[0], odd[1], (odd[0],)),),
    )
    said = [each.text for each in parsed(named).iter(f"{SVG}title")]
    assert said.count(odd[0]) == said.count(odd[1]) == 2
    assert said.count(f"{odd[0]} → {odd[1]}") == 2


@pytest.mark.parametrize("count", [1, 2, 3, 7, 40])
def test_the_hull_holds_all_points_and_is_made_of_some(count: int) -> None:
    points = np.round(np.random.default_rng(count).normal(size=(count, 2)), 6)
    corners = hull(points)
    assert {tuple(corner) for corner in corners} <= {tuple(point) for point in points}
    for turn in np.arange(0, 2 * math.pi, 0.1):
        ahead = (math.cos(turn), math.sin(turn))
        assert np.max(corners @ ahead) == pytest.approx(np.max(points @ ahead))


@pytest.mark.parametrize(("form", "elevation_deg"), [("block", 35.0), ("cylinder", 20.0), ("sphere", 20.0)])
def test_bent_beams_are_drawn_where_the_rig_has_them(form: Form, elevation_deg: float) -> None:
    """Of each beam the way from the lamp, into the glass, out of it and to the wall, in both panels; the body too."""
    turn = np.radians(elevation_deg)
    way = (float(np.cos(turn)), 0.0, -float(np.sin(turn)))
    grid = Grid((10, 10, 10), 4.0)
    place = (70.0, 0.0, 70.0 * way[2] / way[0] + float(Glass(1.5, form).around(grid).rise_mm(np.array([way]))[0]))
    glass = Glass(1.5, form, "blocked" if form == "block" else "open")
    lamp, wall = Lamp("lamp", way), Screen("wall", place, (20.0, 20.0), 2.0)
    stage = Stage(grid, (lamp,), (wall,), (Shot("one", "wall", ("lamp",)),), glass=glass)
    text = drawing(stage)
    found = bent(stage.rig())
    lit = sum(found.through[0, int(down * 10), int(across * 10)] > 0 for down in _PARTS for across in _PARTS)
    parts = list(ElementTree.fromstring(text).iter())  # noqa: S314 - the project's own drawing
    named = {name: [each for each in parts if each.get("class") == name] for name in ("bent", "glass", "blocked")}
    beams, edges, bottoms = named.values()
    assert len(beams) == 2 * lit > 8
    assert (len(edges) > 0) == (form != "block")
    assert len(bottoms) == (form == "block")
    for beam in beams[lit:]:  # from the side
        ends = np.array([[float(part) for part in place.split(",")] for place in beam.attrib["points"].split()])
        into, inside, on = np.diff(ends, axis=0)
        slopes = [float(step[1] / step[0]) for step in (into, inside, on)]
        assert abs(slopes[1] - slopes[0]) > 0.03
        if form == "block":
            assert slopes[2] == pytest.approx(slopes[0], rel=0.03)
