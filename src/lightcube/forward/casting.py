"""Program 3, the forward computation: what the screen shows at any turntable angle."""

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lightcube.forward.turning import exposures_at, lamp_at, views_at
from lightcube.kernels.layout import columns_from_volume, pictures_from_columns
from lightcube.optics.cube import Cube
from lightcube.optics.law import falling_light
from lightcube.optics.rig import Lighting
from lightcube.optics.views import Views, check_angles
from lightcube.projection.projector import Projector

#: Views that are computed together: enough for all threads, few enough to bound memory.
_BATCH = 16


def cast(
    cube: Cube, views: Views, lamp_powers: NDArray[np.float64], lighting: Lighting | None = None
) -> Iterator[NDArray[np.float32]]:
    """Yield what the screen shows in each picture, ``(row, column, channel)`` float32 linear light, never clipped.

    Parameters
    ----------
    views
        Lamps and screens.
    lamp_powers
        ``(views, channels)``; a beam that misses the cube shows the lamp's power.
    lighting
        Which views make which picture, the lamp powers being those of its pairs; None = each view is a picture.
        Pixels that are not on the screen are black.
    """
    columns = columns_from_volume(cube.extinction)
    if lighting is None:
        yield from _cast(columns, cube, views, lamp_powers)
    else:
        yield from _cast_sums(columns, cube, views, lamp_powers, lighting)


def play(cube: Cube, angles: ArrayLike | None = None, *, whole_screen: bool = False) -> NDArray[np.float32]:
    """What the screen shows, ``(view, row, column, channel)`` float32 linear light, lamp included, never clipped.

    Parameters
    ----------
    angles
        Turntable angles in degrees; None = the pictures that the cube was made for. On a stage with several screens
        the pictures of an angle follow each other (`exposures_at`).
    whole_screen
        Show the whole shadow and its surroundings instead of the picture window; a stage's screens are whole anyway.
    """
    return player(cube, whole_screen=whole_screen)(angles)


def player(cube: Cube, *, whole_screen: bool = False) -> Callable[[ArrayLike | None], NDArray[np.float32]]:
    """Make a function of the angles that shows what `play` does, fast enough for a cube that is turned by hand.

    The cube is laid out for casting once, which takes as much memory again.

    Parameters
    ----------
    whole_screen
        Show the whole shadow and its surroundings instead of the picture window.
    """
    columns = columns_from_volume(cube.extinction)
    if cube.lighting is not None:
        return _stage_player(columns, cube, cube.lighting)

    def show(angles: ArrayLike | None) -> NDArray[np.float32]:
        turned = cube.views.angles if angles is None else check_angles(angles)
        powers = cube.powers if angles is None else lamp_at(cube, turned)
        own = angles is None and not whole_screen
        views = cube.views if own else views_at(cube, turned, whole_screen=whole_screen)
        return np.stack(list(_cast(columns, cube, views, powers)))

    return show


def _stage_player(
    columns: NDArray[np.floating], cube: Cube, lighting: Lighting
) -> Callable[[ArrayLike | None], NDArray[np.float32]]:
    def show(angles: ArrayLike | None) -> NDArray[np.float32]:
        shown = (cube.views, lighting, cube.powers) if angles is None else exposures_at(cube, angles)
        return np.stack(list(_cast_sums(columns, cube, shown[0], shown[2], shown[1])))

    return show


def _cast_sums(
    columns: NDArray[np.floating], cube: Cube, views: Views, lamp_powers: NDArray[np.float64], lighting: Lighting
) -> Iterator[NDArray[np.float32]]:
    """Yield what `cast` does with a lighting, picture by picture, and a few views of it at a time."""
    light, shadow = falling_light(views, lighting)
    powers = (lamp_powers[lighting.pair] * lighting.share).astype(np.float32)
    inside = lighting.inside(views.picture_shape)
    starts = lighting.starts
    for picture in range(lighting.pictures):
        total = np.zeros((*views.picture_shape, powers.shape[1]), np.float32)
        for first in range(starts[picture], starts[picture + 1], _BATCH):
            batch = range(first, min(first + _BATCH, starts[picture + 1]))
            heard = np.repeat(inside[picture][None], len(batch), axis=0)
            matrix = Projector(cube.grid, views.take(batch), heard)
            absorbance = matrix.forward(columns.reshape(matrix.shape[1], -1))
            lines = absorbance.reshape(len(batch) * views.picture_shape[1], -1)
            absorbed = pictures_from_columns(lines, views.picture_shape, powers.shape[1])
            for view, each in zip(batch, absorbed, strict=True):
                total += powers[view] * light[view][..., None] * (1 + shadow[view][..., None] * np.expm1(-each))
        yield total * inside[picture][..., None]


def _cast(
    columns: NDArray[np.floating], cube: Cube, views: Views, lamp_powers: NDArray[np.float64]
) -> Iterator[NDArray[np.float32]]:
    """Yield what `cast` does, of the cube's extinction as `columns_from_volume` lays it out."""
    channels = lamp_powers.shape[1]
    for start in range(0, len(views), _BATCH):
        batch = views.take(slice(start, start + _BATCH))
        matrix = Projector(cube.grid, batch)
        absorbance = matrix.forward(columns.reshape(matrix.shape[1], -1))
        light = absorbance.reshape(len(batch), batch.picture_shape[1], -1)
        np.exp(np.negative(light, out=light), out=light)
        light *= np.tile(lamp_powers[start : start + _BATCH].astype(np.float32), batch.picture_shape[0])[:, None, :]
        yield from pictures_from_columns(light.reshape(-1, light.shape[2]), batch.picture_shape, channels)
