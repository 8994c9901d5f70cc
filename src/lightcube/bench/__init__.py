"""How fast this machine is, how much of that the projections use, and what others need for the same."""

from collections.abc import Callable
from typing import Any

from lightcube.bench.host import machine
from lightcube.bench.limits import ceilings
from lightcube.bench.others import peers
from lightcube.bench.playing import playback
from lightcube.bench.products import CHANNELS, product, projector
from lightcube.bench.starting import starts
from lightcube.kernels import tasks
from lightcube.optics.grid import Grid, raster_shape

#: Elevations of the lamp that are measured: the two at which cubes are made.
ELEVATIONS = (0.0, 35.0)
#: How often each thing is timed, and how many seconds a ceiling is looked at for each time.
_REPEATS, _LASTING = 3, 0.3
_QUICK_LASTING = 0.02


def memory(n: int, views: int) -> int:
    """Bytes that `measure` takes: of the cube and its pictures under the steepest lamp, two of each."""
    rows, columns = raster_shape(Grid((n, n, n)), max(ELEVATIONS))
    return 2 * 4 * CHANNELS * (n**3 + views * rows * columns)


def measure(n: int, views: int, say: Callable[[str], None], *, quick: bool = False) -> dict[str, Any]:
    """Measure all, and return it by name: seconds, and multiply-adds or bytes a second.

    Parameters
    ----------
    n
        Voxels along each side of the cube, in three colours.
    views
        Pictures, each the whole screen.
    say
        Is told what is being measured.
    quick
        Time everything once only, and briefly.
    """
    repeats, lasting = (1, _QUICK_LASTING) if quick else (_REPEATS, _LASTING)
    counts = sorted({1, tasks.threads()}, reverse=True)
    limits, kernels, played = {}, [], []
    for threads in counts:
        say(f"ceilings, threads: {threads}")
        limits[threads] = ceilings(threads, lasting, repeats)
    for elevation_deg in ELEVATIONS:
        matrix = projector(n, views, elevation_deg)
        for threads in counts:
            say(f"forward and adjoint at {elevation_deg:g} degrees, threads: {threads}")
            kernels.append({"elevation_deg": elevation_deg, **product(matrix, threads, limits[threads]["l2"], repeats)})
    ours = next(each for each in kernels if each["elevation_deg"] == 0 and each["threads"] == 1)
    compared = peers(projector(n, views, 0.0), ours["pass"]["seconds"], repeats, say)
    for elevation_deg in ELEVATIONS:
        say(f"playback at {elevation_deg:g} degrees")
        played.append({"elevation_deg": elevation_deg, **playback(n, elevation_deg, repeats)})
    say("start-up")
    return {
        "machine": machine(),
        "problem": {"n": n, "views": views, "repeats": repeats},
        "ceilings": [{"threads": threads, **figures} for threads, figures in limits.items()],
        "kernels": kernels,
        "peers": compared,
        "playback": played,
        "starts": starts(),
    }
