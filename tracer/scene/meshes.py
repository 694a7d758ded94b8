"""Scenes from mesh files (OBJ, PLY, STL, glTF, GLB), read by trimesh; large ones of plain triangles in parts.

Such files say little of how a surface shines in a Whitted world, and most have neither camera
nor lights.  Colours and textures are kept as they would be displayed; roughness and metalness
become a diffuse and a mirror part; where the file has none, a camera that frames the model and two
lights are added, or a studio around it.
"""

from __future__ import annotations

import logging
import warnings
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path
from threading import get_ident
from typing import Any

import numpy as np

from tracer.scene.animation import Animation
from tracer.scene.arrays import Float32, Float64, Report, vector
from tracer.scene.assembly import Geometry
from tracer.scene.binary_meshes import BinaryMesh, read_binary
from tracer.scene.bounds import bounds
from tracer.scene.crease import creased_normals
from tracer.scene.files import SceneFiles, read_regular
from tracer.scene.limits import LARGEST, MOST_NESTED, MOST_PRIMITIVES
from tracer.scene.memory_check import check_reading
from tracer.scene.mesh_materials import MaterialTable
from tracer.scene.mesh_options import AS_IN_FILE, CREASE, MeshOptions
from tracer.scene.model import Camera, Progress, Scene, SceneError
from tracer.scene.pieces import IndexedMesh, Mesh, Piece
from tracer.scene.ply import with_even_lists, with_strips
from tracer.scene.punctual_lights import has_lights, punctual_lights
from tracer.scene.studio import build_studio, framing_camera, framing_lights, with_floor
from tracer.scene.textures import only_known_images, open_image
from tracer.scene.up_axis import guess

MESH_EXTENSIONS = (".obj", ".ply", ".stl", ".gltf", ".glb")
ONLY_MESH = "geometry_0"
"""What trimesh calls the mesh of a file that has one without a name."""


@dataclass(frozen=True)
class _MeshPlace:
    """A triangle of a named mesh; these formats do not say in which line."""

    path: Path
    mesh: str

    @property
    def source(self) -> Hashable:
        return self.path

    @property
    def part(self) -> str:
        return self.mesh

    def __call__(self, item: int = 0) -> str:
        return f"{self.path}: {self.mesh!a}, triangle {item}"


def load_mesh(
    path: str | Path, progress: Progress | None = None, folders: Iterable[Path] = (), options: MeshOptions = AS_IN_FILE
) -> Scene:
    """A mesh file as a static scene; raises SceneError in one line that names the file.

    What it refers to lies below its folder or one of `folders`."""
    path = Path(path)
    report = progress or (lambda what, fraction: None)
    report(f"Reading {path.name}", 0.0)
    table, geometry = MaterialTable(path), Geometry()
    try:
        binary = read_binary(path, _part(report, f"Reading {path.name}", 0.0, 0.5))
        if binary is not None:
            model, own_camera, alone, head, notes = None, None, options.studio, binary.head, list[str]()
        else:
            check_reading(path, whole=True)  # its first face may have looked as if parts would do
            model, notes, head = _read(path, SceneFiles(path, folders))
            own_camera = _own_camera(model)
            alone = options.studio and own_camera is None and not has_lights(model)
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror or error}; check it") from None
    crease = _crease(options, alone, path)
    if binary is not None:
        geometry.meshes.append(_piece_of_binary(binary, path, table, crease, report))
        del binary
    else:
        notes += _add_pieces(model, path, table, geometry, crease, report)
    objects, remarks = geometry.objects((), lambda: report(f"Putting {path.name} together", 0.9))
    if not len(objects[0].triangles):
        remarks.append(f"{path}: no triangle; only the background is seen")
    box = bounds(objects, Animation.empty(), 0.0)
    camera = own_camera or framing_camera(box)
    lights, dark = punctual_lights(model, path, objects, box) if model is not None else ((), [])
    del model, geometry  # a studio needs room of its own
    report(f"Putting {path.name} together", 0.95)
    scene = Scene(
        path=path,
        objects=objects,
        materials=tuple(table.materials),
        textures=tuple(table.textures),
        lights=lights or framing_lights(box, camera),
        camera=camera,
        animation=Animation.empty(),
        background=(0.6, 0.7, 0.8),
        warnings=(*notes, *table.warnings, *remarks, *dark),
    )
    del objects
    if not alone or box is None:
        return scene
    return _in_studio(scene, options.up, head, lambda: report(f"Setting {path.name} in a studio", 0.95))


def _part(report: Progress, what: str, begin: float, end: float) -> Report:
    """What is told of a part of the work, from 0 to 1, as one of all of it."""
    return lambda done: report(what, begin + (end - begin) * done)


def _add_pieces(
    model: Any, path: Path, table: MaterialTable, geometry: Geometry, crease: float, report: Progress
) -> list[str]:
    """Add what is in a trimesh scene to a geometry; returns warnings."""
    nodes = list(model.graph.nodes_geometry)
    skipped = []
    for i, node in enumerate(nodes):
        begin, end = 0.5 + 0.35 * i / len(nodes), 0.5 + 0.35 * (i + 1) / len(nodes)
        report(f"Reading {path.name}", begin)
        matrix, name = model.graph[node]
        mesh = model.geometry[name]
        if not hasattr(mesh, "faces") or not len(mesh.faces):
            skipped.append(f"{path}: {name!a} has no triangles; it is left out")
            continue
        smoothing = _part(report, f"Smoothing {path.name}", begin, end)
        for shape, material, texture in _shapes(mesh, _MeshPlace(path, name), table, crease, smoothing):
            geometry.meshes.append(Piece(shape, (np.asarray(matrix, np.float64),), material, texture))
    return skipped


def _piece_of_binary(
    mesh: BinaryMesh, path: Path, table: MaterialTable, crease: float, report: Progress
) -> Piece[Mesh | IndexedMesh]:
    normals = mesh.normals
    if normals is None and crease > 0:
        smoothing = _part(report, f"Smoothing {path.name}", 0.5, 0.85)
        normals = creased_normals(mesh.vertices, mesh.faces, crease, smoothing, mesh.place)
    shape = IndexedMesh(mesh.vertices, mesh.faces, _MeshPlace(path, ONLY_MESH), normals)
    return Piece(shape, (), table.plain())


def _in_studio(scene: Scene, up: str | None, head: bytes, report: Callable[[], None]) -> Scene:
    """The scene with floor, camera and lamps around its triangles; `head` is how its file begins."""
    static = scene.objects[0]
    corners = static.triangles.corners
    report()
    studio = build_studio(corners, up or guess(scene.path, head, corners), len(scene.materials), report)
    return replace(
        scene,
        objects=(with_floor(static, studio.floor, report), *scene.objects[1:]),
        materials=(*scene.materials, studio.material),
        lights=studio.lights,
        camera=studio.camera,
        background=studio.background,
    )


def _crease(options: MeshOptions, alone: bool, path: Path) -> float:
    """The crease angle in degrees, where the file has no normals; its maker's word goes before ours: glTF asks for
    sharp edges there."""
    if options.crease is not None:
        return options.crease
    return CREASE if alone and path.suffix.lower() not in (".gltf", ".glb") else 0.0


def _read(path: Path, files: SceneFiles) -> tuple[Any, list[str], bytes]:
    """The trimesh scene in a file, warnings of what it refers to and could not be read, and how the file begins."""
    import trimesh  # here, because it takes a while that other scenes need not wait for

    class Beside(trimesh.resolvers.Resolver):
        """Reads what a mesh file refers to.  Failures, over which trimesh passes in silence, become warnings."""

        def __init__(self) -> None:
            pass

        def get(self, name: str) -> bytes:
            if kind.lower() == "gltf" and name == "model.gltf":  # tried where the file itself is no JSON
                raise FileNotFoundError(name)
            shown = f"{name[:80]!a}"
            # Files of other machines have paths of those: the name alone may be found beside the mesh.
            wanted = (path.parent / part for part in (name.strip(), name.strip().lstrip("/"), Path(name).name))
            try:
                data = files.read(next(w for w in wanted if files.holds(w) and w.is_file()))
                if Path(name).suffix.lower() not in (".mtl", ".bin"):
                    open_image(BytesIO(data)).close()
            except SceneError as error:
                troubles.append(f"{path}: texture {shown}: {error}; the surface keeps its material colour")
                raise
            except (OSError, ValueError, RuntimeError, StopIteration):  # among them circles of links, and nothing found
                troubles.append(f"{path}: {shown}, which it refers to, cannot be read; put it beside the file")
                raise SceneError(troubles[-1]) from None
            return data

        def keys(self) -> list[str]:
            return []

        def namespaced(self, namespace: str) -> Beside:
            return self

        def write(self, name: str, data: str | bytes) -> None:
            raise PermissionError(name)

    troubles: list[str] = []
    kind = path.suffix[1:]
    data = read_regular(path)
    try:
        with quiet(), only_known_images():
            readable = with_even_lists(data) if kind.lower() == "ply" else data
            model = trimesh.load_scene(BytesIO(readable), file_type=kind.lower(), resolver=Beside(), process=False)
            model = with_strips(model)
            _check_nesting(model.graph.transforms.parents, path)
            triangles = 0
            for node in model.graph.nodes_geometry:
                mesh = model.geometry[model.graph[node][1]]
                if hasattr(mesh, "faces"):
                    _check(mesh, path)
                    triangles += len(mesh.faces)
        if triangles > MOST_PRIMITIVES:
            raise SceneError(f"{path}: more than {MOST_PRIMITIVES} triangles; make it simpler")
    except SceneError:
        raise
    except Exception:  # trimesh lets whatever its parsers raise on broken files through
        what = f"cannot be read as {kind.upper()}: it is damaged or incomplete"
        raise SceneError(f"{path}: {what}; repair or convert the file") from None
    return model, list(dict.fromkeys(troubles)), data[:1024]


@contextmanager
def quiet() -> Iterator[None]:
    """Without what trimesh, numpy and Pillow say of a file to the terminal: it is judged by us."""
    log, here = logging.getLogger("trimesh.util"), get_ident()

    def elsewhere(record: logging.LogRecord) -> bool:
        return record.thread != here

    log.addFilter(elsewhere)
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            yield
    finally:
        log.removeFilter(elsewhere)


def _check_nesting(parents: Mapping[str, str], path: Path) -> None:
    """Raise SceneError where nodes lie too deep below each other; each would be placed by all matrices above it."""
    depths: dict[str, int] = {}
    for node in parents:
        way: list[str] = []
        while node in parents and node not in depths and len(way) <= MOST_NESTED:
            way.append(node)
            node = parents[node]
        depths |= {passed: depth for depth, passed in enumerate(reversed(way), depths.get(node, 0) + 1)}
    if max(depths.values(), default=0) > MOST_NESTED:
        raise SceneError(f"{path}: more than {MOST_NESTED} nodes around each other; make it simpler")


def _check(mesh: Any, path: Path) -> None:
    """Raise SceneError where the arrays of a mesh are not of the shapes that belong together."""
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    if vertices.ndim != 2 or vertices.shape[1:] != (3,) or vertices.dtype.kind not in "fiu":
        raise SceneError(f"{path}: a vertex has not three coordinates; repair the file")
    if faces.ndim != 2 or faces.shape[1:] != (3,) or faces.dtype.kind not in "iu":
        raise SceneError(f"{path}: a face is no triangle; convert the file")
    if len(faces) and (faces.min() < 0 or faces.max() >= len(vertices)):
        raise SceneError(f"{path}: a triangle refers to a vertex that is not there; repair the file")


def _shapes(
    mesh: Any, place: _MeshPlace, table: MaterialTable, crease: float, report: Report
) -> Iterator[tuple[IndexedMesh, int, int]]:
    """Parts of one material each, with its number and that of the texture; `crease` is the angle in degrees up to which
    edges are rounded where there are no normals."""
    vertices, faces = np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int64)
    normals: Float32 | Float64 | None = _of_vertices(_vertex_normals(mesh), (len(vertices), 3))
    if normals is None and crease > 0:
        normals = creased_normals(vertices, faces, crease, report)
    uvs = _of_vertices(getattr(mesh.visual, "uv", None), (len(vertices), 2))
    for which, material, texture in table.parts(mesh, place()):
        of_corners = normals is not None and normals.ndim == 3
        some = normals[which] if normals is not None and of_corners else normals
        yield IndexedMesh(vertices, faces[which], place, some, uvs), material, texture if uvs is not None else -1


def _of_vertices(values: Any, shape: tuple[int, int]) -> Float64 | None:
    """Numbers of vertices (k, ...), where they are of the shape that is expected."""
    return None if values is None or np.shape(values) != shape else np.asarray(values, np.float64)


def _vertex_normals(mesh: Any) -> Float64 | None:
    """(vertices, 3) where the file itself has normals: made-up ones would round every edge."""
    if "vertex_normals" in mesh._cache:
        return np.asarray(mesh.vertex_normals, np.float64)
    try:  # PLY keeps its own columns
        data = mesh.metadata["_ply_raw"]["vertex"]["data"]
        normals = np.stack([np.asarray(data[axis], np.float64).reshape(-1) for axis in ("nx", "ny", "nz")], axis=1)
    except (KeyError, TypeError, ValueError, IndexError):
        return None
    return normals if len(normals) == len(mesh.vertices) else None


def _own_camera(model: Any) -> Camera | None:
    """The file's camera, which looks along its own -z, where it has a usable one."""
    if not model.has_camera:
        return None
    placed = np.asarray(model.camera_transform, np.float64)
    direction, up, angle = -placed[:3, 2], placed[:3, 1], float(model.camera.fov[1])
    if not ((np.abs(placed) <= LARGEST).all() and direction.any() and 0.0 < angle < 180.0):
        return None
    return Camera(vector(placed[:3, 3]), vector(direction), vector(up), angle)
