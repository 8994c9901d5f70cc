"""What a page or a notebook's widget holds of a cube."""

from typing import Any

from lightcube.cube import Cube
from lightcube.pieces import Watching
from lightcube.viewer.described import describe
from lightcube.viewer.packing import pack
from lightcube.viewer.smaller import smaller


def contents(
    cube: Cube, title: str, *, full: bool = False, callback: Watching | None = None
) -> tuple[dict[str, Any], bytes]:
    """Description and voxels, as the page's modules read them.

    Parameters
    ----------
    title
        For people.
    full
        Keep all voxels; else a `smaller` cube is solved for one of more than 128 along a side.
    callback
        Is told of every pass of that.

    Raises
    ------
    InputError
        Where the cube has other than 1 or 3 colours, more voxels than a browser takes, or lamps at several elevations.
    """
    packed = pack(cube if full else smaller(cube, callback))
    return describe(cube, packed, title), packed.data()
