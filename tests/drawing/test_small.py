"""A cube of a few voxels as it is drawn: every voxel that can be seen, and every picture, in its own colour."""

import numpy as np

from lightcube.drawing.small import small_cube

SHAPE = (2, 3, 4)
#: Every voxel of a colour of its own.
GLASS = np.stack(np.meshgrid(*(np.linspace(0.2, 1, count) for count in SHAPE), indexing="ij")).astype(np.float64)
PICTURES = np.random.default_rng(5).uniform(0, 1, (5, 2, 3, 3))


def test_pictures_stand_as_they_are_by_turns() -> None:
    drawn = small_cube(GLASS, PICTURES, range(5))
    other = small_cube(GLASS, PICTURES[:, ::-1], range(5))
    assert drawn.shape == other.shape
    blank = small_cube(GLASS, np.zeros_like(PICTURES), range(5))
    rows, columns = np.nonzero(np.any(drawn != blank, axis=-1))
    assert len(rows) >= 0.99 * PICTURES[..., 0].size * 34**2  # so large is a pixel
    assert columns.min() > np.nonzero(np.any(drawn != small_cube(GLASS**2, PICTURES, range(5)), axis=-1))[1].max()


def test_the_three_faces_that_are_seen_are_the_nearest_voxels() -> None:
    """A change of one voxel is seen just where it is on the top, or on one of the two sides to the eye."""
    drawn = small_cube(GLASS, PICTURES, range(5))
    for z, y, x in np.ndindex(SHAPE):
        changed = GLASS.copy()
        changed[:, z, y, x] = 0.05
        is_outer = z == SHAPE[0] - 1 or y == 0 or x == 0
        seen = np.any(small_cube(changed, PICTURES, range(5)) != drawn)
        assert seen or not is_outer, (z, y, x)


def test_nothing_is_cut_off() -> None:
    drawn = small_cube(GLASS, PICTURES, range(5))
    paper = drawn[0, 0]
    for edge in (drawn[:8], drawn[-8:], drawn[:, :8], drawn[:, -8:]):
        assert np.all(edge == paper)
