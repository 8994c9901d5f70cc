"""Every kind of thing is foretold, made as its command makes it, stopped, and taken away, in words of its own."""

import gzip
import json
import threading
from base64 import b64decode
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from PIL import Image

pytest.importorskip("fastapi", reason="the studio's extra is not installed")

import lightcube as lc
from lightcube import io
from lightcube.errors import InputError
from lightcube.events import Interrupted
from lightcube.scoring.reliefs import score_relief
from lightcube.studio import away, plates, rooms
from lightcube.studio.forecaster import Asked
from lightcube.studio.kinds import KINDS, check_there, command_of, described, kind_of, made_of, used
from lightcube.studio.makers import without_commands
from lightcube.studio.making import MOST_PICTURES, FilmsMaking, PlateMaking, ShapeMaking
from lightcube.studio.offered import THINGS
from lightcube.studio.pictures import Strip
from lightcube.studio.project import MADE, KindName, Picture, Project, Settings
from lightcube.studio.solver import Task
from lightcube.verbs import hulls, reliefs
from lightcube.viewer.label import Label
from tests.cli.test_cli import run

__all__ = ["run"]

ROOM = rooms.Room.model_validate(
    {
        "stops_deg": [10, 55],
        "lamps": [{"name": "lamp", "x": -150, "y": 0, "z": 105}],
        "screens": [{"name": "wall", "x": 150, "y": 0, "z": -105, "lamp": "lamp"}],
    }
)
#: Of each kind, how it is made soon.
SMALL: dict[str, Any] = {
    "shape": ShapeMaking(voxels=32, size_mm=40, wall_mm=0.4),
    "plate": PlateMaking(columns=32, quality="draft"),
    "films": FilmsMaking(films=3, cells=16, quality="draft", assembly_mm=0),
    "parts": {"rooms": ROOM.model_dump(mode="json")},
}
MADE_SOON: list[KindName] = ["shape", "plate", "films", "room"]


class Told:
    """Hears what is told; stops after so many steps."""

    def __init__(self, most: float = np.inf) -> None:
        self.heard: list[tuple[str, dict[str, Any]]] = []
        self.stopping, self._left = threading.Event(), most

    def __call__(self, what: str, **facts: Any) -> None:
        self.heard.append((what, facts))

    def pass_on(self, _: Any) -> bool:
        self._left -= 1
        if self._left < 0:
            self.stopping.set()
        return self.stopping.is_set()


class Looking:
    """Whom nobody asks for anything newer."""

    kept = None

    def __init__(self) -> None:
        self.orders: dict[Any, Any] = {}

    def give_way(self) -> None:
        """Nothing newer is asked for."""

    def watch(self, _: Any) -> None:
        """Nothing newer is asked for."""

    def show(self, _: Any, thing: Any) -> None:
        self.shown = thing

    def look(self, planned: Any, size: Any = None) -> Any:
        from lightcube.planning.prediction import rehearsed

        width, passes = size or (20, 4)
        return rehearsed(planned.targets, planned.grid, planned.recipe, width=width, passes=passes)


@pytest.fixture
def project(desk: Any) -> Project:
    """Three pictures, each with shapes on plain ground."""
    y, x = np.indices((40, 40)) / 39 - 0.5
    shapes = [np.maximum(abs(x), abs(y)) < 0.3, np.hypot(x, y) < 0.35, (abs(x) < 0.3) & (y > -0.3) & (y < 0.35)]
    opened: Project = desk.project
    pictures = []
    for number, shape in enumerate(shapes):
        levels = np.where(shape[..., None], (40, 60 * number, 120), 235).astype(np.uint8)
        key = f"{number:016x}"
        Image.fromarray(levels).save(opened.path("dropped", f"{key}.png"))
        pictures.append(Picture(key=key, name="abc"[number]))
    opened.change(lambda before: before.model_copy(update={"pictures": tuple(pictures), **SMALL}))
    return opened


def become(project: Project, desk: Any, name: str) -> Settings:
    """Let the project become something, and write what is read of it."""
    settings = project.change(lambda before: before.model_copy(update={"kind": name}))
    Strip(desk).write()
    rooms.write(project)
    return settings


def asked(project: Project) -> Asked:
    settings = project.settings
    kind, pictures = kind_of(settings), used(settings)
    files = tuple(project.path("dropped", f"{each.key}.png") for each in pictures)
    keys, names = tuple(each.key for each in pictures), tuple(each.name for each in pictures)
    crops = tuple(each.crop for each in pictures)
    source = project.folder / kind.source
    return Asked(1, kind.foretell, kind.how(settings), keys, names, files, crops, source, "")


def test_the_table_is_whole() -> None:
    assert set(KINDS) == set(get_args(KindName))
    assert len({kind.stem for kind in KINDS.values()}) == len(KINDS)
    for told, (name, kind) in zip(described(), KINDS.items(), strict=True):
        settings = Settings(kind=name, pictures=())
        least, most = kind.counts(settings)
        assert 1 <= least <= most <= MOST_PICTURES
        assert hasattr(settings, kind.settings)
        assert told["name"] == name
        assert list(THINGS[kind.things]) == list(away.MAKERS[kind.things][0])
        assert command_of(Path("/a"), settings).startswith(f"lightcube {kind.verb} /a/{kind.source} -o /a/made/")


def test_a_project_of_before_there_were_kinds_is_a_cube(tmp_path: Path) -> None:
    (tmp_path / "project.toml").write_text("format = 1\ntitle = 'old'\n\n[making]\nvoxels = 32\n")
    old = Project(tmp_path)
    assert (old.settings.kind, old.settings.making.voxels, old.settings.plate) == ("cube", 32, PlateMaking())
    old.close()


def test_what_it_is_made_of_changes_with_what_counts_and_with_nothing_else() -> None:
    pictures = tuple(Picture(key=f"{number:016x}", name="n") for number in range(6))
    plate = Settings(kind="plate", pictures=pictures)
    wider = plate.model_copy(update={"making": plate.making.model_copy(update={"width": 0.9})})
    finer = plate.model_copy(update={"plate": plate.plate.model_copy(update={"columns": 64})})
    fewer = plate.model_copy(update={"pictures": pictures[:3]})
    more = plate.model_copy(update={"pictures": pictures[:5]})
    assert made_of(plate) == made_of(wider) == made_of(more)
    assert len({made_of(plate), made_of(finer), made_of(fewer), made_of(Settings(pictures=pictures))}) == 4
    room = Settings(kind="room", pictures=pictures)
    moved = room.model_copy(update={"parts": SMALL["parts"]})
    assert made_of(room) != made_of(moved)


def test_pictures_stand_where_they_are_said_to(project: Project, desk: Any) -> None:
    """Where the silhouettes and lamps of what is read are; nothing is said where something else decides."""
    settings = become(project, desk, "shape")
    wanted = hulls.read([str(project.folder / "pictures")], *KINDS["shape"].how(settings)[:2])
    screens = wanted.silhouettes.rig.screens.names
    assert KINDS["shape"].places(settings) == screens == ("front", "side", "top")
    assert wanted.silhouettes.names == ("a", "b", "c")
    best = settings.model_copy(update={"shape": settings.shape.model_copy(update={"placement": "best"})})
    named = [
        each.model_copy(update={"name": name}) for each, name in zip(settings.pictures, screens[::-1], strict=True)
    ]
    for other in (best, settings.model_copy(update={"pictures": tuple(named)})):
        assert KINDS["shape"].places(other) == ()
    assert KINDS["plate"].places(settings)[1] == "lamp on the left"
    settings = become(project, desk, "room")
    stage = io.read_stage(project.path(rooms.FILE))[0]
    assert KINDS["room"].places(settings) == [f"{shot.screen} {shot.stop + 1}" for shot in stage.shots]


@pytest.mark.parametrize("name", MADE_SOON)
def test_what_will_come_is_told_of_every_picture(name: KindName, project: Project, desk: Any) -> None:
    settings = become(project, desk, name)
    looking = Looking()
    told = list(kind_of(settings).foretell(looking, asked(project)))  # type: ignore[arg-type]
    assert [each["stage"] for each in told] in (["first", "whole"], ["whole"])
    for each in told:
        assert [picture["key"] for picture in each["pictures"]] == [picture.key for picture in used(settings)]
        assert {picture["mark"] for picture in each["pictures"]} <= {"good", "fair", "poor"}
        assert all(picture["worth"] and picture["image"] for picture in each["pictures"])
        assert name != "plate" or is_plain(each["notes"])
    assert looking.shown is not None


def is_plain(said: list[str]) -> bool:
    """Whether sentences are for people who make things, and know nothing of how they are computed."""
    return not any(word in each for each in said for word in ("dB", "PSNR", "sweep", "column", "near by ("))


def a_ramp() -> lc.Pictures:
    """A picture from dark to light."""
    return lc.Pictures((np.linspace(0, 1, 192, dtype=np.float32).reshape(8, 8, 3),), ("a",))


@pytest.mark.parametrize(
    ("black", "worst", "said"),
    [
        (0.2, 27.0, ["nearly black", "a few degrees more or less do no harm"]),
        (0.4, 26.2, ["dark grey: a higher relief makes it darker", "3° more or less make the pictures a little worse"]),
        (0.6, 20.0, ["middle grey", "with care: 3° more or less make the pictures poor"]),
    ],
)
def test_of_a_plate_it_is_said_what_to_do(black: float, worst: float, said: list[str]) -> None:
    plate = lc.relief(
        lc.Pictures((np.linspace(0, 1, 192, dtype=np.float32).reshape(8, 8, 3),), ("a",)),
        lc.ReliefRecipe(side=16, sweeps=1),
    )
    scores = score_relief(plate, off=True) | {"black": black, "psnr_mean": 27.5}
    scores["off"] = {"3 deg higher": worst, "3 deg lower": 27.5}
    found = plates.told(plate, scores)
    assert is_plain(found)
    for each in said:
        assert any(each in line for line in found)


def test_outlines_that_no_solid_casts_are_not_called_good(project: Project, desk: Any) -> None:
    become(project, desk, "shape")
    good = next(KINDS["shape"].foretell(Looking(), asked(project)))  # type: ignore[arg-type]
    assert {picture["mark"] for picture in good["pictures"]} == {"good"}
    high, low = np.full((40, 40, 3), 235, np.uint8), np.full((40, 40, 3), 235, np.uint8)
    high[5:15, 8:32], low[5:35, 8:32], low[12:28, 12:28] = 20, 20, 235
    high[25:35, 8:32] = 20
    for number, levels in enumerate((high, low, low)):
        Image.fromarray(levels).save(project.path("dropped", f"{number:016x}.png"))
    become(project, desk, "shape")
    bad = next(KINDS["shape"].foretell(Looking(), asked(project)))  # type: ignore[arg-type]
    assert {picture["mark"] for picture in bad["pictures"]} != {"good"}


def test_a_doubt_about_a_picture_stands_beside_it(project: Project, desk: Any) -> None:
    levels = np.full((40, 40, 3), 235, np.uint8)
    levels[:30, 8:32] = 20  # cut off above
    Image.fromarray(levels).save(project.path("dropped", f"{1:016x}.png"))
    become(project, desk, "shape")
    told = list(KINDS["shape"].foretell(Looking(), asked(project)))[-1]  # type: ignore[arg-type]
    reasons = [picture["reason"] for picture in told["pictures"]]
    assert reasons == ["", "its shape touches the border of its picture, and may be cut off there", ""]
    assert not any(each.startswith("b: ") for each in told["notes"])


@pytest.mark.parametrize("name", MADE_SOON)
def test_it_is_made_as_its_command_makes_it_and_taken_away(
    name: KindName, project: Project, desk: Any, run: Callable[..., Any], tmp_path: Path
) -> None:
    settings = become(project, desk, name)
    kind = kind_of(settings)
    check_there(project)
    out = project.path(MADE, kind.file)
    told = Told()
    kind.make(told, "start", Task(str(project.folder / kind.source), str(out), kind.how(settings), "mine"))  # type: ignore[arg-type]
    done = next(facts for what, facts in told.heard if what == "done")
    assert [each["name"] for each in done["pictures"]] == [picture.name for picture in used(settings)]
    assert name != "plate" or is_plain(done["said"])
    scene = [facts["scene"] for what, facts in told.heard if what == "cube"][-1]
    assert json.loads(gzip.decompress(b64decode(scene)))["title"] == "mine"
    words = command_of(project.folder, settings).split()[1:]
    other = tmp_path / f"other{kind.file[kind.file.index('.') :]}"
    words[words.index("-o") + 1] = str(other)
    assert run(*words).code == 0
    read = {"hull": io.read_shape, "relief": io.read_relief, "solve": io.read_cube}[kind.verb]
    one, two = read(out), read(other)
    what = {"hull": "field", "relief": "heights_px", "solve": "extinction"}[kind.verb]
    np.testing.assert_array_equal(getattr(one, what), getattr(two, what))


def made(name: KindName, project: Project, desk: Any) -> Path:
    settings = become(project, desk, name)
    kind, out = kind_of(settings), project.path(MADE, kind_of(settings).file)
    kind.make(Told(), "start", Task(str(project.folder / kind.source), str(out), kind.how(settings), ""))  # type: ignore[arg-type]
    return out


@pytest.mark.parametrize("name", ["shape", "plate", "films"])
def test_each_thing_that_is_offered_is_made_and_says_what_it_is_worth(
    name: KindName, project: Project, desk: Any, tmp_path: Path
) -> None:
    source = made(name, project, desk)
    offer = KINDS[name].things
    for thing, offered in THINGS[offer].items():
        if offered.suffix == "mp4":
            continue  # movies take long: they are made of cubes in tests/drawing
        target = tmp_path / f"{thing}.{offered.suffix}"
        said = away.make(offer, thing, source, target, Label("mine"), lambda _: None, captions=False)
        assert target.exists()
        assert said
        assert not any("lightcube " in each or "--" in each for each in said)


@pytest.mark.parametrize("name", ["shape", "plate"])
def test_what_is_stopped_leaves_nothing(name: KindName, project: Project, desk: Any) -> None:
    settings = become(project, desk, name)
    kind, out = kind_of(settings), project.path(MADE, kind_of(settings).file)
    task = Task(str(project.folder / kind.source), str(out), kind.how(settings), "")
    with pytest.raises(Interrupted):
        kind.make(Told(1), "start", task)  # type: ignore[arg-type]
    assert not list(project.path(MADE).iterdir())


def test_a_lamp_goes_once_round_a_plate(project: Project, desk: Any, tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.setattr(reliefs, "ROUND", 8)
    monkeypatch.setattr(reliefs, "REST", 2)
    target = tmp_path / "round.mp4"
    said = away.make(
        "plates", "round", made("plate", project, desk), target, Label("mine"), lambda _: None, captions=False
    )
    assert target.stat().st_size > 1000
    assert said == ["the lamp goes round once, and rests at each picture"]


@pytest.mark.parametrize(
    ("name", "count", "said"),
    [
        ("cube", 1, "the cube needs at least 2 pictures, and there is one"),
        ("shape", 2, "the solid needs at least 3 pictures, and there are 2"),
        ("plate", 0, "the plate needs at least 1 picture, and there is none"),
        ("films", 0, "the films need at least 2 pictures, and there is none"),
    ],
)
def test_too_few_pictures_are_a_sentence(name: KindName, count: int, said: str, project: Project) -> None:
    project.change(lambda before: before.model_copy(update={"kind": name, "pictures": before.pictures[:count]}))
    with pytest.raises(InputError, match=said):
        check_there(project)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("a contradicts b: lightcube check --opaque says where", ["a contradicts b"]),
        ("it casts a 90%; --overlay draws what has changed, and more", ["it casts a 90%"]),
        ("or coloured glass (lightcube solve)", ["or coloured glass"]),
        ("more columns (--columns)", ["more columns"]),
        ("lightcube view shows it", []),
        ("plate 10 x 10 mm (two), as it is", ["plate 10 x 10 mm (two), as it is"]),
    ],
)
def test_people_without_a_terminal_are_not_told_what_to_type(given: str, said: list[str]) -> None:
    assert without_commands([given]) == said
