"""Cubes and unfinished cubes of stages on the disk: every number comes back, and damage is one sentence."""

import json
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lightcube import load, save
from lightcube.backward.job import Job, differences, fingerprint
from lightcube.backward.pieces import solve_piece
from lightcube.backward.solution import merged
from lightcube.backward.solving import make_job
from lightcube.backward.solving import solve_job as solved
from lightcube.errors import InputError
from lightcube.io._rig import RigJson, rig_to_json
from lightcube.jobs.partial import DiskStore, load_job, open_partial
from lightcube.jobs.reading import UnfinishedCube
from lightcube.optics.cube import Cube
from lightcube.optics.glass import Glass
from lightcube.optics.light import Light
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.pictures.fitting import as_levels
from lightcube.pictures.targets import Targets
from tests.backward.test_job import same
from tests.helpers.areas import divided
from tests.helpers.recipes import asked
from tests.helpers.wall import play
from tests.io.test_cubes import SUFFIXES, change, partial_path, put
from tests.io.test_cubes import assert_same as assert_same_field
from tests.optics.test_rig import GRID, ROOM, extinction, made, powers_of


def assert_same_rig(one: Rig, other: Rig) -> None:
    assert one.glass == other.glass
    for part in fields(Rig):
        if part.name == "glass":
            continue
        for each in fields(getattr(one, part.name)):
            names = getattr(one, part.name), getattr(other, part.name)
            assert_same_field(*(getattr(thing, each.name) for thing in names))


def assert_same(one: Cube, other: Cube) -> None:
    """Every field, bit for bit."""
    assert_same_rig(one.rig, other.rig)
    assert_same_field(replace(one, rig=other.rig), other)


def some_cube(**more: Any) -> Cube:
    """Lamps with discs, sampled; numbers that no decimal fraction is."""
    lamps = tuple(replace(lamp, size_deg=0.1 + 0.2) for lamp in ROOM.lamps)
    rig = divided(replace(ROOM, lamps=lamps).rig(), lamp=2, pixel=2)
    levels = np.random.default_rng(1).integers(0, 65536, (4, 5, 5, 4), np.uint16)
    return Cube(extinction(), GRID, rig, powers_of(rig), levels, **more)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_cube_of_a_stage_comes_back_bit_for_bit(tmp_path: Path, suffix: str) -> None:
    for name, cube in (("sampled", some_cube(hold_deg=1 / 3)), ("plain", made(ROOM))):
        again = load(save(cube, tmp_path / f"{name}{suffix}"))
        assert_same(again, cube)
        np.testing.assert_array_equal(play(again), play(cube))
        np.testing.assert_array_equal(play(again, [7.0]), play(cube, [7.0]))


def test_rigs_come_back_from_json_bit_for_bit() -> None:
    bath, three = Glass(4 / 3, "round-bath"), Glass((1.5 - 1 / 300, 1.5, 1.5 + 1 / 300), bottom="blocked")
    in_glass = [turntable(GRID, [1 / 3, 77.0], elevation_deg=12.3, glass=glass) for glass in (bath, three)]
    for rig in (ROOM.rig(), some_cube().rig, turntable(GRID, [1 / 3, 77.0], elevation_deg=12.3), *in_glass):
        text = json.dumps(rig_to_json(rig), allow_nan=False)
        assert_same_rig(RigJson.model_validate(json.loads(text)).rig(), rig)


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (put("rig", value=[]), "rig"),
        (put("rig", "more", value=1), r"rig\.more"),
        (put("rig", "sums", "share", 0, 0, value=-1.0), r"rig\.sums\.share\.0\.0"),
        (put("rig", "sums", "share", 0, value=[1.0]), "share|inhomogeneous"),
        (put("rig", "sums", "share", value=[]), "share"),
        (put("rig", "sums", "picture", 0, value=1), "order of their pictures"),
        (put("rig", "sums", "picture", -1, value=2), "none of which is left out"),
        (put("rig", "sums", "picture", value=[]), "share of a rig|lamp of a rig|disc_deg of a rig"),
        (put("rig", "sums", "lamp", 0, value=99), "numbers of the names"),
        (put("rig", "stops", "screen", 0, value=99), "numbers of the names"),
        (put("rig", "sums", "lamp", 0, value=-1), r"rig\.sums\.lamp\.0"),
        (put("rig", "lamps", "names", value=["sun"]), "least"),
        (put("rig", "fading", "reach_mm", 0, value=[1.0]), r"rig\.fading\.reach_mm\.0"),
        (put("rig", "fading", "falloff_mm", 0, 0, value="far"), r"rig\.fading\.falloff_mm\.0\.0"),
        (put("rig", "turning", "axis", value=[0.0, 0.0]), r"rig\.turning\.axis"),
        (put("rig", "stops", "angle_deg", 0, value=float("nan")), r"rig\.stops\.angle_deg\.0"),
        (put("rig", "stops", "angle_deg", value=[]), "angle|screen|order|stops"),
        (put("rig", "stops", "window", 0, value=[5]), r"rig\.stops\.window\.0"),
        (put("rig", "lamps", "least", 0, value=100.0), "least before the largest"),
        (put("rig", value=None), "rig"),
        (put("format_version", value=1.5), "format_version"),
        (put("lamp_powers", value=[[1.0, 1.0, 1.0]]), "lamp powers"),
    ],
)
def test_a_damaged_rig_is_one_sentence(tmp_path: Path, suffix: str, edit: Any, message: str) -> None:
    path = save(made(ROOM), tmp_path / f"a{suffix}")
    change(path, edit)
    with pytest.raises(InputError, match=f"damaged light cube.*({message})") as caught:
        load(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def job(glass: Glass | None = None, **options: Any) -> Job:
    """On a room with fixed and with free lamps, or on a turntable in glass."""
    stage = replace(ROOM, lamps=(replace(ROOM.lamps[0], power=1.1), *ROOM.lamps[1:]))
    in_glass = turntable(GRID, [1 / 3, 77.0, 130.0, 250.0], elevation_deg=20, picture_shape=(5, 5), glass=glass)
    rig = stage.rig() if glass is None else in_glass
    pictures = np.random.default_rng(2).uniform(0.1, 1, (4, 5, 5, 3)).astype(np.float32)
    targets = Targets(pictures, rig, rig.inside.astype(np.float32))
    return make_job(**asked(targets, GRID, **{"passes": 4, **options}))


KINDS: list[dict[str, Any]] = [
    {},
    {"units": 2, "hold_deg": 2.0},
    {"powers": "shared", "units": 3},
    {"powers": "coarse"},
    {"glass": Glass(1.5 + 1e-3 / 3, "cylinder"), "units": 3},
    {"glass": Glass((1.49, 1.5, 1.52)), "hold_deg": 1.0, "light": Light(3)},
]


@pytest.mark.parametrize("options", KINDS, ids=str)
def test_a_job_of_a_stage_comes_back_from_the_disk(tmp_path: Path, options: dict[str, Any]) -> None:
    """And so does its cube, finished or not; killed and continued it is the same, bit for bit."""
    one, out = job(**options), tmp_path / "a.zarr"
    store = open_partial(out, one)
    again = load_job(partial_path(out))
    assert fingerprint(again) == fingerprint(one)
    assert_same_rig(again.targets.rig, one.targets.rig)
    for name in again.pieces:
        assert not solve_piece(again, name, store, lambda step: True)
        with pytest.warns(UnfinishedCube, match="still being made"):
            reached = load(partial_path(out))
        assert reached.status == "interrupted"
        assert_same_rig(reached.rig, one.targets.rig)
        assert solve_piece(again, name, DiskStore(partial_path(out)))
    whole = solved(one)
    assert same(merged(again, store), whole)
    np.testing.assert_array_equal(merged(again, store).cube.targets, as_levels(one.targets))
    assert_same_rig(whole.cube.rig, one.targets.rig)


def test_a_folder_begun_under_other_lamps_is_refused(tmp_path: Path) -> None:
    one = job()
    open_partial(tmp_path / "a.zarr", one)
    rig = one.targets.rig
    others = [
        replace(rig, sums=replace(rig.sums, share=rig.sums.share * 0.5)),
        replace(rig, fading=replace(rig.fading, reach_mm=rig.fading.reach_mm + 1)),
        replace(rig, lamps=replace(rig.lamps, least=rig.lamps.least / 2)),
        replace(rig, screens=replace(rig.screens, black=rig.screens.black * 2)),
        replace(rig, fading=replace(rig.fading, veil=rig.fading.veil + 0.1)),
    ]
    for changed in others:
        other = replace(one, targets=replace(one.targets, rig=changed))
        assert "the lamps and screens differ" in differences(fingerprint(one), fingerprint(other))
        with pytest.raises(InputError, match="the lamps and screens differ"):
            open_partial(tmp_path / "a.zarr", other)


def test_a_damaged_rig_of_an_unfinished_cube_is_one_sentence(tmp_path: Path) -> None:
    open_partial(tmp_path / "a.zarr", job())
    file = partial_path(tmp_path / "a.zarr") / "job.json"
    whole = json.loads(file.read_text())
    for part, name, value, message in (
        ("sums", "lamp", [99] * 8, "numbers of the names"),
        ("sums", "share", [], "share"),
        ("fading", "reach_mm", [[1.0, None]] * 8, "the lamps and screens differ"),
        ("fading", "cosine", "yes", r"rig\.fading\.cosine"),
    ):
        damaged = {**whole["rig"], part: {**whole["rig"][part], name: value}}
        file.write_text(json.dumps({**whole, "rig": damaged}))
        with pytest.raises(InputError, match=f"job.json is damaged|targets.npz is damaged.*{message}") as caught:
            load_job(file.parent)
        assert message.replace("\\", "") in str(caught.value)
        assert "\n" not in str(caught.value)
