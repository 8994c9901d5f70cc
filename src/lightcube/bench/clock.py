"""Timing: how long work takes, and how often it can be done."""

import time
from collections.abc import Callable
from functools import partial

import numpy as np


def seconds(work: Callable[[], object], repeats: int) -> dict[str, float]:
    """Run `work` so often; return the least number of ``seconds`` and the ``median``."""
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        work()
        times.append(time.perf_counter() - began)
    return {"seconds": min(times), "median": float(np.median(times))}


def rate(work: Callable[[int], object], lasting: float, repeats: int) -> float:
    """How often a second what ``work(times)`` does so many times can be done; runs of `lasting` seconds or longer."""
    work(1)  # compiles it
    times = 1
    while (took := seconds(partial(work, times), repeats)["seconds"]) < lasting:
        times = max(2 * times, int(times * min(1.2 * lasting / max(took, 1e-9), 100)))
    return times / took
