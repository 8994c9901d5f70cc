"""What will come of films, of a cube in a room, of a solid and of a plate: told from smaller or less careful ones."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from lightcube.errors import InputError
from lightcube.events import Progress, Said
from lightcube.studio.forecaster import FIRST, Asked, Look, Looking, facts, looks_of, mark_of, told_of_cube
from lightcube.studio.makers import names_of, without_commands

#: Passes of films in a first look, cells along a picture, and voxels of a solid's block along its longest side in both.
_PASSES, _CELLS, _VOXELS = 12, 32, (32, 56)
#: Columns of a plate in a first look, and how often each is offered another height.
_COLUMNS, _SWEEPS = 48, 20
#: So much of an outline is to be as it was drawn.
_GOOD, _FAIR = 0.97, 0.9


def of_films(looking: Looking, asked: Asked) -> Iterator[dict[str, Any]]:
    """Films of fewer cells, then those that are asked for, in a few passes."""
    from lightcube.backward.solving import solve
    from lightcube.planning.prediction import reached
    from lightcube.verbs import solving

    began = time.monotonic()
    quick = replace(asked.how, n=min(_CELLS, asked.how.n), quality=None, iterations=_PASSES)
    for stage, options in (("first", quick), ("whole", replace(asked.how, quality="draft"))):
        planned = solving.read(str(asked.source), options, told=False)(solving.rehearsals())
        cube = solve(planned.targets, planned.grid, planned.recipe, callback=looking.watch).cube
        told = reached(planned.targets, cube)
        notes = planned.doubtful if stage == "whole" else ()
        yield facts(asked, looks_of(cube, told, [""] * len(told)), began, stage, notes)
    looking.show(asked, cube)


def of_a_room(looking: Looking, asked: Asked) -> Iterator[dict[str, Any]]:
    """Small cubes in the room of a stage file."""
    from lightcube.verbs import solving

    began = time.monotonic()
    planned = solving.read(str(asked.source), replace(asked.how, grain=0.0), told=False)(solving.rehearsals())
    if planned.impossible:
        raise InputError(f"in this room {planned.impossible[0]}")
    yield told_of_cube(asked, planned, *looking.look(planned, FIRST), began, "first")
    small, cube = looking.look(planned)
    yield told_of_cube(asked, planned, small, cube, began, "whole") | {"notes": planned.doubtful}
    looking.show(asked, cube)


def of_a_solid(looking: Looking, asked: Asked) -> Iterator[dict[str, Any]]:
    """A coarser solid, first with what no solid casts left out, then as it will be made to agree."""
    from lightcube.drawing.overlay import tiles
    from lightcube.solids.shape import as_cube
    from lightcube.verbs import hull_words, hulls, making

    began = time.monotonic()
    options, cutting, how = asked.how
    tried = [("first", _VOXELS[0], replace(how, way="trim", carving="none")), ("whole", _VOXELS[1], how)]
    for stage, most, way in tried:
        wanted = hulls.read([str(asked.source)], replace(options, n=min(most, options.n)), cutting)
        made = making.make(wanted, way, lambda *_: looking.give_way())
        doubts = hull_words.doubts(wanted)
        reasons = {name: _first_of(name, doubts) for name in made.given.names}
        notes = [each for each in doubts if not any(each.startswith(f"{name}: ") for name in reasons)]
        notes += making.in_words(made, is_placed=bool(wanted.placed))
        looks = [
            Look(name, np.asarray(levels), _kept(overlap), f"{overlap:.0%} as drawn", reasons[name])
            for name, levels, overlap in zip(made.given.names, tiles(made), made.overlaps, strict=True)
        ]
        yield facts(asked, looks, began, stage, notes if stage == "whole" else ())
    looking.show(asked, as_cube(made.shape))


def _first_of(name: str, doubts: Sequence[str]) -> str:
    """The first doubt about a picture, for people who have no terminal."""
    about = [each.removeprefix(f"{name}: ") for each in doubts if each.startswith(f"{name}: ")]
    return next(iter(without_commands(about)), "")


def _kept(overlap: float) -> str:
    """How good an outline is of which so much is as it was drawn."""
    return "good" if overlap >= _GOOD else "fair" if overlap >= _FAIR else "poor"


def of_a_plate(looking: Looking, asked: Asked) -> Iterator[dict[str, Any]]:
    """A smaller plate, then the one that is asked for, made with a tenth of the care."""
    from lightcube.scoring.reliefs import score_relief
    from lightcube.solids.relief_making import relief
    from lightcube.studio import plates
    from lightcube.verbs import reliefs
    from lightcube.verbs.words import duration

    def tell(_: Progress | Said) -> None:
        looking.give_way()

    began = time.monotonic()
    recipe, is_colour = asked.how
    read = reliefs.read([str(asked.source)])
    quick = relief(read, replace(recipe, side=min(_COLUMNS, recipe.side), sweeps=_SWEEPS), colour=is_colour, tell=tell)
    yield facts(asked, _of_plate(quick, score_relief(quick)), began, "first")
    made, seconds = reliefs.rehearsed(read, recipe, colour=is_colour, tell=tell)
    scores = score_relief(made, off=True)
    notes = [*plates.foretold(made, scores), f"making it takes about {duration(seconds)}"]
    yield facts(asked, _of_plate(made, scores), began, "whole", notes)
    looking.show(asked, made)


def _of_plate(made: Any, scores: Any) -> list[Look]:
    """What each lamp of a plate shows, and how good that is from afar."""
    from lightcube.drawing.relief_sheet import as_seen, in_words
    from lightcube.optics.transfer import to_uint8
    from lightcube.solids.relief_light import shown

    judged = [(scores["near_psnr_mean"], scores["psnr_mean"])]
    if not made.is_colour:
        judged = [(each["near_psnr"], each["psnr"]) for each in scores["pictures"]]
    seen = (to_uint8(picture) for picture in as_seen(made, shown(made)))
    return [
        Look(name, levels, mark_of(far), in_words(near, far))
        for name, levels, (near, far) in zip(names_of(made), seen, judged, strict=True)
    ]
