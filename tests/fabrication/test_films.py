"""Pages of films: exact on paper, read back as they were written, and honest about what they cast."""

import json
import re
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lightcube.errors import InputError
from lightcube.fabrication.coverage import levels_of
from lightcube.fabrication.dots import blue_dots
from lightcube.fabrication.exporting import export
from lightcube.fabrication.films import FilmPages
from lightcube.fabrication.paper import Layout
from lightcube.fabrication.reading import read_export
from lightcube.fabrication.resins import ConvertedCube
from lightcube.optics.dyes import Dyes
from lightcube.optics.grid import Grid
from lightcube.optics.moves import Move, misplaced
from lightcube.optics.stack import Stack
from lightcube.pictures.fitting import targets_of
from lightcube.scoring.metrics import score
from lightcube.verbs.exporting import opened, said_of_score, turned
from tests.helpers.prints import CELL, INKS, placed, stack, wanted

pytest.importorskip("reportlab")

MM = 72 / 25.4


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Any, dict[str, Any]]:
    """Pages of a stack in inks, the stack, and what the sidecar says."""
    path = tmp_path_factory.mktemp("prints") / "prints.pdf"
    made = stack(inks=INKS)
    return path, made, export(made, path, "film", paper="a5")


def test_pages_are_exact(printed: tuple[Path, Any, dict[str, Any]]) -> None:
    path, made, said = printed
    pikepdf = pytest.importorskip("pikepdf")
    with pikepdf.open(path) as pdf:
        for page in pdf.pages:
            assert np.allclose([float(side) / MM for side in page.MediaBox], [0, 0, 148, 210], atol=0.01)
        assert pdf.Root.ViewerPreferences.PrintScaling == "/None"
        assert len(pdf.pages) == 2 + made.grid.shape[0]
    _, ny, nx = made.grid.shape
    asked = said["picture_mm"]
    for matrix, _ in placed(path):
        (a, b, _), (c, d, _), (left, bottom, _) = matrix / MM
        assert np.allclose([a, b, c, d], [nx * CELL, 0, 0, ny * CELL], atol=0.01)
        assert np.allclose([left, bottom], asked["corner"], atol=0.01)
        dots = np.array([left, bottom, left + a, bottom + d]) * 600 / 25.4
        assert np.allclose(dots, np.round(dots), atol=0.01)


def test_another_reader_finds_the_same_bytes_and_casts_the_same(printed: tuple[Path, Any, dict[str, Any]]) -> None:
    path, made, said = printed
    levels, kind, lost = levels_of(made, None)
    found = placed(path)
    assert len(found) == len(levels)
    assert not lost
    for (_, dots), film in zip(found, levels, strict=True):
        assert np.array_equal(dots, np.repeat(np.repeat(film[::-1], 30, axis=0), 30, axis=1))
    cells = np.stack([dots[15::30, 15::30][::-1] for _, dots in found]).astype(np.float64)
    held = replace(made, extinction=(kind.absorbance(cells) / CELL).astype(np.float32), amounts=None, dyes=None)
    again = score(held, targets_of(made))["psnr_mean"]
    assert again == pytest.approx(said["predicted"]["psnr_mean"], abs=0.05)
    own = opened(str(path))
    assert score(own, targets_of(made))["psnr_mean"] == pytest.approx(said["predicted"]["psnr_mean"], abs=0.05)
    assert np.allclose(own.extinction, held.extinction, rtol=1e-5, atol=1e-6)
    assert isinstance(own.grid, Stack)
    assert own.grid.heights_mm == made.grid.heights_mm


def test_levels_of_8_bits_cost_little(printed: tuple[Path, Any, dict[str, Any]]) -> None:
    assert printed[2]["predicted"]["psnr_mean"] >= 58


def test_crosses_stand_where_they_are_said_to(printed: tuple[Path, Any, dict[str, Any]]) -> None:
    path, _, said = printed
    pypdfium2 = pytest.importorskip("pypdfium2")
    document = pypdfium2.PdfDocument(path)
    try:
        bitmap = document[2].render(scale=600 / 72, grayscale=True).to_numpy()
    finally:
        document.close()
    dark = 255.0 - bitmap.reshape(bitmap.shape[0], -1)
    (tall, wide), (width, height) = dark.shape, said["film"]["page_mm"]
    for x, y in said["crosses_mm"]:
        column, row = x / width * wide, tall - y / height * tall  # of pages that are not whole dots pixels are smaller
        near = dark[int(row) - 60 : int(row) + 60, int(column) - 60 : int(column) + 60]
        at = np.arange(120) + 0.5
        up, across = (each - each.min() for each in (near.sum(axis=0), near.sum(axis=1)))  # of one line each
        assert np.average(at, weights=up) + int(column) - 60 == pytest.approx(column, abs=0.5)
        assert np.average(at, weights=across) + int(row) - 60 == pytest.approx(row, abs=0.5)


def test_nothing_is_printed_in_the_margins(tmp_path: Path) -> None:
    pypdfium2 = pytest.importorskip("pypdfium2")
    export(stack(), tmp_path / "a.pdf", "film", paper="a5", score=False)
    document = pypdfium2.PdfDocument(tmp_path / "a.pdf")
    try:
        for page in document:
            shown = page.render(scale=2).to_numpy()
            inside = int(5.9 * MM * 2)
            shown[inside:-inside, inside:-inside] = 255
            assert shown.min() == 255
    finally:
        document.close()


def test_no_turn_and_no_mirror_lays_pin_holes_on_each_other() -> None:
    where = Layout("a4", (210.0, 297.0), 600, 59, (72, 60))
    pins = np.array(where.pins_mm) - np.array(where.page_mm) / 2
    for swap, across, along in product((False, True), (1, -1), (1, -1)):
        other = (pins[:, ::-1] if swap else pins) * (across, along)
        lies = all(np.min(np.linalg.norm(pins - pin, axis=1)) < 5 for pin in other)
        assert lies == (not swap and across == along == 1)


@pytest.mark.parametrize(
    "how",
    [{}, {"mirror": True}, {"scale_x": 1.01, "scale_y": 0.993}, {"mirror": True, "scale_y": 1.002}, {"dpi": 1200}],
)
def test_films_come_back_however_they_are_drawn(tmp_path: Path, how: dict[str, Any]) -> None:
    made = stack(inks=INKS)
    export(made, tmp_path / "a.pdf", "film", score=False, **how)
    found = read_export(tmp_path / "a.pdf")
    levels, kind, _ = levels_of(made, None)
    assert found.grid.voxel_mm == pytest.approx(CELL, rel=1e-6)
    assert np.allclose(found.extinction * CELL, kind.absorbance(levels.astype(np.float64)), rtol=1e-4, atol=1e-5)
    assert found.rig.stops.films.shape[1] == 0


def test_the_same_stack_gives_the_same_bytes(tmp_path: Path) -> None:
    made = stack(2)
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        export(made, tmp_path / name / "x.pdf", "film", score=False)
    assert (tmp_path / "a" / "x.pdf").read_bytes() == (tmp_path / "b" / "x.pdf").read_bytes()


def _edited(path: Path, edit: Any) -> Path:
    """A copy of pages that was saved by another program after an edit."""
    pikepdf = pytest.importorskip("pikepdf")
    other = path.with_name("other.pdf")
    with pikepdf.open(path) as pdf:
        edit(pdf)
        pdf.save(other, object_stream_mode=pikepdf.ObjectStreamMode.disable, compress_streams=True)
    said = json.loads(Path(f"{path}.json").read_text())
    Path(f"{other}.json").write_text(json.dumps(said | {"files": {"other.pdf": "0" * 64}}))
    return other


def _reverse(pdf: Any) -> None:
    films = list(pdf.pages)[2:]
    for number, page in enumerate(reversed(films)):
        pdf.pages[2 + number] = page


def _mirror(pdf: Any) -> None:
    for page in list(pdf.pages)[2:]:
        page.contents_add(f"-1 0 0 1 {float(page.MediaBox[2])} 0 cm\n".encode(), prepend=True)


@pytest.mark.parametrize(
    ("edit", "told"),
    [
        (_reverse, "bottom and top exchanged.*order of their numbers"),
        (_mirror, "left and right exchanged.*--mirror"),
    ],
)
def test_pages_the_other_way_round_are_told_as_such(tmp_path: Path, edit: Any, told: str) -> None:
    made = stack(3)
    export(made, tmp_path / "a.pdf", "film", score=False, made_from=None)
    other = _edited(tmp_path / "a.pdf", edit)
    with pytest.raises(InputError, match="is not the file that was exported"):
        read_export(other)
    held = read_export(other, force=True)
    worth = score(held, targets_of(made))["psnr_mean"]
    assert worth < 15
    found = turned(held, targets_of(made), worth)
    assert found is not None
    assert found.psnr_mean > 40
    assert re.search(told, "".join(said_of_score(str(other), found, worth)))


def test_a_film_that_was_moved_on_its_page_is_misplaced(tmp_path: Path) -> None:
    made = stack(3)
    export(made, tmp_path / "a.pdf", "film", score=False)

    def move(pdf: Any) -> None:
        pdf.pages[3].contents_add(f"1 0 0 1 {0.5 * MM} {-0.2 * MM} cm\n".encode(), prepend=True)

    held = read_export(_edited(tmp_path / "a.pdf", move), force=True)
    off = np.zeros((3, 3))
    off[1] = 0.5, -0.2, 0
    straight = replace(held, rig=misplaced(made.rig, held.grid, off))  # type: ignore[arg-type]
    worth = score(held, targets_of(made))["psnr_mean"]
    assert worth == pytest.approx(score(straight, targets_of(made))["psnr_mean"], abs=0.01)
    assert worth < score(replace(held, rig=made.rig), targets_of(made))["psnr_mean"] - 5


def test_dot_gain_is_allowed_for() -> None:
    made = stack(inks=INKS)
    levels, kind, _ = levels_of(made, None)
    assert made.amounts is not None
    plain = levels_of(replace(made, dyes=(bare := replace(INKS, gain=()))), bare)[0]
    assert np.any(levels[..., 1] != plain[..., 1])  # magenta, which gains
    assert np.array_equal(levels[..., [0, 2]], plain[..., [0, 2]])
    assert not levels[..., 3].any()
    assert np.allclose(kind.absorbance(levels.astype(np.float64)), INKS.mixed(made.amounts), atol=0.03)


def test_pages_without_inks_are_light_and_say_what_that_costs(tmp_path: Path) -> None:
    said = export(stack(2), tmp_path / "a.pdf", "film")
    assert said["film"]["space"] == "rgb"
    assert any("driver" in note for note in said["notes"])
    assert said["predicted"]["psnr_mean"] > 50
    grey = stack(2)
    one = replace(grey.rig, sums=replace(grey.rig.sums, share=grey.rig.sums.share[:, :1]))
    grey = replace(grey, extinction=grey.extinction[:1], lamp_powers=grey.powers[:, :1], rig=one, targets=None)
    assert export(wanted(grey), tmp_path / "b.pdf", "film")["film"]["space"] == "grey"
    assert read_export(tmp_path / "b.pdf").extinction.shape[0] == 1


def test_inks_that_a_stack_was_not_solved_in_are_warned_of(tmp_path: Path) -> None:
    with pytest.warns(ConvertedCube, match="not solved in these inks"):
        said = export(stack(2), tmp_path / "a.pdf", "film", inks=INKS)
    assert said["predicted"]["psnr_mean"] >= said["predicted"]["psnr_mean_of_old_lamps"]
    assert said["lost"]["out_of_reach_extinction"] > 0.01


def test_dots_cover_as_much_as_they_are_asked_to() -> None:
    for level, film in product((0, 1, 64, 200, 255), (0, 3)):
        dots = blue_dots(film, np.full((96, 64, 4), level, np.uint8))
        assert set(np.unique(dots)) <= {0, 255}
        assert np.allclose(dots.mean(axis=(0, 1)), level, atol=0.26)  # one of 1024 places
    once = blue_dots(0, np.full((32, 32, 4), 128, np.uint8))
    assert not np.array_equal(once[..., 0], once[..., 1])


def test_a_halftone_comes_back_as_its_means(tmp_path: Path) -> None:
    made = stack(2, inks=INKS)
    said = export(made, tmp_path / "a.pdf", "film", halftone="blue", score=False)
    assert any("halftone" in note for note in said["notes"])
    assert np.allclose(read_export(tmp_path / "a.pdf").extinction, made.extinction, atol=0.15)
    with pytest.raises(InputError, match="dots are of inks"):
        export(stack(2), tmp_path / "b.pdf", "film", halftone="blue")


def test_moves_are_told_as_they_were_asked_for(tmp_path: Path) -> None:
    slid = Move("slid", shift_mm=((0.0, 0.0), (2.5, -1.25)), turn_deg=(0.0, 180.0))
    made = stack(2, moves=(None, slid))
    export(made, tmp_path / "a.pdf", "film", score=False)
    pypdfium2 = pytest.importorskip("pypdfium2")
    document = pypdfium2.PdfDocument(tmp_path / "a.pdf")
    try:
        text = document[0].get_textpage().get_text_range()
    finally:
        document.close()
    assert re.search(r"two: film 2 2\.5 mm right and 1\.25 mm down, turned 180", text)
    assert "one: as they lie" in text


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "paper": ({"paper": "foolscap"}, "no paper 'foolscap'"),
    "dots": ({"dpi": 601}, r"30\.05 dots at 601 dpi.*take --dpi 600.*--size-mm 15\.21"),
    "few": ({"dpi": 10}, "72 to 2400 dots"),
    "scale": ({"scale_x": 99.2}, "scale_x is 100 mm divided"),
    "option": ({"unit": "m"}, "film takes"),
    "resins": ({"inks": replace(INKS, kind="resin")}, "these are resins"),
    "names": ({"inks": replace(INKS, names=("cyan", "pink", "yellow"))}, "there is 'pink'"),
    "colours": ({"inks": Dyes(("cyan", "black"), np.array([[1.0, 0.2], [1, 1]]), kind="ink")}, "inks of 2 colours"),
}


@pytest.mark.parametrize("which", REFUSED)
def test_what_cannot_be_printed_is_refused_before_anything_is_written(tmp_path: Path, which: str) -> None:
    how, told = REFUSED[which]
    with pytest.raises(InputError, match=told):
        export(stack(2), tmp_path / "a.pdf", "film", **how)
    assert not list(tmp_path.iterdir())


def test_films_that_are_too_large_are_told_what_fits(tmp_path: Path) -> None:
    made = stack(2)
    large = replace(made.grid, shape=(2, 90, 130))
    wide = replace(made, grid=large, extinction=np.zeros((3, 2, 90, 130), np.float32), targets=None)
    with pytest.raises(InputError, match=r"165\.1 x 114\.3 mm.*do not fit a5.*--paper letter"):
        export(replace(wide, grid=replace(large)), tmp_path / "a.pdf", "film", paper="a5", dpi=600)
    assert not list(tmp_path.iterdir())
    assert FilmPages(paper="a4").laid_out(large, made.rig)[1].page_mm == (210, 297)
    across = replace(large, shape=(2, 30, 180))
    assert FilmPages(paper="a4").laid_out(across, made.rig)[1].page_mm == (297, 210)


@pytest.mark.parametrize("inks", [None, INKS])
def test_films_that_are_too_dark_are_refused(tmp_path: Path, inks: Dyes | None) -> None:
    made = stack(2)
    dark = made.extinction.copy()
    dark[1, 1, 2, 3] = 9 / CELL
    with pytest.raises(InputError, match=r"film 2 is as dark as density 3\.91.*--max-extinction"):
        export(replace(made, extinction=dark), tmp_path / "a.pdf", "film", inks=inks)
    assert not list(tmp_path.iterdir())


def test_cubes_are_no_films(tmp_path: Path) -> None:
    made = stack(2)
    voxels = replace(made, grid=Grid(made.grid.shape, CELL), targets=None)
    with pytest.raises(InputError, match="not a stack of films"):
        export(voxels, tmp_path / "a.pdf", "film")


def test_what_stands_there_stays(tmp_path: Path) -> None:
    (tmp_path / "a.pdf.json").write_text("mine")
    with pytest.raises(InputError, match="exists already"):
        export(stack(2), tmp_path / "a.pdf", "film")
    assert [each.name for each in tmp_path.iterdir()] == ["a.pdf.json"]


def test_pages_alone_are_not_enough(tmp_path: Path) -> None:
    export(stack(2), tmp_path / "a.pdf", "film", score=False)
    (tmp_path / "a.pdf.json").unlink()
    with pytest.raises(InputError, match=r"no a\.pdf\.json beside it"):
        read_export(tmp_path / "a.pdf")


def test_lost_pages_are_told(tmp_path: Path) -> None:
    export(stack(3), tmp_path / "a.pdf", "film", score=False)

    def lose(pdf: Any) -> None:
        del pdf.pages[3]

    with pytest.raises(InputError, match="has 2 films, and its stack 3"):
        read_export(_edited(tmp_path / "a.pdf", lose), force=True)
