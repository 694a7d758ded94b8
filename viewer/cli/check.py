"""The command `check`: whether saved pictures and figures are still what the program makes of what they carry."""

from __future__ import annotations

import json
import tempfile
from argparse import Namespace
from collections.abc import Mapping
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tracer import fingerprint
from tracer.frame import Frame
from tracer.geometry.world import World
from tracer.method import Method
from tracer.renderer import Renderer
from tracer.scene.edits import Edits, edited
from tracer.scene.files import read_regular
from tracer.scene.load import load_visible_scene
from tracer.scene.mesh_options import MeshOptions
from tracer.scene.model import Cancelled, Scene, SceneError
from tracer.settings import Settings
from tracer.version import program_version
from viewer.cli import options
from viewer.cli.arguments import FAILED, Parser
from viewer.cli.console import Work, working
from viewer.output import capture, exr
from viewer.output.commands import BUILT, CHANCE
from viewer.output.comparison import comparison_of, text_of_pdf
from viewer.services import comparison, stills
from viewer.services.scene_files import find_scene
from viewer.state import codec
from viewer.state.methods import NO_CULLING
from viewer.state.view_state import ViewState, Warmup
from viewer.state.views import View
from viewer.util.messages import ERROR, in_one_line, printable

KINDS = {".png": b"\x89PNG\r\n\x1a\n", ".pdf": b"%PDF-", exr.ENDING: b"\x76\x2f\x31\x01"}
"""How a file of each kind that is checked begins."""
ROUNDING = 2  # of 255, by which a GPU may draw a view otherwise
EPILOG = """\
examples:
  shadowcull check figure.png
  shadowcull check paper/*.png paper/methods.pdf

A picture carries its scene, camera, time, settings, view and the frames that its modes came from. It is true if it is
the same again, bit for bit; a view that a GPU has drawn may be off by rounding. Otherwise the line says how many
pixels differ, and what has changed since: a part of the scene, the version, or the file itself. Files that are
missing, or none of these kinds, are errors. The exit code is 0 only if all are true.
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
                verdict = checker.check(path)
            except (ValueError, OSError) as error:
                work.note(f"{ERROR}{path}: {_why(error)}")
                good = False
                continue
            good &= verdict.true is True
            print(printable(f"{path}: {verdict}"), flush=True)
    return 0 if good else FAILED


@dataclass(frozen=True)
class Verdict:
    """Whether a file is true, None where that cannot be told, and why."""

    true: bool | None
    text: str

    def __str__(self) -> str:
        return f"{ {True: 'true', False: 'FALSE', None: 'unknown'}[self.true] }: {self.text}"


class Checker:
    """Checks one file after another; a scene that several have in common is read once."""

    def __init__(self, given: Namespace, work: Work) -> None:
        self._given, self._work = given, work
        self._scene: tuple[tuple[Path, MeshOptions, Edits], Scene] | None = None
        self._world: tuple[str, World] | None = None

    def check(self, path: Path) -> Verdict:
        """Raises Cancelled, and ValueError or OSError for a file that cannot be read, or is of no kind that can be
        checked; every other failure is a verdict."""
        kind = _kind_of(path)
        try:
            return {".pdf": self._check_pdf, exr.ENDING: self._check_exr}.get(kind, self._check_png)(path)
        except Cancelled:
            raise
        except (SceneError, ValueError, OSError) as error:
            text = in_one_line(error)
            return Verdict(None, text.removeprefix(f"{path}: "))

    def _check_png(self, path: Path) -> Verdict:
        data = capture.read_data(path)
        with Image.open(BytesIO(read_regular(path)), formats=("PNG",)) as image:
            kept = np.asarray(image.convert("RGB"))
        if "figure" in data:
            again = self._figure(path, data, ".png")
            with Image.open(BytesIO(again), formats=("PNG",)) as image:
                return self._compared(kept, np.asarray(image.convert("RGB")), data, {}, False)
        if data.get("picture", {}).get("style", {}).get("annotations"):
            return Verdict(None, "arrows, boxes or words are drawn on it, which are not drawn any more")
        if data.get("window"):
            return Verdict(None, "it shows two pictures, or the window with its panels, which cannot be rendered again")
        wanted = self._wanted(data)
        forgotten = wanted.warmup.unknown and not wanted.warmup.modes
        if forgotten and wanted.draw.view is View.COLOR and wanted.draw.savings is None:
            return self._against_tracing_all(path, kept, wanted)
        frame, wanted = self._traced(path, wanted)
        pixels, _ = stills.draw(frame, self._open_scene, wanted)
        return self._compared(
            kept, pixels, data, frame.statistics.to_dict(), bool(data.get("picture", {}).get("by_gpu"))
        )

    def _against_tracing_all(self, path: Path, kept: NDArray[np.uint8], wanted: ViewState) -> Verdict:
        """What can be said of a picture whose modes nobody can learn again: where it is not that without culling."""
        settings = replace(wanted.settings, method=NO_CULLING)
        frame, plain = self._traced(path, replace(wanted, settings=settings, warmup=Warmup()))
        pixels, _ = stills.draw(frame, self._open_scene, plain)
        if pixels.shape != kept.shape:
            raise ValueError(_not_again(wanted))
        apart = np.abs(kept.astype(np.int16) - pixels.astype(np.int16)).max(axis=-1)
        differ, most = int((apart > 0).sum()), int(apart.max(initial=0))
        if not differ:
            return Verdict(True, "bit for bit the picture with every shadow ray traced: nothing of its culling shows")
        return Verdict(
            None,
            f"but for {differ:,} of {apart.size:,} pixels it is the picture with every shadow ray traced; these differ "
            f"by {most} of 255 at most, which culling may have done: {_not_again(wanted)}",
        )

    def _wanted(self, data: Mapping[str, Any]) -> ViewState:
        """Return the state that a picture carries; raises ValueError in one line."""
        return codec.picture_from_json(data)

    def _traced(self, path: Path, wanted: ViewState) -> tuple[Frame, ViewState]:
        """The frame of a picture, once more; raises ValueError, in one line, where that cannot be."""
        if wanted.warmup.unknown and not wanted.warmup.modes:
            raise ValueError(_not_again(wanted))
        scene, wanted = self._prepared(path, wanted, (wanted.settings.method,))
        stills.check_light(wanted, scene)
        renderer = Renderer(scene, wanted.settings, world=self._world_of(scene, wanted))

        def tell(done: int, frames: int) -> None:
            self._work.count(f"{path.name}, frame {done + 1} of {frames}", done, frames)

        return stills.trace(renderer, wanted, on_frame=tell, cancelled=self._work.cancelled), wanted

    @property
    def _open_scene(self) -> Scene:
        assert self._scene is not None
        return self._scene[1]

    def _check_exr(self, path: Path) -> Verdict:
        """By its linear colours, as they are kept: with 32 bits, or with 16."""
        exr.check()
        kept, data = exr.read(path)
        frame, _ = self._traced(path, self._wanted(data))
        color = frame.color.astype(kept.dtype)
        size = f"{kept.shape[1]} × {kept.shape[0]}"
        if kept.shape != color.shape:
            return Verdict(False, f"it has {size} pixels; {self._since(data, None)}")
        differ = int((kept != color).any(axis=-1).sum())
        if not differ:
            return Verdict(True, f"{size}, the colours bit for bit")
        since = self._since(data, None) + _counted(data.get("statistics"), frame.statistics.to_dict())
        return Verdict(False, f"the colours of {differ:,} of {color[..., 0].size:,} pixels differ; {since}")

    def _check_pdf(self, path: Path) -> Verdict:
        kept = read_regular(path)
        text = text_of_pdf(kept)
        if text is None:
            return Verdict(None, "a PDF, but not a figure of Shadowcull")
        data = json.loads(text)
        if self._figure(path, data, ".pdf") == kept:
            return Verdict(True, "byte for byte")
        return Verdict(False, f"the file is another; {self._since(data, None)}")

    def _figure(self, path: Path, data: Mapping[str, Any], ending: str) -> bytes:
        """The file of a figure, made again."""
        state = codec.picture_from_json(data)
        wanted = comparison_of(data["figure"], state.size)
        scene, state = self._prepared(path, state, wanted.methods)

        def tell(method: str, done: int, frames: int) -> None:
            self._work.count(f"{path.name}, {method}, frame {done + 1} of {frames}", done, frames)

        shown = comparison.trace(scene, state, wanted, self._world_of(scene, state), tell, self._work.cancelled)
        with tempfile.TemporaryDirectory() as folder:
            again = Path(folder) / f"again{ending}"
            # What it carries is what the other carried: times and versions are of then.
            comparison.save(shown, again, json.dumps(data))
            return again.read_bytes()

    def _prepared(self, path: Path, wanted: ViewState, methods: tuple[str, ...]) -> tuple[Scene, ViewState]:
        """Return the scene, read, and the state with the path that it has now; raises ValueError where it is gone."""
        found = find_scene(str(wanted.scene), path)
        if found is None:
            raise ValueError(f"its scene is gone: {wanted.scene}")
        if self._scene is None or self._scene[0] != (found, wanted.meshes, wanted.edits):
            read = load_visible_scene(found, self._work.progress, self._given.folder, wanted.meshes)
            self._scene = (found, wanted.meshes, wanted.edits), edited(read, wanted.edits).scene
            self._world = None
        scene = self._scene[1]
        options.prepare_kernels(self._work, len(scene.lights), wanted.settings.accelerator, *methods)
        settings = replace(wanted.settings, threads=wanted.settings.threads or self._given.threads)
        start, end = scene.time_range
        if not start <= wanted.time <= end:
            raise ValueError(f"its time, {wanted.time:g} s, is none of the scene's any more")
        return scene, replace(wanted, scene=str(found), settings=settings)

    def _world_of(self, scene: Scene, wanted: ViewState) -> World:
        accelerator = wanted.settings.accelerator
        if self._world is None or self._world[0] != accelerator:
            self._world = accelerator, World(scene, wanted.time, accelerator, self._work.progress)
        return self._world[1]

    def _compared(
        self,
        kept: NDArray[np.uint8],
        again: NDArray[np.uint8],
        data: Mapping[str, Any],
        statistics: Mapping[str, Any],
        by_gpu: bool,
    ) -> Verdict:
        size = f"{kept.shape[1]} × {kept.shape[0]}"
        if kept.shape != again.shape:
            now = f"{again.shape[1]} × {again.shape[0]}"
            return Verdict(False, f"it has {size} pixels, and {now} when made again; {self._since(data, kept)}")
        apart = np.abs(kept.astype(np.int16) - again.astype(np.int16)).max(axis=-1)
        differ, most = int((apart > 0).sum()), int(apart.max(initial=0))
        if not differ:
            return Verdict(True, f"{size}, bit for bit")
        words = f"{differ:,} of {apart.size:,} pixels differ, by {most} of 255 at most"
        if by_gpu and most <= ROUNDING:
            return Verdict(True, f"{size}, but for the rounding of the GPU that drew it: {words}")
        return Verdict(False, f"{words}; {self._since(data, kept)}{_counted(data.get('statistics'), statistics)}")

    def _since(self, data: Mapping[str, Any], kept: NDArray[np.uint8] | None) -> str:
        """What has changed since a file was made, in words."""
        made = data.get("made")
        if not isinstance(made, Mapping) or self._scene is None:
            return "it does not say what it was made of"
        found = []
        was, now = made.get("scene", {}), fingerprint.of_scene(self._scene[1])
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


def _counted(then: Any, now: Mapping[str, Any]) -> str:
    """The counters of shadow rays that are others than then."""
    if not isinstance(then, Mapping) or not now:
        return ""
    was, counts = then.get("shadow", {}), now["shadow"]
    names = [name for name in ("due", "culled", "dynamic_only") if was.get(name) != counts[name]]
    told = ", ".join(f"{name.replace('_', ' ')} {was.get(name):,} then, {counts[name]:,} now" for name in names)
    return f"; shadow rays {told}" if told else ""


def _kind_of(path: Path) -> str:
    """The ending of the kind that a file's first bytes say it is of.

    Raises ValueError, in one line, for another kind, and OSError for a file that cannot be read."""
    data = read_regular(path)
    for ending, start in KINDS.items():
        if data.startswith(start):
            return ending
    raise ValueError("not a file that can be checked; check reads PNG and EXR pictures, and figures as PNG or PDF")


def _why(error: Exception) -> str:
    """Why a file cannot be read."""
    if isinstance(error, FileNotFoundError):
        return "no such file"
    return getattr(error, "strerror", None) or str(error)
