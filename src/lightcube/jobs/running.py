"""Running the pieces of a job in this program: how far it is, how good the pictures are, what it goes on from."""

import time

from lightcube.backward.job import Job
from lightcube.backward.pieces import Step, Watching, solve_pieces
from lightcube.events import Progress, Said, Tell
from lightcube.jobs.partial import DiskStore
from lightcube.scoring import metrics
from lightcube.wording import counted

#: Seconds between two looks at the screen at least, and so many times as long as one took.
_LOOK_S, _PATIENCE = 1.0, 10.0


def run(job: Job, pieces: list[str], store: DiskStore, tell: Tell, watch: Watching | None = None) -> bool:
    """Solve what is not finished of some pieces of a job; False where `tell` stopped it.

    `watch` sees each step too.
    """
    resumed, done = not store.is_empty(), store.names()
    began, first, next_look = time.monotonic(), -1.0, 0.0

    def watching(step: Step) -> bool:
        nonlocal first, next_look
        if first < 0:
            first = step.done
            if resumed:
                tell(_resumed(step, len(done.intersection(job.unit_names)), job.units))
        if watch is not None:
            watch(step)
        figures = {}
        looking = time.monotonic()
        if step.shown is not None and looking > next_look:
            figures["PSNR"] = metrics.mean_psnr(step.shown(), job.targets, step.window)
            now = time.monotonic()
            next_look = now + max(_LOOK_S, _PATIENCE * (now - looking))
        left = (time.monotonic() - began) * (1 - step.done) / (step.done - first) if step.done > first else None
        return bool(tell(Progress(round(step.done * step.iterations), step.iterations, figures, left)))

    return solve_pieces(job, pieces, store, watching)


def _resumed(step: Step, units: int, of: int) -> Said:
    """Where a job goes on that was stopped or killed."""
    passes = max(step.iteration - 1, 0)
    place = (
        f"from {units} of {counted(of, 'unit')}, pass {passes} of {step.iterations}"
        if step.iteration
        else "at a smaller size"
    )
    facts = {"units_done": units, "units": of, "passes_done": passes, "passes": step.iterations}
    return Said(f"going on {place}", "resumed", facts)
