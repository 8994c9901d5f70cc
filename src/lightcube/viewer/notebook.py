"""A cube in a notebook: the widget where a front end can show it, and what it shows at its stops everywhere."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from lightcube.drawing.strip import still
from lightcube.errors import InputError
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.viewer.smaller import MOST_SIDE

if TYPE_CHECKING:
    from lightcube.viewer.widget import CubeWidget


@checked
def show(cube: Cube, *, full: bool = False) -> CubeWidget:
    """Make a widget in which a cube is turned, for Jupyter, VS Code and marimo; its ``angle`` can be read and set.

    Parameters
    ----------
    full
        Keep all voxels; else a smaller cube is solved for one of more than 128 along a side, and the widget says so.

    Raises
    ------
    InputError
        Where anywidget is missing, or the cube has other than 1 or 3 colours, more voxels than a browser takes, or
        lamps at several elevations.
    """
    try:
        import anywidget  # noqa: F401
    except ImportError:
        raise InputError(
            "to turn a cube in a notebook takes one more package: pip install 'lightcube[notebook]'"
        ) from None
    from lightcube.viewer.widget import CubeWidget

    return CubeWidget(cube, full=full)


def displayed(cube: Cube) -> dict[str, Any]:
    """What a notebook shows of a cube that is the value of a cell, by MIME type, at once.

    The widget, where one can be shown and needs no smaller cube to be solved; a picture of what the cube shows at its
    stops, for notebooks that are opened without a kernel, on the web or on paper; and a line of text.
    """
    if _is_terminal():
        return {"text/plain": repr(cube)}
    try:
        quick = cube.grid.longest <= MOST_SIDE
        shown = show(cube)._repr_mimebundle_() if quick and _has_widgets() else None
    except InputError:  # there is no anywidget, or the cube is none for a page
        shown = None
    return still(cube) if shown is None else shown[0]


def _shell() -> Any:
    """IPython's shell, or None."""
    ipython = sys.modules.get("IPython")
    return ipython.get_ipython() if ipython else None


def _is_terminal() -> bool:
    shell = _shell()
    return shell is not None and getattr(shell, "kernel", None) is None


def _has_widgets() -> bool:
    """Whether there is something at the other end of a kernel that may show widgets: Jupyter's, or marimo."""
    marimo = sys.modules.get("marimo")
    return getattr(_shell(), "kernel", None) is not None or bool(marimo and marimo.running_in_notebook())
