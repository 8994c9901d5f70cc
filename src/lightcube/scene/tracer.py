"""Pictures of a scene: seen by its camera, or as shadows on the screen of a turntable."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Images, Reals, locked
from lightcube.optics.checks import checked
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.optics.views import Views, spread_angles
from lightcube.pictures.targets import Targets
from lightcube.scene.description import ShadowCamera
from lightcube.scene.scene import Scene
from lightcube.wording import counted

#: Called with (pictures made, pictures wanted).
Callback = Callable[[int, int], None]

#: Pictures per call of a kernel: enough for all threads, few enough for a lively progress bar.
_BATCH = 16


def casts_shadows(scene: Scene) -> bool:
    """Whether the scene's camera is the shadow camera."""
    return isinstance(scene.description.camera, ShadowCamera)


def times(count: int) -> Reals:
    """Instants ``i / count`` of the pictures of an animation: in a loop the last is followed by the first."""
    return np.arange(count) / count


@checked
def trace(scene: Scene, count: int, picture_shape: tuple[int, int], *, callback: Callback | None = None) -> Images:
    """Ray-trace a scene as its perspective or parallel camera sees it.

    Parameters
    ----------
    count
        Number of pictures; picture ``i`` is seen at time ``i / count``.
    picture_shape
        ``(rows, columns)``; pixels are square.
    callback
        Called with (pictures made, pictures wanted) now and then.

    Returns
    -------
    ``(picture, row, column, 3)`` float32 in linear light, 0 to 1 (brighter beams count as white).

    Raises
    ------
    InputError
        For a shadow camera, or sizes below 1.

    Notes
    -----
    Light is Lambert's law and Blinn's highlight [1]_ of all lights that reach a surface, plus ambient light. Glass
    absorbs along the straight line (Beer-Lambert); its shadows are tinted. Lights do not weaken with distance.

    References
    ----------
    .. [1] J. F. Blinn, "Models of light reflection for computer synthesized pictures", SIGGRAPH 1977.
    """
    from lightcube.scene.compiled import compiled, sight  # here: the compiler comes with them
    from lightcube.scene.kernels.render import shaded

    if casts_shadows(scene):
        raise InputError(f"{scene.name} has a shadow camera: its pictures need the views of a cube (use shadows)")
    rows, columns = picture_shape
    if min(count, rows, columns) < 1:
        raise InputError(
            f"cannot trace {counted(count, 'picture')} of {rows} x {columns} pixels: each must be at least 1"
        )
    pictures = np.empty((count, rows, columns, 3), dtype=np.float32)
    seen, shapes = sight(scene.description), compiled(scene)
    instants = times(count)
    for start in range(0, count, _BATCH):
        part = slice(start, min(start + _BATCH, count))
        shaded(shapes.at(instants[part]), seen, pictures[part])
        if callback is not None:
            callback(part.stop, count)
    return pictures


@checked
def shadows(scene: Scene, views: Views, grid: Grid, *, callback: Callback | None = None) -> Images:
    """Shadows of a scene's glass on the screen of a turntable, where the light cube of `grid` would stand.

    Parameters
    ----------
    views
        Lamp and screen of each picture; view ``i`` of N sees the solids at time ``i / N``.
    grid
        The cube: ``cube_width`` scene units of the scene's camera are as wide as it (its y axis).
    callback
        Called with (pictures made, pictures wanted) now and then.

    Returns
    -------
    ``(view, row, column, 3)`` float32: for each colour ``exp(-sum sigma * chord)`` along the beam to the pixel's
    centre. Chords are exact, and solids that overlap add up.

    Raises
    ------
    InputError
        For a scene without a shadow camera.
    """
    from lightcube.scene.compiled import compiled  # here: the compiler comes with them
    from lightcube.scene.kernels.render import shadowed

    camera = scene.description.camera
    if not isinstance(camera, ShadowCamera):
        raise InputError(f"{scene.name} has no shadow camera: set camera.type to 'shadow' (or use trace)")
    unit_mm = grid.size_mm[1] / camera.cube_width
    # A point lamp stands somewhere; parallel light only goes somewhere.
    lamps = np.where(views.lamps[:, 3:] != 0, views.lamps / np.array([unit_mm, unit_mm, unit_mm, 1.0]), views.lamps)
    origins_mm, column_steps_mm, row_steps_mm = (
        a / unit_mm for a in (views.origins_mm, views.column_steps_mm, views.row_steps_mm)
    )
    shapes = compiled(scene)
    pictures = np.empty((len(views), *views.picture_shape, 3), dtype=np.float32)
    instants = times(len(views))
    for start in range(0, len(views), _BATCH):
        part = slice(start, min(start + _BATCH, len(views)))
        world = shapes.at(instants[part])
        shadowed(world, lamps[part], origins_mm[part], column_steps_mm[part], row_steps_mm[part], pictures[part])
        if callback is not None:
            callback(part.stop, len(views))
    return pictures


@checked
def scene_rig(
    scene: Scene,
    count: int | None = None,
    size: tuple[int, int] | None = None,
    span_deg: float | None = None,
    elevation_deg: float | None = None,
) -> tuple[Grid, Rig]:
    """Cube and turntable that a scene is made for, unless something else is wanted.

    Parameters
    ----------
    count
        Number of pictures; default the scene's own ``pictures.count``.
    size
        ``(width, height)`` of the pictures in pixels; default the scene's own ``pictures.size``.
    span_deg, elevation_deg
        Degrees over which the views are spread, and elevation of the lamp; default the scene's own.

    Returns
    -------
    A grid as wide and as high as the pictures with voxels of 1 mm, and a turntable of it with stops spread evenly over
    the scene's ``pictures.span_deg`` at its ``pictures.elevation_deg``.
    """
    table = scene.description.pictures
    width, height = size or table.size
    grid = Grid((height, width, width))
    raised = table.elevation_deg if elevation_deg is None else elevation_deg
    angles_deg = spread_angles(
        table.count if count is None else count, table.span_deg if span_deg is None else span_deg, elevation_deg=raised
    )
    return grid, turntable(grid, angles_deg, elevation_deg=raised, picture_shape=(height, width))


@checked
def scene_targets(scene: Scene, rig: Rig, grid: Grid, *, callback: Callback | None = None) -> Targets:
    """Pictures of a scene for a turntable with the cube `grid`, one per stop: by its camera, or its `shadows`.

    Examples
    --------
    >>> import lightcube as lc
    >>> grid = lc.Grid((6, 8, 8))
    >>> rig = lc.turntable(grid, lc.spread_angles(4), picture_shape=(6, 8))
    >>> lc.scene_targets(lc.read_scene("gems"), rig, grid)
    <4 pictures wanted on <rig of 4 pictures of 6 x 8 pixels, 4 views>>
    """
    if casts_shadows(scene):
        pictures = shadows(scene, rig.views, grid, callback=callback)
    else:
        pictures = trace(scene, len(rig), rig.picture_shape, callback=callback)
    return Targets(locked(pictures), rig)
