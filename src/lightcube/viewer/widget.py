"""The notebook widget in which a cube is turned; it needs anywidget."""

import math
from typing import TYPE_CHECKING, Any

import anywidget
import traitlets

from lightcube.drawing.strip import still
from lightcube.errors import InputError
from lightcube.optics.cube import Cube
from lightcube.viewer.description import zipped
from lightcube.viewer.modules import joined, source
from lightcube.viewer.page import contents

if TYPE_CHECKING:

    class _Widget:
        """What is used of anywidget's class, of which type checkers do not know what it is itself made of."""

        def __init__(self, **traits: Any) -> None: ...
        def __getattr__(self, name: str) -> Any: ...
        def _repr_mimebundle_(self, **asked: Any) -> tuple[dict[str, Any], dict[str, Any]] | None: ...
else:
    _Widget = anywidget.AnyWidget


class CubeWidget(_Widget):
    """A cube that is turned by hand or from Python, made by `lightcube.show`.

    Parameters
    ----------
    cube
        What is shown.
    full
        Keep all voxels; else a smaller cube is solved for one of more than 128 along a side, and the widget says so.

    Attributes
    ----------
    angle_deg
        Of the turntable, degrees in [0, 360). Setting it turns the cube, and turning the cube sets it:
        ``widget.observe(callback, "angle_deg")`` tells.
    """

    _esm = joined("widget.js") + "\nexport default { render };\n"
    _css = source("style.css")

    angle_deg: Any = traitlets.Float(0.0).tag(sync=True)
    scene: Any = traitlets.Bytes().tag(sync=True)
    voxels: Any = traitlets.Bytes().tag(sync=True)

    def __init__(self, cube: Cube, *, full: bool = False) -> None:
        description, voxels = contents(cube, "light cube", full=full)
        self._cube = cube
        super().__init__(angle_deg=float(cube.angles_deg[0]), scene=zipped(description), voxels=voxels)

    @traitlets.validate("angle_deg")
    def _within_a_turn(self, proposal: dict[str, Any]) -> float:
        angle_deg = float(proposal["value"])
        if not math.isfinite(angle_deg):
            raise InputError(f"a cube cannot be turned to {angle_deg} degrees: give a finite angle")
        return angle_deg % 360.0 % 360.0  # of a tiny negative angle the first remainder is 360

    def _repr_mimebundle_(self, **asked: Any) -> tuple[dict[str, Any], dict[str, Any]] | None:
        """The widget, and for notebooks that are opened without a kernel what the cube shows at its stops."""
        shown = super()._repr_mimebundle_(**asked)
        return None if shown is None else (shown[0] | still(self._cube), shown[1])
