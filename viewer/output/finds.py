"""Counterexamples: wrong pixels that a hunt has found, in words, as JSON, and as what a figure shows of them."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tracer.scene.model import Camera, Scene
from viewer.output.comparison_figure import Crop
from viewer.output.legend_parts import named_light
from viewer.output.recipe import scene_word
from viewer.state import earlier
from viewer.state.earlier import Earlier
from viewer.state.picking import primitive_in_words
from viewer.state.session import Session

PATH, AROUND = "path", "around"
"""Where a find is: on the path that was searched, or beside it."""
VISIBLE = 0.5 / 255.0
"""Differences below this are not seen on a screen of 8 bits."""


@dataclass(frozen=True)
class Find:
    """A wrong pixel (x, y), and what is wrong there.

    The pixel is `difference` (0 to 1, the largest of the three channels) from `reference`, the right colour; `color`
    is what the method shows, both linear RGB.  A shadow ray from `primitive`, which the pixel shows after `bounces`,
    to `light` got the answer `lit`, by `verdict`, the name of a `tracer.culling.verdicts.Verdict`; `blocker` is what
    is in the way, -1 for nothing; `more_lights` are wrong there in the same way.  `taught` is the number, among the
    frames before it, of that which taught it, -1 where that is not known, and `taught_time` its time.  Of the frame,
    `pixels` counts the wrong pixels, with a wrong answer or another colour, `answers` the wrong answers and
    `differing` the pixels whose colour is another.  `before` are the fewest frames before it that were found to make
    it, of `learnt_from` that really came before."""

    place: str
    time: float
    camera: Camera
    own_camera: bool
    x: int
    y: int
    difference: float
    color: tuple[float, float, float]
    reference: tuple[float, float, float]
    primitive: int
    light: int
    lit: bool
    verdict: str
    blocker: int
    bounces: int
    pixels: int
    answers: int = 0
    differing: int = 0
    more_lights: int = 0
    taught: int = -1
    taught_time: float | None = None
    before: tuple[Earlier, ...] = ()
    learnt_from: int = 0

    @property
    def key(self) -> tuple[int, int]:
        """Finds of the same primitive and light are the same mistake."""
        return self.primitive, self.light

    @property
    def seen_camera(self) -> Camera | None:
        """The camera, None where it is the scene's own."""
        return None if self.own_camera else self.camera


@dataclass
class Findings:
    """What a hunt has found: the worst finds first, and of how many frames and pixels.

    `wrong_pixels` and `wrong_frames` count those with a wrong answer.  `settings` are by name."""

    scene: str
    method: str
    size: tuple[int, int]
    settings: dict[str, Any]
    frames: int = 0
    pixels: int = 0
    wrong_pixels: int = 0
    wrong_frames: int = 0
    finds: list[Find] = field(default_factory=list)

    @property
    def summary(self) -> str:
        """How much was compared, and how much of it was wrong, in one line."""
        compared = f"{self.pixels:,} pixels of {self.frames:,} frame{'s' * (self.frames != 1)} compared"
        if not self.wrong_pixels:
            return f"{compared}: none is wrong"
        frames = f"{self.wrong_frames:,} frame{'s' * (self.wrong_frames != 1)}"
        wrong = f"{self.wrong_pixels:,} wrong pixel{'s' * (self.wrong_pixels != 1)}"
        return f"{compared}: {wrong}, in {frames}"


def where(find: Find, scene: Scene) -> str:
    """The frame of the path, or the one that it is beside."""
    session = Session(scene)
    number = f"frame {session.frame_at(find.time)}" if session.animated else "here"
    return number if find.place == PATH else f"beside {number}" if session.animated else "beside it"


def frame_of(find: Find, scene: Scene) -> str:
    """The number of that frame, in few words."""
    number = Session(scene).frame_at(find.time)
    return f"{number}" if find.place == PATH else f"near {number}"


def verdict_of(find: Find) -> str:
    """What culling goes by, such as "non shadow"."""
    return find.verdict.replace("_", " ").lower()


def taught(find: Find, scene: Scene) -> str:
    """The frame that taught the mode; "" where that is not known."""
    if find.taught_time is None:
        return ""
    session = Session(scene)
    return f"frame {session.frame_at(find.taught_time)}" if session.animated else f"picture {find.taught + 1}"


def light_of(find: Find, scene: Scene) -> str:
    """The light whose answer is wrong, and how many others are."""
    more = f" and {find.more_lights} more" if find.more_lights else ""
    return f"{named_light(scene.lights, find.light)}{more}"


def primitive_of(find: Find, scene: Scene) -> str:
    """The primitive, in few words."""
    return f"{find.primitive} of {scene.name_of(find.primitive)}"


def in_words(find: Find, scene: Scene) -> list[str]:
    """The pixel, the answer that is wrong, what is true, and where it was learnt: a sentence each."""
    brighter = sum(find.color) > sum(find.reference)
    seen = f", seen by {find.bounces} bounce{'s' * (find.bounces != 1)}" if find.bounces else ""
    said = [
        f"Pixel {find.x}, {find.y} is too {'bright' if brighter else 'dark'}, by {find.difference:.3f} of 1.",
        f"It shows {primitive_in_words(scene, find.primitive)}{seen}.",
    ]
    known, light = verdict_of(find), _capital(light_of(find, scene))
    counts = "count" if find.more_lights else "counts"
    if find.lit and find.blocker >= 0:
        by = "itself" if find.blocker == find.primitive else primitive_in_words(scene, find.blocker)
        first = "the first is" if find.more_lights else "is"
        said.append(f"{light} {counts} as reaching it ({known}), but {first} blocked by {by}.")
    else:
        way = "their" if find.more_lights else "its"
        said.append(f"{light} {counts} as blocked ({known}), but nothing is in {way} way.")
    if find.taught >= 0:
        said.append(f"That was learnt in {taught(find, scene)}.")
    return [*said, *_history(find)]


def in_its_frame(find: Find) -> str:
    """How many pixels and answers of its frame are wrong; a pixel has one answer for each light and bounce."""
    pixels = f"{find.pixels:,} pixel{'s are' if find.pixels != 1 else ' is'} wrong"
    answers = f"{find.answers:,} shadow answer{'s' * (find.answers != 1)}"
    colors = f"{find.differing:,} pixel{'s differ' if find.differing != 1 else ' differs'} in colour"
    return f"In this frame {pixels}, by {answers}; {colors}."


def _history(find: Find) -> list[str]:
    few, every = len(find.before), find.learnt_from
    if not every:
        return []
    if find.place == AROUND:
        return [f"The camera came there after {'that frame' if few == 1 else f'{few} frames'} of the path."]
    if few < every:
        return [f"The modes that {few} of {every} earlier frames left are enough to show it."]
    return [f"It shows with the modes that {few} earlier frame{'s' * (few != 1)} left."]


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def crop_of(find: Find, size: tuple[int, int]) -> Crop:
    """The surroundings of the pixel, inside the picture."""
    width, height = min(max(24, size[0] // 8), size[0]), min(max(18, size[1] // 8), size[1])
    x = min(max(find.x - width // 2, 0), size[0] - width)
    y = min(max(find.y - height // 2, 0), size[1] - height)
    return Crop(x, y, width, height)


def to_json(find: Find, scene: Scene) -> dict[str, Any]:
    """A find as JSON has it; `--before` of the commands takes the file."""
    blocker = None if find.blocker < 0 else primitive_in_words(scene, find.blocker)
    return {
        "place": find.place,
        "frame": Session(scene).frame_at(find.time),
        "time": find.time,
        "camera": find.camera.to_json(),
        "own_camera": find.own_camera,
        "pixel": [find.x, find.y],
        "difference": find.difference,
        "color": list(find.color),
        "reference": list(find.reference),
        "primitive": find.primitive,
        "primitive_name": primitive_in_words(scene, find.primitive),
        "light": find.light,
        "light_name": scene.lights[find.light].name,
        "answer": "lit" if find.lit else "blocked",
        "verdict": find.verdict,
        "blocker": None if find.blocker < 0 else find.blocker,
        "blocker_name": blocker,
        "bounces": find.bounces,
        "more_lights": find.more_lights,
        "wrong_pixels": find.pixels,
        "wrong_answers": find.answers,
        "differing_pixels": find.differing,
        "taught_time": find.taught_time,
        "learnt_from": find.learnt_from,
        "before": earlier.to_json(find.before),
    }


def all_to_json(findings: Findings, scene: Scene) -> dict[str, Any]:
    """All that a hunt has found, as JSON has it."""
    return {
        "scene": findings.scene,
        "method": findings.method,
        "size": list(findings.size),
        "settings": findings.settings,
        "frames": findings.frames,
        "pixels": findings.pixels,
        "wrong_pixels": findings.wrong_pixels,
        "wrong_frames": findings.wrong_frames,
        "finds": [to_json(find, scene) for find in findings.finds],
    }


def explaining(find: Find, findings: Findings, before: Path | str) -> list[str]:
    """The words of the command that explains a find; `before` is the file of the frames before it."""
    width, height = findings.size
    words = ["shadowcull", "explain", scene_word(Path(findings.scene)), f"--time={find.time!r}"]
    words += ["--size", f"{width}x{height}", "--method", findings.method, "--pixel", f"{find.x},{find.y}"]
    if not find.own_camera:
        words += ["--camera", json.dumps(find.camera.to_json())]
    for option, default in (("depth", 10), ("zoom_factor", 4.0), ("lamp_radius", None), ("lamp_samples", None)):
        value = findings.settings.get(option, default)
        if value != default:
            words += [f"--{option.replace('_', '-')}", str(value)]
    words += ["--symmetric"] if findings.settings.get("symmetric") else []
    return [*words, "--before", str(before), "--only", "wrong"]
