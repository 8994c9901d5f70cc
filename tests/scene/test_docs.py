"""The reference of scene files: whole, and its example runs."""

import re
import tomllib
from pathlib import Path
from typing import Any, get_args

import pytest
from pydantic import BaseModel

from lightcube.io.scenes import scene_names
from lightcube.scene import description
from lightcube.scene.scene import scene_from_tables
from lightcube.scene.tracer import trace

PAGE = Path(__file__).parents[2] / "docs" / "scenes.md"
TABLES = [t for t in vars(description).values() if isinstance(t, type) and issubclass(t, BaseModel)]


def test_the_example_runs() -> None:
    example = re.search(r"```toml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert example is not None
    pictures = trace(scene_from_tables(tomllib.loads(example[1])), 2, (5, 5))
    assert pictures.std() > 0.01


@pytest.mark.parametrize("table", TABLES, ids=[t.__name__ for t in TABLES])
def test_every_key_is_described(table: type[BaseModel]) -> None:
    text = PAGE.read_text(encoding="utf-8")
    for key, about in table.model_fields.items():
        words: list[Any] = [key, *(get_args(about.annotation) if key in ("type", "easing") else ())]
        for word in words:
            if isinstance(word, str):
                assert re.search(rf"\b{re.escape(word)}\b", text), word


def test_every_shipped_scene_has_its_picture() -> None:
    text = PAGE.read_text(encoding="utf-8")
    for name in scene_names():
        assert f"| `{name}` |" in text
        assert f"(pictures/scene-{name}.png)" in text
        assert 0 < (PAGE.parent / "pictures" / f"scene-{name}.png").stat().st_size < 150_000
