"""Reading and writing files, by suffix."""

from lightcube.io._zarr import HollowCube
from lightcube.io.cubes import bare_name, read_cube
from lightcube.io.machine import free_memory
from lightcube.io.masks import read_mask
from lightcube.io.materials import material_names, read_dyes
from lightcube.io.meshes import is_mesh, read_solid
from lightcube.io.movies import ClippedPictures
from lightcube.io.outputs import Output, save, write_together
from lightcube.io.pictures import (
    ChangedPictures,
    DoubtfulFolder,
    ThinnedFilm,
    TransparentPictures,
    is_film,
    read_pictures,
)
from lightcube.io.reliefs import is_relief, read_relief
from lightcube.io.remembered import Remembered
from lightcube.io.scenes import read_scene, scene_names
from lightcube.io.shapes import is_shape, read_shape, written_mesh
from lightcube.io.stages import is_stage, read_stage, read_stage_targets, stage_pictures

__all__ = [
    "ChangedPictures",
    "ClippedPictures",
    "DoubtfulFolder",
    "HollowCube",
    "Output",
    "Remembered",
    "ThinnedFilm",
    "TransparentPictures",
    "bare_name",
    "free_memory",
    "is_film",
    "is_mesh",
    "is_relief",
    "is_shape",
    "is_stage",
    "material_names",
    "read_cube",
    "read_dyes",
    "read_mask",
    "read_pictures",
    "read_relief",
    "read_scene",
    "read_shape",
    "read_solid",
    "read_stage",
    "read_stage_targets",
    "save",
    "scene_names",
    "stage_pictures",
    "write_together",
    "written_mesh",
]
