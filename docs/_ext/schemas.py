"""The pages of the files that lightcube reads and writes: every table and key, from the models that check them."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import stored
from marked import hidden, plain, table
from pydantic import BaseModel

from lightcube.io import _metadata, _shape_json, pictures_folder
from lightcube.io._attenuators import AttenuatorFile
from lightcube.io._stage_tables import StageFile
from lightcube.io.materials import MaterialFile
from lightcube.scene.description import SceneFile

#: Bounds that keep numbers from overflowing, of which nothing is said here.
_FAR = 1e6


@dataclass(frozen=True)
class Described:
    """A kind of file: its page, what is said of it in Markdown, and the model that checks it, where one does."""

    name: str
    title: str
    said: str
    model: type[BaseModel] | None = None

    def said_from(self, up: str) -> str:
        """What is said of it on a page from which `up` leads to the docs."""
        return self.said.replace("](docs:", f"]({up}/")


FILES = (
    Described("scene", "A scene", "TOML that `lightcube trace` takes; [scene files](docs:scenes.md).", SceneFile),
    Described("stage", "A stage", "TOML, a room of lamps and screens; [the stage](docs:stage.md).", StageFile),
    Described("films", "A stage of films", "TOML; [films](docs:films.md).", AttenuatorFile),
    Described("material", "A material", "TOML, inks or resins; [materials](docs:materials.md).", MaterialFile),
    Described("views", "views.toml", "TOML beside the pictures of a folder.", pictures_folder._ViewsToml),
    Described(
        "cube",
        "A cube",
        "`.zarr`, `.zarr.zip`, `.npz`. The keys below are JSON: Zarr's attribute `lightcube`, NPZ's text `lightcube`.",
        _metadata._CubeJson,
    ),
    Described(
        "shape",
        "A shape",
        "`.shape.zarr`; [opaque objects](docs:solids.md). The keys below are JSON, Zarr's attribute `lightcube`.",
        _shape_json._ShapeJson,
    ),
    Described("relief", "A relief", "`.relief.zarr`; [a relief](docs:relief.md)."),
)


def pages() -> dict[str, str]:
    """The pages, and what the page of all includes, by the names of their files."""
    return {**{f"files/{each.name}.md": page(each) for each in FILES}, "files.txt": _index()}


def page(described: Described) -> str:
    """All that stands in a file: its arrays, where it has some, and every table and key."""
    parts = [f"# {described.title}", described.said_from("../../.."), *stored.arrays(described.name)]
    if described.model is not None:
        schema = described.model.model_json_schema()
        parts += _keys(schema, described.name)
        for name, each in schema.get("$defs", {}).items():
            parts += [f"({_anchor(described.name, name)})=\n## {_called(name)}", *_keys(each, described.name)]
    return "\n\n".join(parts) + "\n"


def _keys(schema: Mapping[str, Any], file: str) -> list[str]:
    """What is said of a table, and its keys."""
    needed = set(schema.get("required", ()))
    rows = [
        (f"`{key}`", _values(each, file), "*needed*" if key in needed else _default(each))
        for key, each in schema.get("properties", {}).items()
    ]
    said = " ".join(schema.get("description", "").split())
    return [said, table(("key", "holds", "if left out"), rows)] if rows else [said]


def _values(schema: Mapping[str, Any], file: str) -> str:
    """Which values a key may have, in words."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[1]
        return f"[{_called(name)}](#{_anchor(file, name)})"
    for several in ("anyOf", "oneOf"):
        if several in schema:
            each = [_values(one, file) for one in schema[several] if one.get("type") != "null"]
            return " or ".join(dict.fromkeys(each))
    if "const" in schema or "enum" in schema:
        return ", ".join(f"`{value}`" for value in schema.get("enum", [schema.get("const")]))
    said = _OF_TYPE.get(schema.get("type", ""))
    return "anything" if said is None else said(schema, file)


def _array(schema: Mapping[str, Any], file: str) -> str:
    if "prefixItems" in schema:
        each = [_values(one, file) for one in schema["prefixItems"]]
        return f"{len(each)} × {each[0]}" if len(set(each)) == 1 else f"[{', '.join(each)}]"
    least, most = schema.get("minItems"), schema.get("maxItems")
    count = f"{least} ×" if least is not None and least == most else "at least one of" if least else "list of"
    return f"{count} {_values(schema.get('items', {}), file)}"


def _number(schema: Mapping[str, Any], _file: str) -> str:
    words = {"exclusiveMinimum": "above", "minimum": "from", "exclusiveMaximum": "below", "maximum": "to"}
    bounds = [f"{word} {schema[key]:g}" for key, word in words.items() if key in schema and abs(schema[key]) != _FAR]
    return " ".join(["whole number" if schema["type"] == "integer" else "number", *bounds])


def _object(schema: Mapping[str, Any], file: str) -> str:
    inner = schema.get("additionalProperties")
    return f"by name: {_values(inner, file)}" if isinstance(inner, Mapping) and inner else "table"


def _text(schema: Mapping[str, Any], _file: str) -> str:
    return "date" if schema.get("format") == "date" else "text"


def _flag(_schema: Mapping[str, Any], _file: str) -> str:
    return "`true` or `false`"


_OF_TYPE: Mapping[str, Callable[[Mapping[str, Any], str], str]] = {
    "array": _array,
    "number": _number,
    "integer": _number,
    "object": _object,
    "string": _text,
    "boolean": _flag,
}


def _default(schema: Mapping[str, Any]) -> str:
    """What holds where a key is left out."""
    value = schema.get("default")
    if value is None or value in ([], {}) or isinstance(value, dict):
        return ""
    return f"`{str(value).lower() if isinstance(value, bool) else value}`"


def _called(name: str) -> str:
    """What a table is called, of its model's name."""
    words = re.sub(r"(Table|Json|File)$", "", name.strip("_"))
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", words).capitalize()


def _anchor(file: str, name: str) -> str:
    return f"{file}-{_called(name).lower().replace(' ', '-')}"


def _index() -> str:
    """What the page of all files includes."""
    rows = [(f"[{plain(each.title)}](made/files/{each.name}.md)", each.said_from("..")) for each in FILES]
    listed = hidden([f"made/files/{each.name}" for each in FILES])
    return f"{table(('file', 'what it is'), rows)}\n\n{listed}\n"
