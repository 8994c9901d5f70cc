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
    """Description and voxels, as the page's modules read them; takes and raises what `page` does."""
    packed = pack(cube if full else smaller(cube, callback))
    return describe(cube, packed, title), packed.data()
