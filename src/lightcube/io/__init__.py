"""Reading and writing files, by suffix."""

from lightcube.io.cubes import UnfinishedCube, bare_name, check_cube_target, load, publish, save
from lightcube.io.figures import check_figure_target, write_figure
from lightcube.io.machine import free_memory
from lightcube.io.movies import ClippedPictures, check_pictures_target, write_pictures
from lightcube.io.partial import (
    DiskStore,
    begun_units,
    check_partial,
    discard_partial,
    load_job,
    open_partial,
    partial_path,
    published_path,
)
from lightcube.io.pictures import TransparentPictures, read_pictures
from lightcube.io.scenes import read_scene, scene_names
from lightcube.io.sheets import check_sheet_target, write_json, write_sheet
from lightcube.io.stages import is_stage, read_stage, read_stage_frames, stage_pictures
from lightcube.io.texts import check_drawing_target, check_page_target, write_drawing, write_page

__all__ = [
    "ClippedPictures",
    "DiskStore",
    "TransparentPictures",
    "UnfinishedCube",
    "bare_name",
    "begun_units",
    "check_cube_target",
    "check_drawing_target",
    "check_figure_target",
    "check_page_target",
    "check_partial",
    "check_pictures_target",
    "check_sheet_target",
    "discard_partial",
    "free_memory",
    "is_stage",
    "load",
    "load_job",
    "open_partial",
    "partial_path",
    "publish",
    "published_path",
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
