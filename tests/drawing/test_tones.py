"""The page's JavaScript and the drawings of the room are two programs of one law, by the same numbers."""

import re
from importlib.resources import files

import numpy as np
import pytest

from lightcube.drawing import beam, orbit, tones
from lightcube.drawing.glass import clearer
from lightcube.kernels import glimpse

WEB = files("lightcube.viewer") / "web" / "room"
SHADERS, FURNITURE, CAMERA = ((WEB / f"{name}.js").read_text() for name in ("shaders", "furniture", "camera"))
NUMBER = r"([\d.]+)"


def numbers(text: str, pattern: str) -> tuple[float, ...]:
    """What the groups of a pattern are in a program."""
    found = re.search(pattern, text)
    assert found is not None, pattern
    return tuple(float(each) for each in found.groups())


@pytest.mark.parametrize(
    ("ours", "theirs"),
    [
        *((getattr(tones, name.upper()), name) for name in ("floor", "far", "table", "rim", "wall", "back", "off")),
        *((getattr(tones, name.upper()), name) for name in ("edge", "hint", "shade", "glow", "ember")),
        (tones.LINES, "grid"),
    ],
)
def test_colours(ours: tuple[float, ...] | float, theirs: str) -> None:
    dark = FURNITURE[FURNITURE.index("dark: {") : FURNITURE.index("light: {")]
    count = len(np.atleast_1d(ours))
    pattern = rf"\b{theirs}: \[?{', '.join([NUMBER] * count)}"
    np.testing.assert_array_equal(numbers(dark, pattern), ours)


def test_sizes() -> None:
    assert numbers(FURNITURE, f"LAMP_RADIUS = {NUMBER}") == (tones.LAMP_RADIUS,)
    assert numbers(FURNITURE, rf"\[FRAME, WALL\] = \[{NUMBER}, {NUMBER}\]") == (tones.FRAME, tones.WALL_WIDTH)
    assert numbers(SHADERS, f"THROUGH = {NUMBER}") == (tones.THROUGH,)
    sight = numbers(CAMERA, rf"\[LAMPS_SIGHT, FAR_FIELD\] = \[{NUMBER}, {NUMBER}\]")
    assert sight == (orbit.LAMPS_SIGHT, orbit.FAR_FIELD)


def test_glass() -> None:
    law = rf"pow\(1.0 \+ grey / {NUMBER}, -{NUMBER}\) \* pow\(1.0 \+ colour / {NUMBER}, vec3\(-{NUMBER}\)\)"
    assert numbers(SHADERS, law) == (tones.GREY, tones.GREY, tones.COLOUR, tones.COLOUR)
    shine = rf"exp\(-piece \* {NUMBER} \* log\(1.0 \+ {NUMBER} \* pure\)\)"
    assert numbers(SHADERS, shine) == (glimpse.SHINES, glimpse.PURITY)
    assert numbers(SHADERS, f"BLACK = {NUMBER}") == (glimpse.BLACK,)


def test_beams() -> None:
    assert numbers(SHADERS, rf"{NUMBER} \* beamTones") == (beam.BEFORE,)
    assert numbers(SHADERS, rf"exp\(-{NUMBER} \* length\(place - middle\) / unit\)") == (glimpse.FAINTER,)


def test_clear_glass_is_clear_and_darker_glass_lets_less_through() -> None:
    dense = (np.linspace(0, 30, 50)[:, None] * (1, 0.5, 0.8)).astype(np.float32)
    through = clearer(dense)
    assert np.all(through[0] == 1)
    assert np.all(np.diff(through, axis=0) < 0)
    assert np.all(through[1:] > np.exp(-dense[1:]))
