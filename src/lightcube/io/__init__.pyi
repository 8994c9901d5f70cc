"""Reading and writing files, by suffix."""

from lightcube.io.cubes import bare_name, check_cube_target, read_cube, save
from lightcube.io.documents import (
    check_drawing_target,
    check_figure_target,
    check_page_target,
    check_sheet_target,
    write_drawing,
    write_figure,
    write_json,
    write_page,
    write_sheet,
)
from lightcube.io.machine import free_memory
from lightcube.io.movies import ClippedPictures, check_pictures_target, write_pictures
from lightcube.io.pictures import TransparentPictures, read_pictures
from lightcube.io.scenes import read_scene, scene_names
from lightcube.io.stages import is_stage, read_stage, read_stage_frames, stage_pictures

__all__ = [
    "ClippedPictures",
    "TransparentPictures",
    "bare_name",
    "check_cube_target",
    "check_drawing_target",
    "check_figure_target",
    "check_page_target",
    "check_pictures_target",
    "check_sheet_target",
    "free_memory",
    "is_stage",
    "read_cube",
    "read_pictures",
    "read_scene",
    "read_stage",
    "read_stage_frames",
    "save",
    "scene_names",
    "stage_pictures",
    "write_drawing",
    "write_figure",
    "write_json",
    "write_page",
    "write_pictures",
    "write_sheet",
]
