"""Meshes as files: other programs read what is written, and nothing is written that loses what matters."""

import zipfile
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from lightcube.errors import InputError
from lightcube.io import save
from lightcube.io.printable import WRITERS, read_written
from lightcube.solids.mesh import Mesh
from tests.laws.test_writer import a_mesh
from tests.solids.test_printing import box

every_suffix = pytest.mark.parametrize("suffix", WRITERS)


@every_suffix
def test_trimesh_reads_the_same(tmp_path: Path, suffix: str) -> None:
    trimesh = pytest.importorskip("trimesh", reason="the extra oracle")
    if suffix == ".3mf":
        pytest.importorskip("lxml", reason="the extra oracle")
        pytest.importorskip("networkx", reason="the extra oracle")
    mesh = a_mesh(1, suffix)
    read = trimesh.load_mesh(save(mesh, tmp_path / f"a{suffix}"))
    assert read.is_watertight
    assert len(read.faces) == len(mesh)
    assert read.volume == pytest.approx(mesh.volume_mm3, rel=1e-6)
    np.testing.assert_allclose(read.bounds[1] - read.bounds[0], mesh.size_mm, rtol=1e-6)


@pytest.mark.parametrize("suffix", [".stl", ".3mf"])
def test_lib3mf_reads_the_same(tmp_path: Path, suffix: str) -> None:
    lib3mf = pytest.importorskip("lib3mf", reason="the extra oracle")
    mesh = a_mesh(0, suffix)
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader(suffix[1:])
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(save(mesh, tmp_path / f"a{suffix}")))
    assert reader.GetWarningCount() == 0
    objects = model.GetMeshObjects()
    assert objects.MoveNext()
    (read,) = [objects.GetCurrentMeshObject()]
    assert not objects.MoveNext()
    assert read.IsManifoldAndOriented()
    assert read.GetTriangleCount() == len(mesh)
    if suffix == ".3mf":
        assert model.GetUnit() == lib3mf.ModelUnit.MilliMeter
        vertices = np.array([list(vertex.Coordinates) for vertex in read.GetVertices()])
        np.testing.assert_array_equal(vertices, mesh.vertices_mm.astype(np.float32))
        assert [list(face.Indices) for face in read.GetTriangleIndices()] == mesh.faces.tolist()


def test_manifold_takes_it_and_gives_it_back(tmp_path: Path) -> None:
    manifold3d = pytest.importorskip("manifold3d", reason="the extra oracle")
    mesh = read_written(save(a_mesh(1, ""), tmp_path / "a.ply"))
    given = manifold3d.Mesh(mesh.vertices_mm.astype(np.float32), mesh.faces.astype(np.uint32))
    solid = manifold3d.Manifold(given)
    assert solid.status() == manifold3d.Error.NoError
    assert solid.volume() == pytest.approx(mesh.volume_mm3, rel=1e-6)
    back = solid.to_mesh()
    assert Mesh(back.vert_properties[:, :3], back.tri_verts.astype(int)).is_watertight


def test_3mf_has_a_picture_of_what_is_in_it(tmp_path: Path) -> None:
    """A box, 4 wide, 3 deep and 8 high: its three faces are seen, the top brightest, and nothing around it."""
    with zipfile.ZipFile(save(box(4.0, 3.0, 8.0), tmp_path / "a.3mf")) as archive:
        kinds, links = (archive.read(name).decode() for name in ("[Content_Types].xml", "_rels/.rels"))
        levels = np.asarray(Image.open(archive.open("Metadata/thumbnail.png"))).astype(int)
    assert 'Extension="png" ContentType="image/png"' in kinds
    assert "/Metadata/thumbnail.png" in links
    assert levels.shape == (256, 256, 4)
    rows, columns = (np.flatnonzero((levels[..., 3] > 128).any(axis=axis)) for axis in (1, 0))
    assert 0.85 * 256 < np.ptp(rows) < 0.9 * 256
    assert rows[0] + rows[-1] == pytest.approx(255, abs=2)
    assert np.ptp(columns) < 0.8 * np.ptp(rows)
    assert levels[2, 2, 3] == levels[-3, 2, 3] == 0
    middle = levels[128, 128]
    assert middle[3] == 255
    assert middle[0] > middle[1] > middle[2]


@every_suffix
def test_the_same_mesh_gives_the_same_bytes(tmp_path: Path, suffix: str) -> None:
    first, second = (save(a_mesh(0, suffix), tmp_path / f"{name}{suffix}").read_bytes() for name in "ab")
    assert first == second


@every_suffix
def test_a_mesh_too_fine_for_its_place_is_refused_and_nothing_stays(tmp_path: Path, suffix: str) -> None:
    """A ball of 20 mm, 100 km from the origin: float32 counts there in steps of 8 mm."""
    ball = a_mesh(0, suffix)
    with pytest.raises(InputError, match="cannot hold this mesh: files count with seven digits"):
        save(Mesh(ball.vertices_mm + 1e8, ball.faces), tmp_path / f"a{suffix}")
    assert list(tmp_path.iterdir()) == []
