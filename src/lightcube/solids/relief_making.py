"""From pictures to a relief whose shadows they are."""

from __future__ import annotations

from dataclasses import replace
from importlib.metadata import version

from lightcube.events import Tell
from lightcube.optics.checks import checked
from lightcube.pictures.pictures import Pictures
from lightcube.solids import relief_local as local
from lightcube.solids.relief import Relief, ReliefRecipe
from lightcube.solids.relief_annealing import annealed
from lightcube.solids.relief_light import unbounced
from lightcube.solids.relief_pictures import wanted_of


@checked
def relief(
    pictures: Pictures, recipe: ReliefRecipe | None = None, *, colour: bool = False, tell: Tell | None = None
) -> Relief:
    """Make one relief that shows a picture under each of up to four low lamps.

    Parameters
    ----------
    pictures
        One to four; the lamps stand to the right, to the left, behind and in front.
    recipe
        How; None: 128 columns a side, for photographs.
    colour
        Whether the one picture is shown in colour, by a red, a green and a blue lamp.
    tell
        Is told of the progress; True stops the work.

    Warns
    -----
    CroppedPictures, DarkPictures
        Where a picture is no square, or a black is asked for that no relief can show.

    Raises
    ------
    InputError
        Where there are more pictures than lamps, one is all of one tone, or walls would be too high.
    Interrupted
        Where `tell` stops the work.

    Examples
    --------
    >>> import numpy as np, lightcube as lc
    >>> light = np.linspace(0, 1, 24 * 24 * 3, dtype=np.float32).reshape(24, 24, 3)
    >>> pictures = lc.Pictures((light, light[::-1]), ("down", "up"))
    >>> plate = lc.relief(pictures, lc.ReliefRecipe(side=24, sweeps=5))
    >>> plate.names, plate.azimuths_deg, plate.heights_px.shape
    (('down', 'up'), (0.0, 180.0), (24, 24))
    """
    wishes = ReliefRecipe() if recipe is None else recipe
    origin = {"lightcube": version("lightcube")}
    if wishes.method == "global":
        wishes = replace(wishes, black=wishes.black_level)
        wanted, names = wanted_of(pictures, wishes, wishes.side, colour=colour)
        heights = annealed(wanted, wishes, tell)
        return Relief(heights, wanted, wishes, names, colour, provenance=origin).layered()
    side, width = local.check_local(len(pictures), wishes, colour=colour), local.width_of(wishes)
    wishes = replace(wishes, black=local.black_of(wishes))
    wanted, names = wanted_of(pictures, wishes, side, colour=False)
    heights, drift = local.walled(unbounced(wanted, wishes.bounce), width)
    local.check_height(heights, drift, wishes)
    return Relief(heights, wanted, wishes, names, cell=width + 1, provenance={**origin, "drift_px": drift}).layered()
