"""How a method is found: in the table, among what installed packages register, by its place, or as a function."""

import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from lightcube import solvers
from lightcube.errors import InputError
from lightcube.solvers import METHODS, check_lasting, find_method
from lightcube.solvers.cgls import cgls
from lightcube.solvers.method import Method
from tests.helpers.solver_problems import plain_descent

PLACE = "tests.helpers.solver_problems:plain_descent"
OWN = list(solvers.OWN)
MODULE = """
from lightcube.solvers.method import Method
from tests.helpers.solver_problems import plain_descent
TOLD = Method(plain_descent, coarse_to_fine=False, arrays=(3.0, 4.0))
NUMBER = 7
def few(A, B): ...
class Inside:
    @staticmethod
    def method(A, wanted, *, x0, bounds, iterations, callback, state): ...
"""


@pytest.fixture(autouse=True)
def nothing_is_remembered() -> Iterator[None]:
    yield
    solvers._registered.cache_clear()
    solvers._load.cache_clear()


@pytest.fixture
def someones(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Modules that somebody has installed: one that works and one that does not."""
    (tmp_path / "someones_methods.py").write_text(MODULE)
    (tmp_path / "someones_broken.py").write_text("import nothing_of_this_name")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "someones_methods", raising=False)


@pytest.fixture
def registered(someones: None, tmp_path: Path) -> None:
    """What an installed package says of these modules."""
    said = tmp_path / "someones-1.0.dist-info"
    said.mkdir()
    (said / "METADATA").write_text("Metadata-Version: 2.1\nName: someones\nVersion: 1.0\n")
    entries = {
        "plain": PLACE,
        "told": "someones_methods:TOLD",
        "broken": "someones_broken:method",
        "number": "someones_methods:NUMBER",
        "few": "someones_methods:few",
        "sirt": PLACE,
    }
    lines = [f"{name} = {place}" for name, place in entries.items()]
    (said / "entry_points.txt").write_text("\n".join(["[lightcube.methods]", *lines]))
    solvers._registered.cache_clear()


def test_the_table_has_the_packages_own() -> None:
    assert list(METHODS) == OWN
    assert len(METHODS) == 5
    for name in OWN:
        assert METHODS[name].name == name
        assert find_method(name) is METHODS[name]
        check_lasting(METHODS[name])
    assert "magic" not in METHODS
    with pytest.raises(KeyError):
        METHODS["magic"]
    with pytest.raises(InputError, match=r"unknown method 'magic': use one of display, .*cgls"):
        find_method("magic")


@pytest.mark.usefixtures("registered")
def test_registered_methods_are_in_the_table_and_the_broken_ones_are_not() -> None:
    assert METHODS["sirt"].solve is not plain_descent  # own names are nobody else's
    assert solvers._registered.cache_info().currsize == 0  # and nothing is looked for before it is asked for
    assert list(METHODS) == [*OWN, "plain", "told"]
    assert find_method("plain") == Method(plain_descent, "plain")
    told = find_method("told")
    assert (told.name, told.coarse_to_fine, told.arrays) == ("told", False, (3.0, 4.0))
    check_lasting(told)


@pytest.mark.parametrize(
    ("name", "why"),
    [
        (
            "broken",
            r"method broken \(someones_broken:method\) cannot be loaded \(No module named 'nothing_of_this_name'\)",
        ),
        ("number", r"method number \(someones_methods:NUMBER\) cannot be loaded \(.* is int and no function"),
        ("few", r"method few .* does not take what a solver is given, .* unexpected keyword argument 'x0'"),
    ],
)
@pytest.mark.usefixtures("registered")
def test_a_broken_one_is_named_when_it_is_asked_for(name: str, why: str) -> None:
    with pytest.raises(InputError, match=why):
        find_method(name)
    with pytest.raises(InputError, match=why):
        METHODS[name]
    assert name not in list(METHODS)


@pytest.mark.usefixtures("someones")
def test_a_function_is_called_by_its_place_and_found_there() -> None:
    method = find_method(plain_descent)
    assert method == Method(plain_descent) == find_method(PLACE) == find_method(method)
    assert method.name == PLACE
    assert find_method("someones_methods:TOLD").name == "someones_methods:TOLD"
    inside = find_method("someones_methods:Inside.method")
    assert inside.name == "someones_methods:Inside.method"
    for lasting in (method, find_method("someones_methods:TOLD"), inside, find_method(inside.solve)):
        check_lasting(lasting)


@pytest.mark.usefixtures("someones")
@pytest.mark.parametrize(
    ("place", "why"),
    [
        ("no_such_module:method", "method no_such_module:method cannot be imported"),
        ("someones_broken:method", "cannot be imported .*nothing_of_this_name"),
        ("someones_methods:magic", "cannot be imported .* no attribute 'magic'"),
        ("someones_methods:NUMBER", "is int and no function"),
        ("someones_methods:few", "does not take what a solver is given"),
        ("os:system", "does not take what a solver is given"),
        (":", "cannot be imported"),
    ],
)
def test_a_place_without_a_method_is_refused_with_a_sentence(place: str, why: str) -> None:
    with pytest.raises(InputError, match=why):
        find_method(place)


def test_what_no_name_leads_to_is_a_method_but_does_not_last(monkeypatch: pytest.MonkeyPatch) -> None:
    """Another program could not go on with what it has begun, or would with another function of that name."""

    def inner(A: Any, wanted: Any, **more: Any) -> Any:
        raise NotImplementedError

    monkeypatch.setattr(inner, "__module__", __name__)
    ones: list[Any] = [
        inner,
        partial(plain_descent, iterations=3),
        lambda A, wanted, **more: None,
        Method(plain_descent, "sirt"),
    ]
    for one in (*ones, Method(plain_descent, takes_sums=True)):
        method = find_method(one)
        with pytest.raises(InputError, match=r"an unfinished cube cannot go on .* name it as package\.module:name"):
            check_lasting(method)
    monkeypatch.setattr(plain_descent, "__module__", "__main__")
    monkeypatch.setattr(sys.modules["__main__"], "plain_descent", plain_descent, raising=False)
    with pytest.raises(InputError, match="by method __main__:plain_descent, which no name leads to"):
        check_lasting(find_method(plain_descent))


def test_a_function_of_another_signature_is_none() -> None:
    with pytest.raises(InputError, match="does not take what a solver is given"):
        find_method(lambda A, B: None)  # type: ignore[arg-type]


def test_a_plain_function_is_taken_for_what_the_defaults_say() -> None:
    method = Method(cgls)
    assert (method.chooses_lamps, method.takes_sums, method.holds_matrix) == (False, False, False)
    assert (method.coarse_to_fine, method.residual, method.passes) == (True, "sum", 100)
