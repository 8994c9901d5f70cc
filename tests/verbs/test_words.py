"""What is said of pictures: how near they come, which are no good, and what would help."""

import pytest

from lightcube.scoring.metrics import nearness
from lightcube.verbs import words

NAMES = ("a", "b", "c", "d")


def test_words_for_how_near_pictures_come_fall_with_the_figures() -> None:
    kinds = ["poor", "fair", "good", "hard to tell from what is wanted"]
    found = [nearness(decibels) for decibels in (0, 25.99, 26, 32.9, 33, 39.9, 40, 100)]
    assert found == [kind for kind in kinds for _ in (0, 1)]


@pytest.mark.parametrize(
    ("psnr", "said"),
    [
        ((44, 50, 41, 90), "well: all 4 pictures are hard to tell from what is wanted"),
        ((20, 9, 3, 1), "wrong: all 4 pictures are poor"),
        ((34, 45, 35, 46), "well: of 4 pictures 2 are hard to tell from what is wanted and 2 are good"),
        (
            (34, 9, 45, 20),
            "wrong: of 4 pictures 1 are hard to tell from what is wanted, 1 are good and 2 are poor (b, d)",
        ),
        ((34, 29, 28, 35), "well: of 4 pictures 2 are good and 2 are fair (c, b)"),
    ],
)
def test_pictures_are_judged_best_first_and_the_worst_are_named(psnr: tuple[float, ...], said: str) -> None:
    assert words.judged(NAMES, psnr, "are") == said.replace("1 are", "1 is")


def test_one_picture_is_one() -> None:
    assert words.judged(("a",), (35.0,), "will be") == "well: it will be good"


def test_of_many_bad_pictures_the_worst_five_are_named() -> None:
    said = words.judged([f"p{i}" for i in range(9)], range(20, 11, -1), "are")
    assert said == "wrong: all 9 pictures are poor"
    said = words.judged([f"p{i}" for i in range(9)], [50, *range(20, 12, -1)], "are")
    assert said.endswith("8 are poor (p8, p7, p6, p5, p4 and 3 more)")
