"""Cubes and unfinished cubes of stages on the disk: every number comes back, and damage is one sentence."""

import json
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lightcube import load, play, save
from lightcube.backward.job import Job, differences, fingerprint
from lightcube.backward.pieces import solve_piece
from lightcube.backward.solution import merged
from lightcube.backward.solving import make_job
from lightcube.backward.solving import run as solved
from lightcube.errors import InputError
from lightcube.io._lighting import LightingJson, lighting_to_json
from lightcube.jobs.cubes import UnfinishedCube
from lightcube.jobs.partial import DiskStore, load_job, open_partial
from lightcube.optics.cube import Cube
from lightcube.optics.rig import Lighting, sampled
from lightcube.optics.stage import exposures
from lightcube.pictures.fitting import targets
from lightcube.pictures.frames import Frames
from tests.backward.test_job import same
from tests.helpers.recipes import asked
from tests.io.test_cubes import SUFFIXES, change, partial_path, put
from tests.io.test_cubes import assert_same as assert_same_but_lighting
from tests.optics.test_rig import GRID, ROOM, extinction, made, powers_of


def assert_same_lighting(one: Lighting | None, other: Lighting | None) -> None:
    assert one is not None
    assert other is not None
    for each in fields(Lighting):
        assert_same_but_lighting(getattr(one, each.name), getattr(other, each.name))


def assert_same(one: Cube, other: Cube) -> None:
    """Every field, bit for bit."""
    assert_same_lighting(one.lighting, other.lighting)
    assert_same_but_lighting(replace(one, lighting=other.lighting), other)


def some_cube(**more: Any) -> Cube:
    """Lamps with discs, sampled; numbers that no decimal fraction is."""
    lamps = tuple(replace(lamp, size_deg=0.1 + 0.2) for lamp in ROOM.lamps)
    views, lighting = sampled(*exposures(replace(ROOM, lamps=lamps)), lamp_samples=2, pixel_samples=2)
    levels = np.random.default_rng(1).integers(0, 256, (4, 5, 5, 4), np.uint8)
    return Cube(extinction(), GRID, views, powers_of(lighting), levels, lighting=lighting, **more)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_cube_of_a_stage_comes_back_bit_for_bit(tmp_path: Path, suffix: str) -> None:
    for name, cube in (("sampled", some_cube(hold_deg=1 / 3)), ("plain", made(ROOM))):
        again = load(save(cube, tmp_path / f"{name}{suffix}"))
        assert_same(again, cube)
        np.testing.assert_array_equal(play(again), play(cube))
        np.testing.assert_array_equal(play(again, [7.0]), play(cube, [7.0]))


def test_lightings_come_back_from_json_bit_for_bit() -> None:
    assert lighting_to_json(None) is None
    for lighting in (exposures(ROOM)[1], some_cube().lighting):
        text = json.dumps(lighting_to_json(lighting), allow_nan=False)
        assert_same_lighting(LightingJson.model_validate(json.loads(text)).lighting(), lighting)


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (put("lighting", value=[]), "lighting"),
        (put("lighting", "more", value=1), r"lighting\.more"),
        (put("lighting", "share", 0, 0, value=-1.0), r"lighting\.share\.0\.0"),
        (put("lighting", "share", 0, value=[1.0]), "share|inhomogeneous"),
        (put("lighting", "share", value=[]), "share"),
        (put("lighting", "picture", 0, value=1), "order of their pictures"),
        (put("lighting", "picture", -1, value=2), "none of which is left out"),
        (put("lighting", "picture", value=[]), "lamp of a lighting has shape"),
        (put("lighting", "lamp", 0, value=99), "numbers of the names"),
        (put("lighting", "screen", 0, value=99), "numbers of the names"),
        (put("lighting", "lamp", 0, value=-1), r"lighting\.lamp\.0"),
        (put("lighting", "lamp_names", value=["sun"]), "least"),
        (put("lighting", "reach_mm", 0, value=[1.0]), r"lighting\.reach_mm\.0"),
        (put("lighting", "falloff_mm", 0, 0, value="far"), r"lighting\.falloff_mm\.0\.0"),
        (put("lighting", "axis", value=[0.0, 0.0]), r"lighting\.axis"),
        (put("lighting", "angle", 0, value=float("nan")), r"lighting\.angle\.0"),
        (put("lighting", "angle", value=[]), "angle|screen|order"),
        (put("lighting", "window", 0, value=[5]), r"lighting\.window\.0"),
        (put("lighting", "least", 0, value=100.0), "least before most"),
        (put("lighting", value=None), "lamp powers|names|targets"),
        (put("format_version", value=1.5), "format_version"),
        (put("lamp_powers", value=[[1.0, 1.0, 1.0]]), "lamp powers"),
    ],
)
def test_a_damaged_lighting_is_one_sentence(tmp_path: Path, suffix: str, edit: Any, message: str) -> None:
    path = save(made(ROOM), tmp_path / f"a{suffix}")
    change(path, edit)
    with pytest.raises(InputError, match=f"damaged light cube.*({message})") as caught:
        load(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def job(**options: Any) -> Job:
    """On a room with fixed and with free lamps."""
    stage = replace(ROOM, lamps=(replace(ROOM.lamps[0], power=1.1), *ROOM.lamps[1:]))
    views, lighting = exposures(stage)
    pictures = np.random.default_rng(2).uniform(0.1, 1, (4, 5, 5, 3)).astype(np.float32)
    frames = Frames(pictures, views, lighting.inside((5, 5)).astype(np.float32), lighting=lighting)
    return make_job(frames, GRID, **asked(**{"passes": 4, **options}))


KINDS: list[dict[str, Any]] = [
    {},
    {"units": 2, "hold_deg": 2.0},
    {"powers": "shared", "units": 3},
    {"powers": "coarse"},
]


@pytest.mark.parametrize("options", KINDS, ids=str)
def test_a_job_of_a_stage_comes_back_from_the_disk(tmp_path: Path, options: dict[str, Any]) -> None:
    """And so does its cube, finished or not; killed and continued it is the same, bit for bit."""
    one, out = job(**options), tmp_path / "a.zarr"
    store = open_partial(out, one)
    again = load_job(partial_path(out))
    assert fingerprint(again) == fingerprint(one)
    assert_same_lighting(again.frames.lighting, one.frames.lighting)
    for name in again.pieces:
        assert not solve_piece(again, name, store, lambda step: True)
        with pytest.warns(UnfinishedCube, match="still being made"):
            reached = load(partial_path(out))
        assert reached.status == "interrupted"
        assert_same_lighting(reached.lighting, one.frames.lighting)
        assert solve_piece(again, name, DiskStore(partial_path(out)))
    whole = solved(one)
    assert same(merged(again, store), whole)
    np.testing.assert_array_equal(merged(again, store).cube.targets, targets(one.frames))
    assert_same_lighting(whole.cube.lighting, one.frames.lighting)


def test_a_folder_begun_under_other_lamps_is_refused(tmp_path: Path) -> None:
    one = job()
    open_partial(tmp_path / "a.zarr", one)
    lighting = one.frames.lighting
    assert lighting is not None
    others: list[dict[str, Any]] = [
        {"share": lighting.share * 0.5},
        {"reach_mm": lighting.reach_mm + 1},
        {"least": lighting.least / 2},
    ]
    for changes in others:
        other = replace(one, frames=replace(one.frames, lighting=replace(lighting, **changes)))
        assert differences(fingerprint(one), fingerprint(other)) == ["the lamps differ"]
        with pytest.raises(InputError, match="the lamps differ"):
            open_partial(tmp_path / "a.zarr", other)


def test_a_damaged_lighting_of_an_unfinished_cube_is_one_sentence(tmp_path: Path) -> None:
    open_partial(tmp_path / "a.zarr", job())
    file = partial_path(tmp_path / "a.zarr") / "job.json"
    whole = json.loads(file.read_text())
    for name, value, message in (
        ("lamp", [99] * 8, "numbers of the names"),
        ("share", [], "share"),
        ("reach_mm", [[1.0, None]] * 8, "the lamps differ"),
        ("cosine", "yes", r"lighting\.cosine"),
    ):
        file.write_text(json.dumps({**whole, "lighting": {**whole["lighting"], name: value}}))
        with pytest.raises(InputError, match=f"job.json is damaged|frames.npz is damaged.*{message}") as caught:
            load_job(file.parent)
        assert message.replace("\\", "") in str(caught.value)
        assert "\n" not in str(caught.value)
