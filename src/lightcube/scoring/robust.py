"""What is left of the pictures in a set-up that is a little off."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.forward.casting import cast
from lightcube.optics.arrays import Reals
from lightcube.optics.cube import Cube
from lightcube.optics.disturbance import DISTURBANCES, Disturbance
from lightcube.optics.haze import veil_part
from lightcube.optics.rig import Rig
from lightcube.optics.setups import soft
from lightcube.optics.stack import Stack
from lightcube.optics.transfer import encode
from lightcube.optics.views import Views
from lightcube.pictures.targets import Targets
from lightcube.scoring import films
from lightcube.scoring.metrics import check_same_views, psnr


def disturbed(cube: Cube, disturbance: Disturbance) -> Iterator[NDArray[np.float32]]:
    """Yield what the screen shows at each stop of a disturbed set-up, ``(row, column, channel)``, linear light."""
    rig = cube.rig.turned(disturbance.turn_deg + disturbance.turn_of_64_deg * 64 / max(cube.grid.shape[1:]))
    if disturbance.disc_deg and rig.glass is None:
        rig = soft(rig, cube.grid, disturbance.disc_deg)
    elif disturbance.disc_deg:
        rig = replace(rig, sums=replace(rig.sums, disc_deg=np.full(len(rig.views), disturbance.disc_deg)))
    if rig.glass is not None and disturbance.ior:
        iors = tuple(ior + disturbance.ior for ior in rig.glass.iors)
        rig = replace(rig, glass=replace(rig.glass, ior=iors))
    views = rig.views
    # In the cube's own axes it is the screen that moves, the other way.
    right, down = (
        steps / np.linalg.norm(steps, axis=1, keepdims=True) for steps in (views.column_steps_mm, views.row_steps_mm)
    )
    shift_mm = disturbance.up_voxels * cube.grid.slice_mm * down
    shift_mm -= disturbance.right_voxels * cube.grid.voxel_mm * right
    shift_mm += disturbance.further * cube.grid.size_mm[1] * _ways(views)
    rig = replace(rig, views=replace(views, origins_mm=views.origins_mm + shift_mm))
    if disturbance.levels:
        rounded = _rounded(cube.extinction, disturbance.levels)
        cube = replace(cube, extinction=rounded, amounts=None, dyes=None)
    powers = cube.powers * (1 + disturbance.lamp)
    shown = cast(cube, rig, powers)
    for picture in _hazy(cube, rig, powers, disturbance) if disturbance.haze else shown:
        yield picture + np.float32(disturbance.black)


def _hazy(cube: Cube, rig: Rig, powers: Reals, disturbance: Disturbance) -> Iterator[NDArray[np.float32]]:
    """What a cube shows through haze, as bright as without: what goes straight on, exactly, under an even veil."""
    loss = np.float32(disturbance.haze / max(cube.grid.size_mm))
    hazy = replace(cube, extinction=cube.extinction + loss, amounts=None, dyes=None)
    part = np.float32(veil_part(disturbance.haze, disturbance.phase))
    for clear, straight in zip(cast(cube, rig, powers), cast(hazy, rig, powers), strict=True):
        bright, left = (picture.mean(axis=(0, 1), dtype=np.float64) for picture in (clear, straight))
        gain = np.divide(bright, left, out=np.zeros_like(left), where=left > 0).astype(np.float32)
        yield (1 - part) * gain * straight + part * bright.astype(np.float32)


def _ways(views: Views) -> NDArray[np.float64]:
    """``(views, 3)``: the way of the light at each picture's middle, of length 1."""
    lamps, is_near = views.lamps[:, :3], views.lamps[:, 3:] > 0
    light = np.where(is_near, views.origins_mm - lamps, lamps)
    return np.asarray(light / np.linalg.norm(light, axis=1, keepdims=True))


def _rounded(extinction: NDArray[np.float32], levels: int) -> NDArray[np.float32]:
    step = extinction.max(axis=(1, 2, 3), keepdims=True) / np.float32(levels)
    step[step == 0] = 1  # a colour that nothing absorbs stays 0
    return np.rint(extinction / step) * step


def disturbances(cube: Cube) -> dict[str, Disturbance]:
    """Those of `DISTURBANCES` that can befall a cube: parallel lamps of a turntable may have a disc unawares.

    How far screens stand away matters under lamps that are near, or have a disc, and behind round glass.
    """
    rig = cube.rig
    lens = rig.glass is not None and rig.glass.is_round
    spreads = bool(lens or np.any(rig.sums.disc_deg) or np.any(rig.views.lamps[:, 3]))
    raised = None if np.any(rig.sums.disc_deg) or not np.all(rig.screens.endless) else rig.elevation_deg
    return {
        name: each
        for name, each in DISTURBANCES.items()
        if (not each.disc_deg or (raised is not None and abs(raised) + each.disc_deg / 2 < 90))
        and (spreads or not each.further)
        and (rig.glass is not None or not each.ior)
    }


def robust(cube: Cube, targets: Targets, *, callback: Callable[[int, int], None] | None = None) -> dict[str, Any]:
    """What is left of the pictures in a set-up that is a little off: ``psnr_mean`` and ``psnr_min`` by disturbance.

    The `disturbances` are: none, the cube turned by 0.2 degrees, by 0.2 degrees times 64 / n of its n voxels across,
    half a voxel to the right, half a voxel up, every lamp power 2 % too high, extinction in 8 bits, a screen's black of
    1 % of white, on a turntable a lamp of half a degree, under lamps that are near or have a disc screens 5 % of the
    cube's width too far and too near, haze of an optical thickness of 0.1 and 0.4 along the cube that throws light to
    all sides or ahead, of glass an index of refraction 0.001 and 0.01 too high, and all at once but the lamp's size,
    the screens, haze, the index and the second turn. Those of films are
    `lightcube.scoring.films.robust`'s.

    Parameters
    ----------
    callback
        Called with how many pictures are compared, and how many there are.

    Raises
    ------
    InputError
        Where the targets do not fit the cube's views.
    """
    check_same_views(cube, targets)
    if isinstance(cube.grid, Stack):
        return films.robust(cube, targets, callback)
    wanted = encode(targets.pictures, targets.transfer)
    figures, tried = {}, disturbances(cube)
    for number, (name, disturbance) in enumerate(tried.items()):
        each: list[float] = []
        for picture, *pair in zip(disturbed(cube, disturbance), wanted, targets.weight, strict=True):
            each.append(psnr(encode(picture, targets.transfer), *pair))
            if callback is not None:
                callback(number * len(targets) + len(each), len(tried) * len(targets))
        figures[name] = {"psnr_mean": float(np.mean(each)), "psnr_min": float(np.min(each))}
    return figures
