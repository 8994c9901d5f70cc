"""What `solve` and `make_job` are asked for, from options in one row."""

from dataclasses import fields
from typing import Any

from lightcube.backward.recipe import Recipe
from lightcube.optics.material import Material

_OWN = {each.name for each in fields(Recipe)}


def asked(**options: Any) -> dict[str, Any]:
    """The recipe of those options that are its fields (`max_extinction` is its material's), and the others."""
    own = {name: value for name, value in options.items() if name in _OWN}
    others = {name: value for name, value in options.items() if name not in _OWN}
    if "max_extinction" in others:
        own["material"] = Material(others.pop("max_extinction"))
    return {"recipe": Recipe(**own), **others}
