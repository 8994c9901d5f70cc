"""Reports of opaque shapes and of reliefs: what is measured stands there, in whole pages."""

import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from lightcube import io
from lightcube.events import Progress, Said
from lightcube.optics.grid import Grid
from lightcube.report.reliefs import measure_relief
from lightcube.report.shapes import measure_shape
from lightcube.scoring.reliefs import score_relief
from lightcube.scoring.wall_shares import wall_shares
from lightcube.solids.relief import Relief, ReliefRecipe
from lightcube.solids.shape import Shape, hull
from lightcube.solids.walls import walls
from lightcube.verbs import reporting
from lightcube.viewer.label import Label
from tests.cli.test_cli import run
from tests.helpers.solid import of_pixels

__all__ = ["run"]

GRID = Grid((12, 14, 16), 2.0)
LABEL = Label("A <thing>", "Ada", "for Bob")


@pytest.fixture(scope="module")
def shape() -> Shape:
    """A block whose side picture asks for more than the front allows, and a pin on it."""
    front, side, top = (np.zeros(size, bool) for size in ((12, 16), (12, 14), (14, 16)))
    front[3:9, 2:13] = side[3:10, 3:11] = top[3:11, 2:13] = True
    front[1:3, 6] = side[1:3, 6] = True
    return hull(of_pixels(walls(GRID).rig(), front, side, top), GRID)


def relief(*, is_colour: bool = False) -> Relief:
    random = np.random.default_rng(5)
    names = ("sky red", "sky green", "sky blue") if is_colour else ("ash", "birch", "cedar")
    wanted = random.uniform(0.2, 1, (3, 13, 11))
    return Relief(random.uniform(0, 6, (13, 11)), wanted, ReliefRecipe(black=0.5), names, is_colour)


def quiet(_: Progress | Said) -> None:
    """Listens to nothing."""


class Whole(HTMLParser):
    """Fails where an element is not closed."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.said: list[str] = []
        self.feed(page)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in ("meta", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.said.append(data)


def told(page: str) -> str:
    """The words of a page."""
    return " ".join(" ".join(Whole(page).said).split())


def test_a_shapes_report_says_what_was_measured(shape: Shape) -> None:
    steps: list[tuple[int, int]] = []
    found = measure_shape(shape, lambda done, of: steps.append((done, of)))
    made = reporting.shape_report(shape, "no such place", LABEL, quiet)
    said = told(made.text)
    assert steps == [(number, 5) for number in range(1, 6)]
    assert "A <thing>" in said
    assert "for Bob" in said
    for overlap, share in zip(found.certificate.overlap, found.reach.shares, strict=True):
        assert f"{overlap:.2%}" in said
        assert f"{share:.2%} out of reach" in said
    assert found.reach.shares[1] > 0.05
    assert f"{shape.mesh.volume_mm3 / 1000:.3g} cm³" in said
    assert f"{1.24 * shape.mesh.volume_mm3 / 1000:.3g} g" in said
    assert made.text.count("<img") == 3 * 3 + 3
    assert made.scores == found.certificate.facts
    assert made.text == reporting.shape_report(shape, "no such place", LABEL, quiet).text


def test_a_reliefs_report_says_what_was_measured() -> None:
    plate = relief()
    made, scores = reporting.relief_report(plate, "no such place", LABEL, quiet), score_relief(plate, off=True)
    said = told(made.text)
    for each in scores["pictures"]:
        assert f"{each['psnr']:.2f}" in said
        assert each["name"] in said
    assert f"{scores['off']['3 deg higher']:.2f}" in said
    assert "lamp behind" in said
    assert made.text.count("<img") == 2 * 3 + 1
    assert made.text.count("<svg") == 3
    assert made.scores == scores
    assert told(reporting.relief_report(relief(is_colour=True), "none", LABEL, quiet).text).count("sky") >= 2


def test_lamps_that_stand_right_are_those_of_the_scores() -> None:
    plate, found = relief(), measure_relief(relief(), lambda done, of: None)
    right = [each["psnr"] for each in score_relief(plate)["pictures"]]
    np.testing.assert_allclose(found.higher[:, 4], right)
    np.testing.assert_allclose(found.rounder[:, 0], right)
    assert np.all(found.higher[:, 0] != found.higher[:, 4])


def test_walls_are_as_thick_as_they_are() -> None:
    """Of a ball on a thin plate: the plate's part is thin, the ball's thick, and together they are all."""
    grid = Grid((30, 30, 30), 0.5)
    z, y, x = np.indices(grid.shape) + 0.5
    ball = (x - 15) ** 2 + (y - 15) ** 2 + (z - 16) ** 2 < 11**2
    plate = (np.abs(z - 3) < 1.1) & (x > 1) & (x < 29) & (y > 1) & (y < 29)
    rig = walls(grid).rig()
    silhouettes = of_pixels(rig, *(np.ones(shape, bool) for shape in ((30, 30), (30, 30), (30, 30))))

    def of(inside: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return wall_shares(Shape(np.where(inside, -1.0, 1.0).astype(np.float32), grid, silhouettes))

    edges, parts = of(ball | plate)
    assert parts.sum() == pytest.approx(1)
    assert np.all(np.diff(edges) > 0)
    thin = plate.sum() - (plate & ball).sum()
    assert parts[0] == pytest.approx(thin / (ball | plate).sum(), abs=0.06)
    assert parts[edges[:-1] > 8].sum() > 0.5  # the ball is 11 mm thick
    edges, parts = of(plate)
    assert parts.tolist() == [1.0]


def test_the_command_writes_both(run, shape: Shape, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    for name, thing in (("a.shape.zarr", shape), ("b.relief.zarr", relief())):
        place, page = tmp_path / name, tmp_path / f"{name}.html"
        io.save(thing, place)
        done = run("report", place, "-o", page, "--by", "Ada")
        assert done.code == 0, done.err
        assert re.search(r"overlap by \d+\.\d\d%|mean PSNR \d+", done.out)
        assert place.name in told(page.read_text(encoding="utf-8"))
        page.unlink()
        refused = run("report", place, tmp_path, "-o", page)
        assert (refused.code, page.exists()) == (2, False)
        assert "keeps its own pictures" in refused.err
