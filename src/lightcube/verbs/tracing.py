"""What `trace` makes: the pictures of a moving scene, and the rig that they are for."""

import math

from lightcube.events import Tell, counting
from lightcube.pictures.targets import Targets
from lightcube.scene.scene import Scene
from lightcube.scene.tracer import scene_rig, scene_targets
from lightcube.verbs.solving import check_memory

#: Bytes that a pixel takes while it is traced: three float32 numbers, and as many again.
_BYTES_PER_PIXEL = 24


def trace(
    scene: Scene,
    tell: Tell,
    *,
    count: int | None = None,
    size: tuple[int, int] | None = None,
    span_deg: float | None = None,
    elevation_deg: float | None = None,
) -> Targets:
    """Ray-trace a scene; what is None is the scene's own.

    Parameters
    ----------
    count
        How many pictures.
    size
        Their width and height in pixels.
    span_deg, elevation_deg
        Degrees that the views are spread over, and of the lamp.

    Raises
    ------
    InputError
        Where one of them cannot be, or the pictures do not fit into the memory that is free.
    """
    grid, rig = scene_rig(scene, count, size, span_deg, elevation_deg)
    check_memory(_BYTES_PER_PIXEL * len(rig) * math.prod(rig.picture_shape))
    return scene_targets(scene, rig, grid, callback=counting(tell))
