"""Counterexamples: pixels at which a method is wrong, what is wrong there, in words and as JSON."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tracer.experiments import warmup_frames
from tracer.experiments.warmup_frames import WarmupFrame
from tracer.inspect.path_records import VERDICTS, RayTree
from tracer.inspect.why_in_words import primitive_in_words
from tracer.scene.arrays import Float32, vector
from tracer.scene.lights import named_light
from tracer.scene.model import Camera, Scene
from tracer.util.text import mode_in_words

PATH, AROUND = "path", "around"
"""Where a counterexample is: on the path that was searched, or beside it."""
_TOLD = ("place", "time", "own_camera", "difference", "color", "reference", "primitive", "light", "verdict", "bounces",
         "more_lights", "taught_time", "learnt_from")  # fmt: skip


@dataclass(frozen=True)
class Counterexample:
    """A wrong pixel (x, y), and what is wrong there.

    The pixel is `difference` (0 to 1, as `difference_of` says) from `reference`, the right colour; `color` is what the
    method shows, both linear RGB.  A shadow ray from `primitive`, which the pixel shows after `bounces`,
    to `light` got the answer `lit`, by `verdict`, the name of a `tracer.culling.verdicts.Verdict`; `blocker` is what
    is in the way, -1 for nothing; `more_lights` are wrong there in the same way.  `taught` is the number, among the
    frames before it, of the one that taught the mode, -1 where that is not known, and `taught_time` its time.  Of the
    frame, `pixels` counts the wrong pixels, with a wrong answer or another colour, `answers` the wrong answers and
    `differing` the pixels whose colour is another.  `before` are the fewest frames before it that were found to make
    it, of `learnt_from` that really came before."""

    time: float
    camera: Camera
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
    place: str = PATH
    own_camera: bool = False
    pixels: int = 0
    answers: int = 0
    differing: int = 0
    more_lights: int = 0
    taught: int = -1
    taught_time: float | None = None
    before: tuple[WarmupFrame, ...] = ()
    learnt_from: int = 0

    @property
    def key(self) -> tuple[int, int]:
        """The primitive and the light: counterexamples with the same key are one mistake."""
        return self.primitive, self.light

    @property
    def seen_camera(self) -> Camera | None:
        """The camera, None where it is the scene's own."""
        return None if self.own_camera else self.camera


def frame_number(scene: Scene, time: float) -> int:
    """Return the number of the frame of a scene's path whose time is nearest."""
    start, end = scene.time_range
    return round((time - start) / (end - start) * (scene.frames - 1)) if scene.frames > 1 and end > start else 0


def frame_of(example: Counterexample, scene: Scene) -> str:
    """Return the number of the frame of the path, or of the one that it is near."""
    number = frame_number(scene, example.time)
    return f"{number}" if example.place == PATH else f"near {number}"


def taught_by(example: Counterexample, scene: Scene) -> str:
    """Return the frame that taught the mode; "" where that is not known."""
    if example.taught_time is None:
        return ""
    return f"frame {frame_number(scene, example.taught_time)}" if scene.frames > 1 else f"picture {example.taught + 1}"


def in_words(example: Counterexample, scene: Scene) -> list[str]:
    """Say in a sentence each what the pixel shows, which answer is wrong, what is true, and which frame taught it."""
    brighter = sum(example.color) > sum(example.reference)
    seen = f", seen by {example.bounces} bounce{'s' * (example.bounces != 1)}" if example.bounces else ""
    said = [
        f"Pixel {example.x}, {example.y} is too {'bright' if brighter else 'dark'}, by {example.difference:.3f} of 1.",
        f"It shows {primitive_in_words(scene, example.primitive)}{seen}.",
    ]
    more = f" and {example.more_lights} more" if example.more_lights else ""
    known, light = mode_in_words(example.verdict), f"{named_light(scene.lights, example.light)}{more}"
    if example.lit and example.blocker >= 0:
        by = "itself" if example.blocker == example.primitive else primitive_in_words(scene, example.blocker)
        first = "the first is" if example.more_lights else "it is"
        said.append(f"The method takes it to be lit by {light} ({known}), but {first} blocked by {by}.")
    else:
        said.append(f"The method takes it to be in the shadow of {light} ({known}), but nothing is in the way.")
    if example.taught >= 0:
        said.append(f"That was learnt in {taught_by(example, scene)}.")
    return [*said, *_history(example)]


def in_its_frame(example: Counterexample) -> str:
    """Say how much of its frame is wrong. A pixel has one answer for each light and bounce."""
    pixels = f"{example.pixels:,} pixel{'s are' if example.pixels != 1 else ' is'} wrong"
    answers = f"{example.answers:,} shadow answer{'s' * (example.answers != 1)}"
    colors = f"{example.differing:,} pixel{'s differ' if example.differing != 1 else ' differs'} in colour"
    return f"In this frame {pixels}, by {answers}; {colors}."


def _history(example: Counterexample) -> list[str]:
    few, every = len(example.before), example.learnt_from
    if not every:
        return []
    if example.place == AROUND:
        return [f"The camera came there after {'that frame' if few == 1 else f'{few} frames'} of the path."]
    if few < every:
        return [f"The modes that {few} of {every} earlier frames left are enough to show it."]
    return [f"It is wrong with the modes that {few} earlier frame{'s' * (few != 1)} left."]


def to_json(example: Counterexample, scene: Scene) -> dict[str, Any]:
    """Return the counterexample as JSON has it. The commands' `--before` takes the file."""
    blocked = example.blocker >= 0
    return {name: getattr(example, name) for name in _TOLD} | {
        "frame": frame_number(scene, example.time),
        "camera": example.camera.to_json(),
        "pixel": [example.x, example.y],
        "primitive_name": primitive_in_words(scene, example.primitive),
        "light_name": scene.lights[example.light].name,
        "answer": "lit" if example.lit else "blocked",
        "blocker": example.blocker if blocked else None,
        "blocker_name": primitive_in_words(scene, example.blocker) if blocked else None,
        "wrong_pixels": example.pixels, "wrong_answers": example.answers, "differing_pixels": example.differing,
        "before": warmup_frames.to_json(example.before),
    }  # fmt: skip


def difference_of(color: Float32, right: Float32) -> Float32:
    """(...) how far colours (..., 3) are from the right ones as a screen shows them: 0 to 1, of the worst channel."""
    return np.abs(np.clip(color, 0.0, 1.0) - np.clip(right, 0.0, 1.0)).max(axis=-1)


def counterexample_in(tree: RayTree, scene: Scene) -> Counterexample | None:
    """Read off a pixel's rays, in a verified frame, what is wrong there: of its wrong answers the one that weighs most.

    Returns None where no answer is wrong, as where only a sum was rounded differently."""
    answers = [
        (float(ray.weight.max()) * max(scene.lights[int(found.light[place])].color), ray, found, place)
        for ray in tree.rays
        if (found := ray.shadows) is not None
        for place in np.flatnonzero(found.wrong).tolist()
    ]
    if not answers:
        return None
    _, ray, shadows, place = max(answers, key=lambda answer: answer[0])
    frame, lit = tree.frame, bool(shadows.lit[place])
    assert frame.reference is not None
    color, right = frame.color[tree.y, tree.x], frame.reference[tree.y, tree.x]
    return Counterexample(
        frame.time, frame.camera, tree.x, tree.y,
        difference=float(difference_of(color, right)), color=vector(color), reference=vector(right),
        primitive=ray.primitive, bounces=ray.bounce, light=int(shadows.light[place]), lit=lit,
        verdict=VERDICTS[shadows.verdict[place]].value, blocker=int(shadows.blocker[place]),
        more_lights=len(np.unique(shadows.light[shadows.wrong & (shadows.lit == lit)])) - 1,
    )  # fmt: skip
