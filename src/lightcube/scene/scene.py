"""A scene: its description and the triangles of the meshes that it names."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Floats, Reals, owned
from lightcube.optics.checks import check_fields
from lightcube.scene.description import Mesh, SceneFile, Text, parse
from lightcube.scene.letters import text_mesh
from lightcube.scene.meshes import DoubtfulMesh, is_closed, outward, tidy


@dataclass(frozen=True, eq=False)
class Scene:
    """Moving shapes, lights and a camera; time runs from 0 to 1 over the animation.

    Parameters
    ----------
    description
        What the scene file says, see docs/scenes.md.
    meshes
        Triangles ``(n, 3, 3)`` of each mesh file that the description names, by the name written there.
    name
        The scene's name, for messages.

    Warns
    -----
    DoubtfulMesh
        Where an opaque mesh is not closed.

    Raises
    ------
    InputError
        Where a mesh is missing, has no extent, or is not closed but is to be glass.
    """

    description: SceneFile
    meshes: Mapping[str, Floats] = field(default_factory=dict)
    name: str = "scene"
    #: Triangles ``(n, 3, 3)`` of each mesh or text among the shapes, by the shape's number.
    triangles: Mapping[int, Reals] = field(init=False)

    def __post_init__(self) -> None:
        check_fields(self)
        object.__setattr__(self, "meshes", {name: owned(mesh, np.float64) for name, mesh in self.meshes.items()})
        made: dict[int, Reals] = {}
        for i, shape in enumerate(self.description.shapes):
            if isinstance(shape, Text):
                try:
                    made[i] = tidy(text_mesh(shape.text, shape.height, shape.depth))
                except InputError as error:
                    raise InputError(f"{self.name}: shapes.{i}.text: {error}") from None
            elif isinstance(shape, Mesh):
                made[i] = self._mesh(i, shape)
        object.__setattr__(self, "triangles", {number: owned(mesh, np.float64) for number, mesh in made.items()})

    def _mesh(self, i: int, shape: Mesh) -> Reals:
        where = f"{self.name}: shapes.{i}.file"
        if shape.file not in self.meshes:
            raise InputError(f"{where}: the mesh {shape.file} was not given: name its triangles in meshes")
        triangles = tidy(self.meshes[shape.file], f"{where}: {shape.file}")
        if is_closed(triangles):
            return outward(triangles)
        if shape.glass is not None:
            raise InputError(
                f"{where}: {shape.file} is not closed, so glass has no inside: mend its holes and flipped faces, "
                f"or leave out glass"
            )
        warnings.warn(
            f"{where}: {shape.file} is not closed: it is shown as a surface that can be seen from both sides",
            DoubtfulMesh,
            stacklevel=5,
        )
        return triangles

    def __repr__(self) -> str:
        return f"<scene {self.name!r} of {len(self.description.shapes)} shapes>"


def scene_from_tables(
    data: Mapping[str, Any], meshes: Mapping[str, Floats] | None = None, name: str = "scene"
) -> Scene:
    """Scene from the tables of a scene file; `InputError` names the key that is wrong and what is allowed."""
    return Scene(parse(data, name), meshes or {}, name)
