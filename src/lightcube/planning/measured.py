"""What was measured, and on what: planning knows rooms with one parallel lamp and a screen behind the cube.

In other rooms a rehearsal on a small cube is no guide: told as `lightcube.planning.prediction` does, the mean PSNR of
rooms with a point lamp, or lamps of several elevations, came out 2 to 10 dB too low (21 rooms of benchmarks/stages.py).
"""

from lightcube.errors import InputError
from lightcube.optics.rig import Rig


def is_measured(rig: Rig) -> bool:
    """Whether a rig has one parallel lamp, raised alike for all pictures, and a screen behind the cube."""
    return rig.is_thin and rig.elevation_deg is not None


def raised(rig: Rig) -> float:
    """Elevation of a rig's light, degrees, or `InputError` where planning was not measured on rooms like it."""
    elevation_deg = rig.elevation_deg
    if elevation_deg is None or not is_measured(rig):
        raise InputError(
            "what to expect was measured for one parallel lamp, raised alike for all pictures, and a screen behind the "
            "cube: this room is another one, so solve a small cube to see"
        )
    return elevation_deg
