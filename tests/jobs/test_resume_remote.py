"""Work on a cube at a URL: solved, interrupted, continued, published there, as on the disk."""

import json
from pathlib import Path

import numpy as np
import pytest

from lightcube import io
from lightcube.backward.job import fingerprint
from lightcube.backward.pieces import solve_piece
from lightcube.backward.solution import merged
from lightcube.backward.solving import solve_job as solved
from lightcube.errors import InputError
from lightcube.jobs.partial import DiskStore, begun_units, check_partial, load_job, open_partial
from lightcube.jobs.publishing import publish
from lightcube.jobs.reading import UnfinishedCube, load
from tests.backward.test_job import LEVEL, job, same
from tests.cli.test_cli import pressed, run
from tests.io.test_cubes import assert_same
from tests.io.test_places import bucket, files_at, put, remote, s3

__all__ = ["bucket", "remote", "run", "s3"]

SMALL = ("--shape", "6,8,7", "--picture-width", "0.7", "--hold-deg", "0", "--iterations", "5")


def test_solve_from_a_url_to_a_url(run, remote: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:  # type: ignore[no-untyped-def]
    pictures = np.random.default_rng(0).uniform(0.1, 1, (3, 6, 5, 3)).astype(np.float32)
    photographs, out = io.save(pictures, f"{remote}/photographs"), f"{remote}/a.zarr"
    with monkeypatch.context() as patched:
        patched.setattr("lightcube.scoring.metrics.mean_psnr", pressed)
        stopped = run("solve", photographs, "-o", out, *SMALL)
    assert stopped.code == 130, stopped.err
    assert f"lightcube publish {out}.partial" in stopped.err
    assert set(files_at(f"{out}.partial")) == {"targets.npz", "job.json", "unit-0.state.npz"}
    with pytest.warns(UnfinishedCube):
        assert load(f"{out}.partial").status == "interrupted"
    changed = run("solve", photographs, "-o", out, *SMALL, "--lamp-max", "4")
    assert changed.code == 2
    assert "largest lamp power was" in changed.err
    again = run("solve", photographs, "-o", out, *SMALL)
    assert again.code == 0, again.err
    assert "going on from 0 of 1 unit, pass 1 of 5" in again.err
    assert not files_at(f"{out}.partial")
    assert run("solve", photographs, "-o", tmp_path / "a.zarr", *SMALL).code == 0
    assert_same(load(out), load(tmp_path / "a.zarr"))
    scored = run("score", out, photographs, "--sheet", f"{remote}/sheet.png", "--json")
    assert scored.code == 0, scored.err
    assert json.loads(scored.out)["psnr_mean"] > 0
    assert run("score", out, "--sheet", f"{remote}/a.png", "--plot", f"{remote}/a.png").code == 2
    assert run("play", out, "-o", f"{remote}/a.gif", "--count", 3).code == 0
    assert {"sheet.png", "a.gif"} <= set(files_at(remote))


def test_units_are_published_at_a_url(run, remote: str) -> None:  # type: ignore[no-untyped-def]
    made, out = job(**LEVEL, passes=2), f"{remote}/a.npz"
    store = open_partial(out, made)
    assert store.is_empty()
    assert fingerprint(load_job(store.folder)) == fingerprint(made)
    for name in reversed(made.pieces[1:]):
        assert solve_piece(made, made.pieces[0], open_partial(out, made))
        assert solve_piece(made, name, open_partial(out, made))
    assert store.names() == set(made.pieces)
    whole = solved(made)
    assert same(merged(made, store), whole)
    assert run("publish", f"{out}.partial").code == 0
    np.testing.assert_array_equal(load(out).extinction, whole.cube.extinction)
    assert not files_at(f"{out}.partial")


def test_what_is_there_is_published_or_replaced(remote: str) -> None:
    out, made = f"{remote}/a.zarr", job(**LEVEL, passes=2)
    with pytest.raises(InputError, match="there is no unfinished cube"):
        publish(f"{out}.partial")
    store = open_partial(out, made)
    with pytest.raises(InputError, match="has nothing of a cube in it yet"):
        publish(f"{out}.partial")
    assert solve_piece(made, made.pieces[0], store)
    assert publish(f"{out}.partial").path == out
    with pytest.warns(UnfinishedCube):
        assert load(out).status == "interrupted"
    assert solve_piece(made, made.pieces[0], open_partial(out, made))
    other = job(**{**LEVEL, "units": 2}, passes=2)
    with pytest.raises(InputError, match="units was 3 and is 2"):
        open_partial(out, other)
    assert begun_units(out, other) == 3
    assert begun_units(out, job()) is None
    assert open_partial(out, other, overwrite=True).is_empty()


def test_spoilt_files_and_strange_folders_are_named(remote: str) -> None:
    out, made = f"{remote}/a.zarr", job()
    store = open_partial(out, made)
    store.keep("unit-0", {"x": np.ones(3)})
    put(f"{out}.partial/unit-0.state.npz", files_at(f"{out}.partial")["unit-0.state.npz"][:-9])
    with pytest.raises(InputError, match=r"a\.zarr\.partial/unit-0\.state\.npz is damaged"):
        DiskStore(store.folder).state("unit-0")
    put(f"{out}.partial/thesis.tex", b"years of work")
    with pytest.raises(InputError, match="stands where the unfinished cube would"):
        check_partial(out)


def test_a_finished_piece_is_seen_by_others_at_once(s3: str) -> None:
    made = job()
    store = open_partial(f"{s3}/a.zarr", made)
    assert not store.names()
    elsewhere = pytest.importorskip("s3fs").S3FileSystem(skip_instance_cache=True)
    elsewhere.pipe_file(f"{store.folder}/unit-0.npz", b"of another program")
    assert store.names() == {"unit-0"}
