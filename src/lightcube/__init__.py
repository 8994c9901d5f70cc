"""Pictures in, a cube of coloured shadows out."""

from lightcube.loading import when_used
from lightcube.optics import showing

__getattr__, __dir__, __all__ = when_used(
    __name__,
    {
        "Solution": "backward.solution",
        "solve": "backward.solving",
        "InputError": "errors",
        "cast": "forward.casting",
        "play": "forward.casting",
        "player": "forward.casting",
        "exposures_at": "forward.turning",
        "lamp_at": "forward.turning",
        "views_at": "forward.turning",
        "read_pictures": "io",
        "read_scene": "io",
        "read_stage": "io",
        "read_stage_frames": "io",
        "save": "io",
        "write_page": "io",
        "write_pictures": "io",
        "load": "jobs.cubes",
        "publish": "jobs.cubes",
        "Cube": "optics.cube",
        "Grid": "optics.grid",
        "Lighting": "optics.rig",
        "sampled": "optics.rig",
        "Lamp": "optics.stage",
        "Screen": "optics.stage",
        "Shot": "optics.stage",
        "Stage": "optics.stage",
        "exposures": "optics.stage",
        "Views": "optics.views",
        "spread_angles": "optics.views",
        "turntable": "optics.views",
        "fit": "pictures.fitting",
        "fit_to_stage": "pictures.fitting",
        "Frames": "pictures.frames",
        "Pictures": "pictures.frames",
        "check": "planning.consistency",
        "best_order": "planning.order",
        "Plan": "planning.plan",
        "plan": "planning.plan",
        "Prediction": "planning.prediction",
        "predict": "planning.prediction",
        "Projector": "projection.projector",
        "dot_test": "projection.projector",
        "Scene": "scene.scene",
        "scene_frames": "scene.tracer",
        "scene_views": "scene.tracer",
        "score": "scoring.metrics",
        "METHODS": "solvers",
        "Result": "solvers.contract",
        "show": "viewer.notebook",
        "page": "viewer.page",
    },
)


def _displayed(cube: object) -> dict[str, object]:
    """What a notebook shows of a cube; the page's modules load with the first one that is shown."""
    from lightcube.viewer.notebook import displayed

    return displayed(cube)


showing.by = _displayed  # the cube itself stands too low to know the page
