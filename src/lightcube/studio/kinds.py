"""What a project can become: a table from a name to its words, its pictures, its settings, and who makes it."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from lightcube.errors import InputError
from lightcube.solids.relief import LAMPS_DEG, MOST, side_of
from lightcube.solids.walls import WALLS
from lightcube.studio import foretelling, makers, making
from lightcube.studio.forecaster import Foretell, of_a_turntable
from lightcube.studio.kept import dropped
from lightcube.studio.project import MADE, PICTURES, KindName, Picture, Project, Settings
from lightcube.studio.rooms import FILE, PART, pictures_of, room_of
from lightcube.studio.solver import Make, solve
from lightcube.wording import counted

#: Pictures that films show at most: so many lamps stand in three rows.
_MOST_OF_FILMS = 9


@dataclass(frozen=True)
class Kind:
    """Something that a project can become.

    Parameters
    ----------
    title, said
        For people who choose: what it is, and what one sees of it.
    called, are
        In sentences: "the cube", "is".
    wants
        What pictures are dropped for it.
    settings
        Which of the settings say how it is made.
    counts
        How many pictures it takes, at least and at most.
    how, words
        What the settings say: as its verb takes it, and as it is typed.
    verb, source, file
        The command, what of the folder it reads, and what it writes in the folder of what was made.
    make, foretell
        Make it, and tell what will come, each in a process of its own.
    things
        What can be taken away, by the name of its table.
    also
        What else of the settings it depends on.
    places
        Where pictures stand, in their order, if it is known and worth a word.
    can_pause
        Whether what was begun can be gone on with.
    """

    title: str
    said: str
    called: str
    wants: str
    settings: str
    counts: Callable[[Settings], tuple[int, int]]
    how: Callable[[Settings], Any]
    words: Callable[[Settings], list[str]]
    verb: Literal["solve", "hull", "relief"]
    file: str
    make: Make
    foretell: Foretell
    things: Literal["cubes", "films", "solids", "plates"]
    source: str = PICTURES
    also: Callable[[Settings], Any] = lambda _: None
    places: Callable[[Settings], Sequence[str]] = lambda _: ()
    are: Literal["is", "are"] = "is"
    can_pause: bool = True

    @property
    def stem(self) -> str:
        """What the names of all that belongs to it begin with."""
        return self.file.partition(".")[0]

    def called_in(self, settings: Settings) -> str:
        """What a project calls it; what it is where nothing is said."""
        return settings.title or self.title.removeprefix("A ").capitalize()


def _of_shape(settings: Settings) -> tuple[int, int]:
    """Three walls take a picture each."""
    return (3, 3) if settings.shape.where == "walls" else (2, making.MOST_PICTURES)


def _on_walls(settings: Settings) -> Sequence[str]:
    """On which wall a picture stands; whose names say so are put there by these."""
    by_name = sorted(picture.name.lower() for picture in settings.pictures[: len(WALLS)]) == sorted(WALLS)
    given = settings.shape.where == "walls" and settings.shape.placement == "given"
    return WALLS if given and not by_name else ()


def _in_room(settings: Settings) -> Sequence[str]:
    """On which screen a picture stands, and at which stop where there are several."""
    room = room_of(settings)
    if room is None:
        return ()
    stops = [""] if len(room.stops_deg) == 1 else [f" {number + 1}" for number in range(len(room.stops_deg))]
    return [f"{screen.name}{stop}" for screen in room.screens for stop in stops]


#: The table, in the page's order.
KINDS: Mapping[KindName, Kind] = {
    "cube": Kind(
        title="A light cube",
        said="Coloured glass on a turntable. At each stop its shadow is another picture.",
        called="the cube",
        wants="Photographs, drawings, an animation or a video. At each stop of the turning cube its shadow will be one "
        "of them.",
        settings="making",
        counts=lambda settings: (2, settings.making.count or making.MOST_PICTURES),
        how=lambda settings: making.of_cube(settings.making),
        words=lambda settings: making.option_words(making.of_cube(settings.making)),
        verb="solve",
        file="cube.zarr",
        make=solve,
        foretell=of_a_turntable,
        things="cubes",
    ),
    "shape": Kind(
        title="A solid",
        said="An opaque object to print. Its black shadows are letters or outlines, one on each wall.",
        called="the solid",
        wants="Dark shapes on plain ground: letters, logos, outlines. Three of them: from the front, from the right "
        "side, and from above.",
        settings="shape",
        counts=_of_shape,
        how=lambda settings: making.of_shape(settings.shape),
        words=lambda settings: making.shape_words(settings.shape),
        verb="hull",
        file="solid.shape.zarr",
        places=_on_walls,
        make=makers.carve,
        foretell=foretelling.of_a_solid,
        things="solids",
        can_pause=False,
    ),
    "plate": Kind(
        title="A white plate",
        said="A relief to print. Under each of up to four low lamps its shadows are another picture.",
        called="the plate",
        wants="One to four pictures with clear lights and darks; they become square, and grey.",
        settings="plate",
        counts=lambda settings: (1, 1 if settings.plate.colour else MOST),
        how=lambda settings: making.of_plate(settings.plate),
        words=lambda settings: making.plate_words(settings.plate),
        verb="relief",
        file="plate.relief.zarr",
        places=lambda settings: () if settings.plate.colour else [f"lamp {side_of(each)}" for each in LAMPS_DEG],
        make=makers.press,
        foretell=foretelling.of_a_plate,
        things="plates",
        can_pause=False,
    ),
    "films": Kind(
        title="Printed films",
        said="A few transparencies above each other. Under each lamp they cast another picture.",
        called="the films",
        wants="Two to nine photographs or drawings. There is a lamp for each of them.",
        settings="films",
        counts=lambda _: (2, _MOST_OF_FILMS),
        how=lambda settings: making.of_films(settings.films),
        words=lambda settings: making.film_words(settings.films),
        verb="solve",
        file="films.zarr",
        make=solve,
        foretell=foretelling.of_films,
        things="films",
        are="are",
    ),
    "room": Kind(
        title="A cube in your room",
        said="A light cube between the lamps and walls that you set up under Room.",
        called="the cube",
        wants="A picture for each wall at each stop of the turntable.",
        settings="making",
        counts=lambda settings: (pictures_of(settings),) * 2,
        how=lambda settings: making.in_room(settings.making),
        words=lambda settings: making.option_words(making.in_room(settings.making)),
        verb="solve",
        file="room.zarr",
        make=solve,
        foretell=foretelling.of_a_room,
        things="cubes",
        source=FILE,
        also=lambda settings: settings.parts.get(PART),
        places=_in_room,
    ),
}
#: What the page is told of a kind.
_TOLD = ("title", "said", "called", "are", "wants", "settings", "can_pause")


def kind_of(settings: Settings) -> Kind:
    """What a project is to become."""
    return KINDS[settings.kind]


def used(settings: Settings) -> tuple[Picture, ...]:
    """The pictures that it is made of."""
    return settings.pictures[: kind_of(settings).counts(settings)[1]]


def made_of(settings: Settings) -> str:
    """All that it depends on, to see whether that has changed."""
    kind = kind_of(settings)
    pictures = [picture.model_dump() for picture in used(settings)]
    return json.dumps([settings.kind, repr(kind.how(settings)), pictures, kind.also(settings)], sort_keys=True)


def check_there(project: Project) -> None:
    """Raise `InputError` where pictures that are used are gone from the folder, or there are too few."""
    settings = project.settings
    kind, pictures = kind_of(settings), used(settings)
    least, _ = kind.counts(settings)
    if len(pictures) < max(least, 1):
        there = "is one" if len(pictures) == 1 else f"are {len(pictures)}" if pictures else "is none"
        needs = "needs" if kind.are == "is" else "need"
        raise InputError(f"{kind.called} {needs} at least {counted(least, 'picture')}, and there {there}: drop more")
    gone = [picture.name for picture in pictures if not dropped(project, picture.key).is_file()]
    if gone:
        raise InputError(
            f"{counted(len(gone), 'picture')} vanished from the folder ({', '.join(gone[:3])}): remove and drop again"
        )


def command_of(folder: Path, settings: Settings) -> str:
    """The command that makes the same in a terminal."""
    kind = kind_of(settings)
    places = [str(folder / kind.source), "-o", str(folder / MADE / kind.file)]
    return shlex.join(["lightcube", kind.verb, *places, *kind.words(settings), "--overwrite"])


def described() -> list[dict[str, Any]]:
    """The table as the page is told of it."""
    return [{"name": name, **{told: getattr(kind, told) for told in _TOLD}} for name, kind in KINDS.items()]
