"""The command `check`: whether saved pictures and figures are still what the program makes of what they carry."""

from __future__ import annotations

import math
import tempfile
from argparse import Namespace
from dataclasses import replace
from functools import lru_cache
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.editing.edits import Edits, edited
from tracer.geometry.world import World
from tracer.method import Method
from tracer.renderer import Renderer
from tracer.scene import fingerprint
from tracer.scene.files import read_regular
from tracer.scene.load import load_visible_scene
from tracer.scene.mesh_options import MeshOptions
from tracer.scene.model import Scene, SceneError
from tracer.scene.textures import open_image
from tracer.settings import Settings
from tracer.util.text import printable
from tracer.util.version import program_version
from viewer.cli import options
from viewer.cli.arguments import FAILED, Parser
from viewer.cli.console import Work, working
from viewer.output import capture, exr
from viewer.output.capture import Carried
from viewer.output.commands import CHANCE
from viewer.output.comparison import comparison_of, text_of_pdf
from viewer.services import stills
from viewer.services.scene_files import find_scene
from viewer.state.methods import NO_CULLING
from viewer.state.plans import MOST_PICTURE_PIXELS
from viewer.state.view_state import ViewState, Warmup
from viewer.state.views import View
from viewer.util.messages import ERROR, in_one_line, one_line

MOST_PIXELS = MOST_PICTURE_PIXELS * 5 // 4
"""Of a picture with all that is written above and below it."""
EPILOG = """\
examples:
  shadowcull check figure.png
  shadowcull check paper/*.png paper/methods.pdf

A picture carries its scene, camera, time, settings, view and the frames that its modes came from. It is true if it is
the same again, bit for bit. Otherwise the line says how many pixels differ, and what has changed since: a part of the
scene, the version, or the file itself. Files that cannot be read, or carry nothing of this program, are errors. The
exit code is 0 only if all are true.
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
                carried, kept = read(path)
            except (ValueError, OSError, SyntaxError) as error:  # the last is Pillow's
                why = one_line(error) if isinstance(error, OSError) else in_one_line(error)
                why = why if str(path) in why else in_one_line(f"{path}: {why}")
                work.note(f"{ERROR}{why}")
                good = False
                continue
            try:
                true, words = checker.verdict(path, carried, kept)
                verdict = f"{'true' if true else 'FALSE'}: {words}"
            except (SceneError, ValueError, OSError) as error:
                true, verdict = False, f"unknown: {in_one_line(error).removeprefix(f'{path}: ')}"
            good &= true
            print(printable(f"{path}: {verdict}"), flush=True)
    return 0 if good else FAILED


def read(path: Path) -> tuple[Carried, NDArray[Any]]:
    """Return what a file carries, and what is compared of it: pixels (h, w, 3), of an EXR as floats, or a PDF's bytes.

    Raises ValueError or OSError, in one line."""
    ending = path.suffix.lower()
    if not path.exists():
        raise ValueError(f"{path}: no such file")
    if ending == exr.ENDING:
        exr.check()
        color, carried = exr.read(path)
        return carried, color
    if ending == ".pdf":
        file = read_regular(path)
        text = text_of_pdf(file)
        if text is None:
            raise ValueError(f"{path}: a PDF, but not a figure of Shadowcull")
        return capture.carried_from_text(path, text), np.frombuffer(file, np.uint8)
    if ending != ".png" and path.is_file():
        raise ValueError(f"{path}: check reads PNG and EXR pictures, and figures as PNG or PDF")
    carried = capture.read_carried(path)
    return carried, _pixels(path.read_bytes(), math.inf if carried.figure is not None else MOST_PIXELS)


def _pixels(file: bytes, most: float = math.inf) -> NDArray[np.uint8]:
    with open_image(BytesIO(file), ("PNG",)) as image:
        if image.width * image.height > most:
            raise ValueError(f"{image.width} x {image.height} pixels: no picture of Shadowcull has so many")
        return np.asarray(image.convert("RGB"))


class Checker:
    """Checks one file after another; a scene that several have in common is read once."""

    def __init__(self, given: Namespace, work: Work) -> None:
        self._given, self._work = given, work
        self._scene: Scene | None = None
        self._read = lru_cache(1)(self._read_scene)

    def verdict(self, path: Path, carried: Carried, kept: NDArray[Any]) -> tuple[bool, str]:
        """Make a file again and compare; return whether it is the same, and in words what is.

        Raises SceneError, ValueError or OSError, in one line, where it cannot be made again."""
        make_again = self._picture_again if carried.figure is None else self._figure_again
        again = make_again(path, carried, kept)
        if kept.ndim == 1:
            same, size, different = "byte for byte", "", "the PDF differs"
        else:
            size, other = (f"{one.shape[1]} × {one.shape[0]}" for one in (kept, again))
            same = f"{size}, {'the colours ' if path.suffix.lower() == exr.ENDING else ''}bit for bit"
            different = f"it has {size} pixels, and {other} when rendered again"
        if np.array_equal(kept, again):
            return True, same
        if kept.shape == again.shape and kept.ndim > 1:
            differ = (kept != again).any(axis=-1)
            different = f"{int(differ.sum()):,} of {differ.size:,} pixels differ"
            if kept.dtype == np.uint8:
                different += f", by {int(np.abs(kept.astype(np.int16) - again).max())} of 255 at most"
        return False, f"{different}; {self._since(carried, kept)}"

    def _picture_again(self, path: Path, carried: Carried, kept: NDArray[Any]) -> NDArray[Any]:
        """What `read` would give of a picture, were it made now."""
        if carried.window:
            raise ValueError("it shows two pictures, or the window with its panels, which cannot be rendered again")
        wanted = carried.view_state()
        linear = kept.dtype != np.uint8
        unknown = bool(wanted.warmup.unknown and not wanted.warmup.modes)
        if unknown and (linear or wanted.draw.view is not View.COLOR or wanted.draw.savings is not None):
            raise ValueError(_not_again(wanted))
        # What nobody can learn again may not show: then it is the picture with every shadow ray traced.
        traced = replace(wanted.with_settings(method=NO_CULLING), warmup=Warmup()) if unknown else wanted
        scene, traced = self._prepared(path, traced, (traced.settings.method,))
        stills.check_lights(traced, scene)

        def tell(done: int, frames: int) -> None:
            self._work.count(f"{path.name}, frame {done + 1} of {frames}", done, frames)

        renderer = Renderer(scene, traced.settings, self._work.progress)
        frame = stills.trace(renderer, traced, on_frame=tell, cancelled=self._work.cancelled)
        pixels = frame.color.astype(kept.dtype) if linear else stills.draw(frame, scene, traced)[0]
        if unknown and not np.array_equal(pixels, kept):
            raise ValueError(_not_again(wanted))
        return pixels

    def _figure_again(self, path: Path, carried: Carried, kept: NDArray[Any]) -> NDArray[Any]:
        """The same of a figure."""
        state = carried.view_state()
        wanted = comparison_of(carried.figure, state.size)
        scene, state = self._prepared(path, state, wanted.methods)
        world = World(scene, state.time, state.settings.accelerator, self._work.progress)

        def tell(method: str, done: int, frames: int) -> None:
            self._work.count(f"{path.name}, {method}, frame {done + 1} of {frames}", done, frames)

        shown = stills.trace_methods(scene, state, wanted, world, tell, self._work.cancelled)
        with tempfile.TemporaryDirectory() as folder:
            again = Path(folder) / f"again{path.suffix.lower()}"
            # A PDF carries what the other carried, to the letter: times and versions are of then.
            stills.save_methods(shown, again, text_of_pdf(kept.tobytes()) or "")
            file = again.read_bytes()
        return np.frombuffer(file, np.uint8) if kept.ndim == 1 else _pixels(file)

    def _prepared(self, path: Path, wanted: ViewState, methods: tuple[str, ...]) -> tuple[Scene, ViewState]:
        """The scene, and the state with the path that it has now; raises ValueError where it is gone."""
        found = find_scene(str(wanted.scene), path)
        if found is None:
            raise ValueError(f"its scene is gone: {wanted.scene}")
        scene = self._scene = self._read(found, wanted.meshes, wanted.edits)
        options.prepare_kernels(self._work, len(scene.lights), wanted.settings.accelerator, *methods)
        start, end = scene.time_range
        if not start <= wanted.time <= end:
            raise ValueError(f"it shows {wanted.time:g} s, and the scene's time now runs from {start:g} to {end:g} s")
        wanted = wanted.with_settings(threads=wanted.settings.threads or self._given.threads)
        return scene, replace(wanted, scene=str(found))

    def _read_scene(self, path: Path, meshes: MeshOptions, edits: Edits) -> Scene:
        return edited(load_visible_scene(path, self._work.progress, self._given.folder, meshes), edits).scene

    def _since(self, carried: Carried, kept: NDArray[Any]) -> str:
        """What has changed since a file was made, in words."""
        made, found = carried.made, []
        if made is None or self._scene is None:
            return "it does not say what it was made of"
        now = fingerprint.of_scene(self._scene)
        parts = [part for part, code in now.items() if made.scene.get(part) != code]
        if parts:
            found.append(f"the scene's {' and '.join(filter(None, [', '.join(parts[:-1]), parts[-1]]))}")
        if made.version != program_version():
            found.append(f"the version, {made.version} then and {program_version()} now")
        if made.pixels and kept.dtype == np.uint8 and made.pixels != fingerprint.of_pixels(kept):
            found.append("the file's own pixels")
        if not found:
            return "nothing that it was made of has changed, so the program has, or the libraries it draws with"
        return f"changed since: {'; '.join(found)}"


def _not_again(wanted: ViewState) -> str:
    """Why a picture cannot be made again, and how to save one that can."""
    if wanted.warmup.unknown == CHANCE:
        way = "a picture of the view color can be made again" if Method.parse(wanted.settings.method).exact else ""
    else:
        way = "Backspace in the window forgets all modes: what is saved after it can be made again"
    return f"it cannot be made again: {wanted.warmup.unknown}{f'; {way}' if way else ''}"
