"""Outlines of silhouettes in mm: as large as they are, holes and all."""

import re
from xml.etree import ElementTree

import numpy as np

import lightcube as lc
from lightcube.drawing.outlines import outlines
from lightcube.solids.silhouettes import FINE, Silhouettes

GRID = lc.Grid((6, 8, 10), 2.0)


def area_of(path: str) -> float:
    """Area within a path by the even-odd rule, of lines that do not cross: holes count against what they are in."""
    total = 0.0
    for line in re.findall(r"M([^Z]*)Z", path):
        x, y = np.array([point.split(",") for point in line.split("L")], float).T
        total += float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2)
    return abs(total)


def test_outlines_enclose_what_silhouettes_cover() -> None:
    rig = lc.walls(GRID).rig()
    rows, columns = rig.picture_shape
    inside = np.zeros((3, FINE * rows, FINE * columns), bool)
    inside[:, 6:-6, 6:-6] = True
    inside[1, 10:-10, 12:-12] = False  # a hole
    silhouettes = Silhouettes(inside, rig, ("front & <b>", "side", "top"))
    drawn = ElementTree.fromstring(outlines(silhouettes))  # noqa: S314 - our own
    paths = drawn.findall("{*}path")
    assert [path.findtext("{*}title") for path in paths] == ["front & <b>", "side", "top"]
    for number, path in enumerate(paths):
        pixel = np.linalg.norm(rig.views.column_steps_mm[number]) * np.linalg.norm(rig.views.row_steps_mm[number])
        covered = inside[number].sum() / FINE**2 * pixel
        assert abs(area_of(path.attrib["d"]) - covered) < 0.08 * covered
    assert paths[1].attrib["d"].count("M") == 2
    width = float(drawn.attrib["width"].removesuffix("mm"))
    sides = np.linalg.norm(rig.views.column_steps_mm, axis=1)
    assert abs(width - (columns * sides.sum() + 4 * 5)) < 1e-3
    assert drawn.attrib["viewBox"].split()[2] == f"{width:.3f}"
