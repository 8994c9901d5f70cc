"""Pictures in, a cube of coloured shadows out."""

from lightcube.backward.solution import Solution
from lightcube.backward.solving import solve
from lightcube.errors import InputError
from lightcube.forward.casting import cast, play, player
from lightcube.forward.turning import exposures_at, lamp_at, views_at
from lightcube.io import read_pictures, read_scene, read_stage, read_stage_frames, save, write_page, write_pictures
from lightcube.jobs.cubes import load, publish
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Lighting, sampled
from lightcube.optics.stage import Lamp, Screen, Shot, Stage, exposures
from lightcube.optics.views import Views, spread_angles, turntable
from lightcube.pictures.fitting import fit, fit_to_stage
from lightcube.pictures.frames import Frames, Pictures
from lightcube.planning.consistency import check
from lightcube.planning.order import best_order
from lightcube.planning.plan import Plan, plan
from lightcube.planning.prediction import Prediction, predict
from lightcube.projection.projector import Projector, dot_test
from lightcube.scene.scene import Scene
from lightcube.scene.tracer import scene_frames, scene_views
from lightcube.scoring.metrics import score
from lightcube.solvers import METHODS
from lightcube.solvers.contract import Result
from lightcube.viewer.notebook import show
from lightcube.viewer.page import page

__all__ = [
    "METHODS",
    "Cube",
    "Frames",
    "Grid",
    "InputError",
    "Lamp",
    "Lighting",
    "Pictures",
    "Plan",
    "Prediction",
    "Projector",
    "Result",
    "Scene",
    "Screen",
    "Shot",
    "Solution",
    "Stage",
    "Views",
    "best_order",
    "cast",
    "check",
    "dot_test",
    "exposures",
    "exposures_at",
    "fit",
    "fit_to_stage",
    "lamp_at",
    "load",
    "page",
    "plan",
    "play",
    "player",
    "predict",
    "publish",
    "read_pictures",
    "read_scene",
    "read_stage",
    "read_stage_frames",
    "sampled",
    "save",
    "scene_frames",
    "scene_views",
    "score",
    "show",
    "solve",
    "spread_angles",
    "turntable",
    "views_at",
    "write_page",
    "write_pictures",
]
