"""Reading and writing files, by suffix."""

from lightcube.loading import when_used

__getattr__, __dir__, __all__ = when_used(
    __name__,
    {
        "bare_name": "cubes",
        "read_cube": "cubes",
        "free_memory": "machine",
        "material_names": "materials",
        "read_dyes": "materials",
        "ClippedPictures": "movies",
        "Output": "outputs",
        "save": "outputs",
        "write_together": "outputs",
        "HollowCube": "_zarr",
        "ChangedPictures": "pictures",
        "DoubtfulFolder": "pictures",
        "TransparentPictures": "pictures",
        "ThinnedFilm": "pictures",
        "is_film": "pictures",
        "read_pictures": "pictures",
        "Remembered": "remembered",
        "is_relief": "reliefs",
        "read_relief": "reliefs",
        "read_scene": "scenes",
        "scene_names": "scenes",
        "is_stage": "stages",
        "read_stage": "stages",
        "is_shape": "shapes",
        "read_shape": "shapes",
        "written_mesh": "shapes",
        "read_stage_targets": "stages",
        "stage_pictures": "stages",
    },
)
