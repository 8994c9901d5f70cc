"""Meshes as 3MF: a zip archive of XML, which says millimetres and shares vertices; what slicers like best."""

import io
import re
import zipfile
from collections.abc import Sequence
from importlib.metadata import version
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from lightcube.solids.mesh import Mesh

_MODEL = "3D/3dmodel.model"
_TYPES = """<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"""
_RELATIONS = f"""<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Id="rel0" Target="/{_MODEL}" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
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
_VERTEX = re.compile(rb'<vertex x="([^"]+)" y="([^"]+)" z="([^"]+)"/>')
_TRIANGLE = re.compile(rb'<triangle v1="(\d+)" v2="(\d+)" v3="(\d+)"/>')


def write_3mf(mesh: Mesh) -> bytes:
    """A mesh as the bytes of a 3MF file, coordinates as float32; the same mesh gives the same bytes."""
    return _packed([_OPENING.format(version=version("lightcube")), *_body(mesh), _CLOSING])


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
    return _packed(model)


def _body(mesh: Mesh, more: str = "") -> list[str]:
    """Vertices and triangles, of which each says something `more`."""
    corners = mesh.vertices_mm.astype(np.float32).tolist()
    body = [f'<vertex x="{x:.9g}" y="{y:.9g}" z="{z:.9g}"/>\n' for x, y, z in corners]
    body.append(_MIDDLE)
    return body + [f'<triangle v1="{a}" v2="{b}" v3="{c}"{more}/>\n' for a, b, c in mesh.faces.tolist()]


def _packed(model: Sequence[str]) -> bytes:
    """The archive of a model, of no date."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED, compresslevel=4) as archive:
        for name, text in (("[Content_Types].xml", _TYPES), ("_rels/.rels", _RELATIONS), (_MODEL, "".join(model))):
            entry = zipfile.ZipInfo(name)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, text)
    return made.getvalue()


def read_3mf(data: bytes) -> NDArray[np.float64]:
    """Triangles ``(faces, 3, 3)`` of a 3MF file that `write_3mf` made."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        vertices, triangles = archive.read(_MODEL).split(_MIDDLE.encode())
    corners = np.array(_VERTEX.findall(vertices), dtype="S").astype(np.float64)
    faces = np.array(_TRIANGLE.findall(triangles), dtype="S").astype(np.int64)
    return np.asarray(corners[faces])
