"""What a frame has answered for the lights at a pixel, where that is not true."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tracer.frame import Frame
from tracer.method import Method
from tracer.ray_tree import ray_tree
from tracer.renderer import Renderer
from tracer.told_rays import VERDICTS, RayTree, ShadowRays


@dataclass(frozen=True)
class WrongLight:
    """A light at what a pixel shows: `lit` of its `samples` that are due get there in the picture, `wrong` answers
    are not true, the first of them by `verdict`, the name of a `tracer.culling.verdicts.Verdict`."""

    lit: int
    samples: int
    wrong: int
    verdict: str


@dataclass(frozen=True)
class WrongAnswers:
    """The wrong answers of a pixel: those of the surface that it shows by light, and how many there are at what is
    mirrored in it or seen through it."""

    lights: dict[int, WrongLight]
    beyond: int = 0

    @property
    def count(self) -> int:
        return self.beyond + sum(one.wrong for one in self.lights.values())


NONE_WRONG = WrongAnswers({})


def wrong_answers(renderer: Renderer, frame: Frame, x: int, y: int) -> WrongAnswers:
    """What is wrong at a pixel; nothing where the method is exact, or where it is no longer known what became of its
    rays, as another frame has begun."""
    if Method.parse(frame.settings.method).exact or (frame.wrong is not None and not frame.wrong[y, x]):
        return NONE_WRONG
    try:
        return told_wrong(ray_tree(renderer, frame, x, y))
    except LookupError:
        return NONE_WRONG


def told_wrong(tree: RayTree) -> WrongAnswers:
    """What is wrong among the rays of a pixel."""
    lights: dict[int, WrongLight] = {}
    beyond = 0
    for ray in tree.rays:
        if ray.shadows is None:
            continue
        if ray.parent >= 0:
            beyond += int(np.count_nonzero(ray.shadows.wrong))
        else:
            lights |= _by_light(ray.shadows)
    return WrongAnswers(lights, beyond)


def _by_light(s: ShadowRays) -> dict[int, WrongLight]:
    found = {}
    for light in np.unique(s.light[s.wrong]).tolist():
        places = s.of_light(light)
        wrong, due = s.wrong[places], [VERDICTS[number].due for number in s.verdict[places]]
        verdict = VERDICTS[s.verdict[places][wrong][0]].value
        found[light] = WrongLight(int(s.lit[places].sum()), sum(due), int(wrong.sum()), verdict)
    return found
