"""Scene files, the meshes they name, and the scenes that ship with the package."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

from lightcube.errors import InputError
from lightcube.io._files import refuse_gone_folder
from lightcube.io._toml import read_tables
from lightcube.io.meshes import read_mesh
from lightcube.optics.checks import checked
from lightcube.scene.description import Mesh, parse
from lightcube.scene.scene import Scene


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
    try:
        path.stat()
    except FileNotFoundError as error:
        refuse_gone_folder(error)
        names = ", ".join(scene_names())
        raise InputError(f"there is no {path}: give a scene's .toml file, or one of {names}") from error
    except OSError:  # told where it is read
        pass
    description = parse(read_tables(path, path.name), path.name)
    meshes = {
        shape.file: read_mesh(path.parent / shape.file, f"{path.name}: shapes.{i}.file")
        for i, shape in enumerate(description.shapes)
        if isinstance(shape, Mesh)
    }
    return Scene(description, meshes, path.name)
