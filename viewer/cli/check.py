"""The command `check`: whether saved pictures and figures are still what the program makes of what they carry."""

from __future__ import annotations

import json
import tempfile
from argparse import Namespace
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tracer import fingerprint
from tracer.geometry.world import World
from tracer.method import Method
from tracer.renderer import Renderer
from tracer.scene.edits import Edits, edited
from tracer.scene.files import read_regular
from tracer.scene.load import load_visible_scene
from tracer.scene.mesh_options import MeshOptions
from tracer.scene.model import Scene, SceneError
from tracer.settings import Settings
from tracer.text import printable
from tracer.version import program_version
from viewer.cli import options
from viewer.cli.arguments import FAILED, Parser
from viewer.cli.console import Work, working
from viewer.output import capture, exr
from viewer.output.commands import BUILT, CHANCE
from viewer.output.comparison import comparison_of, text_of_pdf
from viewer.services import stills
from viewer.services.scene_files import find_scene
from viewer.state import codec
from viewer.state.methods import NO_CULLING
from viewer.state.view_state import ViewState, Warmup
from viewer.state.views import View
from viewer.util.messages import ERROR, in_one_line

KINDS = (".png", exr.ENDING, ".pdf")
ROUNDING = 2  # of 255, by which a GPU may draw a view otherwise
EPILOG = """\
examples:
  shadowcull check figure.png
  shadowcull check paper/*.png paper/methods.pdf

A picture carries its scene, camera, time, settings, view and the frames that its modes came from. It is true if it is
the same again, bit for bit; a view that a GPU has drawn may be off by rounding. Otherwise the line says how many
pixels differ, and what has changed since: a part of the scene, the version, or the file itself. Files that cannot be
read, or carry nothing of this program, are errors. The exit code is 0 only if all are true.
"""


def parser() -> Parser:
    description = "Render saved pictures and figures again, and say of each whether it is still true."
    parser = Parser("check", description, EPILOG)
    help_ = "a .png or .exr that this program saved, or a .png or .pdf of figure"
    parser.add_argument("pictures", nargs="+", type=Path, metavar="FILE", help=help_)
    options.add_folders(parser)
    options.add_settings(parser, Settings, "threads")
    return parser


def run(given: Namespace) -> int:
    """Check all files, and print a line for each, an error for those that cannot be read."""
    good = True
    with working() as work:
        checker = Checker(given, work)
        for number, path in enumerate(given.pictures):
            work.count(f"checking {path.name}", number, len(given.pictures))
            try:
                data, kept = read(path)
            except (ValueError, OSError, SyntaxError) as error:  # the last is Pillow's
                why = in_one_line(error if str(path) in str(error) else f"{path}: {error}")
                work.note(f"{ERROR}{why}")
                good = False
                continue
            try:
                verdict = checker.verdict(path, data, kept)
            except (SceneError, ValueError, OSError) as error:
                verdict = Verdict(None, in_one_line(error).removeprefix(f"{path}: "))
            good &= verdict.true is True
            print(printable(f"{path}: {verdict}"), flush=True)
    return 0 if good else FAILED


class Verdict(NamedTuple):
    """Whether a file is true, None where that cannot be told, and why."""

    true: bool | None
    text: str

    def __str__(self) -> str:
        return f"{ {True: 'true', False: 'FALSE', None: 'unknown'}[self.true] }: {self.text}"


def read(path: Path) -> tuple[Mapping[str, Any], NDArray[Any]]:
    """Return what a file carries, and what is compared of it: pixels (h, w, 3), of an EXR as floats, or a PDF's bytes.

    Raises ValueError or OSError, in one line."""
    ending = path.suffix.lower()
    if not path.exists():
        raise ValueError(f"{path}: no such file")
    if ending == exr.ENDING:
        exr.check()
        color, data = exr.read(path)
        return data, color
    if ending == ".pdf":
        file = read_regular(path)
        text = text_of_pdf(file)
        if text is None:
            raise ValueError(f"{path}: a PDF, but not a figure of Shadowcull")
        return json.loads(text), np.frombuffer(file, np.uint8)
    if ending != ".png" and path.is_file():
        raise ValueError(f"{path}: check reads PNG and EXR pictures, and figures as PNG or PDF")
    return capture.read_data(path), _pixels(path.read_bytes())


def _pixels(file: bytes) -> NDArray[np.uint8]:
    with Image.open(BytesIO(file), formats=("PNG",)) as image:
        return np.asarray(image.convert("RGB"))


class Checker:
    """Checks one file after another; a scene that several have in common is read once."""

    def __init__(self, given: Namespace, work: Work) -> None:
        self._given, self._work = given, work
        self._scene: Scene | None = None
        self._read = lru_cache(1)(self._read_scene)

    def verdict(self, path: Path, data: Mapping[str, Any], kept: NDArray[Any]) -> Verdict:
        """Make it again and compare; raises SceneError, ValueError or OSError, in one line, where that cannot be."""
        again = self._again(path, data, kept)
        ending, size = path.suffix.lower(), f"{kept.shape[1]} × {kept.shape[0]}" if kept.ndim > 1 else ""
        if kept.shape == again.shape and (kept == again).all():
            same = {".pdf": "byte for byte", exr.ENDING: f"{size}, the colours bit for bit"}
            return Verdict(True, same.get(ending, f"{size}, bit for bit"))
        if ending == ".pdf":
            words = "the file is another"
        elif kept.shape != again.shape:
            words = f"it has {size} pixels, and {again.shape[1]} × {again.shape[0]} when made again"
        else:
            differ = (kept != again).any(axis=-1)
            words = f"{int(differ.sum()):,} of {differ.size:,} pixels differ"
            if ending == ".png":
                most = int(np.abs(kept.astype(np.int16) - again).max())
                words += f", by {most} of 255 at most"
                if most <= ROUNDING and data.get("picture", {}).get("by_gpu"):
                    return Verdict(True, f"{size}, but for the rounding of the GPU that drew it: {words}")
        return Verdict(False, f"{words}; {self._since(data, kept if ending == '.png' else None)}")

    def _again(self, path: Path, data: Mapping[str, Any], kept: NDArray[Any]) -> NDArray[Any]:
        """What `read` would give of the file, were it made now."""
        if "figure" in data:
            file = self._figure(path, data)
            return np.frombuffer(file, np.uint8) if kept.ndim == 1 else _pixels(file)
        if data.get("picture", {}).get("style", {}).get("annotations"):
            raise ValueError("arrows, boxes or words are drawn on it, which are not drawn any more")
        if data.get("window"):
            raise ValueError("it shows two pictures, or the window with its panels, which cannot be rendered again")
        wanted = codec.picture_from_json(data)
        linear = kept.dtype != np.uint8
        unknown = bool(wanted.warmup.unknown and not wanted.warmup.modes)
        if unknown and (linear or wanted.draw.view is not View.COLOR or wanted.draw.savings is not None):
            raise ValueError(_not_again(wanted))
        # What nobody can learn again may not show: then it is the picture with every shadow ray traced.
        traced = replace(wanted.with_settings(method=NO_CULLING), warmup=Warmup()) if unknown else wanted
        scene, traced = self._prepared(path, traced, (traced.settings.method,))
        stills.check_light(traced, scene)

        def tell(done: int, frames: int) -> None:
            self._work.count(f"{path.name}, frame {done + 1} of {frames}", done, frames)

        renderer = Renderer(scene, traced.settings, self._work.progress)
        frame = stills.trace(renderer, traced, on_frame=tell, cancelled=self._work.cancelled)
        pixels = frame.color.astype(kept.dtype) if linear else stills.draw(frame, scene, traced)[0]
        if unknown and not np.array_equal(pixels, kept):
            raise ValueError(_not_again(wanted))
        return pixels

    def _figure(self, path: Path, data: Mapping[str, Any]) -> bytes:
        """The file of a figure, made again."""
        state = codec.picture_from_json(data)
        wanted = comparison_of(data["figure"], state.size)
        scene, state = self._prepared(path, state, wanted.methods)
        world = World(scene, state.time, state.settings.accelerator, self._work.progress)

        def tell(method: str, done: int, frames: int) -> None:
            self._work.count(f"{path.name}, {method}, frame {done + 1} of {frames}", done, frames)

        shown = stills.trace_methods(scene, state, wanted, world, tell, self._work.cancelled)
        with tempfile.TemporaryDirectory() as folder:
            again = Path(folder) / f"again{path.suffix.lower()}"
            # What it carries is what the other carried: times and versions are of then.
            stills.save_methods(shown, again, json.dumps(data))
            return again.read_bytes()

    def _prepared(self, path: Path, wanted: ViewState, methods: tuple[str, ...]) -> tuple[Scene, ViewState]:
        """The scene, and the state with the path that it has now; raises ValueError where it is gone."""
        found = find_scene(str(wanted.scene), path)
        if found is None:
            raise ValueError(f"its scene is gone: {wanted.scene}")
        scene = self._scene = self._read(found, wanted.meshes, wanted.edits)
        options.prepare_kernels(self._work, len(scene.lights), wanted.settings.accelerator, *methods)
        start, end = scene.time_range
        if not start <= wanted.time <= end:
            raise ValueError(f"its time, {wanted.time:g} s, is none of the scene's any more")
        wanted = wanted.with_settings(threads=wanted.settings.threads or self._given.threads)
        return scene, replace(wanted, scene=str(found))

    def _read_scene(self, path: Path, meshes: MeshOptions, edits: Edits) -> Scene:
        return edited(load_visible_scene(path, self._work.progress, self._given.folder, meshes), edits).scene

    def _since(self, data: Mapping[str, Any], kept: NDArray[np.uint8] | None) -> str:
        """What has changed since a file was made, in words; `kept` are the pixels of one that says their code."""
        made, found = data.get("made"), []
        if not isinstance(made, Mapping) or self._scene is None:
            return "it does not say what it was made of"
        was, now = made.get("scene", {}), fingerprint.of_scene(self._scene)
        parts = [part for part, code in now.items() if isinstance(was, Mapping) and was.get(part) != code]
        if parts:
            found.append(f"the scene's {' and '.join(filter(None, [', '.join(parts[:-1]), parts[-1]]))}")
        if made.get("version") != program_version():
            found.append(f"the version, {made.get('version')} then and {program_version()} now")
        if kept is not None and "pixels" in made and made["pixels"] != fingerprint.of_pixels(kept):
            found.append("the file's own pixels")
        if not found:
            return "nothing that it was made of has changed, so the program has, or the libraries it draws with"
        return f"changed since: {'; '.join(found)}"


def _not_again(wanted: ViewState) -> str:
    """Why a picture cannot be made again, and how to save one that can."""
    if wanted.warmup.unknown in (CHANCE, BUILT):
        way = "a picture of the view color can be made again" if Method.parse(wanted.settings.method).exact else ""
    else:
        way = "Backspace in the window forgets all modes: what is saved after it can be made again"
    return f"it cannot be made again: {wanted.warmup.unknown}{f'; {way}' if way else ''}"
