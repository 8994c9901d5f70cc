"""Saving and loading cubes: bit-exact round trips, whole files or none, and damaged ones refused."""

import asyncio
import json
import shutil
import threading
import zipfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as st_numpy
from zarr.codecs import BloscCodec, GzipCodec

from lightcube.backward.job import Job
from lightcube.backward.pieces import solve_piece
from lightcube.backward.recipe import Recipe
from lightcube.backward.solution import merged
from lightcube.errors import InputError
from lightcube.io import HollowCube, _zarr, save
from lightcube.jobs import partial
from lightcube.jobs.partial import DiskStore, discard_partial, open_partial
from lightcube.jobs.publishing import publish
from lightcube.jobs.reading import UnfinishedCube, load
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.pictures.targets import Targets
from lightcube.scoring import metrics

SUFFIXES = (".zarr", ".zarr.zip", ".npz")
MANY = settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def make(shape: tuple[int, int, int] = (3, 5, 7), count: int = 2, channels: int = 3, **more: Any) -> Cube:
    random = np.random.default_rng(22)
    grid = Grid(shape, 0.3)
    rig = turntable(grid, np.arange(count) * 31.7 + 0.1, elevation_deg=20, picture_shape=(3, 5))
    return Cube(
        random.random((channels, *shape), dtype=np.float32),
        grid,
        rig,
        random.random((count, channels)) + 1e-3,
        random.integers(0, 65536, (count, 3, 5, channels + 1), dtype=np.uint16),
        scores={"psnr_mean": 0.1 + 0.2, "pictures": [{"psnr": 1e-300}, {"psnr": None}]},
        provenance={"method": "display", "iterations": 7, "ok": True, "name": "ü\n"},
        **more,
    )


def assert_same(one: Any, other: Any) -> None:
    """Every field, bit for bit."""
    assert type(one) is type(other)
    if isinstance(one, np.ndarray):
        assert one.dtype == other.dtype
        assert one.shape == other.shape
        assert one.tobytes() == other.tobytes()
    elif is_dataclass(one):
        for item in fields(one):
            assert_same(getattr(one, item.name), getattr(other, item.name))
    else:
        assert one == other


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_slices_that_are_taller_than_wide_come_back(tmp_path: Path, suffix: str) -> None:
    cube = make()
    cube = replace(cube, grid=Grid(cube.grid.shape, 0.3, 1 / 3))
    save(cube, tmp_path / f"a{suffix}")
    assert_same(load(tmp_path / f"a{suffix}"), cube)
    if suffix == ".zarr":
        ome = json.loads((tmp_path / "a.zarr" / "zarr.json").read_text())["attributes"]["ome"]
        (made,) = ome["multiscales"][0]["datasets"][0]["coordinateTransformations"]
        assert made["scale"] == pytest.approx([1.0, 0.1, 0.3, 0.3])


def partial_path(out: Path) -> Path:
    """As `lightcube.jobs.partial.partial_path`, of a path."""
    return Path(partial.partial_path(out))


def files_in(folder: Path) -> list[str]:
    return sorted(item.name for item in folder.iterdir())


def content(path: Path) -> dict[Path, bytes]:
    return {file: file.read_bytes() for file in path.rglob("*") if file.is_file()}


finite = st.floats(allow_nan=False, allow_infinity=False)
plain_json = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**60), 2**60) | finite | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)


@st.composite
def cubes(draw: st.DrawFn) -> Cube:
    shape = draw(st.tuples(*[st.integers(1, 5)] * 3))
    count, channels = draw(st.integers(1, 3)), draw(st.integers(1, 4))
    picture = draw(st.tuples(st.integers(1, 4), st.integers(1, 4)))
    grid = Grid(shape, draw(st.floats(1e-6, 1e6)))
    angles_deg = draw(st.lists(st.floats(0, 359), min_size=count, max_size=count))
    flat = turntable(grid, angles_deg, elevation_deg=draw(st.floats(-80, 80)))
    reach_mm = 1e8 * grid.voxel_mm
    origins_mm = draw(st_numpy.arrays(np.float64, (count, 3), elements=st.floats(-reach_mm, reach_mm)))
    targets = st_numpy.arrays(np.uint16, (count, *picture, channels + 1))
    names = st.lists(st.text(st.characters(codec="utf-8"), max_size=4), min_size=count, max_size=count)
    return Cube(
        draw(st_numpy.arrays(np.float32, (channels, *shape), elements=st.floats(0, 2.0**100, width=32))),
        grid,
        Rig.of(replace(flat.views, origins_mm=origins_mm, picture_shape=picture)),
        draw(st_numpy.arrays(np.float64, (count, channels), elements=st.floats(1e-300, 1e300))),
        draw(st.none() | targets),
        tuple(draw(names)),
        draw(st.sampled_from(["srgb", "linear"])),
        draw(st.dictionaries(st.text(max_size=5), plain_json, max_size=3)),
        draw(st.dictionaries(st.text(max_size=5), plain_json, max_size=3)),
        "complete",
        draw(st.floats(0, 180)),
    )


@pytest.mark.parametrize("suffix", SUFFIXES)
@MANY
@given(cube=cubes())
def test_all_fields_come_back_bit_for_bit(tmp_path: Path, suffix: str, cube: Cube) -> None:
    path = tmp_path / f"cube{suffix}"
    assert save(cube, path, overwrite=True) == path
    assert_same(load(path), cube)
    assert files_in(tmp_path) == [path.name]


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_values_that_json_does_not_know_become_plain(tmp_path: Path, suffix: str) -> None:
    said: dict[Any, Any] = {
        "a": np.float32(0.1),
        "b": np.arange(3),
        "c": (1, 2),
        "d": np.nan,
        "e": [np.inf],
        7: Path("x"),
        "f": None,
    }
    cube = replace(make(), scores=said)
    save(cube, tmp_path / f"a{suffix}")
    wanted = {"a": float(np.float32(0.1)), "b": [0, 1, 2], "c": [1, 2], "d": None, "e": [None], "7": "x", "f": None}
    assert load(tmp_path / f"a{suffix}").scores == wanted


@pytest.mark.parametrize("suffix", ["", ".zip"])
def test_several_slabs_come_back(tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_zarr, "_CHUNK_BYTES", 4 * 3 * 35 * 2)
    cube = make((7, 5, 7))
    save(cube, tmp_path / f"a.zarr{suffix}")
    assert_same(load(tmp_path / f"a.zarr{suffix}"), cube)
    if not suffix:
        array = zarr.open_array(tmp_path / "a.zarr", path="0", mode="r")
        assert array.chunks == (3, 2, 5, 7)
        assert array.shards is None


def test_the_folder_is_an_ome_zarr_image(tmp_path: Path) -> None:
    save(make(), tmp_path / "a.zarr")
    group = json.loads((tmp_path / "a.zarr" / "zarr.json").read_text())
    image = json.loads((tmp_path / "a.zarr" / "0" / "zarr.json").read_text())
    assert group["zarr_format"] == image["zarr_format"] == 3
    assert image["shape"] == [3, 3, 5, 7]
    assert image["dimension_names"] == ["c", "z", "y", "x"]
    ome = group["attributes"]["ome"]
    assert ome["version"] == "0.5"
    (scales,) = ome["multiscales"]
    assert [axis["name"] for axis in scales["axes"]] == ["c", "z", "y", "x"]
    assert [axis["type"] for axis in scales["axes"]] == ["channel", "space", "space", "space"]
    assert [axis.get("unit") for axis in scales["axes"]] == [None, "millimeter", "millimeter", "millimeter"]
    (dataset,) = scales["datasets"]
    assert dataset == {
        "path": "0",
        "coordinateTransformations": [{"type": "scale", "scale": [1.0, 0.3, 0.3, 0.3]}],
    }
    colours = [channel["color"] for channel in ome["omero"]["channels"]]
    assert colours == ["FF0000", "00FF00", "0000FF"]
    assert all(set(channel["window"]) == {"min", "max", "start", "end"} for channel in ome["omero"]["channels"])
    assert zarr.open_array(tmp_path / "a.zarr", path="targets", mode="r").dtype == np.uint16


def test_a_display_shows_most_of_a_cube(tmp_path: Path) -> None:
    """A few voxels that are as dark as can be do not make all others black, and an empty cube has a window too."""
    made = make()
    for factor in (0.0, 1.0):
        extinction = factor * made.extinction
        extinction[0, 0, 0, 0] = 100 * factor
        save(replace(made, extinction=extinction), tmp_path / f"{factor}.zarr")
        ome = json.loads((tmp_path / f"{factor}.zarr" / "zarr.json").read_text())["attributes"]["ome"]
        for channel in ome["omero"]["channels"]:
            window = channel["window"]
            assert window["max"] == (100 if factor else 1)
            assert 0 == window["min"] == window["start"] < window["end"] <= window["max"]
            assert window["end"] <= 1


@pytest.mark.parametrize("suffix", [".zarr", ".zarr.zip"])
@pytest.mark.parametrize(
    "packed",
    [
        {"chunks": (1, 1, 2, 3)},
        {"chunks": (3, 3, 5, 7), "compressors": None},
        {"chunks": (2, 2, 2, 2), "compressors": BloscCodec(cname="lz4")},
        {"chunks": (1, 3, 5, 7), "compressors": GzipCodec(level=1)},
        {"chunks": (3, 1, 5, 7), "dtype": np.float64},
        {"chunks": (3, 1, 1, 1), "dtype": ">f4"},
    ],
)
@pytest.mark.filterwarnings("ignore:.* parts of array '0'")
def test_what_other_programs_packed_anew_is_read(tmp_path: Path, packed: dict[str, Any], suffix: str) -> None:
    """Chunks of nothing but zeros are left out by most."""
    made = make()
    extinction = made.extinction.copy()
    extinction[:, 1:] = 0
    made = replace(made, extinction=extinction)
    save(made, tmp_path / "a.zarr")
    shutil.rmtree(tmp_path / "a.zarr" / "0")
    array = zarr.create_array(tmp_path / "a.zarr", name="0", shape=extinction.shape, **{"dtype": np.float32, **packed})
    array[...] = extinction
    if suffix == ".zarr.zip":
        shutil.make_archive(str(tmp_path / "a.zarr"), "zip", tmp_path / "a.zarr")
    assert_same(load(tmp_path / f"a{suffix}"), made)


def test_the_archive_begins_with_the_metadata_and_is_not_packed_twice(tmp_path: Path) -> None:
    save(make(), tmp_path / "a.zarr.zip")
    with zipfile.ZipFile(tmp_path / "a.zarr.zip") as archive:
        assert archive.namelist()[0] == "zarr.json"
        assert {item.compress_type for item in archive.infolist()} == {zipfile.ZIP_STORED}


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_no_thread_stays_behind_and_event_loops_are_no_hindrance(tmp_path: Path, suffix: str) -> None:
    before = threading.active_count()

    async def in_a_notebook() -> Cube:
        save(make(), tmp_path / f"a{suffix}")
        return load(tmp_path / f"a{suffix}")

    with ThreadPoolExecutor(1) as thread:  # of its own: a browser of other tests keeps a loop in this one
        assert_same(thread.submit(asyncio.run, in_a_notebook()).result(), make())
    assert threading.active_count() == before


@pytest.mark.parametrize("name", ["a", "a.zip", "a.tar", ".zarr", "a.zarr.gz"])
def test_unknown_suffixes_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=r"use one of \.zarr, \.zarr\.zip, \.npz"):
        load(tmp_path / name)


def test_suffixes_are_known_in_any_case(tmp_path: Path) -> None:
    for name in ("a.ZARR", "a.Zarr.Zip", "a.NPZ"):
        save(make(), tmp_path / name)
        assert_same(load(tmp_path / name), make())
    assert files_in(tmp_path) == ["a.NPZ", "a.ZARR", "a.Zarr.Zip"]


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_is_not_there_or_of_another_kind_is_refused(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"a{suffix}"
    with pytest.raises(InputError, match="there is no"):
        load(path)
    with pytest.raises(InputError, match="File name too long"):
        load(tmp_path / ("x" * 300 + suffix))
    if suffix == ".zarr":
        path.write_bytes(b"x")
    else:
        path.mkdir()
    with pytest.raises(InputError, match=r"is a (folder|file)"):
        load(path)


def change(path: Path, edit: Any) -> None:
    """Change the metadata of a saved cube by ``edit(document)``; `edit` returning None keeps what it changed."""
    if path.suffix == ".zarr":
        file = path / "zarr.json"
        group = json.loads(file.read_text())
        group["attributes"]["lightcube"] = edit(group["attributes"]["lightcube"])
        file.write_text(json.dumps(group))
    elif path.suffix == ".zip":
        folder = path.with_name("unpacked.zarr")
        with zipfile.ZipFile(path) as archive:
            archive.extractall(folder)
        change(folder, edit)
        _zarr.zip_folder(folder, path)
        shutil.rmtree(folder)
    else:
        with np.load(path) as arrays:
            parts = dict(arrays)
        parts["lightcube"] = np.array(json.dumps(edit(json.loads(str(parts["lightcube"])))))
        np.savez(path, **parts)


def put(*keys: str | int, value: Any) -> Any:
    """Edit that sets one key, deep down."""

    def edit(document: Any) -> Any:
        inner = document
        for key in keys[:-1]:
            inner = inner[key]
        inner[keys[-1]] = value
        return document

    return edit


def with_method(data: bytes, method: int) -> bytes:
    """A zip file whose entries claim to be compressed in another way: local headers, and the directory's."""
    changed = bytearray(data)
    for head, at in ((b"PK\x03\x04", 8), (b"PK\x01\x02", 10)):
        place = data.find(head)
        while place >= 0:
            changed[place + at : place + at + 2] = method.to_bytes(2, "little")
            place = data.find(head, place + 1)
    return bytes(changed)


@pytest.mark.parametrize(
    "damaged",
    [
        lambda data: with_method(data, 8),
        lambda data: with_method(data, 12),
        lambda data: with_method(data, 14),
        lambda data: with_method(data, 99),
        lambda data: data.replace(b"), }", b"),  ", 1),
    ],
    ids=["deflate", "bzip2", "lzma", "no such way", "a header that does not end"],
)
def test_whatever_a_damaged_archive_raises_is_one_sentence(tmp_path: Path, damaged: Any) -> None:
    path = save(make(), tmp_path / "a.npz")
    path.write_bytes(damaged(path.read_bytes()))
    with pytest.raises(InputError, match="is a damaged light cube"):
        load(path)


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("found", [6, 10**9])
def test_a_newer_format_is_refused(tmp_path: Path, suffix: str, found: int) -> None:
    path = save(make(), tmp_path / f"a{suffix}")
    change(path, lambda document: {"format_version": found, "something": "else"})
    with pytest.raises(InputError, match=f"in format {found} of a newer lightcube.*update"):
        load(path)


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("found", [0, -1])
def test_a_format_that_never_was_is_refused(tmp_path: Path, suffix: str, found: int) -> None:
    path = save(make(), tmp_path / f"a{suffix}")
    change(path, lambda document: {"format_version": found, "something": "else"})
    with pytest.raises(InputError, match=f"in format {found}, which no lightcube wrote"):
        load(path)


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("document", [None, 3, [], {}, "text"])
def test_a_file_without_our_metadata_is_no_cube(tmp_path: Path, suffix: str, document: Any) -> None:
    path = save(make(), tmp_path / f"a{suffix}")
    change(path, lambda _: document)
    with pytest.raises(InputError, match="is no light cube"):
        load(path)


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (put("format_version", value="1"), "format_version"),
        (put("format_version", value=True), "format_version"),
        (put("format_version", value=4.0), "format_version"),
        (put("voxel_mm", value=0), "voxel_mm"),
        (put("voxel_mm", value=float("nan")), "voxel_mm"),
        (put("rig", "views", "lamps", 1, 2, value=float("inf")), r"rig\.views\.lamps\.1\.2"),
        (put("rig", "views", "lamps", 1, value=[0, 0, 0, 0]), "lamps of view 2 is 0"),
        (put("rig", "views", "lamps", 1, 0, value=1e308), r"lamps of view 2 is 1e\+308"),
        (put("rig", "views", "origins_mm", 1, 0, value=1e17), "the picture of view 2 reaches"),
        (put("rig", "views", "picture_shape", 0, value=10**30), "million|too large|picture_shape"),
        (put("rig", "stops", "window", 0, 0, value=10**30), "whole numbers"),
        (put("rig", "stops", "angle_deg", 0, value=1e308), "angle_deg"),
        (put("rig", "views", "lamps", 1, 3, value=0.5), "fourth number"),
        (put("rig", "views", "lamps", 1, value=[1.0]), r"views\.lamps\.1"),
        (put("rig", "views", "origins_mm", value=[]), "origins_mm"),
        (put("rig", "views", "row_steps_mm", 0, value=[0, 0, 0]), "row_steps_mm of view 1 is 0"),
        (put("rig", "views", "picture_shape", value=[3, 0]), r"picture_shape\.1"),
        (put("rig", "views", "picture_shape", value=[3, 6]), "targets"),
        (put("lamp_powers", 0, 0, value=0), r"lamp_powers\.0\.0"),
        (put("lamp_powers", 0, 0, value=-1), r"lamp_powers\.0\.0"),
        (put("lamp_powers", 0, 0, value="bright"), r"lamp_powers\.0\.0"),
        (put("lamp_powers", value=[[1.0, 1.0, 1.0]]), "lamp powers"),
        (put("lamp_powers", value=[[1.0, 1.0, 1.0], [1.0]]), "lamp_powers|inhomogeneous"),
        (put("names", value=["one"]), "with 1 name"),
        (put("transfer", value="gamma"), "transfer"),
        (put("status", value="done"), "status"),
        (put("more", value=1), "more"),
        (lambda document: {key: document[key] for key in document if key != "names"}, "names"),
    ],
)
def test_metadata_that_cannot_be_right_is_refused(tmp_path: Path, suffix: str, edit: Any, message: str) -> None:
    path = save(make(), tmp_path / f"a{suffix}")
    change(path, edit)
    with pytest.raises(InputError, match=f"damaged light cube.*({message})") as caught:
        load(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def poke(path: Path, name: str, values: Any) -> None:
    """Replace an array of a saved cube."""
    if path.suffix == ".npz":
        with np.load(path) as arrays:
            parts = dict(arrays)
        parts[{"0": "extinction"}.get(name, name)] = values
        np.savez(path, **parts)
    else:
        shutil.rmtree(path / name)
        (zarr.open_group(path, mode="r+")).create_array(name, data=values)


@pytest.mark.parametrize("suffix", [".zarr", ".npz"])
@pytest.mark.parametrize(
    ("name", "values", "message"),
    [
        ("0", np.full((3, 3, 5, 7), np.nan, np.float32), "non-finite"),
        ("0", np.full((3, 3, 5, 7), -1, np.float32), "negative"),
        ("0", np.ones((3, 3, 5, 7), np.int32), "float32"),
        ("0", np.ones((3, 3, 5, 7), np.float16), "float32"),
        ("0", np.full((3, 3, 5, 7), 1e300), "non-finite"),
        ("targets", np.full((2, 3, 5, 4), 65536, np.int32), "uint16"),
        ("targets", np.ones((2, 3, 5, 4), np.float64), "uint16"),
        ("0", np.ones((3, 5, 7), np.float32), "3 axes|4 axes"),
        ("0", np.ones((2, 3, 5, 7), np.float32), "lamp powers"),
        ("targets", np.zeros((2, 3, 5, 3), np.uint16), "targets"),
        ("targets", np.zeros((2, 3, 5, 4), np.uint8), "targets"),
    ],
)
def test_arrays_that_cannot_be_right_are_refused(
    tmp_path: Path, suffix: str, name: str, values: Any, message: str
) -> None:
    path = save(make(), tmp_path / f"a{suffix}")
    poke(path, name, values)
    with pytest.raises(InputError, match=f"damaged light cube.*({message})"):
        load(path)


@pytest.mark.parametrize("suffix", [".zarr", ".npz"])
@pytest.mark.parametrize(("floats", "levels"), [(np.float64, np.int64), (">f4", ">u2"), (">f8", np.uint32)])
def test_arrays_that_others_rewrote_in_wider_types_are_read(
    tmp_path: Path, suffix: str, floats: Any, levels: Any
) -> None:
    cube = make()
    path = save(cube, tmp_path / f"a{suffix}")
    assert cube.targets is not None
    poke(path, "0", cube.extinction.astype(floats))
    poke(path, "targets", cube.targets.astype(levels))
    assert_same(load(path), cube)


def packed(folder: Path, file: Path, prefix: str, *beside: str) -> Path:
    """A zip archive of a folder under a prefix, made as people's programs make it."""
    with zipfile.ZipFile(file, "a", zipfile.ZIP_DEFLATED) as archive:
        for each in sorted(folder.rglob("*")):
            archive.write(each, prefix + each.relative_to(folder).as_posix())
        for name in beside:
            archive.writestr(name, b"")
    return file


@pytest.mark.parametrize(
    ("prefix", "beside"),
    [
        ("", []),
        ("cube.zarr/", []),
        ("a b/c.zarr/", [".DS_Store"]),
        ("ü.zarr/", ["__MACOSX/ü.zarr/._zarr.json", "__MACOSX/zarr.json"]),
        ("cube.zarr/", ["Thumbs.db", "notes.txt"]),
        ("./cube.zarr/", []),
    ],
)
def test_a_zip_archive_may_hold_the_folder_itself(tmp_path: Path, prefix: str, beside: list[str]) -> None:
    cube = make()
    file = packed(save(cube, tmp_path / "a.zarr"), tmp_path / "b.ZARR.zip", prefix, *beside)
    assert_same(load(file), cube)


def test_a_zip_archive_holds_one_cube(tmp_path: Path) -> None:
    folder = save(make(), tmp_path / "a.zarr")
    two = packed(folder, packed(folder, tmp_path / "two.zarr.zip", "a/"), "b/")
    with pytest.raises(InputError, match=r"two\.zarr\.zip holds 2 Zarr groups: give a zip archive of one cube"):
        load(two)
    with zipfile.ZipFile(tmp_path / "none.zarr.zip", "w") as archive:
        archive.writestr("a.txt", b"")
    with pytest.raises(InputError, match=r"none\.zarr\.zip holds no Zarr group"):
        load(tmp_path / "none.zarr.zip")


def test_missing_parts_of_a_folder_are_noticed(tmp_path: Path) -> None:
    whole = save(make(), tmp_path / "whole.zarr")
    for lost in ("0", "0/zarr.json", "0/c", "0/c/0/0/0/0", "targets/c/0/0/0/0"):
        path = tmp_path / "a.zarr"
        shutil.copytree(whole, path)
        shutil.rmtree(path / lost) if (path / lost).is_dir() else (path / lost).unlink()
        with pytest.raises(InputError, match="damaged light cube"):
            load(path)
        shutil.rmtree(path)
    shutil.copytree(whole, tmp_path / "b.zarr")
    (tmp_path / "b.zarr" / "zarr.json").unlink()
    with pytest.raises(InputError, match=r"no zarr\.json"):
        load(tmp_path / "b.zarr")


@pytest.mark.parametrize("suffix", [".zarr", ".zarr.zip"])
@pytest.mark.parametrize("name", ["0", "targets"])
def test_parts_that_are_not_there_of_a_cube_that_was_rewritten_are_told(
    name: str, suffix: str, tmp_path: Path, recwarn: pytest.WarningsRecorder
) -> None:
    """Other programs leave out what is zero, so it cannot be known whether they are lost."""
    cube = make()
    rewritten = save(cube, tmp_path / "a.zarr")
    group = zarr.open_group(rewritten, mode="a")
    values = np.array(cube.extinction if name == "0" else cube.targets)
    del group[name]
    group.create_array(name, data=values, chunks=(1, *values.shape[1:]), compressors=[GzipCodec()])

    def read() -> Cube:
        if suffix == ".zarr":
            return load(rewritten)
        (tmp_path / f"a{suffix}").unlink(missing_ok=True)
        return load(packed(rewritten, tmp_path / f"a{suffix}", ""))

    assert_same(read(), cube)
    assert not recwarn.list
    (rewritten / name / "c" / "1" / "0" / "0" / "0").unlink()
    with pytest.warns(
        HollowCube, match=rf"^1 of the {len(values)} parts of array '{name}' in .*a{suffix} are not there"
    ):
        found = read()
    empty = np.array(found.extinction if name == "0" else found.targets)
    assert not empty[1].any()
    np.testing.assert_array_equal(np.delete(empty, 1, 0), np.delete(values, 1, 0))


@pytest.mark.parametrize("suffix", [".zarr", ".zarr.zip", ".npz"])
@pytest.mark.parametrize("field", ["provenance", "names"])
def test_what_is_written_can_be_read_or_it_is_refused(field: str, suffix: str, tmp_path: Path) -> None:
    """However much a cube says beside its arrays: readers take no more than 20 MiB."""
    for size, is_read in ((19 << 20, True), (21 << 20, False)):
        text = "y" * size
        cube = replace(make(), provenance={"x": text}) if field == "provenance" else replace(make(), names=(text, "b"))
        if is_read:
            assert_same(load(save(cube, tmp_path / f"a{suffix}")), cube)
            continue
        with pytest.raises(InputError, match="a cube says at most 20 MiB beside its arrays, and this one more: "):
            save(cube, tmp_path / f"b{suffix}")
    assert [each.name for each in tmp_path.iterdir()] == [f"a{suffix}"]


def test_a_job_whose_cube_could_not_be_read_is_not_begun(tmp_path: Path) -> None:
    cube = make()
    pictures = np.full((2, 3, 5, 3), 0.5, np.float32)
    job = Job(Targets(pictures, cube.rig), cube.grid, Recipe(), provenance={"x": "y" * (15 << 20)})
    with pytest.raises(InputError, match="at most 20 MiB beside its arrays"):
        open_partial(tmp_path / "a.zarr", job)
    assert not list(tmp_path.iterdir())


def test_a_missing_array_of_an_archive_is_noticed(tmp_path: Path) -> None:
    path = save(make(), tmp_path / "a.npz")
    with np.load(path) as arrays:
        np.savez(path, lightcube=arrays["lightcube"])
    with pytest.raises(InputError, match="'extinction' is missing"):
        load(path)


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("letter", [0x110000, 0xFFFFFFFF, 0xFB000000])
def test_letters_that_do_not_exist_are_refused(letter: int, order: str, tmp_path: Path) -> None:
    """NumPy hands out a text with them, which Python and what is written in Rust fall over."""
    path = save(make(), tmp_path / "a.npz")
    with np.load(path) as arrays:
        kept = dict(arrays)
    letters = np.array([kept["lightcube"]]).view(np.uint32)
    for at in (0, 20, len(letters) - 1):
        changed = letters.copy()
        changed[at] = letter
        said = changed.astype(f"{order}u4").view(f"{order}U{len(letters)}").reshape(())
        np.savez(path, **{**kept, "lightcube": said})
        with pytest.raises(InputError, match="letters that do not exist"):
            load(path)


@pytest.mark.parametrize("said", [np.array(5), np.array(b"{}"), np.array(["{}", "{}"]), np.array([], "U1")])
def test_what_a_cube_says_is_one_text(said: np.ndarray, tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    np.savez(path, extinction=make().extinction, lightcube=said)
    with pytest.raises(InputError, match="what it says is no text"):
        load(path)


@pytest.mark.parametrize("suffix", SUFFIXES)
@MANY
@given(data=st.data())
def test_cut_and_changed_bytes_are_refused_or_harmless(tmp_path: Path, suffix: str, data: st.DataObject) -> None:
    whole, path = tmp_path / f"whole{suffix}", tmp_path / f"a{suffix}"
    if not whole.exists():
        save(make(), whole)
        shutil.copytree(whole, path) if whole.is_dir() else shutil.copy(whole, path)
    files = sorted(file.relative_to(whole) for file in ([whole] if whole.is_file() else content(whole)))
    name = data.draw(st.sampled_from(files))
    before = (whole / name).read_bytes()
    if data.draw(st.booleans()):
        after = before[: data.draw(st.integers(0, len(before) - 1))]
    else:
        at = data.draw(st.integers(0, len(before) - 1))
        after = before[:at] + bytes([before[at] ^ data.draw(st.integers(1, 255))]) + before[at + 1 :]
    (path / name).write_bytes(after)
    try:
        cube = load(path)
    except InputError as error:
        assert str(path) in str(error)  # noqa: PT017 - any other exception fails the test
    else:
        # Checksums hold the arrays; a changed letter of the metadata can still be a sound cube.
        if cube.extinction.shape == make().extinction.shape:
            np.testing.assert_array_equal(cube.extinction, make().extinction)
    finally:
        (path / name).write_bytes(before)


@pytest.mark.parametrize("name", ["0/c/0/0/0/0", "targets/c/0/0/0/0"])
def test_a_changed_bit_of_an_array_is_noticed(tmp_path: Path, name: str) -> None:
    file = save(make(), tmp_path / "a.zarr") / name
    before = file.read_bytes()
    for at in range(len(before) // 3, len(before), 97):
        file.write_bytes(before[:at] + bytes([before[at] ^ 1]) + before[at + 1 :])
        with pytest.raises(InputError, match="damaged light cube"):
            load(tmp_path / "a.zarr")


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_an_interrupted_cube_loads_with_a_warning(tmp_path: Path, suffix: str) -> None:
    cube = make(status="interrupted")
    path = save(cube, tmp_path / f"a{suffix}")
    with pytest.warns(UnfinishedCube, match="stopped early") as caught:
        assert_same(load(path), cube)
    assert len(caught) == 1
    assert caught[0].filename == __file__


def begun(out: Path, *pieces: str) -> Job:
    """A partial folder with some pieces of a job in it."""
    rig = turntable(Grid((3, 5, 7)), [10.0, 80.0], picture_shape=(3, 5), power=1.0)
    targets = Targets(np.full((2, 3, 5, 3), 0.5, np.float32), rig)
    job = Job(targets, Grid((3, 5, 7)), Recipe(method="sirt", passes=2), units=2)
    store = open_partial(out, job)
    for name in pieces:
        solve_piece(job, name, store)
    return job


@pytest.mark.parametrize("suffix", SUFFIXES)
class TestPartial:
    def test_begin_load_publish(self, tmp_path: Path, suffix: str) -> None:
        out = tmp_path / f"a{suffix}"
        begun(out, "unit-0")
        assert files_in(tmp_path) == [f"a{suffix}.partial"]
        with pytest.warns(UnfinishedCube, match="still being made"):
            reached = load(partial_path(out))
        assert reached.status == "interrupted"
        made = publish(partial_path(out))
        assert (made.path, made.is_whole, made.done, made.units) == (out, False, 1, 2)
        assert files_in(tmp_path) == [out.name, f"{out.name}.partial"]
        with pytest.warns(UnfinishedCube, match="stopped early"):
            assert_same(load(out), reached)

    def test_a_finished_one_is_published_complete(self, tmp_path: Path, suffix: str) -> None:
        out = tmp_path / f"a{suffix}"
        job = begun(out, "unit-0", "unit-1")
        with pytest.warns(UnfinishedCube, match="still being made"):
            whole = load(partial_path(out))
        assert_same(whole, merged(job, DiskStore(partial_path(out))).cube)
        made = publish(partial_path(out))
        assert (made.path, made.is_whole) == (out, True)
        assert files_in(tmp_path) == [out.name]
        assert_same(load(out), replace(whole, scores=json.loads(json.dumps(metrics.score(whole, job.targets)))))

    def test_publish_overwrites_only_when_asked(self, tmp_path: Path, suffix: str) -> None:
        out = save(make((5, 3, 7)), tmp_path / f"a{suffix}")
        begun(out, "unit-0", "unit-1")
        with pytest.raises(InputError, match="exists already"):
            publish(partial_path(out))
        assert partial_path(out).is_dir()
        assert_same(load(out), make((5, 3, 7)))
        publish(partial_path(out), overwrite=True)
        assert load(out).grid.shape == (3, 5, 7)
        assert files_in(tmp_path) == [out.name]

    def test_discard(self, tmp_path: Path, suffix: str) -> None:
        out = tmp_path / f"a{suffix}"
        begun(out, "unit-0")
        discard_partial(out)
        assert files_in(tmp_path) == []

    def test_nothing_there_is_refused(self, tmp_path: Path, suffix: str) -> None:
        out = tmp_path / f"a{suffix}"
        for refused in (discard_partial, lambda path: publish(partial_path(path)), lambda p: load(partial_path(p))):
            with pytest.raises(InputError, match="no unfinished cube"):
                refused(out)
        for wrong in (save(make(), out), tmp_path / ".partial"):
            with pytest.raises(InputError, match=r"ends with \.partial"):
                publish(wrong)

    def test_an_empty_or_foreign_folder_is_refused(self, tmp_path: Path, suffix: str) -> None:
        out = tmp_path / f"a{suffix}"
        partial_path(out).mkdir()
        with pytest.raises(InputError, match="nothing of a cube"):
            publish(partial_path(out))
        begun(out)
        with pytest.raises(InputError, match="nothing of a cube"):
            publish(partial_path(out))
        (partial_path(out) / "thesis.tex").write_text("years of work")
        with pytest.raises(InputError, match="no unfinished cube"):
            discard_partial(out)
        with pytest.raises(InputError, match="is none"):
            begun(out)
        assert files_in(partial_path(out)) == ["job.json", "targets.npz", "thesis.tex"]


def test_pictures_given_as_a_cube_are_named_with_their_folder(tmp_path: Path) -> None:
    (tmp_path / "my photos").mkdir()
    path = save(np.zeros((2, 4, 6, 3), np.uint8), tmp_path / "my photos" / "a.mp4", fps=10, scale=2)
    with pytest.raises(InputError) as told:
        load(path)
    assert str(told.value).endswith(f"as in lightcube solve '{path}' -o cube.zarr")
