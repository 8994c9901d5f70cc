"""All shapes of a scene at one instant, as flat arrays, and what a beam meets among them."""

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from lightcube.scene.kernels.mesh import mesh_inside, mesh_nearest
from lightcube.scene.kernels.solids import MESH, crossings, normal


class World(NamedTuple):
    """A compiled scene: ``i`` counts shapes, ``f`` instants.

    Loops over shapes ask for the ball first and index whole arrays only: handing over a `World`, or making a view of
    a row, costs more than the test.
    """

    shiny: bool  # any glass has a highlight
    kinds: NDArray[np.int64]  # (i,) see solids
    sizes: NDArray[np.float64]  # (i, 3)
    roots: NDArray[np.int64]  # (i,) node of the mesh's tree, or -1
    to_local: NDArray[np.float64]  # (f, i, 3, 4) from the scene into the shape's own axes
    spheres: NDArray[np.float64]  # (f, i, 4) a ball around the shape: centre, radius (inf: a plane, < 0: not there)
    opaque: int  # shapes before this one are opaque, this one and the next are glass
    colours: NDArray[np.float64]  # (i, 2, 3) linear; the second is the checker's
    extinctions: NDArray[np.float64]  # (i, 3) 1/unit
    checkers: NDArray[np.float64]  # (i,) side of a cell, 0 = none
    highlights: NDArray[np.float64]  # (i, 2) strength, sharpness
    triangles: NDArray[np.float64]  # (m, 3, 3) of all meshes
    boxes: NDArray[np.float64]  # (k, 6) of all trees
    links: NDArray[np.int64]  # (k, 3)


#: For functions that only kernels call: without entries from Python, which take most of the compiler's time, and put
#: in place, since handing over a `World` copies a hundred words.
inner: Any = njit(forceinline=True, no_cpython_wrapper=True, no_cfunc_wrapper=True)  # type: ignore[call-overload]

Vector = tuple[float, float, float]


@inner
def into(m: NDArray[np.float64], f: int, i: int, o: Vector, d: Vector) -> tuple[Vector, Vector]:
    """A line in the axes that the affine map ``m[f, i]`` (3, 4) leads to."""
    return (
        (
            m[f, i, 0, 0] * o[0] + m[f, i, 0, 1] * o[1] + m[f, i, 0, 2] * o[2] + m[f, i, 0, 3],
            m[f, i, 1, 0] * o[0] + m[f, i, 1, 1] * o[1] + m[f, i, 1, 2] * o[2] + m[f, i, 1, 3],
            m[f, i, 2, 0] * o[0] + m[f, i, 2, 1] * o[1] + m[f, i, 2, 2] * o[2] + m[f, i, 2, 3],
        ),
        (
            m[f, i, 0, 0] * d[0] + m[f, i, 0, 1] * d[1] + m[f, i, 0, 2] * d[2],
            m[f, i, 1, 0] * d[0] + m[f, i, 1, 1] * d[1] + m[f, i, 1, 2] * d[2],
            m[f, i, 2, 0] * d[0] + m[f, i, 2, 1] * d[1] + m[f, i, 2, 2] * d[2],
        ),
    )


@inner
def ball_span(balls: NDArray[np.float64], f: int, i: int, o: Vector, d: Vector) -> tuple[float, float]:
    """Where a line of unit direction is inside the ball ``balls[f, i]``; (inf, -inf) if nowhere."""
    radius = balls[f, i, 3]
    if radius < 0.0:
        return (math.inf, -math.inf)
    x, y, z = balls[f, i, 0] - o[0], balls[f, i, 1] - o[1], balls[f, i, 2] - o[2]
    along = x * d[0] + y * d[1] + z * d[2]
    x, y, z = x - along * d[0], y - along * d[1], z - along * d[2]
    left = radius * radius - (x * x + y * y + z * z)
    if left < 0.0:
        return (math.inf, -math.inf)
    half = math.sqrt(left)
    return (along - half, along + half)


@inner
def _size(world: World, i: int) -> Vector:
    return (world.sizes[i, 0], world.sizes[i, 1], world.sizes[i, 2])


@inner
def first_hit(
    world: World, f: int, i: int, o: Vector, d: Vector, near: float, far: float, out: NDArray[np.float64]
) -> tuple[float, int]:
    """``(t, triangle)`` where a beam first crosses the surface of shape `i` within (near, far); inf if it does not."""
    kind = world.kinds[i]
    p, q = into(world.to_local, f, i, o, d)
    if kind == MESH:
        return mesh_nearest(
            world.triangles, world.boxes, world.links, world.roots[i], p[0], p[1], p[2], q[0], q[1], q[2], near, far
        )
    count = crossings(kind, _size(world, i), p[0], p[1], p[2], q[0], q[1], q[2], out)
    for k in range(count):
        if near < out[k] < far:
            return (out[k], -1)
    return (math.inf, -1)


@inner
def chord(
    world: World, f: int, i: int, o: Vector, d: Vector, near: float, far: float, out: NDArray[np.float64]
) -> float:
    """Length of a beam inside closed shape `i` between `near` and `far`, both finite, in scene units."""
    p, q = into(world.to_local, f, i, o, d)
    if world.kinds[i] == MESH:
        return mesh_inside(
            world.triangles, world.boxes, world.links, world.roots[i], p[0], p[1], p[2], q[0], q[1], q[2], near, far
        )
    total = 0.0
    for k in range(crossings(world.kinds[i], _size(world, i), p[0], p[1], p[2], q[0], q[1], q[2], out)):
        total += min(max(out[k], near), far) * (1.0 if k % 2 else -1.0)
    return total


@inner
def transmission(
    world: World, f: int, o: Vector, d: Vector, near: float, far: float, out: NDArray[np.float64]
) -> Vector:
    """What all glass leaves of red, green and blue between `near` and `far`: ``exp(-sum extinction * chord)``.

    Overlapping solids add up.
    """
    spheres = world.spheres
    r, g, b = 0.0, 0.0, 0.0
    for i in range(world.opaque, len(world.kinds)):
        enter, leave = ball_span(spheres, f, i, o, d)
        enter, leave = max(near, enter), min(far, leave)
        if enter >= leave:
            continue
        length = chord(world, f, i, o, d, enter, leave, out)
        r += world.extinctions[i, 0] * length
        g += world.extinctions[i, 1] * length
        b += world.extinctions[i, 2] * length
    if r == 0.0 and g == 0.0 and b == 0.0:
        return (1.0, 1.0, 1.0)
    return (math.exp(-r), math.exp(-g), math.exp(-b))


@inner
def nearest(
    world: World, f: int, glass: bool, o: Vector, d: Vector, near: float, far: float, out: NDArray[np.float64]
) -> tuple[float, int, int]:
    """``(t, shape, triangle)`` of the first surface of glass, or of the first opaque one; shape -1 if there is none."""
    spheres = world.spheres
    best, shape, triangle = far, -1, -1
    for i in range(world.opaque if glass else 0, len(world.kinds) if glass else world.opaque):
        enter, leave = ball_span(spheres, f, i, o, d)
        if enter >= best or leave <= near:
            continue
        t, hit = first_hit(world, f, i, o, d, near, best, out)
        if t < best:
            best, shape, triangle = t, i, hit
    return (best, shape, triangle)


@inner
def blocked(world: World, f: int, o: Vector, d: Vector, near: float, far: float, out: NDArray[np.float64]) -> bool:
    """Whether anything opaque is in the way."""
    spheres = world.spheres
    for i in range(world.opaque):
        enter, leave = ball_span(spheres, f, i, o, d)
        if enter < far and leave > near and first_hit(world, f, i, o, d, near, far, out)[0] < far:
            return True
    return False


@inner
def normal_towards(world: World, f: int, i: int, triangle: int, p: Vector, d: Vector) -> Vector:
    """Unit normal of shape `i` at `p`, on the side that a beam along `d` comes from."""
    m = world.to_local
    if triangle >= 0:
        c, k = world.triangles, triangle
        ux, uy, uz = c[k, 1, 0] - c[k, 0, 0], c[k, 1, 1] - c[k, 0, 1], c[k, 1, 2] - c[k, 0, 2]
        vx, vy, vz = c[k, 2, 0] - c[k, 0, 0], c[k, 2, 1] - c[k, 0, 1], c[k, 2, 2] - c[k, 0, 2]
        n = (uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx)
    else:
        q = into(m, f, i, p, d)[0]
        n = normal(world.kinds[i], _size(world, i), q[0], q[1], q[2])
    # Normals go by the transpose of the map that leads into the shape's axes.
    x = m[f, i, 0, 0] * n[0] + m[f, i, 1, 0] * n[1] + m[f, i, 2, 0] * n[2]
    y = m[f, i, 0, 1] * n[0] + m[f, i, 1, 1] * n[1] + m[f, i, 2, 1] * n[2]
    z = m[f, i, 0, 2] * n[0] + m[f, i, 1, 2] * n[1] + m[f, i, 2, 2] * n[2]
    scale = 1.0 / max(math.sqrt(x * x + y * y + z * z), 1e-300)
    if x * d[0] + y * d[1] + z * d[2] > 0.0:
        scale = -scale
    return (x * scale, y * scale, z * scale)


@inner
def colour_at(world: World, f: int, i: int, p: Vector, n: Vector) -> Vector:
    """Linear colour of shape `i` at surface point `p` with unit normal `n`: plain, or a solid checker in its axes."""
    side = world.checkers[i]
    which = 0
    if side > 0.0:
        # A little inside the surface, so that a face that lies on a cell's face has one colour.
        q, inward = into(world.to_local, f, i, p, (-n[0], -n[1], -n[2]))
        depth = 1e-3 * side / math.sqrt(inward[0] ** 2 + inward[1] ** 2 + inward[2] ** 2)
        cell = 0.0
        for k in range(3):
            cell += math.floor((q[k] + depth * inward[k]) / side)
        which = 1 if cell % 2.0 >= 0.5 else 0
    return (world.colours[i, which, 0], world.colours[i, which, 1], world.colours[i, which, 2])
