"""Photograph the shadows of a small cube in Mitsuba 3, for `tests/forward/test_against_mitsuba.py` to compare with.

A second opinion on the whole way from a cube to what its wall shows: Mitsuba's own lamp, block of gas, white wall and
camera, none of this package's code. Tests read the numbers and want no Mitsuba. To make them again, in ten minutes::

    pip install mitsuba && python -m tests.forward.mitsuba.make

The room is that of `docs/conventions.md`, with the cube turned and the lamp standing still. The camera looks at the
wall from the lamp's side, orthographically, and each of its pixels is one of the wall's: the mean over its area. A wall
is as bright as how much of the lamp reaches it, so a photograph over that of the bare wall is linear light under a lamp
of power 1, whatever the wall's whiteness and the cosine of the lamp.

What the lamp's light keeps on its way is estimated by ratio tracking: free of bias, with noise. A photograph is a mean
of several with seeds of their own, and how these differ says how large the noise is.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any

import mitsuba
import numpy as np
from numpy.typing import NDArray

mitsuba.set_variant("scalar_rgb")

#: Voxels along (z, y, x): no two axes alike, so that none can be taken for another.
SHAPE, VOXEL_MM = (6, 9, 11), 0.5
#: Turntable angle, elevation, angular diameter of the lamp, all degrees; from the circle that the cube's corners sweep
#: to the wall, mm (far where the lamp has a size, so that it blurs by more than half a pixel); rows of the picture.
VIEWS = ((23.0, 35.0, 0.0, 4.5, 16), (148.0, 35.0, 0.0, 4.5, 16), (71.0, 0.0, 0.0, 4.5, 6), (23.0, 35.0, 0.5, 24.0, 16))
COLUMNS = 15
#: So far away a lamp with a size is, mm. From 50 m its shadows would be larger by a fifteenth of a per cent.
FAR_MM = 1e6
#: Rays of a pixel in each of the photographs whose mean is taken: a square number, spread evenly over the pixel.
RAYS = 1024


def cube_extinction() -> NDArray[np.float32]:
    """``(channel, z, y, x)``, 1/mm: two fifths clear, others with an absorbance of up to 1.5 a voxel and colour."""
    random = np.random.default_rng(20)
    absorbance = np.round(random.uniform(0, 1.5, (3, *SHAPE)) * 16) / 16
    return (absorbance * (random.random(SHAPE) > 0.4) / VOXEL_MM).astype(np.float32)


def room(view: tuple[float, float, float, float, int], extinction: NDArray[np.float32] | None) -> dict[str, Any]:
    """Lamp, wall, camera and, where there is one, the cube.

    The origin is half way between them: how far rays start before surfaces, and how coarse all places are in float32,
    grows with the distance from it. (With it in the cube and a wall at 57 mm a photograph is 0.009 of a pixel too low.)
    """
    angle_deg, elevation_deg, lamp_deg, screen_mm, rows = view
    radius_mm = math.hypot(*SHAPE[1:]) / 2 * VOXEL_MM
    light = np.array([math.cos(math.radians(elevation_deg)), 0.0, -math.sin(math.radians(elevation_deg))])
    wall = light / light[0] * (radius_mm + screen_mm) / 2  # the picture's middle
    things = {
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": 2, "rr_depth": 1000},
        "lamp": lamp(light, lamp_deg, -wall),
        "wall": {
            "type": "rectangle",
            "to_world": transform().look_at(origin=wall, target=wall - [1, 0, 0], up=[0, 0, 1])
            @ transform().scale(4 * radius_mm),
            "bsdf": {"type": "diffuse"},
        },
        "camera": camera(wall, rows),
    }
    return things if extinction is None else things | {"cube": block(extinction, angle_deg, -wall)}


def transform() -> Any:
    """The one that moves nothing."""
    return mitsuba.ScalarTransform4f()


def lamp(light: NDArray[np.float64], lamp_deg: float, cube: NDArray[np.float64]) -> dict[str, Any]:
    """Parallel light, or a glowing disc far away that faces the cube's middle."""
    if not lamp_deg:
        return {"type": "directional", "direction": light}
    radius_mm = FAR_MM * math.tan(math.radians(lamp_deg / 2))
    facing = transform().look_at(origin=cube - FAR_MM * light, target=cube, up=[0, 0, 1])
    return {
        "type": "disk",
        "to_world": facing @ transform().scale(radius_mm),
        "emitter": {"type": "area", "radiance": {"type": "rgb", "value": 1.0}},
    }


def block(extinction: NDArray[np.float32], angle_deg: float, middle: NDArray[np.float64]) -> dict[str, Any]:
    """Gas that takes light away and scatters none, in a box without walls that is turned about the z axis."""
    turned = transform().translate(middle) @ transform().rotate([0, 0, 1], angle_deg)
    size_mm = [count * VOXEL_MM for count in reversed(SHAPE)]
    grid = mitsuba.VolumeGrid(np.ascontiguousarray(np.moveaxis(extinction, 0, -1)))
    corner = transform().translate([-side / 2 for side in size_mm]) @ transform().scale(size_mm)
    gas = {
        "type": "gridvolume",
        "grid": grid,
        "filter_type": "nearest",
        "wrap_mode": "clamp",
        "raw": True,
        "to_world": turned @ corner,
    }
    return {
        "type": "cube",  # from -1 to 1 along each axis
        "to_world": turned @ transform().scale([side / 2 for side in size_mm]),
        "bsdf": {"type": "null"},
        "interior": {"type": "heterogeneous", "albedo": 0.0, "sigma_t": gas},
    }


def camera(wall: NDArray[np.float64], rows: int) -> dict[str, Any]:
    """An orthographic one, close before the wall, behind the cube; its scale is half the width, along both axes."""
    scale = COLUMNS * VOXEL_MM / 2
    return {
        "type": "orthographic",
        "near_clip": 0.01,
        "far_clip": 10.0,
        "to_world": transform().look_at(origin=wall - [1, 0, 0], target=wall, up=[0, 0, 1])
        @ transform().scale([scale, scale, 1]),
        "film": {
            "type": "hdrfilm",
            "width": COLUMNS,
            "height": rows,
            "rfilter": {"type": "box"},
            "component_format": "float32",
        },
        "sampler": {"type": "multijitter", "sample_count": RAYS},
    }


def photograph(things: dict[str, Any], photographs: int) -> tuple[NDArray[np.float64], float]:
    """Mean of several photographs, and the noise that is left in it (root of the mean square over pixels)."""
    scene = mitsuba.load_dict(things)
    each = [np.array(mitsuba.render(scene, spp=RAYS, seed=seed), np.float64) for seed in range(photographs)]
    variance = np.var(each, axis=0, ddof=1) / photographs
    return np.mean(each, axis=0), math.sqrt(np.mean(variance))


def main() -> None:
    """Write ``walls.npz`` beside this file."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--photographs", type=int, default=144, help="whose mean is taken")
    parser.add_argument("--to", type=Path, default=Path(__file__).with_name("walls.npz"))
    given = parser.parse_args()
    extinction = cube_extinction()
    numbers: dict[str, Any] = {}
    for i, view in enumerate(VIEWS):
        bare, _ = photograph(room(view, None), 2)
        shown, noise = photograph(room(view, extinction), given.photographs)
        numbers |= {f"shown_{i}": (shown / bare.mean()).astype(np.float32), f"noise_{i}": noise / bare.mean()}
    np.savez_compressed(
        given.to, extinction=extinction, voxel_mm=VOXEL_MM, views=np.array([view[:4] for view in VIEWS]), **numbers
    )


if __name__ == "__main__":
    main()
