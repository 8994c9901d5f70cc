"""The examples of docstrings run and print what they say."""

import doctest
import importlib
import re
from pathlib import Path

import numpy as np
import pytest

import lightcube

PACKAGE = Path(lightcube.__file__).parent
WITH_EXAMPLES = [file for file in sorted(PACKAGE.rglob("*.py")) if ">>>" in file.read_text()]


def dotted(file: Path) -> str:
    return ".".join(["lightcube", *file.relative_to(PACKAGE).with_suffix("").parts]).removesuffix(".__init__")


def examples(name: str) -> list[doctest.DocTest]:
    """What doctest finds in the docstrings of a module."""
    return [found for found in doctest.DocTestFinder().find(importlib.import_module(name), name) if found.examples]


@pytest.mark.parametrize("file", WITH_EXAMPLES, ids=dotted)
def test_examples_of_docstrings_run(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Numbers are printed to four places, and tiny ones as 0, so that no machine's last digit matters."""
    monkeypatch.chdir(tmp_path)
    for each in examples(dotted(file)):
        with np.printoptions(precision=4, suppress=True):
            said: list[str] = []
            failed = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(each, out=said.append).failed
        assert not failed, "".join(said)


@pytest.mark.parametrize("file", WITH_EXAMPLES, ids=dotted)
def test_no_example_is_overlooked(file: Path) -> None:
    """Doctest passes over functions in functions, cached properties, and what stands outside of docstrings."""
    written = len(re.findall(r"^\s*>>> ", file.read_text(), re.MULTILINE))
    assert sum(len(each.examples) for each in examples(dotted(file))) == written
