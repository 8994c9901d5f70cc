"""Small files that state enormous sizes, and what is no file at all: made, and given to the commands.

``python -m tests.hostile.bombs FOLDER`` makes each in a folder and gives it to the commands that would read it, in a
process of its own, and prints a line of JSON for each: exit code, what was said, seconds, megabytes beyond what the
process had before. With ``-`` behind it, names are read as lines, and each is given to the first of its commands.
"""

import json
import os
import resource
import shutil
import signal
import socket
import struct
import sys
import tempfile
import time
import zipfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

import lightcube as lc
from tests.hostile.pictures import GIGABYTE, MILLION, blanks, bytes_pictures, crc_of_blanks

Maker = Callable[[Path], Path]

GRID = lc.Grid((4, 5, 6))
CUBE = lc.Cube(
    np.ones((3, *GRID.shape), np.float32),
    GRID,
    lc.turntable(GRID, [0.0, 90.0], elevation_deg=30, picture_shape=(4, 4)),
)


def wrote(path: Path, data: bytes, size: int = 0) -> Path:
    """Write a file; with a size, that is followed by as many zeros, which take no place on the disk."""
    with path.open("wb") as file:
        file.write(data)
        file.truncate(max(size, len(data)))
    return path


# Cubes ----------------------------------------------------------------------------------------------------------------


def changed_zarr(folder: Path, name: str, **changes: Any) -> Path:
    """A cube's folder in which the description of an array is another one."""
    path = lc.save(CUBE, folder / name)
    described = path / "0" / "zarr.json"
    document = json.loads(described.read_text())
    document.update(changes)
    described.write_text(json.dumps(document))
    return path


def grid_of(*shape: int) -> dict[str, Any]:
    return {"name": "regular", "configuration": {"chunk_shape": list(shape)}}


def zstd_blanks(size: int) -> bytes:
    from numcodecs.zstd import Zstd

    return bytes(Zstd(level=3).encode(bytes(size)))


def zstd_untold(size: int) -> bytes:
    """A Zstandard frame that does not say how long it is: repeated bytes."""
    blocks = size // 131072
    heads = [struct.pack("<I", (number == blocks - 1) | 1 << 1 | 131072 << 3)[:3] + b"\0" for number in range(blocks)]
    return b"\x28\xb5\x2f\xfd" + b"\0\x70" + b"".join(heads)


def with_chunk(path: Path, data: bytes, size: int = 0) -> Path:
    wrote(path / "0" / "c" / "0" / "0" / "0" / "0", data, size)
    return path


def codecs(*named: dict[str, Any]) -> list[dict[str, Any]]:
    return [{"name": "bytes", "configuration": {"endian": "little"}}, *named]


def zipped(path: Path, members: dict[str, bytes], *, packed: bool = True) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED if packed else zipfile.ZIP_STORED) as archive:
        for name, data in members.items():
            archive.writestr(name, data)
    return path


def zip_of_blanks(path: Path, name: str, size: int, others: dict[str, bytes], begins: bytes = b"") -> Path:
    """An archive one of whose members is blanks: it is put there packed, and then called so."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for other, data in others.items():
            archive.writestr(other, data)
        member = zipfile.ZipInfo(name)
        archive.writestr(member, blanks(size, -15, begins), zipfile.ZIP_STORED)
        member.compress_type, member.file_size = zipfile.ZIP_DEFLATED, size + len(begins)
        member.CRC = crc_of_blanks(size, begins)
        assert archive.fp is not None
        archive.fp.seek(member.header_offset)
        archive.fp.write(member.FileHeader())
    return path


def members_of(folder: Path) -> dict[str, bytes]:
    return {
        item.relative_to(folder).as_posix(): item.read_bytes() for item in sorted(folder.rglob("*")) if item.is_file()
    }


def npy(shape: tuple[int, ...], dtype: str = "<f4", data: bytes = b"") -> bytes:
    header = repr({"descr": dtype, "fortran_order": False, "shape": shape}).encode()
    header = header.ljust(118 + -len(header) % 64) + b"\n"
    return b"\x93NUMPY\x01\0" + struct.pack("<H", len(header)) + header + data


def npz(folder: Path, **changed: bytes) -> Path:
    path = lc.save(CUBE, folder / "bomb.npz")
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    return zipped(path, members | {f"{name}.npy": data for name, data in changed.items()})


def npz_of_blanks(name: str, begins: bytes) -> Maker:
    def make(folder: Path) -> Path:
        path = lc.save(CUBE, folder / "bomb.npz")
        with zipfile.ZipFile(path) as archive:
            others = {other: archive.read(other) for other in archive.namelist() if other != name}
        return zip_of_blanks(path, name, 2 * GIGABYTE, others, begins)

    return make


def zarr_zip_with(folder: Path, name: str, size: int) -> Path:
    """A cube in an archive one of whose members is blanks."""
    members = members_of(lc.save(CUBE, folder / "plain.zarr"))
    members.pop(name, None)
    return zip_of_blanks(folder / "bomb.zarr.zip", name, size, members)


def million_members(folder: Path) -> Path:
    members = members_of(lc.save(CUBE, folder / "plain.zarr"))
    return zipped(folder / "bomb.zarr.zip", members | {f"x{k}": b"" for k in range(MILLION // 5)}, packed=False)


def nested(depth: int) -> bytes:
    return b"[" * depth + b"]" * depth


def zarr_with_json(folder: Path, data: bytes, inside: str = "zarr.json", size: int = 0) -> Path:
    path = lc.save(CUBE, folder / "bomb.zarr")
    wrote(path / inside, data, size)
    return path


def attributes_nested(depth: int) -> bytes:
    return b'{"zarr_format": 3, "node_type": "group", "attributes": {"lightcube": ' + nested(depth) + b"}}"


def cubes() -> dict[str, Maker]:
    zstd = {"name": "zstd", "configuration": {"level": 3, "checksum": False}}
    gzip = {"name": "gzip", "configuration": {"level": 5}}
    blosc = {
        "name": "blosc",
        "configuration": {"typesize": 4, "cname": "lz4", "clevel": 5, "shuffle": "noshuffle", "blocksize": 0},
    }
    shards = {
        "name": "sharding_indexed",
        "configuration": {
            "chunk_shape": [1, 1, 1, 1],
            "codecs": codecs(zstd),
            "index_codecs": codecs({"name": "crc32c"}),
            "index_location": "end",
        },
    }
    blosc_head = struct.pack("<BBBBIII", 2, 1, 0x33, 4, 2**31 - 65536, 2**31 - 65536, 20) + bytes(4)
    return {
        "chunks.zarr": lambda at: changed_zarr(
            at, "b.zarr", shape=[3, 1800, 1800, 1800], chunk_grid=grid_of(1, 1, 1, 1)
        ),
        "shape.zarr": lambda at: changed_zarr(
            at, "b.zarr", shape=[3, 10**6, 10**6, 10**6], chunk_grid=grid_of(3, 10**6, 10**6, 10**6)
        ),
        "8-gb.zarr": lambda at: changed_zarr(
            at, "b.zarr", shape=[3, 900, 900, 900], chunk_grid=grid_of(3, 900, 900, 900)
        ),
        "zero.zarr": lambda at: changed_zarr(at, "b.zarr", shape=[3, 0, 10**9, 10**9]),
        "zstd.zarr": lambda at: with_chunk(lc.save(CUBE, at / "b.zarr"), zstd_blanks(2 * GIGABYTE)),
        "zstd-untold.zarr": lambda at: with_chunk(lc.save(CUBE, at / "b.zarr"), zstd_untold(2 * GIGABYTE)),
        "gzip.zarr": lambda at: with_chunk(changed_zarr(at, "b.zarr", codecs=codecs(gzip)), blanks(2 * GIGABYTE, 31)),
        "blosc.zarr": lambda at: with_chunk(changed_zarr(at, "b.zarr", codecs=codecs(blosc)), blosc_head),
        "shards.zarr": lambda at: changed_zarr(at, "b.zarr", codecs=[shards]),
        "raw.zarr": lambda at: with_chunk(changed_zarr(at, "b.zarr", codecs=codecs()), b"", GIGABYTE),
        "deep.zarr": lambda at: zarr_with_json(at, attributes_nested(100_000)),
        "deeper.zarr": lambda at: zarr_with_json(at, nested(MILLION)),
        "json.zarr": lambda at: zarr_with_json(at, b"{", size=GIGABYTE),
        "json-0.zarr": lambda at: zarr_with_json(at, b"[" + b"0," * 100_000 + b"0]", "0/zarr.json"),
        "root.zarr.zip": lambda at: zarr_zip_with(at, "zarr.json", 1500 * MILLION),
        "array.zarr.zip": lambda at: zarr_zip_with(at, "0/zarr.json", 1500 * MILLION),
        "chunk.zarr.zip": lambda at: zarr_zip_with(at, "0/c/0/0/0/0", 1500 * MILLION),
        "million.zarr.zip": million_members,
        "shape.npz": lambda at: npz(at, extinction=npy((3, 10**6, 10**6, 10**6))),
        "8-gb.npz": lambda at: npz(at, extinction=npy((3, 900, 900, 900))),
        "text.npz": lambda at: npz(at, lightcube=npy((), "<U500000000")),
        "header.npz": lambda at: npz(at, extinction=b"\x93NUMPY\x02\0" + struct.pack("<I", 2**32 - 1) + b"{" * 1000),
        "deep.npz": lambda at: npz(at, lightcube=npy((), "<U200000", nested(100_000).decode().encode("utf-32-le"))),
        "blanks.npz": npz_of_blanks("extinction.npy", b""),
        "blank-text.npz": npz_of_blanks("lightcube.npy", npy((), "<U500000000")),
    }


# Texts and meshes -----------------------------------------------------------------------------------------------------


def of_mesh(name: str, data: Callable[[], bytes], size: int = 0) -> Maker:
    """A shipped scene that has a mesh more."""
    import lightcube.scene

    text = (Path(lightcube.scene.__file__).parent / "library" / "gems.toml").read_text()

    def make(folder: Path) -> Path:
        wrote(folder / name, data(), size)
        return wrote(
            folder / "bomb.toml",
            (text + f'\n[[shapes]]\ntype = "mesh"\nfile = "{name}"\ncolour = "#ffffff"\n').encode(),
        )

    return make


def texts() -> dict[str, Callable[[], bytes]]:
    return {
        "dots.toml": lambda: b".".join([b"a"] * 100_000) + b" = 1",
        "keys.toml": lambda: b"".join(b"a%d.b.c.d.e.f.g.h = 1\n" % number for number in range(42_000)),
        "some-keys.toml": lambda: b"".join(b"a%d.b.c.d.e.f.g.h = 1\n" % number for number in range(24_900)),
        "deep-keys.toml": lambda: b"".join(b"a%d%s = 1\n" % (number, b".b" * 30) for number in range(6_200)),
        "tables.toml": lambda: b"".join(b"[" + b"a." * 30 + b"k%d]\n" % number for number in range(15_000)),
        "more-tables.toml": lambda: b"[[a]]\n" * 149_000,
        "deep.toml": lambda: b"a = " + nested(100_000),
        "deep-tables.toml": lambda: b"a = " + b"{a=" * 100_000,
        "digits.toml": lambda: b"a = " + b"9" * MILLION,
        "large.toml": lambda: b"#" * 2 * MILLION,
        "list.toml": lambda: b"a = [" + b"1," * 520_000 + b"]",
        "dotted.toml": lambda: b"".join(b"a.b%d.c = 1\n" % number for number in range(65_000)),
        "inline.toml": lambda: b"a = {" + b",".join(b"k%d.b = 1" % number for number in range(80_000)) + b"}",
    }


def meshes() -> dict[str, Maker]:
    return {
        "count.stl": of_mesh("m.stl", lambda: bytes(80) + b"\xff\xff\xff\xff" + bytes(5000)),
        "blanks.stl": of_mesh("m.stl", lambda: bytes(80) + struct.pack("<I", 40 * MILLION), 2 * GIGABYTE + 84),
        "text.stl": of_mesh("m.stl", lambda: b"solid x\n", GIGABYTE),
        "text.obj": of_mesh("m.obj", lambda: b"v 0 0 0\n", GIGABYTE),
        "numbers.obj": of_mesh("m.obj", lambda: b"v 0 0 0\nf 1 999999999999 -1\n"),
        "face.obj": of_mesh("m.obj", lambda: b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf" + b" 1 2 3" * MILLION),
        "held.obj": of_mesh("m.obj", lambda: b"v 0 0 \\\n" * MILLION),
    }


# What is no file ------------------------------------------------------------------------------------------------------


def fifo(name: str) -> Maker:
    def make(folder: Path) -> Path:
        os.mkfifo(folder / name)
        return folder / name

    return make


def zeros(name: str) -> Maker:
    def make(folder: Path) -> Path:
        (folder / name).symlink_to("/dev/zero")
        return folder / name

    return make


def a_socket(name: str) -> Maker:
    def make(folder: Path) -> Path:
        before = Path.cwd()
        os.chdir(folder)  # names of sockets are short
        listening = socket.socket(socket.AF_UNIX)
        listening.bind(name)
        listening.close()
        os.chdir(before)
        return folder / name

    return make


def a_folder(name: str) -> Maker:
    def make(folder: Path) -> Path:
        (folder / name).mkdir()
        return folder / name

    return make


def inside(name: str, make: Callable[[str], Maker], honest: Callable[[Path], Path]) -> Maker:
    """Something honest in which one file is something else."""

    def replaced(folder: Path) -> Path:
        whole = honest(folder)
        target = whole / name
        target.unlink(missing_ok=True)
        make(target.name)(target.parent)
        return whole

    return replaced


def two_pictures(folder: Path) -> Path:
    pictures = folder / "pictures"
    pictures.mkdir()
    for number in range(2):
        Image.new("RGB", (8, 8)).save(pictures / f"{number}.png")
    return pictures


def no_files() -> dict[str, tuple[Maker, tuple[str, ...]]]:
    doors = {
        **dict.fromkeys(("x.png", "x.gif", "x.tif", "x.mp4", "x.webp"), PICTURES),
        **dict.fromkeys(("x.npz", "x.zarr", "x.zarr.zip"), ("info", "play")),
        "x.toml": ("check", "trace"),
        "x.zarr.partial": ("publish",),
    }
    made = {
        f"{kind}: {name}": (make(name), doors[name])
        for kind, make in (("fifo", fifo), ("zeros", zeros), ("socket", a_socket), ("folder", a_folder))
        for name in doors
    }
    for kind, make in (("fifo", fifo), ("zeros", zeros), ("socket", a_socket), ("folder", a_folder)):
        made[f"{kind}: views.toml"] = (inside("views.toml", make, two_pictures), ("check",))
        made[f"{kind}: 1.png inside"] = (inside("1.png", make, two_pictures), ("check",))
        for name in ("zarr.json", "0/zarr.json", "0/c/0/0/0/0"):
            made[f"{kind}: {name} inside"] = (inside(name, make, lambda at: lc.save(CUBE, at / "b.zarr")), ("info",))
    return made


# Doors ----------------------------------------------------------------------------------------------------------------

PICTURES = ("check", "solve")
#: What is asked of the program, by its command; where a file is written, it is in the same folder.
WORDS: dict[str, tuple[str, ...]] = {
    "solve": ("-o", "out.zarr", "--n", "8"),
    "play": ("-o", "out.gif"),
    "view": ("-o", "out.html"),
    "trace": ("-o", "out", "--count", "2", "--size", "8x8"),
    "report": ("-o", "report.html"),
}


def all_bombs() -> dict[str, tuple[Maker, tuple[str, ...]]]:
    """What makes each, and the commands that would read it."""

    def of_bytes(name: str, make: Callable[[Path], bytes]) -> Maker:
        return lambda folder: wrote(folder / name, make(folder))

    def of_text(name: str, make: Callable[[], bytes]) -> Maker:
        return lambda folder: wrote(folder / name, make())

    return {
        **{name: (of_bytes(name, make), PICTURES) for name, make in bytes_pictures().items()},
        **{name: (make, ("info", "play", "score", "view", "report")) for name, make in cubes().items()},
        **{name: (of_text(name, make), ("trace", "check")) for name, make in texts().items()},
        **{name: (make, ("trace",)) for name, make in meshes().items()},
        **no_files(),
    }


def command(door: str, path: Path) -> list[str]:
    """The words of a command that reads `path`."""
    words = [str(path.parent / word) if word.startswith(("out", "report.")) else word for word in WORDS.get(door, ())]
    return [door, str(path), *words]


def _peak() -> float:
    """Most megabytes that this process has had."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1 if sys.platform != "darwin" else 1024) / 1024


def _child(words: list[str], said: int) -> None:
    """Run a command in this process, which ends with its exit code."""
    from lightcube.cli.main import run

    os.dup2(said, 1)
    os.dup2(said, 2)
    code = 70
    try:
        code = run(words)
    except BaseException as error:
        os.write(2, f"Traceback: {type(error).__name__}: {error}".encode())
    finally:
        os._exit(code)


def given(words: list[str], limit_s: float = 12) -> dict[str, Any]:
    """What a command says in a process of its own."""
    with tempfile.TemporaryFile() as said:
        resident = int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() / 2**20
        pid = os.fork()
        if not pid:
            signal.alarm(int(limit_s))
            _child(words, said.fileno())
        began = time.monotonic()
        _, status, used = os.wait4(pid, 0)
        took = time.monotonic() - began
        said.seek(0)
        text = said.read().decode(errors="replace")
    return {
        "code": os.waitstatus_to_exitcode(status),
        "said": text.strip(),
        "seconds": round(took, 2),
        "cpu": round(used.ru_utime + used.ru_stime, 2),
        "megabytes": round(used.ru_maxrss / 1024 - resident),
    }


def warm_up(folder: Path) -> None:
    """Let all that reads files be loaded."""
    pictures = two_pictures(folder)
    for suffix in (".zarr", ".npz", ".zarr.zip"):
        lc.load(lc.save(CUBE, folder / f"honest{suffix}"))
    lc.read_pictures(lc.save(np.zeros((2, 8, 8, 3), np.float32), folder / "honest.mp4"))
    for name in ("honest.tif", "honest.webp", "honest.jpg", "honest.gif"):
        Image.new("RGB", (8, 8)).save(folder / name)
        lc.read_pictures(folder / name, least=1)
    lc.read_pictures(pictures)
    lc.read_scene("gems")
    import lightcube.cli.check
    import lightcube.cli.info
    import lightcube.cli.play
    import lightcube.cli.publish
    import lightcube.cli.report
    import lightcube.cli.score
    import lightcube.cli.solve
    import lightcube.cli.trace
    import lightcube.cli.view  # noqa: F401
    import tests.hostile.bombs  # noqa: F401


def serve(folder: Path, asked: Iterable[str], doors: int | None) -> None:
    """Print a line for each bomb that is asked for, given to so many of its doors."""
    (folder / "warm").mkdir(parents=True)
    warm_up(folder / "warm")
    made = all_bombs()
    for number, name in enumerate(asked):
        make, reading = made[name]
        at = folder / str(number)
        at.mkdir()
        path = make(at)
        before = {item.name for item in at.iterdir()}
        for door in reading[:doors]:
            found = given(command(door, path))
            left = sorted({item.name for item in at.iterdir()} - before)
            print(json.dumps({"name": name, "door": door, **found, "left": left}), flush=True)  # noqa: T201
        shutil.rmtree(at)


if __name__ == "__main__":
    if sys.argv[2:] == ["-"]:
        serve(Path(sys.argv[1]), (line.rstrip("\n") for line in sys.stdin), 1)
    else:
        serve(Path(sys.argv[1]), all_bombs(), None)
