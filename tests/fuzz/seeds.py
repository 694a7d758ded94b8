"""Small whole files of every kind that is read: what the fuzzer damages."""

from __future__ import annotations

import io
import json
from pathlib import Path

import numpy as np
import trimesh
from PIL import Image

AFF = b"""\
b 0.2 0.3 0.4 am 1 1 1
v from 0 1 4 at 0 0 0 up 0 1 0 angle 50 hither 1 resolution 32 32
a 0 9 10 d 1
l 2 4 3 1 1 1
la swing -3 4 2 0.5 0.5 0.5
lamp rectangle at 0 2.4 0 edges 0.6 0 0 0 0 0.3 samples 4 color 1 0.9 0.8 falloff inverse-square
lamp dome at 0 0 0 radius 20 up 0 1 0 samples 4
f 0.8 0.6 0.4 0.9 0.1 10 0.2 1.5
p 4 -2 -1 -2 -2 -1 2 2 -1 2 2 -1 -2
pp 3 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1
tt picture.png 0 0 0 0 0 1 0 0 1 0 0 1 0 0 1
fm 0.1 0.1 0.1 0.3 0.5 0.8 0.2 0.2 0.2 10 0.5 1.4
s 0 0 0 0.5
xs 1 2 1 0 1 0 30 0 1 0 { c 0 0 0 0.5 0 1 0 0.2 i 1 part.aff }
x swing { x turn { p 3 -0.2 0.8 0 0.2 0.8 0 0 1.1 0 s 0 0 0 -0.1 } }
tpa 2 0 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1 9 0 0 0 0 0 1 1 0 0 0 0 1 0 1 1 0 0 1
k swing { visibility 1 0 1 transl 4 -1 0 0 0 0 0 0 0 0 0 0 0 0 0 9 1 0 0 0 0 0 10 1 0 0 0 0 0 }
k turn { rot 4 0 0 1 0 0 0 0 0 1 0 1 0 90 0 0 0 2 0 1 0 180 0 0 0 3 0 1 0 270 0 0 0
 scale 4 0 1 1 1 0 0 0 1 2 1 1 0 0 0 2 1 1 1 0 0 0 3 1 1 1 0 0 0 }
k camera { transl 4 -1 0 0 5 0 0 0 0 0 0 5 0 0 0 9 1 0 4 0 0 0 10 1 0 4 0 0 0 }
m vertices 4 0 0 0 1 0 0 0 1 0 0 0 1 normals 1 0 0 1 texturecoords 1 picture.png 0 0
 triangles 2 0 1 2 0 0 0 0 0 0 0 1 3 0 0 0 0 0 0
"""
OBJ = b"""\
mtllib a.mtl
v 0 0 0
v 1 0 0 0.5 0.5 0.5
v 1 1 0
v 0 1 0
vt 0 0
vt 1 1
vn 0 0 1
usemtl a
f 1/1/1 2/2/1 3/1/1
f 1 3 -1
"""
MTL = b"newmtl a\nKd 0.5 0.5 0.5\nKs 0.1 0.1 0.1\nNs 10\nNi 1.5\nd 0.5\nillum 3\nmap_Kd picture.png\n"
PLY = b"""\
ply
format ascii 1.0
comment TextureFile picture.png
element vertex 3
property float x
property float y
property float z
property float nx
property float ny
property float nz
property uchar red
property uchar green
property uchar blue
element face 1
property list uchar int vertex_indices
end_header
0 0 0 0 0 1 255 0 0
1 0 0 0 0 1 0 255 0
0 1 0 0 0 1 0 0 255
3 0 1 2
"""
STL = b"""\
solid a
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
endsolid a
"""


def _polygons() -> bytes:
    """A binary PLY file of a triangle and a square, with a list of texture places for each."""
    head = (
        "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
    )
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "<f4").tobytes()
    faces = [bytes([n]) + np.arange(n, dtype="<i4").tobytes() + bytes([2 * n]) + bytes(8 * n) for n in (3, 4)]
    return head.encode() + points + b"".join(faces)


def picture() -> bytes:
    """A PNG of a few pixels."""
    file = io.BytesIO()
    Image.fromarray(np.arange(48, dtype=np.uint8).reshape(4, 4, 3)).save(file, "PNG")
    return file.getvalue()


def _model() -> trimesh.Scene:
    box = trimesh.creation.box((1, 2, 3))
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=Image.open(io.BytesIO(picture())))
    box.visual = trimesh.visual.TextureVisuals(uv=np.zeros((8, 2)), material=material)
    return trimesh.Scene(box)


def _gltf() -> bytes:
    """A glTF file with all its data in itself, and a light."""
    files = trimesh.exchange.gltf.export_gltf(_model(), embed_buffers=True)
    tree = json.loads(files["model.gltf"])
    tree["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "spot", "intensity": 5, "color": [1, 1, 0.5]}]}}
    tree["nodes"].append({"translation": [1, 2, 3], "extensions": {"KHR_lights_punctual": {"light": 0}}})
    tree["scenes"][0]["nodes"].append(len(tree["nodes"]) - 1)
    return json.dumps(tree).encode()


def seeds() -> dict[str, bytes]:
    """Files by their names; each is a scene of its own."""
    box = trimesh.creation.box((1, 2, 3))
    return {
        "a.aff": AFF,
        "a.obj": OBJ,
        "a.ply": PLY,
        "b.ply": box.export(file_type="ply"),
        "c.ply": _polygons(),
        "a.stl": STL,
        "b.stl": box.export(file_type="stl"),
        "a.gltf": _gltf(),
        "a.glb": trimesh.exchange.gltf.export_glb(_model()),
    }


def write_beside(folder: Path) -> None:
    """The files that seeds refer to."""
    (folder / "picture.png").write_bytes(picture())
    (folder / "part.aff").write_bytes(b"s 1 1 1 0.2\n")
    (folder / "a.mtl").write_bytes(MTL)
