"""What a scene file may say: one pydantic model per table, see docs/scenes.md.

Lengths are scene units, angles degrees, times fractions of the animation (0 to 1), colours sRGB. The axes are
right-handed with z up. Unknown keys are refused.
"""

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import ErrorDetails, PydanticCustomError

from lightcube.errors import InputError

#: Larger numbers would overflow in squares of squares.
_LARGEST = 1e6

Number = Annotated[float, Field(strict=True, ge=-_LARGEST, le=_LARGEST, allow_inf_nan=False)]
Positive = Annotated[float, Field(strict=True, gt=0, le=_LARGEST, allow_inf_nan=False)]
AtLeastZero = Annotated[float, Field(strict=True, ge=0, le=_LARGEST, allow_inf_nan=False)]
Fraction = Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)]
Elevation = Annotated[float, Field(strict=True, gt=-89.999, lt=89.999, allow_inf_nan=False)]
Count = Annotated[int, Field(strict=True, ge=1, le=100_000)]
Pixels = Annotated[int, Field(strict=True, ge=1, le=8192)]
Point = tuple[Number, Number, Number]
Line = Annotated[str, Field(min_length=1, pattern=r"^[^\x00-\x1f\x7f]*\S[^\x00-\x1f\x7f]*$")]


def hex_colour(value: Any) -> Any:
    """``"#rgb"`` or ``"#rrggbb"`` to three numbers; anything else as it is, for the next check."""
    if not isinstance(value, str):
        return value
    if not re.fullmatch(r"#([0-9a-fA-F]{3}|[0-9a-fA-F]{6})", value):
        raise PydanticCustomError("colour", "must be '#rgb', '#rrggbb' or three numbers from 0 to 1")
    digits = value[1:]
    pairs = [2 * digit for digit in digits] if len(digits) == 3 else [digits[i : i + 2] for i in (0, 2, 4)]
    return tuple(int(pair, 16) / 255 for pair in pairs)


def _three(value: Any) -> Any:
    """One number for all axes to three numbers."""
    return (value,) * 3 if isinstance(value, int | float) and not isinstance(value, bool) else value


def _direction(value: Point) -> Point:
    """Refuse a vector that points nowhere."""
    if max(map(abs, value)) < 1e-9:
        raise PydanticCustomError("direction", "must not be zero")
    return value


Colour = Annotated[tuple[Fraction, Fraction, Fraction], BeforeValidator(hex_colour)]
Light = Annotated[Colour, BeforeValidator(_three)]
Scale = Annotated[tuple[AtLeastZero, AtLeastZero, AtLeastZero], BeforeValidator(_three)]
Direction = Annotated[Point, AfterValidator(_direction)]
Easing = Literal["linear", "ease-in", "ease-out", "ease-in-out", "smooth", "step"]


class _Table(BaseModel):
    model_config: ClassVar[ConfigDict] = ConfigDict(extra="forbid", frozen=True, defer_build=True)


class Key(_Table):
    """What holds at one time; what is left out goes on between the keys that name it."""

    time: Fraction
    position: Point | None = None
    rotation_deg: Point | None = None
    scale: Scale | None = None
    easing: Easing | None = None


class Motion(_Table):
    """Keyframes; `easing` is how the motion goes from a key to the next where that key does not say."""

    keys: Annotated[tuple[Key, ...], Field(min_length=1, max_length=1000)]
    loop: Annotated[bool, Field(strict=True)] = False
    phase: Fraction = 0.0
    easing: Easing = "linear"

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        times = [key.time for key in self.keys]
        if any(later <= earlier for earlier, later in pairwise(times)):
            raise PydanticCustomError("keys", "keys must be in order of time, no two at the same time")
        if self.phase and not self.loop:
            raise PydanticCustomError("phase", "phase shifts a loop only: set loop = true")
        if self.loop:
            self._check_closed()
        return self

    def _check_closed(self) -> None:
        """In a loop times 0 and 1 are the same instant."""
        for channel in ("position", "rotation_deg", "scale"):
            named = [key for key in self.keys if getattr(key, channel) is not None]
            if len(named) > 1 and named[0].time == 0 and named[-1].time == 1:
                gaps = [b - a for a, b in zip(getattr(named[0], channel), getattr(named[-1], channel), strict=True)]
                turn = 360.0 if channel == "rotation_deg" else 1e30
                if any(abs(gap - turn * round(gap / turn)) > 1e-9 for gap in gaps):
                    raise PydanticCustomError("loop", f"in a loop, {channel} at time 1 must be as at time 0")


class Placed(_Table):
    """Whatever stands somewhere: at rest as said here, or as its motion says; in the scene or in a parent's axes."""

    position: Point = (0.0, 0.0, 0.0)
    rotation_deg: Point = (0.0, 0.0, 0.0)
    scale: Scale = (1.0, 1.0, 1.0)
    parent: str | None = None
    motion: Motion | None = None


class Group(Placed):
    """Axes that shapes and other groups may name as their parent."""


class Checker(_Table):
    """A second colour in every other cell of a cubic pattern in the shape's own axes."""

    colour: Colour
    size: Positive


class _Shape(Placed):
    colour: Colour
    glass: Positive | None = None
    checker: Checker | None = None
    highlight: AtLeastZero = 0.0
    sharpness: Annotated[float, Field(strict=True, ge=1, le=10_000)] = 40.0

    @model_validator(mode="after")
    def _plain_glass(self) -> Self:
        if self.glass is not None and self.checker is not None:
            raise PydanticCustomError("glass", "glass cannot have a checker: leave out one of the two")
        return self


class Sphere(_Shape):
    """A ball."""

    type: Literal["sphere"]
    radius: Positive


class Box(_Shape):
    """A box of full side lengths `size`."""

    type: Literal["box"]
    size: tuple[Positive, Positive, Positive]


class Cylinder(_Shape):
    """A cylinder along z."""

    type: Literal["cylinder"]
    radius: Positive
    height: Positive


class Capsule(_Shape):
    """Everything within `radius` of a piece of the z axis, `length` long."""

    type: Literal["capsule"]
    radius: Positive
    length: Positive


class Cone(_Shape):
    """A cone along z, its base below; with a `top_radius` a truncated one."""

    type: Literal["cone"]
    radius: Positive
    height: Positive
    top_radius: AtLeastZero = 0.0


class Torus(_Shape):
    """A ring about z: a tube of radius `tube` whose middle runs at `radius`."""

    type: Literal["torus"]
    radius: Positive
    tube: Positive

    @model_validator(mode="after")
    def _thin(self) -> Self:
        if self.tube >= self.radius:
            raise PydanticCustomError("tube", "tube must be < radius")
        return self


class Plane(_Shape):
    """The endless plane z = 0, seen from both sides."""

    type: Literal["plane"]
    glass: None = None


class Mesh(_Shape):
    """Triangles from an STL or OBJ file, its path relative to the scene file."""

    type: Literal["mesh"]
    file: Annotated[str, Field(min_length=1)]


class Text(_Shape):
    """Letters that read along x and stand along z, `depth` thick along y, capitals `height` high, centred."""

    type: Literal["text"]
    text: Annotated[Line, Field(max_length=64)]
    height: Positive
    depth: Positive


Shape = Annotated[
    Sphere | Box | Cylinder | Capsule | Cone | Torus | Plane | Mesh | Text,
    Field(discriminator="type"),
]


class PointLight(_Table):
    """A lamp at `position` whose light does not weaken with distance."""

    type: Literal["point"]
    position: Point
    colour: Light = (1.0, 1.0, 1.0)
    strength: AtLeastZero = 1.0


class DirectionalLight(_Table):
    """Parallel light that travels along `direction`."""

    type: Literal["directional"]
    direction: Direction
    colour: Light = (1.0, 1.0, 1.0)
    strength: AtLeastZero = 1.0


class _SeeingCamera(_Table):
    position: Point
    target: Point = (0.0, 0.0, 0.0)
    samples: Annotated[int, Field(strict=True, ge=1, le=8)] = 2

    @model_validator(mode="after")
    def _looks_somewhere(self) -> Self:
        x, y, z = (b - a for a, b in zip(self.position, self.target, strict=True))
        if max(abs(x), abs(y), abs(z)) < 1e-9:
            raise PydanticCustomError("target", "target must differ from position")
        if max(abs(x), abs(y)) < 1e-9 * abs(z):
            raise PydanticCustomError("target", "the camera cannot look straight up or down: move it a little aside")
        return self


class PerspectiveCamera(_SeeingCamera):
    """A pinhole camera; `field_of_view_deg` is the angle from the picture's top to its bottom."""

    type: Literal["perspective"]
    field_of_view_deg: Annotated[float, Field(strict=True, gt=0, le=170)] = 40.0


class ParallelCamera(_SeeingCamera):
    """A camera of parallel beams; `height` is what its picture holds from top to bottom."""

    type: Literal["parallel"]
    height: Positive


class ShadowCamera(_Table):
    """The lamp and screen of the light cube's own turntable; `cube_width` scene units are as wide as the cube."""

    type: Literal["shadow"]
    cube_width: Positive


Camera = Annotated[PerspectiveCamera | ParallelCamera | ShadowCamera, Field(discriminator="type")]


class Background(_Table):
    """Colours at the picture's top and bottom edge; display values are mixed in linear light between them."""

    top: Light = (1.0, 1.0, 1.0)
    bottom: Light = (1.0, 1.0, 1.0)


class PicturesTable(_Table):
    """How many pictures of which ``size = [width, height]``, over how many degrees, with the lamp how high."""

    count: Count = 60
    size: tuple[Pixels, Pixels] = (128, 128)
    span_deg: Annotated[float, Field(strict=True, gt=0, le=360)] | None = None
    elevation_deg: Elevation = 0.0


class SceneFile(_Table):
    """A whole scene file."""

    title: str = ""
    camera: Camera
    pictures: PicturesTable = PicturesTable()
    background: Background = Background()
    ambient: Light = (0.35, 0.35, 0.35)
    lights: tuple[Annotated[PointLight | DirectionalLight, Field(discriminator="type")], ...] = ()
    groups: dict[str, Group] = Field(default_factory=dict)
    shapes: Annotated[tuple[Shape, ...], Field(min_length=1, max_length=1000)]

    @model_validator(mode="after")
    def _parents(self) -> Self:
        placed: list[tuple[str, Placed]] = [(f"shapes.{i}", shape) for i, shape in enumerate(self.shapes)]
        placed += [(f"groups.{name}", group) for name, group in self.groups.items()]
        for where, one in placed:
            seen = set()
            parent = one.parent
            while parent is not None:
                if parent not in self.groups:
                    raise _at(f"{where}.parent", f"there is no group {parent!r}: {_known(self.groups)}")
                if parent in seen:
                    raise _at(f"{where}.parent", f"group {parent!r} is its own ancestor")
                seen.add(parent)
                parent = self.groups[parent].parent
        return self

    @model_validator(mode="after")
    def _shadow_solids(self) -> Self:
        if self.camera.type == "shadow":
            for i, shape in enumerate(self.shapes):
                if shape.type == "plane":
                    raise _at(f"shapes.{i}.type", "a plane is no solid: a shadow camera sees closed solids only")
                if shape.glass is None:
                    raise _at(f"shapes.{i}.glass", "is missing: a shadow camera sees glass only")
        return self


def _at(where: str, message: str) -> PydanticCustomError:
    """Error at a key that the model itself cannot point to."""
    return PydanticCustomError("at", "{where}: {message}", {"where": where, "message": message})


def _known(names: Mapping[str, Any]) -> str:
    return f"the groups are {', '.join(names)}" if names else "the scene has no groups"


def parse(data: Mapping[str, Any], name: str = "scene") -> SceneFile:
    """Check the tables of a scene file.

    Parameters
    ----------
    data
        The file's tables, as a TOML reader gives them.
    name
        The file's name, for messages.

    Raises
    ------
    InputError
        For the first thing that is wrong: ``name: key.path: what is allowed``.
    """
    try:
        return SceneFile.model_validate(data)
    except ValidationError as error:
        raise InputError(f"{name}: {sentence(error.errors(include_url=False)[0])}") from None


def sentence(problem: ErrorDetails) -> str:
    """``key.path: what is allowed`` of one of pydantic's findings."""
    path = _path(problem["loc"])
    kind, context = problem["type"], problem.get("ctx", {})
    if kind == "at":
        return f"{context['where']}: {context['message']}"
    if kind in _COMPARISONS:
        sign, key = _COMPARISONS[kind]
        message = f"must be {sign} {context[key]:g}"
    elif kind in ("union_tag_invalid", "union_tag_not_found"):
        path, message = f"{path}.type", f"must be one of {context.get('expected_tags', 'the known types')}"
    else:
        message = _MESSAGES.get(kind, problem["msg"].replace("Input should be", "must be"))
    return f"{path}: {message}" if path else message


#: So many letters of a key are said.
_LONGEST_KEY = 60
_COMPARISONS = {
    "greater_than": (">", "gt"),
    "greater_than_equal": (">=", "ge"),
    "less_than": ("<", "lt"),
    "less_than_equal": ("<=", "le"),
}
_MESSAGES = {
    "extra_forbidden": "no such key here: take it out, or mend its name",
    "missing": "is missing",
    "too_short": "is too short: more is needed here",
    "too_long": "is too long",
    "tuple_type": "must be a list",
    "model_type": "must be a table",
    "model_attributes_type": "must be a table",
    "list_type": "must be a list",
    "dict_type": "must be a table",
    "float_type": "must be a number",
    "int_type": "must be a whole number",
    "bool_type": "must be true or false",
    "string_type": "must be a text",
    "string_too_long": "is too long",
    "string_pattern_mismatch": "must be one line with something to see in it",
}


def _shown(key: str) -> str:
    """A key as one can read it: not too long, and without what moves a terminal's cursor."""
    key = key if len(key) <= _LONGEST_KEY else f"{key[:_LONGEST_KEY]}..."
    return key if key.isprintable() else repr(key)


def _path(place: Sequence[int | str]) -> str:
    """Key path without the type names that pydantic puts after a table that may be of several types."""
    parts = [_shown(str(part)) for part in place]
    typed = {2: "shapes lights", 1: "camera"}
    return ".".join(
        part for i, part in enumerate(parts) if not (i in typed and parts[0] in typed[i].split() and len(parts) > i)
    )
