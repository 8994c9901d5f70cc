"""A thing as the page's viewer takes it."""

from __future__ import annotations

from base64 import b64encode

from lightcube.optics.cube import Cube
from lightcube.solids.relief import Relief
from lightcube.viewer.description import zipped
from lightcube.viewer.page import parts_of


def viewed(thing: Cube | Relief, title: str) -> dict[str, str]:
    """Its scene and its voxels, gzipped and in base64: both of the same moment."""
    description, voxels = parts_of(thing, title)
    return {"scene": b64encode(zipped(description)).decode(), "voxels": b64encode(voxels).decode()}
