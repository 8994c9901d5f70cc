"""Small cubes for what is made of them, of pictures that they cast themselves: they score well as they are."""

from dataclasses import replace

import numpy as np

import lightcube as lc
from lightcube.optics.dyes import Dyes
from lightcube.optics.transfer import to_uint16


def a_cube(
    shape: tuple[int, int, int] = (10, 12, 14), voxel_mm: float = 0.5, tall: float = 1.0, seed: int = 0
) -> lc.Cube:
    """A block of unequal sides with smooth matter in it, and as its targets what it casts."""
    grid = lc.Grid(shape, voxel_mm, tall)
    rig = lc.turntable(grid, [10.0, 95.0, 222.0], elevation_deg=35, picture_shape=(6, 8))
    random = np.random.default_rng(seed)
    matter = random.random((3, *shape)) ** 6
    matter[:, : shape[0] // 2] *= 2.0
    matter[:, :, : shape[1] // 3] *= 0.2
    return with_own_targets(lc.Cube(matter.astype(np.float32), grid, rig, random.uniform(0.5, 2, (3, 3))))


def with_own_targets(cube: lc.Cube) -> lc.Cube:
    """The same cube, wanted to cast what it casts, brightened where it is more than white."""
    shown = np.stack(list(lc.cast(cube)))
    cube = replace(cube, lamp_powers=cube.powers * 0.9 / shown.max())
    levels = to_uint16(np.stack(list(lc.cast(cube))))
    return replace(cube, targets=np.concatenate([levels, np.full_like(levels[..., :1], 65535)], axis=-1))


def some_dyes() -> Dyes:
    """Three dyes that absorb beside their own colours, in a material that is not quite clear."""
    extinction = [[8.0, 0.9, 0.2], [0.15, 2.2, 1.8], [0.06, 0.6, 12.0]]
    return Dyes(("cyan", "magenta", "yellow"), np.array(extinction), base=np.array([0.002, 0.003, 0.004]))


def in_dyes(shape: tuple[int, int, int] = (8, 12, 14), voxel_mm: float = 0.25, seed: int = 0) -> lc.Cube:
    """A cube of dyes."""
    cube, dyes = a_cube(shape, voxel_mm), some_dyes()
    amounts = (np.random.default_rng(seed).random((3, *shape)) ** 4 * 0.3).astype(np.float32)
    return with_own_targets(replace(cube, extinction=dyes.mixed(amounts), amounts=amounts, dyes=dyes))
