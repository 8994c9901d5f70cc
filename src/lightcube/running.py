"""Running the pieces of a job in the foreground: progress, what it goes on from, and Ctrl-C."""

import time

from lightcube import metrics
from lightcube.console import ctrl_c, err, json_line, progress
from lightcube.io import DiskStore
from lightcube.job import Job
from lightcube.pieces import Step, solve_pieces

#: Seconds between two looks at the screen: one costs as much as half a pass.
_LOOK_S = 1.0


def run(job: Job, pieces: list[str], store: DiskStore, *, as_json: bool) -> bool:
    """Solve what is not finished of some pieces of a job; False where Ctrl-C was pressed."""
    resumed, done = not store.is_empty(), store.names()
    began, first, looked = time.monotonic(), -1.0, 0.0
    with ctrl_c() as stopped, progress("solving", as_json=as_json) as advance:

        def watching(step: Step) -> bool:
            nonlocal first, looked
            if first < 0:
                first = step.done
                if resumed:
                    _say_resumed(step, len(done.intersection(job.unit_names)), job.units, as_json=as_json)
            figures = {}
            if step.shown is not None and time.monotonic() - looked > _LOOK_S:
                figures["PSNR"] = metrics.mean_psnr(step.shown(), job.frames, step.window)
                looked = time.monotonic()
            if as_json and step.done > first:  # the bar reckons for itself
                figures["left_s"] = (time.monotonic() - began) * (1 - step.done) / (step.done - first)
            advance(round(step.done * step.iterations), step.iterations, **figures)
            return stopped()

        return solve_pieces(job, pieces, store, watching)


def _say_resumed(step: Step, units: int, of: int, *, as_json: bool) -> None:
    """Say where a job goes on that was stopped or killed."""
    passes = max(step.iteration - 1, 0)
    if as_json:
        json_line("resumed", units_done=units, units=of, passes_done=passes, passes=step.iterations)
        return
    place = f"from {units} of {of} units, pass {passes} of {step.iterations}" if step.iteration else "at a smaller size"
    err.print(f"going on {place}")
