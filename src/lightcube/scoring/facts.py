"""What is worth knowing of a cube, beside how good it is, and of a shape."""

from typing import Any

import numpy as np

from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.naming import is_dial, told_apart
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.solids.shape import Shape


def facts(cube: Cube) -> dict[str, Any]:
    """What is worth knowing of a cube, by name, for people and JSON."""
    return {
        "status": cube.status,
        **_block(cube.grid),
        "views": len(cube.rig.views),
        **_where(cube.rig),
        "lamp_power": [float(cube.powers.min()), float(cube.powers.max())],
        "lamp_ev": [float(np.log2(cube.powers.min())), float(np.log2(cube.powers.max()))],
        "extinction_mean": float(cube.extinction.mean()),
        "extinction_max": float(cube.extinction.max()),
        **({} if isinstance(cube.grid, Stack) else {"hold_deg": cube.hold_deg}),
        "transfer": cube.transfer,
        "names": list(cube.names),
        **{name: value for name, value in cube.scores.items() if name != "pictures"},
        **{f"made_with_{name}": value for name, value in cube.provenance.items()},
    }


def shape_facts(shape: Shape) -> dict[str, Any]:
    """What is worth knowing of a shape, by name, for people and JSON."""
    mesh = shape.mesh
    return {
        "kind": "shape",
        **_block(shape.grid),
        **_where(shape.rig),
        "filled": float(shape.inside.mean()),
        "mesh_size_mm": " x ".join(f"{length:.6g}" for length in mesh.size_mm) + " (x, y, z)",
        "volume_mm3": mesh.volume_mm3,
        "faces": len(mesh),
        "bad_edges": mesh.bad_edges,
        "names": list(shape.names),
        **{f"made_with_{name}": value for name, value in shape.provenance.items()},
    }


def _block(grid: Grid) -> dict[str, Any]:
    """A block of voxels, by name."""
    nz, ny, nx = grid.shape
    if isinstance(grid, Stack):
        return {
            "films": nz,
            "cells": f"{ny} x {nx} (y, x)",
            "size_mm": " x ".join(f"{length:g}" for length in grid.size_mm),
            "cell_mm": grid.voxel_mm,
            "heights_mm": list(grid.heights_mm),
            "index": grid.index,
        }
    return {
        "voxels": f"{nz} x {ny} x {nx} (z, y, x)",
        "size_mm": " x ".join(f"{length:g}" for length in grid.size_mm),
        "voxel_mm": grid.voxel_mm,
        **({} if grid.tall == 1 else {"slice_mm": grid.slice_mm}),
    }


def _where(rig: Rig) -> dict[str, Any]:
    """A rig's pictures, and where its lamps and screens stand, by name."""
    rows, columns = rig.picture_shape
    return {
        "pictures": len(rig),
        "picture": f"{columns} x {rows} pixels",
        **_told(rig),
        "lamps": list(rig.lamps.names),
        "screens": [rig.screens.names[screen] for screen in rig.stops.screen],
    }


def _told(rig: Rig) -> dict[str, Any]:
    """What tells a rig's pictures apart, and how light falls, by name."""
    parallel = rig.views.elevations_deg[rig.views.lamps[:, 3] == 0]
    if is_dial(rig):
        return {"shown": told_apart(rig), "off_upright_deg": sorted({90 - float(each) for each in parallel})}
    return {"angles_deg": rig.stops.angle_deg.tolist(), "elevation_deg": sorted({float(each) for each in parallel})}
