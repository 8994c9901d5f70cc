"""Work that was killed, stopped, split up or spoilt: what is on the disk, and how it goes on from there."""

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from lightcube import load, save
from lightcube.backward import needs
from lightcube.backward.job import Job, fingerprint
from lightcube.backward.pieces import solve_piece
from lightcube.backward.solution import merged
from lightcube.backward.solving import solve_job as solved
from lightcube.errors import InputError
from lightcube.jobs import publishing
from lightcube.jobs.partial import DiskStore, discard_partial, load_job, open_partial
from lightcube.jobs.publishing import publish
from lightcube.jobs.reading import UnfinishedCube
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.material import Material
from lightcube.optics.setups import turntable
from tests.backward.test_job import DYED, LEVEL, RAISED, job, same
from tests.cli.test_cli import pressed, run
from tests.conftest import INTERPRETED
from tests.io.test_cubes import assert_same, content, files_in, partial_path

__all__ = ["run"]

#: What suits a small cube, in programs of their own and in this one.
SMALL = {
    "lightcube.backward.job.COARSE_PASSES": 20,
    "lightcube.backward.needs.PROGRAM": 0,
    **{f"lightcube.planning.order.{name}": 1 for name in ("_PASSES", "_WALKS", "_SWAPS")},
}
#: The command line, with a checkpoint after every pass.
PROGRAM = f"""
from importlib import import_module
for name, value in {SMALL}.items():
    module, _, own = name.rpartition(".")
    setattr(import_module(module), own, value)
from lightcube.backward import pieces
pieces.FIRST_CHECKPOINT_S = pieces.CHECKPOINT_S = pieces._PATIENCE = 0.0
from lightcube.__main__ import main
main()
"""
PASSES = 4 if INTERPRETED else 300
ANOTHER = Cube(np.zeros((3, 2, 3, 4), np.float32), Grid((2, 3, 4)), turntable(Grid((2, 3, 4)), [0.0]))
CLEAR = Material(4.0, clear=(0.02, 0.03, 0.01))
LEVEL_LAMP = ("--elevation-deg", "0", "--max-extinction", "1")


@pytest.fixture
def photographs(tmp_path: Path) -> Path:
    """Three pictures of 5 x 6 pixels of noise, which take long to solve for."""
    folder = tmp_path / "photographs"
    folder.mkdir()
    noise = np.random.default_rng(0).integers(60, 250, (3, 6, 5, 3), np.uint8)
    for index, picture in enumerate(noise):
        Image.fromarray(picture).save(folder / f"{index}.png")
    return folder


def options(*more: str) -> list[str]:
    return ["--shape", "6,8,7", "--picture-width", "0.7", "--hold-deg", "0", "--iterations", str(PASSES), *more]


def process(*arguments: object) -> list[str]:
    return [sys.executable, "-c", PROGRAM, *map(str, arguments)]


def in_two_units(run: Any, photographs: Path, out: Path) -> list[str]:
    """The options of a job that is split because its memory does not suffice."""
    told = json.loads(run("solve", photographs, "-o", out, *options(*LEVEL_LAMP), "--dry-run", "--json").out)
    assert told["units"] == 1
    return options(*LEVEL_LAMP, "--memory", str(told["memory"] - 1))


@pytest.mark.parametrize("split", [False, True])
def test_killed_anywhere_the_same_command_comes_to_the_same_cube(  # type: ignore[no-untyped-def]
    run, photographs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, split: bool
) -> None:
    """SIGKILL, twice, at whatever moment after the work has begun; and one Ctrl-C."""
    for name, value in SMALL.items():
        monkeypatch.setattr(name, value)
    straight, out = tmp_path / "straight.zarr", tmp_path / "a.zarr"
    said = in_two_units(run, photographs, straight) if split else options()
    assert run("solve", photographs, "-o", straight, *said).code == 0
    command = process("solve", photographs, "-o", out, *said, "--json")
    events, moments = [], np.random.default_rng()
    for how in (signal.SIGKILL, signal.SIGKILL, signal.SIGINT):
        kept = [file for file in partial_path(out).glob("*.npz") if file.name != "targets.npz"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
            assert running.stdout is not None
            events.append(json.loads(running.stdout.readline())["event"])
            # where something was kept it goes on from there, unless all its pieces were finished
            assert events[-1] in ({"resumed", "result"} if kept else {"progress"})
            time.sleep(moments.uniform(0, 1 if INTERPRETED else 0.3))
            running.send_signal(how)
            _, err = running.communicate(timeout=120)
        if out.exists():  # it was quicker
            break
        assert running.returncode == (130 if how == signal.SIGINT else -how), err
    if not out.exists():
        assert run("solve", photographs, "-o", out, *said).code == 0
    assert content_of(out) == content_of(straight)
    assert not partial_path(out).exists()


def content_of(cube: Path) -> dict[str, bytes]:
    return {str(path.relative_to(cube)): data for path, data in content(cube).items()}


@pytest.mark.parametrize("verb", ["solve", "publish"])
@pytest.mark.parametrize("mine", [True, False])
def test_killed_before_it_was_tidied_the_same_command_tidies(  # type: ignore[no-untyped-def]
    run, photographs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, verb: str, *, mine: bool
) -> None:
    """The cube has its name by then. Another cube of that name stays, and so does what was solved."""
    out = tmp_path / "a.zarr"
    solve = ("solve", photographs, "-o", out, *options())
    again = solve if verb == "solve" else ("publish", partial_path(out))

    def killed(_: Any) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(publishing, "discard_partial", killed)
        assert run(*solve).code == 130
    assert partial_path(out).exists()
    if not mine:
        save(ANOTHER, out, overwrite=True)
    before, number = content_of(out), (out / "zarr.json").stat().st_ino
    said = run(*again)
    assert said.code == (0 if mine else 2), said.err
    assert content_of(out) == before
    assert (out / "zarr.json").stat().st_ino == number
    assert partial_path(out).exists() is not mine
    assert mine or "exists already" in said.err
    if not mine:
        assert run(*again, "--overwrite").code == 0
        assert content_of(out) != before


def test_killed_while_it_was_tidied_nothing_stays_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = job()
    begun(tmp_path / "a.zarr", made, *made.pieces)

    def killed(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(shutil, "rmtree", killed)
        with pytest.raises(KeyboardInterrupt):
            discard_partial(tmp_path / "a.zarr")
    assert not partial_path(tmp_path / "a.zarr").exists()
    assert len(files_in(tmp_path)) == 1
    save(ANOTHER, tmp_path / "b.zarr")
    assert [found.name for found in tmp_path.iterdir()] == ["b.zarr"]


def test_units_of_several_programs_published_are_the_run_in_one(run, photographs: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    out, one = tmp_path / "a.zarr", tmp_path / "one.zarr"
    said = options(*LEVEL_LAMP, "--iterations", "9")
    assert run("solve", photographs, "-o", out, *said, "--unit", "2/2").code == 0
    assert not out.exists()
    other = run("solve", photographs, "-o", out, *said, "--unit", "1/3")
    assert other.code == 2
    assert "units was 2 and is 3" in other.err
    told = json.loads(run("solve", photographs, "-o", out, *said, "--dry-run", "--json").out)
    assert told["units"] == 2  # as the folder was begun
    assert run("solve", photographs, "-o", out, *said, "--unit", "1/2").code == 0
    published = run("publish", f"{out}.partial")
    assert published.code == 0, published.err
    assert f"{out} is whole\n" in published.out
    assert not partial_path(out).exists()
    made = load(out)
    assert made.scores["psnr_mean"] > 0
    assert made.status == "complete"
    assert made.provenance["units"] == 2
    told = json.loads(run("solve", photographs, "-o", one, *said, "--dry-run", "--json").out)
    assert told["units"] == 1
    assert run("solve", photographs, "-o", one, *said, "--memory", told["memory"] - 1).code == 0
    assert_same(load(one), made)


def test_ctrl_c_says_how_to_go_on_and_what_is_there_can_be_published(  # type: ignore[no-untyped-def]
    run, photographs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "a.npz"
    said = options("--iterations", "9")
    with monkeypatch.context() as patched:
        patched.setattr("lightcube.scoring.metrics.mean_psnr", pressed)
        stopped = run("solve", photographs, "-o", out, *said)
    assert stopped.code == 130
    assert "the same command goes on" in stopped.err
    partial = partial_path(out)
    with pytest.warns(UnfinishedCube, match="still being made"):
        reached = load(partial)
    assert reached.status == "interrupted"
    assert 0 < reached.provenance["iterations"] < 9
    assert np.any(reached.extinction > 0)
    again = run("solve", photographs, "-o", out, *said)
    assert again.code == 0
    assert f"going on from 0 of 1 unit, pass {reached.provenance['iterations']} of 9" in again.err
    assert run("solve", photographs, "-o", tmp_path / "b.npz", *said).code == 0
    assert_same(load(out), load(tmp_path / "b.npz"))


def test_what_changed_is_named_and_nothing_is_lost(run, photographs: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    out = tmp_path / "a.zarr"
    said = options("--iterations", "2")
    assert run("solve", photographs, "-o", out, *said, "--unit", "1/2").code == 0
    before = content(partial_path(out))
    for change, sentence in (
        (("--iterations", "3"), "passes was 2 and is 3"),
        (("--lamp-max", "4"), "largest lamp power was"),
    ):
        refused = run("solve", photographs, "-o", out, *said, *change, "--unit", "1/2")
        assert refused.code == 2
        assert sentence in refused.err
        assert "--overwrite" in refused.err
    Image.new("RGB", (5, 6), (9, 99, 199)).save(photographs / "1.png")
    assert "the pictures differ" in run("solve", photographs, "-o", out, *said, "--unit", "1/2").err
    assert content(partial_path(out)) == before
    assert run("solve", photographs, "-o", out, *said, "--overwrite").code == 0
    assert load(out).status == "complete"
    assert not partial_path(out).exists()


def test_a_dry_run_says_what_it_takes_and_writes_nothing(run, photographs: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    before = content(tmp_path)
    told = run("solve", photographs, "-o", tmp_path / "a.zarr", *options(), "--dry-run", "--verbose")
    assert told.code == 0
    assert f"at most {PASSES} passes" in told.out
    facts = json.loads(run("solve", photographs, "-o", tmp_path / "a.zarr", *options(), "--dry-run", "--json").out)
    assert facts["memory"] > needs.PROGRAM
    assert facts["units"] == 1
    assert facts["seconds"] > 0
    assert content(tmp_path) == before


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        (("--memory", "1MB"), "GB of memory at least"),
        (("--memory", "lots"), "such as 2GB"),
        (("--memory", "-1GB"), "such as 2GB"),
        (("--unit", "3/2"), "--unit 3/2"),
        (("--unit", "1"), "--unit 1"),
        (("--unit", "1/9"), "1 to 3 units"),
        (("--unit", "1/2", "--memory", "1GB"), "leave one of them out"),
    ],
)
def test_memory_and_units_that_cannot_be(  # type: ignore[no-untyped-def]
    run, photographs: Path, tmp_path: Path, more: tuple[str, ...], sentence: str
) -> None:
    before = content(tmp_path)
    refused = run("solve", photographs, "-o", tmp_path / "a.zarr", *options(), *more)
    assert refused.code == 2
    assert sentence in refused.err
    assert content(tmp_path) == before


def begun(out: Path, made: Job, *pieces: str) -> DiskStore:
    store = open_partial(out, made)
    for name in pieces:
        assert solve_piece(made, name, store)
    return store


@pytest.mark.parametrize(
    "options",
    [
        {},
        RAISED,
        LEVEL,
        {**LEVEL, "method": "sirt", "max_extinction": 2.0},
        {**LEVEL, "material": DYED},
        {"material": CLEAR},
        {**LEVEL, "material": CLEAR},
    ],
    ids=str,
)
def test_a_job_comes_back_from_the_disk(options: dict[str, Any], tmp_path: Path) -> None:
    """All that a program elsewhere needs is in the folder."""
    made = job(**options, enough_db=60.0, provenance={"fit": "pad"})
    begun(tmp_path / "a.zarr", made)
    partial = partial_path(tmp_path / "a.zarr")
    again = load_job(partial)
    assert fingerprint(again) == fingerprint(made)
    assert again.provenance == made.provenance
    store = DiskStore(partial)
    for name in again.pieces:
        assert solve_piece(again, name, store)
    assert same(merged(again, store), solved(made))
    assert_same(merged(load_job(partial), store).cube, solved(made).cube)


def test_a_job_of_tall_slices_comes_back_and_is_no_other(tmp_path: Path) -> None:
    usual = job(**RAISED)
    tall = replace(usual, grid=replace(usual.grid, tall=0.5))
    begun(tmp_path / "a.zarr", tall)
    assert load_job(partial_path(tmp_path / "a.zarr")).grid == tall.grid
    with pytest.raises(InputError, match="voxel side"):
        open_partial(tmp_path / "a.zarr", usual)


def test_publishing_what_is_there(tmp_path: Path) -> None:
    made = job(**LEVEL)
    out = tmp_path / "a.zarr"
    begun(out, made, "level-1", "unit-1")
    assert not publish(partial_path(out)).is_whole
    whole = solved(made).cube
    with pytest.warns(UnfinishedCube):
        cube = load(out)
    assert cube.status == "interrupted"
    part = made.parts[1].slices
    assert np.array_equal(cube.extinction[:, part], whole.extinction[:, part])
    assert np.array_equal(cube.powers, whole.powers)
    assert cube.extinction.min(axis=(2, 3)).shape == cube.extinction.max(axis=(2, 3)).shape
    assert np.all(cube.extinction.max(axis=(0, 2, 3)) > 0)
    store = open_partial(out, made)
    assert store.names() == {"level-1", "unit-1"}  # so that its solving can go on
    for name in made.pieces:
        assert solve_piece(made, name, store)
    assert_same(replace(publishing.finish(made, store, out, overwrite=True).solution.cube, scores={}), whole)
    assert not partial_path(out).exists()
    begun(tmp_path / "b.zarr", made, *made.pieces)
    publish(partial_path(tmp_path / "b.zarr"))
    assert_same(replace(load(tmp_path / "b.zarr"), scores={}), whole)


def test_what_others_finish_while_it_is_published_is_not_lost(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made, out = job(**LEVEL), tmp_path / "a.zarr"
    store = begun(out, made, *made.pieces[:-1])

    def slow(*arguments: Any) -> Any:
        reached = merged(*arguments)
        assert solve_piece(made, made.pieces[-1], store)  # by another program, after the pieces were read
        return reached

    monkeypatch.setattr(publishing, "merged", slow)
    assert not publish(partial_path(out)).is_whole
    assert store.names() == set(made.pieces)


def test_two_programs_at_the_same_unit_do_no_harm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lightcube.backward.pieces.FIRST_CHECKPOINT_S", 0.0)
    monkeypatch.setattr("lightcube.backward.pieces.CHECKPOINT_S", 0.0)
    made = job(**LEVEL, lamp_power=1.0)
    out = tmp_path / "a.zarr"
    second = open_partial(out, made)
    turns = 0

    def other(step: Any) -> None:
        """Now and then the other program does some passes of the same unit, and is killed."""
        nonlocal turns
        turns += 1
        if turns % 5 == 0:
            solve_piece(made, "unit-0", second, lambda step: step.iteration > turns)

    first = DiskStore(partial_path(out))
    assert solve_piece(made, "unit-0", first, other)
    second.finish("unit-0", {**(second.finished("unit-0") or {})})
    for name in made.unit_names:
        assert solve_piece(made, name, first)
    assert same(merged(made, first), solved(made))


def test_writers_at_the_same_time_leave_one_whole_file(tmp_path: Path) -> None:
    store = begun(tmp_path / "a.zarr", job())

    def write(value: float) -> None:
        for _ in range(9):
            store.keep("unit-0", {"x": np.full(999, value)})

    writers = [threading.Thread(target=write, args=(value,)) for value in (1.0, 2.0)]
    for writer in writers:
        writer.start()
    while any(writer.is_alive() for writer in writers):
        found = store.state("unit-0")
        assert found is None or len(np.unique(found["x"])) == 1
    assert files_in(Path(store.folder)) == ["job.json", "targets.npz", "unit-0.state.npz"]


@pytest.mark.parametrize("name", ["unit-0.npz", "unit-0.state.npz", "targets.npz", "job.json"])
@pytest.mark.parametrize("harm", ["cut", "flip", "empty", "text"])
def test_damage_is_one_sentence(tmp_path: Path, name: str, harm: str) -> None:
    made = job(**RAISED)
    store = begun(tmp_path / "a.zarr", made, "level-1", "unit-0")
    store.keep("unit-0", store.finished("unit-0") or {})
    file = Path(store.folder) / name
    data = bytearray(file.read_bytes())
    middle = len(data) // 2
    if name.startswith("unit"):
        numbers = (store.finished("unit-0") or {})["extinction"].tobytes()
        middle = data.find(numbers) + len(numbers) // 2
    data[middle] ^= 255
    spoilt = {"cut": bytes(data[:middle]), "flip": bytes(data), "empty": b"", "text": b"dear diary"}
    file.write_bytes(spoilt[harm])

    def read() -> object:
        if name == "unit-0.state.npz":
            return DiskStore(store.folder).state("unit-0")
        return publish(store.folder)

    with pytest.raises(InputError, match=r"is damaged|begun by another version") as refused:
        read()
    assert name in str(refused.value)
    assert Path(store.folder).is_dir()


def test_pieces_of_another_job_are_refused(tmp_path: Path) -> None:
    one = begun(tmp_path / "a.zarr", job(), "unit-0")
    other = begun(tmp_path / "b.zarr", job(hold_deg=1.0))
    (Path(one.folder) / "unit-0.npz").rename(Path(other.folder) / "unit-0.npz")
    with pytest.raises(InputError, match="belongs to another cube"):
        merged(job(hold_deg=1.0), other)


def test_another_version_refuses_to_go_on_but_publishes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = job()
    begun(tmp_path / "a.zarr", made, "unit-0")
    for module in ("lightcube.backward.job", "lightcube.jobs.partial"):
        monkeypatch.setattr(f"{module}.version", lambda _: "9.9")
    with pytest.raises(InputError, match=r"lightcube was .* and is 9\.9"):
        open_partial(tmp_path / "a.zarr", made)
    assert load(publish(partial_path(tmp_path / "a.zarr")).path).status == "complete"


def test_old_leftovers_are_removed_and_fresh_ones_are_not(tmp_path: Path) -> None:
    store = begun(tmp_path / "a.zarr", job())
    old, fresh = (Path(store.folder) / f".unit-0.npz-{digit * 32}" for digit in "ab")
    for leftover in (old, fresh):
        leftover.write_bytes(b"half")
    os.utime(old, (0, 0))
    open_partial(tmp_path / "a.zarr", job())
    assert files_in(Path(store.folder)) == [fresh.name, "job.json", "targets.npz"]


@pytest.mark.parametrize("at", range(7))
def test_a_kill_between_any_two_files_loses_nothing(tmp_path: Path, at: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The disk refuses, once, at each of the renames: what has a name is whole, and the work goes on from there."""
    made, out = job(**RAISED), tmp_path / "a.zarr"
    real, calls = Path.replace, 0

    def refused(self: Path, target: Path) -> Path:
        nonlocal calls
        calls += 1
        if calls == at + 1:
            raise KeyboardInterrupt
        return real(self, target)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", refused)
        try:
            solved(made, open_partial(out, made))
        except KeyboardInterrupt:
            assert calls == at + 1
    assert same(solved(made, open_partial(out, made)), solved(made))


def test_a_full_disk_keeps_the_state_before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = begun(tmp_path / "a.zarr", job(), "unit-0")
    before = content(Path(store.folder))

    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(InputError, match="no space"):
        store.keep("unit-0", {"x": np.ones(3)})
    assert content(Path(store.folder)) == before
    with pytest.raises(InputError, match="no space"):
        open_partial(tmp_path / "b.zarr", job(hold_deg=1.0))
