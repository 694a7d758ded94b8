"""Reading AFF, the Animated File Format of BART, and its subset NFF.

An AFF file is a program: statements change a current material and a stack of transforms, include
other files, and emit geometry.  `_Reader` runs it, one method per statement.  The current
material is global: neither a closing brace nor the end of an included file restores it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from time import perf_counter

import numpy as np

from tracer.scene import aff_statements, rotations
from tracer.scene.aff_statements import FoundLight, dimmed, read_lamp, read_light, settled
from tracer.scene.aff_tokens import AffFile, Cursor, quoted, reason
from tracer.scene.animation import Animation, Chain, TrackSet
from tracer.scene.arrays import vector
from tracer.scene.assembly import Geometry
from tracer.scene.bounds import bounds
from tracer.scene.files import SceneFiles
from tracer.scene.limits import MOST_FRAMES, MOST_INCLUDES, MOST_NESTED, MOST_PRIMITIVES
from tracer.scene.model import Camera, Material, Progress, Scene, SceneError
from tracer.scene.pieces import Mesh, Piece, Quadric
from tracer.scene.studio import framing_camera
from tracer.scene.textures import TextureTable

SECONDS_BETWEEN_REPORTS = 0.02


def load_aff(
    path: str | Path, progress: Progress | None = None, detail: int | None = None, folders: Iterable[Path] = ()
) -> Scene:
    """An AFF or NFF scene with everything it includes.

    `detail` overrides what the file says with `d`; all that it names lies below its folder or one of `folders`.  Raises
    SceneError, in one line that names file and line, and lets what `progress` raises (Cancelled) through.
    """
    reader = _Reader(Path(path), progress, detail, folders)
    reader.run()
    return reader.scene()


class _Reader:
    """The state of a scene while its files are run."""

    def __init__(self, path: Path, progress: Progress | None, detail: int | None, folders: Iterable[Path]) -> None:
        self.path = path
        self.scene_files = SceneFiles(path, folders)
        self.progress = progress
        self.reported = 0.0
        self.detail_is_fixed = detail is not None
        self.detail = detail or 0
        self.files: dict[Path, AffFile] = {}
        self.including: list[AffFile] = []  # the file that is being run comes last
        self.includes = 0  # that were run
        self.nested = 0  # transforms around here
        self.primitives = 0
        self.chain: Chain = ()
        self.geometry = Geometry()
        self.materials: list[Material] = []
        self.material = -1
        self.textures = TextureTable(path, self.scene_files)
        self.tracks: dict[str, TrackSet] = {}
        self.lights: list[FoundLight] = []
        self.camera: Camera | None = None
        self.background = (0.0, 0.0, 0.0)
        self.ambient = (1.0, 1.0, 1.0)
        self.time_range = (0.0, 0.0)
        self.frames = 1
        self.statements: dict[bytes, Callable[[Cursor], None]] = {
            b"b": self.read_background,
            b"v": self.read_viewpoint,
            b"l": self.read_light,
            b"la": lambda at: self.read_light(at, at.name("the name of a light")),
            b"lamp": lambda at: self.lights.append(read_lamp(at, self.chain, len(self.lights))),
            b"am": self.read_ambient,
            b"a": self.read_animation,
            b"f": self.read_fill,
            b"fm": self.read_extended_fill,
            b"c": lambda at: self.add_quadric(aff_statements.read_cone(at)),
            b"s": lambda at: self.add_quadric(aff_statements.read_sphere(at)),
            b"p": lambda at: self.add_mesh(aff_statements.read_polygon(at, False)),
            b"pp": lambda at: self.add_mesh(aff_statements.read_polygon(at, True)),
            b"tt": lambda at: self.add_mesh(aff_statements.read_textured_triangle(at, False)),
            b"ttp": lambda at: self.add_mesh(aff_statements.read_textured_triangle(at, True)),
            b"tpa": self.read_morph,
            b"m": lambda at: self.add_mesh(aff_statements.read_mesh(at)),
            b"d": self.read_detail,
            b"k": self.read_tracks,
        }

    # Running files

    def run(self) -> None:
        try:
            file = self.open(self.path)
        except (OSError, ValueError) as error:
            raise SceneError(f"{self.path}: cannot be read: {reason(error)}; check the path") from None
        if not file.words:
            raise SceneError(f"{self.path}:1: the file is empty; give a scene with at least one statement")
        with np.errstate(all="ignore"):  # shapes of numbers that overflow are dropped at the end
            self.run_file(file, 0.0, 1.0)

    def open(self, path: Path) -> AffFile:
        """The words of a file, split once however often it is included; raises OSError or ValueError."""
        resolved = path.resolve()
        if resolved not in self.files:
            self.files[resolved] = AffFile(path, self.scene_files.read(path))
        return self.files[resolved]

    def run_file(self, file: AffFile, low: float, high: float) -> None:
        """Run a file whose share of the progress is low to high; includes take equal parts of it."""
        self.including.append(file)
        share = (high - low) / max(1, file.words.count(b"i"))
        has_includes = b"i" in file.words
        done = low
        opened: list[tuple[Chain, int]] = []  # what to return to at each '}', and where its '{' stands
        at = Cursor(file)
        while not at.at_end:
            within = done if has_includes else low + (high - low) * at.position / len(file.words)
            self.report(f"Reading {file.path.name}", min(within, high))  # sums of shares may be a little more
            word = at.word("a statement")
            if word == b"}":
                if not opened:
                    raise at.error("'}' that closes nothing; remove it or open a brace before it")
                self.chain = opened.pop()[0]
                self.nested -= 1
            elif word in (b"x", b"xs"):
                if self.nested == MOST_NESTED:
                    raise at.error(f"more than {MOST_NESTED} transforms around each other; write fewer")
                self.nested += 1
                before = self.chain
                self.chain = self.read_transform(at) if word == b"xs" else (*before, at.name("the name of a transform"))
                at.expect(b"{", "of a transform")
                opened.append((before, at.position - 1))
            elif word == b"i":
                self.include(at, done, done + share)
                done += share
            elif word in self.statements:
                self.statements[word](at)
            else:
                raise at.error(f"unknown statement {quoted(word)}; correct it, or check that this is an AFF file")
        if opened:
            raise at.error("'{' that is never closed; add '}'", opened[-1][1])
        self.including.pop()

    def report(self, what: str, fraction: float) -> None:
        if self.progress is not None and (now := perf_counter()) - self.reported > SECONDS_BETWEEN_REPORTS:
            self.reported = now
            self.progress(what, min(fraction, 1.0))

    def include(self, at: Cursor, low: float, high: float) -> None:
        level = at.count("detail levels", least=-(10**9))
        name = at.name("the name of a file")
        if level > self.detail:
            return
        path = at.file.path.parent / name
        try:
            file = self.open(path)
        except (OSError, ValueError) as error:
            what = f"the included file {name!a} cannot be read: {reason(error)}"
            raise at.error(f"{what}; add it or correct the name") from None
        if file in self.including:
            raise at.error(f"{name!a} includes itself; break the circle")
        self.includes += 1
        if self.includes > MOST_INCLUDES or len(self.including) > MOST_NESTED:
            raise at.error(
                f"more than {MOST_INCLUDES} files are included, or {MOST_NESTED} by each other; include fewer"
            )
        self.run_file(file, low, high)

    # Statements

    def read_background(self, at: Cursor) -> None:
        self.background = at.triple("the background")

    def read_ambient(self, at: Cursor) -> None:
        self.ambient = at.triple("the ambient light")

    def read_detail(self, at: Cursor) -> None:
        level = at.count("detail levels", least=-(10**9))
        if not self.detail_is_fixed:
            self.detail = level

    def read_animation(self, at: Cursor) -> None:
        start, end = at.numbers(2, "the time range").tolist()
        self.frames = at.count("frames", least=1, most=MOST_FRAMES)
        self.time_range = (start, end)

    def read_viewpoint(self, at: Cursor) -> None:
        """`hither` and `resolution` are read and ignored: a ray tracer starts at the eye, and has its own size."""
        counts = {b"from": 3, b"at": 3, b"up": 3, b"angle": 1, b"hither": 1, b"resolution": 2}
        given: dict[bytes, list[float]] = {}
        start = at.position - 1
        while at.peek() in counts:
            key = at.word("a viewpoint")
            given[key] = at.numbers(counts[key], f"{key.decode()} of the viewpoint").tolist()
        for key in (b"from", b"at"):
            if key not in given:
                raise at.error(f"the viewpoint has no '{key.decode()}'; add it", start)
        direction = np.subtract(given[b"at"], given[b"from"])
        if not direction.any():
            raise at.error("the viewpoint looks at itself; make 'from' and 'at' differ", start)
        angle = given.get(b"angle", [45.0])[0]
        if not 0.0 < angle < 180.0:
            raise at.error(f"an angle of {angle:g} degrees; give one between 0 and 180", start)
        up = vector(given.get(b"up", [0.0, 1.0, 0.0]))
        self.camera = Camera(vector(given[b"from"]), vector(direction), up, angle)

    def read_light(self, at: Cursor, name: str | None = None) -> None:
        self.lights.append(read_light(at, self.chain, len(self.lights), name))

    def read_fill(self, at: Cursor) -> None:
        """NFF knows a colour, Kd, Ks and no ambient: diffuse is Kd times the colour, highlights and
        mirror images are white times Ks, and a tenth of the diffuse colour serves as ambient.
        Shine is the Phong exponent itself."""
        start = at.position - 1
        r, g, b, kd, ks, shine, transmission, ior = at.numbers(8, "a material").tolist()
        diffuse = (kd * r, kd * g, kd * b)
        ambient = (0.1 * diffuse[0], 0.1 * diffuse[1], 0.1 * diffuse[2])
        self.use_material(at.file, start, Material("", ambient, diffuse, (ks, ks, ks), shine, transmission, ior))

    def read_extended_fill(self, at: Cursor) -> None:
        start = at.position - 1
        ambient, diffuse, specular = (at.triple(f"the {part} colour") for part in ("ambient", "diffuse", "specular"))
        shine, transmission, ior = at.numbers(3, "a material").tolist()
        self.use_material(at.file, start, Material("", ambient, diffuse, specular, 4 * shine, transmission, ior))

    def use_material(self, file: AffFile, index: int, material: Material) -> None:
        name = f"{file.path.stem}:{file.line(index)}"
        self.materials.append(replace(material, name=name, ior=material.ior if material.ior > 0 else 1.0))
        self.material = len(self.materials) - 1

    def read_transform(self, at: Cursor) -> Chain:
        """The chain within `xs`: T R S, merged with a matrix before it."""
        numbers = at.numbers(10, "a transform")
        matrix = np.eye(4)
        matrix[:3, :3] = rotations.matrices(rotations.from_axes(numbers[None, 3:6], numbers[6:7]))[0] * numbers[:3]
        matrix[:3, 3] = numbers[7:]
        if self.chain and not isinstance(self.chain[-1], str):
            return (*self.chain[:-1], self.chain[-1] @ matrix)
        return (*self.chain, matrix)

    def read_tracks(self, at: Cursor) -> None:
        name = at.name("the name of tracks")
        self.tracks[name] = aff_statements.read_tracks(at)

    # Geometry

    def current_material(self) -> int:
        """The number of the current material; a white one where none was given yet."""
        if self.material < 0:
            self.materials.append(Material("default"))
            self.material = 0
        return self.material

    def count(self, primitives: int) -> None:
        """Add to the number of primitives, or refuse to."""
        self.primitives += primitives
        if self.primitives > MOST_PRIMITIVES:
            file = self.including[-1]
            raise SceneError(f"{file.path}: more than {MOST_PRIMITIVES} triangles, spheres and cones; make it simpler")

    def add_mesh(self, mesh: Mesh) -> None:
        self.count(len(mesh.corners))
        texture = -1 if mesh.texture is None else self.textures.number(mesh.texture, self.including[-1].path)
        self.geometry.meshes.append(Piece(mesh, self.chain, self.current_material(), texture))

    def add_quadric(self, quadric: Quadric) -> None:
        self.count(1)
        self.geometry.quadrics.append(Piece(quadric, self.chain, self.current_material()))

    def read_morph(self, at: Cursor) -> None:
        self.count(1)
        self.geometry.morphs.append(Piece(aff_statements.read_morph(at), self.chain, self.current_material()))

    # The end

    def scene(self) -> Scene:
        found = dimmed(self.lights) if self.path.suffix.lower() == ".nff" else self.lights
        lights, left_out = settled(found, self.tracks)
        assembling = f"Reading {self.path.name}: putting it together"
        objects, remarks = self.geometry.objects(self.tracks, lambda: self.report(assembling, 1.0))
        animation = Animation(self.tracks)
        camera = self.camera
        if camera is None:
            camera = framing_camera(bounds(objects, animation, self.time_range[0]))
            remarks.append(f"{self.path}: no viewpoint (v); a camera that sees everything is used")
        if not lights:
            remarks.append(f"{self.path}: no light (l); only ambient light is seen")
        if not any(len(o.triangles) or len(o.quadrics) for o in objects):
            remarks.append(f"{self.path}: no triangle, sphere or cone; only the background is seen")
        return Scene(
            path=self.path,
            objects=objects,
            materials=tuple(self.materials),
            textures=tuple(self.textures.textures),
            lights=lights,
            camera=camera,
            animation=animation,
            background=self.background,
            ambient=self.ambient,
            time_range=self.time_range,
            frames=self.frames,
            warnings=(*left_out, *self.textures.warnings, *remarks),
        )
