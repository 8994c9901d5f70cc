"""What a wall shows of the pictures alone."""

from functools import partial

from lightcube.forward import casting

play = partial(casting.play, picture_only=True)
