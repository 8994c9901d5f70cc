"""Silhouettes as outlines in mm, for cutters and plotters: what each wall is to show, as it was bent."""

from __future__ import annotations

import numpy as np

from lightcube.drawing.svg import element
from lightcube.optics.arrays import Reals
from lightcube.solids.silhouettes import Silhouettes

#: Between outlines and around them, mm.
_GAP_MM = 5.0
#: The line of cutters.
_LINE = 'fill="#23262922" fill-rule="evenodd" stroke="#232629" stroke-width="0.1"'


def outlines(silhouettes: Silhouettes) -> str:
    """An SVG whose lengths are mm: the outlines of all silhouettes side by side, holes and all, with their names."""
    views = silhouettes.rig.views
    rows, columns = views.picture_shape
    steps = zip(views.column_steps_mm, views.row_steps_mm, strict=True)
    sides = [(float(np.linalg.norm(right)), float(np.linalg.norm(down))) for right, down in steps]
    left, parts = _GAP_MM, []
    for number, (name, (wide, high)) in enumerate(zip(silhouettes.names, sides, strict=True)):
        lines = " ".join(_line(each * (wide, high) + (left, _GAP_MM)) for each in _closed(silhouettes, number))
        parts.append(f'<path d="{lines}" {_LINE}>{element("title", name)}</path>')
        left += columns * wide + _GAP_MM
    height = 2 * _GAP_MM + rows * max(high for _, high in sides)
    box = f'width="{left:.3f}mm" height="{height:.3f}mm" viewBox="0 0 {left:.3f} {height:.3f}"'
    return "\n".join([f'<svg xmlns="http://www.w3.org/2000/svg" {box}>', *parts, "</svg>", ""])


def _closed(silhouettes: Silhouettes, number: int) -> list[Reals]:
    """Closed lines ``(n, 2)`` around a silhouette and its holes: x and y in pixels from the picture's upper left."""
    from skimage.measure import find_contours  # here: it takes long to load

    from lightcube.kernels.hull import MARGIN  # here: the compiler comes with it

    found = find_contours(np.asarray(silhouettes.distances[number], np.float64), 0.0)
    return [line[:, ::-1] - MARGIN + 0.5 for line in found if len(line) > 3 and np.allclose(line[0], line[-1])]


def _line(points: Reals) -> str:
    """A closed path through points, mm."""
    return "M" + "L".join(f"{x:.3f},{y:.3f}" for x, y in points[:-1]) + "Z"
