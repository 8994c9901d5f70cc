"""Volumes as other programs read them, and as they are read back: the same numbers at the same places."""

import json
import shutil
import struct
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import lightcube as lc
from lightcube.errors import InputError
from lightcube.fabrication import sidecar
from lightcube.fabrication.volumes import FORMATS
from tests.helpers.made import a_cube

#: A system's Python that has OpenVDB, and what it makes of a file: each grid's numbers, and where its first voxel is.
SYSTEM = "/usr/bin/python3"
OPENED = """
import sys, numpy as np, pyopenvdb
grids, _ = pyopenvdb.readAll(sys.argv[1])
found = {}
for grid in grids:
    last = np.array(grid.evalActiveVoxelBoundingBox()[1]) + 1
    numbers = np.zeros((*last, 3) if "Vec" in type(grid).__name__ else tuple(last), np.float32)
    grid.copyToArray(numbers)
    found[grid.name] = numbers
    found[grid.name + "_place"] = np.array([*grid.transform.indexToWorld((0, 0, 0)), *grid.transform.voxelSize()])
    assert grid.background in (0.0, (0.0, 0.0, 0.0)) and grid.activeVoxelCount() == np.prod(last)
np.savez(sys.argv[2], **found)
"""
#: What another program finds: the volume ``(channel, z, y, x)``, the middle of its first voxel, and its sides.
Found = tuple[NDArray[Any], NDArray[Any], NDArray[Any]]


def by_openvdb(path: Path) -> Found:
    has = subprocess.run([SYSTEM, "-c", "import pyopenvdb, numpy"], capture_output=True)
    if not Path(SYSTEM).exists() or has.returncode:
        pytest.skip("the system has no OpenVDB for Python (on Debian: python3-openvdb)")
    out = path.with_suffix(".npz")
    subprocess.run([SYSTEM, "-c", OPENED, path, out], check=True)
    with np.load(out) as found:
        together = found["sigma"].transpose(3, 2, 1, 0)
        for name, numbers in zip(("red", "green", "blue"), together, strict=True):
            np.testing.assert_array_equal(found[name].transpose(2, 1, 0), numbers)
        return together, found["red_place"][:3], found["red_place"][3:]


def by_simpleitk(path: Path) -> Found:
    sitk = pytest.importorskip("SimpleITK", reason="SimpleITK is of the extra readers")
    image = sitk.ReadImage(str(path))
    assert image.GetDirection() == (1, 0, 0, 0, 1, 0, 0, 0, 1)
    numbers = sitk.GetArrayFromImage(image)
    return numbers.transpose(3, 0, 1, 2), np.array(image.GetOrigin()), np.array(image.GetSpacing())


def by_pynrrd(path: Path) -> Found:
    nrrd = pytest.importorskip("nrrd", reason="pynrrd is of the extra readers")
    numbers, head = nrrd.read(str(path))
    return numbers.transpose(0, 3, 2, 1), head["space origin"], np.diag(head["space directions"][1:])


def by_vtk(path: Path) -> Found:
    vtk = pytest.importorskip("vtk", reason="vtk is of the extra readers")
    support = pytest.importorskip("vtk.util.numpy_support")
    reader = vtk.vtkXMLImageDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    nx, ny, nz = (count - 1 for count in image.GetDimensions())
    numbers = support.vtk_to_numpy(image.GetCellData().GetArray("extinction")).reshape(nz, ny, nx, -1)
    sides = np.array(image.GetSpacing())
    return numbers.transpose(3, 0, 1, 2), np.array(image.GetOrigin()) + sides / 2, sides


READERS: dict[str, tuple[str, Callable[[Path], Found]]] = {
    "OpenVDB": (".vdb", by_openvdb),
    "SimpleITK": (".nrrd", by_simpleitk),
    "pynrrd": (".nrrd", by_pynrrd),
    "vtk": (".vti", by_vtk),
}
every_reader = pytest.mark.parametrize("reader", READERS)
every_suffix = pytest.mark.parametrize("suffix", FORMATS)


@every_reader
def test_another_program_finds_the_same_numbers_at_the_same_places(tmp_path: Path, reader: str) -> None:
    suffix, read = READERS[reader]
    cube = a_cube((5, 17, 9), 0.3, 1.7)
    lc.export(cube, tmp_path / f"a{suffix}", "volume", score=False)
    numbers, first, sides = read(tmp_path / f"a{suffix}")
    np.testing.assert_array_equal(numbers, cube.extinction)
    np.testing.assert_allclose(sides, cube.grid.sides_mm)
    np.testing.assert_allclose(first, -cube.grid.sides_mm * (np.array(cube.grid.shape[::-1]) - 1) / 2)


@every_reader
def test_what_another_program_finds_casts_what_was_predicted(tmp_path: Path, reader: str) -> None:
    suffix, read = READERS[reader]
    cube = a_cube()
    said = lc.export(cube, tmp_path / f"a{suffix}", "volume")
    numbers, _, _ = read(tmp_path / f"a{suffix}")
    found = lc.Cube(np.array(numbers), cube.grid, cube.rig, cube.powers, cube.targets)
    assert abs(lc.score(found)["psnr_mean"] - said["predicted"]["psnr_mean"]) < 0.05
    assert said["predicted"]["psnr_mean"] > 60


@every_suffix
@pytest.mark.parametrize(("shape", "channels"), [((5, 17, 9), 3), ((3, 4, 21), 1), ((8, 16, 24), 2)])
def test_what_is_read_back_is_what_was_written(
    tmp_path: Path, suffix: str, shape: tuple[int, int, int], channels: int
) -> None:
    grid = lc.Grid(shape, 0.3, 1.7)
    volume = np.random.default_rng(0).random((channels, *shape), dtype=np.float32)
    write, read = FORMATS[suffix]
    write(tmp_path / f"a{suffix}", volume, grid)
    found, of = read(tmp_path / f"a{suffix}")
    np.testing.assert_array_equal(found, volume)
    if of is not None:
        assert of.shape == grid.shape
        np.testing.assert_allclose(of.sides_mm, grid.sides_mm, rtol=1e-12)
    again = tmp_path / f"b{suffix}"
    write(again, volume, grid)
    assert again.read_bytes() == (tmp_path / f"a{suffix}").read_bytes()


def test_a_vdb_in_metres_is_the_same_block(tmp_path: Path) -> None:
    cube = a_cube()
    lc.export(cube, tmp_path / "a.vdb", "volume", unit="m", score=False)
    found = lc.read_export(tmp_path / "a.vdb")
    np.testing.assert_allclose(found.extinction, cube.extinction, rtol=1e-6)
    assert found.grid == cube.grid
    data = (tmp_path / "a.vdb").read_bytes()
    at = data.index(b"ScaleTranslateMap") + 17
    np.testing.assert_allclose(struct.unpack_from("<3d", data, at + 24), cube.grid.sides_mm / 1000)
    with pytest.raises(InputError, match=r"only a .vdb does not: leave --unit m out"):
        lc.export(cube, tmp_path / "b.nrrd", "volume", unit="m")


@every_suffix
def test_a_file_of_somebody_else_is_a_sentence(tmp_path: Path, suffix: str) -> None:
    """Of another layout, cut short, longer, or with other bytes where its layout is said."""
    cube, path = a_cube(), tmp_path / f"a{suffix}"
    lc.export(cube, path, "volume", score=False)
    whole = path.read_bytes()
    harmed = [b"", b"NRRD0005\ntype: double\n", b"\0" * 400, whole[:-1], whole[: len(whole) // 2], whole + b"\0"]
    harmed += [whole.replace(b"float", b"short", 1).replace(b"Float32", b"Float64", 1), whole[:40] + whole[41:]]
    if suffix == ".npy":
        harmed = [*harmed[:3], harmed[4], whole.replace(b"<f4", b"<f2", 1)]
    for data in harmed:
        path.write_bytes(data)
        with pytest.raises(
            InputError, match=f"^[^\n]*a{suffix} is not as lightcube export writes {suffix} files[^\n]*$"
        ):
            lc.read_export(path, force=True)


def test_a_count_that_no_file_holds_is_refused_before_memory_is_taken(tmp_path: Path) -> None:
    cube, path = a_cube(), tmp_path / "a.nrrd"
    lc.export(cube, path, "volume", score=False)
    path.write_bytes(path.read_bytes().replace(b"sizes: 3 14", b"sizes: 3 99999999"))
    with pytest.raises(InputError, match="is not as lightcube export writes"):
        lc.read_export(path, force=True)


@every_suffix
def test_a_changed_file_is_told_and_force_takes_it(tmp_path: Path, suffix: str) -> None:
    cube, path = a_cube(), tmp_path / f"a{suffix}"
    lc.export(cube, path, "volume", score=False)
    data = bytearray(path.read_bytes())
    at = data.index(
        cube.extinction[:, 0, 0, 0].tobytes() if suffix in (".nrrd", ".vti") else cube.extinction[0, 0, 0, :1].tobytes()
    )
    data[at + 1] ^= 1
    path.write_bytes(bytes(data))
    with pytest.raises(InputError, match=r"is not the file that was exported, its SHA-256 is another .*--force"):
        lc.read_export(path)
    assert lc.read_export(path, force=True).extinction[0, 0, 0, 0] != cube.extinction[0, 0, 0, 0]


def test_without_a_sidecar_the_cube_says_what_lamps_there_are(tmp_path: Path) -> None:
    cube = a_cube()
    for suffix in FORMATS:
        path = tmp_path / f"a{suffix}"
        lc.export(cube, path, "volume", score=False)
        (tmp_path / f"a{suffix}.json").unlink()
        with pytest.raises(InputError, match=rf"there is no a{suffix}.json beside it: name the cube"):
            lc.read_export(path)
        found = lc.read_export(path, like=cube)
        np.testing.assert_array_equal(found.extinction, cube.extinction)
        np.testing.assert_array_equal(found.powers, cube.powers)
        np.testing.assert_allclose(found.grid.sides_mm, cube.grid.sides_mm)


def test_one_name_with_two_suffixes_has_two_sidecars(tmp_path: Path) -> None:
    cube = a_cube()
    for suffix in FORMATS:
        lc.export(cube, tmp_path / f"a{suffix}", "volume", score=False)
    for suffix in FORMATS:
        np.testing.assert_array_equal(lc.read_export(tmp_path / f"a{suffix}").extinction, cube.extinction)


def test_a_sidecar_says_what_it_is_of_and_none_of_another_is_taken(tmp_path: Path) -> None:
    cube = a_cube((6, 7, 9))
    said = lc.export(cube, tmp_path / "a.vdb", "volume", made_from="../cube.zarr")
    assert json.loads((tmp_path / "a.vdb.json").read_text()) == json.loads(sidecar.text(said))
    assert said["voxels"] == {"x": 9, "y": 7, "z": 6}
    assert said["pitch_mm"] == {"x": 0.5, "y": 0.5, "z": 0.5}
    assert said["files"] == {"a.vdb": sidecar.digest(tmp_path / "a.vdb")}
    assert said["made_from_sha256"] == sidecar.digest_of(cube)
    shutil.copy(tmp_path / "a.vdb", tmp_path / "b.vdb")
    (tmp_path / "b.vdb.json").write_text((tmp_path / "a.vdb.json").read_text())
    with pytest.raises(InputError, match=r"there is no b.vdb.json beside it"):  # it is that of a.vdb
        lc.read_export(tmp_path / "b.vdb")
    for harmed in ("", "{}", "[]", '{"format": "lightcube export 9"}', json.dumps({**said, "kind": "cake"})):
        (tmp_path / "a.vdb.json").write_text(harmed)
        with pytest.raises(InputError, match=r"a.vdb.json is not what lightcube export wrote[^\n]*: export again"):
            lc.read_export(tmp_path / "a.vdb")
