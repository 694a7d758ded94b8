"""Which clusters of lights shade a pixel?  Asked about what was clicked or, until something is, what the pointer is on.

The question goes to the render thread, which alone may shade anew, and is answered between two frames.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol, cast

import numpy as np

from tracer.frame import Frame
from tracer.light_cut import LightCut, light_cut
from tracer.renderer import Renderer
from viewer.services.render_request import Question, Traces
from viewer.services.selection import Selection
from viewer.state.picking import pixel_at
from viewer.state.projection import Stroke, place, strokes

MOST_DRAWN = 100
"""Nodes of a cut that are drawn, those that send most."""


class CutQuestion:
    """The cut of a pixel; `over` once there is an answer: `found`, or None where the pixel has no cut."""

    def __init__(self, frame: Frame, x: int, y: int) -> None:
        self.frame, self.x, self.y = frame, x, y
        self.found: LightCut | None = None
        self.over = False

    @property
    def time(self) -> float:
        return self.frame.time

    def answer(self, renderer: Traces) -> None:
        try:
            self.found = light_cut(cast(Renderer, renderer), self.frame, self.x, self.y)
        except LookupError:  # another frame has begun meanwhile: it will be asked about that one
            self.found = None
        self.over = True


class DrawnNode(NamedTuple):
    """A node on the picture: the edges of its box in pieces, or where its only light is; how many lights it stands for;
    and how much of the light that arrives it sends, a part of the most that any node sends."""

    strokes: list[Stroke]
    at: tuple[float, float] | None
    lights: int
    part: float


class Answers(Protocol):
    """The part of `RenderThread` that is used here."""

    def ask(self, question: Question) -> None: ...


class CutInspector:
    """`cut` is that of the pixel that was clicked or is pointed at, None while it is not known or not wanted."""

    def __init__(self, selection: Selection, renderer: Answers) -> None:
        self._selection, self._renderer = selection, renderer
        self._asked: CutQuestion | None = None
        self.cut: LightCut | None = None
        self._drawn: tuple[LightCut, list[DrawnNode]] | None = None

    def follow(self, frame: Frame | None, idle: bool) -> None:
        """Ask about the pixel of the newest whole frame, None where nobody wants to know, and take up what has come.

        A cut is that of a picture, however many samples it gets: it is asked for once, and stays while they come."""
        if frame is None or not idle:
            self._asked = self.cut = self._drawn = None
            return
        at = self._selection.pixel
        if self._selection.picked is None and self._selection.hovered is not None:
            at = pixel_at(frame, *self._selection.hovered)
        if at is None or not (at[0] < frame.width and at[1] < frame.height) or frame.primitive[at[1], at[0]] < 0:
            self._asked = self.cut = None
            return
        asked = self._asked
        if asked is None or asked.frame.primitive is not frame.primitive or (asked.x, asked.y) != at:
            self._asked = asked = CutQuestion(frame, *at)
            self._renderer.ask(asked)
        if asked.over:
            self.cut = asked.found
        elif self.cut is not None and (
            self.cut.frame.primitive is not frame.primitive or (self.cut.x, self.cut.y) != at
        ):
            self.cut = None

    @property
    def waits_for(self) -> tuple[int, int] | None:
        """The pixel whose cut has been asked for and is not known yet; None where nothing is awaited."""
        asked = self._asked
        return (asked.x, asked.y) if asked is not None and not asked.over else None

    def drawn(self) -> list[DrawnNode]:
        """The nodes of the cut on its frame, those that send least first."""
        cut = self.cut
        if cut is None:
            return []
        if self._drawn is None or self._drawn[0] is not cut:
            self._drawn = cut, drawn_nodes(cut)
        return self._drawn[1]


def drawn_nodes(cut: LightCut) -> list[DrawnNode]:
    """What is drawn of a cut: of the nodes that send most, the box or the single light."""
    order = np.argsort(-cut.sent, kind="stable")[:MOST_DRAWN][::-1]
    most, found = max(float(cut.sent.max(initial=0.0)), 1e-30), []
    for k in order.tolist():
        box, lights = cut.boxes[k].astype(np.float64), int(cut.lights[k])
        part = float(cut.sent[k]) / most
        if lights == 1 or (box[:3] == box[3:]).all():
            found.append(DrawnNode([], place(cut.frame, box[:3]), lights, part))
            continue
        corners = np.array([[box[3 * (n >> axis & 1) + axis] for axis in range(3)] for n in range(8)])
        edges = [(a, a | 1 << axis) for axis in range(3) for a in range(8) if not a >> axis & 1]
        lines = [stroke for a, b in edges for stroke in strokes(cut.frame, corners[[a, b]])]
        found.append(DrawnNode(lines, None, lights, part))
    return found
