"""Light through glass in Mitsuba 3, for tests to compare with: a block with a cube's voxels in it, and round bodies.

A second opinion on refraction with Mitsuba's own shapes, dielectric faces and media, none of this package's code. Tests
read the numbers and want no Mitsuba. To make them again, in some minutes (LLVM 17 or newer)::

    pip install mitsuba && python -m tests.forward.mitsuba.glass

All is in **the axes of the body** (`docs/conventions.md`): right-handed, z up, middle at 0, mm; the body stands still
and the lamp goes round it. Light of elevation e at a turntable angle θ goes along ``(cos e cos θ, −cos e sin θ,
−sin e)``, a step to the next column is ``(−sin θ, −cos θ, 0)`` and to the next row ``(0, 0, −1)`` voxels, and the
screen is square to ``(cos θ, −sin θ, 0)``.

**The block** (names ``block_…``). ``extinction`` is ``(z, y, x)``, 1/mm, grey, of voxels of ``voxel_mm``, and fills the
glass, which is as large as the voxels together: its faces are theirs. ``lamp[v]`` is light's way, ``origin[v]``
the place on the screen where the picture's middle is: where the straight line along the light through the block's
middle meets the screen, ``SCREEN_MM`` behind the middle. The middle of the pixel (row, column) is ``origin + (column −
(columns − 1) / 2) column_step + (row − (rows − 1) / 2) row_step``, and a pixel is the parallelogram about it with these
steps as sides. ``shown[v, row, column]`` is the mean over a pixel's area of the **direct** light, that which leaves
along ``lamp`` again, over that without the block: Fresnel's share times exp(−absorbance), 1 beside the block. Light
that is thrown back by a wall inside lands from other directions, and is not in it: rays leave the screen against the
light, and see a lamp of ``LAMP_DEG`` to all sides. ``variance[v, row, column]`` is that of ``shown``: k of N rays saw
the lamp, and it is p (1 − p) / N with p = (k + 1) / (N + 2). What a plain calculation lacks: light that is thrown back
twice inside, some thousandths, and Mitsuba takes light for unpolarised at each face anew, 0.6 % at most.

**The round bodies** (names ``cylinder_0_…``, ``cylinder_20_…``, ``sphere_20_…``: the lamp's elevation, at θ = 0).
Radius ``round_radius_mm``, index ``ior``, the cylinder endless about z. Beams come from the lamp (``…_lamp``, a unit
vector), spread evenly over 0.85 of the body's width, and go through the shape by Mitsuba's intersection and
transmission: ``…_entry`` and ``…_exit`` are points, ``…_inner`` and ``…_outgoing`` unit vectors, ``…_through``
Fresnel's share of both faces. All are single floats in Mitsuba: 1e-5 mm and 1e-6 of a direction at best.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any

import mitsuba
import numpy as np
from numpy.typing import NDArray

mitsuba.set_variant("llvm_ad_rgb")

IOR = 1.5
#: Voxels along (z, y, x): no two axes alike, so that none can be taken for another.
SHAPE, VOXEL_MM = (36, 32, 40), 1.0
#: Turntable angles, lamp's elevation, all degrees; the screen's distance; pixels of a voxel's size.
ANGLES_DEG, ELEVATION_DEG, SCREEN_MM, PIXELS = (15.0, 45.0), 35.0, 100.0, (24, 24)
LAMP_DEG, LAMP_MM = 4.0, 2000.0
RADIUS_MM, BEAMS = 20.0, 25

Numbers = NDArray[np.float64]


def extinction() -> Numbers:
    """A third of the voxels clear, others with up to 0.125 a mm, in steps that single floats hold exactly."""
    random = np.random.default_rng(7)
    return np.round(random.uniform(0, 0.125, SHAPE) * 256) / 256 * (random.random(SHAPE) > 0.33)


def light(elevation_deg: float, angle_deg: float) -> Numbers:
    e, t = math.radians(elevation_deg), math.radians(angle_deg)
    return np.array([math.cos(e) * math.cos(t), -math.cos(e) * math.sin(t), -math.sin(e)])


def pixel_frame(angle_deg: float) -> tuple[Numbers, Numbers, Numbers]:
    """The picture's middle, a step to the next column, one to the next row."""
    t, way = math.radians(angle_deg), light(ELEVATION_DEG, angle_deg)
    middle = SCREEN_MM / math.cos(math.radians(ELEVATION_DEG)) * way
    column, row = np.array([-math.sin(t), -math.cos(t), 0.0]), np.array([0.0, 0.0, -1.0])
    return middle, VOXEL_MM * column, VOXEL_MM * row


def transform() -> Any:
    """The one that moves nothing."""
    return mitsuba.ScalarTransform4f()


def vectors(kind: Any, rows: Numbers) -> Any:
    return kind(*(mitsuba.Float(np.ascontiguousarray(column, np.float32)) for column in rows.T))


def block_scene(way: Numbers) -> Any:
    """The glass with its gas, and a glowing disc far away that faces it."""
    size = [count * VOXEL_MM for count in reversed(SHAPE)]
    gas = {
        "type": "gridvolume",
        "grid": mitsuba.VolumeGrid(extinction().astype(np.float32)[..., None]),
        "filter_type": "nearest",
        "wrap_mode": "clamp",
        "raw": True,
        "to_world": transform().translate([-side / 2 for side in size]) @ transform().scale(size),
    }
    facing = transform().look_at(origin=-LAMP_MM * way, target=[0, 0, 0], up=[0, 0, 1])
    lamp_radius = LAMP_MM * math.tan(math.radians(LAMP_DEG))
    return mitsuba.load_dict(
        {
            "type": "scene",
            "lamp": {
                "type": "disk",
                "to_world": facing @ transform().scale(lamp_radius),
                "emitter": {"type": "area", "radiance": {"type": "rgb", "value": 1.0}},
                "bsdf": {"type": "null"},
            },
            "block": {
                "type": "cube",  # from -1 to 1 along each axis
                "to_world": transform().scale([side / 2 for side in size]),
                "bsdf": {"type": "dielectric", "int_ior": IOR, "ext_ior": 1.0},
                "interior": {"type": "heterogeneous", "albedo": 0.0, "sigma_t": gas},
            },
        }
    )


def seen(angle_deg: float, rays: int, batches: int) -> tuple[Numbers, Numbers]:
    """Mean and variance of the picture, from ``rays`` of each pixel in each of several batches."""
    way = light(ELEVATION_DEG, angle_deg)
    middle, column, row = pixel_frame(angle_deg)
    scene, walk = block_scene(way), mitsuba.load_dict({"type": "volpath", "max_depth": 1000, "rr_depth": 100000})
    random = np.random.default_rng(round(angle_deg))
    r, c = (places.ravel()[:, None] for places in np.indices(PIXELS) - (np.array(PIXELS) - 1)[:, None, None] / 2)
    hits = np.zeros(PIXELS)
    for batch in range(batches):
        down, right = (places + random.uniform(-0.5, 0.5, (places.size, rays)) for places in (r, c))
        points = middle + right[..., None] * column + down[..., None] * row
        sampler = mitsuba.load_dict({"type": "independent"})
        sampler.seed(1000 * round(angle_deg) + batch, points.size // 3)
        ray = mitsuba.Ray3f(vectors(mitsuba.Point3f, points.reshape(-1, 3)), mitsuba.Vector3f(*(-way).tolist()))
        shown = walk.sample(scene, sampler, mitsuba.RayDifferential3f(ray), None, mitsuba.Bool(True))[0]
        hits += np.array(shown)[0].reshape(*PIXELS, rays).sum(axis=2)
    count = rays * batches
    likely = (hits + 1) / (count + 2)
    return hits / count, likely * (1 - likely) / count


def through(shape: dict[str, Any], way: Numbers) -> dict[str, Numbers]:
    """Beams that go through a body by Mitsuba's shape and dielectric."""
    scene = mitsuba.load_dict(
        {"type": "scene", "body": shape | {"bsdf": {"type": "dielectric", "int_ior": IOR, "ext_ior": 1.0}}}
    )
    right = np.array([0.0, -1.0, 0.0])
    up = np.cross(right, way)
    places = np.linspace(-0.6, 0.6, BEAMS) * RADIUS_MM  # a square whose corners are 0.85 of the radius from its middle
    a, b = (each.ravel()[:, None] for each in np.meshgrid(places, places))
    start = a * right + b * up - 30 * way
    transmit = mitsuba.BSDFContext()
    transmit.type_mask = mitsuba.BSDFFlags.Transmission
    ray = mitsuba.Ray3f(vectors(mitsuba.Point3f, start), mitsuba.Vector3f(*way.tolist()))
    share, found = mitsuba.Float(1), {"lamp": way}
    for place, direction in (("entry", "inner"), ("exit", "outgoing")):
        hit = scene.ray_intersect(ray)
        assert np.all(np.array(hit.is_valid()))
        sample, weight = hit.bsdf().sample(transmit, hit, mitsuba.Float(0.5), mitsuba.Point2f(0.5, 0.5))
        # Radiance is taken n² times as large in glass, which both faces together make good.
        share *= weight[0]
        ray = hit.spawn_ray(hit.to_world(sample.wo))
        found |= {place: np.array(hit.p).T, direction: np.array(ray.d).T}
    return found | {"through": np.array(share)}


def main() -> None:
    """Write ``glass.npz`` beside this file."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--batches", type=int, default=8, help="of 256 rays of each pixel")
    parser.add_argument("--to", type=Path, default=Path(__file__).with_name("glass.npz"))
    given = parser.parse_args()
    numbers: dict[str, Any] = {"ior": IOR, "extinction": extinction().astype(np.float32), "voxel_mm": VOXEL_MM}
    numbers |= {"block_angles_deg": ANGLES_DEG, "block_elevation_deg": ELEVATION_DEG, "block_screen_mm": SCREEN_MM}
    numbers["block_lamp"] = [light(ELEVATION_DEG, angle) for angle in ANGLES_DEG]
    frames = np.array([pixel_frame(angle) for angle in ANGLES_DEG])
    numbers |= {f"block_{name}": frames[:, i] for i, name in enumerate(("origin", "column_step", "row_step"))}
    pictures = np.array([seen(angle, 256, given.batches) for angle in ANGLES_DEG], np.float32)
    numbers |= {"block_shown": pictures[:, 0], "block_variance": pictures[:, 1], "round_radius_mm": RADIUS_MM}
    endless = {"type": "cylinder", "p0": [0, 0, -200], "p1": [0, 0, 200], "radius": RADIUS_MM}
    ball = {"type": "sphere", "radius": RADIUS_MM}
    for name, shape in (("cylinder_0", endless), ("cylinder_20", endless), ("sphere_20", ball)):
        for part, values in through(shape, light(float(name.split("_")[1]), 0)).items():
            numbers[f"{name}_{part}"] = values.astype(np.float64 if part == "lamp" else np.float32)
    np.savez_compressed(given.to, **numbers)


if __name__ == "__main__":
    main()
