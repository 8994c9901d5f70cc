"""A cube, a shape or a relief as a Zarr group: an OME-Zarr 0.5 image with one more attribute.

Zarr's own coroutines run in an event loop that ends with each call, so that no thread is left behind.
"""

import asyncio
import concurrent.futures
import math
import warnings
import zipfile
from collections.abc import Callable, Coroutine, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path, PurePosixPath
from typing import Any, TypeVar

import numpy as np
import zarr
from numpy.typing import NDArray
from zarr.codecs import ZstdCodec
from zarr.storage import LocalStore, StorePath, ZipStore

from lightcube.errors import InputError
from lightcube.io import _metadata, _relief_json, _shape_json
from lightcube.io._archives import is_crowded
from lightcube.io._bounds import check_file, check_text, memory
from lightcube.io._files import system_errors
from lightcube.io._guarded import Guarded
from lightcube.optics.arrays import locked
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.solids.relief import Relief
from lightcube.solids.shape import Shape

Value = TypeVar("Value")
#: By an array's name: how many of its chunks are not there, of how many.
Missing = dict[str, tuple[int, int]]
Parts = tuple[object, NDArray[Any], NDArray[Any] | None, NDArray[Any] | None]


@dataclass(frozen=True)
class _Kind:
    """What a group holds: names and numbers of axes of its arrays, the third of which may have no name.

    `check` says what its document must be.

    `damaged` makes what is raised where it is not so.
    """

    second: str
    check: Callable[[Path, object], object]
    damaged: Callable[[Path, str], InputError]
    first: str = "0"
    axes: tuple[int, int] = (4, 4)
    third: str = ""


#: An array with its name and those of its axes.
Named = tuple[str, NDArray[Any], list[str]]


class HollowCube(UserWarning):
    """Parts of a cube's arrays that another program wrote are not there: they may be empty, or lost."""


#: A chunk is as many whole slices as fit into this many bytes, at least one.
_CHUNK_BYTES = 8 << 20
#: Other programs make more of them, up to so many: each takes a while to find.
_MOST_CHUNKS = 100_000
_ROOT = "zarr.json"
_IMAGE, _TARGETS, _SILHOUETTES, _ATTRIBUTE = "0", "targets", "silhouettes", "lightcube"
_HEIGHTS, _WANTED, _AMOUNTS = "heights", "wanted", "amounts"
#: Where a display's white is, among the voxels that are not empty, in per cent: a twentieth of them or more are as dark
#: as the material can be, ten times as dark as most, and a display that ends there shows a cube as black.
_WHITE = 90
_CUBE = _Kind(_TARGETS, _metadata.check_version, _metadata.damaged, third=_AMOUNTS)
_SHAPE = _Kind(_SILHOUETTES, _shape_json.check_version, _shape_json.damaged)
_RELIEF = _Kind(_WANTED, _relief_json.check_version, _relief_json.damaged, _HEIGHTS, (2, 3))
_COLOURS = (("red", "FF0000"), ("green", "00FF00"), ("blue", "0000FF"))


def write_zarr(folder: Path, cube: Cube) -> None:
    """Write `cube` as a new Zarr group, format 3, into `folder`, which does not exist yet."""
    arrays: list[Named] = [(_IMAGE, cube.extinction, ["c", "z", "y", "x"])]
    if cube.targets is not None:
        arrays.append((_TARGETS, cube.targets, ["view", "row", "column", "channel"]))
    if cube.amounts is not None:
        arrays.append((_AMOUNTS, cube.amounts, ["dye", "z", "y", "x"]))
    _run(lambda: _write(folder, {"ome": _ome(cube), _ATTRIBUTE: _metadata.to_json(cube)}, arrays))


def write_shape(folder: Path, shape: Shape) -> None:
    """Write `shape` as a new Zarr group, format 3, into `folder`, which does not exist yet."""
    ome = {"version": "0.5", "multiscales": _multiscales("field", shape.grid)}
    given = shape.silhouettes.inside[..., None].astype(np.uint8)
    arrays: list[Named] = [
        (_IMAGE, shape.field[None], ["c", "z", "y", "x"]),
        (_SILHOUETTES, given, ["view", "row", "column", "channel"]),
    ]
    _run(lambda: _write(folder, {"ome": ome, _ATTRIBUTE: _shape_json.to_json(shape)}, arrays))


def read_shape(path: Path) -> Shape:
    """Read a shape from a Zarr folder, or from one in a zip archive."""
    missing: Missing = {}
    document, field, given, _ = _reading(path, lambda: _read_either(path, missing, _SHAPE), _SHAPE)
    if missing:
        raise _shape_json.damaged(path, f"parts of its array {next(iter(missing))!r} are missing")
    return _shape_json.from_json(path, document, field, given)


def write_relief(folder: Path, relief: Relief) -> None:
    """Write `relief` as a new Zarr group, format 3, into `folder`, which does not exist yet."""
    arrays: list[Named] = [
        (_HEIGHTS, relief.heights_px, ["row", "column"]),
        (_WANTED, relief.wanted, ["picture", "row", "column"]),
    ]
    _run(lambda: _write(folder, {_ATTRIBUTE: _relief_json.to_json(relief)}, arrays))


def read_relief(path: Path) -> Relief:
    """Read a relief from a Zarr folder, or from one in a zip archive."""
    missing: Missing = {}
    document, heights, wanted, _ = _reading(path, lambda: _read_either(path, missing, _RELIEF), _RELIEF)
    if missing or wanted is None:
        raise _relief_json.damaged(path, "parts of its arrays are missing")
    return _relief_json.from_json(path, document, heights, wanted)


def read_zarr(path: Path) -> Cube:
    """Read a cube from a Zarr folder."""
    store, size = _folder(path)
    return _cube(path, lambda missing: _read(path, store, size, missing))


def _folder(path: Path) -> tuple[LocalStore, Callable[[str], int]]:
    """A folder as a store, and what tells the bytes of a file in it, none where there is none."""
    if not (path / _ROOT).is_file():
        raise InputError(f"{path} is no light cube: there is no zarr.json in it, give a folder that lightcube wrote")

    def size(key: str) -> int:
        member = check_file(path / key)
        return member.stat().st_size if member.is_file() else 0

    return LocalStore(path, read_only=True), size


def zipped(write: Callable[[Path, Value], None]) -> Callable[[Path, Value], None]:
    """What writes a Zarr group in one zip archive, stored as it is: its chunks are compressed already."""

    def written(file: Path, thing: Value) -> None:
        folder = file.with_name(file.name + ".unzipped")
        write(folder, thing)
        zip_folder(folder, file)

    return written


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
    return _cube(path, lambda missing: _read_zip(path, missing, _CUBE))


async def _read_zip(path: Path, missing: Missing, kind: _Kind) -> Parts:
    """What a zip archive holds of a kind."""
    with path.open("rb") as file:
        if is_crowded(file):
            raise kind.damaged(path, "it lists too many members")
        with zipfile.ZipFile(file) as archive:
            sizes = {member.filename: member.file_size for member in archive.infolist()}
    store, inside = ZipStore(path, mode="r"), _inside(path, sizes)
    return await _read(path, store, lambda key: sizes.get(key, 0), missing, inside, kind=kind)


async def _read_either(path: Path, missing: Missing, kind: _Kind) -> Parts:
    """What a folder or a zip archive holds of a kind."""
    if not path.is_dir():
        return await _read_zip(path, missing, kind)
    store, size = _folder(path)
    return await _read(path, store, size, missing, kind=kind)


def _cube(path: Path, read: Callable[[Missing], Coroutine[Any, Any, Parts]]) -> Cube:
    """The cube of what `read` finds; of parts that are not there a note says so."""
    missing: Missing = {}
    cube = _metadata.from_json(path, *_reading(path, lambda: read(missing), _CUBE))
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


async def _write(folder: Path, attributes: dict[str, Any], arrays: Sequence[Named]) -> None:
    """Write group, arrays and attributes."""
    group = await zarr.AsyncGroup.from_store(LocalStore(folder), attributes=attributes, zarr_format=3)
    check_text((folder / _ROOT).stat().st_size)
    for name, values, axes in arrays:
        array = await group.create_array(
            name,
            shape=values.shape,
            dtype=values.dtype,
            chunks=_chunks(name, values),
            dimension_names=axes,
            compressors=ZstdCodec(level=3, checksum=True),
            fill_value=0,
            config={"write_empty_chunks": True},  # a chunk that is missing is then known to be lost
        )
        await array.setitem(..., values)


def _chunks(name: str, values: NDArray[Any]) -> tuple[int, ...]:
    """The shape of an array's chunks: whole slices of a volume, whole pictures of all else."""
    if name in (_IMAGE, _AMOUNTS):
        channels, nz, ny, nx = values.shape
        return channels, max(1, min(nz, _CHUNK_BYTES // (4 * channels * ny * nx))), ny, nx
    return max(1, min(len(values), _CHUNK_BYTES // values[0].size)), *values.shape[1:]


def _multiscales(name: str, grid: Grid) -> list[dict[str, Any]]:
    """OME-Zarr's axes and voxel size of a volume."""
    x_mm, y_mm, z_mm = grid.sides_mm.tolist()
    space = [{"name": axis, "type": "space", "unit": "millimeter"} for axis in "zyx"]
    return [
        {
            "name": name,
            "axes": [{"name": "c", "type": "channel"}, *space],
            "datasets": [
                {
                    "path": _IMAGE,
                    "coordinateTransformations": [{"type": "scale", "scale": [1.0, z_mm, y_mm, x_mm]}],
                }
            ],
        }
    ]


def _ome(cube: Cube) -> dict[str, Any]:
    """OME-Zarr 0.5 metadata of the image: axes, voxel size, and colours of the channels."""
    channels = len(cube.extinction)
    colours = _COLOURS if channels == len(_COLOURS) else [(str(index + 1), "FFFFFF") for index in range(channels)]
    most = float(cube.extinction.max()) or 1.0
    some = cube.extinction.ravel()[:: -(-cube.extinction.size // 1_000_000)]
    white = float(np.percentile(some[some > 0], _WHITE)) if np.any(some > 0) else most
    return {
        "version": "0.5",
        "multiscales": _multiscales("extinction", cube.grid),
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
    path: Path,
    opened: LocalStore | ZipStore,
    size: Callable[[str], int],
    missing: Missing,
    inside: str = "",
    *,
    kind: _Kind = _CUBE,
) -> Parts:
    """Metadata and arrays of the group in a store, or in a folder inside it; and what is `missing`."""
    store = Guarded(opened, size, partial(kind.damaged, path))
    try:
        group = await zarr.AsyncGroup.open(await StorePath.open(store, inside, mode="r"), zarr_format=3)
        document = group.attrs.get(_ATTRIBUTE)
        kind.check(path, document)
        first = await _array(path, store, group, kind.first, missing, kind)
        if first is None:
            raise kind.damaged(path, f"its array {kind.first!r} is missing")
        second = await _array(path, store, group, kind.second, missing, kind)
        third = await _array(path, store, group, kind.third, missing, kind) if kind.third else None
        return document, first, second, third
    finally:
        store.close()


async def _array(
    path: Path, store: Guarded, group: zarr.AsyncGroup, name: str, missing: Missing, kind: _Kind
) -> NDArray[Any] | None:
    """All of an array, or None where there is none; `InputError` where chunks are missing.

    Other programs leave out chunks that hold nothing but zeros: of theirs it is told in `missing`.
    """
    if not await group.contains(name):
        return None
    array = await group.getitem(name)
    if (
        not isinstance(array, zarr.AsyncArray)
        or array.ndim != (axes := kind.axes[name != kind.first])
        or not all(array.shape)
    ):
        raise kind.damaged(path, f"{name!r} is not an array with {axes} axes, none of them empty")
    chunk_bytes = math.prod(array.chunks) * array.dtype.itemsize
    if max(array.nbytes, chunk_bytes) > memory() // 2:
        raise InputError(f"{path} states more than half of this machine's memory: open it on a larger one")
    store.expect(array.metadata.codecs, chunk_bytes)
    counts = [-(-size // chunk) for size, chunk in zip(array.shape, array.chunks, strict=True)]
    if not _is_as_written(array) and math.prod(counts) > _MOST_CHUNKS:
        raise kind.damaged(path, f"its array {name!r} has more than {_MOST_CHUNKS:,} chunks: make them larger")
    absent = await _absent(store, array, counts)
    if absent and _is_as_written(array):
        raise kind.damaged(path, f"parts of its array {name!r} are missing")
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


def _reading(path: Path, read: Callable[[], Coroutine[Any, Any, Parts]], kind: _Kind) -> Parts:
    """Run `read`; whatever Zarr and its codecs raise over damaged bytes becomes one sentence."""
    try:
        with system_errors(path, "reading"):
            return _run(read)
    except InputError:
        raise
    except MemoryError as error:
        raise InputError(f"{path} does not fit into this machine's memory: open it on a larger one") from error
    except Exception as error:  # Zarr, zipfile and numcodecs raise whatever they trip over
        detail = " ".join(str(error).split())[:100] or type(error).__name__
        raise kind.damaged(path, detail) from error


def _run(work: Callable[[], Coroutine[Any, Any, Value]]) -> Value:
    """Run a coroutine to its end in a thread of its own: the caller's may have an event loop already."""
    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        return pool.submit(lambda: asyncio.run(work())).result()
