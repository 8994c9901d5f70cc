"""Beams and slanted sheets in the page meet the voxels that plain boxes and the matrix say, against Python."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lightcube.drawing.standing import drawn
from lightcube.forward.turning import moment
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.transfer import encode
from lightcube.optics.views import Views
from lightcube.viewer.packing import Packed
from tests.helpers import plain
from tests.helpers.areas import JUDGED_LEVEL, THIN, Points, along_row, averaged, judged, over_square
from tests.helpers.paging import ANGLES, GRID, PLAIN, Evaluate, asked, held_in_a_page, nearly, on_table, paged, table
from tests.projection.test_rays import lamps_for, lit, screens_for


def plain_views(views: Views) -> list[dict[str, Any]]:
    """Views as far as a beam needs them."""
    fields = {
        "light": views.lamps,
        "origin": views.origins_mm,
        "right": views.column_steps_mm,
        "down": views.row_steps_mm,
    }
    return [{name: array[view].tolist() for name, array in fields.items()} for view in range(len(views))]


BEAMS = """argument.views.map((view) => argument.pixels.map(([row, column]) => {
  const beam = beamOf(view, row, column, argument.raster);
  const { start, way, first, last } = beam;
  return { ...beam, ...walk(argument.shape, argument.voxel_mm, start, way, first, last),
    inside: stretchInside(argument.shape, argument.voxel_mm, beam) };
}))"""


def walked(evaluate: Evaluate, grid: Grid, views: Views) -> list[Any]:
    pixels = list(np.ndindex(*views.picture_shape))
    argument = {"views": plain_views(views), "pixels": pixels, "raster": views.picture_shape}
    argument |= {"shape": grid.shape, "voxel_mm": grid.voxel_mm}
    found = evaluate(("model/beam.js",), PLAIN % BEAMS, argument)
    return [(view, *pixel, found[view][i]) for view in range(len(views)) for i, pixel in enumerate(pixels)]


@pytest.mark.parametrize("lamp", lamps_for((1, 1, 1)))
@pytest.mark.parametrize("shape", [(3, 5, 7), (4, 6, 5)])
def test_walks_meet_what_plain_boxes_do(evaluate: Evaluate, shape: tuple[int, int, int], lamp: str) -> None:
    """Ties included, and beams end at their lamp and their pixel."""
    grid = Grid(shape, 1.3)
    views = lit(grid, [lamps_for(shape)[lamp]], list(screens_for(shape).values()), (2, 3))
    met = 0
    for view, row, column, beam in walked(evaluate, grid, views):
        point, way, first, last = plain.beam_of_pixel(views, view, row, column)
        wanted = plain.lengths_of_beam(grid, point, way, first, last)
        found = np.zeros(grid.shape)
        np.add.at(found.reshape(-1), np.array(beam["voxels"], int), beam["lengths"])
        nearly(found, wanted, 1e-9)
        nearly(beam["pixel"], point, 1e-12)
        nearly(beam["way"], way, 1e-12)
        assert (beam["inside"] is None) == (len(beam["voxels"]) == 0)
        met += len(beam["voxels"])
        if beam["inside"]:
            start, end = np.array(beam["inside"]["start"]), np.array(beam["inside"]["end"])
            long = np.linalg.norm(end - start)
            nearly(end - start, long * way, 1e-9)
            nearly(np.cross(start - point, way), np.zeros(3), 1e-9)
            assert min(abs(long * part - wanted.sum()) for part in (1, 0.5, 0.25)) < 1e-9  # parts outside vanish
    assert met > 0


def test_a_beam_to_the_lamp_itself_meets_nothing(evaluate: Evaluate) -> None:
    views = Views(np.array([[1.0, 2, 0.5, 1]]), np.array([[1.0, 2, 0.5]]), -np.eye(3)[1:2], -np.eye(3)[2:], (1, 1))
    ((*_, beam),) = walked(evaluate, GRID, views)
    assert beam["voxels"] == []
    assert beam["inside"] is None
    assert np.linalg.norm(beam["way"]) == 1


# model/sheet.js


SHEETS = """argument.angles_deg.flatMap((angle) => exposures(scene, angle)).flatMap((exposure) =>
  exposure.views.flatMap((view, number) => [0, 1, 2].map((row) => {
    const points = pointsOf(cube, exposure, { THIN, QUICK, JUDGED }[argument.beams]);
    const columns = [...Array(exposure.window[1]).keys()];
    const facts = columns.map((column) => pixelFacts(cube, exposure, number, row, column, points))
      .map(({ voxels, left }) => ({ voxels: [...voxels], left }));
    return { row, number, exposure, sheet: sheetOf(cube, exposure, number, row, points), facts };
  })))"""


def sheets(
    evaluate: Evaluate, name: str, angles_deg: tuple[float, ...], beams: str = "THIN"
) -> tuple[Cube, list[Any], list[Views]]:
    """The packed cube, its sheets, and for each of them its view by itself."""
    return sheets_of(evaluate, *held_in_a_page(name)[1:], angles_deg, beams)


def sheets_of(
    evaluate: Evaluate, packed: Packed, data: dict[str, str], angles_deg: tuple[float, ...], beams: str = "THIN"
) -> tuple[Cube, list[Any], list[Views]]:
    found = asked(evaluate, data, SHEETS, angles_deg=angles_deg, beams=beams)
    views = moment(drawn(packed.cube), angles_deg)[0].views
    return packed.cube, found, [views.take([i // 3]) for i in range(len(found))]


@pytest.mark.parametrize(
    ("name", "beams", "points"),
    [
        *((name, "THIN", THIN) for name in ("level", "raised, moved", "stage")),
        *(("level", "QUICK", along_row(3)), ("level", "JUDGED", JUDGED_LEVEL)),
        *(("raised, moved", "QUICK", over_square(3, 2)), ("stage", "QUICK", over_square(3, 2))),
    ],
)
def test_what_a_pixel_meets_is_rows_of_the_matrix(evaluate: Evaluate, name: str, beams: str, points: Points) -> None:
    """All voxels of all its beams, and the mean of what these let through."""
    cube, found, alone = sheets(evaluate, name, (10.0, 102.5), beams)
    for each, view in zip(found, alone, strict=True):
        for column, facts in enumerate(each["facts"]):
            lengths = [
                plain.lengths_of_beam(GRID, *plain.beam_of_pixel(view, 0, each["row"] + down, column + across))
                for across, down in points
            ]
            met = np.flatnonzero(np.max(lengths, axis=0) > 1e-9)
            assert sorted(facts["voxels"]) == met.tolist()
            nearly(facts["left"], np.exp(-np.einsum("pzyx,czyx->pc", lengths, cube.extinction)).mean(axis=0), 1e-6)


@pytest.mark.parametrize("beams", ["THIN", "JUDGED"])
@pytest.mark.parametrize("name", ["level, moved, held", "raised", "one colour", "stage", "lamps go round"])
def test_a_sheet_shows_its_row_of_the_screen(evaluate: Evaluate, name: str, beams: str) -> None:
    """Each pixel its mean, and each of the beams of its bundle, side by side, the light where it lands."""
    angles_deg = (43.7, 130.0)
    cube, found, _ = sheets(evaluate, name, angles_deg, beams)
    thin = beams == "THIN"
    count = 1 if thin else 5
    means = averaged(cube, angles_deg, THIN) if thin else judged(cube, angles_deg)
    apart = np.stack([averaged(cube, angles_deg, [point]) for point in along_row(count)], axis=3)
    means, apart = (np.clip(encode(each, cube.transfer), 0, 1) for each in (means, apart))
    picture = -1
    for each in found:
        picture += (each["number"], each["row"]) == (0, 0)
        pixels = each["sheet"]["pixels"]
        assert [pixel["column"] for pixel in pixels] == list(range(each["exposure"]["window"][1]))
        own, single = (light[picture, each["row"], : len(pixels)] for light in (means, apart))
        nearly([pixel["shown"] for pixel in pixels], np.broadcast_to(own, (len(pixels), 3)), 1e-5)
        shown = [[beam["shown"] for beam in pixel["beams"]] for pixel in pixels]
        nearly(shown, np.broadcast_to(single, (len(pixels), count, 3)), 1e-5)
        for pixel, facts in zip(pixels, each["facts"], strict=True):
            for beam in pixel["beams"]:
                assert (beam["start"] is None) == (beam["end"] is None)
                assert beam["start"] is None or facts["voxels"]
                assert not thin or (beam["start"] is None) == (facts["voxels"] == [])


@pytest.mark.parametrize("name", ["level", "level, moved, held"])
def test_level_light_runs_in_one_slice(evaluate: Evaluate, name: str) -> None:
    _, found, alone = sheets(evaluate, name, ANGLES)
    for each, view in zip(found, alone, strict=True):
        sheet = each["sheet"]
        height = (view.origins_mm[0] + (each["row"] - 1) * view.row_steps_mm[0])[2] / GRID.voxel_mm + 1.5
        assert (sheet["axis"], sheet["shape"]) == (2, [5, 7])
        inside = 0 < height < 3
        wanted = int(height) * 35 + np.arange(35) if inside else np.full(35, -1)
        np.testing.assert_array_equal(sheet["cells"], wanted)
        assert {voxel for facts in each["facts"] for voxel in facts["voxels"]} <= set(sheet["cells"])


@pytest.mark.parametrize("name", ["raised", "stage", "lamps go round"])
def test_cells_are_the_voxels_at_the_height_of_the_plane(evaluate: Evaluate, name: str) -> None:
    """And every voxel that a beam of the row meets is one of them, or the next above or below."""
    _, found, alone = sheets(evaluate, name, ANGLES[:6])
    axes = set()
    for each, view in zip(found, alone, strict=True):
        axis, cells = each["sheet"]["axis"], np.array(each["sheet"]["cells"]).reshape(each["sheet"]["shape"])
        pixels = [plain.beam_of_pixel(view, 0, each["row"], column)[:2] for column in (0, view.picture_shape[1] - 1)]
        normal = np.cross(pixels[0][1], pixels[1][0] - pixels[0][0])
        axes.add(axis)
        assert abs(normal[axis]) == pytest.approx(np.abs(normal).max())
        others = [other for other in (2, 1, 0) if other != axis]
        counts = GRID.shape[::-1]
        assert cells.shape == tuple(counts[other] for other in others)
        heights = np.empty(cells.shape)
        for cell in np.ndindex(cells.shape):
            middle = np.zeros(3)
            middle[others] = [(cell[i] + 0.5 - counts[other] / 2) * GRID.voxel_mm for i, other in enumerate(others)]
            away = normal @ (pixels[0][0] - middle) / normal[axis] / GRID.voxel_mm
            heights[cell] = height = away + counts[axis] / 2
            place = np.zeros(3, int)
            place[others], place[axis] = cell, int(np.floor(height))
            wanted = np.ravel_multi_index(place[::-1], GRID.shape) if 0 <= height < counts[axis] else -1
            assert cells[cell] == wanted or abs(height - round(height)) < 1e-6
        for facts in each["facts"]:
            for voxel in facts["voxels"]:
                at = np.unravel_index(voxel, GRID.shape)[::-1]
                assert -1 - 1e-9 <= heights[tuple(at[other] for other in others)] - at[axis] <= 2 + 1e-9
    assert len(axes) > (name != "raised")


@pytest.mark.parametrize("off", [0.5, -0.5])
def test_a_plane_along_faces_shows_a_slice_beside_it(evaluate: Evaluate, off: float) -> None:
    """Level beams half a voxel down, or up: the lowest, or highest, run on the outside of the cube."""
    rig = table(0, 70)
    cube = on_table(
        replace(rig, views=replace(rig.views, origins_mm=rig.views.origins_mm + off * rig.views.row_steps_mm))
    )
    _, found, _ = sheets_of(evaluate, *paged(cube)[1:], (0.0, 30.0))
    assert len(found) == 6
    for each in found:
        height = round(2.5 - off - each["row"])
        assert set(np.array(each["sheet"]["cells"]) // 35) == {min(height, 2)}
        slices = {voxel // 35 for facts in each["facts"] for voxel in facts["voxels"]}
        assert slices == {height, height - 1} & {0, 1, 2}
        for pixel, facts in zip(each["sheet"]["pixels"], each["facts"], strict=True):
            assert (pixel["beams"][0]["start"] is None) == (facts["voxels"] == [])
