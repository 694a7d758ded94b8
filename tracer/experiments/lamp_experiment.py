"""A path of frames by several methods under lamps of several sizes and numbers of samples.

Each kind of lamp is an experiment of its own (`tracer.experiments.experiment`), in one world.  The method `free`, for
which shadow rays cost nothing, is always measured as well: its speed-up over `none` is the most that culling can reach.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any

import numpy as np

from tracer.experiments.experiment import REFERENCE, Results, run, saved_of, speed_up
from tracer.frame import Frame, Settings
from tracer.geometry.world import World
from tracer.scene.lights import as_lamps
from tracer.scene.model import Scene

CEILING = "free"


@dataclass(frozen=True)
class LampRow:
    """A method under one kind of lamp.

    `lamp_radius` and `lamp_samples` are those of the settings. `frame_seconds` is the median, `shadow_rays` the mean of
    those due per frame, `known` the part of them that was saved (`ShadowCounts.saved`), `speed_up` the time of `none`
    over that of the method in all frames, and `share_of_free` the part that this is of the speed-up of `free`.
    """

    lamp_radius: float | None
    lamp_samples: int | None
    method: str
    frame_seconds: float
    shadow_rays: float
    known: float
    speed_up: float
    share_of_free: float


@dataclass
class LampResults:
    """The results of each kind of lamp, in the order in which they were measured; the last may be unfinished."""

    runs: list[Results] = field(default_factory=list)

    def to_dict(self) -> dict[str, Any]:
        """The first kind of lamp as an experiment has it, and all of them under `lamps`, with the `table`."""
        lamps = [
            one.to_dict() | {name: one.settings[name] for name in ("lamp_radius", "lamp_samples")} for one in self.runs
        ]
        return self.runs[0].to_dict() | {"lamps": lamps, "table": [vars(row) for row in table(self)]}


def kinds_of_lamps(
    scene: Scene, radii: Sequence[float | None], samples: Sequence[int | None]
) -> list[tuple[float | None, int | None]]:
    """Every radius with every number of samples; of those that make the same lamps of the scene's lights, the first."""
    found: dict[object, tuple[float | None, int | None]] = {}
    for kind in product(radii, samples):
        found.setdefault(as_lamps(scene.lights, *kind), kind)
    return list(found.values())


def run_lamps(
    scene: Scene,
    settings: Settings,
    methods: list[str],
    kinds: Sequence[tuple[float | None, int | None]],
    times: list[float],
    numbers: range | None = None,
    cancel: Callable[[], bool] | None = None,
    world: World | None = None,
    on_frame: Callable[[int, str, Frame], None] | None = None,
) -> Iterator[LampResults]:
    """Render the path once for each kind of lamp, and yield the same growing results after each frame.

    `kinds` are radii and numbers of samples (`kinds_of_lamps`); everything else is as for `experiment.run`."""
    results = LampResults()
    world = world or World(scene, times[0] if times else 0.0, settings.accelerator)
    world.build()  # no frame that is measured has to
    for radius, samples in kinds:
        if cancel is not None and cancel():
            return
        of_kind = replace(settings, lamp_radius=radius, lamp_samples=samples)
        for grown in run(scene, of_kind, [*methods, CEILING], times, numbers, None, cancel, world, on_frame):
            if not results.runs or results.runs[-1] is not grown:
                results.runs.append(grown)
            yield results


def table(results: LampResults) -> list[LampRow]:
    """A row for each method under each kind of lamp."""
    return [_row(one, method) for one in results.runs for method in one.methods]


def _speed_up(results: Results, method: str) -> float:
    none, other = (np.array(results.methods[name]["frame_seconds"]) for name in (REFERENCE, method))
    return speed_up(none, other)[0]


def _row(results: Results, method: str) -> LampRow:
    figures = {name: np.array(values, np.float64) for name, values in results.methods[method].items()}
    due, faster = figures["shadow_rays_due"], _speed_up(results, method)
    return LampRow(
        lamp_radius=results.settings["lamp_radius"],
        lamp_samples=results.settings["lamp_samples"],
        method=method,
        frame_seconds=float(np.median(figures["frame_seconds"])),
        shadow_rays=float(due.mean()),
        known=saved_of(figures) / max(1.0, float(due.sum())),
        speed_up=faster,
        share_of_free=faster / _speed_up(results, CEILING),
    )
