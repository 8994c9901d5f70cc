"""What `help` says of the public names can be read."""

import inspect

import pytest

import lightcube as lc

CALLABLE = sorted(set(lc.__all__) - {"METHODS", "InputError"})


@pytest.mark.parametrize("name", CALLABLE)
def test_signatures_are_short_and_name_arrays_by_a_word(name: str) -> None:
    said = str(inspect.signature(getattr(lc, name)))
    assert len(said) <= 600
    for wall in ("ndarray[", "dtype[", "NDArray", "lightcube.", "numpy.", "collections."):
        assert wall not in said


@pytest.mark.parametrize("name", CALLABLE)
def test_every_annotation_means_something(name: str) -> None:
    """What checks rely on: no parameter is without one."""
    for parameter in inspect.signature(getattr(lc, name)).parameters.values():
        assert parameter.annotation is not inspect.Parameter.empty
