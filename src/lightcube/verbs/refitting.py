"""The pictures that a cube was made from, fitted as they were for it."""

from dataclasses import replace

import numpy as np

from lightcube import io
from lightcube.errors import InputError
from lightcube.optics.cube import Cube
from lightcube.optics.stack import Stack
from lightcube.optics.told import remembered
from lightcube.pictures.fitting import check_fit, fit, targets_of
from lightcube.pictures.targets import Targets


def _of_stage(path: str, cube: Cube) -> Targets:
    """The pictures of a stage file, as wanted of a cube that was made on it; `InputError` where it was on another."""
    _, targets = io.read_stage_targets(path, transfer=cube.transfer)
    rig = targets.rig
    same = rig.picture_shape == cube.rig.picture_shape and len(rig.views) == len(cube.rig.views)
    if not (same and np.allclose(rig.views.lamps, cube.rig.views.lamps)):
        raise InputError(f"the cube was not made on the stage {path}: give the one it was made on")
    return replace(targets, rig=cube.rig)


def wanted_of(cube: Cube, source: str | None) -> Targets:
    """The pictures that a cube is compared with: those of a file or folder, or its own targets."""
    return targets_of(cube) if source is None else refitted(cube, source)


def refitted(cube: Cube, source: str) -> Targets:
    """Pictures as `solve` fitted them to the cube, in its order; `InputError` where they cannot be those it is for."""
    if io.is_stage(source):
        return _of_stage(source, cube)
    of_films = isinstance(cube.grid, Stack) and "fit" in remembered(cube)
    if not (of_films or np.all(cube.rig.screens.endless)):
        raise InputError(f"the cube was made on a stage: give its file instead of {source}, or nothing")
    part = remembered(cube).get("film", {}) if io.is_film(source) else {}
    pictures = io.read_pictures(source, transfer=cube.transfer, **part)
    x, y = remembered(cube).get("focus", pictures.focus)
    pictures = replace(pictures, focus=(x, y))
    order = remembered(cube).get("order", range(len(pictures)))
    if len(order) == len(pictures):
        images, names = (tuple(each[picture] for picture in order) for each in (pictures.images, pictures.names))
        pictures = replace(pictures, images=images, names=names)
    if pictures.angles_deg is not None and len(pictures) == len(cube.rig):
        apart = np.abs(np.remainder(pictures.angles_deg - cube.angles_deg + 180, 360) - 180)
        if np.max(apart) > 1e-6:
            raise InputError(
                f"{source} says other angles than the cube was made for: give the pictures it was made from"
            )
    return fit(pictures, cube.rig, check_fit(remembered(cube).get("fit", "crop")))
