"""All bodies and silhouettes of 3 x 3 x 3 voxels: a connected body exists just where one piece of the hull casts all.

Bodies and pictures are numbers of 27 and 9 bits. A front stands for all that it turns or mirrors into: 101
of 511 are left.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from lightcube.optics.grid import Grid
from lightcube.solids.reach import reach
from lightcube.solids.walls import walls
from tests.helpers.solid import compiled_only, of_pixels

Array = NDArray[np.int64]
#: Voxels z, y, x as bits 9 z + 3 y + x: those that are not the last, or the first, along x and y.
_BITS = np.arange(27)
NOT_LAST = [int(sum(1 << b for b in _BITS if b // step % 3 != 2)) for step in (1, 3)]
NOT_FIRST = [int(sum(1 << b for b in _BITS if b // step % 3 != 0)) for step in (1, 3)]
ALL = (1 << 27) - 1
X_ON, Y_ON = NOT_LAST
X_BACK, Y_BACK = NOT_FIRST


def spread(step_row: int, step_column: int, along: int) -> Array:
    """By picture the voxels whose rays are dark in it: bit 3 row + column of a picture is a row of voxels."""
    made = np.zeros(512, np.int64)
    for picture in range(512):
        for bit in range(9):
            if picture >> bit & 1:
                for third in range(3):
                    made[picture] |= 1 << (bit // 3 * step_row + bit % 3 * step_column + third * along)
    return made


#: Front (z, x), side (z, y), top (y, x).
HELD = np.array([spread(9, 1, 3), spread(9, 3, 1), spread(3, 1, 9)])
#: Of a layer of 9 voxels (y, x) what is seen along y and along x.
ALONG_Y = np.array([layer & 7 | layer >> 3 & 7 | layer >> 6 for layer in range(512)])
ALONG_X = np.array([sum(1 << y for y in range(3) if layer >> 3 * y & 7) for layer in range(512)])


@njit(cache=True)
def piece(body: int, start: int) -> int:
    """The voxels of a body that hang together with one, by faces."""
    found = start
    while True:
        near = (found & X_ON) << 1 | (found & X_BACK) >> 1 | (found & Y_ON) << 3 | (found & Y_BACK) >> 3
        grown = (found | near | found << 9 | found >> 9) & body & ALL
        if grown == found:
            return found
        found = grown


@njit(cache=True)
def seen(body: int, along_y: Array, along_x: Array) -> tuple[int, int, int]:
    """Its three pictures."""
    front, side, top = 0, 0, 0
    for z in range(3):
        layer = body >> 9 * z & 511
        front |= along_y[layer] << 3 * z
        side |= along_x[layer] << 3 * z
        top |= layer
    return front, side, top


@njit(cache=True)
def exists(rank: Array, along_y: Array, along_x: Array, found: NDArray[np.bool_]) -> None:
    """Mark the pictures of every connected body, ``[rank of the front, side, top]``."""
    for high in range(512):
        for middle in range(512):
            for low in range(512):
                front = along_y[low] | along_y[middle] << 3 | along_y[high] << 6
                if rank[front] < 0:
                    continue
                body = low | middle << 9 | high << 18
                if piece(body, body & -body) == body:
                    side = along_x[low] | along_x[middle] << 3 | along_x[high] << 6
                    found[rank[front], side, low | middle | high] = True


@njit(cache=True)
def one_piece_casts_all(front: int, side: int, top: int, held: Array, along_y: Array, along_x: Array) -> bool:
    left = held[0, front] & held[1, side] & held[2, top]
    while left:
        one = piece(left, left & -left)
        if seen(one, along_y, along_x) == (front, side, top):
            return True
        left &= ~one
    return False


@njit(cache=True)
def disagreeing(fronts: Array, held: Array, along_y: Array, along_x: Array, found: NDArray[np.bool_]) -> int:
    """For how many pictures there is a connected body and no such piece of the hull, or the other way round."""
    wrong = 0
    for number in range(len(fronts)):
        for side in range(1, 512):
            for top in range(1, 512):
                told = one_piece_casts_all(fronts[number], side, top, held, along_y, along_x)
                wrong += told != found[number, side, top]
    return wrong


def standing_for_others() -> Array:
    """Fronts of which none that they turn or mirror into is a smaller number."""
    pictures = (np.arange(1, 512)[:, None] >> np.arange(9) & 1).reshape(-1, 3, 3)
    weights = 1 << np.arange(9)
    turned = [np.rot90(each, k, (1, 2)) for each in (pictures, pictures[:, ::-1]) for k in range(4)]
    numbers = np.array([each.reshape(-1, 9) @ weights for each in turned])
    return np.unique(numbers.min(axis=0))


@compiled_only
def test_a_connected_body_exists_just_where_one_piece_of_the_hull_casts_all() -> None:
    fronts = standing_for_others()
    assert len(fronts) == 101
    rank = np.full(512, -1)
    rank[fronts] = np.arange(len(fronts))
    found = np.zeros((len(fronts), 512, 512), np.bool_)
    exists(rank, ALONG_Y, ALONG_X, found)
    assert disagreeing(fronts, HELD, ALONG_Y, ALONG_X, found) == 0
    assert 0 < np.count_nonzero(found) < found.size
    told(fronts, found)


def told(fronts: Array, found: NDArray[np.bool_]) -> None:
    """`reach` says the same of some that exist, of some that fall apart, and of some that nothing casts."""
    random, grid = np.random.default_rng(1), Grid((3, 3, 3))
    rig, left = walls(grid).rig(), {"one piece": 60, "pieces": 60, "nothing": 20}
    while any(left.values()):
        number, side, top = (
            int(random.integers(least, most)) for least, most in ((0, len(fronts)), (1, 512), (1, 512))
        )
        hull = int(HELD[0, fronts[number]] & HELD[1, side] & HELD[2, top])
        is_cast = seen(hull, ALONG_Y, ALONG_X) == (int(fronts[number]), side, top)
        kind = "one piece" if found[number, side, top] else "pieces" if is_cast else "nothing"
        if not left[kind]:
            continue
        left[kind] -= 1
        bits = [(each >> np.arange(9) & 1).astype(bool).reshape(3, 3)[::-1] for each in (fronts[number], side, top)]
        answer = reach(of_pixels(rig, *bits), grid)
        assert answer.is_valid == is_cast
        assert (answer.is_valid and answer.is_one_piece) == (kind == "one piece")
