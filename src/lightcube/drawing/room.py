"""A picture of the room in perspective: the cube of glass, its lamps, and the screens that carry its shadows.

The page that is turned by hand draws the same room, by the same laws.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from lightcube.drawing import tones
from lightcube.drawing.beam import Air, off_pictures
from lightcube.drawing.bending import draw_bent, draw_body, is_cut
from lightcube.drawing.camera import Camera, Canvas, Floats, Reals
from lightcube.drawing.eyes import AROUND
from lightcube.drawing.film_glass import FilmGlass
from lightcube.drawing.furniture import (
    Layers,
    draw_edges,
    draw_floor,
    draw_hints,
    draw_lamp,
    draw_picture,
    draw_sheets,
    draw_wall,
    table_layers,
)
from lightcube.drawing.glass import Glass
from lightcube.drawing.stacks import sheets
from lightcube.drawing.standing import PlacedLamp, PlacedScreen, Standing, drawn, extent, size_of, standing
from lightcube.forward.casting import screens
from lightcube.forward.turning import moment
from lightcube.optics.cube import Cube
from lightcube.optics.stack import Stack
from lightcube.optics.transfer import decode
from lightcube.optics.views import unit

#: An eye's iris is open as far as this from the middle of the picture, in halves of its diagonal, and shut there.
_OPEN, _SHUT = 1.1, 1.5


def room_picture(cube: Cube, angle_deg: float, camera: Camera) -> Floats:
    """The room at a turntable angle (degrees), ``(row, column, 3)`` linear light, 1 = white."""
    return Room(cube).seen(camera, angle_deg)


class Room:
    """A cube's room, laid out for being drawn at any angle, from any eye."""

    def __init__(self, cube: Cube) -> None:
        self.cube = cube
        self._cast = screens(cube, picture_only=True, zoom=1, light="area")
        self._glass = FilmGlass(cube) if isinstance(cube.grid, Stack) else Glass(cube)
        rooms = [standing(cube, angle_deg) for angle_deg in np.unique(cube.angles_deg)]
        self._places = np.concatenate([screen.corners for room in rooms for screen in room.screens])
        low = min(float(extent(cube.grid, standing(cube, angle_deg))[:, 2].min()) for angle_deg in AROUND)
        self._low = low - 0.02 * size_of(cube.grid)
        self._last: tuple[float, list[Floats]] | None = None  # what was cast last
        self._still: tuple[Camera, Reals, tuple[Canvas, Floats]] | None = None  # the room without cube and light

    def seen(self, camera: Camera, angle_deg: float, *, lit: bool = True, bare: float = 0.0) -> Floats:
        """What a camera sees at a turntable angle (degrees), ``(row, column, 3)`` linear light.

        Parameters
        ----------
        lit
            Whether its lamps are on.
        bare
            0: glass as one likes to see it. 1: for an eye that is where a lamp is, glass as that lamp's light goes
            through it, from an iris that keeps it to the picture and its mat, and nothing else.
        """
        now, grid = standing(self.cube, angle_deg), self.cube.grid
        lamps = self.lamps_on(angle_deg)
        if not lit:
            now = replace(now, lamps=tuple(replace(lamp, light=0 * lamp.light) for lamp in now.lamps))
            lamps = [[] for _ in lamps]
        pictures = self.shown(angle_deg, lit=lit)
        canvas, floor = self._walls(camera, now, pictures, lit=lit)
        light = np.sum([lamp.light for lamp in now.lamps], axis=0)
        ember = tones.EMBER * light / light.max(initial=1e-9)
        glass = self._glass.seen(canvas, now, ember, bare)
        table = None if isinstance(grid, Stack) else table_layers(canvas, grid, now, floor)
        off = off_pictures(canvas, now.screens)
        clear = self.cube.rig.glass
        air = Air(canvas, grid)
        for screen, picture, own in zip(now.screens, pictures, lamps, strict=True):
            for lamp in own[: clear is None]:  # what is bent is drawn in lines
                air.take(lamp, screen, picture)
        for front in (False, True):
            self._overlay(canvas, now, table, lamps, 1 - bare, front=front)
            air.lay(off, 1 - bare, front=front)
            if glass is not None and not front:
                self._behind(canvas, angle_deg, bare)
                glass.lay(canvas)
        if isinstance(grid, Stack):
            draw_sheets(canvas, sheets(grid, now.films), 1 - bare)
        elif not is_cut(clear):
            draw_edges(canvas, grid, now.turn, 1 - bare)
        if clear is not None:
            rig = moment(drawn(self.cube), [angle_deg])[0]
            draw_body(canvas, grid, rig, now, 1 - bare)
            if lit:
                draw_bent(canvas, rig, now, 1 - bare)
        return canvas.picture()

    def shown(self, angle_deg: float, *, lit: bool = True) -> list[Floats]:
        """What stands on each screen at an angle; unlit, it is as any other part of the wall."""
        rig = self.cube.rig.at([angle_deg])[0]
        if not lit:
            return [np.full((1, 1, 3), tones.WALL, np.float32)] * len(rig)
        if self._last is None or self._last[0] != angle_deg:
            cast = self._cast(np.array([angle_deg]))
            pictures = [each[:rows, :columns] for each, (rows, columns) in zip(cast, rig.stops.window, strict=True)]
            self._last = angle_deg, pictures
        return self._last[1]

    def _walls(self, camera: Camera, now: Standing, pictures: list[Floats], *, lit: bool) -> tuple[Canvas, Floats]:
        """A canvas with the floor and the screens, and the floor's inverse depth; kept where no light falls on them."""
        places = np.array([screen.corners for screen in now.screens])
        kept = self._still
        if not lit and kept is not None and kept[0] == camera and np.allclose(kept[1], places):
            return kept[2][0].copy(), kept[2][1]
        canvas, grid = Canvas(camera), self.cube.grid
        means = [np.broadcast_to(picture.mean(axis=(0, 1)), 3) for picture in pictures]
        floor = draw_floor(canvas, grid, self._on_floor(now), self._low, means)
        for screen, picture in zip(now.screens, pictures, strict=True):
            draw_wall(canvas, screen, self._width(screen), picture)
        if not lit:
            self._still = camera, places, (canvas.copy(), floor)
        return canvas, floor

    def _width(self, screen: PlacedScreen) -> float | Reals:
        """How far a wall goes on beyond its picture; a screen with edges has a frame.

        A stack's lies on one sheet of paper, which has room for all its pictures.
        """
        if isinstance(self.cube.grid, Stack):
            return self._paper(screen)
        if not np.all(self.cube.rig.screens.endless):
            return tones.FRAME * size_of(self.cube.grid)
        return tones.WALL_WIDTH * float(np.linalg.norm(screen.right)) * max(screen.pixels)

    def _paper(self, screen: PlacedScreen) -> Reals:
        """What a sheet has left around one of its pictures: to the left, to the right, above and below."""
        frame, spare = tones.PAPER * size_of(self.cube.grid), []
        for step, count in ((screen.right, screen.pixels[1]), (screen.down, screen.pixels[0])):
            along = (self._places - screen.corner) @ unit(step)
            spare += [-float(along.min()), float(along.max()) - count * float(np.linalg.norm(step))]
        return np.maximum(spare, 0) + frame

    def _on_floor(self, now: Standing) -> Standing:
        """What stands on the floor and shades it: of a stack the whole sheet of paper instead of its pictures."""
        if not isinstance(self.cube.grid, Stack):
            return now
        papers = []
        for screen in now.screens:
            left, right, above, below = self._paper(screen)
            across, down = unit(screen.right), unit(screen.down)
            high, wide = screen.pixels[0] * screen.down, screen.pixels[1] * screen.right
            corner = screen.corner - left * across - above * down
            papers.append(PlacedScreen(corner, wide + (left + right) * across, high + (above + below) * down, (1, 1)))
        return replace(now, screens=tuple(papers))

    def lamps_on(self, angle_deg: float) -> list[list[PlacedLamp]]:
        """For each screen the lamps that light it at an angle, with their light there, the brightest first."""
        rig, powers = moment(self.cube, [angle_deg])
        light = powers[rig.pair] * rig.sums.share
        placed = standing(self.cube, angle_deg).lamps
        found = []
        for picture in range(len(rig)):
            own = [
                replace(lamp, light=light[(rig.sums.picture == picture) & (rig.sums.lamp == number)].sum(axis=0))
                for number, lamp in zip(np.unique(self.cube.rig.sums.lamp), placed, strict=True)
            ]
            lit = [lamp for lamp in own if np.any(lamp.light > 0)]
            found.append(sorted(lit, key=lambda lamp: -float(lamp.light.max())))
        return found

    def eyes_lamp(self, angle_deg: float) -> tuple[PlacedScreen, PlacedLamp]:
        """The lamp whose eye one takes, with its light: the brightest one that lights the first lit screen."""
        number, lamps = self._first_lit(angle_deg)
        return standing(self.cube, angle_deg).screens[number], lamps[0]

    def _first_lit(self, angle_deg: float) -> tuple[int, list[PlacedLamp]]:
        """The first screen on which anything shines."""
        return next((number, lamps) for number, lamps in enumerate(self.lamps_on(angle_deg)) if lamps)

    def from_lamp(self, camera: Camera, angle_deg: float) -> Floats:
        """What stands on the wall of the lamp whose eye a camera is, where it sees it, in the dark."""
        number, _ = self._first_lit(angle_deg)
        canvas = Canvas(camera)
        draw_picture(canvas, standing(self.cube, angle_deg).screens[number], self.shown(angle_deg)[number])
        return canvas.picture()

    def _behind(self, canvas: Canvas, angle_deg: float, bare: float) -> None:
        """Put the light of the lamp whose eye one takes behind the glass, and leave the rest of the room dark."""
        if not bare:
            return
        screen, lamp = self.eyes_lamp(angle_deg)
        _, across, below = canvas.plane(screen.corner, screen.right, screen.down, canvas.whole)
        part = decode(_iris(below, across, screen.pixels), self.cube.transfer)
        light = part[..., None] * [lamp.light[min(i, len(lamp.light) - 1)] for i in range(3)]
        there = (canvas.glass > canvas.near)[..., None]
        canvas.light += np.float32(bare) * (np.where(there, light.astype(np.float32), 0) - canvas.light)

    def _overlay(
        self,
        canvas: Canvas,
        now: Standing,
        table: Layers | None,
        lamps: list[list[PlacedLamp]],
        part: float,
        *,
        front: bool,
    ) -> None:
        """Draw the table, the lamps and thin lines: those that lie before the cube's glass, or those behind it."""
        if table is not None:
            region, near, layers = table
            for light, strength in layers:
                canvas.blend(region, near, light, part * strength, front)
        if self.cube.rig.glass is None:
            draw_hints(canvas, now, lamps, part, front)
        for lamp in now.lamps:
            draw_lamp(canvas, self.cube.grid, lamp, part, front)


def _iris(down: Floats, across: Floats, window: tuple[int, int]) -> Floats:
    """What a round iris lets through at some rows and columns of a picture, in display values; all of the picture."""
    rows, columns = window
    away = np.hypot(down - rows / 2, across - columns / 2) / (math.hypot(rows, columns) / 2)
    part = np.clip((_SHUT - away) / (_SHUT - _OPEN), 0, 1)
    return np.asarray(part * part * (3 - 2 * part), np.float32)
