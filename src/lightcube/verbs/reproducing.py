"""The command that makes a cube again, from what the cube itself says."""

import hashlib
import math
import shlex
from collections.abc import Iterator, Mapping
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube import io
from lightcube.backward.job import Job
from lightcube.backward.mat import TONES, Mat
from lightcube.backward.needs import MEMORY, fewest_units
from lightcube.backward.recipe import QUALITIES, Quality, Recipe, recipe_of
from lightcube.errors import InputError, without_secrets
from lightcube.optics.attenuator import Films
from lightcube.optics.cube import Cube
from lightcube.optics.dyes import Dyes
from lightcube.optics.glare import off_normals
from lightcube.optics.glass import Glass
from lightcube.optics.light import Light
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.optics.stack import Stack
from lightcube.optics.tables import POWER_MAX
from lightcube.optics.told import remembered
from lightcube.optics.transfer import BLACK
from lightcube.optics.views import spread_angles, swept_mm
from lightcube.pictures.targets import Targets
from lightcube.report.page import Command, Origin
from lightcube.verbs.options import Options
from lightcube.wording import counted

#: Longest side of a cube, mm, unless the command line says another.
_SIZE_MM = 100.0
#: A number of mm is looked for among so many neighbours of the nearest one.
_NEIGHBOURS = 4
#: By what is taken of a film, the option that says so.
_FILM = {"from_s": "--from", "to_s": "--to", "every": "--every", "most": "--most"}
#: Digits of a degree that the angles of views are known to.
_DIGITS = 9


def reproducing(cube: Cube, targets: Targets, source: str | None, target: str) -> Command:
    """Put together the command that makes a cube again; every number is tried, and said as short as it can be.

    Parameters
    ----------
    targets
        What was wanted of the cube.
    source, target
        What the command reads and writes; without a source there is a word in its place.
    """
    command, provenance = Command(), remembered(cube)
    place = _place_options(cube, command)
    words = [*place, *_solver_options(cube, command)]
    if cube.transfer != "srgb":
        words += ["--transfer", cube.transfer]
    stands_for = "PICTURES" if _is_planned(cube) or _is_of_films(cube) else "STAGE.toml"
    asked = ["lightcube", "solve", source or stands_for, "-o", target]
    solve = [shlex.join(asked), *(shlex.join(pair) for pair in zip(words[::2], words[1::2], strict=True))]
    _doubt_origin(cube, command, source)
    if source is not None and without_secrets(source) != source:
        command.doubts.append("The URL of the pictures is shown without its login and its query: put them in again.")
    units = int(provenance.get("units", 1))
    if units == 1 or units == _usual_units(cube, targets):
        command.lines = [solve]
        return command
    command.lines = [[*solve, f"--unit {unit}/{units}"] for unit in range(1, units + 1)]
    command.lines.append([shlex.join(["lightcube", "publish", f"{target}.partial"])])
    return command


def _is_planned(cube: Cube) -> bool:
    """Whether a cube was planned for pictures, and not made on a stage, whose screens have edges."""
    return bool(np.all(cube.rig.screens.endless))


def _is_of_films(cube: Cube) -> bool:
    """Whether it is a stack that was made of pictures by its number of films, and not of a stage's file."""
    return isinstance(cube.grid, Stack) and "fit" in remembered(cube)


def _place_options(cube: Cube, command: Command) -> Iterator[str]:
    """What says where things stand, beside pictures or the file of a stage."""
    if _is_of_films(cube):
        return _films_options(cube)
    return _turntable_options(cube, command) if _is_planned(cube) else _stage_options(cube)


def _films_options(cube: Cube) -> Iterator[str]:
    """Films and their cells; their lamps stand as they come."""
    assert isinstance(cube.grid, Stack)  # noqa: S101 - asked before
    usual, stack = Films(), cube.grid
    cells = round(min(cube.rig.views.pixel_in(stack)))
    pixels, heights = max(cube.rig.picture_shape), stack.heights_mm
    yield from ("--films", str(stack.shape[0]))
    gap_mm = (heights[-1] - heights[0]) / max(len(heights) - 1, 1)
    if abs(gap_mm - usual.gap_mm) > 1e-9 and len(heights) > 1:
        yield from ("--gap-mm", _number(gap_mm))
    if pixels * cells != usual.pixels * usual.cells_a_pixel:
        yield from ("--n", str(pixels * cells))
    if cells != usual.cells_a_pixel:
        yield from ("--pixel", str(cells))
    size_mm = round(pixels * cells * stack.voxel_mm, 9)
    if size_mm != usual.size_mm:
        yield from ("--size-mm", _number(size_mm))
    yield from _shown(remembered(cube))
    yield from _lamp(cube)


def _shown(provenance: Mapping[str, Any]) -> Iterator[str]:
    """What was done to pictures."""
    yield from _film(provenance)
    if provenance.get("fit", "crop") != "crop":
        yield from ("--fit", str(provenance["fit"]))
    if "focus" in provenance:
        yield from ("--focus", _listed(np.array(provenance["focus"])))


def _turntable_options(cube: Cube, command: Command) -> Iterator[str]:
    """Cube, pictures, angles and lamp's elevation of a turntable."""
    views, provenance, pixel = cube.rig.views, remembered(cube), _pixel(cube)
    yield from ("--shape", ",".join(map(str, cube.grid.shape)))
    tall = cube.grid.tall
    if tall != 1 and tall == round(tall):
        yield from ("--slices-tall", str(round(tall)))
    elif tall != 1:
        command.doubts.append(f"No option says slices {tall:g} times as tall as voxels are wide.")
    size = _size(cube.grid.voxel_mm, cube.grid.longest)
    if size is None:
        command.doubts.append(f"No size in mm gives voxels of exactly {cube.grid.voxel_mm!r} mm.")
    elif size != _SIZE_MM:
        yield from ("--size-mm", _number(size))
    yield from ("--picture-width", _width(views.picture_shape[1], cube.grid.shape[1] / pixel))
    if pixel != 1:
        yield from ("--pixel", str(pixel))
    yield from ("--elevation-deg", _number(float(views.elevations_deg[0])))
    if cube.rig.glass is not None:
        yield from _glass(cube.rig.glass)
    said, angles_deg = _angles(cube)
    yield from said
    disc = _disc(cube, angles_deg)
    if disc is None:
        command.doubts.append(
            "No angles, elevation and lamp on the command line give exactly this cube's lamps and screens."
        )
    yield from disc or ()
    yield from _shown(provenance)
    if "order" in provenance:
        yield from ("--order", "best")
    if "shift" in provenance:
        yield from ("--shift", str(provenance["shift"]))
    yield from ("--hold-deg", _number(cube.hold_deg))
    yield from _lamp(cube)


def _film(provenance: Mapping[str, Any]) -> Iterator[str]:
    """What was taken of a film, where that is not as usual."""
    part = provenance.get("film", {})
    if part != Options().film:
        yield from (word for name, value in part.items() for word in (_FILM[name], _number(value)))


def _lamp(cube: Cube) -> Iterator[str]:
    """Power of the lamp, black of the screen, and what lies over it."""
    least, most, black = (
        float(part[0]) for part in (cube.rig.lamps.least, cube.rig.lamps.most, cube.rig.screens.black)
    )
    if least == most and (recipe_of(cube).solver.chooses_lamps or most != 1):
        yield from ("--lamp-power", _number(most))
    elif least != most and most != POWER_MAX:
        yield from ("--lamp-max", _number(most))
    if black != BLACK:
        yield from ("--black", _number(black))
    if np.any(cube.rig.fading.veil):
        yield from ("--veil", _number(float(cube.rig.fading.veil[0])))


def _stage_options(cube: Cube) -> Iterator[str]:
    """What the command line says beside a stage's file."""
    if cube.hold_deg:
        yield from ("--hold-deg", _number(cube.hold_deg))


def _solver_options(cube: Cube, command: Command) -> Iterator[str]:
    """Method, lamp, bounds and passes."""
    made, usual = recipe_of(cube), Recipe()
    if made.solver != usual.solver:
        yield from ("--method", made.solver.name)
    if made.powers != usual.powers:
        yield from ("--powers", made.powers)
    if made.dyes is not None:
        yield from ("--material", _material(made.dyes, command))
    elif replace(made.bounded_by, clear=0.0) != usual.bounded_by:
        yield from ("--max-extinction", _number(made.bounded_by.most(cube.grid)))
    if made.bounded_by.clear:
        yield from ("--clear", ",".join(_number(each) for each in np.atleast_1d(made.bounded_by.clear)))
    if made.assembly_mm:
        yield from ("--assembly-mm", _number(made.assembly_mm))
    if made.seed:
        yield from ("--seed", str(made.seed))
    yield from _mat(made, command, is_of_films=isinstance(cube.grid, Stack))
    quality = _quality(made) if "passes" in remembered(cube) else None
    if not isinstance(cube.grid, Stack):
        yield from _light(made.beams, quality, command)
    if quality is None:
        yield from _passes(remembered(cube), command)
    elif quality != "normal":
        yield from ("--quality", quality)


def _glass(glass: Glass) -> Iterator[str]:
    """What bends the light."""
    yield from ("--ior", _listed(np.array(glass.iors)))
    if glass.form != "block":
        yield from ("--form", glass.form)
    if glass.bottom != "open":
        yield from ("--bottom", glass.bottom)
    if glass.bath_mm is not None:
        yield from ("--bath-mm", _number(glass.bath_mm))


def _material(dyes: Dyes, command: Command) -> str:
    """The material that ships with these dyes, or a file's name in its place."""
    known = (name for name in io.material_names() if io.read_dyes(name) == dyes)
    name = next(known, "material.toml")
    if name.endswith(".toml"):
        command.doubts.append(f"Its material is kept with it: lightcube.save(cube.dyes, {name!r}) writes the file.")
    return name


def _mat(made: Recipe, command: Command, *, is_of_films: bool) -> Iterator[str]:
    """What surrounds the pictures, where that is not as usual."""
    usual = None if made.beams.is_thin or not made.solver.chooses_lamps else Mat()
    if made.mat == usual or is_of_films:
        return
    names = [name for name, tone in TONES.items() if made.mat == Mat(tone)]
    if made.mat is not None and not names:
        command.doubts.append(f"No option says a mat of {made.mat!r}.")
        return
    yield from ("--mat", names[0] if names else "none")


def _quality(made: Recipe) -> Quality | None:
    """The quality whose passes a cube was solved by."""
    thin = made.beams.is_thin
    found: list[Quality] = [
        quality
        for quality, effort in QUALITIES.items()
        if (effort.thin_passes if thin else effort.passes, effort.enough_db) == (made.passes, made.enough_db)
    ]
    return found[0] if found and made.method == "display" else None


def _light(light: Light, quality: Quality | None, command: Command) -> Iterator[str]:
    """How fine light is, where nothing that is said already says it."""
    if light.is_thin:
        yield from ("--light", "thin")
        return
    yield from ("--grain", f"{light.grain:g}")
    if replace(light, grain=0.0) == (QUALITIES[quality].light if quality else Light()):
        return
    if light.points != light.row_points:
        command.doubts.append(
            f"No option says {light.points} points a pixel, and {light.row_points} where light is level."
        )
    yield from ("--points", str(light.points))


def _passes(made: Mapping[str, Any], command: Command) -> Iterator[str]:
    """How many passes at most; the number of passes itself where no more is known."""
    if "passes" in made:
        passes, enough = made["passes"], made.get("enough_db") or math.inf
        if enough < math.inf:
            command.doubts.append(
                f"No option says at most {passes} passes, or fewer where a PSNR of {enough:g} dB is reached."
            )
        if passes is not None:
            yield from ("--iterations", str(passes))
    elif made.get("stop_reason") == "iterations":
        yield from ("--iterations", str(made["iterations"]))
    else:
        known = {"enough": "were enough", "best": "were best", "converged": "left nothing to do"}
        reason = known.get(made.get("stop_reason", ""), "came")
        passes = (
            f"{counted(made['iterations'], 'pass')} {reason}" if "iterations" in made else "nothing is said of passes"
        )
        command.doubts.append(
            f"How many passes were allowed, and which PSNR was enough, is not recorded ({passes}); the default is "
            "taken here."
        )


def _doubt_origin(cube: Cube, command: Command, source: str | None) -> None:
    """Say what stands between the command and the same cube, beside its options."""
    made, doubts = remembered(cube), command.doubts
    if source is None:
        doubts.insert(0, "The pictures are not recorded with the cube: put the name of theirs into the command.")
    if _is_planned(cube) and "fit" not in made:
        doubts.append("How the pictures were fitted is not recorded: the cube was not made by `lightcube solve`.")
    if made.get("dtype", "float32") != "float32":
        doubts.append(f"It was computed in {made['dtype']}, the command line computes in float32.")
    if cube.status != "complete":
        doubts.append("The solver was stopped early; the command goes on to its end.")
    if "started_from" in made:
        doubts.append("It was started from another cube, which is not kept: add --start-from with that one.")
    if made.get("lightcube") != version("lightcube"):
        written = made.get("lightcube", "an unknown version")
        doubts.append(f"It was made by lightcube {written}; another version may come to other bits.")


def _usual_units(cube: Cube, targets: Targets) -> int:
    """In how many units the cube would be solved if nothing is said of them; 1 where its method is not to be found."""
    try:
        job = Job(targets, cube.grid, recipe_of(cube))
    except InputError:
        return 1
    return fewest_units(job, MEMORY)


def _angles(cube: Cube) -> tuple[list[str], NDArray[np.float64]]:
    """The option that gives the cube's angles, and what it gives: exactly them if any does."""
    views = cube.rig.views.take(cube.rig.starts[:-1])
    angles_deg = views.angles_deg
    for offset in (1 / 2, 1 / 3):  # as `lightcube.optics.views.spread_angles` begins
        span_deg = round(float(angles_deg[0]) / offset * len(views), 6)
        if 0 < span_deg <= 360:
            spread_deg = off_normals(spread_angles(len(views), span_deg), cube.rig.glass)
            if np.array_equal(_made(cube, spread_deg).views.lamps, cube.rig.views.lamps):
                return ["--span-deg", _number(span_deg)], spread_deg
    return ["--angles-deg", _listed(angles_deg)], np.round(angles_deg, _DIGITS)


def _disc(cube: Cube, angles_deg: NDArray[np.float64]) -> list[str] | None:
    """The options of the lamp's disc that give exactly the cube's lamps and screens at these angles, or None."""
    lamp_deg = float(cube.rig.sums.disc_deg[0])
    if not lamp_deg and cube.rig.glass is None:
        return [] if _same(cube, _made(cube, angles_deg)) else None
    said = ["--lamp-deg", _number(lamp_deg)] if lamp_deg else []
    if _same(cube, _made(cube, angles_deg, lamp_deg=lamp_deg)):
        return said
    away_mm = float(cube.rig.behind_mm[0]) - swept_mm(cube.grid)
    for screen_mm in _rounded(max(away_mm, 0.0)):
        if _same(cube, _made(cube, angles_deg, lamp_deg=lamp_deg, screen_mm=screen_mm)):
            return [*said, "--screen-mm", _number(screen_mm)]
    return None


def _made(cube: Cube, angles_deg: NDArray[np.float64], lamp_deg: float = 0.0, screen_mm: float | None = None) -> Rig:
    """A turntable of the cube's elevation, glass and pictures at these angles."""
    views = cube.rig.views
    elevation_deg = float(views.elevations_deg[0])
    shape = views.picture_shape
    return turntable(
        cube.grid,
        angles_deg,
        elevation_deg=elevation_deg,
        picture_shape=shape,
        pixel=_pixel(cube),
        lamp_deg=lamp_deg,
        screen_mm=screen_mm,
        glass=cube.rig.glass,
    )


def _pixel(cube: Cube) -> int:
    """How many voxels the cube's pixels are wide, as near as an option can say it."""
    return min(max(1, round(cube.rig.views.pixel_in(cube.grid)[1])), cube.grid.largest_pixel)


def _same(cube: Cube, made: Rig) -> bool:
    """Whether a rig has the cube's lamps and screens, bit for bit; pictures may have been shifted by whole pixels."""
    views = cube.rig.views
    if not np.array_equal(made.sums.disc_deg, cube.rig.sums.disc_deg):
        return False
    if "shift" in remembered(cube):
        off = views.origins_mm - made.views.origins_mm
        steps = views.column_steps_mm, views.row_steps_mm
        offsets = [np.rint(np.sum(off * each, axis=1) / np.sum(each**2, axis=1)).astype(int) for each in steps]
        made = made.shifted(np.stack(offsets, axis=1))
    names = ("lamps", "origins_mm", "column_steps_mm", "row_steps_mm")
    return all(np.array_equal(getattr(made.views, name), getattr(views, name)) for name in names)


def _listed(angles_deg: NDArray[np.float64]) -> str:
    return ",".join(_number(float(angle_deg)) for angle_deg in angles_deg)


def _size(voxel_mm: float, voxels: float) -> float | None:
    """The shortest length of so many voxels that gives exactly their side, or None."""
    return next((each for each in _rounded(voxel_mm * voxels) if each / voxels == voxel_mm), None)


def _rounded(length: float) -> Iterator[float]:
    """Numbers near one, those of few digits first."""
    yield from (float(f"{length:.{digits}g}") for digits in range(1, 18))
    for way in (-math.inf, math.inf):
        beside = length
        for _ in range(_NEIGHBOURS):
            beside = math.nextafter(beside, way)
            yield beside


def _width(columns: int, across: float) -> str:
    """The shortest part of the cube's width, of so many pixels, that a picture of so many columns is rounded to."""
    part = columns / across
    tried = (f"{part:.{digits}g}" for digits in range(1, 18))
    return next(text for text in tried if abs(float(text) * across - columns) < 0.9)


def _number(value: float) -> str:
    """A number that reads back as the same one, without a useless .0."""
    return repr(float(value)).removesuffix(".0")


def origins(cube: str, targets: str | None, role: str = "cube") -> Iterator[Origin]:
    """The files on this disk that were read; `role` is what the first one is."""
    read = [(role, Path(cube))]
    if targets is not None and io.is_stage(targets):
        read += [("stage", Path(targets)), *(("pictures", path) for path in io.stage_pictures(targets))]
    elif targets is not None:
        read.append(("pictures", Path(targets)))
    for what, path in read:
        if path.exists():
            yield _origin(what, path)


def _origin(role: str, path: Path) -> Origin:
    """Size and checksum of a file, or of all files of a folder that are not hidden."""
    if not path.is_dir():
        return Origin(role, path.name, 1, path.stat().st_size, _checksum(path))
    inside = {f"./{each.relative_to(path).as_posix()}": each for each in path.rglob("[!.]*") if each.is_file()}
    shown = {
        name: inside[name]
        for name in sorted(inside, key=lambda name: name.encode("utf-8", "surrogateescape"))
        if "/." not in name
    }
    listed = "".join(f"{_checksum(each)}  {name}\n" for name, each in shown.items())
    size = sum(each.stat().st_size for each in shown.values())
    digest = hashlib.sha256(listed.encode("utf-8", "surrogateescape")).hexdigest()
    return Origin(role, path.resolve().name, len(shown), size, digest)


def _checksum(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
