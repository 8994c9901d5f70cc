"""Pictures in, a cube of coloured shadows out."""

from lightcube.backward import solve
from lightcube.conditioning import best_order
from lightcube.consistency import check
from lightcube.cores import threads
from lightcube.cube import Cube
from lightcube.errors import InputError
from lightcube.fitting import fit, fit_to_stage
from lightcube.forward import cast, exposures_at, lamp_at, play, player, views_at
from lightcube.frames import Frames, Pictures
from lightcube.geometry import Grid, Views, spread_angles, turntable
from lightcube.io import (
    load,
    publish,
    read_pictures,
    read_scene,
    read_stage,
    read_stage_frames,
    save,
    write_page,
    write_pictures,
)
from lightcube.lighting import Lighting, sampled
from lightcube.metrics import score
from lightcube.planning import Plan, plan
from lightcube.prediction import Prediction, predict
from lightcube.projector import Projector, dot_test
from lightcube.scene.scene import Scene
from lightcube.scene.tracer import scene_frames, scene_views
from lightcube.solution import Solution
from lightcube.solvers import METHODS
from lightcube.solvers.contract import Result
from lightcube.stage import Lamp, Screen, Shot, Stage, exposures
from lightcube.viewer.notebook import displayed, show
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
    "threads",
    "turntable",
    "views_at",
    "write_page",
    "write_pictures",
]

Cube.shown_by = displayed  # the cube itself stands too low to know the page
