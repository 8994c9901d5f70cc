"""The room is drawn small: how it is drawn is tested where it is drawn."""

import pytest

from lightcube.report import measuring


@pytest.fixture(autouse=True)
def small_room(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measuring, "ROOM", (27, 48))
