"""Unfinished and finished cubes in whose files somebody wrote: one sentence, or the cube that it would have been."""

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import lightcube as lc
from lightcube.backward.pieces import solve_piece
from lightcube.backward.solving import make_job, solve_job
from lightcube.backward.store import MemoryStore
from lightcube.errors import InputError
from lightcube.jobs.partial import load_job, open_partial
from tests.hostile.doors import LEAVES, changed_leaf, leaves

Array = NDArray[Any]
GRID = lc.Grid((4, 5, 6))
TARGETS = lc.Targets(
    np.random.default_rng(0).random((3, 4, 4, 3)).astype(np.float32),
    lc.turntable(GRID, [0.0, 80.0, 200.0], elevation_deg=0, picture_shape=(4, 4)),
)
RECIPE = lc.Recipe(passes=4)


def tampered(array: Array) -> dict[str, Array | None]:
    """By what was done to it, an array that another one stands for; None where it is gone."""
    wide = array.astype(np.float64) if array.dtype.kind in "fiu" else np.zeros(2)
    first = wide.copy()
    first.flat[:1] = np.nan
    return {
        "gone": None,
        "not a number": first,
        "infinite": np.full_like(wide, np.inf),
        "negative": -1 - np.abs(wide),
        "longer": np.stack([array, array]),
        "empty": np.empty(0),
        "text": np.full(array.shape, "1"),
        "complex": wide.astype(complex),
        "truth": np.zeros(array.shape, bool),
        "dates": np.zeros(array.shape, "M8[s]"),
        "records": np.zeros(array.shape, [("a", "f4")]),
        "beyond": np.full(array.shape, 2**40),
    }


@pytest.fixture(scope="module")
def begun(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, bytes], Array]:
    """Files of a job of two pieces, the first finished and the second stopped; and the voxels it comes to."""
    folder = tmp_path_factory.mktemp("begun")
    job = make_job(TARGETS, GRID, RECIPE, units=2)
    store = open_partial(folder / "a.zarr", job)
    for name in ("level-1", "unit-0"):
        solve_piece(job, name, store)
    solve_piece(job, "unit-1", store, lambda step: step.iteration == 2)
    files = {item.name: item.read_bytes() for item in (folder / "a.zarr.partial").iterdir()}
    assert {"level-1.npz", "unit-0.npz", "unit-1.state.npz", "job.json", "targets.npz"} == set(files)
    return files, solve_job(load_job(folder / "a.zarr.partial"), store).cube.extinction


def laid(folder: Path, files: dict[str, bytes]) -> Path:
    partial = folder / "a.zarr.partial"
    partial.mkdir(parents=True)
    for name, data in files.items():
        (partial / name).write_bytes(data)
    return partial


def comes_to_nothing_else(partial: Path, voxels: Array) -> str:
    """Go on, and publish: what is said, where that is a sentence."""
    said = ""
    try:
        job = load_job(partial)
        solve_job(job, open_partial(partial.with_suffix(""), job))
        lc.publish(partial)
        assert np.array_equal(lc.load(partial.with_suffix("")).extinction, voxels)
    except InputError as error:
        said = str(error)
        assert said.isprintable(), said
        assert partial.exists()
        assert not partial.with_suffix("").exists()
    return said


@pytest.mark.parametrize("name", ["level-1.npz", "unit-0.npz", "unit-1.state.npz", "targets.npz"])
def test_arrays_that_somebody_changed(name: str, begun: tuple[dict[str, bytes], Array], tmp_path: Path) -> None:
    files, voxels = begun
    honest = laid(tmp_path / "honest", files)
    with np.load(honest / name) as arrays:
        given = dict(arrays)
    assert not comes_to_nothing_else(honest, voxels)
    refused = total = 0
    for key, array in given.items():
        for what, other in tampered(array).items():
            partial = laid(tmp_path / f"{key}-{what}", files)
            kept = {**given, key: other} if other is not None else {k: v for k, v in given.items() if k != key}
            np.savez(partial / name, **kept)
            said = comes_to_nothing_else(partial, voxels)
            assert not said or name.removesuffix(".npz") in said or "state to continue from" in said, (key, what, said)
            refused, total = refused + bool(said), total + 1
    assert refused > total / 2


@pytest.mark.parametrize("name", ["level-1", "unit-0", "unit-1.state"])
def test_stores_that_hand_out_what_is_not_the_jobs(name: str, begun: tuple[dict[str, bytes], Array]) -> None:
    """Whatever keeps the pieces: what is not as the job says is never put into a cube."""
    job = make_job(TARGETS, GRID, RECIPE, units=2)
    with np.load(io.BytesIO(begun[0][f"{name}.npz"])) as arrays:
        given = {key: array for key, array in arrays.items() if key != "job-key"}
    refused = total = 0
    for key, array in given.items():
        for other in tampered(array).values():
            store = MemoryStore()
            kept = {**given, key: other} if other is not None else {k: v for k, v in given.items() if k != key}
            (store.keep if "state" in name else store.finish)(name.removesuffix(".state"), kept)
            total += 1
            try:
                cube = solve_job(job, store).cube
            except InputError:
                refused += 1
            else:
                assert np.all(np.isfinite(cube.extinction))
    assert refused > total / 2


def test_files_that_somebody_changed(begun: tuple[dict[str, bytes], Array], tmp_path: Path) -> None:
    files, voxels = begun
    one, two = files["unit-0.npz"], files["unit-1.state.npz"]
    changes: dict[str, dict[str, bytes]] = {
        "cut": {"unit-0.npz": one[: len(one) // 2]},
        "empty": {"unit-0.npz": b""},
        "swapped": {"unit-1.npz": one, "unit-0.npz": one},
        "state for result": {"unit-1.npz": two},
        "result for state": {"unit-1.state.npz": one},
        "unit for level": {"level-1.npz": one},
        "a job's for a piece": {"unit-0.npz": files["targets.npz"]},
        "text": {"unit-0.npz": b"no archive"},
    }
    for what, change in changes.items():
        said = comes_to_nothing_else(laid(tmp_path / what, {**files, **change}), voxels)
        assert said or what == "unit for level", what
    partial = laid(tmp_path / "linked", {**files, "unit-0.npz": b""})
    (partial / "unit-0.npz").unlink()
    (partial / "unit-0.npz").symlink_to("/dev/zero")
    assert "pipe, a device or a socket" in comes_to_nothing_else(partial, voxels)
    partial = laid(tmp_path / "other", {**files, "thesis.tex": b"years of work"})
    assert "and is none" in comes_to_nothing_else(partial, voxels)
    assert (partial / "thesis.tex").exists()


@pytest.mark.parametrize("number", range(len(LEAVES)))
def test_a_job_that_somebody_changed(number: int, begun: tuple[dict[str, bytes], Array], tmp_path: Path) -> None:
    files, voxels = begun
    document = json.loads(files["job.json"])
    for at, path in enumerate(leaves(document)):
        change = json.dumps(changed_leaf(document, path, LEAVES[number])).encode()
        partial = laid(tmp_path / str(at), {**files, "job.json": change})
        comes_to_nothing_else(partial, voxels)
