"""Numbers as people say them: counts with their nouns, powers of lamps in stops of a camera."""

import math


def counted(count: int, noun: str) -> str:
    """A count with its noun, in one or many: ``1 picture``, ``2 pictures``, ``2 passes``."""
    end = "es" if noun.endswith(("s", "x", "ch")) else "s"
    return f"{count} {noun}{'' if count == 1 else end}"


def in_ev(power: float) -> str:
    """A power of a lamp in stops of a camera, of which each is twice as much light: 16 is ``+4 EV``, 1 is ``0 EV``."""
    stops = round(math.log2(power), 1)
    return f"{stops:+g} EV" if stops else "0 EV"
