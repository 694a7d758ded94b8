"""A figure that can be explored: one HTML file, with a picture in which a reader clicks pixels.

The page (`explorable.html`) draws views from what frames say of each pixel.  All is in the file, deflated; nothing is
fetched.  A notebook shows a frame by the same page, with what that frame has recorded.
"""

from __future__ import annotations

import base64
import json
import shlex
import zlib
from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.fate import Fate
from tracer.frame import Frame, counters
from tracer.geometry.rays import ray_batch
from tracer.geometry.world import World
from tracer.inspect.projection import seen_at
from tracer.inspect.why_in_words import primitive_in_words
from tracer.method import Method
from tracer.scene.lights import light_in_words, named_light
from tracer.scene.model import Scene
from viewer.output import commands
from viewer.output.comparison import Crop, Shown
from viewer.state.palette import FATES, OCCLUSION, SHADOW, Class, color_map
from viewer.state.session import Session
from viewer.state.views import Record
from viewer.util.files import write_text
from viewer.util.numbers import several

ENDING = ".html"
RECORDS = tuple(Record)  # of a frame: all that views show
MOST_PIXELS, MOST_LIGHTS = 640 * 480, 8
HEIGHT = 760  # pixels of a notebook that a page takes
_BETWEEN = 1e-4  # of the way from a light: nearer to either end lies the lamp itself, or the surface that is asked


def check(width: int, height: int, crops: Sequence[Crop] = ()) -> None:
    """Raise ValueError, in one line, for a picture that makes too large a file, and for crops, which no page has."""
    if crops:
        raise ValueError("--crops: a page has none; give a .png or .pdf")
    if width * height > MOST_PIXELS:
        raise ValueError(f"{width} x {height} pixels make too large a file: {MOST_PIXELS:,} at most (--size)")


def save(shown: Shown, world: World, path: Path) -> None:
    """Write the page; raises OSError in one line.  The frames have recorded all of RECORDS."""
    write_text(path, _page(page_data(shown, world)))


class Page(NamedTuple):
    """A page as a notebook shows it, in a frame of its own; `html` is the file."""

    html: str

    def _repr_html_(self) -> str:
        return f'<iframe srcdoc="{escape(self.html)}" width="100%" height="{HEIGHT}" style="border:0"></iframe>'


def page_of_frame(frame: Frame, scene: Scene | None = None) -> Page:
    """Return the page of one frame alone, with names if its scene is given; raises ValueError for too large a one."""
    check(frame.width, frame.height)
    name = frame.settings.method
    data = _about(frame, scene, [], f"{frame.time:.3f} s, {frame.width} × {frame.height}, {Method.parse(name).title}")
    return Page(_page(data | {"methods": [_method(name, frame, counters(frame.statistics))]}))


def _page(data: dict[str, Any]) -> str:
    text = Path(__file__).with_suffix(ENDING).read_text(encoding="utf-8")
    return text.replace("/*DATA*/null", json.dumps(data, separators=(",", ":")).replace("<", "\\u003c"), 1)


def page_data(shown: Shown, world: World) -> dict[str, Any]:
    """Return what the page is given, as JSON has it."""
    scene, state, frame = shown.scene, shown.state, shown.reference
    positions = scene.light_positions(frame.time)
    in_the_way = [blockers(frame, world, positions, light) for light in range(min(frame.lights, MOST_LIGHTS))]
    number = Session(scene).frame_at(state.time)
    before = f", with what {several(shown.warmed, 'earlier frame')} taught" if shown.warmed else ""
    words = ["shadowcull", "figure", _scene_word(scene.path), "-o", "figure.html"]
    data = _about(frame, scene, in_the_way, f"{scene.path.name}, frame {number}{before}")
    data["caption"], data["view"] = shown.comparison.words or state.draw.caption, state.draw.view.value
    options = commands.options(state.with_draw(caption=""), scene)
    at = options.index("--method")  # which is of one method, and of one view
    data["command"] = shlex.join([*words, "--methods", ",".join(shown.frames), *options[:at], *options[at + 2 :]])
    for name in dict.fromkeys(["none", *shown.frames]):
        one = shown.frames.get(name, frame)
        counts = Shown(scene, state, shown.comparison, {name: one}, frame).counts(name)
        data["methods"].append(_method(name, one, counts))
    return data


def _about(frame: Frame, scene: Scene | None, in_the_way: list[NDArray[np.int32]], title: str) -> dict[str, Any]:
    """What the page is told of what all methods share."""
    lights, left_out = min(frame.lights, MOST_LIGHTS), max(frame.lights - MOST_LIGHTS, 0)
    seen = [int(k) for k in np.unique([frame.primitive, *in_the_way]) if k >= 0]
    return {
        "title": title, "caption": "", "command": "", "view": "color", "methods": [],
        "note": f"{several(left_out, 'further light')} left out" if left_out else "",
        "width": frame.width, "height": frame.height,
        "lights": [named_light(scene.lights, k) if scene else light_in_words(k, "") for k in range(lights)],
        "primitives": {k: primitive_in_words(scene, k) if scene else f"primitive {k}" for k in seen},
        "primitive": _deflated(frame.primitive, np.int32),
        "blockers": [_deflated(blocker, np.int32) for blocker in in_the_way],
        "classes": {"occlusion": _classes(OCCLUSION), "shadow": _classes(SHADOW), "fate": _classes(FATES)},
        "away": int(Fate.FACES_AWAY),
        "colors": np.round(255 * color_map()).astype(int).tolist(),
    }  # fmt: skip


def _scene_word(path: Path) -> str:
    """As commands name a scene, but from the folder of the moment where it is in there: pages are given to others."""
    word, here = commands.scene_word(path), Path.cwd()
    word = str(Path(word).relative_to(here)) if Path(word).is_relative_to(here) else word
    return f"./{word}" if word.startswith("-") else word


def _method(name: str, frame: Frame, counts: Sequence[Sequence[str]]) -> dict[str, Any]:
    """What the page is told of a method."""
    lights, of_modes = range(min(frame.lights, MOST_LIGHTS)), frame.settings.keeps_modes
    return {
        "name": name, "title": Method.parse(name).title, "counts": counts,
        "pixels": _deflated(np.diff(frame.pixels.reshape(-1, 3), axis=0, prepend=np.uint8(0)), np.uint8),
        "occlusion": _deflated(frame.occlusion_mode, np.uint8) if of_modes else "",
        "shadow": [_deflated(frame.shadow_mode[..., k], np.uint8) for k in lights] if of_modes else [],
        "fate": [_deflated(frame.fate(k), np.uint8) for k in lights] if frame.fates is not None else [],
        "traced": _deflated(frame.cost, np.int32), "due": _deflated(frame.due_rays, np.int32),
        "untraced": _deflated(frame.saved, np.int32), "wrong": _deflated(frame.wrong, np.int32),
    }  # fmt: skip


def blockers(frame: Frame, world: World, lights: NDArray[np.float64], light: int) -> NDArray[np.int32]:
    """(h, w) the first primitive from the middle of one of lights (l, 3) towards what each pixel shows; -1 where the
    light gets there, or is not due."""
    assert frame.asked is not None and frame.reached is not None
    y, x = np.nonzero((frame.primitive >= 0) & (frame.asked[..., light] > 0) & (frame.reached[..., light] == 0))
    starts = np.repeat(lights[light : light + 1], len(x), 0)
    rays = ray_batch(starts, seen_at(frame, x, y) - starts, _BETWEEN, 1.0 - _BETWEEN)
    found = np.full(frame.primitive.shape, -1, np.int32)
    found[y, x] = world.closest_hits(rays).primitive
    return found


def _classes(classes: dict[Any, Class]) -> list[dict[str, Any]]:
    return [
        {"name": c.name, "color": [round(255 * x) for x in c.color], "meaning": c.meaning} for c in classes.values()
    ]


def _deflated(values: NDArray[Any] | Iterable[Any] | None, kind: type) -> str:
    """Numbers, little-endian, as the page inflates them; nothing for None."""
    if values is None:
        return ""
    data = np.ascontiguousarray(values, np.dtype(kind).newbyteorder("<")).tobytes()
    return base64.b64encode(zlib.compress(data, 9)).decode()
