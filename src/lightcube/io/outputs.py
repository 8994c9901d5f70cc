"""What can be written: one table from kind and suffix to a writer, and outputs that are asked before long work."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypeVar, Unpack

import numpy as np

from lightcube.errors import InputError
from lightcube.io import cubes, documents, materials, movies, printable, reliefs, shapes
from lightcube.io._files import (
    RELIEF_SUFFIX,
    SHAPE_SUFFIX,
    Replaceable,
    Writer,
    check_free,
    suffix_entry,
    written_whole,
)
from lightcube.io._places import Place, place
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.optics.dyes import Dyes
from lightcube.solids.mesh import Mesh
from lightcube.solids.relief import Relief
from lightcube.solids.shape import Shape

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Given = TypeVar("Given", bound=str | Path)

#: What can be written, by name.
Kind = Literal[
    "cube", "mesh", "shape", "relief", "pictures", "page", "drawing", "plot", "picture", "document", "material"
]

#: Whatever is of one of the kinds.
Thing: TypeAlias = (
    "Cube | Dyes | Mesh | Shape | Relief | str | movies.Picture | Iterable[movies.Frame] | Mapping[str, Any]"
    "| movies.Levels | Figure"
)


@dataclass(frozen=True)
class Row:
    """All that is known of one kind.

    Parameters
    ----------
    called
        What sentences call it.
    writers
        By suffix; the empty one is that of names without a suffix.
    takes
        Tells of a thing whether it is of the kind.
    folders
        By suffix, for those that are written as folders: tells of an existing one whether it is of the kind. No other
        folder is ever replaced.
    """

    called: str
    writers: Mapping[str, Writer]
    takes: Callable[[Any], bool]
    folders: Mapping[str, Replaceable] = field(default_factory=dict)

    def writer(self, at: Place) -> Writer:
        """The writer for a place, by its suffix, or `InputError`."""
        return suffix_entry(at, self.writers, self.called)

    def replaceable(self, at: Place) -> Replaceable:
        """Which folders may be replaced at a place; None where a file is written."""
        return suffix_entry(at, {**dict.fromkeys(self.writers), **self.folders}, self.called)


def _is_picture(thing: Any) -> bool:
    """Whether something is one picture of 8-bit levels, not several of linear light."""
    return isinstance(thing, np.ndarray) and thing.dtype == np.uint8 and thing.ndim == 3


#: The table; of the kinds that take a thing, `save` chooses the first one that knows the suffix.
KINDS: Mapping[Kind, Row] = {
    "cube": Row("a cube", cubes.WRITERS, lambda thing: isinstance(thing, Cube), {".zarr": cubes.is_cube_folder}),
    "mesh": Row("a mesh", printable.WRITERS, lambda thing: isinstance(thing, Mesh)),
    "relief": Row(
        "a relief",
        reliefs.WRITERS,
        lambda thing: isinstance(thing, Relief),
        {RELIEF_SUFFIX: reliefs.is_relief_folder},
    ),
    "shape": Row(
        "a shape", shapes.WRITERS, lambda thing: isinstance(thing, Shape), {SHAPE_SUFFIX: shapes.is_shape_folder}
    ),
    "page": Row("a page", dict.fromkeys((".html", ".htm"), documents.write_text), lambda thing: isinstance(thing, str)),
    "drawing": Row("a drawing", {".svg": documents.write_text}, lambda thing: isinstance(thing, str)),
    "plot": Row("a plot", documents.PLOTS, lambda thing: hasattr(thing, "savefig")),
    "picture": Row("a picture", documents.PICTURES, _is_picture),
    "material": Row("a material", materials.WRITERS, lambda thing: isinstance(thing, Dyes)),
    "document": Row("a document", {".json": documents.write_json}, lambda thing: isinstance(thing, Mapping)),
    "pictures": Row(
        "a movie",
        movies.WRITERS,
        lambda thing: isinstance(thing, Iterable) and not (isinstance(thing, str | Mapping) or _is_picture(thing)),
        {"": movies.is_pictures_folder},
    ),
}


@dataclass(frozen=True)
class Output:
    """A place that something of one kind will be written to.

    Parameters
    ----------
    path
        A path or a URL.
    kind
        One of `KINDS`.
    overwrite
        Whether what stands there may be replaced: an existing file, or an existing folder of the kind.
    """

    path: str | Path
    kind: Kind
    overwrite: bool = False

    def check(self) -> None:
        """Raise `InputError` unless the output could be written: ask before long work."""
        at, row = place(self.path), KINDS[self.kind]
        check_free(at, overwrite=self.overwrite, replaceable=row.replaceable(at))

    @checked
    def write(self, thing: Thing, **options: Unpack[movies.Options]) -> None:
        """Write something of the kind; takes and raises what `save` does."""
        if not KINDS[self.kind].takes(thing):
            raise InputError(f"{KINDS[self.kind].called} is not made of {type(thing).__name__}: give what `save` takes")
        _write(self, thing, options)


@checked
def save(thing: Thing, path: Given, *, overwrite: bool = False, **options: Unpack[movies.Options]) -> Given:
    """Save a thing by the suffix of `path`; the file appears when it is whole.

    Parameters
    ----------
    thing
        * A cube: ``.zarr`` (a folder, OME-Zarr 0.5: napari and others open it as it is), ``.zarr.zip`` (the same in
          one file), or ``.npz`` (NumPy's own: `extinction`, `targets`, and the rest as JSON in `lightcube`).
        * A mesh, in mm: ``.stl`` (binary), ``.3mf``, ``.obj`` or ``.ply`` (binary), coordinates in float32. It is read
          back before it gets its name, and is then as closed and of the same volume to a millionth.
        * A relief: ``.relief.zarr`` (a folder with all that is known of it), ``.relief.zarr.zip`` (the same in one
          file), ``.png`` (its heights, 16 bits, white the highest that it may be), or the mesh of it as above.
        * A shape: ``.shape.zarr`` (a folder, all of it), ``.shape.zarr.zip`` (the same in one file), or its mesh,
          standing on z = 0, as meshes are.
        * Pictures, ``(view, row, column, 3)`` or one ``(row, column, 3)`` after the other, in linear light, 1 = white,
          or 8-bit display levels, which are written as they are:
          ``.png`` for a single one, ``.mp4`` (H.264, visually lossless; at an even `scale` in 4:2:0, which every player
          knows, else in 4:4:4), ``.webm`` (VP9, lossless), ``.gif`` (256 colours for all pictures), ``.webp`` and
          ``.apng`` (lossless), ``.npy`` (float32 linear light, never clipped), or no suffix for a folder of PNGs, with
          a `views.toml` where `views` or `names` are given. Of pictures that are made one by one, only one is in
          memory at a time.
        * The text of a page, ``.html`` or ``.htm``, or of a drawing, ``.svg``.
        * A matplotlib figure, ``.png`` or ``.svg``.
        * One picture ``(row, column, 3)`` of 8-bit sRGB, such as a contact sheet: ``.png``, ``.webp``, ``.jpg``.
        * A mapping, as a JSON document: ``.json``.
    path
        It may be a URL such as ``s3://bucket/cube.zarr``.
    overwrite
        Whether an existing file, or an existing folder with a cube or with pictures in it, is replaced.
    **options
        Of pictures, as `lightcube.io.movies.Options` lists them: `fps` (10), `scale` (1), `transfer` (sRGB), `views`,
        `names`, `shared`, and `count`, which pictures without a length need.

    Returns
    -------
    `path`.

    Warns
    -----
    ClippedPictures
        Once, with the number of values of pictures that were clipped to black or white.

    Raises
    ------
    InputError
        Where the suffix is unknown, the target exists, the disk is full, or the pictures cannot be used.
        Nothing is left behind.

    Notes
    -----
    All arrays and numbers of a cube come back bit for bit. Its `scores` and `provenance` come back as JSON's types:
    tuples as lists, NaN and infinities as None, anything that JSON does not know as its text.

    Examples
    --------
    >>> import numpy as np, lightcube as lc, os, tempfile
    >>> grid = lc.Grid((3, 5, 7))
    >>> cube = lc.Cube(np.full((3, 3, 5, 7), 0.1), grid, lc.turntable(grid, [0, 90]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     kept = lc.save(cube, os.path.join(folder, "cube.npz"))
    ...     page = lc.save(lc.page(cube, "Grey"), os.path.join(folder, "cube.html"))
    ...     os.path.basename(page), np.array_equal(lc.load(kept).extinction, cube.extinction)
    ('cube.html', True)
    """
    _write(Output(path, _kind(thing, place(path)), overwrite), thing, options)
    return path


def _kind(thing: Thing, at: Place) -> Kind:
    """The kind that a thing is written as at a place; `InputError` where none of its kinds has such a suffix."""
    kinds: list[Kind] = [kind for kind, row in KINDS.items() if row.takes(thing)]
    if not kinds:
        raise InputError(
            f"save has no way to write {type(thing).__name__}: "
            "give a Cube, a Mesh, a Shape, a Relief, pictures, text, a figure or a mapping"
        )
    if len(kinds) == 1:
        return kinds[0]
    known: dict[str, Kind] = {}
    for kind in kinds:
        for suffix in KINDS[kind].writers:
            known.setdefault(suffix, kind)
    return suffix_entry(at, known, " or ".join(KINDS[kind].called for kind in kinds))


def write_together(*things: tuple[Output, Thing]) -> None:
    """Write things to outputs; none of them gets its name before all are made, nor where one cannot be.

    The folders in which they are made go when all have their names: after a kill in between, the same again finishes.
    """
    for output, _ in things:
        output.check()  # all of them first: whoever makes one tidies what tells of the others
    with ExitStack() as stack:
        made = [stack.enter_context(_made(output, thing, {})) for output, thing in things]
        for _, give_its_name in made:
            give_its_name()


def _write(output: Output, thing: Thing, options: movies.Options) -> None:
    """Write to an output, whole or not at all, and warn the caller's caller of what was lost."""
    output.check()
    with _made(output, thing, options) as (lost, give_its_name):
        give_its_name()
    if lost is not None:
        warnings.warn(lost, stacklevel=4)


@contextmanager
def _made(output: Output, thing: Thing, options: movies.Options) -> Iterator[tuple[Warning | None, Callable[[], None]]]:
    """Make something, and yield what was lost and what gives it its name."""
    at, row = place(output.path), KINDS[output.kind]
    write = row.writer(at)
    with written_whole(at, overwrite=output.overwrite, replaceable=row.replaceable(at)) as (fresh, give_its_name):
        yield write(fresh, thing, **options), give_its_name
