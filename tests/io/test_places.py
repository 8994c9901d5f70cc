"""Pictures and cubes at URLs: what was sent comes back, and what is not whole is not read."""

import io
import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from uuid import uuid4

import numpy as np
import pytest
from PIL import Image

from lightcube.errors import InputError
from lightcube.io import (
    DoubtfulFolder,
    Output,
    TransparentPictures,
    _places,
    read_pictures,
    save,
)
from lightcube.io._places import place
from lightcube.jobs.reading import load
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.optics.transfer import from_levels, to_uint8

fsspec = pytest.importorskip("fsspec", reason="URLs need the extra remote")

RANDOM = np.random.default_rng(23)
LEVELS = RANDOM.integers(0, 256, (4, 5, 7, 3), dtype=np.uint8)
VIEWS = turntable(Grid((5, 7, 7)), np.arange(4) * 31.7 + 350, elevation_deg=20).views
SUFFIXES = (".zarr", ".zarr.zip", ".npz")


def make(shape: tuple[int, int, int] = (3, 5, 7)) -> Cube:
    random = np.random.default_rng(22)
    extinction = random.random((3, *shape), dtype=np.float32)
    targets = random.integers(0, 65536, (4, *VIEWS.picture_shape, 4), dtype=np.uint16)
    return Cube(extinction, Grid(shape, 0.3), Rig.of(VIEWS), random.random((4, 3)) + 0.1, targets)


def assert_same(one: Cube, other: Cube) -> None:
    assert one.names == other.names
    assert one.targets is not None
    assert other.targets is not None
    for a, b in ((one.extinction, other.extinction), (one.powers, other.powers), (one.targets, other.targets)):
        np.testing.assert_array_equal(a, b)


class Disk(fsspec.get_filesystem_class("file")):  # type: ignore[misc]
    """A store with real folders, in which a file is seen while it is written."""

    protocol = "disk"


@pytest.fixture(scope="module")
def bucket() -> Iterator[str]:
    """URL of a bucket on an S3 server on this machine."""
    s3fs = pytest.importorskip("s3fs", reason="S3 needs the extra remote")
    moto = pytest.importorskip("moto.server", reason="the S3 server of the tests is moto")
    server = moto.ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    host, port = server.get_host_and_port()
    settings = {
        "AWS_ENDPOINT_URL": f"http://{host}:{port}",
        "AWS_ACCESS_KEY_ID": "test",
        "AWS_SECRET_ACCESS_KEY": "test",
        "AWS_DEFAULT_REGION": "us-east-1",
        "AWS_EC2_METADATA_DISABLED": "true",
    }
    with pytest.MonkeyPatch.context() as patch:
        for name in [name for name in os.environ if name.startswith("AWS_")]:
            patch.delenv(name)
        for name, value in settings.items():
            patch.setenv(name, value)
        s3fs.S3FileSystem.clear_instance_cache()
        name = f"lightcube-{uuid4().hex}"  # all servers of a process share their buckets
        s3fs.S3FileSystem().mkdir(name)
        yield f"s3://{name}"
        s3fs.S3FileSystem.clear_instance_cache()
    server.stop()


@pytest.fixture
def s3(bucket: str) -> str:
    """URL of a place in the bucket where nothing is."""
    return f"{bucket}/{uuid4().hex}/some"


def empty_place(kind: str, request: pytest.FixtureRequest, tmp_path: Path) -> str:
    if kind == "s3":
        return str(request.getfixturevalue("s3"))
    if kind == "memory":
        return f"memory://{uuid4().hex}/some"
    if kind == "disk":
        fsspec.register_implementation("disk", Disk, clobber=True)
        return f"disk://{tmp_path}/some"
    (tmp_path / "some").mkdir()
    return f"file://{tmp_path}/some"


@pytest.fixture(params=["file", "memory", "disk", "s3"])
def folder(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """URL of a place that is empty."""
    return empty_place(request.param, request, tmp_path)


@pytest.fixture(params=["memory", "disk", "s3"])
def remote(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """URL of a place that is empty and no path."""
    return empty_place(request.param, request, tmp_path)


def store_of(url: str) -> tuple[Any, str]:
    store, path = fsspec.url_to_fs(url)
    store.invalidate_cache()
    return store, path


def put(url: str, data: bytes) -> None:
    """Put a file there as others do."""
    store, path = store_of(url)
    if url.startswith("disk:"):
        store.makedirs(path.rsplit("/", 1)[0], exist_ok=True)
    store.pipe_file(path, data)


def files_at(url: str) -> dict[str, bytes]:
    """All files below a URL by their relative name."""
    store, path = store_of(url)
    return {name.removeprefix(path.rstrip("/") + "/"): store.cat_file(name) for name in store.find(path)}


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_cubes_come_back_bit_for_bit(folder: str, suffix: str) -> None:
    url = f"{folder}/a{suffix}"
    Output(url, "cube").check()
    assert save(make(), url) == url
    assert_same(load(url), make())
    assert_same(load(url + "/"), make())
    assert {name.split("/")[0] for name in files_at(folder)} == {f"a{suffix}"}
    for refused in (lambda: save(make((5, 3, 7)), url), Output(url, "cube").check):
        with pytest.raises(InputError, match=rf"a{suffix} exists already.*--overwrite"):
            refused()
    assert_same(load(url), make())
    Output(url, "cube", overwrite=True).check()
    save(make((5, 3, 7)), url, overwrite=True)
    assert_same(load(url), make((5, 3, 7)))


@pytest.mark.parametrize("suffix", ["", ".webm", ".apng"])
def test_pictures_come_back(folder: str, suffix: str) -> None:
    url = f"{folder}/a{suffix}"
    Output(url, "pictures").check()
    names = ("b", "a", "ü [1]", "c") if not suffix else None
    assert save(from_levels(LEVELS), url, views=None if suffix else VIEWS, names=names) == url
    read = read_pictures(url)
    np.testing.assert_array_equal(np.stack([to_uint8(image) for image in read.images]), LEVELS)
    if not suffix:
        assert read.names == names
        np.testing.assert_array_equal(read.angles_deg, VIEWS.angles_deg)
    with pytest.raises(InputError, match="exists already"):
        save(from_levels(LEVELS), url)
    save(from_levels(LEVELS[:2, :3]), url, overwrite=True)
    assert [image.shape for image in read_pictures(url).images] == [(3, 7, 3)] * 2
    assert len(files_at(url) if not suffix else files_at(folder)) == (2 if not suffix else 1)


def test_only_pictures_are_fetched_of_a_folder(remote: str, monkeypatch: pytest.MonkeyPatch) -> None:
    save(from_levels(LEVELS), f"{remote}/a", views=VIEWS)
    for name in ("notes.txt", "[x].raw", "deep/0.png", ".hidden.png"):
        put(f"{remote}/a/{name}", b"x")
    sizes: dict[str, int] = {}
    real = _places._fetch

    def fetch(store: Any, url: str, path: str, copy: Path, wanted: Any) -> None:
        real(store, url, path, copy, wanted)
        sizes.update({item.name: item.stat().st_size for item in copy.iterdir()})

    monkeypatch.setattr(_places, "_fetch", fetch)
    with pytest.warns(DoubtfulFolder, match=rf"^{re.escape(remote)}/a: [23] of what is there .* \[x\]\.raw"):
        assert len(read_pictures(f"{remote}/a")) == 4
    assert sizes.pop("notes.txt") == sizes.pop("[x].raw") == sizes.pop(".hidden.png") == 0
    assert len(sizes) == 5
    assert all(sizes.values())
    put(f"{remote}/b/notes.txt", b"x")
    with pytest.raises(InputError, match=rf"^there are no pictures in the folder {re.escape(remote)}/b"):
        read_pictures(f"{remote}/b")


@pytest.mark.parametrize(
    ("remote", "suffix"),
    [(kind, suffix) for kind in ("memory", "disk") for suffix in (".zarr", ".npz", "")]
    + [("s3", ".zarr"), ("s3", ".npz")],
    indirect=["remote"],
)
def test_an_interrupted_upload_is_never_taken_for_whole(
    remote: str, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Cut the line before each step that changes the store: what is found then is old, new, or refused."""
    url = f"{remote}/a{suffix}"

    def write(number: int, overwrite: bool = True) -> None:
        if suffix:
            save(make(((3, 5, 7), (5, 3, 7))[number]), url, overwrite=overwrite)
        else:
            save(from_levels(LEVELS[: 4 - number]), url, overwrite=overwrite)

    def found() -> str:
        try:
            if suffix:
                cube = load(url)
                assert_same(cube, make(cube.grid.shape))
                return "old" if cube.grid.shape == (3, 5, 7) else "new"
            return {4: "old", 3: "new"}[len(read_pictures(url))]
        except InputError as error:
            return "unfinished" if f"{url} is unfinished" in str(error) else str(error)

    seen = set()
    for allowed in (0, 7, 100) if remote.startswith("s3") else range(100):  # S3 is slow, even here
        write(0)
        with monkeypatch.context() as patch:
            finished = cut_after(allowed, store_of(url)[0], patch, lambda: write(1))
        seen.add(found())
        if finished:
            break
        if found() == "unfinished":
            store, path = store_of(url)
            if "zarr.json" in files_at(url):  # others take it for whole, so it is
                store.rm_file(f"{path}/{_places.UNFINISHED}")
                assert found() in ("old", "new")
                store.pipe_file(f"{path}/{_places.UNFINISHED}", b"")
            Output(url, "cube" if suffix else "pictures").check()
            write(0, overwrite=False)
    assert finished
    assert {"new"} < seen <= ({"old", "new"} if suffix == ".npz" else {"old", "unfinished", "new"})
    assert found() == "new"


def cut_after(allowed: int, store: Any, patch: pytest.MonkeyPatch, work: Any) -> bool:
    """Whether `work` comes to its end before the line is cut, after so many steps."""
    steps = 0

    def step() -> None:
        nonlocal steps
        steps += 1
        if steps > allowed:
            raise ConnectionError("the line is cut")

    def counted(name: str, real: Any) -> Any:
        def plain(*args: Any, **keys: Any) -> Any:
            step()
            return real(*args, **keys)

        async def awaited(*args: Any, **keys: Any) -> Any:
            step()
            return await real(*args, **keys)

        return awaited if name == "_put_file" else plain

    for name in ("pipe_file", "put_file", "_put_file", "rm_file", "mv"):
        if hasattr(store, name):
            patch.setattr(store, name, counted(name, getattr(store, name)))
    try:
        work()
    except InputError as error:
        assert "the line is cut" in str(error)  # noqa: PT017 - only one of two ways
        return False
    return True


def test_what_changes_while_it_is_read_is_refused(remote: str, monkeypatch: pytest.MonkeyPatch) -> None:
    url = f"{remote}/a.zarr"
    save(make(), url)
    real = _places._transfer

    def transfer(store: Any, verb: str, *names: Any) -> None:
        if verb == "get":
            monkeypatch.undo() if not url.startswith("s3") else monkeypatch.setattr(_places, "_transfer", real)
            save(make((5, 3, 7)), url, overwrite=True)
        real(store, verb, *names)

    monkeypatch.setattr(_places, "_transfer", transfer)
    with pytest.raises(InputError, match=rf"{re.escape(url)} (changed while|failed)"):
        load(url)


def test_what_is_not_there_is_refused_by_its_url(remote: str) -> None:
    for suffix in SUFFIXES:
        with pytest.raises(InputError, match=rf"^there is no {re.escape(remote)}/a{suffix}: give the file"):
            load(f"{remote}/a{suffix}")
    with pytest.raises(InputError, match=rf"^there is no {re.escape(remote)}/photos: give a folder"):
        read_pictures(f"{remote}/photos")
    put(f"{remote}/a.zarr", b"x")
    with pytest.raises(InputError, match=rf"^{re.escape(remote)}/a\.zarr is a file"):
        load(f"{remote}/a.zarr")
    put(f"{remote}/b.zarr/zarr.json", b"x")
    with pytest.raises(InputError, match=rf"{re.escape(remote)}/b\.zarr is a damaged"):
        load(f"{remote}/b.zarr")
    with pytest.raises(InputError, match="of something else"):
        save(make(), f"{remote}/b.zarr", overwrite=True)


def test_a_bucket_that_is_not_there_is_not_made(s3: str) -> None:
    with pytest.raises(InputError, match=r"^there is no s3://nowhere-at-all/a\.zarr"):
        load("s3://nowhere-at-all/a.zarr")
    with pytest.raises(
        InputError, match=r"^writing s3://nowhere-at-all/a\.zarr failed \(The specified bucket does not"
    ):
        save(make(), "s3://nowhere-at-all/a.zarr")
    assert not store_of(s3)[0].exists("nowhere-at-all")


def test_names_that_lead_out_of_the_folder_are_refused(s3: str, tmp_path: Path) -> None:
    save(make(), f"{s3}/a.zarr")
    put(f"{s3}/a.zarr/../../../../evil", b"x")
    with pytest.raises(InputError, match="leads out of the folder"):
        load(f"{s3}/a.zarr")


def test_single_pictures_and_documents(remote: str) -> None:
    sheet = Output(f"{remote}/a.png", "picture")
    sheet.check()
    sheet.write(LEVELS[0])
    assert save({"a": 1}, f"{remote}/a.json") == f"{remote}/a.json"
    assert set(files_at(remote)) == {"a.png", "a.json"}
    assert files_at(remote)["a.json"] == b'{\n  "a": 1\n}\n'
    with pytest.raises(InputError, match="exists already"):
        sheet.check()


def test_warnings_name_the_url(remote: str) -> None:
    for name in "ab":
        file = io.BytesIO()
        Image.new("RGBA", (7, 5), (1, 2, 3, 4)).save(file, "PNG")
        put(f"{remote}/see-through/{name}.png", file.getvalue())
    with pytest.warns(TransparentPictures, match=f"{re.escape(remote)}/see-through are"):
        read_pictures(f"{remote}/see-through")


def test_files_of_a_folder(folder: str) -> None:
    """What a store of unfinished work needs."""
    at = _places.place(folder)
    one = _places.child(at, "one [1].npz")
    assert _places.name_of(one) == "one [1].npz"
    assert _places.read_bytes(one) is None
    assert not _places.exists(one)
    assert _places.names_in(at) == []
    for data in (b"first", b"second"):
        with _places.written(one) as file:
            file.write(data)
        assert _places.read_bytes(one) == data
    with _places.written(_places.beside(one, "two")):
        pass
    with pytest.raises(ZeroDivisionError), _places.written(one) as file:
        file.write(1 // 0 * b"third")
    assert _places.read_bytes(one) == data
    assert _places.names_in(at) == ["one [1].npz", "two"]
    assert _places.is_folder(at)
    assert not _places.is_folder(one)
    _places.remove(one)
    _places.remove(one)
    assert _places.names_in(at) == ["two"]
    _places.remove(at)
    assert not _places.exists(at)
    assert _places.names_in(at) == []


@pytest.mark.parametrize(
    ("url", "said"),
    [
        ("nobody://x/a.zarr", r"nobody://x/a\.zarr cannot be reached, nobody knows nobody://"),
        ("s3://", "names no file and no folder"),
        ("file://a.zarr", "begin with three slashes, such as file:///tmp/a.zarr"),
        ("-", "^- is no name: nothing is read from a pipe or written to one"),
        ("s3://b/a.tar", r"s3://b/a\.tar has no suffix that a cube can have"),
    ],
)
def test_urls_that_cannot_be_right(url: str, said: str) -> None:
    for refused in (lambda: save(make(), url), lambda: load(url), Output(url, "cube").check):
        with pytest.raises(InputError, match=said):
            refused()


def test_a_missing_package_is_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(url: str) -> Any:
        raise ImportError("Install s3fs to access S3")

    with monkeypatch.context() as patch:
        patch.setattr(fsspec, "url_to_fs", missing)
        with pytest.raises(InputError, match=r"s3://b/a.zarr cannot.*Install s3fs.*pip install 'lightcube\[remote\]'$"):
            load("s3://b/a.zarr")
    monkeypatch.setitem(sys.modules, "fsspec", None)
    for url in ("s3://b/a.zarr", "memory://b/a.zarr"):
        with pytest.raises(InputError, match=rf"{url} is a URL, .*: pip install 'lightcube\[remote\]'$"):
            load(url)


def test_paths_are_no_urls(tmp_path: Path) -> None:
    for path in (r"C:\x\a.zarr", "C:/x/a.zarr", "c://x/a.zarr", "a.zarr", "a:b/c"):
        assert _places.place(path) == Path(path)
    assert _places.place("file:///tmp/a%20b.zarr") == Path("/tmp/a b.zarr")  # noqa: S108 - no file
    assert _places.place("S3://Bucket/a/") == "s3://Bucket/a"
    assert _places.name_of("https://host/a.npz?signed=a/b") == "a.npz"


@pytest.mark.parametrize("given", ["zip://a.npz::memory://x.zip", "simplecache::memory://a.npz", "a::b::s3://c/d.zarr"])
def test_chains_of_urls_are_told(given: str) -> None:
    with pytest.raises(InputError, match="is a chain of URLs"):
        place(given)
    assert place("a::b.zarr") == Path("a::b.zarr")
