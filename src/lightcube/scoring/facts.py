"""What is worth knowing of a cube, beside how good it is."""

from typing import Any

from lightcube.optics.cube import Cube


def facts(cube: Cube) -> dict[str, Any]:
    """What is worth knowing of a cube, by name, for people and JSON."""
    nz, ny, nx = cube.grid.shape
    rows, columns = cube.views.picture_shape
    return {
        "status": cube.status,
        "voxels": f"{nz} x {ny} x {nx} (z, y, x)",
        "size_mm": " x ".join(f"{length:g}" for length in cube.grid.size_mm),
        "voxel_mm": cube.grid.voxel_mm,
        "views": len(cube.views),
        "pictures": len(cube.names),
        "picture": f"{columns} x {rows} pixels",
        **_where(cube),
        "lamp_power": [float(cube.powers.min()), float(cube.powers.max())],
        "extinction_mean": float(cube.extinction.mean()),
        "extinction_max": float(cube.extinction.max()),
        "hold": cube.hold_deg,
        "transfer": cube.transfer,
        "names": list(cube.names),
        **{name: value for name, value in cube.scores.items() if name != "views"},
        **{f"made_with_{name}": value for name, value in cube.provenance.items()},
    }


def _where(cube: Cube) -> dict[str, Any]:
    """Where a cube's lamps and screens stand, by name."""
    angles = {"angles": [float(angle) for angle in cube.angles]}
    if cube.lighting is None:
        return angles | {"elevation": sorted({float(elevation) for elevation in cube.views.elevations})}
    screens = [cube.lighting.screen_names[screen] for screen in cube.lighting.screen]
    return angles | {"lamps": list(cube.lighting.lamp_names), "screens": screens}
