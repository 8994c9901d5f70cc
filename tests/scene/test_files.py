"""Scene files and the meshes they name: what is read, and what is refused with one sentence."""

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lightcube.errors import InputError
from lightcube.io.scenes import read_scene, scene_names
from lightcube.scene.description import parse
from lightcube.scene.kernels.mesh import mesh_inside
from lightcube.scene.meshes import DoubtfulMesh, is_closed, tidy, tree, volume
from lightcube.scene.scene import Scene, scene_from_tables
from lightcube.scene.tracer import trace

GOOD = """
title = "one ball"
[camera]
type = "parallel"
position = [-5, 0, 0]
height = 4
[[lights]]
type = "point"
position = [0, 0, 9]
[groups.a]
position = [1, 2, 3]
[[shapes]]
type = "sphere"
radius = 1
colour = "#f80"
parent = "a"
[[shapes]]
type = "box"
size = [1, 2, 3]
colour = [0.5, 0, 1]
glass = 0.5
[[shapes]]
type = "torus"
radius = 1
tube = 0.2
colour = "#ff8800"
[shapes.motion]
loop = true
keys = [{ time = 0, rotation_deg = [0, 0, 0] }, { time = 1, rotation_deg = [0, 0, 360] }]
"""

MESH = """
[camera]
type = "CAMERA"
[[shapes]]
type = "mesh"
file = "FILE"
colour = "#8cf"
glass = 1
"""

CUBE = np.array(
    [
        [[0, 0, 0], [0, 1, 1], [0, 1, 0]],
        [[0, 0, 0], [0, 0, 1], [0, 1, 1]],
        [[1, 0, 0], [1, 1, 0], [1, 1, 1]],
        [[1, 0, 0], [1, 1, 1], [1, 0, 1]],
        [[0, 0, 0], [1, 0, 1], [0, 0, 1]],
        [[0, 0, 0], [1, 0, 0], [1, 0, 1]],
        [[0, 1, 0], [0, 1, 1], [1, 1, 1]],
        [[0, 1, 0], [1, 1, 1], [1, 1, 0]],
        [[0, 0, 0], [1, 1, 0], [1, 0, 0]],
        [[0, 0, 0], [0, 1, 0], [1, 1, 0]],
        [[0, 0, 1], [1, 0, 1], [1, 1, 1]],
        [[0, 0, 1], [1, 1, 1], [0, 1, 1]],
    ],
    dtype=float,
)


def write_stl(path: Path, triangles: np.ndarray[Any, Any]) -> None:
    """Binary STL."""
    rows = b"".join(struct.pack("<12fH", 0, 0, 0, *triangle.reshape(-1), 0) for triangle in triangles)
    path.write_bytes(b"a solid".ljust(80) + struct.pack("<I", len(triangles)) + rows)


def write_obj(path: Path, triangles: np.ndarray[Any, Any]) -> None:
    corners = "".join("v {} {} {}\n".format(*corner) for corner in triangles.reshape(-1, 3))
    faces = "".join(f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}\n" for i in range(len(triangles)))
    path.write_text(corners + faces)


def mesh_scene(folder: Path, file: str, camera: str = 'shadow"\ncube_width = 3 #') -> Path:
    path = folder / "mesh.toml"
    path.write_text(MESH.replace("CAMERA", camera).replace("FILE", file))
    return path


def test_four_scenes_or_more_ship_and_are_found_by_name() -> None:
    assert len(scene_names()) >= 4
    assert scene_names() == sorted(scene_names())
    for name in scene_names():
        assert read_scene(name).description.title


def test_a_good_file_is_read(tmp_path: Path) -> None:
    path = tmp_path / "ball.toml"
    path.write_text(GOOD)
    made = read_scene(path)
    assert [shape.type for shape in made.description.shapes] == ["sphere", "box", "torus"]
    assert made.description.shapes[0].colour == pytest.approx((1, 136 / 255, 0))
    assert "ball.toml" in repr(made)


CHANGES = [
    ("radius = 1\ncol", "radius = 0\ncol", "shapes.0.radius: must be > 0"),
    ("radius = 1\ncol", "radius = -1\ncol", "shapes.0.radius: must be > 0"),
    ("radius = 1\ncol", "radius = nan\ncol", "shapes.0.radius: must be a finite number"),
    ("radius = 1\ncol", "radius = inf\ncol", "shapes.0.radius: must be"),
    ("radius = 1\ncol", "radius = 1e9\ncol", "shapes.0.radius: must be <= 1e+06"),
    ("radius = 1\ncol", 'radius = "1"\ncol', "shapes.0.radius: must be a"),
    ("radius = 1\ncol", "radius = true\ncol", "shapes.0.radius: must be a"),
    ("radius = 1\ncol", "col", "shapes.0.radius: is missing"),
    ("radius = 1\ncol", "radius = 1\nwidth = 3\ncol", "shapes.0.width: no such key"),
    ('"sphere"', '"spere"', "shapes.0.type: must be one of 'sphere', 'box'"),
    ('"#f80"', '"orange"', "shapes.0.colour: must be '#rgb', '#rrggbb' or three numbers from 0 to 1"),
    ('"#f80"', "[1, 2, 3]", "shapes.0.colour.1: must be <= 1"),
    ('"#f80"', "[1, 0]", "shapes.0.colour.2: is missing"),
    ('"#f80"', "7", "shapes.0.colour: must be a list"),
    ('parent = "a"', 'parent = "b"', "shapes.0.parent: there is no group 'b': the groups are a"),
    ("[1, 2, 3]\n[[sh", '[1, 2, 3]\nparent = "a"\n[[sh', "'a' is its own ancestor"),
    ("size = [1, 2, 3]", "size = [1, 2, 0]", "shapes.1.size.2: must be > 0"),
    ("glass = 0.5", "glass = 0", "shapes.1.glass: must be > 0"),
    ("glass = 0.5", 'glass = 1\nchecker = { colour = "#fff", size = 1 }', "shapes.1: glass cannot have a checker"),
    ("tube = 0.2", "tube = 2", "shapes.2: tube must be < radius"),
    ("time = 1", "time = 0", "shapes.2.motion: keys must be in order of time"),
    ("time = 1", "time = 1.5", "shapes.2.motion.keys.1.time: must be <= 1"),
    ("360]", "350]", "shapes.2.motion: in a loop, rotation_deg at time 1 must be as at time 0"),
    ("loop = true", "phase = 0.5", "shapes.2.motion: phase shifts a loop only"),
    ("loop = true", 'loop = "yes"', "shapes.2.motion.loop: must be"),
    ("loop = true", 'easing = "bouncy"', "shapes.2.motion.easing: must be 'linear', 'ease-in'"),
    ('"parallel"', '"fisheye"', "camera.type: must be one of 'perspective', 'parallel', 'shadow'"),
    ("height = 4", "height = 4\nzoom = 2", "camera.zoom: no such key"),
    ("position = [-5, 0, 0]", "position = [0, 0, 0]", "camera: target must differ from position"),
    ("position = [-5, 0, 0]", "position = [0, 0, 5]", "camera: the camera cannot look straight up or down"),
    ('"point"', '"spot"', "lights.0.type: must be one of 'point', 'directional'"),
    ('"point"\nposition = [0, 0, 9]', '"directional"\ndirection = [0, 0, 0]', "lights.0.direction: must not be zero"),
    ('title = "one ball"', "title = 3", "title: must be a text"),
    ('title = "one ball"', "sky = 3", "sky: no such key"),
    ('title = "one ball"', "pictures = { size = [0, 3] }", "pictures.size.0: must be >= 1"),
    ('title = "one ball"', "pictures = { elevation_deg = 90 }", "pictures.elevation_deg: must be < 89.999"),
    ('title = "one ball"', "pictures = 3", "pictures: must be a table"),
    ('"parallel"\nposition = [-5, 0, 0]\nheight = 4', '"shadow"\ncube_width = 2', "shapes.0.glass: is missing"),
]


@pytest.mark.parametrize(("old", "new", "said"), CHANGES, ids=[c[2][:40] + c[1][-8:] for c in CHANGES])
def test_one_wrong_key_is_named_in_one_sentence(tmp_path: Path, old: str, new: str, said: str) -> None:
    assert old in GOOD
    path = tmp_path / "ball.toml"
    path.write_text(GOOD.replace(old, new, 1))
    with pytest.raises(InputError) as caught:
        read_scene(path)
    message = str(caught.value)
    assert message.startswith("ball.toml: ")
    assert said in message
    assert "\n" not in message
    assert "pydantic" not in message


def test_a_plane_casts_no_shadow_and_text_needs_letters() -> None:
    shadow = {"type": "shadow", "cube_width": 2}
    with pytest.raises(InputError, match=r"shapes\.0\.type: a plane is no solid"):
        scene_from_tables({"camera": shadow, "shapes": [{"type": "plane", "colour": "#fff"}]})
    text = {"type": "text", "height": 1, "depth": 1, "colour": "#fff", "glass": 1}
    for words in ("", "   ", "a\nb", "x" * 65):
        with pytest.raises(InputError, match=r"shapes\.0\.text: "):
            scene_from_tables({"camera": shadow, "shapes": [{**text, "text": words}]})
    with pytest.raises(InputError, match=r"shapes\.0\.text: .*no letter '漢'"):
        scene_from_tables({"camera": shadow, "shapes": [{**text, "text": "A 漢"}]})


def test_no_shapes_no_scene() -> None:
    with pytest.raises(InputError, match="shapes: is missing"):
        parse({"camera": {"type": "shadow", "cube_width": 1}}, "x.toml")
    with pytest.raises(InputError, match="shapes: is too short"):
        parse({"camera": {"type": "shadow", "cube_width": 1}, "shapes": []}, "x.toml")


anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)


@given(
    where=st.sampled_from(
        [
            "title",
            "camera",
            "pictures",
            "background",
            "ambient",
            "lights",
            "groups",
            "shapes",
            "extra",
            "radius",
            "colour",
            "glass",
            "checker",
            "highlight",
            "position",
            "rotation_deg",
            "scale",
            "parent",
            "motion",
            "type",
        ]
    ),
    value=anything,
)
@settings(max_examples=150)
def test_any_rubbish_gives_a_scene_or_one_sentence(where: str, value: Any) -> None:
    shape: dict[str, Any] = {"type": "sphere", "radius": 1, "colour": "#fff"}
    data: dict[str, Any] = {"camera": {"type": "parallel", "position": [1, 2, 3], "height": 1}, "shapes": [shape]}
    (data if where in (*data, "title", "pictures", "background", "ambient", "lights", "groups", "extra") else shape)[
        where
    ] = value
    said = ""
    try:
        made = scene_from_tables(data)
    except InputError as error:
        said = str(error)
    assert "\n" not in said
    assert said or np.all(np.isfinite(trace(made, 1, (1, 1))))


def test_files_that_are_no_scene(tmp_path: Path) -> None:
    for name, content in (
        ("a.toml", b"[[["),
        ("b.toml", b"\xff\xfe"),
        ("c.toml", b"x = 1\nx = 2"),
        ("d.toml", b"x = " + b"[" * 5000),
    ):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(InputError, match=rf"^{name} is not a TOML file( for us)?: "):
            read_scene(tmp_path / name)
    with pytest.raises(InputError, match=r"^there is no .*none\.toml: give "):
        read_scene(tmp_path / "none.toml")
    (tmp_path / "folder.toml").mkdir()
    with pytest.raises(InputError, match="failed: Is a directory"):
        read_scene(tmp_path / "folder.toml")
    with pytest.raises(InputError, match=r"there is no scene 'nothing': give a \.toml file, or one of bloom"):
        read_scene("nothing")


@pytest.mark.parametrize(("name", "write"), [("cube.stl", write_stl), ("cube.obj", write_obj), ("CUBE.STL", write_stl)])
def test_meshes_are_read_beside_the_scene_file(
    tmp_path: Path, name: str, write: Callable[[Path, np.ndarray[Any, Any]], None]
) -> None:
    (tmp_path / "parts").mkdir()
    write(tmp_path / "parts" / name, CUBE[:, ::-1] * [2, 3, 5])
    made = read_scene(mesh_scene(tmp_path, f"parts/{name}"))
    body = made.triangles[0]
    assert is_closed(body)
    assert volume(body) == pytest.approx(30)
    assert mesh_inside(*tree(body), 0, -1.0, 1.0, 2.0, 1.0, 0.0, 0.0, 0.0, 9.0) == pytest.approx(2)


def test_a_mesh_that_is_not_closed_can_be_seen_but_is_no_glass(tmp_path: Path) -> None:
    write_stl(tmp_path / "open.stl", CUBE[1:])
    with pytest.raises(InputError, match=r"^mesh\.toml: shapes\.0\.file: open\.stl is not closed"):
        read_scene(mesh_scene(tmp_path, "open.stl"))
    path = mesh_scene(
        tmp_path, "open.stl", 'parallel"\nposition = [-5, 0.4, 0.3]\ntarget = [0, 0.4, 0.3]\nheight = 2 #'
    )
    with pytest.raises(InputError, match="is not closed"):
        read_scene(path)
    path.write_text(path.read_text().replace("glass = 1", ""))
    with pytest.warns(DoubtfulMesh, match=r"^mesh\.toml: shapes\.0\.file: open\.stl is not closed"):
        seen = read_scene(path)
    assert trace(seen, 1, (3, 3))[0, 1, 1, 0] < 1


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("short.stl", b"x" * 10),
        ("cut.stl", None),
        ("empty.stl", b""),
        ("empty.obj", b""),
        ("words.obj", b"v a b c\nf 1 2 3\n"),
        ("range.obj", b"v 0 0 0\nv 1 0 0\nf 1 2 9\n"),
        ("nan.obj", b"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("flat.obj", b"v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n"),
    ],
)
def test_damaged_meshes(tmp_path: Path, name: str, content: bytes | None) -> None:
    if content is None:
        write_stl(tmp_path / "whole.stl", CUBE)
        content = (tmp_path / "whole.stl").read_bytes()[:-70]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_scene(mesh_scene(tmp_path, name))
    assert str(caught.value).startswith(f"mesh.toml: shapes.0.file: {name} ")
    assert "\n" not in str(caught.value)


def test_missing_and_unknown_mesh_files(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"shapes\.0\.file: there is no file .*none\.stl"):
        read_scene(mesh_scene(tmp_path, "none.stl"))
    with pytest.raises(InputError, match=r"use a file ending in \.stl, \.obj, \.ply, \.3mf"):
        read_scene(mesh_scene(tmp_path, "cube.step"))
    description = parse({"camera": {"type": "shadow", "cube_width": 1}, "shapes": [_mesh_shape("a.stl")]})
    with pytest.raises(InputError, match=r"shapes\.0\.file: the mesh a\.stl was not given"):
        Scene(description)
    assert Scene(description, {"a.stl": CUBE}).triangles[0].shape == (12, 3, 3)


def _mesh_shape(file: str) -> dict[str, Any]:
    return {"type": "mesh", "file": file, "colour": "#fff", "glass": 1}


def test_the_test_cube_is_a_cube() -> None:
    assert is_closed(tidy(CUBE))
    assert volume(tidy(CUBE)) == pytest.approx(1)
