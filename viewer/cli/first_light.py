"""What `make run` does without a display: it traces frames of a scene's path by the paper's method, draws the last, and
says what was saved of it, stage by stage of the paper's Figure 1."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from rich.table import Table

from tracer.frame import Frame, Settings
from tracer.geometry.accelerators import BVH8
from tracer.renderer import Renderer
from tracer.scene.load import check_scene_file
from tracer.scene.model import Scene
from tracer.statistics import FrameStatistics
from viewer.cli import options
from viewer.cli.console import Work, print_table, titled, working
from viewer.cli.render import write_picture
from viewer.output import figure1_drawing
from viewer.output.figure1 import TITLE, Stage, figure_of
from viewer.services import stills
from viewer.state.methods import BY_MODES, NO_CULLING
from viewer.state.view_state import ViewState, Warmup
from viewer.util.files import check_writable
from viewer.util.messages import printable
from viewer.util.numbers import percent, saved

FRAMES = 20
"""Of the path: what the first ones teach is what the last one saves."""
PICTURE, FIGURE = Path("out") / "first-light.png", Path("out") / "figure-1.svg"
_SIZE = 640, 480
_AGAIN = 2  # frames by none: the first makes room in memory, the last is timed


def show(path: Path, given: Namespace) -> None:
    """Trace, print and write; raises SceneError, ValueError and OSError in one line, or Cancelled."""
    check_scene_file(path)
    for file in (PICTURE, FIGURE):
        file.parent.mkdir(exist_ok=True)
        check_writable(file)
    lamps = {"lamp_radius": given.lamp_radius, "lamp_samples": given.lamp_samples}
    settings = Settings(*_SIZE, method=BY_MODES, **lamps).validated()
    with working() as work:
        scene = options.read_scene(path, given, work)
        options.prepare_kernels(work, len(scene.lights), settings.accelerator, BY_MODES)
        time = scene.frame_time(min(FRAMES, scene.frames) - 1)
        meshes = options.mesh_options(given).of_file(path)
        state = ViewState(str(path.absolute()), meshes, time=time, settings=settings, warmup=Warmup(of_path=FRAMES - 1))
        frame, all_traced = _trace(scene, state, work)
        work.progress("writing", 1.0)
        write_picture(PICTURE, scene, frame, state)
        figure1_drawing.write_svg(FIGURE, frame, scene)
    frames = len(stills.times_before(scene, time, state.warmup.of_path)) + 1
    print_table(_table(path, state, frames, frame, all_traced))
    for file in (PICTURE, FIGURE):
        print(printable(file.absolute()))


def _trace(scene: Scene, state: ViewState, work: Work) -> tuple[Frame, Frame]:
    """The last frame by the paper's method, and by none."""
    renderer, steps = Renderer(scene, state.settings, work.progress), FRAMES + _AGAIN

    def tell(done: int, frames: int) -> None:
        work.count(f"frame {done + 1} of {frames}, {BY_MODES}", done, steps)

    frame = stills.trace(renderer, state, on_frame=tell, cancelled=work.cancelled)
    beside = renderer.beside()
    beside.settings = replace(state.settings, method=NO_CULLING)
    for again in range(_AGAIN):
        work.count(f"the last frame, {NO_CULLING}", FRAMES + again, steps)
        all_traced = beside.render(state.time, cancel=work.cancelled)
    return frame, all_traced


def _table(path: Path, state: ViewState, frames: int, frame: Frame, all_traced: Frame) -> Table:
    """What each stage did, beside what `none` did, and what that saved."""
    size, end = f"{frame.width} × {frame.height}", f"{state.time:.2f} s"
    title = f"{TITLE}: {path.name}, {size}, the last of {frames} frames, at {end}"
    table = titled(title, _caption(frame, all_traced))
    for name in ("", BY_MODES, "", NO_CULLING, "saved"):
        table.add_column(name, justify="right" if name or len(table.columns) else "left")
    stages = figure_of(frame).stages
    theirs = {stage.name: stage for stage in figure_of(all_traced).stages}
    for stage in stages:
        for row in _rows(stage, theirs.get(stage.name)):
            table.add_row(*row)
    table.add_section()
    for row in _in_all(frame.statistics, all_traced.statistics):
        table.add_row(*row)
    return table


def _rows(stage: Stage, other: Stage | None) -> Iterator[tuple[str, ...]]:
    """A stage and its numbers; of those by `none`, where it has them."""
    theirs = {flow.name: flow for flow in other.flows} if other is not None else {}
    name = f"[bold]{stage.name}[/bold] {stage.section}"
    yield name, stage.time, _as_here(stage.part), other.time if other is not None else "", ""
    for flow in stage.flows:
        known = theirs.get(flow.name)
        yield f"  {flow.name}", f"{flow.number:,}", _as_here(flow.share), f"{known.number:,}" if known else "", ""


def _in_all(ours: FrameStatistics, theirs: FrameStatistics) -> Iterator[tuple[str, ...]]:
    """What the whole frame took."""
    yield "Shadow rays saved", f"{ours.shadow.saved:,}", _as_here(percent(ours.shadow.saved, ours.shadow.due)), "", ""
    for name in ("traversal_steps", "intersection_tests"):
        mine, its = getattr(ours.shadow, name), getattr(theirs.shadow, name)
        yield f"  {name.replace('_', ' ')}", f"{mine:,}", "", f"{its:,}", saved(1.0 - mine / its) if its else ""
    seconds = (f"{1e3 * s.seconds:,.1f} ms" for s in (ours, theirs))
    yield "Frame", next(seconds), "", next(seconds), ""  # one frame's time says nothing of speed


def _caption(frame: Frame, all_traced: Frame) -> str:
    """What the table does not say by itself."""
    differ, pixels = int((frame.color != all_traced.color).any(-1).sum()), frame.width * frame.height
    lines = [f"{differ:,} of {pixels:,} pixels ({percent(differ, pixels)}) differ from those by {NO_CULLING}."]
    if frame.settings.accelerator == BVH8:
        lines.append("Steps and tests are those of packets of rays; bench --accelerator kdtree counts each ray's.")
    lines.append("Times are of one frame each: bench tells the speed-up, over many.")
    return "\n".join(lines)


def _as_here(share: str) -> str:
    """A share as tables of commands write it: 20.5%."""
    return share.replace(" %", "%")
