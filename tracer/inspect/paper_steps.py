"""The paper's text run line by line for one pixel: `tracer.reference`, §2.3 to §2.6, on the data of a real frame.

The text is that module's own source, as plain Python under a trace function, which notes what each line reads and
writes.  It is given what the frame had: the primitives at all pixels, modes and counts before it, and the world, which
answers shadow rays.  What concerns the pixel runs: that it is compared with two reference pixels, its shadow rays, and
mode setting of the primitives that these speak of.  What other pixels add to that is taken from the frame.
"""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, lru_cache
from types import FrameType, FunctionType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tracer import reference
from tracer.culling.cells import primitives_are_units
from tracer.culling.modes import MAX_CULLED_LIGHTS, OcclusionMode, ShadowMode, occlusion_mode, shadow_mode
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

_STEPPED = {one.py_func.__code__ for one in (
    reference.compare_pixel, reference._test_one, reference.reached_by_light, reference.set_shadow_modes_of,
    reference.set_occlusion_mode_of)}  # fmt: skip
_HITS_ALONE = hits_alone.py_func.__code__
FIRST, END = "# --- §2.3", "# --- shading"
"""Where the text begins in the module, and what comes after it."""
SECTIONS = {"2.3": "occlusion testing", "2.4": "shadow testing", "2.5": "shadow-mode setting",
            "2.6": "occlusion-mode setting"}  # fmt: skip
_MODES = {"occlusion": OcclusionMode, "mode": OcclusionMode, "shadow": ShadowMode, "found": ShadowMode}
_NAME = re.compile(r"([A-Za-z_][\w.]*)(?:\[([^\]]*)\])?")
_PRIMITIVES = ("current", "primitive", "p")  # names of primitives in the text


class Value(NamedTuple):
    """A name as its line has it, with numbers for indices; what it is after the line; what it was, if that is new."""

    name: str
    text: str
    before: str = ""

    def __str__(self) -> str:
        return f"{self.name}: {self.before} → {self.text}" if self.before else f"{self.name} = {self.text}"


class Part(NamedTuple):
    """What runs: a section of the paper, for a primitive, and for a light where ray number `ray` of the pixel ends."""

    section: str
    primitive: int = MISS
    light: int = -1
    ray: int = -1


class Step(NamedTuple):
    """A line that acts: its number in the module, the values that it reads and writes, the pixels and primitives that
    it speaks of, and whether it changes a mode; a `note` says where else values come from."""

    part: Part
    line: int
    values: tuple[Value, ...] = ()
    pixels: tuple[Pixel, ...] = ()
    primitives: tuple[int, ...] = ()
    changes: bool = False
    note: str = ""


@dataclass(frozen=True)
class PaperSteps:
    """The steps of a pixel of a frame; its rays in words, with their bounces; and the modes that the steps leave: by
    primitive, its occlusion mode and its shadow modes."""

    x: int
    y: int
    method: str
    steps: tuple[Step, ...]
    rays: dict[int, str]
    modes: dict[int, tuple[int, list[int]]]

    @property
    def changes(self) -> bool:
        """Whether any step changes a mode."""
        return any(step.changes for step in self.steps)

    @property
    def remark(self) -> str:
        """What is to be known of these steps where the frame has not taken them."""
        own = Method.parse(self.method).kind.name == "paper"
        return "" if own else f"Traced by {title_of(self.method)}: these are the steps that Paper would take."

    def heading(self, step: Step, scene: Scene) -> str:
        """Say what a step's line runs for."""
        part, said = step.part, f"§{step.part.section} {SECTIONS[step.part.section]}"
        if part.primitive == MISS:
            return f"{said}, {'all pixels' if step.note else f'pixel {self.x},{self.y}'}"
        said += f", {primitive_in_words(scene, part.primitive)}"
        return said if part.light < 0 else f"{said}, {named_light(scene.lights, part.light)}, {self.rays[part.ray]}"


def paper_steps(renderer: Renderer, frame: Frame, x: int, y: int, cancelled: Cancel = None) -> PaperSteps:
    """Run the paper's text for a pixel of the renderer's last frame, all of which is there, in the order of the text.

    Raises ValueError, in one line, if the text does not speak of such a frame, and else what `ray_tree` raises."""
    work, title = renderer.work_on(frame), title_of(frame.settings.method)
    if not frame.settings.keeps_modes:
        raise ValueError(f"{title} keeps no modes of the paper; the method paper does")
    if len(work.first):
        raise ValueError(f"{title} keeps modes of cells, and the text speaks of primitives, as the method paper does")
    for lamp in np.flatnonzero(np.diff(work.shading.lamps.first) > 1).tolist():
        name = named_light(renderer.scene.lights, lamp)
        raise ValueError(f"the text knows points of light, and {name} has several samples")
    return _Run(renderer, frame, x, y, cancelled).steps()


# --- the text ----------------------------------------------------------------------------------------


@cache
def text() -> dict[int, str]:
    """The lines of §2.3 to §2.6, by their numbers in the module."""
    lines = inspect.getsource(reference).splitlines()
    first, end = (next(i for i, line in enumerate(lines) if line.startswith(mark)) for mark in (FIRST, END))
    return dict(enumerate(lines[first : end - 2], first + 1))


_compiled = lru_cache(4096)(compile)


def _values(frame: FrameType, line: int) -> dict[str, str]:
    """The local names that stand in a line, with numbers for indices, in words; no index is before the first."""
    found, known = {}, dict(frame.f_locals)
    for name, index in _NAME.findall(text()[line].partition("#")[0]):
        if name.partition(".")[0] in known:
            numbers = ", ".join(str(known.get(one, one)) for one in index.split(", "))
            name = f"{name}[{numbers}]" if index else name
            with suppress(IndexError):  # a light that has no modes
                if "-" not in numbers:
                    value = eval(_compiled(name, reference.__name__, "eval"), frame.f_globals, known)
                    found[name] = in_words(name, value)
    return found


def in_words(name: str, value: Any) -> str:
    """Return a value of the text as it is shown, modes in binary; "" for what holds many, and for one coordinate."""
    last = name.partition("[")[0].rpartition(".")[2]
    if isinstance(value, tuple) and len(value) == 3:
        return f"({', '.join(f'{one:.4g}' for one in value)})"
    if isinstance(value, bool | np.bool_):
        return str(bool(value))
    if isinstance(value, int | np.integer):
        if last in _MODES:
            return f"{int(value):02b} {_MODES[last](int(value)).name}"
        return "MISS" if last in _PRIMITIVES and value == MISS else str(value)
    return f"{value:g}" if isinstance(value, float) else ""


# --- running it --------------------------------------------------------------------------------------


class _Run:
    """One pixel's run: with the data of the frame, for the primitives that its rays and reference pixels see."""

    def __init__(self, renderer: Renderer, frame: Frame, x: int, y: int, cancelled: Cancel) -> None:
        self._world, self._frame, self._cancelled = renderer.world, frame, cancelled
        self._steps: list[Step] = []
        self._begun: dict[FrameType, tuple[int, dict[str, str]]] = {}  # the step that acts, and values before it
        self._tree = tree = ray_tree(renderer, frame, x, y, cancelled)
        self._rays = [tree.rays[one] for one in _in_order(tree, -1) if tree.rays[one].shadows is not None]
        seen = frame.primitive[[y, y, max(y - 1, 0)], [x, max(x - 1, 0), x]].tolist()
        self._concerned = sorted({*seen, *(ray.primitive for ray in self._rays)} - {MISS})
        lights, work = min(frame.lights, MAX_CULLED_LIGHTS), renderer.work_on(frame)

        def zeros(kind: type, *shape: int) -> Any:  # of which what stays zero takes no memory
            return np.zeros((len(frame.modes), *shape), kind)

        modes = reference.Modes(zeros(np.uint8), zeros(np.uint8, lights), zeros(np.int32), zeros(np.int32))
        for one in self._concerned:
            modes.occlusion[one] = occlusion_mode(frame.modes_before[one])
            modes.shadow[one] = [shadow_mode(frame.modes_before[one], light) for light in range(lights)]
            modes.highest_count[one] = renderer.highest_before[one]
        self._work = reference.Work(
            world=self._world.placed, shading=work.shading, camera=work.rays, lights=tree.samples, modes=modes,
            primitive=frame.primitive, occluded=zeros(np.bool_), found=zeros(np.uint8, lights),
            counts=np.zeros(len(reference.COUNTED), np.int64),
        )  # fmt: skip

    def steps(self) -> PaperSteps:
        """Run the text, section by section."""
        run, work, modes, frame, tree = self._run, self._work, self._work.modes, self._frame, self._tree
        settings, concerned = frame.settings, self._concerned
        run(Part("2.3"), as_python(reference.compare_pixel), work, tree.x, tree.y, settings.symmetric)
        self._test_shadows()
        for one in concerned:  # a frame does not keep what repeats known modes
            gained = frame.modes[one] & ~frame.modes_before[one]
            work.found[one] |= [shadow_mode(gained, light) for light in range(work.found.shape[1])]
        self._join_others("2.5", reference.set_shadow_modes)
        for one in concerned:
            run(Part("2.5", one), as_python(reference.set_shadow_modes_of), work, one)
        occlusion_testing(
            work.world, work.camera, work.primitive, primitives_are_units(), work.primitive, settings.symmetric,
            0, frame.height, np.zeros_like(frame.modes), work.occluded,
        )  # fmt: skip
        modes.pixel_count[concerned] = frame.pixel_count[concerned]
        self._join_others("2.6", reference.set_occlusion_modes)
        for one in concerned:
            run(Part("2.6", one), as_python(reference.set_occlusion_mode_of), work, one, settings.zoom_factor)
        left = {one: (int(modes.occlusion[one]), modes.shadow[one].tolist()) for one in concerned}
        rays = {ray.number: f"{ray.kind.value} ray {ray.bounce or ''}".rstrip() for ray in self._rays}
        return PaperSteps(tree.x, tree.y, settings.method, tuple(self._steps), rays, left)

    def _join_others(self, section: str, function: Any) -> None:
        """Note at the head of a function that what other pixels have found counts from here on."""
        line = function.py_func.__code__.co_firstlineno + 1
        note = "What other pixels have found is included from here on."
        self._steps.append(Step(Part(section), line, primitives=tuple(self._concerned), note=note))

    def _test_shadows(self) -> None:
        plain = as_python(reference.reached_by_light)
        reached = FunctionType(plain.__code__, {**plain.__globals__, "_blocked": self._blocked}, plain.__name__)
        for ray in self._rays:
            assert ray.shadows is not None, "it has hit something"
            for light in np.flatnonzero(ray.shadows.verdict != AWAY).tolist():
                if self._cancelled is not None and self._cancelled():
                    raise Cancelled("cancelled")
                part = Part("2.4", ray.primitive, light, ray.number)
                self._run(part, reached, self._work, ray.primitive, tuple(ray.end), light)

    def _run(self, part: Part, function: Callable, *arguments: Any) -> None:
        """Run a function."""
        self._part, before = part, sys.gettrace()
        sys.settrace(self._call)
        try:
            with np.errstate(all="ignore"):
                function(*arguments)
        finally:
            sys.settrace(before)

    def _answer(self, name: str, text: str, *primitives: int) -> None:
        """Note what the line that acts was answered."""
        step = self._steps[-1]
        values, spoken_of = (*step.values, Value(name, text)), (*step.primitives, *primitives)
        self._steps[-1] = step._replace(values=values, primitives=spoken_of)

    def _call(self, frame: FrameType, _event: str, _argument: Any) -> Callable | None:
        return self._go_on if frame.f_code in _STEPPED or frame.f_code is _HITS_ALONE else None

    def _go_on(self, frame: FrameType, event: str, argument: Any) -> Callable:
        if frame in self._begun:
            self._end(*self._begun.pop(frame), frame)
        if event == "return" and isinstance(argument, bool | np.bool_):
            self._answer("hits_alone" if frame.f_code is _HITS_ALONE else "returns", str(bool(argument)))
        elif event == "line" and frame.f_code in _STEPPED:
            self._begun[frame] = len(self._steps), _values(frame, frame.f_lineno)
            self._steps.append(Step(self._part, frame.f_lineno))
        return self._go_on

    def _end(self, place: int, before: dict[str, str], frame: FrameType) -> None:
        """Note what has become of a line's values, and what it speaks of."""
        step, values = self._steps[place], []
        for name, now in _values(frame, step.line).items():
            was = before.get(name, "")
            values += [Value(name, now, was if was != now else "")] if now else []
        pixels, primitives = _spoken_of(frame.f_locals)
        changes = any(one.before and one.name.startswith(("modes.occlusion", "modes.shadow")) for one in values)
        told, spoken_of = (*values, *step.values), (*primitives, *step.primitives)  # answers come last
        self._steps[place] = Step(step.part, step.line, told, pixels, spoken_of, changes)

    def _blocked(self, _world: Any, ray: Any, which: int, _cost: Any) -> bool:
        """Ask the frame's world what is in the way."""
        found, _ = self._world.occluders_each(ray_batch([ray[:3]], [ray[3:6]], ray.t_min, ray.t_max), which)
        by = int(found[0])
        self._answer("_blocked", "False" if by == MISS else f"True, by {by}", *[by] * (by != MISS))
        return by != MISS


def _in_order(tree: RayTree, parent: int) -> Iterator[int]:
    """The rays of a pixel as the reference follows them: each, then what it has sent on."""
    for number in tree.children.get(parent, ()):
        yield number
        yield from _in_order(tree, number)


def _spoken_of(names: Mapping[str, Any]) -> tuple[tuple[Pixel, ...], tuple[int, ...]]:
    """The pixels and primitives that local names stand for."""
    places = [(names[x], names[y]) for x, y in (("x", "y"), ("rx", "ry")) if y in names]
    pixels = [place for place in places if min(place) >= 0]
    primitives = [names[name] for name in _PRIMITIVES if name in names]
    primitives += [names["work"].primitive[y, x] for x, y in pixels[1:]]
    return tuple(pixels), tuple(int(one) for one in primitives if one != MISS)
