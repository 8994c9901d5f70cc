"""Pictures against geometry and a plain second tracer; shadows against formulas."""

import math
from typing import Any

import numpy as np
import pytest
from numba import config
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.io.scenes import read_scene, scene_names
from lightcube.optics.grid import Grid
from lightcube.optics.views import Views, turntable_views
from lightcube.scene.motion import rotation_matrix
from lightcube.scene.scene import Scene, scene_from_tables
from lightcube.scene.tracer import scene_rig, scene_targets, shadows, trace

Floats = NDArray[Any]
JIT_OFF = bool(getattr(config, "DISABLE_JIT", 0))
SIZE = 9 if JIT_OFF else 35

FRONT = {"type": "parallel", "position": [-9, 0, 0], "height": 4.0, "samples": 1}
BALL = {"type": "sphere", "radius": 1.0, "colour": [1, 1, 1]}


def scene(*shapes: dict[str, Any], camera: dict[str, Any] | None = None, **tables: Any) -> Scene:
    return scene_from_tables({"camera": camera or FRONT, "ambient": 1.0, "shapes": list(shapes), **tables})


def seen(made: Scene, size: int = SIZE) -> Floats:
    return trace(made, 1, (size, size))[0]


def shadow_scene(*shapes: dict[str, Any], width: float = 3.0) -> Scene:
    return scene(*shapes, camera={"type": "shadow", "cube_width": width})


def solid(kind: str, **keys: Any) -> dict[str, Any]:
    return {"type": kind, "colour": "#c08040", "glass": 1.5, **keys}


SOLIDS = [
    solid("sphere", radius=0.4, position=[0.3, -0.5, 0.1]),
    solid("box", size=[0.3, 0.5, 0.7], rotation_deg=[10, 20, 30], colour="#4080c0"),
    solid("torus", radius=0.6, tube=0.2, rotation_deg=[40, 0, 10], colour="#80c040"),
    solid("cone", radius=0.4, height=0.8, position=[-0.4, 0.4, -0.5]),
    solid("text", text="B", height=0.6, depth=0.3, position=[0.5, 0.4, 0.6]),
]


def test_a_sphere_covers_its_disc() -> None:
    picture = seen(scene({**BALL, "colour": "#ff0000"}, camera={**FRONT, "samples": 3}))
    at = (np.arange(SIZE) + 0.5) / SIZE * 4 - 2
    radius = np.hypot(at[:, None], at[None, :])
    pixel = 4 / SIZE
    red = picture[..., 1]
    assert np.all(red[radius < 1 - pixel] == 0)
    assert np.all(red[radius > 1 + pixel] == 1)
    edge = np.abs(radius - 1) < pixel / 4
    assert np.all((red[edge] > 0) & (red[edge] < 1))


def test_right_is_right_and_up_is_up() -> None:
    """The viewer looks along +x: +y is to the left, as on the turntable's screen."""
    red = {**BALL, "radius": 0.5, "colour": "#f00", "position": [0, 1, 0]}
    blue = {**BALL, "radius": 0.5, "colour": "#00f", "position": [0, 0, 1]}
    picture = seen(scene(red, blue))
    half, quarter = SIZE // 2, SIZE // 4
    np.testing.assert_array_equal(picture[half, quarter], [1, 0, 0])
    np.testing.assert_array_equal(picture[quarter, half], [0, 0, 1])
    np.testing.assert_array_equal(picture[half, SIZE - 1 - quarter], [1, 1, 1])


def test_perspective_has_its_field_of_view() -> None:
    """A ball whose outline is seen under half the field of view's tangent covers half the picture's height."""
    distance = 5.0
    inner = math.degrees(2 * math.asin(1 / distance))
    field = math.degrees(2 * math.atan(2 * math.tan(math.radians(inner) / 2)))
    camera = {"type": "perspective", "position": [0, -distance, 0], "field_of_view_deg": field, "samples": 1}
    column = seen(scene({**BALL, "colour": "#000"}, camera=camera), 2 * SIZE)[:, SIZE, 0]
    assert abs(np.count_nonzero(column == 0) - SIZE) <= 1


def test_glass_absorbs_as_beer_and_lambert_say() -> None:
    glass = {"type": "box", "size": [1.3, 9, 9], "colour": [0.5, 0.8, 1.0], "glass": 0.7}
    picture = seen(scene(glass), 3)
    linear = np.array([((0.5 + 0.055) / 1.055) ** 2.4, ((0.8 + 0.055) / 1.055) ** 2.4, 1.0])
    np.testing.assert_allclose(picture, np.broadcast_to(linear ** (1.3 / 0.7), (3, 3, 3)), rtol=1e-6)
    twice = seen(scene(glass, {**glass, "position": [2, 0, 0]}), 3)
    np.testing.assert_allclose(twice, picture**2, rtol=1e-6)
    behind = seen(scene({**BALL, "radius": 3, "position": [-5, 0, 0]}, {**glass, "position": [3, 0, 0]}), 3)
    assert behind[1, 1].tolist() == [1, 1, 1]


def test_the_order_of_shapes_does_not_matter() -> None:
    shapes = [*SOLIDS, {**BALL, "position": [1.5, 0.5, 0], "colour": "#f00"}, {**BALL, "radius": 0.5, "colour": "#0f0"}]
    picture = seen(scene(*shapes))
    np.testing.assert_allclose(seen(scene(*shapes[::-1])), picture, atol=1e-6)
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 5


GROUND = {"type": "plane", "colour": "#fff"}
SUN = {"type": "directional", "direction": [0, 0.6, -0.8]}
ABOVE = {"type": "parallel", "position": [-6, 0, 6], "height": 6.0, "samples": 1}


def on_ground(size: int, height: float) -> Floats:
    """Points of the ground that the pixels of the camera ABOVE see, ``(row, column, 3)``."""
    at = ((np.arange(size) + 0.5) / size - 0.5) * height
    row, column = np.meshgrid(at, at, indexing="ij")
    up, right, forward = np.array([1, 0, 1]) / 2**0.5, np.array([0, -1, 0]), np.array([1, 0, -1]) / 2**0.5
    start = np.array([-6, 0, 6]) + column[..., None] * right - row[..., None] * up
    return start + (-start[..., 2] / forward[2])[..., None] * forward


@pytest.mark.parametrize(
    ("light", "centre"),
    [(SUN, (0.0, -2.05, 3.0)), ({"type": "point", "position": [0.5, -3, 6]}, (0.2, -1.0, 3.0))],
    ids=["sun", "lamp"],
)
def test_shadows_fall_where_geometry_says(light: dict[str, Any], centre: tuple[float, float, float]) -> None:
    radius = 0.9
    ball = {**BALL, "radius": radius, "position": list(centre), "colour": "#000"}
    picture = seen(scene(GROUND, ball, camera=ABOVE, lights=[light], ambient=0.0, background={"top": 0, "bottom": 0}))
    points = on_ground(SIZE, 6.0)
    if light["type"] == "point":
        to = np.array(light["position"]) - points
        far = np.linalg.norm(to, axis=-1, keepdims=True)
        to = to / far
    else:
        to = np.broadcast_to(-np.array(light["direction"]), points.shape)
    along = np.sum((centre - points) * to, axis=-1)
    miss = np.linalg.norm(points + along[..., None] * to - centre, axis=-1)
    view = np.array([-1, 0, 1]) / 2**0.5
    hidden = np.linalg.norm(np.cross(centre - points, view), axis=-1) < radius + 0.01
    dark, bright = ~hidden & (miss < radius - 1e-3), ~hidden & (miss > radius + 1e-3)
    assert min(np.count_nonzero(dark), np.count_nonzero(bright)) > 2
    assert np.all(picture[dark] == 0)
    np.testing.assert_allclose(picture[bright], np.repeat(to[..., 2][bright][:, None], 3, axis=1), rtol=1e-5)


def test_the_shadow_of_glass_is_tinted() -> None:
    glass = {"type": "box", "size": [9, 9, 1], "position": [0, 0, 9], "colour": "#f80", "glass": 0.5}
    light = {"type": "directional", "direction": [0, 0, -1]}
    camera = {**ABOVE, "height": 0.1}
    picture = seen(scene(GROUND, glass, camera=camera, lights=[light], ambient=0.0), 3)
    linear = np.array([1, ((136 / 255 + 0.055) / 1.055) ** 2.4, 1e-4])
    np.testing.assert_allclose(picture[1, 1], linear**2, rtol=1e-5)


def test_light_and_highlight_against_a_plain_formula() -> None:
    light = {"type": "point", "position": [-4, 2, 3], "strength": 0.5, "colour": [1, 1, 0]}
    made = scene({**BALL, "colour": "#888", "highlight": 0.4, "sharpness": 7}, lights=[light], ambient=[0.5, 0, 1])
    picture = seen(made)
    own = ((136 / 255 + 0.055) / 1.055) ** 2.4
    ambient = np.array([((0.5 + 0.055) / 1.055) ** 2.4, 0, 1]) * own
    at = ((np.arange(SIZE) + 0.5) / SIZE - 0.5) * 4
    lit = 0
    for row, z in enumerate(-at):
        for column, y in enumerate(-at):
            if y * y + z * z > 0.9:
                continue
            n = np.array([-math.sqrt(1 - y * y - z * z), y, z])
            to = np.array([-4, 2, 3]) - n
            to /= np.linalg.norm(to)
            half = to + np.array([-1, 0, 0])
            half /= np.linalg.norm(half)
            value = 0.0 if n @ to <= 0 else 0.5 * (own * (n @ to) + 0.4 * max(n @ half, 0) ** 7)
            wanted = np.minimum(ambient + value * np.array([1, 1, 0]), 1)
            np.testing.assert_allclose(picture[row, column], wanted, atol=1e-5)
            lit += value > 0
    assert lit > SIZE


def test_glass_shines() -> None:
    lights = [{"type": "directional", "direction": [1, 0, 0]}]
    glass = {**BALL, "glass": 1.0, "highlight": 0.5, "colour": "#888"}
    plain, shining = (seen(scene({**glass, "highlight": h}, lights=lights)) for h in (0.0, 0.5))
    middle = SIZE // 2
    assert shining[middle, middle, 0] == pytest.approx(plain[middle, middle, 0] + 0.5, abs=0.02)


def test_a_checker_alternates() -> None:
    board = {"type": "box", "size": [1, 4, 4], "colour": "#f00", "checker": {"colour": "#00f", "size": 1.0}}
    picture = seen(scene(board), 4)
    red = picture[..., 0] == 1
    assert np.array_equal(red, np.add.outer(np.arange(4), np.arange(4)) % 2 == (0 if red[0, 0] else 1))
    assert np.array_equal(picture[..., 2] == 1, ~red)


def test_a_stretched_and_turned_body_is_lit_along_its_own_normals() -> None:
    body = {**BALL, "scale": [1, 0.5, 1.5], "rotation_deg": [25, 0, 40], "parent": "g"}
    groups = {"g": {"scale": [0.8, 1.1, 1.0], "rotation_deg": [0, 30, 0]}}
    sun = np.array([0.48, -0.6, -0.64])
    light = {"type": "directional", "direction": sun.tolist()}
    picture = seen(scene(body, lights=[light], ambient=0.0, groups=groups, background={"top": 0, "bottom": 0}))
    outer, inner = rotation_matrix((0, 30, 0)) * [0.8, 1.1, 1.0], rotation_matrix((25, 0, 40)) * [1, 0.5, 1.5]
    back = np.linalg.inv(outer @ inner)
    at = ((np.arange(SIZE) + 0.5) / SIZE - 0.5) * 4
    lit = 0
    for row, z in enumerate(-at):
        for column, y in enumerate(-at):
            o, d = back @ [-9, y, z], back @ [1, 0, 0]
            inside = (o @ d) ** 2 - (d @ d) * (o @ o - 1)
            if inside < 0.05 * (d @ d):
                continue
            n = back.T @ (o + (-(o @ d) - math.sqrt(inside)) / (d @ d) * d)
            cosine = -(n @ sun) / np.linalg.norm(n)
            assert picture[row, column, 0] == pytest.approx(max(cosine, 0), abs=1e-5)
            lit += cosine > 0
    assert lit > 2


def test_what_stands_behind_a_lamp_casts_no_shadow() -> None:
    roof = {"type": "box", "size": [9, 9, 1], "position": [0, 0, 50], "colour": "#fff"}
    lamp = {"type": "point", "position": [0, 0, 20]}
    camera = {**ABOVE, "height": 0.1}
    assert seen(scene(GROUND, roof, camera=camera, lights=[lamp], ambient=0.0), 3).min() > 0.99
    lamp["position"] = [0, 0, 60]
    assert seen(scene(GROUND, roof, camera=camera, lights=[lamp], ambient=0.0), 3).max() == 0


def test_glass_does_not_shine_where_the_light_is_behind_its_surface() -> None:
    to = np.array([math.cos(math.radians(20)), 0, math.sin(math.radians(20))])
    lights = [{"type": "directional", "direction": (-to).tolist()}]
    glass = {**BALL, "glass": 1.0, "sharpness": 1.0, "colour": "#444"}
    plain, shining = (seen(scene({**glass, "highlight": h}, lights=lights)) for h in (0.0, 0.5))
    at = ((np.arange(SIZE) + 0.5) / SIZE - 0.5) * 4
    y, z = -at[None, :], -at[:, None]
    front = np.sqrt(np.maximum(1 - y * y - z * z, 0))
    cosine = np.where(y * y + z * z < 1, -front * to[0] + z * to[2], 0)
    np.testing.assert_array_equal(plain[cosine < -1e-6], shining[cosine < -1e-6])
    assert np.count_nonzero(plain != shining) > 0


def test_a_checker_on_a_flat_face_is_clean() -> None:
    """A face that lies on a plane between cells must not flicker between their colours."""
    board = {"type": "plane", "colour": "#f00", "checker": {"colour": "#00f", "size": 0.7}, "rotation_deg": [0, 0, 30]}
    camera = {**ABOVE, "position": [-6, 0.1, 6], "target": [0, 0.1, 0]}
    picture = seen(scene(board, camera=camera))
    x, y, _ = np.moveaxis(on_ground(SIZE, 6.0) + np.array([0, 0.1, 0]), -1, 0)
    cos, sin = math.cos(math.radians(30)), math.sin(math.radians(30))
    u, v = (cos * x + sin * y) / 0.7, (-sin * x + cos * y) / 0.7
    even = (np.floor(u) + np.floor(v)) % 2 == 0
    clear = (np.abs(u - np.rint(u)) > 1e-6) & (np.abs(v - np.rint(v)) > 1e-6)
    red = picture[..., 0] == 1
    assert np.array_equal(red[clear], even[clear]) or np.array_equal(red[clear], ~even[clear])
    assert np.any(red)
    assert not np.all(red)


def test_samples_are_the_mean_of_a_finer_picture() -> None:
    body = {**BALL, "colour": "#f80", "radius": 1.3}
    lights = [{"type": "directional", "direction": [1, 1, -1], "strength": 0.5}]
    fine = seen(scene(body, lights=lights, ambient=0.2), 15)
    coarse = seen(scene(body, lights=lights, ambient=0.2, camera={**FRONT, "samples": 3}), 5)
    np.testing.assert_allclose(coarse, fine.reshape(5, 3, 5, 3, 3).mean(axis=(1, 3)), atol=1e-6)


def test_the_background_runs_from_top_to_bottom() -> None:
    far = {**BALL, "position": [0, 500, 0]}
    picture = seen(scene(far, background={"top": "#000", "bottom": "#fff"}), 5)
    np.testing.assert_allclose(picture[:, 2, 0], [0.1, 0.3, 0.5, 0.7, 0.9], rtol=1e-6)


def test_picture_i_of_n_is_seen_at_time_i_over_n_and_gone_is_gone() -> None:
    keys = [{"time": t, "scale": s, "easing": "step"} for t, s in ((0.0, 1), (0.25, 0), (0.5, [1, 0, 1]), (0.75, 1))]
    pictures = trace(scene({**BALL, "colour": "#000", "motion": {"keys": keys}}), 4, (3, 3))
    assert pictures[:, 1, 1, 0].tolist() == [0, 1, 1, 0]


def test_a_moved_shape_is_a_moved_picture() -> None:
    """Stretching, turning and parents against the same body written down otherwise."""
    stretched = {**BALL, "scale": [0.3, 0.5, 0.7], "rotation_deg": [90, 0, 0], "parent": "g", "colour": "#000"}
    made = scene(stretched, groups={"g": {"position": [0, 0.4, 0], "rotation_deg": [0, 0, 90], "scale": 1.5}})
    # The x axis goes to y, the z axis to -y and on to x.
    same = scene({**BALL, "scale": [1.05, 0.45, 0.75], "position": [0, 0.4, 0], "colour": "#000"})
    np.testing.assert_array_equal(seen(made), seen(same))


def test_a_shadow_is_beer_and_lambert_along_the_beam() -> None:
    grid = Grid((9, 7, 5), 0.5)
    views = turntable_views(grid, [0.0, 90.0])
    picture = shadows(shadow_scene(solid("sphere", radius=1.0), width=3.5), views, grid)
    rows, columns = views.picture_shape
    z, y = (np.arange(rows) - (rows - 1) / 2) * 0.5, (np.arange(columns) - (columns - 1) / 2) * 0.5
    chord = 2 * np.sqrt(np.maximum(1 - np.add.outer(z**2, y**2), 0))
    linear = ((np.array([0xC0, 0x80, 0x40]) / 255 + 0.055) / 1.055) ** 2.4
    for view in picture:
        np.testing.assert_allclose(view, linear ** (chord[..., None] / 1.5), rtol=1e-6)


def test_half_a_turn_on_is_the_mirror_image_at_elevation_zero_only() -> None:
    grid = Grid((7, SIZE, SIZE))
    for elevation_deg in (0.0, 30.0):
        views = turntable_views(grid, [20.0, 200.0], elevation_deg=elevation_deg)
        first, second = shadows(shadow_scene(*SOLIDS), views, grid)
        close = np.abs(first - second[:, ::-1]).max()
        assert (close < 1e-6) == (elevation_deg == 0)
        assert first.min() < 0.5


def test_shadows_add_as_absorbances_when_solids_add() -> None:
    grid = Grid((7, SIZE, SIZE))
    views = turntable_views(grid, [33.0], elevation_deg=20.0)
    together = shadows(shadow_scene(*SOLIDS), views, grid)
    apart = np.prod([shadows(shadow_scene(one), views, grid) for one in SOLIDS], axis=0)
    np.testing.assert_allclose(together, apart, rtol=1e-5)


def test_turning_the_lamp_is_turning_the_solid_back() -> None:
    grid = Grid((7, SIZE, SIZE))
    turned = [{**one, "parent": "table"} for one in SOLIDS]
    camera = {"type": "shadow", "cube_width": 3.0}
    made = scene(*turned, camera=camera, groups={"table": {"rotation_deg": [0, 0, 37]}})
    np.testing.assert_allclose(
        shadows(made, turntable_views(grid, [0.0], elevation_deg=25.0), grid),
        shadows(shadow_scene(*SOLIDS), turntable_views(grid, [37.0], elevation_deg=25.0), grid),
        atol=1e-5,
    )


def test_a_shadow_does_not_depend_on_the_voxels_size() -> None:
    small, large = Grid((5, 7, 7), 0.1), Grid((5, 7, 7), 30.0)
    made = shadow_scene(*SOLIDS)
    np.testing.assert_allclose(
        shadows(made, turntable_views(small, [10.0]), small),
        shadows(made, turntable_views(large, [10.0]), large),
        rtol=1e-5,
    )


def test_a_point_lamp_casts_a_larger_shadow_and_only_of_what_stands_before_it() -> None:
    grid = Grid((3, 3, 3), 2.0)  # a scene unit is 2 mm
    lamps = np.array([[-8.0, 0, 0, 1]])
    steps = np.array([[0.0, -1, 0]]), np.array([[0.0, 0, -1]])
    views = Views(lamps, np.array([[8.0, 0, 0]]), *steps, (15, 15))
    picture = shadows(shadow_scene(solid("sphere", radius=1.0)), views, grid)[0, 7, :, 0]
    # The tangent beam leaves at asin(1/4) and lands 8 tan of it from the middle.
    edge = 8 * math.tan(math.asin(0.25)) / 0.5
    assert np.array_equal(picture < 1, np.abs(np.arange(15) - 7) < edge)
    behind = shadows(shadow_scene(solid("sphere", radius=1.0, position=[-6, 0, 0]), width=3.0), views, grid)
    assert np.all(behind == 1)


def test_a_moving_solid_casts_the_shadow_of_its_instant() -> None:
    grid = Grid((5, 7, 7))
    views = turntable_views(grid, [0.0, 0.0, 0.0])
    keys = [{"time": 0.0, "position": [0, -0.6, 0]}, {"time": 1.0, "position": [0, 0.6, 0]}]
    moving = shadows(shadow_scene(solid("sphere", radius=0.5, motion={"keys": keys})), views, grid)
    for view, y in zip(moving, (-0.6, -0.2, 0.2), strict=True):
        still = shadows(shadow_scene(solid("sphere", radius=0.5, position=[0, y, 0])), views.take([0]), grid)[0]
        np.testing.assert_allclose(view, still, atol=1e-6)


@pytest.mark.parametrize("name", scene_names())
def test_shipped_scenes_are_pictures_and_loops(name: str) -> None:
    made = read_scene(name)
    grid, views = scene_rig(made, 3, (7, 5))
    said: list[tuple[int, int]] = []
    targets = scene_targets(made, views, grid, callback=lambda done, of: said.append((done, of)))
    assert targets.pictures.shape == (3, 5, 7, 3)
    assert 0 <= targets.pictures.min() < 0.9
    assert targets.pictures.max() <= 1
    assert said[-1] == (3, 3)
    description = made.description
    moving = [*description.shapes, *description.groups.values()]
    assert all(one.motion is None or one.motion.loop for one in moving)


def test_a_scene_brings_its_own_views() -> None:
    made = scene(BALL, pictures={"count": 5, "size": [7, 3], "span_deg": 90, "elevation_deg": 20})
    grid, rig = scene_rig(made)
    assert grid.shape == (3, 7, 7)
    assert rig.picture_shape == (3, 7)
    np.testing.assert_allclose(rig.stops.angle_deg, [9, 27, 45, 63, 81])
    assert rig.elevation_deg == 20


def test_the_wrong_camera_and_empty_pictures_are_refused() -> None:
    grid = Grid((3, 3, 3))
    with pytest.raises(InputError, match="use shadows"):
        trace(shadow_scene(*SOLIDS), 2, (3, 3))
    with pytest.raises(InputError, match=r"camera\.type"):
        shadows(scene(BALL), turntable_views(grid, [0.0]), grid)
    for targets, shape in ((0, (3, 3)), (1, (0, 3)), (1, (3, 0))):
        with pytest.raises(InputError, match="at least 1"):
            trace(scene(BALL), targets, shape)
