"""A scene as the flat arrays that the kernels read."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lightcube.optics.transfer import decode
from lightcube.scene.description import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Group,
    Mesh,
    ParallelCamera,
    PerspectiveCamera,
    PointLight,
    SceneFile,
    Shape,
    Sphere,
    Text,
    Torus,
)
from lightcube.scene.kernels import solids
from lightcube.scene.kernels.render import Sight
from lightcube.scene.kernels.world import World
from lightcube.scene.meshes import tree
from lightcube.scene.motion import placement
from lightcube.scene.scene import Scene

#: A shape squeezed below this factor along any axis is not there.
_GONE = 1e-9
#: The darkest linear transmission that a glass colour may ask for at its depth; black would absorb without end.
_DARKEST = 1e-4


def linear(colour: Sequence[float]) -> NDArray[np.float64]:
    """Linear light, float64, of sRGB display values."""
    return np.asarray(decode(np.array(colour, dtype=np.float64)), dtype=np.float64)


def solid(shape: Shape) -> tuple[int, tuple[float, ...], float]:
    """``(kind, size, reach)`` of a shape as `lightcube.scene.kernels.solids` takes it.

    `reach` is the radius of a ball about the shape's centre that holds it.
    """
    match shape:
        case Sphere():
            return solids.SPHERE, (shape.radius,), shape.radius
        case Box():
            half = tuple(side / 2 for side in shape.size)
            return solids.BOX, half, math.hypot(*half)
        case Cylinder():
            size = (shape.radius, shape.radius, shape.height / 2)
            return solids.CONE, size, math.hypot(shape.radius, shape.height / 2)
        case Cone():
            size = (shape.radius, shape.top_radius, shape.height / 2)
            return solids.CONE, size, math.hypot(max(shape.radius, shape.top_radius), shape.height / 2)
        case Capsule():
            return solids.CAPSULE, (shape.radius, shape.length / 2), shape.radius + shape.length / 2
        case Torus():
            return solids.TORUS, (shape.radius, shape.tube), shape.radius + shape.tube
        case Mesh() | Text():
            return solids.MESH, (), 0.0
    return solids.PLANE, (), math.inf


@dataclass(frozen=True, eq=False)
class Compiled:
    """A scene's shapes, opaque ones first, ready to be placed at any instants."""

    shapes: tuple[Shape, ...]
    groups: Mapping[str, Group]
    #: Everything but the placements.
    world: World
    #: Balls that hold the shapes, in their own axes: ``(i, 3)`` and ``(i,)``.
    centres: NDArray[np.float64]
    reaches: NDArray[np.float64]

    def at(self, times: Sequence[float] | NDArray[np.floating]) -> World:
        """All shapes at each of `times`."""
        count = len(self.shapes)
        to_local, spheres = np.zeros((len(times), count, 3, 4)), np.full((len(times), count, 4), -1.0)
        for f, time in enumerate(times):
            for i, shape in enumerate(self.shapes):
                place = placement(shape, self.groups, float(time))
                stretch = np.linalg.svd(place[:, :3], compute_uv=False)
                if stretch[-1] <= _GONE:
                    continue
                inverse = np.linalg.inv(place[:, :3])
                to_local[f, i] = np.column_stack([inverse, -inverse @ place[:, 3]])
                spheres[f, i, :3] = place[:, :3] @ self.centres[i] + place[:, 3]
                spheres[f, i, 3] = stretch[0] * self.reaches[i] * (1 + 1e-9)
        return self.world._replace(to_local=to_local, spheres=spheres)


def compiled(scene: Scene) -> Compiled:
    """Flat arrays of all shapes of a scene, and the trees of its meshes."""
    every = scene.description.shapes
    order = sorted(range(len(every)), key=lambda i: every[i].glass is not None)
    shapes = tuple(every[i] for i in order)
    corners = [scene.triangles.get(i) for i in order]
    count = len(shapes)
    kinds, sizes, centres, reaches = np.zeros(count, np.int64), np.zeros((count, 3)), np.zeros((count, 3)), []
    for i, (shape, its) in enumerate(zip(shapes, corners, strict=True)):
        kinds[i], size, reach = solid(shape)
        sizes[i, : len(size)] = size
        if its is not None:
            centres[i] = (its.min(axis=(0, 1)) + its.max(axis=(0, 1))) / 2
            reach = float(np.max(np.linalg.norm(its - centres[i], axis=2)))
        reaches.append(reach)
    roots, triangles, boxes, links = _forest(corners)
    colours = np.array([[linear(s.colour), linear(s.checker.colour if s.checker else s.colour)] for s in shapes])
    depths = np.array([s.glass or math.inf for s in shapes])
    world = World(
        opaque=int(np.count_nonzero(np.isinf(depths))),
        shiny=any(shape.glass is not None and shape.highlight > 0 for shape in shapes),
        kinds=kinds,
        sizes=sizes,
        roots=roots,
        to_local=np.empty((0, count, 3, 4)),
        spheres=np.empty((0, count, 4)),
        colours=colours,
        extinctions=-np.log(np.maximum(colours[:, 0], _DARKEST)) / depths[:, None],
        checkers=np.array([s.checker.size if s.checker else 0.0 for s in shapes]),
        highlights=np.array([[s.highlight, s.sharpness] for s in shapes]),
        triangles=triangles,
        boxes=boxes,
        links=links,
    )
    return Compiled(shapes, scene.description.groups, world, centres, np.array(reaches))


def _forest(
    meshes: Sequence[NDArray[np.float64] | None],
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
    """``(roots, triangles, boxes, links)`` of the trees of all meshes, one after the other; root -1 where none is."""
    roots = np.full(len(meshes), -1, dtype=np.int64)
    triangles, boxes, links = [np.empty((0, 3, 3))], [np.empty((0, 6))], [np.empty((0, 3), np.int64)]
    nodes = placed = 0
    for i, corners in enumerate(meshes):
        if corners is None:
            continue
        ordered, its_boxes, its_links = tree(corners)
        roots[i] = nodes
        triangles.append(ordered)
        boxes.append(its_boxes)
        links.append(its_links + np.array([nodes, placed, placed]))
        nodes, placed = nodes + len(its_boxes), placed + len(ordered)
    return roots, np.concatenate(triangles), np.concatenate(boxes), np.concatenate(links)


def sight(description: SceneFile) -> Sight:
    """Camera, lights and background of a scene that has a camera to see with."""
    camera = description.camera
    assert isinstance(camera, PerspectiveCamera | ParallelCamera)  # noqa: S101 - the tracer asked before
    position = np.array(camera.position)
    forward = np.array(camera.target) - position
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    if isinstance(camera, PerspectiveCamera):
        height = 2 * math.tan(math.radians(camera.field_of_view_deg) / 2)
    else:
        height = camera.height
    lights = [
        [*light.position, 1.0, *(light.strength * linear(light.colour))]
        if isinstance(light, PointLight)
        else [*light.direction, 0.0, *(light.strength * linear(light.colour))]
        for light in description.lights
    ]
    return Sight(
        axes=np.array([position, height * right, height * up, forward]),
        perspective=isinstance(camera, PerspectiveCamera),
        samples=camera.samples,
        lights=np.array(lights, dtype=np.float64).reshape(-1, 7),
        ambient=linear(description.ambient),
        background=np.array([linear(description.background.top), linear(description.background.bottom)]),
    )
