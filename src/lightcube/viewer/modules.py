"""The page's JavaScript: readable modules that are put together into one text when a page is written."""

import re
from importlib.resources import files

_IMPORT = re.compile(r'^import \{[^}]*\} from "\./([a-z]+\.js)";\n', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?function|const|class)", re.MULTILINE)


def source(name: str) -> str:
    """Text of one of the page's own files, as it lies beside the package."""
    return files("lightcube.viewer").joinpath("web", name).read_text(encoding="utf-8")


def joined(*entries: str) -> str:
    """One module text of these modules and all that they import, each once and after what it imports.

    The modules share one scope then, so their top-level names must be unique; they import by ``import { a, b } from
    "./name.js";`` and export by a prefix of declarations only.
    """
    texts: dict[str, str] = {}

    def add(name: str) -> None:
        if name in texts:
            return
        text = source(name)
        for needed in _IMPORT.findall(text):
            add(needed)
        texts[name] = f"// {name}\n{_EXPORT.sub('', _IMPORT.sub('', text))}"

    for entry in entries:
        add(entry)
    return "\n".join(texts.values())
