"""Three small cubes to be shown around: photographs in stained glass, a juggler, and two walls at once."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from lightcube import io
from lightcube.backward.recipe import Recipe
from lightcube.optics.grid import Grid
from lightcube.optics.material import Material
from lightcube.optics.setups import turntable
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.optics.views import spread_angles
from lightcube.pictures.pictures import Pictures
from lightcube.pictures.samples import photographs
from lightcube.pictures.targets import Targets
from lightcube.planning.plan import plan, plan_stage
from lightcube.scene.tracer import scene_targets

#: Voxels along a side, and mm of it.
SIDE, SIZE_MM = 64, 100.0
#: What the darkest stained glass may absorb, 1/mm: no voxel of it is a black speck.
_CLEAR = 0.12
#: Two walls: stops at which none of the one wall's pictures has the beams of one of the other's.
_STOPS_DEG = (11.25, 33.75, 191.25, 213.75)
#: The photographs, in the order of the turn.
_IN_GLASS = ("astronaut", "coffee", "cat", "rocket", "retina", "tissue", "colours", "camera")
_ON_WALLS = ("coffee", "stars", "cat", "coins", "astronaut", "retina", "tissue", "rocket")
#: How far below the light's way over the floor it falls, and where a wall's middle is, mm.
_FALL, _AWAY_MM, _DOWN_MM = -0.7, 150.0, -105.0


@dataclass(frozen=True)
class Wonder:
    """A cube that is worth a look.

    Parameters
    ----------
    name, title, said
        Of its files; for people; what there is to be seen, in a sentence.
    make
        Makes what is wanted, the cube that it is for, and how that is solved.
    """

    name: str
    title: str
    said: str
    make: Callable[[], tuple[Targets, Grid, Recipe]]


def _glass() -> tuple[Targets, Grid, Recipe]:
    """Eight photographs without mats: nothing is asked for beside them, so little of the glass is dark."""
    recipe = Recipe.of_quality("normal", material=Material(_CLEAR))
    planned = plan(_photographs(_IN_GLASS), SIDE, recipe, picture_width=0.5, longest_hold=True, smooth=True)
    return planned.targets, planned.grid, planned.recipe


def _juggler() -> tuple[Targets, Grid, Recipe]:
    """A traced scene, one picture for every step of a whole turn of the cube under a raised lamp."""
    grid = Grid((SIDE,) * 3, SIZE_MM / SIDE)
    rows = SIDE // 2
    rig = turntable(grid, spread_angles(24, elevation_deg=35.0), elevation_deg=35.0, picture_shape=(rows, rows))
    return scene_targets(io.read_scene("juggler"), rig, grid), grid, Recipe.of_quality("normal")


def _walls() -> tuple[Targets, Grid, Recipe]:
    """Four stops, each of which shows a photograph on a wall and another one on the wall beside it."""
    grid = Grid((SIDE,) * 3, SIZE_MM / SIDE)
    lamps = Lamp("front", direction=(1.0, 0.0, _FALL)), Lamp("left", direction=(0.0, 1.0, _FALL))
    wide = SIZE_MM / 2
    walls = tuple(
        Screen(name, centre, (wide, wide), grid.voxel_mm, normal=normal)
        for name, centre, normal in (
            ("back wall", (_AWAY_MM, 0.0, _DOWN_MM), (-1.0, 0.0, 0.0)),
            ("side wall", (0.0, _AWAY_MM, _DOWN_MM), (0.0, -1.0, 0.0)),
        )
    )
    pictures = _photographs(_ON_WALLS)
    shots = tuple(
        Shot(name, walls[number % 2].name, (lamps[number % 2].name,), number // 2)
        for number, name in enumerate(pictures.names)
    )
    stage = Stage(grid, lamps, walls, shots, _STOPS_DEG)
    planned = plan_stage(stage, pictures, "crop", Recipe.of_quality("normal"), told=False)
    return planned.targets, planned.grid, planned.recipe


def _photographs(names: Sequence[str]) -> Pictures:
    """Photographs by their names."""
    whole = photographs(16)
    return replace(whole, images=tuple(whole.images[whole.names.index(name)] for name in names), names=tuple(names))


WONDERS = (
    Wonder(
        "photographs", "Eight photographs in stained glass", "Turn it: at each stop the shadow is another one.", _glass
    ),
    Wonder("juggler", "A juggler", "Turn it steadily: its shadow throws the balls.", _juggler),
    Wonder(
        "walls", "Two walls at once", "Two lamps, two walls: each stop shows two photographs at the same time.", _walls
    ),
)
