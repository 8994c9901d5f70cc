"""Light that is reflected twice between the faces of a stack of films, and arrives where it does not belong.

Fresnel's law at upright incidence: a face between air and film of index n reflects ``((n - 1) / (n + 1))^2``. Light
that is reflected at one face and again at another goes through what is between three times, and through the rest once.
"""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np

from lightcube.errors import InputError

#: Indices of refraction of film (PET) and of plates between films (acrylic).
FILM, PLATE = 1.6, 1.49


class Ghosts(NamedTuple):
    """What becomes of light in a stack: parts of what comes in, and of what goes straight through."""

    #: Part of the light that goes straight through clear films.
    through: float
    #: Light that was reflected twice between different films, as a part of what goes straight through.
    displaced: float
    #: The same within one film, which blurs by less than its thickness.
    within: float


def ghosts(films: int, density: float = 0.0, *, loose: bool = True, plates: bool = False) -> Ghosts:
    """Ghosts of so many films, each printed with a mean density (base 10).

    Parameters
    ----------
    loose
        Whether there is air between the films; bonded ones reflect at the outermost faces only.
    plates
        Whether loose plates lie between them too.

    Raises
    ------
    InputError
        Where there is no film, or a density is negative.
    """
    if films < 1 or not 0 <= density < math.inf:
        raise InputError(f"ghosts are of 1 film or more of a density of at least 0, not of {films} of {density:g}")
    mirror, plate = (((index - 1) / (index + 1)) ** 2 for index in (FILM, PLATE))
    ink = 10.0**-density
    # every layer from below: what it lets through, and what it reflects, faces one by one
    layers: list[tuple[float, float]] = []
    for film in range(films):
        top, bottom = loose or film == 0, loose or film == films - 1
        layers += [(1 - mirror, mirror)] * top + [(ink, 0.0)] + [(1 - mirror, mirror)] * bottom
        if loose and plates and film < films - 1:
            layers += [(1 - plate, plate)] * 2
    faces = [number for number, (_, reflected) in enumerate(layers) if reflected]
    through = float(np.prod([passed for passed, _ in layers]))
    displaced = within = 0.0
    for low, high in itertools.combinations(faces, 2):
        between = layers[low + 1 : high]
        part = layers[low][1] * layers[high][1] * float(np.prod([passed for passed, _ in between])) ** 2
        if loose and len(between) == 1 and between[0][1] == 0:
            within += part
        else:
            displaced += part
    return Ghosts(through / ink**films, displaced, within)
