"""How things are made: what the page's sliders say of each, as the verbs take it, and as it is typed in a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from lightcube import io
from lightcube.optics.attenuator import Films
from lightcube.optics.tables import POWER_MAX
from lightcube.solids.relief import ReliefRecipe
from lightcube.verbs import hulls, making
from lightcube.verbs.options import Options, Surround

#: Pictures that a project holds at most: a cube shows so many only where they are small.
MOST_PICTURES = 64
#: Index of refraction of clear glass, and of what is cast of resin.
_GLASS = (1.5,)
#: How often each column of a plate is offered another height.
_SWEEPS = {"draft": 100, "normal": ReliefRecipe().sweeps, "best": 1000}
_FILMS = Films()

Quality = Literal["draft", "normal", "best"]
_Lamp = Annotated[float, Field(ge=1, le=64, allow_inf_nan=False)]


class Strict(BaseModel):
    """Values that do not change, of which no other is taken."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Making(Strict):
    """How a cube is made; in a room of its own fewer of these count."""

    voxels: Annotated[int, Field(ge=16, le=160)] = 64
    width: Annotated[float, Field(ge=0.2, le=1, allow_inf_nan=False)] = 0.5
    lamp: _Lamp = POWER_MAX
    hold_deg: Annotated[float, Field(ge=0, le=6, allow_inf_nan=False)] = 0.25
    #: The most that the glass takes away, 1/mm: clear glass is bright, rich glass has deep colours; 0 = any.
    richness: Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)] = 0.0
    #: How many pictures of the strip are used, from its beginning; 0 = all.
    count: Annotated[int, Field(ge=0, le=MOST_PICTURES)] = 0
    fit: Literal["crop", "pad"] = "crop"
    mat: Surround = "dark"
    order: Literal["given", "best"] = "given"
    quality: Quality = "normal"
    #: What the light enters: air, which bends nothing, or clear glass of a form.
    stands: Literal["air", "block", "cylinder"] = "air"


class ShapeMaking(Strict):
    """How a solid is made that casts silhouettes."""

    #: Three walls, or a turntable.
    where: Literal["walls", "table"] = "walls"
    voxels: Annotated[int, Field(ge=32, le=192)] = 96
    size_mm: Annotated[float, Field(ge=10, le=500, allow_inf_nan=False)] = 80.0
    elevation_deg: Annotated[float, Field(ge=0, le=60, allow_inf_nan=False)] = 35.0
    #: Which side of the pictures is the shape; found = by what covers less of the border.
    dark: Literal["found", "dark", "light"] = "found"
    placement: hulls.Place = "given"
    repair: Literal["auto", "none", "warp", "trim", "grow"] = "auto"
    carve: Literal["none", "shell", "lace"] = "none"
    wall_mm: Annotated[float, Field(ge=0, le=5, allow_inf_nan=False)] = 1.2


class PlateMaking(Strict):
    """How a plate is made whose shadows are pictures."""

    columns: Annotated[int, Field(ge=32, le=256)] = 128
    pitch_mm: Annotated[float, Field(ge=0.2, le=2, allow_inf_nan=False)] = 0.8
    relief: Annotated[float, Field(ge=2, le=30, allow_inf_nan=False)] = 10.0
    elevation_deg: Annotated[float, Field(ge=15, le=70, allow_inf_nan=False)] = 45.0
    #: One picture, by a red, a green and a blue lamp.
    colour: bool = False
    quality: Quality = "normal"


class FilmsMaking(Strict):
    """How films are made that lie above each other."""

    films: Annotated[int, Field(ge=2, le=8)] = 5
    #: Of a film along a picture; two make a pixel.
    cells: Annotated[int, Field(ge=16, le=160, multiple_of=2)] = 64
    gap_mm: Annotated[float, Field(ge=2, le=40, allow_inf_nan=False)] = _FILMS.gap_mm
    size_mm: Annotated[float, Field(ge=40, le=180, allow_inf_nan=False)] = _FILMS.size_mm
    #: By how much films may lie off, so that pictures stand it.
    assembly_mm: Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)] = 0.2
    #: What they are printed with, as `lightcube materials` lists it; any = red, green and blue light.
    inks: Literal["any", "cmyk-film", "cmy-film"] = "cmyk-film"
    lamp: _Lamp = POWER_MAX
    fit: Literal["crop", "pad"] = "crop"
    quality: Quality = "normal"


def of_cube(made: Making) -> Options:
    """A cube on a turntable, as `solve` takes it."""
    return Options(
        n=made.voxels,
        picture_width=made.width,
        lamp_max=_unless(POWER_MAX, made.lamp),
        hold_deg=made.hold_deg,
        max_extinction=made.richness or None,
        fit=made.fit,
        mat=_unless("dark", made.mat),
        order=made.order,
        quality=_unless("normal", made.quality),
        ior=None if made.stands == "air" else _GLASS,
        form="cylinder" if made.stands == "cylinder" else None,
    )


def in_room(made: Making) -> Options:
    """A cube in a room of its own, whose file says the rest."""
    return Options(
        hold_deg=made.hold_deg or None, max_extinction=made.richness or None, quality=_unless("normal", made.quality)
    )


def of_films(made: FilmsMaking) -> Options:
    """Films, as `solve` takes them."""
    return Options(
        films=made.films,
        n=made.cells,
        gap_mm=_unless(_FILMS.gap_mm, made.gap_mm),
        size_mm=_unless(_FILMS.size_mm, made.size_mm),
        assembly_mm=made.assembly_mm or None,
        material=None if made.inks == "any" else io.read_dyes(made.inks),
        lamp_max=_unless(POWER_MAX, made.lamp),
        fit=made.fit,
        quality=_unless("normal", made.quality),
    )


def of_shape(made: ShapeMaking) -> tuple[Options, hulls.Cutting, making.Making]:
    """A solid, as `hull` takes it."""
    is_walls = made.where == "walls"
    return (
        Options(n=made.voxels, size_mm=made.size_mm, elevation_deg=None if is_walls else made.elevation_deg),
        hulls.Cutting(
            invert={"found": None, "dark": False, "light": True}[made.dark],
            is_walls=is_walls,
            placement=made.placement if is_walls else "given",
        ),
        making.Making(made.repair, made.wall_mm, made.carve),
    )


def of_plate(made: PlateMaking) -> tuple[ReliefRecipe, bool]:
    """A plate, as `relief` takes it, and whether it is of one picture in colour."""
    recipe = ReliefRecipe(
        side=made.columns,
        pitch_mm=made.pitch_mm,
        relief_px=made.relief,
        elevation_deg=made.elevation_deg,
        sweeps=_SWEEPS[made.quality],
    )
    return recipe, made.colour


def option_words(said: Options) -> list[str]:
    """Options that are not as usual, as they are typed."""
    usual = Options()
    pairs = [(each.name, getattr(said, each.name)) for each in fields(Options)]
    return [word for name, value in pairs if value != getattr(usual, name) for word in _typed(name, value)]


def film_words(made: FilmsMaking) -> list[str]:
    """The same of films."""
    words = option_words(of_films(made.model_copy(update={"inks": "any"})))
    return words if made.inks == "any" else [*words, "--material", made.inks]


def shape_words(made: ShapeMaking) -> list[str]:
    """The same of a solid."""
    (options, cutting, how), usual = of_shape(made), making.Making()
    said: list[tuple[str, Any, Any]] = [
        ("repair", how.way, usual.way),
        ("wall", how.wall_mm, usual.wall_mm),
        ("carve", how.carving, usual.carving),
        ("placement", cutting.placement, hulls.Cutting().placement),
    ]
    words = [] if cutting.invert is None else ["--invert" if cutting.invert else "--no-invert"]
    words += ["--walls"] if cutting.is_walls else []
    return [*words, *option_words(options), *_unusual(said)]


def plate_words(made: PlateMaking) -> list[str]:
    """The same of a plate."""
    (recipe, is_colour), usual = of_plate(made), ReliefRecipe()
    named = {"side": "columns", "pitch_mm": "pitch-mm", "relief_px": "relief", "elevation_deg": "elevation-deg"}
    named |= {"sweeps": "sweeps"}
    said = [(word, getattr(recipe, name), getattr(usual, name)) for name, word in named.items()]
    return [*(["--colour"] if is_colour else []), *_unusual(said)]


def _unless(usual: Any, value: Any) -> Any:
    """A value, or None where it is as usual."""
    return None if value == usual else value


def _unusual(said: Sequence[tuple[str, Any, Any]]) -> list[str]:
    return [word for name, value, usual in said if value != usual for word in _typed(name, value)]


def _typed(name: str, value: Any) -> tuple[str, str]:
    """An option and its value."""
    several = value if isinstance(value, tuple) else (value,)
    return f"--{name.replace('_', '-')}", ",".join(str(each).removesuffix(".0") for each in several)
