"""How much packed bytes unpack to is found without keeping them, and in time that grows as they do."""

import lzma
import zlib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lightcube.io import _bounds

PACKERS: list[tuple[int, Callable[[bytes], bytes]]] = [(zlib.MAX_WBITS, zlib.compress), (0, lzma.compress)]


@pytest.mark.parametrize(("wbits", "pack"), PACKERS)
@given(length=st.integers(0, 3000), noise=st.integers(0, 3000), piece=st.integers(1, 400), off=st.integers(-3, 3))
def test_what_unpacks_to_more_is_found(
    wbits: int, pack: Callable[[bytes], bytes], length: int, noise: int, piece: int, off: int
) -> None:
    data = bytes(length) + np.random.default_rng(noise).bytes(noise)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(_bounds, "_PIECE", piece)
        assert _bounds.unpacks_beyond(pack(data), len(data) + off, wbits=wbits) == (off < 0)
        assert not _bounds.unpacks_beyond(pack(data)[:-5], len(data), wbits=wbits)
        assert _bounds.unpacks_beyond(pack(data) + b"more", len(data) - 1, wbits=wbits)


def test_bytes_that_wait_are_not_copied_again_and_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """A picture of one strip: handed over as a whole, it was copied for each piece that came out."""
    packed = zlib.compress(np.random.default_rng(1).bytes(200_000))
    handed: list[int] = []
    honest = zlib.decompressobj

    class Counting:
        def __init__(self, wbits: int) -> None:
            self._real = honest(wbits)

        def __getattr__(self, name: str) -> Any:
            return getattr(self._real, name)

        def decompress(self, data: bytes, most: int) -> bytes:
            handed.append(len(data))
            return self._real.decompress(data, most)

    monkeypatch.setattr(_bounds, "_PIECE", 1000)
    monkeypatch.setattr(zlib, "decompressobj", Counting)
    assert not _bounds.unpacks_beyond(packed, 200_000)
    assert sum(handed) < 3 * len(packed)
