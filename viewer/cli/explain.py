"""The command `explain`: why the shadow rays of one pixel were culled or traced, and what became of all its rays."""

from __future__ import annotations

import json
from argparse import Namespace
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.text import Text
from rich.tree import Tree

from tracer.experiments.warmup_frames import WarmupFrame
from tracer.frame import Frame
from tracer.method import DEFAULT_METHOD, Method
from tracer.mode_origins import ModeOrigins
from tracer.reasons import Why
from tracer.renderer import Renderer
from tracer.scene.lights import named_light
from tracer.scene.load import check_scene_file, load_visible_scene
from tracer.scene.model import Scene
from tracer.told_rays import RayTree
from tracer.why import why
from viewer.cli.console import working
from viewer.cli.edit_options import edited_scene, light_index
from viewer.cli.mesh_arguments import mesh_options
from viewer.cli.render import times_before
from viewer.cli.tracing_options import moment, prepare_kernels, tracing_settings
from viewer.output.ray_json import ray_data
from viewer.output.ray_rows import RayRows, Row, totals
from viewer.output.why_lines import why_data, why_lines
from viewer.services.teachers import Answers, Teacher, answers_at, can_be_asked, with_teachers
from viewer.state.verdicts import Filter, Shown
from viewer.util.messages import printable


def explain(path: Path, options: Namespace) -> None:
    """Trace a frame, and print the reasons and the tree of a pixel's rays; raises SceneError and ValueError in one
    line, or Cancelled."""
    check_scene_file(path)
    settings = replace(tracing_settings(options), method=options.method or DEFAULT_METHOD)
    x, y = options.pixel
    if not (x < settings.width and y < settings.height):
        raise ValueError(f"--pixel {x},{y}: the picture is {settings.width} x {settings.height}")
    with working() as work:
        read = load_visible_scene(path, work.progress, options.folder, mesh_options(options))
        scene = edited_scene(read, options)
        light = None if options.light is None else light_index(options, "--light ", options.light, scene)
        time = moment(scene, options.frame, options.time)
        prepare_kernels(work, len(scene.lights), options.accelerator, settings.method)
        renderer = Renderer(scene, settings, work.progress)
        times = times_before(scene, time, options.warmup, work)
        times += [time] * _repeats(options)
        before = [*options.before, *(WarmupFrame(then, options.camera) for then in times)]
        ledger, moves = ModeOrigins(len(scene.lights)), _Moves(scene)
        for done, earlier in enumerate(before):
            work.count(f"warming up, frame {done + 1} of {len(before)}", done, len(before) + 1)
            modes = renderer.render(earlier.time, earlier.camera, work.cancelled).modes
            ledger.add(done, modes, moves.since(earlier.time))
        work.count("tracing", len(before), len(before) + 1)
        frame = renderer.render(time, options.camera, work.cancelled)
        found = why(renderer, frame, x, y, work.cancelled)
        work.count("asking which frames have taught it", len(before), len(before) + 1)
        found = _with_teachers(found, renderer, frame, ledger, before)
    tree = found.tree
    assert tree is not None
    if options.json:
        print(json.dumps(ray_data(tree, scene) | {"why": why_data(found, scene)}, indent=2))
        return
    title = f"{path.name}, {time:.3f} s, pixel {x},{y} of {frame.width} × {frame.height}, method {settings.method}"
    _print(found, tree, scene, Filter(Shown(options.only), light), title)


def _repeats(options: Namespace) -> int:
    """How often the frame itself is traced before: as in the window at rest where no others come before it, so that
    what culls by earlier frames has seen one."""
    if options.repeat is not None:
        return int(options.repeat)
    return 0 if options.warmup or options.before else 1


class _Moves:
    """Which lights are elsewhere than they were in the frame before."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._before: NDArray[np.float64] | None = None

    def since(self, time: float) -> NDArray[np.bool_] | None:
        """(lights,) bool, None in the first frame."""
        before, self._before = self._before, self._scene.light_positions(time)
        return None if before is None else (before != self._before).any(axis=1)


def _with_teachers(
    found: Why, renderer: Renderer, frame: Frame, ledger: ModeOrigins, before: Sequence[WarmupFrame]
) -> Why:
    """The same with the frames, and the pixels of these, that gave the primitive its modes."""
    unit = int(frame.cell[found.y, found.x])
    taught = ledger.of(unit) if found.primitive >= 0 and frame.settings.keeps_modes else None
    if taught is None:
        return found

    def name(number: int) -> str:
        return "the frame before" if len(before) == 1 else f"frame {number + 1} of the {len(before)} frames before this"

    @cache
    def answers(number: int) -> Answers | None:
        if not can_be_asked(frame.settings, frame.lights):
            return None
        then, uses_cells = before[number], Method.parse(frame.settings.method).uses_cells
        return answers_at(renderer, then.time, then.camera, frame.settings, unit, uses_cells)

    def teacher(number: int, light: int, lit: bool) -> Teacher | None:
        known = answers(number)
        return None if known is None else known.get((light, lit), Teacher(0, None))

    return with_teachers(found, taught, teacher, name)


def _print(found: Why, tree: RayTree, scene: Scene, shown: Filter, title: str) -> None:
    console = Console()
    if not console.is_terminal:
        console = Console(width=100_000, soft_wrap=True)  # a line for each row, whatever reads it
    console.print(Text(printable(title), "bold"))
    for line in why_lines(found, scene, shown.light):
        console.print(Text(printable(line)))
    said = [totals(tree)]
    if shown != Filter():
        of = "" if shown.light is None else f" of {named_light(scene.lights, shown.light)}"
        said.append(f"shadow rays shown: {shown.shown.value}{of}")
    drawn = Tree(Text("\n".join(said), "bold"), guide_style="dim")
    for row in RayRows(tree, scene, shown).top:
        _add(drawn, row)
    console.print(drawn, markup=False, highlight=False)
    if tree.frame.statistics.decision:
        console.print(Text(tree.frame.statistics.decision, "italic"))


def _add(tree: Tree, row: Row) -> None:
    """A row, and those below it, but for the single samples and lights of many with the same fate."""
    red, green, blue = (round(255 * channel) for channel in row.color)
    below = tree.add(Text(printable(row.text), f"rgb({red},{green},{blue})" if len(row.places) else "bold"))
    if "fate" in row.key:
        return
    for one in row.rows:
        _add(below, one)
