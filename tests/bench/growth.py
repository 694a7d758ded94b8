"""How the cost of a ray grows with the number of triangles: it must be with their logarithm.

    make growth                                 10,000 to 2,000,000 triangles
    make growth ARGS="--most 200000"            fewer

One model is subdivided further and further; the rays stay the same, but for where
shadow rays end.  Each batch of rays is asked on
one thread, several times, and the least of the thread's own seconds counts.  The model is the same
surface however fine, so that nearly all rays must find what they found in the coarsest.

Rays that have nothing in common must cost what lies on a line over the logarithm; their time bends up
where the tree outgrows the processor's caches.  Neighbouring rays go together, and the smaller the
triangles are, the fewer see the same one: they gain less and less, but must never cost more than
rays alone.  A run where either does not hold ends with exit code 1.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter
from numpy.typing import NDArray
from rich.table import Table

from tests.bench.frame_times import machine
from tests.bench.meshes import bumpy_sphere, frequency_for
from tests.bench.rays import Surfaces, incoherent_rays, points_of, primary_rays, shadow_rays
from tests.tracing.worlds import scene
from tracer.experiments.figures import COLORS, SIZE, file_of, styled
from tracer.geometry.queries import STEPS, TESTS, batch_of
from tracer.geometry.rays import Hits, Rays
from tracer.geometry.world import World
from tracer.scene.model import Camera
from viewer.cli.console import print_table
from viewer.util.messages import say

KINDS = ("primary", "shadow", "incoherent")
CAMERA = Camera((0.6, 0.9, 2.6), (-0.2, -0.3, -0.93), angle=40.0)
LIGHT = (1.6, 1.2, 0.4)  # so near that bumps throw shadows
LEAST_R2 = 0.9  # of the variation of what incoherent rays cost, by a line over the logarithm
SAME_T, LEAST_SAME = 0.02, 0.95


def ask(world: World, kind: str, rays: Rays, repeats: int) -> tuple[dict[str, float], Hits]:
    """What a batch costs a ray on one thread, and its nearest hits; t of a shadow ray is 0 where it is blocked."""
    n = len(rays.t_min)
    hits = Hits(np.zeros(n, np.float32), np.zeros(n, np.int32), np.zeros(n, np.float32), np.zeros(n, np.float32))
    blocked = np.zeros(n, np.uint8)
    batch = batch_of(rays, blocked=blocked) if kind == "shadow" else batch_of(rays, hits)
    query = world.structure.any_hit if kind == "shadow" else world.structure.closest
    took = []
    for _ in range(repeats):
        counts = np.zeros(2, np.int64)
        before = time.thread_time()
        query.call(world.placed.data, batch.ctypes.data, 0, n, counts.ctypes.data)
        took.append(time.thread_time() - before)
    hits.t[:] = np.where(blocked != 0, 0.0, 1.0) if kind == "shadow" else hits.t
    return {"ns": 1e9 * min(took) / n, "steps": counts[STEPS] / n, "tests": counts[TESTS] / n}, hits


def same(kind: str, one: NDArray[np.float32], other: NDArray[np.float32]) -> float:
    """The share of rays that meet the surface at the same place, or miss it in both.

    Shadow rays are not the same ones: of them, how near the shares of those that are blocked lie to each other."""
    if kind == "shadow":
        return 1.0 - abs(float(one.mean()) - float(other.mean()))
    both = np.isfinite(one) & np.isfinite(other)
    apart = np.abs(np.subtract(one, other, where=both, out=np.zeros_like(one)))
    return float(((np.isfinite(one) == np.isfinite(other)) & (apart < SAME_T)).mean())


def measure(sizes: list[int], side: int, repeats: int) -> dict[str, Any]:
    """Costs by kind of ray, one for each size; `faults` says what was not as it must be."""
    rows: dict[str, Any] = {"triangles": [], "build_seconds": [], **{kind: [] for kind in KINDS}}
    rays: dict[str, Rays] = {}
    found: dict[str, NDArray[np.float32]] = {}
    faults = []
    for size in sizes:
        made = scene(bumpy_sphere(frequency_for(size)), lights=[LIGHT], camera=CAMERA)
        before = time.perf_counter()
        world = World(made, accelerator="bvh8")
        rows["build_seconds"].append(time.perf_counter() - before)
        rows["triangles"].append(made.triangle_count)
        if not rays:
            rays["primary"] = primary_rays(CAMERA, side, side)
            rays["incoherent"] = incoherent_rays(world.bounds(), side * side, 1)
        # To the points that this mesh shows: those of a coarser one lie inside it.
        points = points_of(Surfaces.of(made, 0.0), rays["primary"], world.closest_hits(rays["primary"]))
        rays["shadow"] = shadow_rays(points, np.array(LIGHT, np.float32))[0]
        for kind in KINDS:
            cost, hits = ask(world, kind, rays[kind], repeats)
            rows[kind].append(cost)
            share = same(kind, found.setdefault(kind, hits.t.copy()), hits.t)
            if share < LEAST_SAME:
                faults.append(f"{made.triangle_count} triangles: only {share:.1%} of {kind} rays find the same surface")
    return rows | {"rays": {kind: len(rays[kind].t_min) for kind in KINDS}, "faults": faults}


def fit(triangles: list[int], costs: list[float]) -> dict[str, float]:
    """cost = at_least + doubling * log2(triangles / the fewest), how much of the variation that is (r2), and
    the power of the number of triangles that the cost grows like."""
    x, y = np.log2(np.array(triangles) / triangles[0]), np.array(costs)
    doubling, least = np.polyfit(x, y, 1)
    left = y - (least + doubling * x)
    power = np.polyfit(x, np.log2(y), 1)[0]
    r2 = 1.0 - (left**2).sum() / max(((y - y.mean()) ** 2).sum(), 1e-30)
    return {"at_least": float(least), "doubling": float(doubling), "r2": float(r2), "power": float(power)}


def fits(rows: dict[str, Any]) -> dict[str, dict[str, dict[str, float]]]:
    """Of each kind of ray, of its time and of its steps."""
    return {
        kind: {what: fit(rows["triangles"], [cost[what] for cost in rows[kind]]) for what in ("ns", "steps")}
        for kind in KINDS
    }


def misses(rows: dict[str, Any], fitted: dict[str, dict[str, dict[str, float]]]) -> list[str]:
    """What does not grow as it must."""
    found = [
        f"incoherent rays, {what}: a logarithm explains only {f['r2']:.0%}"
        for what, f in fitted["incoherent"].items()
        if f["r2"] < LEAST_R2
    ]
    for kind in ("primary", "shadow"):
        for triangles, together, alone in zip(rows["triangles"], rows[kind], rows["incoherent"]):
            if together["ns"] > alone["ns"]:
                found.append(f"{triangles:,} triangles: {kind} rays cost more than incoherent ones")
    return found


def table(rows: dict[str, Any]) -> Table:
    """Nanoseconds and steps a ray, size by size."""
    made = Table(title="Cost of a ray, one thread", title_justify="left", title_style="bold")
    made.add_column("triangles", justify="right")
    made.add_column("built, s", justify="right")
    for kind in KINDS:
        made.add_column(f"{kind}, ns", justify="right")
        made.add_column("steps", justify="right")
    for i, triangles in enumerate(rows["triangles"]):
        costs = [text for kind in KINDS for text in (f"{rows[kind][i]['ns']:.0f}", f"{rows[kind][i]['steps']:.3f}")]
        made.add_row(f"{triangles:,}", f"{rows['build_seconds'][i]:.2f}", *costs)
    return made


def fit_table(fitted: dict[str, dict[str, dict[str, float]]]) -> Table:
    made = Table(
        "rays", "cost", title="cost = c + d × log2(triangles)", title_justify="left", title_style="bold",
        caption="power: that of the number of triangles which grows most like the cost", caption_justify="left",
    )  # fmt: skip
    for heading in ("at the fewest", "a doubling adds", "R²", "power"):
        made.add_column(heading, justify="right")
    for kind, costs in fitted.items():
        for what, f in costs.items():
            numbers = (f"{f['at_least']:.4g}", f"{f['doubling']:.3g}", f"{f['r2']:.3f}", f"{f['power']:.3f}")
            made.add_row(kind, {"ns": "time, ns"}.get(what, what), *numbers)
    return made


@styled()
def plot(rows: dict[str, Any], fitted: dict[str, dict[str, dict[str, float]]]) -> Figure:
    """Time and steps a ray over the number of triangles, on a logarithmic axis, with the lines fitted to them."""
    figure = Figure(figsize=SIZE, layout="constrained")
    panels = figure.subplots(1, 2)
    triangles = np.array(rows["triangles"])
    for panel, what, label in zip(panels, ("ns", "steps"), ("Nanoseconds a ray", "Steps a ray")):
        for kind, color in zip(KINDS, COLORS):
            f = fitted[kind][what]
            panel.plot(triangles, [cost[what] for cost in rows[kind]], "o", color=color, label=f"{kind} rays")
            line = f["at_least"] + f["doubling"] * np.log2(triangles / triangles[0])
            panel.plot(triangles, line, "-", color=color, linewidth=1.2)
        panel.set_xscale("log")
        panel.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:,.0f}"))
        panel.set_ylim(bottom=0.0)
        panel.set_xlabel("Triangles")
        panel.set_ylabel(label)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    figure.suptitle("The same surface in more and more triangles; lines: c + d log n", x=0.01, ha="left", fontsize=18.0)
    return figure


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="make growth", description=__doc__.splitlines()[0])
    parser.add_argument("--fewest", type=int, default=10_000, help="triangles (default: 10000)")
    parser.add_argument("--most", type=int, default=2_000_000, help="triangles (default: 2000000)")
    parser.add_argument("--sizes", type=int, default=9, help="how many, evenly on a logarithmic scale (default: 9)")
    parser.add_argument("--side", type=int, default=512, help="pixels of the picture's side (default: 512)")
    parser.add_argument("--repeats", type=int, default=5, help="of which the least counts (default: 5)")
    parser.add_argument("--json", type=Path, default=Path("out/growth.json"), help="(default: out/growth.json)")
    parser.add_argument("--plot", type=Path, default=Path("out/growth.png"), help="(default: out/growth.png)")
    options = parser.parse_args(arguments)
    if not 20 <= options.fewest < options.most or options.sizes < 2 or options.repeats < 1 or options.side < 1:
        parser.error("nothing to measure: --fewest is at least 20 and less than --most, --sizes at least 2")
    sizes = [round(size) for size in np.geomspace(options.fewest, options.most, options.sizes)]
    World(scene(bumpy_sphere(2)), accelerator="bvh8")  # untimed: kernels
    rows = measure(sizes, options.side, options.repeats)
    fitted = fits(rows)
    for path in (options.json, options.plot):
        path.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps({"machine": machine(), "costs": rows, "fits": fitted}, indent=1) + "\n")
    options.plot.write_bytes(file_of(plot(rows, fitted), options.plot.suffix))
    print_table(table(rows))
    print_table(fit_table(fitted))
    print(f"all figures in {options.json}, drawn in {options.plot}")
    missed = misses(rows, fitted)
    for miss in missed:
        say(miss)
    for fault in rows["faults"]:
        say(f"not to be trusted: {fault}")
    return 1 if rows["faults"] or missed else 0


if __name__ == "__main__":
    sys.exit(main())
