"""What public functions and values are given, checked by their own annotations: `InputError` says what is wrong.

`checked` is for functions, `check_fields` for frozen dataclasses. Annotations are read when something is first checked,
so that importing costs nothing; a check costs about a microsecond for each thing given.
"""

import builtins
import functools
import inspect
import math
import sys
import types
import typing
from collections.abc import Callable, Mapping
from collections.abc import Set as AnySet
from dataclasses import dataclass, fields
from numbers import Integral, Real
from typing import Any, TypeVar

import numpy as np

from lightcube.errors import InputError

Function = TypeVar("Function", bound=Callable[..., Any])

#: What to do where a value of some class is missing.
_SOURCES = {
    "Cube": "read one with lightcube.load, or take the one that was solved, solution.cube",
    "Grid": "make one with lightcube.Grid((nz, ny, nx))",
    "Pictures": "read some with lightcube.read_pictures",
    "Rig": "make one with lightcube.turntable, or take that of a stage, stage.rig()",
    "Scene": "read one with lightcube.read_scene",
    "Shape": "carve one with lightcube.hull, or read one with lightcube.read_shape",
    "Silhouettes": "make some with lightcube.silhouettes",
    "Stage": "read one with lightcube.read_stage",
    "Targets": "fit pictures to a rig with lightcube.fit",
    "Views": "take those of a rig, rig.views",
}
#: What has a length and parts, and still is no list of things.
_NO_LISTS = (str, bytes, Mapping, AnySet)
#: Kinds of numpy's numbers by what an array is to hold; whatever is left are real numbers.
_NUMBERS: tuple[tuple[type, str, str], ...] = (
    (np.bool_, "b", "an array of True and False"),
    (np.integer, "iu", "an array of whole numbers"),
)


def _is_number(value: Any, kind: type) -> bool:
    """Whether something is a number of a kind, not NaN, and not beyond all that machines reckon with."""
    most: Any = sys.float_info.max if kind is Real else 2**63 - 1
    if not isinstance(value, kind) or isinstance(value, bool):
        return False
    return not math.isnan(value) if isinstance(value, float | np.floating) else -most <= value <= most


@dataclass(frozen=True)
class _Kind:
    """What an annotation stands for: what sentences call it, what is of the kind, and what to do about all else."""

    called: str
    fits: Callable[[Any], bool]
    remedy: str = ""
    #: What lists and arrays are made of in fields.
    is_tuple: bool = False

    @property
    def advice(self) -> str:
        """What to do, for the end of a sentence."""
        return self.remedy or f"give {self.called}"


_ANYTHING = _Kind("anything", lambda value: True)
_SIMPLE = {
    bool: _Kind("True or False", lambda value: isinstance(value, bool | np.bool_)),
    int: _Kind("a whole number", lambda value: _is_number(value, Integral)),
    float: _Kind("a number", lambda value: _is_number(value, Real)),
    str: _Kind("a text", lambda value: isinstance(value, str)),
    Any: _ANYTHING,
    object: _ANYTHING,
}


def checked(function: Function) -> Function:
    """Let a function raise `InputError` where it is given something of another kind than its annotation says.

    What has no annotation may be anything. A missing argument and an unknown one are Python's own `TypeError`.
    """
    names = list(inspect.signature(function).parameters)
    where = function.__qualname__.removesuffix(".__init__").removesuffix(".__call__")

    @functools.wraps(function)
    def checking(*given: Any, **named: Any) -> Any:
        kinds = _kinds(function)
        for name, value in (*zip(names, given, strict=False), *named.items()):
            kind = kinds.get(name, _ANYTHING)
            if not kind.fits(value):
                raise _refused(where, kind, name, value)
        return function(*given, **named)

    return typing.cast(Function, checking)


def check_fields(thing: Any, where: str = "") -> None:
    """Raise `InputError` where a field of a frozen dataclass is of another kind than its annotation says.

    Lists and arrays become tuples where tuples belong. Sentences begin with `where`, or the name of the class.
    """
    for name, kind in _field_kinds(thing.__class__):
        value = getattr(thing, name)
        if not kind.fits(value):
            raise _refused(where or type(thing).__name__, kind, name, value)
        if kind.is_tuple and not isinstance(value, str | tuple | Real | None):
            object.__setattr__(thing, name, tuple(value.tolist() if isinstance(value, np.ndarray) else value))


def _refused(where: str, kind: _Kind, name: str, value: Any) -> InputError:
    """What to raise where a value is of another kind."""
    return InputError(f"{where} takes {kind.called} as {name}, not {_said(value)}: {kind.advice}")


@functools.cache
def _field_kinds(kind: Any) -> list[tuple[str, _Kind]]:
    """The kinds of the fields that a dataclass is made of, by name."""
    kinds = _kinds(kind)
    return [(each.name, kinds[each.name]) for each in fields(kind) if each.init]


def _said(value: Any) -> str:
    """What something is, in a few words."""
    if value is None or isinstance(value, str | int | float | complex):
        text = repr(value)
        return text if len(text) <= 60 else f"{text[:50]}..."
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype}"
    if isinstance(value, list | tuple) and len(text := repr(value)) <= 60:
        return text
    name = type(value).__name__
    return f"{'an' if name[0] in 'AEIOUaeiou' else 'a'} {name}"


class _Names(dict[str, Any]):
    """The names of a module, in which those that only type checkers know are anything."""

    def __missing__(self, name: str) -> Any:
        return getattr(builtins, name, Any)


@functools.cache
def _kinds(thing: Any) -> Mapping[str, _Kind]:
    """The kinds of a function's arguments, or of a class's fields."""
    names = _Names(vars(sys.modules[thing.__module__]))
    hints = typing.get_type_hints(thing, localns=names, include_extras=True)
    hints.pop("return", None)
    options = hints.pop("options", None)  # keyword arguments whose names a `TypedDict` lists
    if typing.get_origin(options) is typing.Unpack:
        table = typing.get_args(options)[0]
        hints |= typing.get_type_hints(table, include_extras=True)
    return {name: _kind(hint) for name, hint in hints.items()}


def _kind(hint: Any) -> _Kind:
    """What an annotation stands for."""
    origin, parts = typing.get_origin(hint), typing.get_args(hint)
    if isinstance(hint, TypeVar):
        return _kind(hint.__bound__ or Any)
    if origin in (typing.Union, types.UnionType):
        return _any_of([_kind(part) for part in parts if part is not type(None)], optional=type(None) in parts)
    if origin is typing.Literal:
        known = f"use one of {', '.join(parts)}"
        return _Kind("a known word", lambda value: isinstance(value, str) and value in parts, known)
    if origin is typing.Annotated:
        return _Kind("numbers", lambda value: _holds(value, "iuf")) if "numbers" in parts else _kind(parts[0])
    if origin is np.ndarray:
        return _array(parts[1])
    if origin is tuple or (isinstance(origin, type) and issubclass(origin, list | typing.Sequence)):
        return _sequence(parts, is_tuple=origin is tuple)
    if origin is Mapping:
        return _table(_kind(parts[1]))
    return _SIMPLE.get(origin or hint) or _of_class(origin or hint)


def _any_of(kinds: list[_Kind], *, optional: bool) -> _Kind:
    """One of several kinds, or None where nothing need be given."""
    called = " or ".join(dict.fromkeys(kind.called for kind in kinds))

    def fits(value: Any) -> bool:
        return (optional and value is None) or any(kind.fits(value) for kind in kinds)

    remedy = kinds[0].remedy or f"give {called}"
    return _Kind(called, fits, remedy + ", or leave it out" * optional, any(kind.is_tuple for kind in kinds))


def _array(dtype: Any) -> _Kind:
    """An array of numbers, or what becomes one."""
    scalar = typing.get_args(dtype)[0]
    scalar = typing.get_origin(scalar) or scalar
    for group, letters, called in _NUMBERS:
        if isinstance(scalar, type) and issubclass(scalar, group):
            return _Kind(called, functools.partial(_holds, kinds=letters, axes=1))
    return _Kind("an array of numbers", functools.partial(_holds, kinds="iuf", axes=1))


def _holds(value: Any, kinds: str, axes: int = 0) -> bool:
    """Whether something is an array of numbers of these of numpy's kinds, or becomes one, of so many axes at least."""
    if isinstance(value, np.ndarray):
        array = value
    elif value is None or isinstance(value, _NO_LISTS):
        return False
    else:
        try:
            array = np.asarray(value)
        except Exception:  # lists of unequal lengths, and whatever a stranger's own conversion raises
            return False
    return array.ndim >= axes and (array.dtype.kind in kinds or (array.size == 0 and array.dtype.kind == "f"))


def _sequence(parts: tuple[Any, ...], *, is_tuple: bool) -> _Kind:
    """A list, tuple or array of things, for tuples without an ellipsis of so many."""
    many = Ellipsis in parts or not is_tuple
    kinds = [_kind(part) for part in parts if part is not Ellipsis]
    alike = kinds[0].called.split(" ", 1)[-1] if kinds[0].called.startswith(("a ", "an ")) else kinds[0].called
    plural = alike if alike.endswith("s") or " of " in alike else f"{alike}s"

    def fits(value: Any) -> bool:
        if type(value) is tuple:
            items = value
        elif isinstance(value, _NO_LISTS) or not hasattr(value, "__getitem__"):
            return False
        else:
            try:
                items = tuple(value.tolist() if isinstance(value, np.ndarray) else value)
            except TypeError:  # an array of no axes is no list
                return False
        if many:
            return all(kinds[0].fits(item) for item in items)
        return len(items) == len(kinds) and all(kind.fits(item) for kind, item in zip(kinds, items, strict=True))

    return _Kind(f"a list of {plural}" if many else f"{len(kinds)} {plural}", fits, is_tuple=is_tuple)


def _table(kind: _Kind) -> _Kind:
    """Values of some kind by their names."""

    def fits(value: Any) -> bool:
        return isinstance(value, Mapping) and all(kind.fits(each) for each in value.values())

    return _Kind(
        "a table of names and values" if kind is _ANYTHING else f"a table of names, each of {kind.called}", fits
    )


def _of_class(kind: Any) -> _Kind:
    """A value of some class, or one that has all that a protocol asks for."""
    name = kind.__name__
    if kind is Callable or name == "Callable":
        return _Kind("a function", callable)
    if getattr(kind, "_is_protocol", False):
        asked = [each for each in vars(kind) if each == "__call__" or not each.startswith("_")]
        if asked == ["__call__"]:
            return _Kind("a function", callable)
        return _Kind(f"a {name}", lambda value: all(hasattr(value, each) for each in asked))
    article = "" if name.endswith("s") else "a "
    return _Kind(f"{article}{name}", lambda value: isinstance(value, kind), _SOURCES.get(name, ""))
