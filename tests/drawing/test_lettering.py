"""Words on pictures: every letter is drawn, or one that can be read in its place."""

import unicodedata

import numpy as np
import pytest
from PIL import Image, ImageDraw, ImageFont

from lightcube.drawing import lettering

BOX = "\uffff"


@pytest.fixture
def alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine without fonts."""
    monkeypatch.setattr(lettering, "_FILES", ("no-such-font.ttf",))


def ink(text: str, width: float = 300) -> np.ndarray:
    sheet = Image.new("L", (300, 40))
    lettering.write(ImageDraw.Draw(sheet), (5, 5), text, 20, 255, width)
    return np.asarray(sheet)


def test_what_the_built_in_font_has_is_written_in_it() -> None:
    plain = Image.new("L", (300, 40))
    ImageDraw.Draw(plain).text((5, 5), "Six “mornings” · 3°", 255, ImageFont.load_default(20))
    np.testing.assert_array_equal(ink("Six “mornings” · 3°"), np.asarray(plain))


def test_other_letters_are_taken_from_a_font_that_has_them() -> None:
    if len(list(lettering._fonts(20))) == 1:
        pytest.skip("there is no font here beside the built-in one")
    line, font = lettering.spelled("Café Łódź, Ωραία", 20)
    assert line == "Café Łódź, Ωραία"
    assert bytes(font.getmask(BOX)) not in {bytes(font.getmask(letter)) for letter in line.replace(" ", "")}
    assert ink("é").sum() > ink("e").sum()


@pytest.mark.parametrize(("text", "line"), [("Café", "Cafe"), ("über Łódź", "uber ?odz"), ("日本", "??")])
def test_without_such_a_font_letters_go_bare_and_none_is_a_box(text: str, line: str, alone: None) -> None:
    spelled, font = lettering.spelled(text, 20)
    assert spelled == line
    assert bytes(font.getmask(BOX)) not in {bytes(font.getmask(letter)) for letter in spelled}
    np.testing.assert_array_equal(ink(text), ink(line))


def test_accents_that_stand_apart_in_a_name_are_one_letter_with_it() -> None:
    assert lettering.spelled(unicodedata.normalize("NFD", "Café"), 20)[0] == "Café"


def test_a_line_is_cut_where_it_is_too_wide_and_has_no_second_one(alone: None) -> None:
    assert ink("one\ntwo").sum() == ink("one two").sum()
    assert ink("a very long line of words", 100)[:, 106:].max() == 0
    assert ink("a very long line of words", 100).any()
