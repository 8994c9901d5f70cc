"""Parts of films: which pictures are read, evenly spread, and what is said of the others."""

import warnings
from pathlib import Path

import numpy as np
import pytest

from lightcube.errors import InputError
from lightcube.io import ThinnedFilm, is_film, read_pictures, save
from lightcube.io._excerpt import Excerpt

#: Pictures of a film of one grey each, ten a second, so that each can be told by its level.
COUNT, RATE = 23, 10
LEVELS = np.linspace(0.05, 0.95, COUNT)


@pytest.fixture(scope="module", params=[".mp4", ".mov", ".webm", ".gif", ".webp", ".apng"])
def film(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("film") / f"grey{request.param}"
    greys = np.broadcast_to(LEVELS[:, None, None, None] ** 2.2, (COUNT, 8, 16, 3)).astype(np.float32)
    made = path.with_suffix(".mp4" if request.param == ".mov" else request.param)
    save(greys, made, fps=RATE, scale=2)
    return made.rename(path)


def numbers(path: Path, **part: float) -> list[int]:
    """Numbers, from 1, of the pictures that are read, by their names and by what is in them."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ThinnedFilm)
        pictures = read_pictures(path, least=1, **part)  # type: ignore[arg-type]
    seen = [int(np.argmin(np.abs(LEVELS**2.2 - image.mean()))) + 1 for image in pictures.images]
    assert pictures.names == (tuple(map(str, seen)) if len(seen) > 1 else (path.stem,))
    return seen


def test_all_are_read_where_nothing_is_said(film: Path) -> None:
    assert numbers(film) == list(range(1, COUNT + 1))


def test_every_so_many_and_at_most_so_many(film: Path) -> None:
    assert numbers(film, every=5) == [1, 6, 11, 16, 21]
    assert numbers(film, every=COUNT + 5) == [1]
    assert numbers(film, most=COUNT) == numbers(film, most=1000) == numbers(film)
    assert numbers(film, most=1) == [COUNT // 2 + 1]
    assert numbers(film, every=5, most=2) == [6, 16]


@pytest.mark.parametrize("most", [2, 3, 7, 16, 22])
def test_what_is_taken_is_evenly_spread(film: Path, most: int) -> None:
    taken = numbers(film, most=most)
    assert len(taken) == most
    steps = np.diff(taken)
    assert steps.max() - steps.min() <= 1
    assert abs((taken[0] - 1) - (COUNT - taken[-1])) <= 1  # as much is left out before as behind


def test_parts_are_in_seconds_and_of_videos(film: Path) -> None:
    if film.suffix in (".mp4", ".mov", ".webm"):
        assert numbers(film, from_s=0.45) == list(range(6, COUNT + 1))
        assert numbers(film, to_s=0.45) == [1, 2, 3, 4, 5]
        assert numbers(film, from_s=0.45, to_s=1.95, every=3) == [6, 9, 12, 15, 18]
        assert numbers(film, from_s=0.45, to_s=1.95, every=3, most=2) == [9, 15]
        assert numbers(film, from_s=0.95, to_s=1.95) == list(range(11, 21))
        with pytest.raises(InputError, match=r"ends after 2.2 s: let --from be earlier"):
            read_pictures(film, from_s=9.0)
    else:
        with pytest.raises(InputError, match="says no times of its pictures: leave --from and --to out"):
            read_pictures(film, from_s=0.5)


def test_what_is_left_out_is_said(film: Path) -> None:
    with pytest.warns(ThinnedFilm, match=rf"6 of {COUNT} pictures of .*grey.* were taken, evenly spread"):
        read_pictures(film, most=6)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read_pictures(film, most=COUNT)
        read_pictures(film, every=2)


@pytest.mark.parametrize(
    ("part", "said"),
    [
        ({"from_s": 3.0, "to_s": 1.0}, "from 3 s to 1 s is none"),
        ({"from_s": 1.0, "to_s": 1.0}, "from 1 s to 1 s is none"),
        ({"from_s": -1.0}, "from 0 on, not at -1"),
        ({"to_s": -0.5}, "from 0 on, not at -0.5"),
        ({"most": 0}, "at least 1"),
        ({"every": 0}, "at least 1"),
    ],
)
def test_parts_that_cannot_be_are_a_sentence(part: dict[str, float], said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        Excerpt(**part)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=said):
        read_pictures(tmp_path / "none.mp4", **part)  # type: ignore[arg-type]


def test_a_folder_is_no_film(tmp_path: Path) -> None:
    folder = tmp_path / "a.gif"
    folder.mkdir()
    save(np.ones((3, 5, 7, 3), np.float32), folder / "in")
    assert not is_film(folder / "in")
    assert not is_film(folder)
    assert is_film(tmp_path / "none.mov")
    with pytest.raises(InputError, match="is a folder, and only of films a part is read"):
        read_pictures(folder / "in", most=2)


def test_long_films_are_looked_through_with_a_bound(film: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if film.suffix not in (".mp4", ".mov", ".webm"):
        return
    monkeypatch.setattr("lightcube.io._video._MOST_FRAMES", 9)
    with pytest.raises(InputError, match="too long to look through: cut out the part"):
        read_pictures(film, most=2)
    assert numbers(film, to_s=0.45, most=2) == [2, 4]
    monkeypatch.setattr("lightcube.io._video.MOST_PICTURES", 9)
    assert numbers(film, to_s=0.45, most=2) == [2, 4]  # what is not read is not counted


def test_a_part_holds_what_begins_in_it() -> None:
    """What is shown from its second on; the end is no part of it."""
    times = [0.0, 0.5, 1.0, 1.5, 2.0]
    for begin, end, found in ((0.5, 1.5, [1, 2]), (0.4, 1.6, [1, 2, 3]), (None, 0.5, [0]), (1.75, None, [4])):
        assert Excerpt(begin, end).numbers(Path("a.mp4"), times) == (found, len(found))
