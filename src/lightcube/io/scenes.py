"""Scene files, the meshes they name, and the scenes that ship with the package."""

from __future__ import annotations

import tomllib
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.optics.checks import checked
from lightcube.scene.description import Mesh, parse
from lightcube.scene.scene import Scene

_MESH_SUFFIXES = (".stl", ".obj")


def scene_names() -> list[str]:
    """Names of the scenes that ship with the package, sorted."""
    library = resources.files("lightcube.scene") / "library"
    return sorted(Path(entry.name).stem for entry in library.iterdir() if entry.name.endswith(".toml"))


@checked
def read_scene(path_or_name: str | Path) -> Scene:
    """Read a scene file (TOML), or one of the shipped scenes by its name.

    Parameters
    ----------
    path_or_name
        A path ending in ``.toml``, or one of `scene_names`. Meshes are looked up relative to the scene file.

    Raises
    ------
    InputError
        Where the file cannot be read, is no scene, or names a mesh that cannot be read.
    """
    path = Path(path_or_name)
    if path.suffix.lower() != ".toml":
        if str(path_or_name) not in scene_names():
            raise InputError(
                f"there is no scene {str(path_or_name)!r}: give a .toml file, or one of {', '.join(scene_names())}"
            )
        path = Path(str(resources.files("lightcube.scene") / "library" / f"{path_or_name}.toml"))
    description = parse(_tables(path), path.name)
    meshes = {
        shape.file: _read_mesh(path.parent / shape.file, f"{path.name}: shapes.{i}.file")
        for i, shape in enumerate(description.shapes)
        if isinstance(shape, Mesh)
    }
    return Scene(description, meshes, path.name)


def _tables(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"cannot read the scene {path}: {error.strerror or error}") from None
    except (UnicodeDecodeError, tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(f"{path.name} is not a TOML file: {error}") from None


def _read_mesh(path: Path, where: str) -> NDArray[np.float64]:
    """Triangles ``(n, 3, 3)`` of a mesh file; `where` names the key that asked for it."""
    if path.suffix.lower() not in _MESH_SUFFIXES:
        raise InputError(f"{where}: {path.name} is no mesh: use a file ending in {' or '.join(_MESH_SUFFIXES)}")
    if not path.is_file():
        raise InputError(f"{where}: there is no file {path}")
    try:
        import trimesh
    except ImportError:
        raise InputError(f"{where}: reading meshes needs one more package: pip install 'lightcube[mesh]'") from None
    try:
        mesh = trimesh.load_mesh(path, process=False)
        triangles = np.asarray(mesh.triangles, dtype=np.float64)
    except Exception:  # the reader raises whatever a damaged file makes it stumble over
        raise InputError(f"{where}: {path.name} cannot be read as a mesh: it may be damaged, export it again") from None
    if triangles.size == 0:
        raise InputError(f"{where}: {path.name} holds no triangles: give a mesh of at least one")
    return triangles
