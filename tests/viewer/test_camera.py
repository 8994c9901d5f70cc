"""The camera of the page: what a ray through a pixel meets is what is drawn there."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.viewer.test_shadows import given, on_stage, on_turntable

Run = Callable[..., Any]
MODULES = ("tools/vectors.js", "model/stage.js", "room/furniture.js", "room/camera.js")
CUBES = {"turntable": lambda: on_turntable("raised"), "stage": lambda: on_stage("two screens of different sizes")}


def ask(evaluate: Run, cube: str, expression: str, **more: Any) -> Any:
    """The value of an expression that may use `scene`, `orbit` and `room`."""
    text = f"""(() => {{
      const {{ scene, angle_deg, aspect }} = argument;
      const room = standing(scene, angle_deg);
      const orbit = fitted(orbitFrom(scene.camera), scene, [room], aspect, argument.head ?? 0);
      orbit.azimuth += argument.round ?? 0;
      const camera = cameraOf(orbit, aspect);
      return {expression};
    }})()"""
    return evaluate(MODULES, text, {"scene": given(CUBES[cube]())["scene"], "angle_deg": 51.0, "aspect": 1.6, **more})


@pytest.mark.parametrize(("cube", "behind"), [("turntable", False), ("turntable", True), ("stage", False)])
def test_pointing_finds_what_is_drawn(evaluate: Run, cube: str, behind: bool) -> None:
    """From every pixel of a screen to the picture and back, where one looks at its lit side; else nothing."""
    pixels = """room.screens.flatMap(({ corner, right, down, pixels, facing }, screen) => {
      const lit = dot(sub(camera.eye, corner), facing) > 0;
      const found = [];
      for (let row = 0; row < pixels[0]; row++) for (let column = 0; column < pixels[1]; column++) {
        const place = add(corner, add(scaled(right, column + 0.9), scaled(down, row + 0.1)));
        const { x, y } = seenAt(camera, place);
        found.push([lit ? { screen, row, column } : null, pointed(room, rayAt(camera, x, y))]);
      }
      return found;
    })"""
    found = ask(evaluate, cube, pixels, round=180 if behind else 0)
    own = [(lit, hit) for lit, hit in found if lit is None or hit is None or lit["screen"] == hit["screen"]]
    assert len(own) >= 0.6 * len(found)  # the others are behind another screen
    assert all((lit is None) == behind for lit, _ in own)
    assert all(lit == hit for lit, hit in own)


@pytest.mark.parametrize("aspect", [0.46, 1.0, 2.3])
@pytest.mark.parametrize("cube", CUBES)
def test_above_all_there_is_room_for_a_title(evaluate: Run, cube: str, aspect: float) -> None:
    """A fifth of the height, below which all is, as large as can be: something touches either margin."""
    expression = "extentOf(scene, room).map((p) => seenAt(camera, p)).map((p) => [p.x, p.y])"
    places = np.array(ask(evaluate, cube, expression, aspect=aspect, head=0.2))
    assert places[:, 1].min() >= 0.25 - 1e-9
    assert places.min() >= 0.05 - 1e-9
    assert places.max() <= 0.95 + 1e-9
    high, wide = np.isclose(np.ptp(places[:, 1]), 0.7), np.isclose(np.ptp(places[:, 0]), 0.9)
    assert high or wide


@pytest.mark.parametrize("aspect", [0.46, 1.0, 2.3])
@pytest.mark.parametrize("cube", CUBES)
def test_all_is_in_the_picture(evaluate: Run, cube: str, aspect: float) -> None:
    """Every corner, within a margin that something touches."""
    places = np.array(
        ask(
            evaluate,
            cube,
            "extentOf(scene, room).map((p) => seenAt(camera, p)).map((p) => [p.x, p.y, p.depth])",
            aspect=aspect,
        )
    )
    assert np.all(places[:, 2] > 0)
    assert places[:, :2].min() >= 0.05 - 1e-9
    assert places[:, :2].max() <= 0.95 + 1e-9
    assert min(np.min(np.abs(places[:, i] - edge)) for i in (0, 1) for edge in (0.05, 0.95)) < 1e-9


def test_a_wide_picture_is_the_described_camera(evaluate: Run) -> None:
    """The orbit keeps the eye, the way it looks, and the field."""
    found = ask(
        evaluate,
        "stage",
        "[eyeOf(orbitFrom(scene.camera)), scene.camera.eye, cameraOf(orbitFrom(scene.camera), 16 / 9)]",
    )
    np.testing.assert_allclose(found[0], found[1], atol=1e-9)
    eye, target = (
        np.array(found[1]),
        np.array(given(on_stage("two screens of different sizes"))["scene"]["camera"]["target"]),
    )
    np.testing.assert_allclose(found[2]["ahead"], (target - eye) / np.linalg.norm(target - eye), atol=1e-9)
    assert np.degrees(2 * np.arctan(found[2]["across"])) == pytest.approx(36)


def test_the_eye_stays_above_the_floor(evaluate: Run) -> None:
    heights = ask(
        evaluate, "turntable", "[-200, 0, 40, 95].map((height) => eyeOf({ ...orbit, height })[2] - orbit.target[2])"
    )
    assert np.all(np.array(heights) > 0)
    assert heights[0] == heights[1] < heights[2] < heights[3]
    ups = ask(evaluate, "turntable", "[-200, 40, 95].map((height) => cameraOf({ ...orbit, height }, 1).up[2])")
    assert min(ups) > 0.01
