"""The paper's text as it runs for one pixel is what the reference does there, line by line, and ends as the frame."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.tracing.glassy import SCENE
from tests.tracing.random_worlds import Walk, quickly, walks
from tracer import reference
from tracer.culling.modes import occlusion_mode, shadow_mode
from tracer.geometry import as_python as plain
from tracer.geometry.rays import ray_batch
from tracer.inspect.paper_steps import FIRST, PaperSteps, Step, Value, in_words, paper_steps, text
from tracer.reference import Reference, Work
from tracer.scene.load import load_scene
from tracer.scene.model import Cancelled
from tracer.shading import one_ray

TIMES = (5.0, 5.5, 5.5)
ANSWERED = ("hits_alone", "_blocked", "returns")
PIXELS = ((5, 4), (8, 6), (0, 5), (11, 8), (6, 2))


@pytest.fixture(scope="module")
def glassy(tmp_path_factory: pytest.TempPathFactory) -> tracer.Scene:
    path = tmp_path_factory.mktemp("steps") / "scene.aff"
    path.write_text(SCENE)
    return load_scene(path)


# --- each step, against the reference under a trace function of its own -----------------------------------


@pytest.fixture
def in_python(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The whole reference as plain Python, but for the queries; of a scene without textures and highlights."""
    worlds: list[Any] = []

    def nearest(world: Any, ray: Any, _cost: Any) -> tuple:
        hits = worlds[0].closest_hits(ray_batch([ray[:3]], [ray[3:6]], ray.t_min, ray.t_max), threads=1)
        return hits.t[0], hits.primitive[0], hits.u[0], hits.v[0]

    def blocked(world: Any, ray: Any, which: int, _cost: Any) -> bool:
        batch = ray_batch([ray[:3]], [ray[3:6]], ray.t_min, ray.t_max)
        return bool(worlds[0].occluders_each(batch, which)[0][0] >= 0)

    one, nothing = (np.float32(1),) * 3, np.float32(0)
    replaced = {reference._nearest: nearest, reference._blocked: blocked, one_ray.one_color: lambda *_: one,
                one_ray.one_highlight: lambda *_: nothing}  # fmt: skip
    for kernel, function in replaced.items():
        monkeypatch.setitem(plain._PLAIN, id(kernel), function)
    plain.as_python.cache_clear()
    yield worlds
    plain.as_python.cache_clear()


@dataclass
class Hook:
    """Holds the lines of the text that the reference runs for one pixel, and for primitives, against the steps."""

    x: int
    y: int
    width: int
    left: dict[str | int, list[Step]]
    waiting: dict[FrameType, tuple[Step, dict[Value, str]]]

    @classmethod
    def of(cls, found: PaperSteps, width: int) -> Hook:
        left: dict[str | int, list[Step]] = {"pixel": []}
        for step in found.steps:
            if not step.note:
                left.setdefault("pixel" if step.part.section < "2.5" else step.part.primitive, []).append(step)
        return cls(found.x, found.y, width, left, {})

    def steps_of(self, frame: FrameType) -> list[Step] | None:
        """Those that are still to come where this function runs; None where it runs for something else."""
        names, back = frame.f_locals, frame.f_back
        match frame.f_code.co_name:
            case "compare_pixel":
                here = (names["x"], names["y"]) == (self.x, self.y)
            case "_test_one":
                return None if back is None else self.steps_of(back)
            case "reached_by_light":
                assert back is not None and back.f_back is not None
                here = back.f_back.f_locals["i"] == self.y * self.width + self.x
            case "set_shadow_modes_of" | "set_occlusion_mode_of":
                return self.left.get(int(names["primitive" if "primitive" in names else "p"]))
            case _:
                return None
        return self.left["pixel"] if here else None

    def __call__(self, frame: FrameType, event: str, _argument: Any) -> Hook | None:
        if event == "call":
            return self if self.steps_of(frame) is not None else None
        step, before = self.waiting.pop(frame, (None, {}))
        if step is not None:
            for value in step.values:
                self.hold(frame, value, before.get(value, ""))
        if event == "line":
            steps = self.steps_of(frame)
            assert steps, f"line {frame.f_lineno} has no step"
            step = steps.pop(0)
            assert step.line == frame.f_lineno
            self.waiting[frame] = step, {value: self.now(frame, value) for value in step.values}
        return self

    def now(self, frame: FrameType, value: Value) -> str:
        """What a value is now."""
        try:
            return in_words(value.name, eval(value.name, frame.f_globals, dict(frame.f_locals)))
        except NameError:
            return ""

    def hold(self, frame: FrameType, value: Value, before: str) -> None:
        if value.name in ANSWERED or "counts[" in value.name:
            return  # the reference counts for all pixels
        now, sets_mode = self.now(frame, value), frame.f_code.co_name == "set_occlusion_mode_of"
        if value.name.startswith(("work.found", "work.occluded")) and not sets_mode:
            assert value.text == now or "11" in now or now == "True", value  # other pixels may have found more
        else:
            assert value.text == now and value.before in ("", before), value


@pytest.mark.parametrize("symmetric", [False, True])
def test_steps_are_those_of_the_reference(glassy: tracer.Scene, in_python: list, symmetric: bool) -> None:
    settings = tracer.Settings(12, 9, method="paper", threads=1, depth=3, symmetric=symmetric)
    renderer, whole = tracer.Renderer(glassy, settings), Reference(glassy, settings)
    in_python.append(whole.world)
    run = {name: plain.as_python(getattr(reference, name)) for name in
           ("trace_primary_rays", "test_occlusion", "shade", "set_shadow_modes", "set_occlusion_modes")}  # fmt: skip
    for number, (time, pixel) in enumerate(zip((*TIMES, 6.0, 6.0), PIXELS, strict=True)):
        frame = renderer.render(time)
        hook = Hook.of(paper_steps(renderer, frame, *pixel), frame.width)
        steps = sum(map(len, hook.left.values()))
        assert steps > (3 if number else 10)
        work: Work = whole._begin(time, renderer.work_on(frame).rays)
        before = sys.gettrace()
        with np.errstate(all="ignore"):
            hits = run["trace_primary_rays"](work)
            sys.settrace(hook)
            try:
                run["test_occlusion"](work, symmetric)
                run["shade"](work, hits, settings.depth)
                run["set_shadow_modes"](work)
                run["set_occlusion_modes"](work, settings.zoom_factor)
            finally:
                sys.settrace(before)
        assert not any(hook.left.values()), "steps that the reference does not take"
        assert np.array_equal(occlusion_mode(frame.modes), whole.modes.occlusion)


# --- the end of the steps, against the frame ----------------------------------------------------------


def assert_ends_as(found: PaperSteps, frame: tracer.Frame) -> None:
    """The modes that the steps leave are the frame's."""
    for primitive, (occlusion, shadow) in found.modes.items():
        word = frame.modes[primitive]
        assert occlusion == occlusion_mode(word)
        assert shadow == [shadow_mode(word, light) for light in range(len(shadow))]


@quickly(4)
@given(walks(3), st.booleans(), st.sampled_from(["paper", "paper+rest", "certified"]), st.sampled_from([1.0, 4.0]))
def test_steps_end_with_the_modes_of_the_frame(walk: Walk, symmetric: bool, method: str, zoom_factor: float) -> None:
    settings = tracer.Settings(
        20, 14, method=method, threads=1, depth=2, symmetric=symmetric, zoom_factor=zoom_factor, modes=True
    )
    renderer = tracer.Renderer(walk.scene, settings)
    for time, camera in walk.frames:
        frame = renderer.render(time, camera)
        for x, y in ((3, 3), (10, 7), (15, 9)):
            found = paper_steps(renderer, frame, x, y)
            assert_ends_as(found, frame)
            assert (found.remark == "") == method.startswith("paper")


def test_lights_past_the_room_for_modes_have_none(glassy: tracer.Scene) -> None:
    many = replace(glassy, lights=glassy.lights * 11)
    renderer = tracer.Renderer(many, tracer.Settings(12, 9, method="paper", threads=1, depth=0))
    for _ in range(2):
        frame = renderer.render(5.0)
        found = paper_steps(renderer, frame, 5, 4)
        assert_ends_as(found, frame)
    last = [step for step in found.steps if step.part.light >= 31]
    assert last and not any("found" in value.name for step in last for value in step.values)


# --- what is told ------------------------------------------------------------------------------------


def test_the_text_is_that_of_four_sections() -> None:
    lines = list(text().items())
    source = Path(reference.__file__).read_text(encoding="utf-8").splitlines()
    assert [source[number - 1] for number, _ in lines] == [line for _, line in lines]
    assert lines[0][1].startswith(FIRST) and "else:" in lines[-2][1]
    assert [number for number in ("3", "4", "5", "6") if any(f"§2.{number}" in line for _, line in lines)]


def test_values_are_written_as_in_the_paper() -> None:
    assert in_words("modes.occlusion[7]", np.uint8(2)) == "10 FULLY_RENDERED"
    assert in_words("work.found[7, 0]", np.uint8(3)) == "11 PARTIAL_SHADOW"
    assert in_words("current", np.int32(-1)) == "MISS" and in_words("modes.highest_count[7]", np.int32(12)) == "12"
    assert in_words("point", (np.float32(1.5),) * 3) == "(1.5, 1.5, 1.5)" and in_words("counts", np.zeros(3)) == ""
    assert str(Value("a", "2", "1")) == "a: 1 → 2" and str(Value("a", "2")) == "a = 2"


def test_what_acts_speaks_of_pixels_primitives_and_lights(glassy: tracer.Scene) -> None:
    renderer = tracer.Renderer(glassy, tracer.Settings(12, 9, method="paper", threads=1, depth=3))
    frame = renderer.render(5.0)
    found = paper_steps(renderer, frame, 5, 4)
    here, beside = int(frame.primitive[4, 5]), int(frame.primitive[4, 4])
    reads = next(step for step in found.steps if ("rx", "4") in [(v.name, v.text) for v in step.values])
    assert reads.pixels == ((5, 4), (4, 4)) and set(reads.primitives) >= {here} | ({beside} - {-1})
    assert found.heading(reads, glassy) == "§2.3 occlusion testing, pixel 5,4"
    shadow = next(step for step in found.steps if step.part.section == "2.4")
    assert "§2.4 shadow testing" in found.heading(shadow, glassy) and found.rays[0] == "primary ray"
    changes = [step for step in found.steps if step.changes]
    assert changes and {step.part.section for step in changes} <= {"2.5", "2.6"}
    assert [step.note != "" for step in found.steps].count(True) == 2
    with pytest.raises(Cancelled):
        paper_steps(renderer, frame, 5, 4, lambda: True)
    with pytest.raises(IndexError, match="no pixel"):
        paper_steps(renderer, frame, 12, 0)


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"method": "none"}, "keeps no modes of the paper"),
        ({"method": "cells"}, "modes of cells"),
        ({"method": "paper", "lamp_radius": 0.1}, "light 0 has several samples"),
    ],
)
def test_a_frame_of_which_the_text_does_not_speak(glassy: tracer.Scene, settings: dict, said: str) -> None:
    renderer = tracer.Renderer(glassy, tracer.Settings(12, 9, threads=1, depth=0, **settings))
    with pytest.raises(ValueError, match=said):
        paper_steps(renderer, renderer.render(5.0), 5, 4)
