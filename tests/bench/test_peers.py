"""The comparison with other packages: its numbers are nobody's own, and everybody stands the right way up."""

import builtins
import importlib.util
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from lightcube.errors import InputError

SCRIPT = Path(__file__).parents[2] / "benchmarks" / "peers.py"
NEEDS_ASTRA = "ASTRA is an optional oracle: lightcube[oracle]"


@pytest.fixture(scope="module")
def peers() -> ModuleType:
    specification = importlib.util.spec_from_file_location("peers", SCRIPT)
    assert specification is not None
    assert specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    sys.modules["peers"] = module
    specification.loader.exec_module(module)
    return module


def test_chords_by_formula_are_what_a_fine_slice_casts(peers: ModuleType) -> None:
    given = peers.slice_of(63, 8)
    cast = given.matrix(given.phantom[None])[:, 0]
    assert np.max(given.absorbance) == pytest.approx(peers.MOST)
    assert peers.relative(cast - given.absorbance, given.absorbance) < 0.02
    for aside in (given.phantom[::-1], given.phantom[:, ::-1], given.phantom.T):
        assert peers.relative(aside - given.phantom, given.phantom) > 0.3, "who turns it the wrong way must be seen"


def table(printed: str) -> dict[str, list[str]]:
    """Cells of the last row of each method."""
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in printed.splitlines() if line.startswith("| ")]
    return {name: cells for name, *cells in rows[1:]}


def compared(
    peers: ModuleType, picture: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> str:
    monkeypatch.setattr("lightcube.threads", lambda _: None)
    peers.main(["--n", "15", "--views", "16", "--passes", "2", "12", "--repeats", "1", "--picture", str(picture)])
    assert picture.stat().st_size > 5000
    return capsys.readouterr().out


def test_all_come_near_the_phantom(
    peers: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("astra", reason=NEEDS_ASTRA)
    pytest.importorskip("matplotlib", reason="drawing needs lightcube[plot]")
    rows = table(compared(peers, tmp_path / "peers.png", capsys, monkeypatch))
    assert set(rows) == {"the phantom itself", *(method.name for method in peers.METHODS)}
    assert rows["the phantom itself"][3] == "0.0%"
    for name, (_, _, residual, error, _) in rows.items():
        assert float(residual.rstrip("%")) < 12, name
        assert float(error.rstrip("%")) < 45, name
    ours, theirs = (float(rows[name][2].rstrip("%")) for name in ("lightcube cgls, unbounded", "ASTRA CGLS"))
    assert ours == pytest.approx(theirs, rel=0.02), "one method, one matrix"


def test_without_astra_the_others_are_compared_and_a_sentence_says_so(
    peers: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("matplotlib", reason="drawing needs lightcube[plot]")
    real = builtins.__import__

    def missing(name: str, *rest: Any) -> Any:
        if name == "astra":
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", missing)
    printed = compared(peers, tmp_path / "peers.png", capsys, monkeypatch)
    assert "ASTRA is not installed and left out: pip install 'lightcube[oracle]'" in printed
    assert set(table(printed)) == {
        "the phantom itself",
        *(method.name for method in peers.METHODS if "ASTRA" not in method.name),
    }


def test_an_even_number_of_pixels_has_no_middle(peers: ModuleType) -> None:
    with pytest.raises(InputError, match="odd --n"):
        peers.slice_of(8, 4)
