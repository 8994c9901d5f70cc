"""What a print takes: volume, weight and hours, by arithmetic that a report says."""

from lightcube.report.html import figure_tiles, number, text

#: Grams of a cubic centimetre of what most prints are made of, and how much of it a nozzle lays down, mm³ a second.
_PLA, _RATE = 1.24, 10.0


def print_tiles(volume_mm3: float, size_mm: tuple[float, float, float]) -> str:
    """Size, volume, weight and hours of a body that is filled all through."""
    hours = volume_mm3 / _RATE / 3600
    duration = f"{number(hours, 1)} h" if hours >= 1 else f"{number(60 * hours, 0)} min"
    tiles = {
        "size": (" × ".join(f"{side:.4g}" for side in size_mm) + " mm", "wide, deep, high"),
        "volume": (f"{volume_mm3 / 1000:.3g} cm³", "all through"),
        "weight": (f"{_PLA * volume_mm3 / 1000:.3g} g", f"in PLA, {_PLA:g} g/cm³"),
        "to print": (duration, f"at {_RATE:g} mm³ a second"),
    }
    said = "Weight and time are those of the whole volume; a slicer that fills less takes less."
    return figure_tiles(tiles) + text("p", said, class_="note")
