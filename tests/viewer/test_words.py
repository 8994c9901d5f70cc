"""Names on the page, as short as they can be told apart."""

import pytest

from tests.helpers.paging import Evaluate


@pytest.mark.parametrize(
    ("names", "wanted"),
    [
        (["IMG_20230411_1023", "IMG_20230411_1147", "IMG_20230411_0900"], ["…1023", "…1147", "…0900"]),
        (["IMG_20230411_1023", "IMG_20230512_0900"], ["…20230411_1023", "…20230512_0900"]),
        (["holiday 1 small", "holiday 22 small"], ["…1…", "…22…"]),
        (["astronaut suit", "astronomer suit"], ["astronaut…", "astronomer…"]),
        (["cat_1", "cat_2"], ["cat_1", "cat_2"]),
        (["a long name alone"], ["a long name alone"]),
        (["the same name", "the same name"], ["…name", "…name"]),
        (["summer picture", "summer picture 2"], ["…picture", "…picture 2"]),
        (["one_two_three", "one_two_three_"], ["…three", "…three_"]),
    ],
)
def test_names_lose_what_they_share(evaluate: Evaluate, names: list[str], wanted: list[str]) -> None:
    assert evaluate(("model/words.js",), "shortened(argument)", names) == wanted


def test_names_that_differ_still_do(evaluate: Evaluate) -> None:
    names = [f"{a}{b}{c}" for a in ("", "x_", "x_x_") for b in ("long long", "long") for c in ("", "_x", ".x_x", "_")]
    shown = evaluate(("model/words.js",), "shortened(argument)", names)
    assert len(set(shown)) == len(set(names))
    pairs = [(a, b) for a in names for b in names if a != b]
    both = evaluate(("model/words.js",), "argument.map(shortened)", pairs)
    assert all(one != other for one, other in both)
