"""The paper's text run line by line for one pixel: `tracer.reference`, §2.3 to §2.6, on the data of a real frame.

Nothing is written twice.  The text is that module's own source, and it runs as plain Python under a trace function,
which notes what each line reads and writes.  It is given what the frame really had: the primitives at all pixels, the
modes and counts before it, and the world as it was placed, which answers the shadow rays.  What concerns the pixel is
run: its comparison with the two reference pixels, its shadow rays at all bounces, and the mode setting of the
primitives that these speak of.  What other pixels add before modes are set is taken from the frame, in a step of its
own.
"""

from __future__ import annotations

import ast
import inspect
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from types import CodeType, FrameType, FunctionType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer import reference
from tracer.culling.cells import primitives_are_units
from tracer.culling.modes import DYNAMIC, MAX_CULLED_LIGHTS, OcclusionMode, ShadowMode, occlusion_mode, shadow_mode
from tracer.culling.occlusion import occlusion_testing
from tracer.geometry.as_python import as_python
from tracer.geometry.queries import hits_alone
from tracer.geometry.rays import MISS, ray_batch
from tracer.inspect.occluded_by import Pixel
from tracer.inspect.path_records import AWAY, RayTree
from tracer.inspect.ray_tree import Cancel, ray_tree
from tracer.inspect.why_in_words import primitive_in_words
from tracer.method import Method, title_of
from tracer.scene.lights import named_light
from tracer.scene.model import Cancelled, Scene

if TYPE_CHECKING:
    from tracer.frame import Frame
    from tracer.renderer import Renderer

FIRST, END = "# --- §2.3", "# --- shading"
"""Where the text begins in the module, and what comes after it."""
OTHERS = "The frame's other pixels:"
_MODES = {"occlusion": OcclusionMode, "mode": OcclusionMode, "shadow": ShadowMode, "found": ShadowMode}
_PRIMITIVES = ("current", "primitive", "p")  # names of primitives in the text
_SECTIONS = {"2.3": "occlusion testing", "2.4": "shadow testing", "2.5": "shadow-mode setting",
             "2.6": "occlusion-mode setting"}  # fmt: skip


class Value(NamedTuple):
    """A name as its line has it, with numbers for indices; what it is after the line; and, where the line has changed
    it, what it was."""

    name: str
    text: str
    before: str = ""

    def __str__(self) -> str:
        return f"{self.name}: {self.before} → {self.text}" if self.before else f"{self.name} = {self.text}"


class Part(NamedTuple):
    """What runs: the section of the paper, for the pixel, for a light at a point of a primitive, which is where ray
    number `ray` of the pixel ends, or for a primitive."""

    section: str
    primitive: int = MISS
    light: int = -1
    ray: int = -1


class Step(NamedTuple):
    """A line that acts: its number in the module, the values that it reads and writes, the pixels and the primitives
    that it speaks of, and whether it changes a mode; `note` says so where something else has brought its values."""

    part: Part
    line: int
    values: tuple[Value, ...] = ()
    pixels: tuple[Pixel, ...] = ()
    primitives: tuple[int, ...] = ()
    changes: bool = False
    note: str = ""


class Segment(NamedTuple):
    """A shadow ray: where its light is, where it is blocked, or ends, and where it ends, (3,) each."""

    start: NDArray[np.float32]
    stop: NDArray[np.float32]
    end: NDArray[np.float32]


@dataclass(frozen=True, eq=False)  # arrays cannot be compared as one
class PaperSteps:
    """The steps of a pixel of a frame; its shadow rays by ray and light; and the modes that the steps leave, (occlusion,
    shadow modes), of the primitives that they speak of."""

    x: int
    y: int
    method: str
    steps: tuple[Step, ...]
    segments: dict[tuple[int, int], Segment]
    modes: dict[int, tuple[int, tuple[int, ...]]]

    @property
    def remark(self) -> str:
        """What is to be known of these steps where the frame has not made them."""
        if Method.parse(self.method).kind.name == "paper":
            return ""
        return (
            f"The picture is traced by {title_of(self.method)}. These are the steps that the paper's method would take, "
            "with the modes that it would have."
        )

    def heading(self, step: Step, scene: Scene) -> str:
        """Say what a step's line is run for."""
        part = step.part
        said = f"§{part.section} {_SECTIONS[part.section]}"
        if step.note or part.section == "2.3":
            return f"{said}, {'all pixels' if step.note else f'pixel {self.x},{self.y}'}"
        where = primitive_in_words(scene, part.primitive)
        bounced = f", met by ray {part.ray} of the pixel" if part.ray > 0 else ""
        return f"{said}, {where}" + (f", {named_light(scene.lights, part.light)}{bounced}" if part.light >= 0 else "")


def paper_steps(renderer: Renderer, frame: Frame, x: int, y: int, cancelled: Cancel = None) -> PaperSteps:
    """Run the paper's text for a pixel.

    Parameters
    ----------
    renderer : Renderer
        The renderer that made the frame; its world must still be placed for it.
    frame : Frame
        The picture, all of it.
    x, y : int
        Column and row of the pixel.
    cancelled : callable, optional
        Asked now and then.

    Returns
    -------
    PaperSteps
        The steps, in the order of the text.

    Raises
    ------
    ValueError
        If the text does not speak of such a frame; the message is one line.
    IndexError
        If the picture has no such pixel.
    LookupError
        If the renderer has begun another frame.
    Cancelled
        Once `cancelled()` is true.
    """
    if problem := why_not(renderer, frame):
        raise ValueError(problem)
    tree = ray_tree(renderer, frame, x, y, cancelled)
    return _Run(renderer, frame, tree, cancelled).steps()


def why_not(renderer: Renderer, frame: Frame) -> str:
    """Return why there are no steps of a frame; "" where there are."""
    work, title = renderer.work_on(frame), title_of(frame.settings.method)
    if not frame.settings.keeps_modes:
        return f"{title} keeps no modes of the paper"
    if len(work.first):
        return f"{title} keeps modes of cells, and the text speaks of primitives"
    several = np.flatnonzero(np.diff(work.shading.lamps.first) > 1)
    if len(several):
        lamp = named_light(renderer.scene.lights, int(several[0]))
        return f"the text knows lights that are points, and {lamp} has several samples"
    return ""


# --- the text ----------------------------------------------------------------------------------------


@cache
def text() -> tuple[tuple[int, str], ...]:
    """The lines of §2.3 to §2.6, with their numbers in the module."""
    lines = list(enumerate(inspect.getsource(reference).splitlines(), 1))
    first, end = (next(i for i, (_, line) in enumerate(lines) if line.startswith(mark)) for mark in (FIRST, END))
    return tuple(lines[first : end - 2])


@cache
def _statements() -> dict[int, ast.stmt]:
    """The module's statements by their lines."""
    return {one.lineno: one for one in ast.walk(ast.parse(inspect.getsource(reference))) if isinstance(one, ast.stmt)}


@cache
def _line_of(function: str) -> int:
    """The line that defines a function."""
    found = (line for line, one in _statements().items() if isinstance(one, ast.FunctionDef) and one.name == function)
    return next(found)


@cache
def _codes() -> frozenset[CodeType]:
    """The functions whose lines are steps."""
    stepped = (
        reference.compare_pixel, reference._test_one, reference.reached_by_light, reference.set_shadow_modes_of,
        reference.set_occlusion_mode_of,
    )  # fmt: skip
    return frozenset(one.py_func.__code__ for one in stepped)


Scope = tuple[dict[str, Any], dict[str, Any]]
"""The globals and the locals that a line sees."""


@cache
def _compiled(node: ast.expr) -> CodeType:
    return compile(ast.unparse(node), "the paper's text", "eval")


def _value(node: ast.expr, scope: Scope) -> Any:
    return eval(_compiled(node), *scope)  # of the text itself


def _read(node: ast.AST, scope: Scope) -> Iterator[ast.expr]:
    """Names that a statement reads, in its order, but for those that it need not look at: as after `or`, where what
    stands before that is true."""
    match node:
        case ast.If(test=part) | ast.For(iter=part) | ast.Assign(value=part) | ast.AugAssign(value=part):
            yield from _read(part, scope)
        case ast.BoolOp(op=op, values=[*parts, last]):
            for part in parts:
                yield from _read(part, scope)
                if bool(_value(part, scope)) == isinstance(op, ast.Or):
                    return
            yield from _read(last, scope)
        case ast.IfExp(test=test, body=then, orelse=other):
            yield from _read(test, scope)
            yield from _read(then if _value(test, scope) else other, scope)
        case ast.Call(args=parts):
            for part in parts:
                yield from _read(part, scope)
        case ast.Name() | ast.Attribute() | ast.Subscript():
            yield node
        case _:
            for part in ast.iter_child_nodes(node):
                yield from _read(part, scope)


def _targets(node: ast.AST) -> list[ast.expr]:
    """What a statement writes."""
    match node:
        case ast.Assign(targets=[one]) | ast.AugAssign(target=one) | ast.For(target=one):
            return list(one.elts) if isinstance(one, ast.Tuple) else [one]
    return []


def _name(node: ast.expr, scope: Scope) -> str:
    """A name with numbers for its indices."""
    if not isinstance(node, ast.Subscript):
        return ast.unparse(node)
    indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
    shown = [str(scope[1][one.id]) if isinstance(one, ast.Name) and one.id in scope[1] else ast.unparse(one)
             for one in indices]  # fmt: skip
    return f"{ast.unparse(node.value)}[{', '.join(shown)}]"


def in_words(name: str, value: Any) -> str:
    """Return a value of the text as it is shown, modes in binary; "" for what holds many."""
    last = name.partition("[")[0].rpartition(".")[2]
    if isinstance(value, tuple):
        return f"({', '.join(f'{one:.4g}' for one in value)})" if len(value) == 3 else ""
    if isinstance(value, bool | np.bool_):
        return str(bool(value))
    if isinstance(value, int | np.integer) and last in _MODES:
        return f"{int(value):02b} {_MODES[last](int(value)).name}"
    if last in _PRIMITIVES and value == MISS:
        return "MISS"
    return f"{value:.6g}" if isinstance(value, int | float | np.number) else ""


# --- running it --------------------------------------------------------------------------------------


class _Line(NamedTuple):
    """A line that has begun: its place among the steps, its statement, and what its targets were."""

    place: int
    statement: ast.stmt
    before: dict[str, str]


class _Recorder:
    """Runs functions of the text, and notes their lines."""

    def __init__(self) -> None:
        self.steps: list[Step] = []
        self._part = Part("2.3")
        self._begun: dict[FrameType, _Line] = {}

    def run(self, part: Part, function: Callable, *arguments: Any) -> None:
        """Run a function."""
        self._part, before = part, sys.gettrace()
        sys.settrace(self._call)
        try:
            with np.errstate(all="ignore"):
                function(*arguments)
        finally:
            sys.settrace(before)

    def answer(self, name: str, text: str, *primitives: int) -> None:
        """Note what the line that acts was answered."""
        step = self.steps[-1]
        found = step.primitives + primitives
        self.steps[-1] = step._replace(values=(*step.values, Value(name, text)), primitives=found)

    def _call(self, frame: FrameType, _event: str, _argument: Any) -> Callable | None:
        if frame.f_code is hits_alone.py_func.__code__:
            frame.f_trace_lines = False
            return self._hit
        return self._go_on if frame.f_code in _codes() else None

    def _hit(self, _frame: FrameType, event: str, argument: Any) -> Callable:
        if event == "return":
            self.answer("hits_alone", str(bool(argument)))
        return self._hit

    def _go_on(self, frame: FrameType, event: str, argument: Any) -> Callable:
        scope = frame.f_globals, dict(frame.f_locals)
        line = self._begun.pop(frame, None)
        if line is not None:
            self._finish(line, scope, frame.f_lineno if event == "line" else -1)
        if event == "line":
            self._begin(frame, scope)
        elif event == "return" and isinstance(argument, bool | np.bool_):
            self.answer("returns", str(bool(argument)))
        return self._go_on

    def _begin(self, frame: FrameType, scope: Scope) -> None:
        statement = _statements()[frame.f_lineno]
        reads = [(_name(one, scope), _value(one, scope)) for one in _read(statement, scope) if _is_local(one, scope)]
        values = [Value(name, in_words(name, value)) for name, value in reads]
        written = [one for one in _targets(statement) if isinstance(one, ast.Subscript)]
        before = {name: in_words(name, _value(one, scope)) for one in written for name in [_name(one, scope)]}
        self._begun[frame] = _Line(len(self.steps), statement, before)
        self.steps.append(Step(self._part, frame.f_lineno, tuple(dict.fromkeys(v for v in values if v.text))))

    def _finish(self, line: _Line, scope: Scope, then: int) -> None:
        """Add what a line has written, and what it speaks of; `then` is the line that acts next, -1 for none."""
        step, statement, changes = self.steps[line.place], line.statement, False
        values = list(step.values)
        ended = isinstance(statement, ast.For) and not statement.lineno < then <= (statement.end_lineno or 0)
        for one in () if ended else _targets(statement):
            name, value = _name(one, scope), _value(one, scope)
            now, was = in_words(name, value), line.before.get(name, "")
            changed = was not in ("", now)
            changes |= changed and name.startswith(("modes.occlusion", "modes.shadow"))
            if now:
                values.append(Value(name, now, was if changed else ""))
        pixels, primitives = _spoken_of(scope[1])
        self.steps[line.place] = step._replace(
            values=tuple(values), pixels=pixels, primitives=(*primitives, *step.primitives), changes=changes
        )


def _is_local(node: ast.expr, scope: Scope) -> bool:
    """Whether a name begins with a local one: others are constants of the module."""
    while isinstance(node, ast.Attribute | ast.Subscript):
        node = node.value
    return isinstance(node, ast.Name) and node.id in scope[1]


def _spoken_of(names: dict[str, Any]) -> tuple[tuple[Pixel, ...], tuple[int, ...]]:
    """The pixels and primitives that local names stand for."""
    pixels = [(int(names[x]), int(names[y])) for x, y in (("x", "y"), ("rx", "ry")) if y in names]
    primitives = [int(names[name]) for name in _PRIMITIVES if name in names]
    if "rx" in names and min(pixels[-1]) >= 0:
        primitives.append(int(names["work"].primitive[names["ry"], names["rx"]]))
    return tuple(one for one in pixels if min(one) >= 0), tuple(one for one in primitives if one != MISS)


class _Run:
    """One pixel's run."""

    def __init__(self, renderer: Renderer, frame: Frame, tree: RayTree, cancelled: Cancel) -> None:
        self._renderer, self._frame, self._tree, self._cancelled = renderer, frame, tree, cancelled
        work, world = renderer.work_on(frame), renderer.world.placed
        self._recorder = _Recorder()
        self._rays = [ray for ray in _in_order(tree) if tree.rays[ray].shadows is not None]
        x, y = tree.x, tree.y
        seen = [(x, y), *((x - 1, y),) * (x > 0), *((x, y - 1),) * (y > 0)]
        numbers = {int(frame.primitive[row, column]) for column, row in seen}
        self._concerned = sorted((numbers | {tree.rays[ray].primitive for ray in self._rays}) - {MISS})
        count, lights = len(frame.modes), min(frame.lights, MAX_CULLED_LIGHTS)
        # Zeros take no memory where nothing is written.
        modes = reference.Modes(
            np.zeros(count, np.uint8), np.zeros((count, lights), np.uint8), np.zeros(count, np.int32),
            np.zeros(count, np.int32),
        )  # fmt: skip
        for one in self._concerned:
            modes.occlusion[one] = occlusion_mode(frame.modes_before[one])
            modes.shadow[one] = [shadow_mode(frame.modes_before[one], light) for light in range(lights)]
            modes.highest_count[one] = renderer.highest_before[one]
        occluded, found = np.zeros(count, np.bool_), np.zeros((count, lights), np.uint8)
        counts = np.zeros(len(reference.COUNTED), np.int64)
        self._work = reference.Work(
            world, work.shading, work.rays, tree.samples, modes, frame.primitive, occluded, found, counts
        )

    def steps(self) -> PaperSteps:
        """Run the text, section by section."""
        run, work, settings = self._recorder.run, self._work, self._frame.settings
        modes, compare = work.modes, as_python(reference.compare_pixel)
        run(Part("2.3", self._tree.rays[0].primitive), compare, work, self._tree.x, self._tree.y, settings.symmetric)
        segments = self._shadow_testing()
        self._take_found()
        for one in self._concerned:
            run(Part("2.5", one), as_python(reference.set_shadow_modes_of), work, one)
        self._take_occluded()
        for one in self._concerned:
            run(Part("2.6", one), as_python(reference.set_occlusion_mode_of), work, one, settings.zoom_factor)
        left = {one: (int(modes.occlusion[one]), tuple(modes.shadow[one].tolist())) for one in self._concerned}
        steps = tuple(self._recorder.steps)
        return PaperSteps(self._tree.x, self._tree.y, settings.method, steps, segments, left)

    def _shadow_testing(self) -> dict[tuple[int, int], Segment]:
        plain = as_python(reference.reached_by_light)
        reached = FunctionType(plain.__code__, {**plain.__globals__, "_blocked": self._blocked}, plain.__name__)
        segments = {}
        for number in self._rays:
            ray = self._tree.rays[number]
            assert ray.shadows is not None
            for light in np.flatnonzero(ray.shadows.verdict != AWAY).tolist():
                if self._cancelled is not None and self._cancelled():
                    raise Cancelled("cancelled")
                start, at = self._tree.samples[light], ray.shadows.blocked_at[light]
                stop = start + at * (ray.end - start) if ray.shadows.blocker[light] >= 0 else ray.end
                segments[number, light] = Segment(start, stop, ray.end)
                part = Part("2.4", ray.primitive, light, number)
                self._recorder.run(part, reached, self._work, ray.primitive, tuple(ray.end), light)
        return segments

    def _blocked(self, _world: Any, ray: Any, which: int, _cost: Any) -> bool:
        """Ask the frame's world whether something is in the way."""
        batch = ray_batch([ray[:3]], [ray[3:6]], ray.t_min, ray.t_max)
        found = int(self._renderer.world.occluders_each(batch, which)[0][0])
        if found == MISS:
            self._recorder.answer("_blocked", "False, nothing is in the way")
        else:
            self._recorder.answer("_blocked", f"True, by {found}", found)
        return found != MISS

    # --- what other pixels have found -----------------------------------------------------------------

    def _take_found(self) -> None:
        """The shadow modes that the frame has set; what only repeats known ones is not told."""
        work, frame, values = self._work, self._frame, []
        for one in self._concerned:
            if work.modes.occlusion[one] == DYNAMIC:
                continue
            for light in range(work.found.shape[1]):
                gained = shadow_mode(frame.modes[one] & ~frame.modes_before[one], light)
                values += self._put(work.found, f"work.found[{one}, {light}]", (one, light), work.found[one, light] | gained)
        self._add_others("2.5", "set_shadow_modes", values)

    def _take_occluded(self) -> None:
        """What tests at all pixels have found occluded, and how many pixels see each primitive."""
        work, frame, values = self._work, self._frame, []
        occluded, words = np.zeros(len(frame.modes), np.bool_), np.zeros_like(frame.modes)
        seen = work.world, work.camera, work.primitive, primitives_are_units(), work.primitive
        occlusion_testing(*seen, frame.settings.symmetric, 0, frame.height, words, occluded)
        for one in self._concerned:
            values += self._put(work.occluded, f"work.occluded[{one}]", one, occluded[one])
            values += self._put(work.modes.pixel_count, f"modes.pixel_count[{one}]", one, frame.pixel_count[one])
        self._add_others("2.6", "set_occlusion_modes", values)

    @staticmethod
    def _put(array: NDArray, name: str, at: Any, value: Any) -> list[Value]:
        """Put a value into an array, and return it if it is news."""
        was, array[at] = in_words(name, array[at]), value
        now = in_words(name, array[at])
        return [Value(name, now, was)] if now != was else []

    def _add_others(self, section: str, function: str, values: list[Value]) -> None:
        step = Step(Part(section), _line_of(function), tuple(values), primitives=tuple(self._concerned), note=OTHERS)
        self._recorder.steps.append(step)


def _in_order(tree: RayTree, parent: int = -1) -> Iterator[int]:
    """The pixel's rays in the order in which the reference follows them: each, then what it has sent on."""
    for number in tree.children.get(parent, ()):
        yield number
        yield from _in_order(tree, number)
