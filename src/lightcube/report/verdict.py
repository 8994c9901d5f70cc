"""What is good of a cube and what is not, in words for people who have no use for decibels."""

from collections.abc import Iterator, Sequence

from lightcube.optics.disturbance import SAID
from lightcube.report.measuring import Findings
from lightcube.scoring.between import LOBE_DB
from lightcube.scoring.metrics import GOOD_DB, grain_word, mark
from lightcube.wording import counted

#: Turning the table that far off a stop is not felt by a hand, degrees: a picture that stands so long stands at ease.
_AT_EASE = 1.0
_SHORT_OF_GOOD = {"fair": "recognisable, with faults that one sees", "poor": "hard to recognise, or not at all"}
#: Names that a sentence holds.
_NAMED = 5


def good(found: Findings) -> Iterator[str]:
    """What is good, a sentence each."""
    each, count = _psnr(found), len(found.cube.names)
    well = sum(mark(psnr) == "good" for psnr in each)
    best = sum(psnr >= GOOD_DB for psnr in each)
    if well:
        said = (
            "Every picture comes out well" if well == count else f"{well} of {counted(count, 'picture')} come out well"
        )
        yield f"{said}{_alike(best, well)}."
    if found.scores["delta_e_mean"] < 1:
        yield "Colours are right: on average no difference can be seen."
    if grain_word(found.scores["grain_rms"]) != "coarse":
        yield "Light is even within pixels: the pictures may be looked at from near."
    curve = found.curve
    if curve is not None and curve.lobes_deg.min() >= _AT_EASE:
        yield f"Every picture stands while the table turns by {curve.lobes_deg.min():.1f}° or more."
    borne = [name for name in _alone(found) if mark(found.robust[name]["psnr_mean"]) == "good"]
    if borne:
        yield f"It bears, one at a time: {_listed(SAID[name] for name in borne)}."


def wanting(found: Findings) -> Iterator[str]:
    """What is not good, a sentence each."""
    names, each = found.cube.names, _psnr(found)
    for kind, how in _SHORT_OF_GOOD.items():
        such = [name for name, psnr in zip(names, each, strict=True) if mark(psnr) == kind]
        if such:
            yield f"{_pictures(len(such))} {'is' if len(such) == 1 else 'are'} {kind}, {how}: {_few(such)}."
    difference = found.scores["delta_e_mean"]
    if difference >= 1:
        yield f"Side by side, colours differ by {difference:.1f} on average, where 1 can just be seen."
    if grain_word(found.scores["grain_rms"]) == "coarse":
        yield "Seen from near, light is coarse within pixels; from further off it melts into the picture."
    curve = found.curve
    if curve is not None and curve.lobes_deg.min() < _AT_EASE:
        short = [name for name, lobe in zip(names, curve.lobes_deg, strict=True) if lobe < _AT_EASE]
        yield (
            f"{_pictures(len(short))} of {len(names)} {'dissolves' if len(short) == 1 else 'dissolve'} within "
            f"{_AT_EASE:g}° of turn (below {LOBE_DB:g} dB): the table has to stop where it should."
        )
    for kind in _SHORT_OF_GOOD:
        harm = [SAID[name] for name in _alone(found) if mark(found.robust[name]["psnr_mean"]) == kind]
        if harm and mark(found.scores["psnr_mean"]) != kind:
            yield f"Pictures become {kind} where the set-up is off by: {_listed(harm)}."
    if found.advice:
        yield "Something is wrong with the pictures themselves: see “Before solving”."


def _psnr(found: Findings) -> list[float]:
    return [float(view["psnr"]) for view in found.scores["pictures"]]


def _alone(found: Findings) -> list[str]:
    """Names of what was tried by itself; of the two turns the one that is the same for every size of cube."""
    return [name for name in found.robust if name not in ("undisturbed", "turned-as-64", "all", "together")]


def _alike(best: int, well: int) -> str:
    """How many of the good pictures are more than good."""
    if not best:
        return ""
    which = "it" if best == well == 1 else "all of them" if best == well else f"{best} of them"
    return f"; {which} can hardly be told from what was wanted"


def _pictures(count: int) -> str:
    return "One picture" if count == 1 else counted(count, "picture")


def _few(names: Sequence[str]) -> str:
    more = len(names) - _NAMED
    return ", ".join(names[:_NAMED]) + (f" and {more} more" if more > 0 else "")


def _listed(parts: Iterator[str] | Sequence[str]) -> str:
    return "; ".join(parts)
