"""Places that are paths or URLs: whole files or none on the disk and in object stores, through fsspec.

A *place* is a `Path`, or a URL as text (``s3://bucket/name``). Files of a URL are fetched into a temporary folder
before they are read, and sent when they are whole. A folder is not sent in one step: while that lasts it holds a
mark, and whoever finds the mark takes the folder for unfinished.
"""

import io
import json
import os
import re
import shutil
import socket
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any, TypeGuard
from uuid import uuid4

from lightcube.errors import InputError, without_secrets
from lightcube.io._bounds import check_file
from lightcube.io._workplaces import settle

#: A file on this disk, or a URL.
Place = Path | str

#: In a folder of a URL while it is being sent.
UNFINISHED = ".lightcube-unfinished"
#: What a Zarr group begins with: without it there is none, so it goes last.
_ROOT = "zarr.json"

#: Requests to a store at the same time.
_AT_ONCE = 16

#: Two letters at least: one is a drive.
_URL = re.compile(r"([A-Za-z][A-Za-z0-9+.-]+)://(.*)", re.DOTALL)
#: What fsspec calls chained: one store inside of another.
_CHAIN = re.compile(r"::[A-Za-z][A-Za-z0-9+.-]+://")
_OF_THE_EXTRA = ("s3", "s3a", "http", "https")


def place(given: str | Path) -> Place:
    """Return what a user gave as a `Path`, or as a URL without a slash at its end; ``file://`` is a path.

    Raises
    ------
    InputError
        Where a URL says nothing but its scheme, a ``file://`` does not begin at the root, or it is "-", which
        elsewhere stands for a pipe.
    """
    if str(given) == "-":
        raise InputError("- is no name: nothing is read from a pipe or written to one, give a file or a folder")
    if isinstance(given, str) and _CHAIN.search(given):
        raise InputError(f"{given} is a chain of URLs, of which one at a time is read or written: give one")
    match = _URL.fullmatch(given) if isinstance(given, str) else None
    if match is None:
        return Path(given)
    scheme, rest = match[1].lower(), match[2].rstrip("/")
    if not rest:
        raise InputError(f"{given} names no file and no folder: give one, such as {scheme}://bucket/name")
    if scheme == "file":
        from urllib.request import url2pathname  # here: all that speaks HTTP comes with it

        rest = rest.removeprefix("localhost")
        if not rest.startswith("/"):
            raise InputError(f"{given} is no file URL: begin with three slashes, such as file:///tmp/{rest}")
        return Path(url2pathname(rest))
    return f"{scheme}://{rest}"


def name_of(at: Place) -> str:
    """Return the last part of a place, with its suffix."""
    if isinstance(at, Path):
        return at.name
    path = at.split("?")[0] if at.startswith("http") else at
    return path.rsplit("/", 1)[-1]


def child(folder: Place, name: str) -> Place:
    """Return the place called `name` inside of a folder."""
    return folder / name if isinstance(folder, Path) else f"{folder}/{name}"


def beside(at: Place, name: str) -> Place:
    """Return the place called `name` in the same folder."""
    return at.with_name(name) if isinstance(at, Path) else f"{at.rsplit('/', 1)[0]}/{name}"


def exists(at: Place) -> bool:
    """Whether there is something, a broken link too; a folder whose sending was interrupted is nothing."""
    if isinstance(at, Path):
        return at.exists() or at.is_symlink()
    with _reaching(at, "looking for") as (store, path):
        return store.exists(path) and not store.exists(f"{path}/{UNFINISHED}")


def is_folder(at: Place) -> bool:
    """Whether there is a folder."""
    if isinstance(at, Path):
        return at.is_dir()
    with _reaching(at, "looking for") as (store, path):
        return store.isdir(path)


def names_in(folder: Place) -> list[str]:
    """Names of the files and folders directly in a folder, sorted; none where there is no such folder."""
    if isinstance(folder, Path):
        with suppress(FileNotFoundError):
            return sorted(entry.name for entry in folder.iterdir())
        return []
    with _reaching(folder, "listing") as (store, path), suppress(FileNotFoundError):
        names = (entry.rstrip("/").rsplit("/", 1)[-1] for entry in store.ls(path, detail=False))
        return sorted(name for name in names if name)
    return []


def read_bytes(at: Place) -> bytes | None:
    """Return what is in a file, or None where there is none."""
    if isinstance(at, Path):
        with suppress(FileNotFoundError):
            return check_file(at).read_bytes()
        return None
    with _reaching(at, "reading") as (store, path), suppress(FileNotFoundError):
        return bytes(store.cat_file(path))
    return None


@contextmanager
def written(at: Place) -> Iterator[IO[bytes]]:
    """Yield a file that gets the name `at`, in place of what had it before, once it is whole and on the disk.

    The folder that it goes into is there already; where URLs know folders it is made.

    Raises
    ------
    InputError
        Where a URL cannot be written. A path raises `OSError`, as all that is done to paths here.
    """
    if not isinstance(at, Path):
        buffer = io.BytesIO()
        yield buffer
        with _reaching(at, "writing") as (store, path):
            _put(store, path, lambda where: store.pipe_file(where, buffer.getvalue()))
        return
    fresh = at.with_name(_hidden(at.name))
    try:
        with fresh.open("xb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        fresh.replace(at)
        settle(at.parent)
    except BaseException:
        fresh.unlink(missing_ok=True)
        raise


def remove(at: Place) -> None:
    """Remove a file, or a folder with all that is in it; nothing happens where there is neither."""
    if isinstance(at, Path):
        if at.is_dir() and not at.is_symlink():
            shutil.rmtree(at)
        else:
            at.unlink(missing_ok=True)
        return
    with _reaching(at, "removing") as (store, path):
        _remove(store, path)


@contextmanager
def fetched(at: Place, wanted: Callable[[str], bool] | None = None) -> Iterator[Path]:
    """Yield a path where the file or folder `at` can be read; for a URL that is a copy which goes away at the end.

    Where nothing is at a URL, nothing is at the path. `InputError` that is raised meanwhile names the URL.

    Parameters
    ----------
    wanted
        Tells by its name which file of a folder is needed. Where it is given, other files are empty in the copy,
        and inner folders are left out.

    Raises
    ------
    InputError
        Where a URL cannot be read, its folder is unfinished, or it changes while it is read.
    """
    if isinstance(at, Path):
        yield at
        return
    with tempfile.TemporaryDirectory(prefix="lightcube-", ignore_cleanup_errors=True) as folder:
        copy = Path(folder) / name_of(at)
        with _reaching(at, "reading") as (store, path):
            _fetch(store, at, path, copy, wanted)
        try:
            yield copy
        except InputError as error:
            raise InputError(str(error).replace(str(copy), at)) from error


def send(local: Path, url: str) -> None:
    """Put a file or a folder that is whole at a URL, in place of what stands there.

    A file is there as a whole or not at all. A folder is marked as unfinished until all of it is there, and what makes
    it a cube for others goes last; an older one is gone from the beginning.

    Raises
    ------
    InputError
        Where the URL cannot be written, or sending breaks off.
    """
    with _reaching(url, "writing") as (store, path):
        if not local.is_dir():
            if store.isdir(path):
                _remove(store, path)
            _put(store, path, lambda where: store.put_file(str(local), where))
            return
        if store.isfile(path):
            store.rm_file(path)
        mark = f"{path}/{UNFINISHED}"
        if not store.async_impl:
            store.makedirs(path, exist_ok=True)
        store.pipe_file(mark, b"")
        old = [found for found in _listing(store, path) or () if found != UNFINISHED]
        for part in _root_apart(old):
            _remove_files(store, [f"{path}/{name}" for name in part])
        names = [file.relative_to(local).as_posix() for file in local.rglob("*") if file.is_file()]
        for part in reversed(_root_apart(names)):
            _transfer(store, "put", [str(local / name) for name in part], [f"{path}/{name}" for name in part])
        store.rm_file(mark)


def _fetch(store: Any, url: str, path: str, copy: Path, wanted: Callable[[str], bool] | None) -> None:
    """Copy what stands at `path` of a store to `copy`, as it is at one moment."""
    depth = None if wanted is None else 1
    found = _listing(store, path, depth)
    if found is None:
        return
    if UNFINISHED in found:
        raise InputError(f"{url} is unfinished, it is being sent or that was interrupted: wait, or make it again")
    if "" in found:
        store.get_file(path, str(copy))
    else:
        copy.mkdir()
        for name in found:
            if not (copy / name).resolve().is_relative_to(copy.resolve()):
                raise InputError(f"{url} holds a file {name!r}, which leads out of the folder: remove it")
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            (copy / name).touch()
        names = [name for name in found if wanted is None or wanted(name)]
        _transfer(store, "get", [f"{path}/{name}" for name in names], [str(copy / name) for name in names])
    if _listing(store, path, depth) != found:
        raise InputError(f"{url} changed while it was read: read it again")


def _listing(store: Any, path: str, depth: int | None = None) -> dict[str, Any] | None:
    """Details of all files at `path` by their relative name, ``""`` for `path` itself; None where nothing is."""
    store.invalidate_cache()
    try:
        itself = store.info(path)
    except FileNotFoundError as error:
        if _is_refusal(cause := error.__cause__):
            raise cause from None
        return None
    if itself["type"] == "file":
        return {"": itself}
    inside = path.rstrip("/") + "/"
    found = {name.removeprefix(inside): said for name, said in store.find(path, maxdepth=depth, detail=True).items()}
    # Some stores show a folder as an empty file whose name ends with a slash.
    return {name: said for name, said in found.items() if name and not name.endswith("/")}


def _transfer(store: Any, verb: str, sources: Sequence[str], targets: Sequence[str]) -> None:
    """Get or put files, many at a time where the store can do that."""
    if store.async_impl:
        if sources:
            getattr(store, verb)(list(sources), list(targets))
        return
    for source, target in zip(sources, targets, strict=True):
        if verb == "put":
            store.makedirs(target.rsplit("/", 1)[0], exist_ok=True)
        getattr(store, f"{verb}_file")(source, target)


def _remove(store: Any, path: str) -> None:
    """Remove a file or a folder, which may be gone already."""
    with suppress(FileNotFoundError):
        _remove_files(store, [f"{path}/{name}" if name else path for name in _listing(store, path) or ()])
        store.invalidate_cache()
        if store.isdir(path):  # stores that know folders keep them when they are empty
            store.rm(path, recursive=True)


def _remove_files(store: Any, paths: Sequence[str]) -> None:
    """Remove files one by one: the stores' own removal of many takes brackets in names for patterns."""
    with ThreadPoolExecutor(_AT_ONCE if store.async_impl else 1) as pool:
        list(pool.map(store.rm_file, paths))


def _root_apart(names: Sequence[str]) -> list[list[str]]:
    """What makes a Zarr group of a folder, and everything else."""
    return [[name for name in names if name == _ROOT], [name for name in names if name != _ROOT]]


def _put(store: Any, path: str, put: Callable[[str], None]) -> None:
    """Let `put` write a file that gets its name when it is whole: stores that cannot rename do so by themselves."""
    if type(store).mv is _no_rename():
        put(path)
        return
    folder, slash, name = path.rpartition("/")
    store.makedirs(folder + slash, exist_ok=True)
    fresh = folder + slash + _hidden(name)
    put(fresh)
    store.mv(fresh, path)


def _no_rename() -> Any:
    """Return the method of stores that move files by copying them."""
    from fsspec import AbstractFileSystem

    return AbstractFileSystem.mv


def _hidden(name: str) -> str:
    return f".{name}-{uuid4().hex}"


@contextmanager
def _reaching(url: str, doing: str) -> Iterator[tuple[Any, str]]:
    """Yield the fsspec file system of a URL and the path in it; what either of them raises becomes one sentence."""
    scheme = url.split("://")[0]
    try:
        yield _file_system(url, scheme)
    except InputError:
        raise
    except ImportError as error:
        package = "'lightcube[remote]'" if scheme in _OF_THE_EXTRA else "what is named here"
        raise InputError(
            f"{url} cannot be reached, a package is missing ({_detail(error, url)}): pip install {package}"
        ) from error
    except Exception as error:  # file systems raise whatever their libraries trip over
        if _is_unreached(error):
            raise InputError(
                f"the server of {url} does not answer ({_detail(error, url)}): check the URL and your network"
            ) from error
        raise InputError(
            f"{doing} {url} failed ({_detail(error, url)}): check the URL and your access to it"
        ) from error


def _file_system(url: str, scheme: str) -> tuple[Any, str]:
    try:
        import fsspec
    except ImportError:
        raise InputError(f"{url} is a URL, which needs more packages: pip install 'lightcube[remote]'") from None
    try:
        fsspec.get_filesystem_class(scheme)
    except ValueError:
        raise InputError(
            f"{url} cannot be reached, nobody knows {scheme}://: use a path, s3://, or check the spelling"
        ) from None
    store, path = fsspec.url_to_fs(url)
    store.invalidate_cache()  # others write there too
    return store, path


def _is_unreached(error: BaseException) -> bool:
    """Whether a server could not be asked; what aiohttp raises then holds the system's error."""
    reason = getattr(error, "os_error", error)
    return reason is not error or isinstance(reason, ConnectionError | TimeoutError | socket.gaierror)


def _is_refusal(error: BaseException | None) -> TypeGuard[BaseException]:
    """Whether what a store takes for a missing file is a server that cannot be asked, or does not want to answer."""
    return error is not None and (_is_unreached(error) or getattr(error, "status", 404) not in (404, 410))


def _detail(error: Exception, url: str) -> str:
    """What a library says; of a URL with a password only what kind of error it is, for it may repeat parts of it."""
    if without_secrets(url) != url:
        return type(error).__name__
    said = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return " ".join(said.split())[:150] or type(error).__name__


def holds(folder: Place, kind: str) -> bool:
    """Whether a folder is of this package, and of some kind but a cube."""
    try:
        document = json.loads(read_bytes(child(folder, "zarr.json")) or b"")
        return bool(document["attributes"]["lightcube"]["kind"] == kind)
    except (OSError, ValueError, LookupError, TypeError):
        return False
