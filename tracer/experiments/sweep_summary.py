"""What a sweep found, in a line for each scene, size, combination of settings and method."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa

from tracer.experiments.experiment import FIGURES, REFERENCE, saved_of, wrong_part
from tracer.experiments.study import ASPECTS
from tracer.experiments.sweep_store import Key, keys_of
from tracer.method import in_order

Group = tuple[str, int, int, tuple[Any, ...]]
"""A scene, a size, and the values of ASPECTS."""
NOTHING = float("nan")


@dataclass(frozen=True)
class Line:
    """A method under the same circumstances.  Savings are averages over frames, parts of 1, against `none`; `spread` is
    how far the averages of seeds deviate from the steps that are saved (standard deviation).  `known` is the part of
    the shadow rays that was saved (`ShadowCounts.saved`).  `seconds` is the median of a frame's
    processor time, for which it matters little what else the machine does, and `speed_up` that of all frames by `none`
    over that of the method.  NaN: not known.

    `settings` names those that the study varies."""

    scene: str
    width: int
    height: int
    settings: str
    method: str
    frames: int
    steps: float
    spread: float
    tests: float
    known: float
    wrong: int
    wrong_part: float
    verified: bool
    seconds: float
    speed_up: float


def summary(table: pa.Table, wanted: Iterable[Key]) -> list[Line]:
    """Lines of the rows of these tasks and frames, in the order of the tasks' scenes, sizes and methods."""
    keys = set(wanted)
    table = table.filter(pa.array([key in keys for key in keys_of(table)], pa.bool_()))
    if not len(table):
        return []
    data = {name: table[name].to_pylist() for name in table.column_names}
    aspects = [name for name in ASPECTS if len(set(data[name])) > 1]
    groups: dict[Group, dict[str, list[int]]] = {}
    for row in range(len(table)):
        values = tuple(data[name][row] for name in ASPECTS)
        group = (data["scene"][row], data["width"][row], data["height"][row], values)
        groups.setdefault(group, {}).setdefault(data["method"][row], []).append(row)
    lines = []
    for group in sorted(groups, key=lambda g: (g[0], g[1] * g[2], g[1], str(g[3]))):
        methods, words = groups[group], ", ".join(f"{n} {_shown(group[3][ASPECTS.index(n)])}" for n in aspects)
        reference = {_moment(data, row): row for row in methods.get(REFERENCE, ())}
        for method in in_order(methods):
            lines.append(_line(data, group, words, method, methods[method], reference))
    return lines


def _line(
    data: dict[str, list[Any]], group: Group, words: str, method: str, rows: list[int], reference: dict[Any, int]
) -> Line:
    scene, width, height, _ = group

    def of(name: str, which: list[int]) -> np.ndarray:
        return np.array([data[name][row] for row in which], np.float64)  # None becomes NaN

    pairs = [(row, reference[_moment(data, row)]) for row in rows if _moment(data, row) in reference]
    mine, theirs = [row for row, _ in pairs], [row for _, row in pairs]

    def savings(traced: str, certified: str) -> np.ndarray:
        before, after = of(traced, theirs), of(traced, mine) + of(certified, mine)
        return np.divide(before - after, before, out=np.zeros_like(before), where=before > 0)

    steps = savings("shadow_traversal_steps", "certificate_steps")
    tests = savings("shadow_intersection_tests", "certificate_tests")
    seeds = np.array([data["seed"][row] for row in mine])
    by_seed = [float(steps[seeds == seed].mean()) for seed in np.unique(seeds)]
    due, wrong = of("shadow_rays_due", rows).sum(), of("wrong", rows).sum()
    seconds = of("processor_seconds", mine).sum()
    return Line(
        scene=scene,
        width=width,
        height=height,
        settings=words,
        method=method,
        frames=len(rows),
        steps=float(steps.mean()) if pairs else NOTHING,
        spread=float(np.std(by_seed)) if len(by_seed) > 1 else NOTHING,
        tests=float(tests.mean()) if pairs else NOTHING,
        known=saved_of({name: of(name, rows) for name in FIGURES}) / max(float(due), 1.0),
        wrong=int(wrong),
        wrong_part=wrong_part(method, wrong, due, width * height * len(rows)),
        verified=all(data["verify"][row] for row in rows),
        seconds=float(np.median(of("processor_seconds", rows))),
        speed_up=float(of("processor_seconds", theirs).sum() / seconds) if seconds > 0 else NOTHING,
    )


def _moment(data: dict[str, list[Any]], row: int) -> tuple[Any, ...]:
    """What a frame of a method and one of the reference must have in common, within a group."""
    return data["seed"][row], data["path_frames"][row], data["frame"][row]


def _shown(value: Any) -> str:
    return "as in the scene" if value is None else f"{value:g}" if isinstance(value, float) else str(value).lower()
