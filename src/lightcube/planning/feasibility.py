"""What cannot be on a stage, what is probably not meant, and its facts: all from where things stand alone.

Lengths are mm, in the cube's own axes, as in `lightcube.optics.views`. Beams are those through the middles of pixels.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.optics.grid import PARALLEL
from lightcube.optics.stage import Lamp, Screen, Shot, Stage

Reals = NDArray[np.float64]
Flags = NDArray[np.bool_]

#: A screen is edge-on to light whose direction is nearer than this (sine) to its plane.
_EDGE = 1e-3
#: Two lamps cast the same beams where they differ by less (radians; parts of a point lamp's distance).
_SAME = 1e-6
#: Of a larger picture, so many beams along each side are looked at: for what is impossible, and for what is doubtful.
_BEAMS, _FEW = 256, 16
#: Pixels smaller than this at the cube's middle, in voxels, are much finer than it can show.
_FINE = 0.5


@dataclass(frozen=True, eq=False)
class _Beams:
    """Beams from one lamp to one picture: the lamp, and middle and steps of the picture's window, as in `Views`."""

    shot: Shot
    lamp: Lamp
    screen: Screen
    light: Reals
    middle: Reals
    right: Reals
    down: Reals

    @cached_property
    def normal(self) -> Reals:
        """Unit vector out of the screen's lit side."""
        normal = np.cross(self.down, self.right)
        return np.asarray((-normal if self.screen.rear else normal) / np.linalg.norm(normal))

    @property
    def fall(self) -> float:
        """How steeply the light falls on the screen's middle: cosine to its normal, below 0 on the lit side."""
        return float(self.ways(self.middle[None])[0][0] @ self.normal)

    def pixels(self, most: int = _BEAMS) -> Reals:
        """``(n, 3)``: middles of the pixels, or of at most so many equal parts along each side."""
        rows, columns = (
            (np.arange(min(count, most)) + 0.5) * (count / min(count, most)) - count / 2 for count in self.screen.pixels
        )
        return np.asarray(
            (self.middle + rows[:, None, None] * self.down + columns[None, :, None] * self.right).reshape(-1, 3)
        )

    def ways(self, points: Reals) -> tuple[Reals, Reals]:
        """Unit directions of the light at points, and how far it has come from the lamp, without end if parallel."""
        ways = points - self.light[:3] if self.light[3] else np.broadcast_to(self.light[:3], points.shape)
        lengths = np.maximum(np.linalg.norm(ways, axis=1), PARALLEL)
        return ways / lengths[:, None], lengths if self.light[3] else np.full(len(points), np.inf)

    def chords(self, points: Reals, half: Reals) -> tuple[Reals, Reals]:
        """How far past each point (before it: negative) its line enters and leaves the cube; it misses if not so."""
        units, _ = self.ways(points)
        units = np.where(np.abs(units) < PARALLEL, PARALLEL, units)
        ends = np.stack([(-half - points) / units, (half - points) / units])
        return ends.min(axis=0).max(axis=1), ends.max(axis=0).min(axis=1)

    def shadow(self, points: Reals, half: Reals) -> Flags:
        """Which points lie in the cube's shadow: the cube is between them and the lamp."""
        enter, leave = self.chords(points, half)
        return np.asarray(np.minimum(leave, 0) > np.maximum(enter, -self.ways(points)[1]) + _thin(half))

    def reach(self, points: Reals, other: "_Beams") -> tuple[Flags, Reals]:
        """Whether the light through the points meets another window, and how far past them (before: negative)."""
        units, come = self.ways(points)
        fall = units @ other.normal
        far = (other.middle - points) @ other.normal / np.where(np.abs(fall) < PARALLEL, PARALLEL, fall)
        hits = points + far[:, None] * units - other.middle
        inside = far > -come
        for step, count in zip((other.down, other.right), other.screen.pixels, strict=True):
            inside &= np.abs(hits @ step) <= (count / 2 + 1e-9) * (step @ step)
        return inside, far


def impossible(stage: Stage) -> list[str]:
    """Say what cannot be on this stage: one sentence each, with names, stops (counted from 1) and what to do.

    Lamps inside the cube, or between it and the screen; screens edge-on to a lamp, with their back to it, in front of
    the cube, through it, or out of its shadow; and pictures that are cast by the same beams: no cube shows both.
    """
    half = _half(stage)
    found, good = [], []
    for shot, lit in _by_shot(stage, _beams(stage)):
        troubles = [trouble for trouble in (_trouble(each, half) for each in lit) if trouble is not None]
        found += [(what, shot.stop, do) for what, do in troubles]
        good.append([] if troubles else lit)
    return _sentences(found) + list(_clashes(stage, good, half))


def doubtful(stage: Stage) -> list[str]:
    """Say what can be, but is probably not meant: one sentence each, as `impossible` does.

    Lamps and screens of no picture; light that other pictures of the stop need, and that throws the cube's shadow on
    this one's screen too; screens in the way of others; pictures of which less than half lies in the cube's shadow;
    pixels much finer than the voxels.
    """
    half = _half(stage)
    beams = _beams(stage)
    found = [*_strays(stage, half), *_shaded(stage, beams), *_bare(beams, half), *_fine(stage, beams)]
    return list(_unused(stage)) + _sentences(found)


def facts(stage: Stage) -> dict[str, Any]:
    """Figures of a stage, for JSON.

    Returns
    -------
    ``lamps, screens, stops, pictures, views``
        How many there are; a view is one lamp of one picture.
    ``per_picture``
        For each: ``name, screen, lamps``; ``stop`` (counted from 1) and ``angle_deg``; ``rows, columns``;
        ``beams_in_cube``, the part of its beams that meet the cube; ``distance_mm`` from the screen's middle to the
        cube's; and ``pixel_in_voxels``, the square root of the cross-section of a pixel's beams where they pass the
        cube's middle, in voxels (mean over its lamps).
    """
    half = _half(stage)
    beams = _beams(stage)
    figures = []
    for shot, lit in _by_shot(stage, beams):
        screen = lit[0].screen
        figures.append(
            {
                "name": shot.name,
                "screen": shot.screen,
                "lamps": list(shot.lamps),
                "stop": shot.stop + 1,
                "angle_deg": float(stage.stops_deg[shot.stop]),
                "rows": screen.pixels[0],
                "columns": screen.pixels[1],
                "beams_in_cube": _part(lit, half),
                "distance_mm": float(np.linalg.norm(screen.centre_mm)),
                "pixel_in_voxels": _pixel_side(lit) / stage.grid.voxel_mm,
            }
        )
    counts = {"lamps": len(stage.lamps), "screens": len(stage.screens), "stops": len(stage.stops_deg)}
    return {**counts, "pictures": len(stage.shots), "views": len(beams), "per_picture": figures}


def _half(stage: Stage) -> Reals:
    """Half the cube's sides along x, y and z."""
    return np.array(stage.grid.size_mm[::-1]) / 2


def _thin(half: Reals) -> float:
    """Shorter ways through the cube are rounding."""
    return 1e-9 * float(half.max())


def _beams(stage: Stage) -> list[_Beams]:
    """One for every lamp of every picture, in this order, as they run without glass."""
    rig = replace(stage, glass=None).rig()
    views = rig.views
    made = []
    for v, (p, name) in enumerate((p, name) for p, shot in enumerate(stage.shots) for name in shot.lamps):
        spare = (np.array(views.picture_shape) - rig.stops.window[p]) / 2
        right, down = views.column_steps_mm[v], views.row_steps_mm[v]
        middle = views.origins_mm[v] - spare[0] * down - spare[1] * right
        shot = stage.shots[p]
        made.append(_Beams(shot, stage.lamp(name), stage.screen(shot.screen), views.lamps[v], middle, right, down))
    return made


def _by_shot(stage: Stage, beams: list[_Beams]) -> Iterator[tuple[Shot, list[_Beams]]]:
    """Every shot with its beams."""
    rest = iter(beams)
    return ((shot, [next(rest) for _ in shot.lamps]) for shot in stage.shots)


def _sentences(found: Iterable[tuple[str, int, str]]) -> list[str]:
    """``what at stop 2: do``, where several stops have the same what and do in one sentence."""
    stops: dict[tuple[str, str], list[int]] = {}
    for what, stop, do in found:
        stops.setdefault((what, do), []).append(stop)
    return [f"{what} at {_said(at)}: {do}" for (what, do), at in stops.items()]


def _said(stops: Iterable[int]) -> str:
    """Stops counted from 0 as people say them: ``stops 1 to 3 and 7``."""
    numbers = sorted(set(stops))
    runs = [[n for _, n in run] for _, run in groupby(enumerate(numbers, 1), lambda pair: pair[1] - pair[0])]
    parts = [part for run in runs for part in ([run] if len(run) > 2 else [[n] for n in run])]
    said = [f"{part[0] + 1} to {part[-1] + 1}" if len(part) > 1 else f"{part[0] + 1}" for part in parts]
    return f"stop{'s' if len(numbers) > 1 else ''} {_listed(said)}"


def _listed(words: list[str]) -> str:
    """``a, b and c``."""
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def _trouble(beams: _Beams, half: Reals) -> tuple[str, str] | None:
    """What is wrong with where lamp, cube and screen stand, and what to do; the first thing found."""
    lamp, screen = f"lamp {beams.lamp.name!r}", f"screen {beams.screen.name!r}"
    if beams.light[3] and np.all(np.abs(beams.light[:3]) <= half):
        return f"{lamp} stands inside the cube", "move it out"
    if abs(beams.fall) < _EDGE:
        return f"{screen} is edge-on to {lamp}", "turn or move one of the two"
    points = beams.pixels()
    enter, leave = beams.chords(points, half)
    thin, come = _thin(half), beams.ways(points)[1]
    crossed = leave > enter + thin
    met = crossed & (leave > thin - come)
    if np.any(met & (leave > thin)):
        if np.all(enter[met] > -thin):
            return f"{screen} stands between {lamp} and the cube", "put it on the far side of the cube"
        return f"{screen} cuts through the cube", "move it out of the cube"
    if beams.fall > 0:
        return f"{lamp} lights the back of {screen}", "turn the screen's normal round, or move one of the two"
    if np.any(met):
        return None
    if np.any(crossed):
        return (
            f"{lamp} stands between the cube and {screen}, and throws no shadow of the cube on it",
            "move it to the other side of the cube",
        )
    return f"the beams of {lamp} through the cube miss {screen}", _where(beams)


def _where(beams: _Beams) -> str:
    """Where the screen should be moved, as the stage's description says it."""
    through = beams.ways(np.zeros((1, 3)))[0][0]
    fall = through @ beams.normal
    far = beams.middle @ beams.normal / (fall if abs(fall) > _EDGE else np.inf)
    if far <= 0:
        return "move the screen to where the cube's shadow falls"
    away = far * through - beams.middle
    place = np.array(beams.screen.centre_mm, np.float64)
    for step, given in zip((beams.right, beams.down), beams.screen.steps, strict=True):
        place += away @ step / (step @ step) * given
    x, y, z = (f"{value:.4g}" for value in np.round(place, 3) + 0.0)
    return f"the middle of the shadow falls on ({x}, {y}, {z}) mm in its plane, so move its centre there"


def _clashes(stage: Stage, lit: list[list[_Beams]], half: Reals) -> Iterator[str]:
    """Pictures that want the same of their beams, each with the first earlier one that does."""
    turned = [stage.stops_deg[shot.stop] for shot in stage.shots]
    for q, later in enumerate(stage.shots):
        for p, earlier in enumerate(stage.shots[:q]):
            pair = f"pictures {earlier.name!r} (stop {earlier.stop + 1}) and {later.name!r} (stop {later.stop + 1})"
            apart = abs((turned[p] - turned[q] + 180) % 360 - 180)
            if earlier.screen == later.screen and set(earlier.lamps) == set(later.lamps) and apart < 1e-6:
                yield (
                    f"{pair} are both wanted on screen {later.screen!r} with the table at {turned[q]:g} degrees and "
                    "the same lamps: give one of them another screen, stop or lamp"
                )
                break
            share = _shared(lit[p], lit[q], half)
            if share > 0:
                yield (
                    f"{pair} are cast by the same beams through the cube, {max(share, 0.01):.0%} of them: "
                    "no cube shows both, so give one of them another stop, lamp or screen"
                )
                break


def _shared(first: list[_Beams], second: list[_Beams], half: Reals) -> float:
    """Part of the beams of a picture with one lamp that another such picture wants too, the larger of both parts."""
    if len(first) != 1 or len(second) != 1 or not _same_beams(first[0], second[0]):
        return 0.0
    parts = [0.0]
    for one, other in ((first[0], second[0]), (second[0], first[0])):
        points = one.pixels()
        points = points[one.shadow(points, half)]
        if len(points):
            parts.append(float(np.mean(one.reach(points, other)[0])))
    return max(parts)


def _same_beams(one: _Beams, other: _Beams) -> bool:
    """Whether two lamps cast the same lines through the cube, either way, in a colour that they share."""
    if one.light[3] != other.light[3] or not np.any(np.multiply(one.lamp.colour, other.lamp.colour)):
        return False
    a, b = one.light[:3], other.light[:3]
    size = np.linalg.norm(a)
    if one.light[3]:
        return bool(np.linalg.norm(a - b) <= _SAME * size)
    return bool(np.linalg.norm(np.cross(a, b)) <= _SAME * size * np.linalg.norm(b))


def _unused(stage: Stage) -> Iterator[str]:
    lit = {name for shot in stage.shots for name in shot.lamps}
    shown = {shot.screen for shot in stage.shots}
    for kind, names, used in (
        ("lamp", [lamp.name for lamp in stage.lamps], lit),
        ("screen", [screen.name for screen in stage.screens], shown),
    ):
        for name in names:
            if name not in used:
                yield f"no picture names {kind} {name!r}: leave it out, or give it a picture"


def _strays(stage: Stage, half: Reals) -> Iterator[tuple[str, int, str]]:
    """Light of other pictures of the same stop that throws the cube's shadow on this one's screen too."""
    lit: dict[float, set[str]] = {}
    for shot in stage.shots:
        lit.setdefault(_turn(stage, shot), set()).update(shot.lamps)
    others = ((shot, lit[_turn(stage, shot)].difference(shot.lamps)) for shot in stage.shots)
    shots = tuple(replace(shot, lamps=tuple(sorted(lamps))) for shot, lamps in others if lamps)
    if not shots:
        return
    strange = replace(stage, shots=shots)
    for shot, beams in _by_shot(strange, _beams(strange)):
        throwing = [each for each in beams if np.any(each.shadow(each.pixels(_FEW), half))]
        found = [repr(each.lamp.name) for each in throwing]
        if found:
            lamps, they = (f"lamps {_listed(found)}", "they are") if len(found) > 1 else (f"lamp {found[0]}", "it is")
            what = f"screen {shot.screen!r} also catches the cube's shadow from {lamps} of other pictures"
            yield what, shot.stop, f"{they} taken to be off meanwhile, or shaded from it"


def _turn(stage: Stage, shot: Shot) -> float:
    """Angle of a shot's stop within a turn, to compare with."""
    return round(stage.stops_deg[shot.stop] % 360, 6) % 360


def _shaded(stage: Stage, beams: list[_Beams]) -> Iterator[tuple[str, int, str]]:
    """Screens that stand in the beams to others."""
    stops = sorted({shot.stop for shot in stage.shots})
    any_lamp = (stage.lamps[0].name,)
    shots = tuple(Shot("", screen.name, any_lamp, stop) for screen in stage.screens for stop in stops)
    windows = _beams(replace(stage, shots=shots))
    for each in beams:
        points = each.pixels(_FEW)
        for other in windows:
            if other.shot.stop != each.shot.stop or other.screen.name == each.screen.name:
                continue
            inside, far = each.reach(points, other)
            if np.any(inside & (far < -1e-6 * each.screen.pitch_mm)):
                beam = f"the beams of lamp {each.lamp.name!r} to screen {each.screen.name!r}"
                what = f"screen {other.screen.name!r} stands in {beam}"
                yield what, each.shot.stop, "move it, or take it away meanwhile"


def _bare(beams: list[_Beams], half: Reals) -> Iterator[tuple[str, int, str]]:
    """Pictures that lie less than half in the cube's shadow, of each lamp."""
    for each in beams:
        if 0 < _part([each], half) < 0.5:
            what = f"less than half of screen {each.screen.name!r} lies in the cube's shadow"
            do = "the rest shows the bare lamp, so make the screen smaller, or move it"
            yield f"{what} from lamp {each.lamp.name!r}", each.shot.stop, do


def _fine(stage: Stage, beams: list[_Beams]) -> Iterator[tuple[str, int, str]]:
    """Pixels much finer than the voxels."""
    for each in beams:
        side = _pixel_side([each]) / stage.grid.voxel_mm
        if side < _FINE and abs(each.fall) >= _EDGE:
            what = f"pixels of screen {each.screen.name!r} are but {side:.2g} voxels wide at the cube's middle"
            do = f"the cube cannot show so fine a picture, so make pitch_mm about {each.screen.pitch_mm / side:.2g}"
            yield f"{what}, in the light of lamp {each.lamp.name!r},", each.shot.stop, do


def _part(beams: list[_Beams], half: Reals) -> float:
    """Part of the beams that meet the cube."""
    return float(np.mean([np.mean(each.shadow(each.pixels(), half)) for each in beams]))


def _pixel_side(beams: list[_Beams]) -> float:
    """Square root of a pixel's cross-section, carried back along the light to the cube's middle, mm."""
    sides = []
    for each in beams:
        units, come = each.ways(each.middle[None])
        side = np.sqrt(abs(np.cross(each.right, each.down) @ units[0]))
        sides.append(side * np.linalg.norm(each.light[:3]) / come[0] if each.light[3] else side)
    return float(np.mean(sides))
