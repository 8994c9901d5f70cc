"""A cube as a Zarr group: an OME-Zarr 0.5 image with one more attribute.

Zarr's own coroutines run in an event loop that ends with each call, so that no thread is left behind.
"""

import asyncio
import concurrent.futures
import math
import warnings
import zipfile
from collections.abc import Callable, Coroutine, Iterable
from functools import partial
from pathlib import Path, PurePosixPath
from typing import Any, TypeVar

import numpy as np
import zarr
from numpy.typing import NDArray
from zarr.codecs import ZstdCodec
from zarr.storage import LocalStore, StorePath, ZipStore

from lightcube.errors import InputError
from lightcube.io import _metadata
from lightcube.io._archives import is_crowded
from lightcube.io._bounds import check_file, check_text, memory
from lightcube.io._files import system_errors
from lightcube.io._guarded import Guarded
from lightcube.optics.arrays import locked
from lightcube.optics.cube import Cube

Value = TypeVar("Value")
#: By an array's name: how many of its chunks are not there, of how many.
Missing = dict[str, tuple[int, int]]
Parts = tuple[object, NDArray[Any], NDArray[Any] | None]


class HollowCube(UserWarning):
    """Parts of a cube's arrays that another program wrote are not there: they may be empty, or lost."""


#: A chunk is as many whole slices as fit into this many bytes, at least one.
_CHUNK_BYTES = 8 << 20
#: Other programs make more of them, up to so many: each takes a while to find.
_MOST_CHUNKS = 100_000
_ROOT = "zarr.json"
_IMAGE, _TARGETS, _ATTRIBUTE = "0", "targets", "lightcube"
#: Where a display's white is, among the voxels that are not empty, in per cent: a twentieth of them or more are as dark
#: as the material can be, ten times as dark as most, and a display that ends there shows a cube as black.
_WHITE = 90
_COLOURS = (("red", "FF0000"), ("green", "00FF00"), ("blue", "0000FF"))


def write_zarr(folder: Path, cube: Cube) -> None:
    """Write `cube` as a new Zarr group, format 3, into `folder`, which does not exist yet."""
    run(lambda: _write(folder, cube))


def read_zarr(path: Path) -> Cube:
    """Read a cube from a Zarr folder."""
    if not (path / _ROOT).is_file():
        raise InputError(f"{path} is no light cube: there is no zarr.json in it, give a folder that lightcube wrote")
    return _cube(path, lambda missing: _read(path, LocalStore(path, read_only=True), partial(_size, path), missing))


def _size(folder: Path, key: str) -> int:
    """Bytes of a file in a folder, none where there is none."""
    member = check_file(folder / key)
    return member.stat().st_size if member.is_file() else 0


def guarded_folder(path: Path) -> Guarded:
    """A folder as a store that is not trusted."""
    return Guarded(LocalStore(path, read_only=True), partial(_size, path), partial(_metadata.damaged, path))


async def group_of(store: Guarded, inside: str = "") -> zarr.AsyncGroup:
    """The group in a store, or in a folder inside it."""
    return await zarr.AsyncGroup.open(await StorePath.open(store, inside, mode="r"), zarr_format=3)


async def new_group(folder: Path, attributes: dict[str, Any]) -> zarr.AsyncGroup:
    """A new group in a folder, which does not exist yet."""
    group = await zarr.AsyncGroup.from_store(LocalStore(folder), attributes=attributes, zarr_format=3)
    check_text((folder / _ROOT).stat().st_size)
    return group


def write_zarr_zip(file: Path, cube: Cube) -> None:
    """Write `cube` as a Zarr group in one zip archive, stored as it is: its chunks are compressed already."""
    folder = file.with_name(file.name + ".unzipped")
    write_zarr(folder, cube)
    zip_folder(folder, file)


def zip_folder(folder: Path, file: Path) -> None:
    """Put a Zarr folder into a zip archive, its root metadata first; the same folder gives the same archive."""
    members = sorted(member for member in folder.rglob("*") if member.is_file())
    members.sort(key=lambda member: (member.name != _ROOT, len(member.parts)))
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        for member in members:
            entry = zipfile.ZipInfo(member.relative_to(folder).as_posix())  # of no date
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, member.read_bytes())


def read_zarr_zip(path: Path) -> Cube:
    """Read a cube from a Zarr group in a zip archive, or from the one folder in it that holds such a group."""

    async def read(missing: Missing) -> Parts:
        with path.open("rb") as file:
            if is_crowded(file):
                raise _metadata.damaged(path, "it lists too many members")
            with zipfile.ZipFile(file) as archive:
                sizes = {member.filename: member.file_size for member in archive.infolist()}
        return await _read(path, ZipStore(path, mode="r"), lambda key: sizes.get(key, 0), missing, _inside(path, sizes))

    return _cube(path, read)


def _cube(path: Path, read: Callable[[Missing], Coroutine[Any, Any, Parts]]) -> Cube:
    """The cube of what `read` finds; of parts that are not there a note says so."""
    missing: Missing = {}
    cube = _metadata.from_json(path, *reading(path, lambda: read(missing)))
    for name, (absent, count) in missing.items():
        warnings.warn(
            f"{absent} of the {count} parts of array {name!r} in {path} are not there and were taken as empty, as the "
            "program that rewrote it may have left them out: get another copy if they were lost",
            HollowCube,
            stacklevel=2,
        )
    return cube


def _inside(path: Path, names: Iterable[str]) -> str:
    """The folder in a zip archive that is the Zarr group: none, or that which was packed as a whole.

    What systems pack beside it counts for nothing; `InputError` where there are two groups or none.
    """
    roots = [name.removesuffix(_ROOT) for name in names if PurePosixPath(name).name == _ROOT]
    roots = [root for root in roots if not root.startswith("__MACOSX/")]
    outer = [root for root in roots if not any(root != other and root.startswith(other) for other in roots)]
    if len(outer) != 1:
        held = f"{len(outer)} Zarr groups" if outer else "no Zarr group"
        raise InputError(f"{path} holds {held}: give a zip archive of one cube")
    return outer[0].rstrip("/")


async def _write(folder: Path, cube: Cube) -> None:
    """Write group, arrays and attributes."""
    channels, nz, ny, nx = cube.extinction.shape
    attributes = {"ome": _ome(cube), _ATTRIBUTE: _metadata.to_json(cube)}
    group = await new_group(folder, attributes)
    slab = max(1, min(nz, _CHUNK_BYTES // (4 * channels * ny * nx)))
    arrays: list[tuple[str, NDArray[Any], tuple[int, ...], list[str]]] = [
        (_IMAGE, cube.extinction, (channels, slab, ny, nx), ["c", "z", "y", "x"])
    ]
    if cube.targets is not None:
        view = max(1, min(len(cube.targets), _CHUNK_BYTES // cube.targets[0].size))
        axes = ["view", "row", "column", "channel"]
        arrays.append((_TARGETS, cube.targets, (view, *cube.targets.shape[1:]), axes))
    for name, values, chunks, axes in arrays:
        await put_array(group, name, values, chunks, axes)


async def put_array(
    group: zarr.AsyncGroup, name: str, values: NDArray[Any], chunks: tuple[int, ...], axes: list[str]
) -> None:
    """Write a new array of a group, its axes named."""
    array = await group.create_array(
        name,
        shape=values.shape,
        dtype=values.dtype,
        chunks=chunks,
        dimension_names=axes,
        compressors=ZstdCodec(level=3, checksum=True),
        fill_value=0,
        config={"write_empty_chunks": True},  # a chunk that is missing is then known to be lost
    )
    await array.setitem(..., values)


def _ome(cube: Cube) -> dict[str, Any]:
    """OME-Zarr 0.5 metadata of the image: axes, voxel size, and colours of the channels."""
    x_mm, y_mm, z_mm = cube.grid.sides_mm.tolist()
    channels = len(cube.extinction)
    colours = _COLOURS if channels == len(_COLOURS) else [(str(index + 1), "FFFFFF") for index in range(channels)]
    most = float(cube.extinction.max()) or 1.0
    some = cube.extinction.ravel()[:: -(-cube.extinction.size // 1_000_000)]
    white = float(np.percentile(some[some > 0], _WHITE)) if np.any(some > 0) else most
    space = [{"name": axis, "type": "space", "unit": "millimeter"} for axis in "zyx"]
    return {
        "version": "0.5",
        "multiscales": [
            {
                "name": "extinction",
                "axes": [{"name": "c", "type": "channel"}, *space],
                "datasets": [
                    {
                        "path": _IMAGE,
                        "coordinateTransformations": [{"type": "scale", "scale": [1.0, z_mm, y_mm, x_mm]}],
                    }
                ],
            }
        ],
        "omero": {
            "channels": [
                {
                    "label": f"extinction {label}",
                    "color": colour,
                    "active": True,
                    "window": {"min": 0.0, "max": most, "start": 0.0, "end": white},
                }
                for label, colour in colours
            ]
        },
    }


async def _read(
    path: Path, opened: LocalStore | ZipStore, size: Callable[[str], int], missing: Missing, inside: str = ""
) -> Parts:
    """Metadata, extinction and targets of the group in a store, or in a folder inside it; and what is `missing`."""
    store = Guarded(opened, size, partial(_metadata.damaged, path))
    try:
        group = await group_of(store, inside)
        document = group.attrs.get(_ATTRIBUTE)
        _metadata.check_version(path, document)
        extinction = await get_array(path, store, group, _IMAGE, missing)
        if extinction is None:
            raise _metadata.damaged(path, f"its array {_IMAGE!r} is missing")
        return document, extinction, await get_array(path, store, group, _TARGETS, missing)
    finally:
        store.close()


async def get_array(
    path: Path, store: Guarded, group: zarr.AsyncGroup, name: str, missing: Missing, axes: int = 4
) -> NDArray[Any] | None:
    """All of an array of so many axes, or None where there is none; `InputError` where chunks are missing.

    Other programs leave out chunks that hold nothing but zeros: of theirs it is told in `missing`.
    """
    if not await group.contains(name):
        return None
    array = await group.getitem(name)
    if not isinstance(array, zarr.AsyncArray) or array.ndim != axes or not all(array.shape):
        raise _metadata.damaged(path, f"{name!r} is not an array with {axes} axes, none of them empty")
    chunk_bytes = math.prod(array.chunks) * array.dtype.itemsize
    if max(array.nbytes, chunk_bytes) > memory() // 2:
        raise InputError(f"{path} states more than half of this machine's memory: open it on a larger one")
    store.expect(array.metadata.codecs, chunk_bytes)
    counts = [-(-size // chunk) for size, chunk in zip(array.shape, array.chunks, strict=True)]
    if not _is_as_written(array) and math.prod(counts) > _MOST_CHUNKS:
        raise _metadata.damaged(path, f"its array {name!r} has more than {_MOST_CHUNKS:,} chunks: make them larger")
    absent = await _absent(store, array, counts)
    if absent and _is_as_written(array):
        raise _metadata.damaged(path, f"parts of its array {name!r} are missing")
    if absent:
        missing[name] = (absent, math.prod(counts))
    return locked(np.asarray(await array.getitem(...)))


async def _absent(store: Guarded, array: zarr.AsyncArray[Any], counts: list[int]) -> int:
    """How many chunks of an array are not there, of so many along each axis."""
    there = {key async for key in store.list_prefix(array.path)}
    if len(there) < math.prod(counts) and _is_as_written(array):  # not to count thousands of millions
        return math.prod(counts) - len(there) or 1
    return sum(f"{array.path}/{array.metadata.encode_chunk_key(at)}" not in there for at in np.ndindex(*counts))


def _is_as_written(array: zarr.AsyncArray[Any]) -> bool:
    """Whether an array is packed as `_write` does it, all chunks there, not as another program wrote it anew."""
    return any(isinstance(codec, ZstdCodec) and codec.checksum for codec in array.metadata.codecs)


def reading(path: Path, read: Callable[[], Coroutine[Any, Any, Parts]]) -> Parts:
    """Run `read`; whatever Zarr and its codecs raise over damaged bytes becomes one sentence."""
    try:
        with system_errors(path, "reading"):
            return run(read)
    except InputError:
        raise
    except MemoryError as error:
        raise InputError(f"{path} does not fit into this machine's memory: open it on a larger one") from error
    except Exception as error:  # Zarr, zipfile and numcodecs raise whatever they trip over
        detail = " ".join(str(error).split())[:100] or type(error).__name__
        raise _metadata.damaged(path, detail) from error


def run(work: Callable[[], Coroutine[Any, Any, Value]]) -> Value:
    """Run a coroutine to its end in a thread of its own: the caller's may have an event loop already."""
    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        return pool.submit(lambda: asyncio.run(work())).result()
