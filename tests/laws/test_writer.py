"""Laws that every row of the table of outputs keeps: what it refuses, what comes back, and nothing left behind."""

import errno
import json
import os
import re
import resource
import shutil
import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast
from uuid import uuid4

import numpy as np
import pytest
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from lightcube.errors import InputError
from lightcube.io import Output, read_dyes, read_pictures, read_relief, read_shape, save
from lightcube.io.outputs import KINDS, Kind
from lightcube.io.printable import read_written
from lightcube.jobs.reading import load
from lightcube.optics.cube import Cube
from lightcube.optics.dyes import Dyes
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.transfer import from_levels, to_uint8
from lightcube.solids.mesh import Mesh
from lightcube.solids.relief import Relief, ReliefRecipe
from lightcube.solids.relief_mesh import relief_mesh
from lightcube.solids.shape import Shape
from lightcube.solids.silhouettes import FINE, Silhouettes

#: How much a kind that keeps less than all may be off: the mean over a picture, in levels.
LOSSY = {".mp4": 3.0, ".gif": 6.0, ".jpg": 3.0, ".jpeg": 3.0, ".webp": 3.0}


@dataclass(frozen=True)
class Example:
    """Things of one kind: the first and the second, as they are written at a suffix, and what is found at a path."""

    made: Callable[[int, str], Any]
    found: Callable[[Any, Path, str], None]


def noise(number: int, *shape: int) -> NDArray[np.uint8]:
    return np.random.default_rng(number).integers(0, 256, (*shape, 3), dtype=np.uint8)


def a_cube(number: int, suffix: str) -> Cube:
    shape = ((9, 11, 13), (13, 9, 11))[number]
    grid = Grid(shape, 0.3)
    random = np.random.default_rng(number)
    views = turntable(grid, [10.0, 41.7], elevation_deg=20, picture_shape=(3, 5))
    return Cube(random.random((3, *shape), dtype=np.float32), grid, views, random.random((2, 3)) + 0.1)


def is_the_cube(cube: Cube, path: Path, suffix: str) -> None:
    np.testing.assert_array_equal(load(path).extinction, cube.extinction)


def a_mesh(number: int, suffix: str) -> Mesh:
    """A lumpy ball."""
    around, up = 9 + number, 7
    turn, rise = np.arange(around) / around * 2 * np.pi, (np.arange(up) + 1) / (up + 1) * np.pi
    radius = np.random.default_rng(number).uniform(9, 11, (up, around))
    ring = np.stack([np.outer(np.sin(rise), np.cos(turn)), np.outer(np.sin(rise), np.sin(turn))], axis=2)
    net = np.concatenate([radius[..., None] * ring, radius[..., None] * np.cos(rise)[:, None, None]], axis=2)
    vertices = np.concatenate([net.reshape(-1, 3), [(0, 0, 10), (0, 0, -10)]])
    faces = [(len(vertices) - 2, j, (j + 1) % around) for j in range(around)]
    low = (up - 1) * around
    faces += [(len(vertices) - 1, low + (j + 1) % around, low + j) for j in range(around)]
    for i in range(up - 1):
        for j in range(around):
            a, b = i * around + j, i * around + (j + 1) % around
            faces += [(a, a + around, b), (b, a + around, b + around)]
    return Mesh(vertices, np.array(faces))


def is_the_mesh(mesh: Mesh, path: Path, suffix: str) -> None:
    read = read_written(path)
    np.testing.assert_array_equal(read.triangles, mesh.vertices_mm.astype(np.float32)[mesh.faces])
    assert read.is_watertight


def a_relief(number: int, suffix: str) -> Relief:
    """Its mesh is far larger than its columns."""
    random = np.random.default_rng(number)
    shape = (40 + number, 33) if suffix.startswith((".png", ".relief")) else (11 + number, 7)
    recipe = ReliefRecipe(side=12, pitch_mm=0.3 + number, steepest_px=4.0 if number else np.inf, black=0.4)
    return Relief(random.uniform(0, 7, shape), random.random((2 + number, *shape)), recipe, provenance={"of": number})


def is_the_relief(relief: Relief, path: Path, suffix: str) -> None:
    if suffix == ".png":
        with Image.open(path) as image:
            levels = np.asarray(image) / 65535
            assert image.mode.startswith("I;16")
            assert image.info["Description"].startswith(f"heights of a relief: white is {relief.recipe.top_mm:g} mm")
        np.testing.assert_allclose(levels * relief.recipe.top_mm, relief.heights_mm, atol=relief.recipe.top_mm / 65535)
    elif suffix.startswith(".relief.zarr"):
        read = read_relief(path)
        for name in ("heights_px", "wanted"):
            np.testing.assert_array_equal(getattr(read, name), getattr(relief, name))
        for name in ("recipe", "names", "is_colour", "cell", "provenance"):
            assert getattr(read, name) == getattr(relief, name)
    else:
        is_the_mesh(relief_mesh(relief), path, suffix)


def a_shape(number: int, suffix: str) -> Shape:
    """A body of noise; its mesh is far larger than its field."""
    sides = ((9, 11, 13), (13, 9, 11)) if suffix.startswith(".shape") else ((4, 5, 6), (6, 4, 5))
    grid = Grid(sides[number], 0.3, 1.5)
    rig = turntable(grid, [10.0, 41.7], elevation_deg=20, picture_shape=(3, 5))
    random = np.random.default_rng(number)
    field = np.rint(64 * random.normal(size=grid.shape)) / 64 + 1 / 256
    given = Silhouettes(random.random((2, 3 * FINE, 5 * FINE)) < 0.5, rig, ("a", "ünï"))
    return Shape(field.astype(np.float32), grid, given, {"size_mm": 2.5, "names": ["a"]})


def is_the_shape(shape: Shape, path: Path, suffix: str) -> None:
    if not suffix.startswith(".shape.zarr"):
        is_the_mesh(shape.mesh.standing(), path, suffix)
        return
    read = read_shape(path)
    np.testing.assert_array_equal(read.field, shape.field)
    np.testing.assert_array_equal(read.silhouettes.inside, shape.silhouettes.inside)
    np.testing.assert_array_equal(read.rig.views.lamps, shape.rig.views.lamps)
    assert (read.grid, read.names, read.provenance) == (shape.grid, shape.names, shape.provenance)


def some_pictures(number: int, suffix: str) -> NDArray[np.float32]:
    return from_levels(noise(number, 1 if suffix == ".png" else 4 - number, 31 + number, 65))


def are_the_pictures(pictures: NDArray[np.float32], path: Path, suffix: str) -> None:
    if suffix == ".npy":
        np.testing.assert_array_equal(np.load(path), pictures)
        return
    read = np.stack([to_uint8(image) for image in read_pictures(path, least=1).images])
    alike(read, to_uint8(pictures), 0.0 if suffix == ".webp" else LOSSY.get(suffix, 0.0))


def is_the_picture(picture: NDArray[np.uint8], path: Path, suffix: str) -> None:
    with Image.open(path) as image:
        assert image.format == {".png": "PNG", ".webp": "WEBP"}.get(suffix, "JPEG")
        alike(np.asarray(image.convert("RGB"))[None], picture[None], LOSSY.get(suffix, 0.0))


def alike(read: NDArray[np.uint8], wanted: NDArray[np.uint8], least: float) -> None:
    assert read.shape == wanted.shape
    if not least:
        np.testing.assert_array_equal(read, wanted)
    np.testing.assert_allclose(read.mean(axis=(1, 2)), wanted.mean(axis=(1, 2)), atol=least)


def a_text(number: int, suffix: str) -> str:
    opening = {".html": "<!doctype html>", ".htm": "<!doctype html>", ".svg": "<svg>"}[suffix]
    return opening + "".join(f"ünï 日本 {number} {place}\n" for place in range(400))


def is_the_text(text: str, path: Path, suffix: str) -> None:
    assert path.read_bytes() == text.encode()


def a_plot(number: int, suffix: str) -> Figure:
    figure = Figure(figsize=(3 + number, 2))
    figure.subplots().plot(np.random.default_rng(number).random(300))
    return figure


def is_the_plot(figure: Figure, path: Path, suffix: str) -> None:
    wide, high = figure.get_size_inches()
    if suffix == ".svg":
        assert f'width="{72 * wide:g}pt" height="{72 * high:g}pt"' in path.read_text()
        return
    with Image.open(path) as image:
        assert (image.format, image.size) == ("PNG", (100 * wide, 100 * high))


def a_document(number: int, suffix: str) -> dict[str, Any]:
    return {"ünï": [f"日本 {number}"] * 400}


def is_the_document(document: dict[str, Any], path: Path, suffix: str) -> None:
    assert json.loads(path.read_text(encoding="utf-8")) == document


def a_material(number: int, suffix: str) -> Dyes:
    """With a dot gain of many points: files of two sizes, both larger than two thousand bytes."""
    gain = tuple(np.stack([at := np.linspace(0, 1, 90), at**0.9], axis=1) for _ in range(4 - number))
    return replace(read_dyes(("cmyk-film", "cmy-film")[number]), gain=gain)


def is_the_material(dyes: Dyes, path: Path, suffix: str) -> None:
    np.testing.assert_allclose(read_dyes(path).extinction, dyes.extinction, rtol=1e-5)


EXAMPLES: Mapping[Kind, Example] = {
    "cube": Example(a_cube, is_the_cube),
    "mesh": Example(a_mesh, is_the_mesh),
    "relief": Example(a_relief, is_the_relief),
    "shape": Example(a_shape, is_the_shape),
    "pictures": Example(some_pictures, are_the_pictures),
    "page": Example(a_text, is_the_text),
    "drawing": Example(a_text, is_the_text),
    "plot": Example(a_plot, is_the_plot),
    "picture": Example(lambda number, suffix: noise(number, 65, 97 + number), is_the_picture),
    "document": Example(a_document, is_the_document),
    "material": Example(a_material, is_the_material),
}
ROWS = [(kind, suffix) for kind, row in KINDS.items() for suffix in row.writers]
every_row = pytest.mark.parametrize(("kind", "suffix"), ROWS, ids=[f"{kind}{suffix}" for kind, suffix in ROWS])


def refusals(kind: Kind, suffix: str, path: Path | str, *, overwrite: bool = False) -> Iterator[Callable[[], object]]:
    """All that would write to a path, or is asked whether it could."""
    thing, output = EXAMPLES[kind].made(1, suffix), Output(path, kind, overwrite)
    return iter((lambda: save(thing, path, overwrite=overwrite), lambda: output.write(thing), output.check))


def content(folder: Path) -> dict[str, bytes | None]:
    """All that is in a folder, hidden things too."""
    found = sorted(folder.rglob("*"))
    return {str(each.relative_to(folder)): each.read_bytes() if each.is_file() else None for each in found}


def test_every_kind_has_an_example() -> None:
    assert set(EXAMPLES) == set(KINDS)


@every_row
def test_what_is_written_is_found_there_and_nothing_else(tmp_path: Path, kind: Kind, suffix: str) -> None:
    example = EXAMPLES[kind]
    thing, path = example.made(0, suffix), tmp_path / f"a{suffix}"
    assert save(thing, path) == path
    example.found(thing, path, suffix)
    other = tmp_path / f"b{suffix}"
    Output(other, kind).check()
    assert not other.exists()
    Output(str(other), kind).write(thing)
    example.found(thing, other, suffix)
    assert sorted(each.name for each in tmp_path.iterdir()) == [path.name, other.name]


@every_row
def test_suffixes_are_known_in_any_case(tmp_path: Path, kind: Kind, suffix: str) -> None:
    example, path = EXAMPLES[kind], tmp_path / f"a{suffix.upper()}"
    thing = example.made(0, suffix)
    Output(path, kind).check()
    assert save(thing, path) == path
    assert [each.name for each in tmp_path.iterdir()] == [path.name]
    example.found(thing, path, suffix)


@every_row
def test_what_is_there_is_replaced_as_a_whole_and_only_when_asked(tmp_path: Path, kind: Kind, suffix: str) -> None:
    example, path = EXAMPLES[kind], tmp_path / f"a{suffix}"
    old, new = (example.made(number, suffix) for number in (0, 1))
    save(old, path)
    before = content(tmp_path)
    for refused in refusals(kind, suffix, path):
        with pytest.raises(InputError, match=r"^[^\n]*exists already: .*--overwrite[^\n]*$"):
            refused()
    assert content(tmp_path) == before
    Output(path, kind, overwrite=True).check()
    assert content(tmp_path) == before
    assert save(new, path, overwrite=True) == path
    example.found(new, path, suffix)
    save(new, tmp_path / f"fresh{suffix}")
    names = [
        {name.partition("/")[2] for name in content(tmp_path) if name.partition("/")[0] == top.name}
        for top in (path, tmp_path / f"fresh{suffix}")
    ]
    assert names[0] == names[1]


@every_row
def test_unknown_suffixes_are_refused(tmp_path: Path, kind: Kind, suffix: str) -> None:
    known = [each for each in KINDS[kind].writers if each]
    names = ["a.xyz", f"a{known[0]}x", "a.zip", "a.zarr.gz", ""]
    if "" not in KINDS[kind].writers:  # which else is a folder of that name
        names += ["a", known[0]]
    for name in names:
        for refused in refusals(kind, suffix, tmp_path / name if name else ""):
            with pytest.raises(InputError, match=r"^[^\n]* has no suffix that [^\n]* can have: use [^\n]*$") as caught:
                refused()
            assert all(each in str(caught.value) for each in known)
    assert content(tmp_path) == {}


@every_row
def test_a_folder_that_is_missing_is_not_made(tmp_path: Path, kind: Kind, suffix: str) -> None:
    for refused in refusals(kind, suffix, tmp_path / "missing" / f"a{suffix}", overwrite=True):
        with pytest.raises(InputError, match=r"^there is no folder [^\n]*missing to write [^\n]*: make it first$"):
            refused()
    assert content(tmp_path) == {}


@every_row
def test_a_folder_of_something_else_is_never_replaced(tmp_path: Path, kind: Kind, suffix: str) -> None:
    path = tmp_path / f"a{suffix}"
    path.mkdir()
    (path / "thesis.tex").write_text("years of work")
    (path / "zarr.json").write_text('{"attributes": {"another": 1}}')
    before = content(tmp_path)
    for refused in refusals(kind, suffix, path, overwrite=True):
        with pytest.raises(
            InputError, match=r"^[^\n]*is a folder of something else and is not|is a folder, and [^\n]*$"
        ):
            refused()
    assert content(tmp_path) == before


@every_row
def test_no_folder_takes_the_place_of_a_file_and_no_file_that_of_a_folder(
    tmp_path: Path, kind: Kind, suffix: str
) -> None:
    """Even of one that is empty, or is of the kind but for its suffix."""
    example, path = EXAMPLES[kind], tmp_path / f"a{suffix}"
    save(example.made(0, suffix), path)
    is_file = path.is_file()
    path.rename(tmp_path / "kept")
    for there in ("empty", "cube", "pictures") if is_file else ("file",):
        if there == "empty":
            path.mkdir()
        elif there == "file":
            path.write_bytes(b"")
        else:
            save(
                a_cube(0, "") if there == "cube" else some_pictures(0, ""), tmp_path / f"x{'.zarr' * (there == 'cube')}"
            )
            next(tmp_path.glob("x*")).rename(path)
        before = content(tmp_path)
        for refused in refusals(kind, suffix, path, overwrite=True):
            with pytest.raises(InputError, match=r"is a (folder|file), and what is written is a (folder|file): "):
                refused()
        assert content(tmp_path) == before
        path.unlink() if there == "file" else shutil.rmtree(path)


@every_row
def test_what_a_killed_program_has_finished_is_recognised(tmp_path: Path, kind: Kind, suffix: str) -> None:
    """Its workplace is still there: the same again succeeds and tidies, anything else is refused as ever."""
    example, path = EXAMPLES[kind], tmp_path / f"a{suffix}"
    old, new = (example.made(number, suffix) for number in (0, 1))
    save(old, path)
    before = content(tmp_path)
    for thing in (old, new):
        workplace = tmp_path / f".lightcube-a{suffix}-abcdefgh"
        workplace.mkdir()
        (workplace / "owner").touch()
        Output(path, kind).check()
        if thing is old:
            assert save(example.made(0, suffix), path) == path
        else:
            with pytest.raises(InputError, match="exists already"):
                save(new, path)
        assert content(tmp_path) == before


@every_row
def test_a_name_that_is_too_long_is_a_sentence(tmp_path: Path, kind: Kind, suffix: str) -> None:
    for refused in refusals(kind, suffix, tmp_path / ("x" * 300 + suffix)):
        with pytest.raises(InputError, match=r"^writing [^\n]* failed: File name too long$"):
            refused()
    assert content(tmp_path) == {}


FAILURES = [
    (KeyboardInterrupt(), KeyboardInterrupt, "^$"),
    (ValueError("a mistake"), ValueError, "^a mistake$"),
    (InputError("one sentence"), InputError, "^one sentence$"),
    (OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)), InputError, r"^no space is left on the disk of [^\n]*$"),
]


@every_row
@pytest.mark.parametrize(("raised", "caught", "said"), FAILURES, ids=lambda each: getattr(each, "__name__", ""))
@pytest.mark.parametrize("old", [False, True])
def test_a_writer_that_fails_leaves_the_old_state(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    kind: Kind,
    suffix: str,
    raised: BaseException,
    caught: type[BaseException],
    said: str,
    old: bool,
) -> None:
    example, path = EXAMPLES[kind], tmp_path / f"a{suffix}"
    if old:
        save(example.made(0, suffix), path)
    before = content(tmp_path)
    writers = cast(dict[str, Any], KINDS[kind].writers)
    real = writers[suffix]

    def failing(*arguments: Any, **options: Any) -> None:
        real(*arguments, **options)
        raise raised

    monkeypatch.setitem(writers, suffix, failing)
    with pytest.raises(caught, match=said):
        save(example.made(1, suffix), path, overwrite=old)
    assert content(tmp_path) == before


@contextmanager
def files_of_at_most(size: int) -> Iterator[None]:
    """Let the system refuse to write more bytes than that into a file."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        signal.signal(signal.SIGXFSZ, before)


@every_row
@pytest.mark.parametrize("old", [False, True])
def test_a_refusal_of_the_system_in_the_middle_leaves_the_old_state(
    tmp_path: Path, kind: Kind, suffix: str, old: bool
) -> None:
    example, path = EXAMPLES[kind], tmp_path / f"a{suffix}"
    new = example.made(1, suffix)
    if old:
        save(example.made(0, suffix), path)
    before = content(tmp_path)
    with files_of_at_most(2000), pytest.raises(InputError, match=r"^writing [^\n]* failed: File too large$"):
        save(new, path, overwrite=old)
    assert content(tmp_path) == before


@every_row
def test_no_thread_stays_behind(tmp_path: Path, kind: Kind, suffix: str) -> None:
    before, example, path = threading.active_count(), EXAMPLES[kind], tmp_path / f"a{suffix}"
    thing = example.made(0, suffix)
    save(thing, path)
    example.found(thing, path, suffix)
    assert threading.active_count() == before


@every_row
def test_a_url_does_as_well(tmp_path: Path, kind: Kind, suffix: str) -> None:
    fsspec = pytest.importorskip("fsspec", reason="URLs need the extra remote")
    example, url = EXAMPLES[kind], f"memory://{uuid4().hex}/a{suffix}"
    old, new = (example.made(number, suffix) for number in (0, 1))
    Output(url, kind).check()
    assert save(old, url) == url
    for refused in refusals(kind, suffix, url):
        with pytest.raises(InputError, match=rf"^{re.escape(url)} exists already"):
            refused()
    Output(url, kind, overwrite=True).write(new)
    store, path = fsspec.url_to_fs(url)
    copy = tmp_path / f"a{suffix}"
    store.get(path, str(copy), recursive=store.isdir(path))
    example.found(new, copy, suffix)


def test_what_nobody_can_write_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="save has no way to write int"):
        save(cast(Any, 5), tmp_path / "a.json")
    with pytest.raises(InputError, match="a cube is not made of str"):
        Output(tmp_path / "a.zarr", "cube").write("text")
    with pytest.raises(TypeError, match="fps"):
        save(a_cube(0, ""), tmp_path / "a.npz", fps=3)
    assert content(tmp_path) == {}


def test_a_text_is_a_page_or_a_drawing_by_its_suffix(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"a page or a drawing can have: use one of \.html, \.htm, \.svg"):
        save("text", tmp_path / "a.pdf")
    assert content(tmp_path) == {}
