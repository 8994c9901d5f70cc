"""`check` and what `solve` decides by itself: the paper's set-up, order, shift, quality, advice."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from lightcube import load, score
from lightcube.backward.recipe import QUALITIES
from lightcube.errors import InputError
from lightcube.verbs.options import Options
from tests.cli.test_cli import pictures, run
from tests.conftest import INTERPRETED
from tests.helpers.wall import play

__all__ = ["pictures", "run"]


#: What no photographer says.
JARGON = {"PSNR", "SSIM", "dB", "load", "centroids", "totals", "passes", "units", "moments", "rms", "E2000"}


@pytest.fixture
def unlike(tmp_path: Path) -> Path:
    """Six pictures of 8 x 6 pixels, alike in pairs that do not stand together."""
    folder = tmp_path / "unlike"
    folder.mkdir()
    random = np.random.default_rng(6)
    grounds = random.uniform(30, 250, (3, 6, 8, 3))
    for index in range(6):
        noise = random.uniform(-5, 5, (6, 8, 3))
        Image.fromarray((grounds[index % 3] + noise).clip(0, 255).astype(np.uint8)).save(folder / f"p{index}.png")
    return folder


def test_check_says_what_to_expect_in_words_and_json(run, pictures: Path) -> None:  # type: ignore[no-untyped-def]
    told = run("check", pictures, "--n", 8)
    assert told.code == 0
    assert not JARGON & set(re.findall(r"\w+", told.out))
    for words in ("4 pictures", "cube of 8 x 8 x 8 voxels, 100 mm wide", "well: all 4 pictures will be "):
        assert words in told.out, words
    numbers = run("check", pictures, "--n", 8, "--verbose").out
    assert numbers.startswith(told.out)
    for words in ("PSNR expected", "load", "mirrored pairs", "row conflicts"):
        assert words in numbers, words
    facts = json.loads(run("check", pictures, "--n", 8, "--json").out)
    assert facts["pictures"] == 4
    assert facts["elevation_deg"] == 35
    assert len(facts["predicted"]["pictures"]) == 4
    assert sorted(facts["order"]["best"]) == [0, 1, 2, 3]
    assert facts["voxels"] == [8, 8, 8]


def test_check_and_solve_agree(run, pictures: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    facts = json.loads(run("check", pictures, "--n", 8, "--json").out)
    done = run("solve", pictures, "-o", tmp_path / "a.npz", "--n", 8, "--iterations", 3, "--json")
    result = json.loads(done.out.strip().splitlines()[-1])
    assert result["predicted"] == facts["predicted"]
    cube = load(tmp_path / "a.npz")
    assert list(cube.grid.shape) == facts["voxels"]
    assert cube.hold_deg == pytest.approx(facts["hold_deg"])
    assert result["optimality"] is None  # no bound is known of light that adds up
    thin = run("solve", pictures, "-o", tmp_path / "b.npz", "--n", 8, "--iterations", 3, "--light", "thin", "--json")
    known = json.loads(thin.out.strip().splitlines()[-1])["optimality"]
    assert known["lower_bound"] <= known["objective"] * (1 + 1e-6)


def test_paper_is_the_papers_set_up(run, pictures: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    assert run("solve", pictures, "-o", tmp_path / "a.npz", "--n", 6, "--iterations", 2, "--paper").code == 0
    cube = load(tmp_path / "a.npz")
    assert np.all(cube.rig.views.elevations_deg == 0)
    assert np.all(cube.powers == 1)
    assert cube.rig.picture_shape == (6, 6)
    assert np.allclose(cube.rig.views.angles_deg, [22.5, 67.5, 112.5, 157.5])
    assert cube.hold_deg == 0


@pytest.mark.parametrize(
    "option",
    [
        ("--elevation-deg", "35"),
        ("--span-deg", "360"),
        ("--angles-deg", "0,1,2,3"),
        ("--picture-width", "0.5"),
        ("--pixel", "2"),
        ("--slices-tall", "2"),
        ("--powers", "shared"),
        ("--lamp-power", "2"),
        ("--lamp-max", "4"),
        ("--hold-deg", "1"),
        ("--lamp-deg", "0.5"),
        ("--screen-mm", "50"),
    ],
)
def test_paper_with_what_contradicts_it_is_refused(  # type: ignore[no-untyped-def]
    run, pictures: Path, tmp_path: Path, option: tuple[str, str]
) -> None:
    done = run("solve", pictures, "-o", tmp_path / "a.npz", "--n", 6, "--paper", *option)
    assert done.code == 2
    assert option[0] in done.err
    assert len(done.lines) == 1
    assert not list(tmp_path.glob("a*"))


@pytest.mark.parametrize(
    "options",
    [
        ("--quality", "draft", "--iterations", "5"),
        ("--quality", "best", "--method", "cgls"),
        ("--quality", "superb"),
        ("--order", "random"),
        ("--shift", "-1"),
        ("--black", "1"),
        ("--black", "-0.5"),
        ("--veil", "1"),
        ("--veil", "-0.01"),
        ("--picture-width", "0"),
        ("--picture-width", "1.9"),
        ("--pixel", "0"),
        ("--slices-tall", "0"),
        ("--slices-tall", "1.5"),
        ("--pixel", "-2"),
        ("--pixel", "7"),
        ("--pixel", "1.5"),
        ("--pixel", "2", "--picture-width", "2.5"),
        ("--powers", "coarse", "--lamp-power", "3"),
    ],
)
def test_what_cannot_be_is_one_sentence(run, pictures: Path, tmp_path: Path, options: tuple[str, ...]) -> None:  # type: ignore[no-untyped-def]
    done = run("solve", pictures, "-o", tmp_path / "a.npz", "--n", 6, *options)
    assert done.code == 2
    assert len(done.lines) == 1, done.err
    assert "Traceback" not in done.err
    assert not list(tmp_path.glob("a*"))


def test_the_best_order_is_kept_by_name(run, unlike: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    """Names follow their pictures, stops stay, and `score` finds the pictures again."""
    done = run("solve", unlike, "-o", tmp_path / "a.npz", "--n", 10, "--iterations", 20, "--order", "best", "--json")
    assert done.code == 0
    cube = load(tmp_path / "a.npz")
    order = cube.provenance["order"]
    assert cube.names == tuple(f"p{index}" for index in order)
    assert np.all(np.diff(cube.rig.views.angles_deg) > 0)
    again = json.loads(run("score", tmp_path / "a.npz", unlike, "--json").out)
    assert again["psnr_mean"] == pytest.approx(cube.scores["psnr_mean"], abs=0.01)
    for own, float_target in zip(score(cube)["pictures"], cube.scores["pictures"], strict=True):  # 8 bits tell to 59 dB
        assert min(own["psnr"], 45) == pytest.approx(min(float_target["psnr"], 45), abs=0.5)


def test_shifted_pictures_are_where_they_were_put(run, unlike: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    done = run("solve", unlike, "-o", tmp_path / "a.zarr", "--n", 12, "--iterations", 5, "--shift", 2, "--hold-deg", 0)
    assert done.code == 0
    cube = load(tmp_path / "a.zarr")
    assert cube.provenance["shift"] == 2
    assert len(np.unique(np.round(cube.rig.views.origins_mm[:, 2], 6))) > 1
    assert np.allclose(cube.rig.at(cube.angles_deg)[0].views.origins_mm, cube.rig.views.origins_mm, atol=1e-6)
    assert np.allclose(play(cube), play(cube, cube.rig.views.angles_deg), rtol=1e-4, atol=1e-5)


def test_poor_pictures_come_with_what_would_help(run, unlike: Path) -> None:  # type: ignore[no-untyped-def]
    told = run("check", unlike, "--n", 12, "--picture-width", 1.2, "--lamp-max", 1)
    assert told.code == 0
    assert not JARGON & set(re.findall(r"\w+", told.out))
    assert "wrong: all 6 pictures will be poor" in told.out
    (helps,) = (line for line in told.out.splitlines() if line.startswith("try: "))
    for change in ("--picture-width", "--lamp-max 16 (+4 EV)", "3 of the pictures"):
        assert change in helps
    asked = ["check", unlike, "--n", 12, "--picture-width", 1.2, "--lamp-max", 1]
    remedies = json.loads(run(*asked, "--json").out)["remedies"]
    assert len(remedies) == 3
    assert run(*asked, "--verbose").out.count("with ") == 3


@pytest.mark.parametrize("quality", ["draft", "normal", "best"])
def test_a_quality_is_a_number_of_passes(run, unlike: Path, tmp_path: Path, quality: str) -> None:  # type: ignore[no-untyped-def]
    options = ["--n", 8, "--picture-width", 1, "--lamp-max", 1, "--quality", quality, "--json", "--hold-deg", 0]
    done = run("solve", unlike, "-o", tmp_path / "a.npz", *options, "--points", 2, "--grain", 0, "--mat", "none")
    result = json.loads(done.out.strip().splitlines()[-1])
    assert 0 < result["iterations"] <= QUALITIES[quality].passes  # type: ignore[index]


def test_options_are_settled_before_anything_is_read() -> None:
    with pytest.raises(InputError, match="--paper"):
        Options(paper=True, hold_deg=1.0).as_in_the_paper()
    assert Options(method="cgls").turntable.power == 1
    assert Options().turntable.power is None
    assert Options(paper=True).as_in_the_paper().turntable.power == 1


@pytest.mark.parametrize(
    "options",
    [
        ("--lamp-power", "0.5"),
        ("--picture-width", "1", "--elevation-deg", "0", "--lamp-max", "1e5"),
        ("--black", "0.4"),
        ("--powers", "coarse", "--max-extinction", "0.5"),
        ("--elevation-deg", "-20", "--order", "best", "--shift", "1"),
        ("--lamp-deg", "0.5", "--screen-mm", "0"),
        ("--lamp-deg", "0", "--paper"),
        ("--pixel", "1", "--paper"),
        ("--slices-tall", "2", "--pixel", "2"),
        ("--slices-tall", "2", "--elevation-deg", "0", "--pixel", "2", "--powers", "coarse"),
        ("--slices-tall", "2"),
        ("--pixel", "3", "--shift", "1", "--order", "best"),
        ("--pixel", "2", "--elevation-deg", "0", "--powers", "coarse"),
    ],
)
def test_odd_but_possible_options_work(run, unlike: Path, tmp_path: Path, options: tuple[str, ...]) -> None:  # type: ignore[no-untyped-def]
    done = run("solve", unlike, "-o", tmp_path / "a.npz", "--n", 10, "--iterations", 2, *options)
    assert done.code == 0, done.err


@pytest.mark.parametrize(
    "options",
    [
        ("--picture-width", "0", "--elevation-deg", "0"),
        ("--picture-width", "nan", "--elevation-deg", "0"),
        ("--paper", "--n", "0"),
        ("--paper", "--n", "6", "--shape", "6,6,6"),
        ("--paper", "--shift", "2"),
        ("--lamp-deg", "-1"),
        ("--lamp-deg", "90"),
        ("--lamp-deg", "1", "--screen-mm", "-1"),
        ("--screen-mm", "50"),
        ("--lamp-deg", "30", "--elevation-deg", "75"),
    ],
)
def test_what_is_wrong_with_a_level_lamp_is_said_too(run, pictures: Path, options: tuple[str, ...]) -> None:  # type: ignore[no-untyped-def]
    done = run("check", pictures, *options)
    assert done.code == 2
    assert len(done.lines) == 1


def test_a_lamp_with_a_size_is_solved_played_scored_and_minded(run, unlike: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    solved, small = tmp_path / "a.npz", ("--n", 10, "--picture-width", 0.5, "--iterations", 2, "--lamp-deg", 0.5)
    done = run("solve", unlike, "-o", solved, *small)
    assert done.code == 0, done.err
    assert "how much a lamp's size costs was not measured" in done.err
    rig = load(solved).rig
    assert set(rig.sums.disc_deg) == {0.5}
    assert np.all(rig.behind_mm > 150)
    scores = json.loads(run("score", solved, "--robust", "--json").out)
    assert "disc" not in scores["robust"]
    assert run("play", solved, "-o", tmp_path / "a.npy").code == 0
    thin = run("check", unlike, *small[:4], *small[6:], "--light", "thin")
    assert "thin beams do not mind the size of lamp 'lamp'" in thin.out


def test_black_is_part_of_the_prediction(run, unlike: Path) -> None:  # type: ignore[no-untyped-def]
    plain, grey = (
        json.loads(run("check", unlike, "--n", 10, "--json", "--picture-width", 0.5, *more).out)["predicted"][
            "psnr_mean"
        ]
        for more in ((), ("--black", 0.5))
    )
    assert grey < plain - (0 if INTERPRETED else 3)  # a brief rehearsal tells less


def test_solve_goes_on_from_another_cube(run, pictures: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    """From where it was, in fewer passes than from nothing: what the first one reached is there at once."""
    options = ["--n", 8, "--picture-width", 0.5, "--hold-deg", 0, "--grain", 0, "--mat", "none"]
    first, again = tmp_path / "a.npz", tmp_path / "b.npz"
    assert run("solve", pictures, "-o", first, *options, "--iterations", 60).code == 0
    assert run("solve", pictures, "-o", again, *options, "--iterations", 1, "--start-from", first).code == 0
    fresh = tmp_path / "c.npz"
    assert run("solve", pictures, "-o", fresh, *options, "--iterations", 1).code == 0
    psnr = [load(each).scores["psnr_mean"] for each in (first, again, fresh)]
    assert psnr[1] > psnr[0] - 1 > psnr[2]


@pytest.mark.parametrize(("grain", "weight"), [("0.3", 0.3), ("0", 0.0), ("auto", 0.01)])
def test_grain_is_as_asked_for_or_follows_from_what_is_expected(  # type: ignore[no-untyped-def]
    run, pictures: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, grain: str, weight: float
) -> None:
    monkeypatch.setattr("lightcube.planning.plan.SMOOTH_DB", 0.0)
    options = ["--n", 8, "--picture-width", 0.5, "--hold-deg", 0, "--iterations", 1, "--grain", grain]
    assert run("solve", pictures, "-o", tmp_path / "a.npz", *options).code == 0
    assert load(tmp_path / "a.npz").provenance["grain"] == weight
    monkeypatch.setattr("lightcube.planning.plan.SMOOTH_DB", 60.0)
    assert run("solve", pictures, "-o", tmp_path / "b.npz", *options).code == 0
    assert load(tmp_path / "b.npz").provenance["grain"] == (0.0 if grain == "auto" else weight)
