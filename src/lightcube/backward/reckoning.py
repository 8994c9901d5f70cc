"""How much of a job is done: reckoned from how good pictures are on the way, where they may be good enough early.

Errors, as they are cast, fall about as a power of the passes, and end where they are as small as is wanted. With few
points a pixel they end high, and fall quickly as soon as there are all. All figures are measured, and rough: where
errors stop falling just before they are small enough nobody can tell how long it takes.
"""

import math

from lightcube.backward.job import Job, phase_work, shares

#: What is cast is first looked at after so many passes at all points, and then more and more rarely.
FIRST_LOOK, _LATER = 8, 1.15
#: Errors at that first look, beside those half through the passes with few points.
_SOON = 0.23
#: The power with which they fall where that was not seen yet, and the least one that is reckoned with.
_POWER, _SLOWEST = 0.6, 0.25
#: The logarithm of more passes than there are.
_NEVER = 99.0


def is_look(iteration: int) -> bool:
    """Whether what is cast is looked at after so many iterations: the same ones wherever a solver goes on."""
    look = FIRST_LOOK
    while look < iteration:
        look = int(look * _LATER) + 1
    return look == iteration


def is_look_ahead(iteration: int, iterations: int) -> bool:
    """Whether it is looked at half through the passes with few points."""
    return iteration == (iterations + 1) // 2


class Reckoning:
    """How much of a job's work is done while one of its pieces is solved, phase by phase.

    Parameters
    ----------
    job, name
        The job, and the piece's name; those before it are finished.
    wanted
        The mean squared difference at which it ends; 0 = never before all its passes.
    """

    def __init__(self, job: Job, name: str, wanted: float) -> None:
        work, phases = shares(job), job.phases(name)
        names = list(work)
        before, after = names[: names.index(name)], names[names.index(name) + 1 :]
        self._before, self._after = (sum(work[each] for each in some) for some in (before, after))
        self._size = work[name] / sum(phase_work(job, phase) for phase in phases)
        self._job, self._phases, self._wanted = job, phases, wanted
        self._number, self._part, self._expected, self._seen = 0, 0.0, math.inf, (0, math.inf)

    def begin(self, number: int) -> None:
        """The phase of this number begins."""
        self._number = number

    def looked_ahead(self, error: float) -> None:
        """Half through the first phase the mean squared difference was `error`."""
        if self._wanted > 0:
            self._expected = _passes(FIRST_LOOK, max(_SOON * error / self._wanted, 1.0), _POWER)

    def looked(self, iteration: int, error: float) -> None:
        """After so many passes of the last phase the mean squared difference was `error`."""
        then, before = self._seen
        self._seen = iteration, error
        if not 0 < self._wanted < error:
            return
        power = math.log(before / error) / math.log(iteration / then) if then and error < before else 0.0
        power = max((power + _POWER) / 2, _SLOWEST)
        self._expected = _passes(iteration, error / self._wanted, power)

    def done(self, iteration: int, iterations: int) -> float:
        """Part of the job's work, in [0, 1], after so many of so many passes of the phase; it never becomes less."""
        finished, phase, last = self._phases[: self._number], self._phases[self._number], self._phases[-1]
        own = sum(phase_work(self._job, each) for each in finished)
        whole = own if phase is last else own + phase_work(self._job, phase)
        soonest, most = iteration + 1 if phase is last else 1, last.passes or iterations
        whole += phase_work(self._job, last, min(max(self._expected, soonest), most))
        done = self._before + self._size * (own + phase_work(self._job, phase, iteration))
        self._part = max(self._part, min(done / (self._before + self._size * whole + self._after), 1.0))
        return self._part


def _passes(now: int, times: float, power: float) -> float:
    """After how many passes an error is so many times smaller than after `now` of them."""
    return math.exp(min(math.log(now) + math.log(times) / power, _NEVER))
