"""A wrong pixel: what is wrong there, read off the tree of its rays, and which of the frames before it taught that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tracer.frame import Frame
from tracer.scene.model import Scene
from tracer.told_rays import VERDICTS, RayTree
from viewer.output.finds import PATH, Find
from viewer.state.earlier import Earlier
from viewer.state.teaching import NEVER, ModeOrigins


class Lessons:
    """Frames that came one after another, and which of them taught what."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self.frames: list[Earlier] = []
        self.ledger = ModeOrigins(len(scene.lights))
        self._lights: np.ndarray | None = None

    def add(self, frame: Frame, earlier: Earlier) -> None:
        """A frame has been traced, and leaves modes."""
        lights = self._scene.light_positions(frame.time)
        moved = None if self._lights is None else (lights != self._lights).any(axis=1)
        if frame.settings.keeps_modes:
            self.ledger.add(len(self.frames), frame.modes, moved)
        self._lights = lights
        self.frames.append(earlier)

    def with_teacher(self, find: Find) -> Find:
        """The find with the frame that taught the mode of its primitive."""
        taught = self.ledger.of(find.primitive)
        if taught is None or find.light >= len(taught.lights):
            return find
        lesson = taught.lights[find.light]
        number = lesson.lit if find.lit else lesson.blocked
        return find if number == NEVER else replace(find, taught=number, taught_time=self.frames[number].time)


def find_in(tree: RayTree, scene: Scene) -> Find | None:
    """What is wrong at a pixel: of its wrong answers the one that weighs most; None where none is, as with a sum of
    rounding alone."""
    worst: tuple[float, Find] | None = None
    for ray in tree.rays:
        if ray.shadows is None:
            continue
        for place in np.flatnonzero(ray.shadows.wrong).tolist():
            light = int(ray.shadows.light[place])
            weight = float(ray.weight.max()) * max(scene.lights[light].color)
            if worst is None or weight > worst[0]:
                others = np.unique(ray.shadows.light[ray.shadows.wrong & (ray.shadows.lit == ray.shadows.lit[place])])
                find = Find(
                    place=PATH,
                    time=tree.frame.time,
                    camera=tree.frame.camera,
                    own_camera=False,
                    x=tree.x,
                    y=tree.y,
                    difference=0.0,
                    color=(0.0, 0.0, 0.0),
                    reference=(0.0, 0.0, 0.0),
                    primitive=ray.primitive,
                    light=light,
                    lit=bool(ray.shadows.lit[place]),
                    verdict=VERDICTS[ray.shadows.verdict[place]].value,
                    blocker=int(ray.shadows.blocker[place]),
                    bounces=ray.bounce,
                    pixels=0,
                    more_lights=len(others) - 1,
                )
                worst = weight, find
    return None if worst is None else worst[1]


def triple(values: np.ndarray) -> tuple[float, float, float]:
    """Three numbers (3,), as Python's own."""
    return float(values[0]), float(values[1]), float(values[2])
