"""Documents in which one value is another one."""

import copy
from collections.abc import Iterator
from typing import Any

#: What stands where something else is expected.
LEAVES: list[Any] = [
    "text",
    "<script>alert(1)</script>\x1b[31m\u202e",
    float("nan"),
    1e308,
    -1,
    10**400,
    None,
    True,
    [],
    {},
    {"a": {"b": [{"c": None}]}},
    [[[["deep"]]]],
    ["x"] * 3,
    "x" * 100_000,
]

Path = tuple[str | int, ...]


def leaves(document: Any, path: Path = ()) -> Iterator[Path]:
    """Yield where each value of a document stands; of lists only the first one."""
    if path:
        yield path
    if isinstance(document, dict):
        for key, value in document.items():
            yield from leaves(value, (*path, key))
    elif isinstance(document, list) and document:
        yield from leaves(document[0], (*path, 0))


def changed_leaf(document: Any, path: Path, value: Any) -> Any:
    """A copy of a document in which one value is another one."""
    made = copy.deepcopy(document)
    inside = made
    for key in path[:-1]:
        inside = inside[key]
    inside[path[-1]] = value
    return made
