"""What a sweep traces: scenes by methods by settings by seeds, frame by frame, cut into tasks that know nothing of one
another.

A frame of a method that learns nothing is a task of its own.  A method that learns from frame to frame traces its whole
path in one task; or, where the study names a `warmup`, each of its frames is a task that first traces so many frames
before it.  Every task is traced by one thread, so that even certificates are made in the same order each time.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from tracer.experiments.experiment import path_times
from tracer.method import Method
from tracer.scene.framing import bounds
from tracer.scene.model import Camera, Scene
from tracer.settings import Settings

ASPECTS = (
    "depth", "symmetric", "zoom_factor", "verify", "accelerator", "lamp_radius", "lamp_samples", "certificates",
    "certificate_seconds", "certificate_memory", "lightcuts_error", "lightcuts_nodes", "light_buffer_side",
    "light_buffer_memory",
)  # fmt: skip
"""Settings that a study may vary, beside sizes and methods."""


@dataclass(frozen=True)
class Study:
    """What to trace.

    `scenes` are the names that the study gives, each with its file.  `settings` are all combinations, without a method.
    Each of `seeds` traces all of it once: with `shake`, its cameras are moved aside by a vector of the seed's own, at
    most so many times the scene's diagonal.  `path_frames` resamples the animation; of the path, `first` to `last` are
    traced.  With `warmup`, a method that learns sees only so many frames before each.
    """

    path: Path
    title: str
    scenes: dict[str, Path]
    methods: tuple[str, ...]
    settings: tuple[Settings, ...]
    seeds: tuple[int, ...] = (0,)
    shake: float = 0.0
    path_frames: int | None = None
    first: int = 0
    last: int | None = None
    warmup: int | None = None
    folders: tuple[Path, ...] = ()

    def label(self, name: str) -> str:
        """A scene in a table: the name of its file alone, where no other scene has the same."""
        stem = Path(name).stem
        return stem if sum(Path(other).stem == stem for other in self.scenes) == 1 else name

    def to_json(self) -> dict[str, Any]:
        """The study in full, to be compared with another."""
        aspects = {name: list(dict.fromkeys(getattr(s, name) for s in self.settings)) for name in ASPECTS}
        return {
            "scenes": list(self.scenes),
            "methods": list(self.methods),
            "sizes": list(dict.fromkeys(f"{s.width}x{s.height}" for s in self.settings)),
            **{name: [_plain(value) for value in values] for name, values in aspects.items()},
            "seeds": list(self.seeds),
            "shake": self.shake,
            "frames of the path": self.path_frames,
            "first frame": self.first,
            "last frame": self.last,
            "warmup": self.warmup,
        }

    def tasks(self, name: str, scene: Scene, code: str) -> list[Task]:
        """The tasks of one of its scenes, those that take longest first; `code` is that of the scene's contents.

        Raises ValueError, in one line, where the scene has no such frames."""
        times = path_times(scene, self.path_frames)
        last = len(times) - 1 if self.last is None else self.last
        if not 0 <= self.first <= last < len(times):
            raise ValueError(
                f"{self.path}: path: the frames {self.first} to {last} are not all of {name}, whose path has "
                f"{len(times)}; change first and last"
            )
        numbers = range(self.first, last + 1)
        found: list[Task] = []
        for settings, method, seed in product(self.settings, self.methods, self.seeds):
            wanted = replace(settings, method=method, threads=1)
            task = Task(name, code, wanted, seed, self.shake, len(times), times[0])

            def at(frames: Sequence[int]) -> tuple[tuple[int, float], ...]:
                return tuple((number, times[number]) for number in frames)

            if not Method.parse(method).learns:
                found += [replace(task, frames=at([number])) for number in numbers]
            elif self.warmup is None:
                found.append(replace(task, frames=at(numbers)))
            else:
                for number in numbers:
                    before = at(range(max(0, number - self.warmup), number))
                    found.append(replace(task, frames=at([number]), before=before, warmup=self.warmup))
        return sorted(found, key=lambda task: -task.cost)


@dataclass(frozen=True)
class Task:
    """Some `frames` (number, seconds) of a path of `path_frames`, traced in their order by one method after the frames
    `before`, which are not measured; `start` is the time of the path's first frame.  `warmup` None: from the start."""

    scene: str
    code: str
    settings: Settings
    seed: int
    shake: float
    path_frames: int
    start: float
    frames: tuple[tuple[int, float], ...] = ()
    before: tuple[tuple[int, float], ...] = ()
    warmup: int | None = None

    @cached_property
    def key(self) -> str:
        """A code of all that its results depend on, but the program."""
        words = repr((asdict(self.settings), {k: v for k, v in asdict(self).items() if k != "settings"}))
        return hashlib.blake2b(words.encode(), digest_size=8).hexdigest()

    @property
    def cost(self) -> int:
        """How long it takes, roughly: pixels of all frames."""
        return self.settings.width * self.settings.height * (len(self.frames) + len(self.before))

    @property
    def repeats(self) -> bool:
        """Whether its counters are the same each time: neither chosen by measured times, nor made within a limit of
        time."""
        method = Method.parse(self.settings.method)
        limited = method.has_certificates and math.isfinite(self.settings.certificate_seconds)
        return not method.adaptive and not limited

    def camera(self, scene: Scene, time: float) -> Camera | None:
        """Where its seed puts the camera; None for the scene's own."""
        if not self.shake:
            return None
        box = bounds(scene.objects, scene.animation, self.start)
        lots = np.random.default_rng(self.seed)
        aside = lots.normal(size=3)
        aside *= lots.uniform() / max(float(np.linalg.norm(aside)), 1e-300)
        diagonal = 0.0 if box is None else float(np.linalg.norm(box[1] - box[0]))
        own = scene.camera_at(time)
        x, y, z = (float(v) for v in np.asarray(own.position) + self.shake * diagonal * aside)
        return replace(own, position=(x, y, z))

    def in_words(self) -> str:
        """Which it is, for messages."""
        numbers = [number for number, _ in self.frames]
        which = f"frame {numbers[0]}" if len(numbers) == 1 else f"frames {numbers[0]} to {numbers[-1]}"
        settings = self.settings
        return f"{self.scene}, {settings.method}, {settings.width}x{settings.height}, {which}"


def _plain(value: Any) -> Any:
    """A value of a setting as JSON has it."""
    return "none" if isinstance(value, float) and not math.isfinite(value) else value


def differences(kept: dict[str, Any], now: dict[str, Any]) -> list[str]:
    """What two studies, as JSON, do not have in common, in words."""
    found = []
    for key, new in now.items():
        old = kept.get(key)
        if old == new:
            continue
        if isinstance(old, list) and isinstance(new, list):
            more = [f"+ {value}" for value in new if value not in old] + [f"- {v}" for v in old if v not in new]
            found.append(f"{key}: {', '.join(more) or 'in another order'}")
        else:
            found.append(f"{key}: {old} → {new}")
    return found
