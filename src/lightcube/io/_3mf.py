"""Meshes as 3MF: a zip archive of XML, which says millimetres and shares vertices; what slicers like best."""

import io
import zipfile
import zlib
from collections.abc import Sequence
from importlib.metadata import version
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from lightcube.solids.mesh import Mesh
from lightcube.solids.portrait import portrait

_MODEL, _PICTURE = "3D/3dmodel.model", "Metadata/thumbnail.png"
_THUMBNAIL = "http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail"
#: Pixels along a side of the picture that lists of files show.
_SIDE = 256
_TYPES = """<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
<Default Extension="png" ContentType="image/png"/>
</Types>
"""
_RELATIONS = f"""<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Id="rel0" Target="/{_MODEL}" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
<Relationship Id="rel1" Target="/{_PICTURE}" Type="{_THUMBNAIL}"/>
</Relationships>
"""
_OPENING = """<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
<metadata name="Application">lightcube {version}</metadata>
<resources>
<object id="1" type="model">
<mesh>
<vertices>
"""
_PARTS_OPENING = """<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" \
xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02">
<metadata name="Application">lightcube {version}</metadata>
<resources>
<m:colorgroup id="1">
"""
_MIDDLE = """</vertices>
<triangles>
"""
_CLOSING = """</triangles>
</mesh>
</object>
</resources>
<build>
<item objectid="1"/>
</build>
</model>
"""
#: What names of elements begin with, a triangle's corners, mm of each unit, bytes of a model, and objects in objects.
_CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
_NAMED = ("v1", "v2", "v3")
_UNITS = {"micron": 1e-3, "millimeter": 1.0, "centimeter": 10.0, "inch": 25.4, "foot": 304.8, "meter": 1000.0}
_MOST_MODEL, _DEEPEST = 1 << 30, 16


def write_3mf(mesh: Mesh) -> bytes:
    """A mesh as the bytes of a 3MF file, coordinates as float32; the same mesh gives the same bytes."""
    return _packed([_OPENING.format(version=version("lightcube")), *_body(mesh), _CLOSING], mesh)


def write_parts_3mf(parts: Sequence[tuple[str, Mesh, tuple[int, int, int]]]) -> bytes:
    """Meshes with names and colours as the bytes of a 3MF file: parts of one object, which stay where they are.

    Every triangle says its colour: slicers that make filaments of colours want that of all.
    """
    model = [_PARTS_OPENING.format(version=version("lightcube"))]
    model += [f'<m:color color="#{red:02X}{green:02X}{blue:02X}FF"/>\n' for _, _, (red, green, blue) in parts]
    model.append("</m:colorgroup>\n")
    for number, (name, mesh, _) in enumerate(parts):
        opening = f'<object id="{number + 2}" type="model" name={quoteattr(name)} pid="1" pindex="{number}">\n<mesh>\n'
        model += [
            opening,
            "<vertices>\n",
            *_body(mesh, f' pid="1" p1="{number}"'),
            "</triangles>\n</mesh>\n</object>\n",
        ]
    model.append(f'<object id="{len(parts) + 2}" type="model">\n<components>\n')
    model += [f'<component objectid="{number + 2}"/>\n' for number in range(len(parts))]
    model.append(
        f'</components>\n</object>\n</resources>\n<build>\n<item objectid="{len(parts) + 2}"/>\n</build>\n</model>\n'
    )
    return _packed(model, parts[0][1])


def _body(mesh: Mesh, more: str = "") -> list[str]:
    """Vertices and triangles, of which each says something `more`."""
    corners = mesh.vertices_mm.astype(np.float32).tolist()
    body = [f'<vertex x="{x:.9g}" y="{y:.9g}" z="{z:.9g}"/>\n' for x, y, z in corners]
    body.append(_MIDDLE)
    return body + [f'<triangle v1="{a}" v2="{b}" v3="{c}"{more}/>\n' for a, b, c in mesh.faces.tolist()]


def _packed(model: Sequence[str], mesh: Mesh) -> bytes:
    """The archive of a model and a picture of a mesh, of no date."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED, compresslevel=4) as archive:
        parts = (("[Content_Types].xml", _TYPES), ("_rels/.rels", _RELATIONS), (_MODEL, "".join(model)))
        for name, text in (*parts, (_PICTURE, _picture(mesh))):
            entry = zipfile.ZipInfo(name)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, text)
    return made.getvalue()


def _picture(mesh: Mesh) -> bytes:
    """A PNG of a mesh."""
    from PIL import Image  # here: who asks whether a name is a mesh's waits for none of it

    encoded = io.BytesIO()
    Image.fromarray(portrait(mesh, _SIDE)).save(encoded, "PNG")
    return encoded.getvalue()


def read_3mf(data: bytes) -> tuple[list[NDArray[np.float64]], str]:
    """Faces of a 3MF file, ``(faces, 3, 3)`` in mm, and what else it holds; `ValueError` says what is wrong.

    Objects are placed as its build says. Parts of other models in the archive are not followed.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            model = next((name for name in archive.namelist() if name.lower() == _MODEL.lower()), None)
            if model is None:
                raise ValueError("there is no model in it")
            if archive.getinfo(model).file_size > _MOST_MODEL:
                raise ValueError("its model is too large")
            root = ElementTree.fromstring(archive.read(model))  # noqa: S314  entities that grow are refused by expat
    except (zipfile.BadZipFile, ElementTree.ParseError, zlib.error, NotImplementedError, RuntimeError) as error:
        raise ValueError(" ".join(str(error).split())[:100]) from error
    try:
        scale = _UNITS[root.get("unit", "millimeter")]
        objects = {each.get("id"): each for each in root.iter(f"{_CORE}object")}
        found = [part for item in root.iter(f"{_CORE}item") for part in _placed(objects, item, _matrix(item), _DEEPEST)]
    except (KeyError, TypeError, IndexError, RecursionError) as error:
        raise ValueError(f"its model names {error} and does not say what that is") from error
    return [scale * part for part in found], ""


def _placed(
    objects: dict[str | None, ElementTree.Element], item: ElementTree.Element, matrix: NDArray[np.float64], deep: int
) -> list[NDArray[np.float64]]:
    """Triangles of an object that an item or a component names, and of what it is made of."""
    if not deep:
        raise RecursionError("itself")
    named = objects[item.get("objectid")]
    made = []
    mesh = named.find(f"{_CORE}mesh")
    if mesh is not None:
        corners = np.array([[float(each.get(axis, "")) for axis in "xyz"] for each in mesh.iter(f"{_CORE}vertex")])
        faces = [[int(each.get(name, "")) for name in _NAMED] for each in mesh.iter(f"{_CORE}triangle")]
        numbers = np.array(faces, np.intp).reshape(-1, 3)
        if len(numbers):
            if numbers.min() < 0 or numbers.max() >= len(corners):
                raise ValueError(f"a triangle names a vertex that is not among its {len(corners)}")
            made.append((corners @ matrix[:3] + matrix[3])[numbers])
    for part in named.iter(f"{_CORE}component"):
        own = _matrix(part)
        joined = np.vstack([own[:3] @ matrix[:3], own[3] @ matrix[:3] + matrix[3]])
        made += _placed(objects, part, joined, deep - 1)
    return made


def _matrix(item: ElementTree.Element) -> NDArray[np.float64]:
    """How an item or a component is placed, ``(4, 3)``: a corner times the first three rows, and the last."""
    said = item.get("transform")
    return np.eye(4, 3) if said is None else np.array(said.split(), np.float64).reshape(4, 3)
