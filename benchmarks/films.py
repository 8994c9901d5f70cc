"""Stacks of films: how good pictures become, and what is left where they lie off.

    python benchmarks/films.py [anywhere|held|sizes|moved ...]

Photographs of scikit-image, 32 x 32 pixels of 5 mm, cells of 2.5 mm, a density of 1.5 at most, 60 passes, unless said.
PSNR in dB, mean / worst, of exact means over pixels; then with every film 0.1 and 0.2 mm off (root of the mean square
of either side), the mean of eight draws that nothing was solved for.
"""

import itertools
import math
import sys
import time
from collections.abc import Callable

import numpy as np

import lightcube as lc
from lightcube.optics.attenuator import snapped
from lightcube.optics.moves import misplaced
from lightcube.optics.stack import Stack
from lightcube.optics.sun import sunlight
from lightcube.pictures.fitting import targets_of
from lightcube.pictures.samples import photographs
from lightcube.scoring.metrics import score_pictures

#: Draws of films that lie off.
DRAWS = 8
FILMS = lc.Films(5, 12.0)


def pictures(count: int) -> list[str]:
    """Names of so many photographs."""
    return list(photographs(count).names)


def solved(stage: lc.Stage, density: float = 1.5, passes: int = 60, assembly_mm: float = 0.0) -> lc.Cube:
    """The stack that shows the photographs in a room."""
    targets = lc.fit(photographs(len(stage.shots)), stage.rig())
    material = lc.Material(density * math.log(10), "voxel")
    return lc.solve(targets, stage.grid, lc.Recipe(passes=passes, material=material, assembly_mm=assembly_mm)).cube


def psnr(cube: lc.Cube, off_mm: float = 0.0, seed: int = 0) -> tuple[float, float]:
    """Mean and worst, with films that lie off by chance."""
    assert isinstance(cube.grid, Stack)  # noqa: S101 - made so
    off = np.zeros((cube.grid.shape[0], 3))
    off[:, :2] = off_mm * np.random.default_rng(1000 + seed).standard_normal((len(off), 2))
    rig = misplaced(cube.rig, cube.grid, off) if off_mm else cube.rig
    found = score_pictures(lc.cast(cube, rig), targets_of(cube))
    return found["psnr_mean"], found["psnr_min"]


def told(name: str, stage: lc.Stage, **more: float) -> None:
    """Print a row."""
    began = time.monotonic()
    cube = solved(stage, **more)  # type: ignore[arg-type]
    seconds = time.monotonic() - began
    mean, worst = psnr(cube)
    off = [np.mean([psnr(cube, off_mm, seed)[0] for seed in range(DRAWS)]) for off_mm in (0.1, 0.2)]
    dark = float(cube.extinction.mean()) * cube.grid.voxel_mm / math.log(10)
    print(
        f"{name:48s} {mean:5.1f} / {worst:4.1f} | {off[0]:4.1f} | {off[1]:4.1f} | mean density {dark:.2f}, "
        f"lamp {cube.powers.max():4.1f} | {seconds:5.1f} s",
        flush=True,
    )


def ring(count: int, degrees: float, first: float = 0.37) -> tuple[lc.Lamp, ...]:
    """Lamps on a cone: anywhere but on a lattice."""
    slope = math.tan(math.radians(degrees))
    turns = first + math.tau * np.arange(count) / count
    return tuple(
        lc.Lamp(f"lamp {k}", direction=(slope * math.cos(turn), slope * math.sin(turn), -1.0))
        for k, turn in enumerate(turns)
    )


def anywhere() -> None:
    """Four pictures, five films: lamps on a lattice, anywhere, snapped, in acrylic; the sun."""
    told("lattice", lc.attenuator(pictures(4), FILMS))
    told("ring of 23 degrees", lc.attenuator(pictures(4), FILMS, lamps=ring(4, 23)))
    told("ring, snapped to the lattice", lc.attenuator(pictures(4), FILMS, lamps=snapped(ring(4, 23), FILMS)))
    acrylic = lc.Films(5, 12.0, index=1.49)
    told("ring of 34 degrees, in acrylic", lc.attenuator(pictures(4), acrylic, lamps=ring(4, 34)))
    suns = tuple(
        lc.Lamp(f"{hour} h", direction=tuple(sunlight(48.0, "06-21", hour, 180, 30).tolist())) for hour in (9, 12, 15)
    )
    told("the sun at 9, 12 and 15 h, 4 films tilted by 30", lc.attenuator(pictures(3), lc.Films(4, 12.0), lamps=suns))


def held() -> None:
    """Films that are solved to lie off."""
    for off_mm in (0.1, 0.2):
        told(f"lattice, solved for {off_mm} mm off", lc.attenuator(pictures(4), FILMS), assembly_mm=off_mm)
    told("ring, solved for 0.2 mm off", lc.attenuator(pictures(4), FILMS, lamps=ring(4, 23)), assembly_mm=0.2)


def sizes() -> None:
    """Pictures, films, gaps, densities, cells."""
    for films in (2, 3, 4, 5, 8):
        told(f"4 pictures, {films} films", lc.attenuator(pictures(4), lc.Films(films, 12.0)))
    for density in (0.5, 1.0, 3.0):
        told(f"4 pictures, 5 films, density {density:g}", lc.attenuator(pictures(4), FILMS), density=density)
    told("4 pictures, 5 films, 80 mm", lc.attenuator(pictures(4), lc.Films(5, 12.0, size_mm=80)))
    for cells in (1, 4):
        fine = lc.Films(5, 12.0, cells_a_pixel=cells)
        told(f"4 pictures, 5 films, {cells} cells a pixel", lc.attenuator(pictures(4), fine))
    for count, many, gap in (
        *((1, 3, 12.0), (2, 2, 12.0), (2, 3, 12.0), (4, 5, 6.0), (6, 6, 12.0)),
        *((9, 5, 12.0), (9, 8, 12.0), (9, 8, 24.0), (16, 8, 24.0)),
    ):
        told(f"{count} pictures, {many} films, gap {gap:g}", lc.attenuator(pictures(count), lc.Films(many, gap)))


def moved() -> None:
    """Films that are slid, or put into another order, under one lamp; 80 mm."""
    for films, count in ((2, 2), (2, 4), (3, 4)):
        touching = lc.Films(films, 0.0, size_mm=80)
        apart = [20 * (k - (films - 1) / 2) for k in range(films)]
        moves = [
            lc.Move(f"slid {n}", shift_mm=tuple((mm * right, mm * up) for mm in apart))
            for n, (right, up) in enumerate([(0, 0), (1, 0), (0, 1), (1, 1)][:count])
        ]
        stage = lc.attenuator(pictures(count), touching, moves=moves)
        told(f"{count} places of {films} films that touch, 20 mm apart", stage, density=2.0, passes=120)
    lamp = (lc.Lamp("lamp", direction=(10 / 12, 5 / 12, -1.0)),)
    for films, step in ((3, 1), (4, 4)):
        orders = list(itertools.permutations(range(1, films + 1)))[::step][:6]
        moves = [lc.Move(f"order {n}", order=order) for n, order in enumerate(orders)]
        stage = lc.attenuator(pictures(6), lc.Films(films, 12.0, size_mm=80), lamps=lamp, moves=moves)
        told(f"6 orders of {films} films, a lamp aslant", stage, density=2.0, passes=120)


CASES: dict[str, Callable[[], None]] = {"anywhere": anywhere, "held": held, "sizes": sizes, "moved": moved}


if __name__ == "__main__":
    for case in sys.argv[1:] or CASES:
        print(case, flush=True)
        CASES[case]()
