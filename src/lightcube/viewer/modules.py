"""The page's JavaScript: readable modules that are put together into one text when a page is written."""

import re
from importlib.resources import files
from posixpath import dirname, join, normpath

_IMPORT = re.compile(r'^import (\{[^}]*\}) from "(\.{1,2}/[a-z/]+\.js)";\n', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?(?:function|const|class) (\w+))", re.MULTILINE)


def source(path: str) -> str:
    """Text of one of the page's own files, by its path in the folder of them beside the package."""
    return files("lightcube.viewer").joinpath("web", *path.split("/")).read_text(encoding="utf-8")


def imports(path: str) -> list[str]:
    """Paths of the modules that a module imports from."""
    return [_beside(path, name) for _, name in _IMPORT.findall(source(path))]


def exports(path: str) -> list[str]:
    """Names that a module exports."""
    return _EXPORT.findall(source(path))


def joined(*entries: str) -> str:
    """One module text of these modules and all that they import, each once and after what it imports.

    Each becomes a closure that returns what it exports, so its other names are its own; what the entries export has
    its name in the text. Modules import by ``import { a, b } from "../tools/name.js";`` and export by a prefix of
    declarations only.
    """
    closures: dict[str, str] = {}

    def add(path: str) -> None:
        if path in closures:
            return
        for needed in imports(path):
            add(needed)
        closures[path] = _closure(path)

    for entry in entries:
        add(entry)
    opened = [f"const {_braced(exports(entry))} = {_variable(entry)};" for entry in entries if exports(entry)]
    return "\n".join([*closures.values(), *opened])


def _closure(path: str) -> str:
    """A module as a constant of the joined text: an object of what it exports."""
    opened = _IMPORT.sub(lambda found: f"const {found[1]} = {_variable(_beside(path, found[2]))};\n", source(path))
    return f"const {_variable(path)} = (() => {{\n{_EXPORT.sub('', opened)}return {_braced(exports(path))};\n}})();"


def _beside(path: str, name: str) -> str:
    """Path of what a module calls by a name that begins in its own folder."""
    return normpath(join(dirname(path), name))


def _variable(path: str) -> str:
    """What the joined text calls a module, as no module calls anything: ``tools/vectors.js`` is ``$tools_vectors``."""
    return "$" + path.removesuffix(".js").replace("/", "_")


def _braced(names: list[str]) -> str:
    return f"{{ {', '.join(names)} }}" if names else "{}"
