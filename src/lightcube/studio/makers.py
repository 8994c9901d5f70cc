"""What carves solids and presses plates, in the process that makes things: both are quick, and begun anew."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

import numpy as np

from lightcube.events import Interrupted, Progress
from lightcube.studio.solver import Deed, Task, tell_thing, tell_wall
from lightcube.studio.worker import Told
from lightcube.verbs import hull_words, hulls, making, reliefs

#: Parts of carving: to have read, to have made, of all.
_READ, _MADE, _ALL = 1, 18, 20
#: What of a sentence is to be typed: in brackets, or behind a colon or semicolon.
_TYPED = re.compile(r"\s*\((?:[^()]*--|lightcube )[^()]*\)|[;:] (?:lightcube |--)[^;]*")


def carve(told: Told, deed: Deed, task: Task) -> None:
    """Carve a solid."""
    options, cutting, how = task.how
    from lightcube import io  # here: what makes files comes with it
    from lightcube.drawing.overlay import tiles
    from lightcube.solids.reach import count_pieces
    from lightcube.solids.shape import as_cube

    def far(done: int, of: int) -> None:
        if told.pass_on(Progress(_READ + (_MADE - _READ) * done // max(of, 1), _ALL)):
            raise Interrupted

    wanted = hulls.read([task.source], options, cutting)
    far(0, 1)
    made = making.make(wanted, how, far)
    far(1, 1)
    io.Output(task.out, "shape", overwrite=True).write(made.shape)
    found = hulls.certificate(task.out, made.shape)
    said = [
        *making.in_words(made, is_placed=bool(wanted.placed)),
        *hull_words.results(made.shape, found, count_pieces(made.shape.inside)),
    ]
    tell_wall(told, made.shape.names, map(np.asarray, tiles(made)), int(max(made.shape.grid.shape)))
    tell_thing(told, as_cube(made.shape), task.title)
    pictures = [{"name": name, "psnr": None} for name in made.shape.names]
    told("done", pictures=pictures, psnr=None, said=without_commands(said))


def press(told: Told, deed: Deed, task: Task) -> None:
    """Press a plate."""
    recipe, is_colour = task.how
    from lightcube import io  # here: what makes files comes with it
    from lightcube.drawing.relief_sheet import as_seen
    from lightcube.optics.transfer import to_uint8
    from lightcube.scoring.reliefs import score_relief
    from lightcube.solids.relief_light import shown
    from lightcube.solids.relief_making import relief
    from lightcube.studio import plates

    made = relief(reliefs.read([task.source]), recipe, colour=is_colour, tell=told.pass_on)
    told("said", sentence="looking at what its lamps show")
    scores = score_relief(made, off=True)
    io.Output(task.out, "relief", overwrite=True).write(made)
    names = names_of(made)
    tell_wall(told, names, [to_uint8(picture) for picture in as_seen(made, shown(made))], recipe.side)
    tell_thing(told, made, task.title)
    pictures = [{"name": name, "psnr": None} for name in names]
    told("done", pictures=pictures, psnr=None, said=plates.told(made, scores))


def names_of(made: Any) -> tuple[str, ...]:
    """Of a plate's pictures; three coloured lamps show one."""
    return (made.names[0].removesuffix(" red"),) if made.is_colour else made.names


def without_commands(said: Iterable[str]) -> list[str]:
    """Sentences for people who have no terminal: without what is to be typed."""
    plain = (_TYPED.sub("", each) for each in said)
    return [each for each in plain if "lightcube " not in each and "--" not in each]
