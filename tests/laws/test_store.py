"""Laws that every store keeps: whole or nothing, twice does no harm, and nothing of another cube."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from uuid import uuid4

import numpy as np
import pytest

from lightcube.backward.store import MemoryStore, Store
from lightcube.errors import InputError
from lightcube.jobs.partial import DiskStore, open_partial, partial_path
from tests.backward.test_job import LEVEL, job

ONE, OTHER = ({"x": np.full((3, 5), number), "of": np.array(f"{number:g}")} for number in (1.0, 2.0))


def in_memory(folder: Path) -> Store:
    return MemoryStore()


def on_disk(folder: Path) -> Store:
    return open_partial(folder / "a.zarr", job(**LEVEL))


def at_a_url(folder: Path) -> Store:
    return open_partial(f"memory://{uuid4().hex}/a.zarr", job(**LEVEL))


STORES = [in_memory, on_disk, at_a_url]


@pytest.fixture(params=STORES, ids=lambda make: make.__name__)
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Store:
    return request.param(tmp_path)


def same(found: Mapping[str, Any] | None, wanted: Mapping[str, Any]) -> bool:
    return (
        found is not None and found.keys() == wanted.keys() and all(np.array_equal(found[k], wanted[k]) for k in wanted)
    )


def test_what_was_never_there_is_not(store: Store) -> None:
    assert store.names() == frozenset()
    assert store.finished("unit-0") is None
    assert store.state("unit-0") is None


def test_what_is_kept_comes_back_in_place_of_what_was_before(store: Store) -> None:
    for arrays in (ONE, OTHER, OTHER):
        store.keep("unit-0", arrays)
        assert same(store.state("unit-0"), arrays)
    assert store.names() == frozenset()
    assert store.finished("unit-0") is None
    assert store.state("unit-1") is None


def test_a_checkpoint_does_not_change_with_the_arrays_it_was_made_of(store: Store) -> None:
    arrays = {name: array.copy() for name, array in ONE.items()}
    store.keep("unit-0", arrays)
    arrays["x"][:] = 9
    assert same(store.state("unit-0"), ONE)


def test_what_is_finished_has_no_checkpoint_and_twice_does_no_harm(store: Store) -> None:
    store.keep("unit-1", ONE)
    store.keep("unit-0", ONE)
    for _ in range(2):
        store.finish("unit-0", OTHER)
        assert store.names() == {"unit-0"}
        assert same(store.finished("unit-0"), OTHER)
        assert store.state("unit-0") is None
    assert same(store.state("unit-1"), ONE)
    store.finish("level-1", ONE)
    assert store.names() == {"unit-0", "level-1"}


class Breaking(Mapping[str, Any]):
    """Arrays that cannot be had to the end, as where memory or the disk is full."""

    def __getitem__(self, name: str) -> Any:
        if name == "of":
            raise OSError(28, "No space left on device")
        return OTHER[name]

    def __iter__(self) -> Iterator[str]:
        return iter(OTHER)

    def __len__(self) -> int:
        return len(OTHER)


def test_what_breaks_on_the_way_leaves_all_as_it_was(store: Store) -> None:
    store.keep("unit-0", ONE)
    store.finish("unit-1", ONE)
    for write in (store.keep, store.finish):
        for name in ("unit-0", "unit-1", "unit-2"):
            with pytest.raises((OSError, InputError), match=r"[Ss]pace"):
                write(name, Breaking())
    assert store.names() == {"unit-1"}
    assert same(store.finished("unit-1"), ONE)
    assert same(store.state("unit-0"), ONE)
    assert store.state("unit-2") is None


def test_nothing_of_another_cube_is_taken(tmp_path: Path) -> None:
    """Of a store that outlives its program: a file that was brought from elsewhere."""
    mine, others = (
        open_partial(tmp_path / name, job(**LEVEL, passes=passes)) for name, passes in (("a.zarr", 3), ("b.zarr", 4))
    )
    others.finish("unit-0", ONE)
    others.keep("unit-1", ONE)
    for name in ("unit-0.npz", "unit-1.state.npz"):
        data = (Path(str(partial_path(tmp_path / "b.zarr"))) / name).read_bytes()
        (Path(str(partial_path(tmp_path / "a.zarr"))) / name).write_bytes(data)
    with pytest.raises(InputError, match="belongs to another cube"):
        mine.finished("unit-0")
    with pytest.raises(InputError, match="belongs to another cube"):
        DiskStore(mine.folder).state("unit-1")
