"""A page's bytes come through, and where they are damaged a sentence says so."""

import base64
import gzip

import numpy as np
import pytest

from lightcube.viewer import packing
from tests.helpers.paging import (
    CUBES,
    GIVEN,
    GRID,
    RANDOM,
    Evaluate,
    asked,
    failure,
    held_in_a_page,
    paged,
)


@pytest.mark.parametrize("native", [True, False])
@pytest.mark.parametrize("bits", packing.BITS)
@pytest.mark.parametrize("name", ["raised", "one colour"])
def test_voxels_come_through(
    evaluate: Evaluate, name: str, bits: int, native: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(packing, "BITS", (bits,))
    _, packed, data = paged(CUBES[name])
    without = "" if native else "delete Uint8Array.fromBase64, "
    found = asked(evaluate, data, f"{without}cube")
    codes = np.array(found["codes"]).reshape(*GRID.shape, 3)
    for channel in range(3):
        own = channel % len(packed.codes)
        np.testing.assert_array_equal(codes[..., channel], packed.codes[own])
        table = np.array(found["tables"][channel])
        assert len(table) == 2**bits
        np.testing.assert_allclose(table[packed.codes[own]], packed.cube.extinction[own], rtol=1e-6)
    assert (tuple(found["shape"]), found["voxel_mm"]) == (GRID.shape, GRID.voxel_mm)


@pytest.mark.parametrize("native", [True, False])
def test_base64_is_read_with_and_without_help(evaluate: Evaluate, native: bool) -> None:
    without = "" if native else "delete Uint8Array.fromBase64, "
    sent = RANDOM.integers(0, 256, 1000).astype(np.uint8).tobytes()
    found = evaluate(("model/data.js",), f"({without}[...fromBase64(argument)])", base64.b64encode(sent).decode())
    assert bytes(found) == sent
    broken = failure(evaluate, f"({without}fromBase64(argument))", "AAAA*AAA")
    assert broken == "the page's data is not base64, some of its letters are damaged: write or send the page again"


@pytest.mark.parametrize("damage", ["flipped", "cut", "longer"])
@pytest.mark.parametrize("part", ["scene", "voxels"])
def test_damaged_gzip_is_told(evaluate: Evaluate, part: str, damage: str) -> None:
    data = held_in_a_page("raised")[2]
    sent = bytearray(base64.b64decode(data[part]))
    if damage == "flipped":
        sent[-5] ^= 8  # in the checksum: all else is as it was
    sent = {"flipped": sent, "cut": sent[:-9], "longer": sent + b"more"}[damage]
    said = failure(evaluate, GIVEN % "cube", data | {part: base64.b64encode(sent).decode()})
    assert said == f"the page's {part} came damaged or cut off (its gzip does not unpack): write or send the page again"


@pytest.mark.parametrize(
    ("scene", "said"),
    [
        (b'{"format": 1', "the page's scene is not readable JSON: write or send the page again"),
        (b'{"format": "\xff"}', "the page's scene is not readable JSON: write or send the page again"),
        (b'{"format": 3}', "the page's data has format 3, newer than 2: update the viewer that opens it"),
        (b'{"format": 0}', "the page's data has format 0, not 2: write the page again with this version"),
        (b'{"title": "x"}', "the page's data has format undefined, not 2: write the page again with this version"),
        (b"null", "the page's data has format undefined, not 2: write the page again with this version"),
    ],
)
def test_a_scene_that_cannot_be_read_is_told(evaluate: Evaluate, scene: bytes, said: str) -> None:
    sent = base64.b64encode(gzip.compress(scene)).decode()
    assert failure(evaluate, "await readScene(fromBase64(argument))", sent) == said


@pytest.mark.parametrize("off", [-1, 1])
def test_a_wrong_number_of_bytes_is_told(evaluate: Evaluate, off: int) -> None:
    _, packed, data = held_in_a_page("raised")
    voxels = gzip.decompress(packed.data())
    sent = base64.b64encode(gzip.compress(voxels[:off] if off < 0 else voxels + b"x")).decode()
    size = 3 * 105 + 79
    said = f"the page's voxels have {size + off} bytes, not the {size} of 3 x 5 x 7 voxels in 3 channels: "
    assert failure(evaluate, GIVEN % "cube", data | {"voxels": sent}) == said + "write or send the page again"


def test_a_browser_without_unpacking_is_told(evaluate: Evaluate) -> None:
    said = failure(evaluate, "{ delete globalThis.DecompressionStream; await gunzip(new Uint8Array(9)); }", None)
    assert said == "this browser cannot unpack gzip: open the page in a newer one"
