"""Triangle meshes against a plain sum over all triangles; letters against their picture."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import config
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from lightcube.errors import InputError
from lightcube.scene import letters, meshes, polygons
from lightcube.scene.kernels import solids
from lightcube.scene.kernels.mesh import mesh_inside, mesh_nearest

Array = NDArray[np.float64]
JIT_OFF = bool(getattr(config, "DISABLE_JIT", 0))
LINES = 60 if JIT_OFF else 500

CORNERS = np.array([[x, y, z] for x in (-1.0, 1) for y in (-1, 1) for z in (-1, 1)])
FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def box_mesh(half: tuple[float, float, float] = (1, 1, 1)) -> Array:
    """Twelve triangles, normals outward."""
    triangles = [[CORNERS[q[0]], CORNERS[q[i]], CORNERS[q[i + 1]]] for q in FACES for i in (1, 2)]
    return np.array(triangles) * half


def ball_mesh(count: int = 9) -> Array:
    """A lumpy closed body: a latitude-longitude net."""
    rng = np.random.default_rng(3)
    radius = rng.uniform(0.5, 1, (count + 1, 2 * count))
    radius[0], radius[-1] = 0.8, 0.7

    def at(i: int, j: int) -> list[float]:
        a, b = math.pi * i / count, math.pi * (j % (2 * count)) / count
        r = radius[i, j % (2 * count)]
        ring = 0.0 if i in (0, count) else math.sin(a)
        return [r * ring * math.cos(b), r * ring * math.sin(b), r * math.cos(a)]

    return np.array(
        [
            triangle
            for i in range(count)
            for j in range(2 * count)
            for triangle in ([at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)])
        ]
    )


def plain_crossings(triangles: Array, o: Array, d: Array) -> tuple[Array, Array]:
    """All crossings (t, sense) of a line with triangles, by solving a 3 x 3 system for each."""
    found = []
    for a, b, c in triangles:
        matrix = np.column_stack([b - a, c - a, -d])
        if abs(np.linalg.det(matrix)) < 1e-14:
            continue
        u, v, t = np.linalg.solve(matrix, o - a)
        if u >= 0 and v >= 0 and u + v <= 1:
            found.append((t, 1 if np.cross(b - a, c - a) @ d > 0 else -1))
    found.sort()
    return np.array([t for t, _ in found]), np.array([s for _, s in found])


def inside(made: tuple[Array, Array, NDArray[np.int64]], o: Array, d: Array, near: float, far: float) -> float:
    return float(mesh_inside(*made, 0, *o, *d, near, far))  # type: ignore[call-arg]


def test_a_tree_finds_what_a_plain_search_finds() -> None:
    body = meshes.tidy(ball_mesh(4 if JIT_OFF else 9))
    assert meshes.is_closed(body)
    made = meshes.tree(meshes.outward(body))
    rng = np.random.default_rng(0)
    hits = 0
    for _ in range(LINES // 5):
        o, d = rng.uniform(-1, 1, 3), rng.normal(size=3)
        d /= np.linalg.norm(d)
        t, sense = plain_crossings(made[0], o, d)
        for near, far in ((-5.0, 5.0), (0.0, 5.0), (-0.3, 0.4)):
            chord = float(np.sum(sense * np.clip(t, near, far))) if len(t) else 0.0
            assert inside(made, o, d, near, far) == pytest.approx(chord, abs=1e-9)
            ahead = t[(t > near) & (t < far)]
            first, which = mesh_nearest(*made, 0, *o, *d, near, far)  # type: ignore[call-arg]
            assert first == pytest.approx(ahead[0] if len(ahead) else math.inf)
            assert (which >= 0) == (len(ahead) > 0)
            hits += len(ahead)
    assert hits > LINES / 5


def test_a_box_of_triangles_is_a_box() -> None:
    half = (0.3, 0.5, 0.7)
    made = meshes.tree(meshes.tidy(box_mesh(half)))
    rng = np.random.default_rng(1)
    out = np.empty(4)
    for _ in range(LINES):
        o, d = rng.uniform(-0.8, 0.8, 3), rng.normal(size=3)
        d /= np.linalg.norm(d)
        count = solids.crossings(solids.BOX, half, *o, *d, out)  # type: ignore[call-arg]
        chord = out[1] - out[0] if count else 0.0
        assert inside(made, o, d, -9, 9) == pytest.approx(chord, abs=1e-12)


def test_lines_through_edges_and_corners_are_counted_once() -> None:
    """Every face's diagonal is an edge of two triangles; every lattice point here lies on one."""
    made = meshes.tree(meshes.tidy(box_mesh()))
    for axis in range(3):
        d = np.eye(3)[axis]
        for a in (-0.5, 0.0, 0.5, 0.75):
            for sign in (1, -1):
                o = np.insert(np.array([a, sign * a]), axis, -4.0)
                assert inside(made, o, d, 0.0, 9.0) == 2.0
                assert inside(made, -o, -d, 0.0, 9.0) == 2.0
    corner = np.full(3, -3.0)
    assert inside(made, corner, np.full(3, 1 / math.sqrt(3)), 0, 9) == pytest.approx(2 * math.sqrt(3))


def test_volume_and_orientation() -> None:
    box = meshes.tidy(box_mesh((0.5, 1, 1.5)))
    assert meshes.volume(box) == pytest.approx(6)
    flipped = box[:, ::-1]
    assert meshes.volume(flipped) == pytest.approx(-6)
    assert meshes.volume(meshes.outward(flipped)) == pytest.approx(6)


def test_a_closed_mesh_loses_its_closedness_with_any_triangle_or_flip() -> None:
    box = meshes.tidy(box_mesh())
    assert meshes.is_closed(box)
    for i in range(len(box)):
        assert not meshes.is_closed(np.delete(box, i, axis=0))
        flipped = box.copy()
        flipped[i] = flipped[i, ::-1]
        assert not meshes.is_closed(flipped)


def test_tidy_joins_corners_that_nearly_coincide_and_drops_what_collapses() -> None:
    rng = np.random.default_rng(5)
    noisy = box_mesh() + rng.uniform(-1e-9, 1e-9, (12, 3, 3))
    sliver = np.array([[[0.2, 0.3, 0.4], [0.2, 0.3, 0.4 + 1e-9], [0.5, 0.5, 0.5]]])
    tidied = meshes.tidy(np.concatenate([noisy, sliver]))
    assert len(tidied) == 12
    assert len(np.unique(tidied.reshape(-1, 3), axis=0)) == 8
    assert meshes.is_closed(tidied)


@pytest.mark.parametrize(
    "bad",
    [
        np.empty((0, 3, 3)),
        np.zeros((4, 3)),
        np.full((1, 3, 3), np.nan),
        np.full((1, 3, 3), np.inf),
        np.ones((3, 3, 3)),
        np.array([[[0, 0, 0], [0, 0, 0], [1, 0, 0]]]),
    ],
    ids=["none", "shape", "nan", "inf", "point", "line"],
)
def test_meshes_without_an_extent_are_refused(bad: Array) -> None:
    with pytest.raises(InputError, match=r"^a\.stl "):
        meshes.tidy(bad, "a.stl")


def star(radii: list[float], turn: float = 0.0) -> Array:
    """Counter-clockwise ring around the origin."""
    a = 2 * np.pi * np.arange(len(radii)) / len(radii) + turn
    return np.column_stack([np.cos(a), np.sin(a)]) * np.array(radii)[:, None]


@given(
    outer=st.lists(st.floats(1, 3), min_size=8, max_size=24),
    hole=st.lists(st.floats(0.05, 0.3), min_size=3, max_size=12),
    turn=st.floats(0, 6),
    two=st.booleans(),
)
@settings(max_examples=20 if JIT_OFF else 100)
def test_a_polygon_is_cut_into_triangles_that_fill_it_once(
    outer: list[float], hole: list[float], turn: float, two: bool
) -> None:
    ring = star(outer)
    holes = [star(hole, turn)[::-1] + np.array([0.32, 0.02])] + (
        [star(hole)[::-1] - np.array([0.33, 0.01])] if two else []
    )
    triangles = polygons.triangulated(ring, holes)
    areas = np.array([polygons.area(t) for t in triangles])
    assert np.all(areas > -1e-12)
    assert areas.sum() == pytest.approx(polygons.area(ring) + sum(polygons.area(h) for h in holes))
    body = meshes.tidy(letters.extruded(ring, holes, 0.5))
    assert meshes.is_closed(body)
    assert meshes.volume(body) == pytest.approx(0.5 * areas.sum(), rel=1e-5)


def rectangle(x: float, y: float, wide: float, high: float) -> Array:
    """Clockwise: a hole."""
    return np.array([[x, y], [x, y + high], [x + wide, y + high], [x + wide, y]])


SPIKED = np.array([[-10.0, -10], [-0.5, -10], [0, 0], [0.5, -10], [10, -10], [10, 10], [-10, 10]])


@pytest.mark.parametrize(
    "holes",
    [
        [rectangle(-0.2, 1.5, 0.4, 0.4), rectangle(-8, 0.5, 16.5, 0.5)],
        [rectangle(1, 0.5, 1, 1), rectangle(-2, 0.5, 1, 1)],
        [rectangle(1, 0.5, 1, 1), rectangle(-2, 0.5, 1, 1), rectangle(-0.3, 1.2, 0.6, 5)],
        [rectangle(1, -0.5, 1, 1), rectangle(-2, -0.6, 1, 1), rectangle(-0.5, 0.4, 1, 1)],
    ],
    ids=["behind a wall", "two at one corner", "three at one corner", "around a corner"],
)
@pytest.mark.parametrize("turn", [0.0, 1.0, 2.5, 4.0])
def test_holes_that_stand_in_each_others_way_are_holes(holes: list[Array], turn: float) -> None:
    spin = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    triangles = polygons.triangulated(SPIKED @ spin, [hole @ spin for hole in holes])
    areas = np.array([polygons.area(t) for t in triangles])
    assert np.all(areas > -1e-12)
    assert areas.sum() == pytest.approx(polygons.area(SPIKED) + sum(polygons.area(h) for h in holes))
    middles = np.array([hole.mean(axis=0) for hole in holes]) @ spin
    for middle in middles:
        assert not any(letters._contains(t, middle) for t in triangles)


def test_letters_are_as_solid_as_their_picture() -> None:
    text, height, depth = "B8%", 0.7, 0.3
    body = meshes.tidy(letters.text_mesh(text, height, depth))
    assert meshes.is_closed(body)
    font = ImageFont.load_default(size=200)
    image = Image.new("L", (600, 300))
    ImageDraw.Draw(image).text((20, 20), text, font=font, fill=255)
    top, bottom = (font.getbbox("H")[k] for k in (1, 3))
    unit = height / (bottom - top)
    ink = np.asarray(image, dtype=float).sum() / 255 * unit**2
    assert meshes.volume(body) == pytest.approx(ink * depth, rel=0.01)
    low, high = body.reshape(-1, 3).min(axis=0), body.reshape(-1, 3).max(axis=0)
    np.testing.assert_allclose(low + high, 0, atol=1e-9)
    assert high[1] - low[1] == pytest.approx(depth)


def test_holes_in_letters_are_holes() -> None:
    made = meshes.tree(meshes.tidy(letters.text_mesh("O", 1.0, 0.25)))
    through, slant = np.array([0.0, 1, 0]), np.array([0, math.sqrt(0.5), math.sqrt(0.5)])
    assert inside(made, np.array([0.0, -5, 0]), through, 0, 9) == 0
    width = float(made[0][..., 0].max())
    assert inside(made, np.array([width - 0.03, -5, 0]), through, 0, 9) == pytest.approx(0.25)
    assert inside(made, np.array([0.0, -5, -5]), slant, 0, 20) == 0
    # Along x the beam passes both sides of the ring and nothing between them.
    assert 0.05 < inside(made, np.array([-5.0, 0, 0]), np.array([1.0, 0, 0]), 0, 5) < 0.3


def test_letters_read_from_left_to_right_and_upright() -> None:
    body = letters.text_mesh("L", 1.0, 0.2)
    made = meshes.tree(meshes.tidy(body))
    high = body.reshape(-1, 3).max(axis=0)
    through = np.array([0.0, 1, 0])

    def ink(x: float, z: float) -> float:
        return inside(made, np.array([x, -5.0, z]), through, 0, 9)

    for z in (-0.9, 0, 0.9):
        assert ink(-0.95 * high[0], z * high[2]) > 0
    assert ink(0.8 * high[0], -0.97 * high[2]) > 0
    assert ink(0.8 * high[0], 0.9 * high[2]) == 0
