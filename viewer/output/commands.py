"""A state as the options of `shadowcull render` that make its picture again, and whether that can be.

Modes come from the frames before, and certificates and caches as well.  A picture that shows them can be made again
where those frames are known (`ViewState.warmup`).  Where they are not, `warmup.unknown` says why, in words; a saved
picture then carries the modes themselves, where they are all that it depends on besides its state."""

from __future__ import annotations

import base64
import json
import math
import zlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from tracer.method import Method
from tracer.scene.load import AFF_EXTENSIONS
from tracer.scene.mesh_options import MeshOptions
from tracer.scene.model import Scene
from tracer.util.setting import settings_of
from viewer.state import codec
from viewer.state.draw_options import DrawOptions
from viewer.state.session import Session
from viewer.state.view_state import ViewState, as_options
from viewer.state.views import Record, View
from viewer.util import resources

CHANCE = "what is certified depends on time and threads"


def needs_history(state: ViewState) -> bool:
    """Return whether frames before it show in the picture of a state."""
    method, view = Method.parse(state.settings.method), state.draw.view
    of_culling = view in (View.CERTIFICATE, View.SLACK) or (
        view.records in (Record.WORK, Record.FATES) and method.culls
    )
    return of_culling or view.of_modes or state.draw.savings is not None or not method.exact


def chance(state: ViewState) -> str:
    """Return, in words, why chance has a part in a picture: what is certified within a limit of time, or by several
    threads, or what `auto` measures; empty where it has none."""
    method, settings = Method.parse(state.settings.method), state.settings
    limited = method.has_certificates and (math.isfinite(settings.certificate_seconds) or settings.threads != 1)
    by_chance = method.exact and not state.draw.view.of_modes and (limited or method.adaptive)
    return CHANCE if by_chance and needs_history(state) else ""


def by_one_thread(state: ViewState) -> bool:
    """Return whether it takes a single thread to make the picture of a state again."""
    return state.settings.threads == 1 and Method.parse(state.settings.method).has_certificates and needs_history(state)


def words(state: ViewState, scene: Scene | None, output: str, folders: Sequence[Path] = ()) -> list[str]:
    """Return the words after `shadowcull` that make the picture of a state again, to the bit; `scene` names frames by
    their numbers, `folders` are those that it may read files from besides its own."""
    found = ["render", scene_word(Path(state.scene)), "-o", f"./{output}" if output.startswith("-") else output]
    found += options(state, scene)
    for folder in folders:
        found += ["--folder", str(folder.absolute())]
    return found


def options(state: ViewState, scene: Scene | None = None) -> list[str]:
    """Return what a state says beside its scene as options of `render`."""
    settings, draw, warmup = state.settings, state.draw, state.warmup
    found = ["--size", f"{settings.width}x{settings.height}", *_moment(state.time, scene)]
    found += ["--method", settings.method, *_view(state)]
    if state.camera is not None:
        found += ["--camera", json.dumps(state.camera.to_json())]
    for one in settings_of(ViewState):
        counts = by_one_thread(state) if one.path == "settings.threads" else state.applies(one)
        if one.path not in NOT_PLAIN and counts:
            found += one.words(one.get(state))
    for option, count in (("--warmup", warmup.of_path), ("--repeat", warmup.repeats)):
        found += [option, str(count)] if count else []
    if draw.legend and draw.legend_at != DrawOptions().legend_at:
        found += ["--legend-at", f"{draw.legend_at[0]!r},{draw.legend_at[1]!r}"]
    if draw.span is not None:
        found += [f"--range={draw.span[0]!r}:{draw.span[1]!r}"]
    if draw.savings is not None:
        found += [f"--savings={draw.savings}"] if draw.savings else ["--savings"]
    if draw.caption:
        found += [f"--caption={draw.caption.replace('{', '{{').replace('}', '}}')}"]
    if warmup.frames:
        found += ["--before", codec.text(warmup.frames)]
    found += as_options(state.edits)
    return found + ([] if Path(state.scene).suffix.lower() in AFF_EXTENSIONS else mesh_options(state.meshes))


NOT_PLAIN = {"settings.method", "draw.view", "draw.spans", "draw.legend_at", "draw.savings", "draw.caption"}
"""Settings whose options take more, or else, than a plain value."""


def _view(state: ViewState) -> list[str]:
    """The view with its light, its line or its shares."""
    draw, view = state.draw, state.draw.view
    light = f":{state.edits.light_number(draw.light)}" if view.of_light else ""
    line = f":{draw.wipe!r}" if view is View.WIPE else ""
    shares = ":share" if view.records is Record.WORK and draw.shares else ""
    return [] if view is View.COLOR else ["--view", f"{view.value}{light}{line}{shares}"]


def mesh_options(meshes: MeshOptions) -> list[str]:
    """Return the options that ask for how a mesh is read."""
    up = [f"--up={meshes.up}"] if meshes.up is not None else []
    crease = [f"--crease={meshes.crease!r}"] if meshes.crease is not None else []
    return [*up, *crease, *([] if meshes.studio else ["--no-studio"])]


def scene_word(path: Path) -> str:
    """Return what names a scene on the command line: of one that comes with the program its name, else where its file
    is."""
    own = {file.resolve(): name for name, file in resources.embedded_scenes().items()}
    return own.get(path.resolve()) or str(path.absolute())


def _moment(time: float, scene: Scene | None) -> list[str]:
    """The number of the frame where it is one's time to the bit, else the time."""
    if scene is not None and scene.frame_time(number := Session(scene).frame_at(time)) == time:
        return ["--frame", str(number)]
    return [f"--time={time!r}"]


# --- modes that a picture carries ------------------------------------------------------------------

LARGEST_MODES = 1 << 20
"""Bytes of their text, at most: pictures of more modes do without them."""


def packed(frame: Frame, state: ViewState) -> str:
    """What `unpacked` makes the modes of again; empty where they are not needed, or do not suffice: other methods learn
    more, and views of modes show what the frame itself has taught, which depends on more."""
    method = Method.parse(state.settings.method)
    by_modes_alone = method.uses_modes and len(method.kinds) == 1 and not state.draw.view.of_modes
    if not (state.warmup.unknown and by_modes_alone and needs_history(state)):
        return ""
    words = np.ascontiguousarray(frame.modes_before)
    text = base64.b64encode(zlib.compress(words.astype(words.dtype.newbyteorder("<")).tobytes(), 6)).decode()
    return text if len(text) <= LARGEST_MODES else ""


def unpacked(text: str, units: int, word: np.dtype) -> NDArray[np.unsignedinteger]:
    """(units,) words; raises ValueError, in one line, where the text is no such modes."""
    size = units * word.itemsize
    try:
        inflating = zlib.decompressobj()
        data = inflating.decompress(base64.b64decode(text, validate=True), size + 1)
    except (ValueError, zlib.error):
        raise ValueError("its modes are damaged") from None
    if len(data) != size or not inflating.eof:
        raise ValueError(f"its modes are not those of {units:,} primitives, as the scene has them now")
    return np.frombuffer(data, word.newbyteorder("<")).astype(word)
