"""Settings that have a value, for the command palette: what each is now, and how what is typed is taken."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

from tracer.scene.lights import MAX_SAMPLES
from tracer.settings import MAX_NODES
from viewer.state.preferences import LONGEST_SIDE, MOST_CERTIFYING, Preferences
from viewer.state.terms import TREES
from viewer.window.finder import Item, Kind
from viewer.window.ui import Ui


@dataclass(frozen=True)
class Number:
    """A setting that is a number from `low` to `high`; `change` puts it where it belongs, `unset` is the word for
    leaving it to the scene, where that can be."""

    label: str
    panel: str
    now: Callable[[], float | int | None]
    change: Callable[[Any], None]
    low: float
    high: float
    whole: bool = True
    unset: str = ""
    unit: str = ""

    @property
    def text(self) -> str:
        now = self.now()
        return self.unset if now is None else f"{now:.6g}"

    @property
    def hint(self) -> str:
        also = f', or "{self.unset}"' if self.unset else ""
        return f"{'a whole number' if self.whole else 'a number'} from {self.low:g} to {self.high:g}{self.unit}{also}"

    def take(self, typed: str) -> str:
        """Try what was typed; returns what is wrong with it, or ""."""
        word = typed.strip().removesuffix("%").strip()
        if self.unset and word.lower() == self.unset:
            self.change(None)
            return ""
        try:
            number = int(word) if self.whole else float(word)
        except ValueError:
            return f"{self.label}: {word or 'nothing'} is not {self.hint}"
        if not math.isfinite(number) or not self.low <= number <= self.high:
            return f"{self.label} is {self.hint}"
        self.change(number)
        return ""


def items(ui: Ui) -> Iterator[Item]:
    """All of them."""
    refused = "a run is under way" if ui.controller.runs.current is not None else ""
    for number in _traced(ui):
        yield _number(ui, number, refused)
    for number in _of_window(ui):
        yield _number(ui, number, "")
    yield from _trees(ui, refused)
    p = ui.controller.preferences
    for name, (label, panel) in _SWITCHES.items():
        on = bool(getattr(p, name))
        yield Item(f"setting {label}", label, Kind.SETTING, _switch(p, name), panel, checked=on, also="on off switch")


_SWITCHES = {
    "dynamic_resolution": ("Progressive refinement", "Rendering"),
    "fixed_resolution": ("Fixed size", "Rendering"),
    "legend_in_pictures": ("Legend in saved pictures", "Saving"),
    "savings_in_pictures": ("What culling saves in saved pictures", "Saving"),
}


def _switch(p: Preferences, name: str) -> Callable[[], None]:
    return lambda: setattr(p, name, not getattr(p, name))


def _number(ui: Ui, number: Number, refused: str) -> Item:
    return Item(
        f"setting {number.label}",
        number.label,
        Kind.SETTING,
        lambda: None,
        number.panel,
        enabled=not refused,
        why_not=refused,
        also="set value",
        value=number.text,
        take=number.take,
        hint=number.hint,
    )


def _trees(ui: Ui, refused: str) -> Iterator[Item]:
    """What rays may be traced through, an item each."""
    c = ui.controller
    for name, meaning in TREES.items():
        yield Item(
            f"setting Tree {name}",
            f"Tree: {name}",
            Kind.SETTING,
            partial(c.settings.change, accelerator=name),
            "Rendering",
            checked=c.session.settings.accelerator == name,
            enabled=not refused,
            why_not=refused,
            also="acceleration structure",
            hint=meaning,
        )


def _traced(ui: Ui) -> Iterator[Number]:
    c = ui.controller
    s = c.session.settings

    def change(name: str) -> Callable[[Any], None]:
        return lambda value: c.settings.change(**{name: value})

    yield Number("Bounces", "Rendering", lambda: s.depth, change("depth"), 0, 100)
    yield Number("Samples per pixel", "Rendering", lambda: s.samples, change("samples"), 1, 64)
    yield Number("Threads", "Rendering", lambda: s.threads, change("threads"), 0, 1024, unit=", 0 for all cores")
    yield Number("Zoom factor", "Culling", lambda: s.zoom_factor, change("zoom_factor"), 1, 1e6, whole=False)
    yield Number("Error of clusters of lights", "Culling", lambda: 100.0 * s.lightcuts_error,
                 lambda value: change("lightcuts_error")(value / 100.0), 0, 100, whole=False, unit=" %")  # fmt: skip
    yield Number("Clusters of lights", "Culling", lambda: s.lightcuts_nodes, change("lightcuts_nodes"), 1, MAX_NODES)
    if c.session.scene is not None and c.session.scene.lights:
        yield Number("Lamp radius", "Rendering", lambda: s.lamp_radius, change("lamp_radius"), 0, 1e9, whole=False,
                     unset="scene")  # fmt: skip
        yield Number("Lamp samples", "Rendering", lambda: s.lamp_samples, change("lamp_samples"), 1, MAX_SAMPLES,
                     unset="scene")  # fmt: skip


def _of_window(ui: Ui) -> Iterator[Number]:
    c, p = ui.controller, ui.controller.preferences

    def put(name: str, scale: float = 1.0) -> Callable[[Any], None]:
        return lambda value: setattr(p, name, value / scale if scale != 1.0 else value)

    yield Number("Certificates, share of a frame", "Culling", lambda: 100.0 * p.certificate_share,
                 put("certificate_share", 100.0), 0, 100.0 * MOST_CERTIFYING, whole=False, unit=" %")  # fmt: skip
    yield Number("Frames per second in motion", "Rendering", lambda: p.target_fps, put("target_fps"), 1, 240,
                 whole=False)  # fmt: skip
    yield Number("Picture width", "Rendering", lambda: p.fixed_width, put("fixed_width"), 1, LONGEST_SIDE)
    yield Number("Picture height", "Rendering", lambda: p.fixed_height, put("fixed_height"), 1, LONGEST_SIDE)
    yield Number("Flying speed", "Camera", lambda: p.speed, put("speed"), 0.001, 1000, whole=False)
    yield Number("Playback rate", "Camera", lambda: p.playback_rate, put("playback_rate"), 0.01, 100, whole=False)
    yield Number("Shading", "View", lambda: p.shading, put("shading"), 0, 1, whole=False)
    yield Number("Size of the interface", "View", lambda: 100.0 * p.ui_scale, put("ui_scale", 100.0), 75, 200,
                 whole=False, unit=" %")  # fmt: skip
    if c.session.animated:
        scene = c.session.scene
        assert scene is not None
        yield Number("Frame", "Time", lambda: c.session.frame, lambda n: c.motion.step(n - c.session.frame), 0,
                     scene.frames - 1)  # fmt: skip
    lights = len(c.session.scene.lights) if c.session.scene is not None else 0
    if lights > 1:
        yield Number("Light", "View", lambda: c.session.light, c.settings.set_light, 0, lights - 1)
