"""The room: lamps and screens that are moved in a plan, what cannot be among them, and the stage's file of it."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Annotated, Any

from fastapi import APIRouter
from pydantic import Field, ValidationError, model_validator

from lightcube.errors import InputError, shown
from lightcube.io._files import system_errors
from lightcube.optics.grid import Grid
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.planning.feasibility import doubtful, impossible
from lightcube.studio.desk import Desk
from lightcube.studio.making import Strict
from lightcube.studio.project import PICTURES, Project, Settings

#: The stage file of a project, and what of the settings keeps the room.
FILE, PART = "room.toml", "rooms"
#: Voxels along a side of the cube that is looked at, and their whole length, mm.
_VOXELS, _SIZE_MM = 48, 100.0
#: Letters of a picture's name at most.
_LETTERS = 64
#: What is nearer to the turntable's axis than this, mm, is above or below the cube.
_ASIDE_MM = 1.0
#: A bulb's pixels are so many times as wide as voxels at most.
_MOST_TIMES = 8.0
_Mm = Annotated[float, Field(ge=-1000, le=1000, allow_inf_nan=False)]
_Name = Annotated[str, Field(pattern=r"^[^\W_](?:[\w -]{0,28}[^\W_])?$")]


class Standing(Strict):
    """Where something stands, mm: x to the right and y up in the plan, z up in the room."""

    name: _Name
    x: _Mm
    y: _Mm
    z: _Mm


class RoomLamp(Standing):
    """A lamp: far away, in the direction of its place, or a bulb that stands there."""

    far: bool = True


class RoomScreen(Standing):
    """A screen: a wall that faces the turntable's axis, or lying; lit by one lamp, for a picture at each stop."""

    lying: bool = False
    side_mm: Annotated[float, Field(ge=5, le=400, allow_inf_nan=False)] = 50.0
    lamp: _Name


class Room(Strict):
    """A room with a turntable in its middle."""

    lamps: Annotated[list[RoomLamp], Field(min_length=1, max_length=8)]
    screens: Annotated[list[RoomScreen], Field(min_length=1, max_length=8)]
    stops_deg: Annotated[
        list[Annotated[float, Field(ge=-360, le=360, allow_inf_nan=False)]], Field(min_length=1, max_length=24)
    ]

    @model_validator(mode="after")
    def _hangs_together(self) -> Room:
        lamps = {lamp.name for lamp in self.lamps}
        for screen in self.screens:
            if screen.lamp not in lamps:
                raise InputError(
                    f"screen {screen.name!r} is lit by {screen.lamp!r}, and there is no such lamp: choose one"
                )
        for lamp in self.lamps:
            if lamp.far and math.hypot(lamp.x, lamp.y, lamp.z) < _ASIDE_MM:
                raise InputError(f"lamp {lamp.name!r} stands in the cube's middle: move it out")
        return self


def router(desk: Desk) -> APIRouter:
    """What the editor of the room asks."""
    made = APIRouter(prefix="/api/rooms")
    desk.minding.insert(0, lambda: write(desk.project))  # before others read it
    desk.starting.insert(0, lambda: write(desk.project))

    @made.post("/check")
    def check(room: Room) -> dict[str, Any]:
        """What cannot be in a room, what is probably not meant, and which things each sentence is about."""
        return checked(room)

    @made.post("/keep")
    def keep(room: Room) -> dict[str, Any]:
        """Let the project become a cube for this room; refused while something cannot be."""
        found = checked(room)
        if found["impossible"]:
            raise InputError(f"this room cannot be yet: {found['impossible'][0]['sentence']}")
        kept = room.model_dump(mode="json")
        return desk.change(
            lambda before: before.model_copy(update={"kind": "room", "parts": before.parts | {PART: kept}})
        )

    return made


def room_of(settings: Settings) -> Room | None:
    """The room that a project keeps; None where there is none."""
    try:
        return Room.model_validate(settings.parts.get(PART))
    except ValidationError:
        return None


def pictures_of(settings: Settings) -> int:
    """How many pictures the room of a project shows."""
    room = room_of(settings)
    return 1 if room is None else len(room.screens) * len(room.stops_deg)


def write(project: Project) -> None:
    """Write the room into the project as a stage file, for the pictures that there are."""
    settings = project.settings
    room, file = room_of(settings), project.path(FILE)
    if room is None:
        return
    made = text(room, [picture.name for picture in settings.pictures], settings.making.voxels).encode()
    with system_errors(file, "reading"):
        before = file.read_bytes() if file.is_file() else b""
    if made != before:
        project.write(made, FILE)


def checked(room: Room) -> dict[str, Any]:
    """What is wrong with a room."""
    stage = stage_of(room)
    names = [each.name for each in (*room.lamps, *room.screens)]

    def told(sentences: list[str]) -> list[dict[str, Any]]:
        return [{"sentence": each, "about": [name for name in names if f"{name!r}" in each]} for each in sentences]

    return {
        "impossible": told(impossible(stage)),
        "doubtful": told(doubtful(stage)),
        "pictures": len(stage.shots),
    }


def stage_of(room: Room, voxels: int = _VOXELS) -> Stage:
    """A room as a stage; `InputError` where it is none."""
    grid = Grid((voxels, voxels, voxels), _SIZE_MM / voxels)
    return Stage(
        grid,
        tuple(_lamp(each) for each in room.lamps),
        tuple(
            Screen(
                each.name,
                (each.x, each.y, each.z),
                (each.side_mm, each.side_mm),
                _pitch_mm(room, each, voxels),
                normal=_facing(each),
            )
            for each in room.screens
        ),
        tuple(
            Shot(f"{each.name} {number + 1}", each.name, (each.lamp,), number)
            for each in room.screens
            for number in range(len(room.stops_deg))
        ),
        tuple(room.stops_deg),
    )


def _lamp(lamp: RoomLamp) -> Lamp:
    place = (lamp.x, lamp.y, lamp.z)
    if not lamp.far:
        return Lamp(lamp.name, position_mm=place)
    return Lamp(lamp.name, direction=_from(place))


def _from(place: tuple[float, float, float]) -> tuple[float, float, float]:
    """The way from a place to the cube's middle, of length 1."""
    far = math.hypot(*place)
    x, y, z = (round(-each / far, 6) + 0.0 for each in place)
    return x, y, z


def _pitch_mm(room: Room, screen: RoomScreen, voxels: int) -> float:
    """From pixel to pixel: as wide as the shadow of a voxel in the cube's middle."""
    lamp = next(each for each in room.lamps if each.name == screen.lamp)
    near, far = math.hypot(lamp.x, lamp.y, lamp.z), math.hypot(screen.x, screen.y, screen.z)
    times = 1.0 if lamp.far or near < _ASIDE_MM else min((near + far) / near, _MOST_TIMES)
    return round(_SIZE_MM / voxels * times, 4)


def _facing(screen: RoomScreen) -> tuple[float, float, float]:
    """Which way a screen faces: up or down to the cube where it lies, else level to the axis."""
    aside = math.hypot(screen.x, screen.y)
    if screen.lying or aside < _ASIDE_MM:
        return (0.0, 0.0, 1.0 if screen.z <= 0 else -1.0)
    return (round(-screen.x / aside, 6) + 0.0, round(-screen.y / aside, 6) + 0.0, 0.0)


def text(room: Room, names: Sequence[str], voxels: int) -> str:
    """A room as a stage file: the first screen has the first pictures, one for each stop, and so on."""
    stops = ", ".join(f"{each:g}" for each in room.stops_deg)
    lines = ["[cube]", f"shape = [{voxels}, {voxels}, {voxels}]", f"size_mm = {_SIZE_MM:g}", ""]
    lines += ["[turntable]", f"stops_deg = [{stops}]"]
    for lamp in room.lamps:
        place = (lamp.x, lamp.y, lamp.z)
        where = f"direction = {_listed(_from(place))}" if lamp.far else f"position_mm = {_listed(place)}"
        lines += ["", "[[lamp]]", f'name = "{lamp.name}"', where]
    for screen in room.screens:
        side = _listed((screen.side_mm, screen.side_mm))
        lines += ["", "[[screen]]", f'name = "{screen.name}"', f"centre_mm = {_listed((screen.x, screen.y, screen.z))}"]
        lines += [f"normal = {_listed(_facing(screen))}", f"size_mm = {side}"]
        lines.append(f"pitch_mm = {_pitch_mm(room, screen, voxels):g}")
    shots = [(screen, stop) for screen in room.screens for stop in range(len(room.stops_deg))]
    for number, ((screen, stop), name) in enumerate(zip(shots, names, strict=False), 1):
        lines += ["", "[[picture]]", f'file = "{PICTURES}/{number:04d}.png"']
        lines.append(f"name = {json.dumps(shown(name)[:_LETTERS].strip() or 'picture', ensure_ascii=False)}")
        lines += [f'screen = "{screen.name}"', f'lamps = ["{screen.lamp}"]', f"stop = {stop + 1}"]
    return "\n".join(lines) + "\n"


def _listed(numbers: tuple[float, ...]) -> str:
    return f"[{', '.join(f'{each:g}' for each in numbers)}]"
