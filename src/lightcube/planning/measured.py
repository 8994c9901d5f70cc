"""What was measured, and on what: planning knows rooms with one parallel lamp and a screen behind the cube."""

from lightcube.errors import InputError
from lightcube.optics.rig import Rig


def raised(rig: Rig) -> float:
    """Elevation of a rig's light, degrees, or `InputError` where planning was not measured on rooms like it."""
    elevation_deg = rig.elevation_deg
    if elevation_deg is None or not rig.is_thin:
        raise InputError(
            "what to expect was measured for one parallel lamp, raised alike for all pictures, and a screen behind the "
            "cube: this room is another one, so solve a small cube to see"
        )
    return elevation_deg
