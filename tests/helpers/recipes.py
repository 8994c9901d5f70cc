"""What `solve` and `make_job` are asked for, from options in one row; targets under other lamps."""

from dataclasses import fields, replace
from typing import Any

import numpy as np

from lightcube.backward.recipe import Recipe
from lightcube.optics.grid import Grid
from lightcube.optics.light import Light
from lightcube.optics.material import Material
from lightcube.optics.tables import power_bounds
from lightcube.pictures.fitting import Fit, fit
from lightcube.pictures.pictures import Pictures
from lightcube.pictures.targets import Targets
from lightcube.pictures.turntable import Turntable
from lightcube.solvers import find_method

_OWN = {each.name for each in fields(Recipe)}
_LIGHT = ("lamp_power", "lamp_max", "black")


def asked(targets: Targets, grid: Grid, **options: Any) -> dict[str, Any]:
    """What `solve` takes: options of the recipe (`max_extinction` its material's), of lamp and screen, and others.

    By thin beams, unless light is said: what is exact is known of those.
    """
    own = {"light": Light.thin()} | {name: value for name, value in options.items() if name in _OWN}
    light = {name: value for name, value in options.items() if name in _LIGHT}
    others = {name: value for name, value in options.items() if name not in (*_OWN, *_LIGHT)}
    if not find_method(options.get("method", "display")).chooses_lamps and not light:
        light["lamp_power"] = 1.0  # they cannot choose it
    if "max_extinction" in others:
        own["material"] = Material(others.pop("max_extinction"))
    return {"targets": lit(targets, **light), "grid": grid, "recipe": Recipe(**own), **others}


def lit(
    targets: Targets, *, lamp_power: float | None = None, lamp_max: float | None = None, black: float | None = None
) -> Targets:
    """The same targets under lamps of one given power, or of another largest one, on screens of another black."""
    rig = targets.rig
    lamps, screens = rig.lamps, rig.screens
    if lamp_power is not None or lamp_max is not None:
        least, most = power_bounds(lamp_power, lamp_max)
        lamps = replace(lamps, least=np.full(len(lamps.names), least), most=np.full(len(lamps.names), most))
    if black is not None:
        screens = replace(screens, black=np.full(len(screens.names), black))
    return replace(targets, rig=replace(rig, lamps=lamps, screens=screens))


def fitted(
    pictures: Pictures, grid: Grid, *, fit_mode: Fit = "crop", picture_width: float = 1.0, **said: Any
) -> Targets:
    """Pictures fitted to a turntable that is made for them."""
    return fit(pictures, Turntable(**said).rig(pictures, grid, picture_width=picture_width), fit_mode)
