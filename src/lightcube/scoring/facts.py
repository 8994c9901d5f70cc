"""What is worth knowing of a cube, beside how good it is."""

from typing import Any

import numpy as np

from lightcube.optics.cube import Cube


def facts(cube: Cube) -> dict[str, Any]:
    """What is worth knowing of a cube, by name, for people and JSON."""
    nz, ny, nx = cube.grid.shape
    rows, columns = cube.rig.picture_shape
    return {
        "status": cube.status,
        "voxels": f"{nz} x {ny} x {nx} (z, y, x)",
        "size_mm": " x ".join(f"{length:g}" for length in cube.grid.size_mm),
        "voxel_mm": cube.grid.voxel_mm,
        **({} if cube.grid.tall == 1 else {"slice_mm": cube.grid.slice_mm}),
        "views": len(cube.rig.views),
        "pictures": len(cube.names),
        "picture": f"{columns} x {rows} pixels",
        **_where(cube),
        "lamp_power": [float(cube.powers.min()), float(cube.powers.max())],
        "lamp_ev": [float(np.log2(cube.powers.min())), float(np.log2(cube.powers.max()))],
        "extinction_mean": float(cube.extinction.mean()),
        "extinction_max": float(cube.extinction.max()),
        "hold_deg": cube.hold_deg,
        "transfer": cube.transfer,
        "names": list(cube.names),
        **{name: value for name, value in cube.scores.items() if name != "pictures"},
        **{f"made_with_{name}": value for name, value in cube.provenance.items()},
    }


def _where(cube: Cube) -> dict[str, Any]:
    """Where a cube's lamps and screens stand, by name."""
    rig = cube.rig
    return {
        "angles_deg": [float(angle_deg) for angle_deg in cube.angles_deg],
        "elevation_deg": sorted(
            {float(elevation_deg) for elevation_deg in rig.views.elevations_deg[rig.views.lamps[:, 3] == 0]}
        ),
        "lamps": list(rig.lamps.names),
        "screens": [rig.screens.names[screen] for screen in rig.stops.screen],
    }
