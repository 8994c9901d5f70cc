"""Reading and writing files, by suffix."""

from lightcube.loading import when_used

__getattr__, __dir__, __all__ = when_used(
    __name__,
    {
        "bare_name": "cubes",
        "check_cube_target": "cubes",
        "read_cube": "cubes",
        "save": "cubes",
        "check_drawing_target": "documents",
        "check_figure_target": "documents",
        "check_page_target": "documents",
        "check_sheet_target": "documents",
        "write_drawing": "documents",
        "write_figure": "documents",
        "write_json": "documents",
        "write_page": "documents",
        "write_sheet": "documents",
        "free_memory": "machine",
        "ClippedPictures": "movies",
        "check_pictures_target": "movies",
        "write_pictures": "movies",
        "TransparentPictures": "pictures",
        "read_pictures": "pictures",
        "read_scene": "scenes",
        "scene_names": "scenes",
        "is_stage": "stages",
        "read_stage": "stages",
        "read_stage_frames": "stages",
        "stage_pictures": "stages",
    },
)
