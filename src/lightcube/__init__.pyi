"""Pictures in, a cube of coloured shadows out."""

from lightcube.backward.mat import Mat
from lightcube.backward.recipe import Recipe
from lightcube.backward.solution import Solution
from lightcube.backward.solving import solve
from lightcube.cores import threads
from lightcube.drawing.films import film
from lightcube.errors import InputError
from lightcube.fabrication.exporting import export
from lightcube.fabrication.reading import read_export
from lightcube.fabrication.thinning import as_films
from lightcube.forward.casting import cast, play, player
from lightcube.io import (
    read_dyes,
    read_pictures,
    read_relief,
    read_scene,
    read_shape,
    read_stage,
    read_stage_targets,
    save,
)
from lightcube.jobs.publishing import publish
from lightcube.jobs.reading import load
from lightcube.optics.attenuator import Films, attenuator
from lightcube.optics.cube import Cube
from lightcube.optics.dyes import Dyes
from lightcube.optics.glass import Glass
from lightcube.optics.grid import Grid
from lightcube.optics.light import Light
from lightcube.optics.material import Material
from lightcube.optics.moves import Move
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.optics.stack import Stack
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.optics.views import Views, spread_angles
from lightcube.pictures.fitting import fit
from lightcube.pictures.pictures import Pictures
from lightcube.pictures.targets import Targets
from lightcube.pictures.turntable import Turntable
from lightcube.planning.consistency import check
from lightcube.planning.order import best_order
from lightcube.planning.plan import Plan, plan
from lightcube.planning.prediction import Prediction, predict
from lightcube.projection.projector import Projector, dot_test
from lightcube.scene.scene import Scene
from lightcube.scene.tracer import scene_rig, scene_targets
from lightcube.scoring.metrics import score
from lightcube.scoring.reliefs import score_relief
from lightcube.solids.base import with_base
from lightcube.solids.carving import carve
from lightcube.solids.certificate import certify
from lightcube.solids.cutting import cut
from lightcube.solids.mesh import Mesh
from lightcube.solids.reach import Reach, reach
from lightcube.solids.relief import Relief, ReliefRecipe
from lightcube.solids.relief_light import relief_shadow
from lightcube.solids.relief_making import relief
from lightcube.solids.relief_mesh import relief_mesh
from lightcube.solids.repair import Repaired, repair
from lightcube.solids.shape import Shape, as_cube, hull
from lightcube.solids.silhouettes import Silhouettes
from lightcube.solids.standing import silhouettes
from lightcube.solids.walls import walls
from lightcube.solids.warp import Warped, warp
from lightcube.solvers import METHODS
from lightcube.solvers.contract import Result
from lightcube.viewer.label import Label
from lightcube.viewer.notebook import show
from lightcube.viewer.page import page

__all__ = [
    "METHODS",
    "Cube",
    "Dyes",
    "Films",
    "Glass",
    "Grid",
    "InputError",
    "Label",
    "Lamp",
    "Light",
    "Mat",
    "Material",
    "Mesh",
    "Move",
    "Pictures",
    "Plan",
    "Prediction",
    "Projector",
    "Reach",
    "Recipe",
    "Relief",
    "ReliefRecipe",
    "Repaired",
    "Result",
    "Rig",
    "Scene",
    "Screen",
    "Shape",
    "Shot",
    "Silhouettes",
    "Solution",
    "Stack",
    "Stage",
    "Targets",
    "Turntable",
    "Views",
    "Warped",
    "as_cube",
    "as_films",
    "attenuator",
    "best_order",
    "carve",
    "cast",
    "certify",
    "check",
    "cut",
    "dot_test",
    "export",
    "film",
    "fit",
    "hull",
    "load",
    "page",
    "plan",
    "play",
    "player",
    "predict",
    "publish",
    "reach",
    "read_dyes",
    "read_export",
    "read_pictures",
    "read_relief",
    "read_scene",
    "read_shape",
    "read_stage",
    "read_stage_targets",
    "relief",
    "relief_mesh",
    "relief_shadow",
    "repair",
    "save",
    "scene_rig",
    "scene_targets",
    "score",
    "score_relief",
    "show",
    "silhouettes",
    "solve",
    "spread_angles",
    "threads",
    "turntable",
    "walls",
    "warp",
    "with_base",
]
