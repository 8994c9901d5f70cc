"""The report of a cube: what it claims is so, it loads nothing, names stay names, and its command makes the cube."""

import base64
import hashlib
import html
import json
import re
import shlex
from collections.abc import Callable, Iterator
from dataclasses import replace
from html.parser import HTMLParser
from importlib.metadata import version
from io import BytesIO
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from lightcube.cli import main
from lightcube.drawing.charts import lamp_powers
from lightcube.io import save
from lightcube.jobs.reading import load
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.optics.views import spread_angles
from lightcube.pictures.fitting import targets_of
from lightcube.report.html import image
from lightcube.report.measuring import EXACT, MOST, chosen, measure
from lightcube.report.page import digest
from lightcube.scoring.metrics import score
from lightcube.verbs import reporting
from lightcube.verbs.refitting import wanted_of
from lightcube.verbs.reproducing import reproducing
from tests.conftest import INTERPRETED
from tests.helpers.browser import opened

Run = Callable[..., tuple[int, str, str]]

_VOID = {"meta", "img"}

STAGE = """
cube = {shape = [5, 6, 7], size_mm = 7}
[[lamp]]
name = "sun & <moon>"
direction = [1, 0, 0]
size_deg = 4
[[lamp]]
name = "top"
direction = [0, 0, -1]
[[screen]]
name = "wall"
centre_mm = [20, 0, 0]
normal = [-1, 0, 0]
size_mm = [6, 5]
[[screen]]
name = "floor"
centre_mm = [0, 0, -20]
normal = [0, 0, 1]
size_mm = [4, 7]
[[picture]]
file = "pictures/1.png"
screen = "wall"
lamps = ["sun & <moon>"]
[[picture]]
file = "pictures/2.png"
screen = "floor"
lamps = ["top"]
"""


class Page(HTMLParser):
    """What is in a page: elements with their attributes, tables, headings, and whether every tag is closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.tables: dict[str, list[list[str]]] = {}
        self.said: list[tuple[str, str]] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        self.said.append((tag, ""))
        if tag not in _VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if not self.open:
            return
        tag, so_far = self.said[-1]
        self.said[-1] = (tag, so_far + data)

    def texts(self, tag: str) -> list[str]:
        return [words.strip() for each, words in self.said if each == tag]

    def rows(self, caption: str) -> list[list[str]]:
        """Cells of the table of that caption, its head first."""
        start = next(i for i, (tag, words) in enumerate(self.said) if (tag, words) == ("caption", caption))
        rows: list[list[str]] = []
        for tag, words in self.said[start + 1 :]:
            if tag == "tr":
                rows.append([])
            elif tag in ("th", "td"):
                rows[-1].append(words.strip())
            elif tag not in ("thead", "tbody"):
                break
        return rows


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    def call(*arguments: object) -> tuple[int, str, str]:
        code = main.run([*map(str, arguments)])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return call


@pytest.fixture
def pictures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with four pictures of 9 x 7 pixels, the third upright, and the place where the commands run."""
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "pictures"
    folder.mkdir()
    random = np.random.default_rng(3)
    for index in range(4):
        shape = (7, 9, 3) if index != 2 else (9, 7, 3)
        Image.fromarray(random.integers(90, 250, shape, dtype=np.uint8)).save(folder / f"{index + 1}.png")
    (tmp_path / "stage.toml").write_text(STAGE)
    return folder


def made(names: tuple[str, ...] = (), **changed: Any) -> Cube:
    """A cube of 3 x 5 x 7 voxels for three pictures of 3 x 5 pixels."""
    random = np.random.default_rng(0)
    grid = Grid((3, 5, 7), 2.0)
    extinction = random.uniform(0, 0.1, (3, 3, 5, 7)).astype(np.float32)
    targets = random.integers(1, 65535, (3, 3, 5, 4), dtype=np.uint16)
    targets[..., 3] = 65535
    rig = turntable(grid, spread_angles(3, 360), elevation_deg=20, picture_shape=(3, 5))
    provenance = {"lightcube": version("lightcube"), "method": "display", "powers": "per-picture", "lamp_max": 4.0}
    return replace(Cube(extinction, grid, rig, None, targets, names, provenance=provenance), **changed)


def reported(run: Run, *arguments: object) -> Page:
    code, _, err = run("report", *arguments, "-o", "report.html", "--overwrite")
    assert code == 0, err
    return Page(Path("report.html").read_text(encoding="utf-8"))


def commands(page: Page, text: str) -> list[str]:
    """The command lines that a page prints."""
    block = text.split('<pre id="command">')[1].split("</pre>")[0]
    lines = ["".join(part for part in _between_tags(line)) for line in block.split("\n")]
    return [html.unescape(line) for line in lines]


def _between_tags(line: str) -> Iterator[str]:
    for part in line.split("<"):
        yield part.split(">", 1)[-1] if ">" in part else part


SOLVES = {
    "planned": "--n 6 --iterations 3",
    "draft": "--n 6 --picture-width 0.5 --hold-deg 0 --quality draft",
    "angles": "--shape 5,7,6 --picture-width 0.7 --elevation-deg 20 --angles-deg 3,100.52,181,-85 "
    "--iterations 3 --lamp-max 4.5 --black 0.02 --veil 0.03 --hold-deg 1.25",
    "span": "--n 7 --span-deg 200 --size-mm 33.3 --picture-width 0.6 --hold-deg 0 --fit pad --powers shared "
    "--transfer linear --max-extinction 0.5 --iterations 2",
    "order": "--n 6 --picture-width 0.5 --hold-deg 0 --order best --shift 1 --powers coarse --iterations 2",
    "pixel": "--shape 5,7,6 --pixel 2 --picture-width 0.8 --iterations 3 --hold-deg 0 --shift 1",
    "tall": "--shape 3,7,6 --size-mm 33.3 --slices-tall 2 --pixel 2 --picture-width 0.8 --iterations 3 --hold-deg 0",
    "paper": "--n 6 --paper --iterations 3",
    "gauss-seidel": "--n 5 --paper --method gauss-seidel",
    "sirt": "--n 5 --picture-width 0.8 --method sirt --lamp-power 2.5 --iterations 4",
    "disc": "--n 6 --picture-width 0.5 --hold-deg 0.5 --lamp-deg 0.5 --iterations 2 --mat none",
    "disc, moved": "--shape 5,7,6 --size-mm 33.3 --picture-width 0.6 --elevation-deg 20 --angles-deg 3,100.52,181,-85 "
    "--lamp-deg 2.25 --screen-mm 12.1 --shift 1 --iterations 2",
    "clear": "--n 6 --picture-width 0.5 --hold-deg 0 --clear 0.01,0.02,0.015 --max-extinction 0.4 --iterations 2",
    "dyes": "--n 6 --picture-width 0.5 --hold-deg 0 --material polyjet --iterations 2",
    "glass": "--n 6 --picture-width 0.5 --hold-deg 0 --ior 1.48,1.5,1.53 --bottom blocked --iterations 2",
    "glass, turned": "--n 6 --picture-width 0.5 --hold-deg 0 --ior 1.5 --span-deg 288 --iterations 2",
    "glass, ghosts": "--n 6 --picture-width 0.5 --hold-deg 0 --ior 1.5 --angles-deg 1,95,200,300 --iterations 2",
    "glass, nearer": "--n 6 --picture-width 0.5 --hold-deg 0 --ior 1.5 --angles-deg 7,95,200,300 --screen-mm 130 "
    "--iterations 2",
    "glass cylinder": "--n 6 --picture-width 0.5 --hold-deg 0 --ior 1.5 --form cylinder --lamp-deg 0.3 --iterations 2",
    "glass sphere": "--n 6 --picture-width 0.5 --hold-deg 0 --ior 1.4 --form sphere --screen-mm 60 --iterations 2",
    "glass bath": "--n 6 --picture-width 0.5 --hold-deg 0 --ior 1.33 --form bath --bath-mm 199 --iterations 2",
    "glass, round bath": "--n 6 --picture-width 0.5 --hold-deg 0 --ior 1.45,1.5,1.6 --form round-bath --iterations 2",
    "units": "--n 6 --picture-width 0.5 --hold-deg 0 --iterations 3 --unit 1/3",
}


@pytest.mark.parametrize("options", SOLVES.values(), ids=SOLVES)
def test_the_command_makes_the_cube_bit_for_bit(run: Run, pictures: Path, options: str) -> None:
    solve = ["solve", "pictures", "-o", "a cube.npz", *options.split()]
    if "--unit" in options:
        for unit in (1, 2, 3):
            assert run(*solve[:-1], f"{unit}/3")[0] == 0
        run("publish", "a cube.npz.partial")
    else:
        assert run(*solve)[0] == 0
    _makes_it_again(run, "a cube.npz", "pictures")


def test_the_command_makes_the_cube_of_a_stage(run: Run, pictures: Path) -> None:
    options = ["--points", 4, "--iterations", 3, "--hold-deg", 1]
    assert run("solve", "stage.toml", "-o", "a.npz", *options)[0] == 0
    _makes_it_again(run, "a.npz", "stage.toml")


def _makes_it_again(run: Run, cube: str, targets: str) -> None:
    page = reported(run, cube, targets)
    text = Path("report.html").read_text(encoding="utf-8")
    assert "bit for bit:" in text
    old = load(cube)
    assert digest(old) in page.texts("code")
    Path(cube).rename("old.npz")
    for line in commands(page, text):
        assert line.startswith("lightcube ")
        assert run(*shlex.split(line)[1:])[0] == 0
    new = load(cube)
    assert digest(new) == digest(old)
    for name in ("extinction", "powers", "targets"):
        np.testing.assert_array_equal(getattr(new, name), getattr(old, name))
    np.testing.assert_array_equal(new.rig.sums.disc_deg, old.rig.sums.disc_deg)
    for name in ("lamps", "origins_mm", "column_steps_mm", "row_steps_mm"):
        np.testing.assert_array_equal(getattr(new.rig.views, name), getattr(old.rig.views, name))
    assert new.rig.glass == old.rig.glass
    assert (new.names, new.hold_deg, new.transfer) == (old.names, old.hold_deg, old.transfer)
    made = [{name: said for name, said in each.provenance.items() if name != "predicted"} for each in (new, old)]
    assert made[0] == made[1]  # where nothing is left to choose nothing is predicted


def test_passes_that_are_recorded_become_options() -> None:
    def words(**recorded: Any) -> tuple[str, list[str]]:
        cube = made()
        cube = replace(cube, provenance={**cube.provenance, "fit": "crop", **recorded})
        command = reproducing(cube, targets_of(cube), "pictures", "cube.zarr")
        return " ".join(command.lines[0]), command.doubts

    assert "quality" not in words(passes=200, enough_db=42.0)[0]
    assert "--quality draft" in words(passes=30, enough_db=36.0)[0]
    assert "--quality best" in words(passes=400, enough_db=None)[0]
    assert "--iterations 17" in words(passes=17, enough_db=None)[0]
    assert words(passes=17, enough_db=None)[1] == []
    assert "33 dB" in words(passes=17, enough_db=33.0)[1][0]
    assert "float64" in words(passes=17, enough_db=None, dtype="float64")[1][0]
    assert "not recorded" in words(iterations=3, stop_reason="enough")[1][0]
    assert "another version" in words(passes=17, lightcube="0.0.1")[1][0]


def test_every_figure_is_that_of_score(run: Run, pictures: Path) -> None:
    assert (
        run("solve", "pictures", "-o", "a.npz", "--n", 6, "--picture-width", 0.5, "--hold-deg", 0, "--iterations", 3)[0]
        == 0
    )
    scores = json.loads(run("score", "a.npz", "pictures", "--between", "--robust", "--json")[1])
    page = reported(run, "a.npz", "pictures")
    head, *rows = page.rows("Every picture")
    assert head == ["no.", "picture", "angle", "PSNR, dB", "SSIM", "CIEDE2000", "predicted, dB", "30 dB over"]
    predicted, lobes = load("a.npz").provenance["predicted"]["pictures"], scores["between"]["lobe_deg"]
    for number, (row, view) in enumerate(zip(rows, scores["pictures"], strict=True)):
        figures = [f"{view['psnr']:.2f}", "–" if view["ssim"] is None else f"{view['ssim']:.4f}"]
        figures += [
            f"{view['delta_e']:.2f}",
            f"{predicted[number]:.1f}",
            f"{lobes[number]:.2f}°",
        ]
        assert row == [str(number + 1), view["name"], f"{view['angle_deg']:.3f}°", *figures]
    robust = [row[1:3] for row in page.rows("What is left of the pictures")[1:]]
    assert robust == [[f"{each['psnr_mean']:.2f}", f"{each['psnr_min']:.2f}"] for each in scores["robust"].values()]
    assert f"{scores['psnr_mean']:.2f} dB" in page.texts("dd")
    assert f"{scores['psnr_min']:.2f} dB" in page.texts("dd")
    assert "which are those that the cube was made from" in Path("report.html").read_text()


def test_a_report_is_the_same_twice_and_says_its_figures_for_machines(run: Run, pictures: Path) -> None:
    save(made(), "a.npz")
    reported(run, "a.npz")
    first = Path("report.html").read_bytes()
    code, out, _ = run("report", "a.npz", "-o", "report.html", "--overwrite", "--json")
    assert (code, Path("report.html").read_bytes()) == (0, first)
    *events, result = map(json.loads, out.splitlines())
    assert {event["task"] for event in events} == {"measuring"}
    assert (result["out"], result["bytes"]) == ("report.html", len(first))
    assert result["psnr_mean"] == score(load("a.npz"))["psnr_mean"]


def test_other_pictures_than_its_own_are_told(run: Run, pictures: Path) -> None:
    assert (
        run("solve", "pictures", "-o", "a.npz", "--n", 6, "--picture-width", 0.5, "--hold-deg", 0, "--iterations", 1)[0]
        == 0
    )
    Image.new("RGB", (9, 7), "#102030").save(pictures / "2.png")
    reported(run, "a.npz", "pictures")
    assert "not known to be those that it was made from" in Path("report.html").read_text()


def test_names_stay_names(run: Run, pictures: Path) -> None:
    evil = ("<b>\"&amp;'</b>", "</title><script>alert(1)</script>")
    name = "a<i>'\"&.npz"
    save(made((*evil, "c")), name)
    page = reported(run, name)
    text = Path("report.html").read_text(encoding="utf-8")
    tags = {tag for tag, _ in page.elements}
    assert not tags & {"i", "script"}
    assert page.texts("h1") == ["a<i>'\"&"]
    assert [row[1] for row in page.rows("Every picture")[1:]] == [*evil, "c"]
    assert shlex.split(commands(page, text)[0])[4] == name
    alts = [attributes["alt"] for tag, attributes in page.elements if tag == "img"]
    assert {f"wanted: {each}" for each in (*evil, "c")} <= set(alts)


def test_nothing_is_loaded_and_the_page_is_well_formed(run: Run, pictures: Path) -> None:
    save(made(), "a.npz")
    page = reported(run, "a.npz")
    for tag, attributes in page.elements:
        assert tag not in ("script", "link", "iframe", "object", "base")
        for name, value in attributes.items():
            assert not name.startswith("on")
            if name in ("src", "href"):
                assert (value or "").startswith(("data:image/", "#"))
    assert "url(" not in Path("report.html").read_text()
    levels = [int(tag[1]) for tag, _ in page.elements if tag in ("h1", "h2", "h3")]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after <= before + 1 for before, after in pairwise(levels))
    assert all(attributes.get("alt") for tag, attributes in page.elements if tag == "img")
    assert all(attributes.get("scope") in ("col", "row") for tag, attributes in page.elements if tag == "th")
    anchors = {attributes["id"] for _, attributes in page.elements if attributes.get("id")}
    assert {str(attributes["href"])[1:] for tag, attributes in page.elements if tag == "a"} <= anchors


def test_pictures_are_those_wanted_and_shown(run: Run, pictures: Path) -> None:
    save(made(), "a.npz")
    page = reported(run, "a.npz")
    found = {}
    for tag, attributes in page.elements:
        if tag == "img":
            data = base64.b64decode(str(attributes["src"]).split(",")[1])
            found[attributes["alt"]] = np.asarray(Image.open(BytesIO(data)))
    targets = load("a.npz").targets
    assert targets is not None
    for number, target in enumerate(targets, 1):
        levels = np.rint(target[..., :3] / 257)
        np.testing.assert_array_equal(found[f"wanted: {number}"], levels)
        off = found[f"shown: {number}"].astype(int) - levels
        seen = found[f"difference: {number}"].astype(int) - 128
        inside = np.abs(off) < 120
        assert np.all(np.abs(seen - off)[inside] <= 2)


def test_an_unfinished_cube_says_so_first(run: Run, pictures: Path) -> None:
    save(made(status="interrupted"), "a.npz")
    code, _, err = run("report", "a.npz", "-o", "report.html")
    assert code == 0
    assert "unfinished" in err
    text = Path("report.html").read_text()
    page = Page(text)
    assert page.texts("p")[0].startswith("This cube is unfinished")
    assert "stopped early" in text


def test_a_stage_has_its_room(run: Run, pictures: Path) -> None:
    assert run("solve", "stage.toml", "-o", "a.npz", "--iterations", 2)[0] == 0
    page = reported(run, "a.npz", "stage.toml")
    assert [row[-1] for row in page.rows("Every picture")[1:]] == ["wall", "floor"]
    assert [row[2] for row in page.rows("Where the pictures stand")[1:]] == ["sun & <moon>", "top"]
    assert any(words.endswith("lamp, glass, and 1 and 2 on the walls.") for words in page.texts("span"))
    assert "30 dB over" in page.rows("Every picture")[0]
    read = [(row[0], row[1], row[-1]) for row in page.rows("What was read")[1:]]
    inside = [Path("stage.toml"), Path("pictures/1.png"), Path("pictures/2.png")]
    roles = ("stage", "pictures", "pictures")
    hashed = [hashlib.sha256(path.read_bytes()).hexdigest() for path in inside]
    assert read[1:] == [(role, path.name, each) for role, path, each in zip(roles, inside, hashed, strict=True)]
    alone = reported(run, "a.npz")
    assert any("give it as the pictures" in words for words in alone.texts("p"))
    sizes = [(a["width"], a["height"]) for t, a in page.elements if t == "img" and str(a["alt"]).startswith("wanted")]
    assert sizes == [("6", "5"), ("4", "7")]


def test_lamps_at_several_elevations_cannot_be_said_on_the_command_line(run: Run, pictures: Path) -> None:
    cube = made()
    other = turntable(cube.grid, [33.0], elevation_deg=10, picture_shape=(3, 5)).views
    save(replace(cube, rig=Rig.of(cube.rig.views.take([0, 1]).joined(other))), "a.npz")
    page = reported(run, "a.npz")
    assert any("exactly this cube's lamps and screens" in words for words in page.texts("li"))


def test_a_cube_that_was_started_from_another_one_says_so(run: Run, pictures: Path) -> None:
    options = ["--n", 6, "--picture-width", 0.5, "--hold-deg", 0, "--grain", 0, "--iterations", 1]
    assert run("solve", "pictures", "-o", "a.npz", *options)[0] == 0
    assert run("solve", "pictures", "-o", "b.npz", *options, "--start-from", "a.npz")[0] == 0
    told = [
        any("started from another cube" in words for words in reported(run, name).texts("li"))
        for name in ("a.npz", "b.npz")
    ]
    assert told == [False, True]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["pictures", "-o", "r.html"], "cube"),
        (["a.npz", "-o", "there.html"], "exists already"),
        (["a.npz", "-o", "r.pdf"], ".html"),
        (["a.npz", "pictures", "-o", "r.html"], "3"),
        (["a.npz", "stage.toml", "-o", "r.html"], "stage"),
        (["none.npz", "-o", "r.html"], "none.npz"),
        (["bare.npz", "-o", "r.html"], "targets"),
    ],
)
def test_what_cannot_be_is_one_sentence(run: Run, pictures: Path, arguments: list[str], said: str) -> None:
    save(made(), "a.npz")
    save(made(targets=None), "bare.npz")
    Path("there.html").write_text("old")
    code, out, err = run("report", *arguments)
    assert (code, out) == (2, "")
    assert len(err.strip().splitlines()) == 1
    assert said in err
    assert Path("there.html").read_text() == "old"
    assert not Path("r.html").exists()
    assert not Path("r.pdf").exists()


def test_a_page_of_many_pictures_stays_small() -> None:
    cube = made()
    targets = targets_of(cube)
    assert chosen(targets) == [0, 1, 2]
    assert chosen(targets, 2 * 3 * 5) == [0, 2]
    assert chosen(targets, 1) == [0]
    random = np.random.default_rng(0)
    noise = random.integers(0, 255, (96, 96, 3), dtype=np.uint8)
    smooth = np.kron(random.integers(0, 255, (12, 12, 3)), np.ones((16, 16, 1))).astype(np.uint8)
    assert len(image(noise, "")) / noise[..., 0].size * 3 * EXACT < 1e7
    assert len(image(smooth, "", exact=False)) / smooth[..., 0].size * 3 * MOST < 1e7


@pytest.mark.skipif(INTERPRETED, reason="the same page as with compiled kernels")
@pytest.mark.usefixtures("large_rooms")
def test_a_browser_finds_nothing_to_mend(run: Run, pictures: Path, browser: Any) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is not installed").Axe()
    save(made(), "a.npz")
    reported(run, "a.npz")
    for width, scheme in ((1280, "light"), (360, "dark")):
        tab, heard = opened(browser, Path("report.html").absolute(), width=width, color_scheme=scheme)
        assert axe.run(tab, options={"resultTypes": ["violations"]}).response["violations"] == []
        assert tab.evaluate("document.documentElement.scrollWidth") <= width
        assert [each for each in heard if not each.startswith("file:")] == []
        tab.context.close()


@pytest.mark.parametrize("darkest", [1000.0, 5.0])
def test_single_dark_voxels_are_told(run: Run, pictures: Path, darkest: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lightcube.report.sections._COARSE_DB", -100)
    cube = made()
    extinction = cube.extinction.copy()
    extinction[:, 1, 2, 3] = darkest / cube.grid.voxel_mm
    save(replace(cube, extinction=extinction), "a.npz")
    told = any("far darker" in words for words in reported(run, "a.npz").texts("p"))
    assert told == (darkest > 10)


@pytest.mark.parametrize(("low", "high"), [(14.3, 16.0), (0.6, 16.0)])
def test_the_axis_of_lamp_powers_can_be_read(low: float, high: float) -> None:
    drawing = lamp_powers(np.arange(1.0, 4.0), np.array([[low], [high], [high]]), high, "lamps")
    labels = [float(said) for said in re.findall(r'text-anchor="end">([\d.]+)<', drawing)]
    assert len([each for each in labels if low / 1.3 < each < 1.3 * high]) >= 2


@pytest.mark.parametrize("compared", [0, 257])
def test_no_login_and_no_signature_of_a_url_is_in_a_report(
    pictures: Path, monkeypatch: pytest.MonkeyPatch, compared: int
) -> None:
    """The command that makes the cube again says that they are to be put in."""
    url, cube = "https://me:secret@host/photos.gif?key=secret&sig=secret", made()
    targets = wanted_of(cube, None)
    monkeypatch.setattr(reporting, "wanted_of", lambda *_: targets)
    monkeypatch.setattr(reporting, "measure", lambda *_: replace(measure(*_), apart=compared))
    text = reporting.report(cube, "https://me:secret@host/c.npz?sig=secret", url, lambda _: None).text
    assert "secret" not in text
    assert "https://***@host/photos.gif?***" in text
    assert "put them in again" in text
    assert "the pictures in photos.gif, which" in text
