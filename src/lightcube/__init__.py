"""Pictures in, a cube of coloured shadows out."""

from lightcube import kernels
from lightcube.loading import when_used
from lightcube.optics import showing

__getattr__, __dir__, __all__ = when_used(
    __name__,
    {
        "Mat": "backward.mat",
        "Recipe": "backward.recipe",
        "Solution": "backward.solution",
        "solve": "backward.solving",
        "threads": "cores",
        "InputError": "errors",
        "export": "fabrication.exporting",
        "as_films": "fabrication.thinning",
        "read_export": "fabrication.reading",
        "cast": "forward.casting",
        "play": "forward.casting",
        "player": "forward.casting",
        "read_dyes": "io",
        "read_pictures": "io",
        "read_relief": "io",
        "read_scene": "io",
        "read_shape": "io",
        "read_stage": "io",
        "read_stage_targets": "io",
        "save": "io",
        "load": "jobs.reading",
        "publish": "jobs.publishing",
        "Cube": "optics.cube",
        "Dyes": "optics.dyes",
        "Grid": "optics.grid",
        "Films": "optics.attenuator",
        "attenuator": "optics.attenuator",
        "Glass": "optics.glass",
        "Light": "optics.light",
        "Material": "optics.material",
        "Move": "optics.moves",
        "Rig": "optics.rig",
        "turntable": "optics.setups",
        "Stack": "optics.stack",
        "Lamp": "optics.stage",
        "Screen": "optics.stage",
        "Shot": "optics.stage",
        "Stage": "optics.stage",
        "Views": "optics.views",
        "spread_angles": "optics.views",
        "fit": "pictures.fitting",
        "Targets": "pictures.targets",
        "Turntable": "pictures.turntable",
        "Pictures": "pictures.pictures",
        "check": "planning.consistency",
        "best_order": "planning.order",
        "Plan": "planning.plan",
        "plan": "planning.plan",
        "Prediction": "planning.prediction",
        "predict": "planning.prediction",
        "Projector": "projection.projector",
        "dot_test": "projection.projector",
        "certify": "solids.certificate",
        "cut": "solids.cutting",
        "Mesh": "solids.mesh",
        "Relief": "solids.relief",
        "ReliefRecipe": "solids.relief",
        "relief": "solids.relief_making",
        "relief_mesh": "solids.relief_mesh",
        "relief_shadow": "solids.relief_light",
        "score_relief": "scoring.reliefs",
        "Reach": "solids.reach",
        "reach": "solids.reach",
        "Shape": "solids.shape",
        "as_cube": "solids.shape",
        "carve": "solids.carving",
        "with_base": "solids.base",
        "Repaired": "solids.repair",
        "repair": "solids.repair",
        "Warped": "solids.warp",
        "warp": "solids.warp",
        "hull": "solids.shape",
        "Silhouettes": "solids.silhouettes",
        "silhouettes": "solids.standing",
        "walls": "solids.walls",
        "Scene": "scene.scene",
        "scene_targets": "scene.tracer",
        "scene_rig": "scene.tracer",
        "score": "scoring.metrics",
        "METHODS": "solvers",
        "Result": "solvers.contract",
        "show": "viewer.notebook",
        "Label": "viewer.label",
        "page": "viewer.page",
        "film": "drawing.films",
    },
)


def _displayed(cube: object) -> dict[str, object]:
    """What a notebook shows of a cube; the page's modules load with the first one that is shown."""
    from lightcube.viewer.notebook import displayed

    return displayed(cube)


showing.by = _displayed  # the cube itself stands too low to know the page


def _free_cores() -> int:
    """How many threads compute where nobody said so."""
    from lightcube.cores import default

    return default()


kernels.default_threads = _free_cores  # the loops themselves stand too low to know the machine
