"""Uses the program for long, as a restless user would, and watches what it takes: memory, threads and open files.

    python -m tests.fuzz.soak --seconds 3600 --seed 0 SCENE ...

The window's controller does, act after act, what its panels make it do, by a generator from a seed: it flies, changes
methods, views, sizes, samples and lamps, opens scenes and gives up opening them, edits them, goes back in time,
compares two methods, runs experiments and hunts and stops them.  Where a picture is at rest and its method exact, it is
compared with one that a new renderer makes without culling, bit for bit.

What it takes is sampled all the time and saved in `build/soak` as JSON and as a plot.  Memory may not go on growing: in
the last quarter its median is at most GROWTH of that in the second, and so are threads and files.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import matplotlib
import numpy as np

from tests.viewer.desk import Desk
from tracer.editing.edits import NO_EDITS
from tracer.method import Method
from tracer.renderer import Renderer
from tracer.scene.model import Camera
from viewer.state.views import View

ROOT = Path(__file__).resolve().parents[2]
SCENES = tuple(ROOT / "assets" / "scenes" / f"{name}.aff" for name in ("default", "figure3", "figure4"))
METHODS = ("none", "paper", "cells", "certified", "auto", "paper+cache", "paper+rest", "certified+cache")
GROWTH = 1.25  # of the second quarter's median: what is kept for going back is bounded, but takes a while to fill
STEADY = 4  # threads and files that may be more for a moment
PATIENCE = 120.0  # seconds in which everything comes to rest


class Sample(NamedTuple):
    """What the process takes after so many seconds and acts: memory in bytes, threads, and open files."""

    seconds: float
    acts: int
    memory: int
    threads: int
    files: int


class Soak:
    """A user who does one thing after another; `done` counts them by name, `wrong` says what differed."""

    def __init__(self, scenes: list[Path], seed: int, folder: Path) -> None:
        self.rng = np.random.default_rng(seed)
        self.scenes = scenes
        self.desk = Desk(scenes[0], folder)
        self.c = self.desk.c
        self.c.session.set_pace(progressive=True)
        self.c.settings.change(method="certified")  # whose pictures can be compared, until another is chosen
        self.done: Counter[str] = Counter()
        self.compared = 0
        self.wrong: list[str] = []
        self._acts: list[Callable[[], None]] = [
            self._fly, self._fly, self._fly, self._follow_path, self._play, self._method, self._method, self._view,
            self._size, self._settings, self._lamps, self._open, self._give_up_opening, self._open_nothing, self._edit,
            self._edit, self._undo, self._redo, self._go_back, self._two_methods, self._experiment, self._hunt,
            self._stop, self._select, self._bookmark, self._reset_modes,
        ]  # fmt: skip

    def act(self) -> None:
        """Do something, and let some frames pass."""
        act = self._acts[self.rng.integers(len(self._acts))]
        act()
        self.done[act.__name__.strip("_")] += 1
        for _ in range(int(self.rng.integers(1, 30))):
            self.desk.tick()
        self.desk.came.clear()
        if self.rng.random() < 0.05:
            self.rest()

    def rest(self) -> None:
        """Wait until nothing goes on any more, and compare the picture."""
        self.c.session.playing = False
        self.c.runs.stop()
        end, quiet = time.monotonic() + PATIENCE, 0
        while quiet < 10:
            if time.monotonic() > end:
                self.wrong.append(
                    f"after {sum(self.done.values())} acts something goes on for more than {PATIENCE:g} s"
                )
                return
            self.desk.tick()
            quiet = 0 if self.c.active else quiet + 1
        self._compare()

    def _compare(self) -> None:
        frame, scene = self.c.frame, self.c.session.scene
        if frame is None or scene is None or not Method.parse(frame.settings.method).exact:
            return
        truth = Renderer(scene, replace(frame.settings, method="none")).render(frame.time, frame.camera)
        self.compared += 1
        if not np.array_equal(truth.color, frame.color):
            pixels = int((truth.color != frame.color).any(axis=2).sum())
            self.wrong.append(f"after {sum(self.done.values())} acts {pixels} pixels differ: {frame.settings}")

    def close(self) -> None:
        if not self.c.close():
            self.wrong.append("it does not end")

    # --- what a user does ---------------------------------------------------------------------------

    def _fly(self) -> None:
        camera, rng = self.c.session.camera, self.rng
        step = rng.normal(size=3) * rng.choice([0.01, 0.3, 3.0])
        place, towards = np.array(camera.position) + step, np.array(camera.direction) + rng.normal(size=3) * 0.1
        self.c.motion.glide(Camera(tuple(place.tolist()), tuple(towards.tolist()), camera.up, camera.angle))

    def _follow_path(self) -> None:
        scene = self.c.session.scene
        self.c.session.change(camera=None)
        self.c.session.change(time=scene.frame_time(int(self.rng.integers(max(scene.frames, 1)))))

    def _play(self) -> None:
        self.c.session.playing = self.c.session.animated and self.rng.random() < 0.7

    def _method(self) -> None:
        self.c.settings.change(method=str(self.rng.choice(METHODS)))

    def _view(self) -> None:
        views = list(View)
        self.c.session.set_draw(view=views[self.rng.integers(len(views))])

    def _size(self) -> None:
        width, height = (int(side) for side in self.rng.integers(8, 160, 2))
        self.c.session.set_pace(fixed_size=bool(self.rng.random() < 0.7), width=width, height=height)

    def _settings(self) -> None:
        rng = self.rng
        self.c.settings.change(
            samples=int(rng.choice([1, 1, 4])), depth=int(rng.integers(0, 6)), verify=bool(rng.random() < 0.2)
        )

    def _lamps(self) -> None:
        radius = None if self.rng.random() < 0.6 else float(10.0 ** self.rng.uniform(-2, 0))
        self.c.settings.change(lamp_radius=radius, lamp_samples=int(self.rng.choice([1, 4, 16])))

    def _open(self) -> None:
        self.c.loader.open(self.scenes[self.rng.integers(len(self.scenes))])

    def _give_up_opening(self) -> None:
        self._open()
        for _ in range(int(self.rng.integers(0, 10))):
            self.desk.tick()
        self.c.loader.cancel()

    def _open_nothing(self) -> None:
        self.c.loader.open(self.scenes[0].with_name("there is no such file.aff"))

    def _edit(self) -> None:
        rng, scene, editing = self.rng, self.c.session.scene, self.c.editing
        if scene.primitive_count == 0:
            editing.show_everything()
            return
        light = int(rng.integers(max(len(scene.lights), 1)))
        edits = [
            editing.now.with_primitive(int(rng.integers(scene.primitive_count)), False),
            editing.now.with_light(light, bool(rng.random() < 0.5)),
            editing.now.with_light_at(light, tuple(rng.normal(size=3).tolist())),
            replace(editing.now, hidden_primitives=frozenset()),
            NO_EDITS,
        ]
        editing.change(edits[rng.integers(len(edits))])

    def _undo(self) -> None:
        self.c.undo.undo()

    def _redo(self) -> None:
        self.c.undo.redo()

    def _go_back(self) -> None:
        if self.c.history.frames:
            self.c.navigator.go(int(self.rng.integers(self.c.history.frames)))

    def _two_methods(self) -> None:
        self.c.comparing.toggle_methods()

    def _experiment(self) -> None:
        runs = self.c.runs
        runs.experiment_plan.frames, runs.experiment_plan.size = int(self.rng.integers(2, 20)), (32, 24)
        runs.start_experiment()

    def _hunt(self) -> None:
        plan = self.c.runs.hunt_plan
        plan.size, plan.first, plan.last, plan.around = (32, 24), 0, int(self.rng.integers(1, 8)), 2
        self.c.runs.start_hunt()

    def _stop(self) -> None:
        self.c.runs.stop()

    def _select(self) -> None:
        self.c.selection.select((float(self.rng.random()), float(self.rng.random())))

    def _bookmark(self) -> None:
        if len(self.c.bookmarks.all) < 5:
            self.c.bookmarks.add()
        else:
            self.c.go_to_bookmark(int(self.rng.integers(5)))

    def _reset_modes(self) -> None:
        self.c.reset_modes()


def soak(scenes: list[Path], seconds: float, seed: int) -> tuple[Soak, list[Sample]]:
    """Use the program for so long."""
    with tempfile.TemporaryDirectory() as folder:
        user, began, samples = Soak(scenes, seed, Path(folder)), time.monotonic(), []
        while (gone := time.monotonic() - began) < seconds and not user.wrong:
            user.act()
            if not samples or gone > samples[-1].seconds + seconds / 400:
                samples.append(_sample(gone, sum(user.done.values())))
                print(
                    f"\r{gone:6.0f} s, {samples[-1].acts} acts, {samples[-1].memory >> 20} MB", end="", file=sys.stderr
                )
        print(file=sys.stderr)
        user.rest()
        user.close()
        return user, samples


def _sample(seconds: float, acts: int) -> Sample:
    """What this process takes, as Linux tells it."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    files = len(list(Path("/proc/self/fd").iterdir()))
    return Sample(seconds, acts, pages * 4096, threading.active_count(), files)


def growing(samples: list[Sample]) -> list[str]:
    """What goes on growing, in words."""
    quarter = len(samples) // 4
    if quarter < 5:
        return []
    said = []
    for name, slack in (("memory", 0), ("threads", STEADY), ("files", STEADY)):
        second, last = (
            float(np.median([getattr(sample, name) for sample in part]))
            for part in (samples[quarter : 2 * quarter], samples[-quarter:])
        )
        if last > GROWTH * second + slack:
            said.append(f"{name} grows from {second:,.0f} to {last:,.0f}")
    return said


def draw(samples: list[Sample], path: Path) -> None:
    """Memory, threads and files over time."""
    matplotlib.use("agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(3, 1, sharex=True, figsize=(9, 6), layout="constrained")
    seconds = [sample.seconds for sample in samples]
    for axis, name, unit in zip(axes, ("memory", "threads", "files"), ("MB", "", ""), strict=True):
        part = 2**20 if name == "memory" else 1
        axis.plot(seconds, [getattr(sample, name) / part for sample in samples], linewidth=1.2)
        axis.set_ylabel(f"{name}, {unit}" if unit else name)
        axis.set_ylim(bottom=0)
        axis.grid(alpha=0.3)
    axes[-1].set_xlabel("seconds")
    figure.savefig(path, dpi=120)
    pyplot.close(figure)


def main() -> int:
    parser = argparse.ArgumentParser(description="use the program for long, and watch what it takes")
    parser.add_argument("scenes", nargs="*", type=Path, help="besides those that come with the program")
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    scenes = [*SCENES, *given.scenes]
    user, samples = soak(scenes, given.seconds, given.seed)
    folder = ROOT / "build" / "soak"
    folder.mkdir(parents=True, exist_ok=True)
    found = user.wrong + growing(samples)
    told = {"seed": given.seed, "acts": dict(user.done), "compared": user.compared, "found": found}
    (folder / "soak.json").write_text(json.dumps(told | {"samples": [s._asdict() for s in samples]}, indent=1))
    draw(samples, folder / "soak.png")
    acts, last = sum(user.done.values()), samples[-1]
    print(f"{acts} acts in {last.seconds:.0f} s, {user.compared} pictures compared; at the end {last.memory >> 20} MB,")
    print(f"{last.threads} threads and {last.files} files; drawn in {folder / 'soak.png'}")
    for line in found:
        print(f"wrong: {line}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
