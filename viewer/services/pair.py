"""Two renderers of one world, which trace the same picture by two methods, part after part in turn.

Each has modes, certificates and counters of its own, so that neither gains by what the other has found out.  The world
is placed again whenever the turn changes, as methods differ in what they count as static.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from dataclasses import replace

from tracer.renderer import Renderer
from viewer.services.render_request import Parts, RenderRequest


class Pair:
    """A renderer and another beside it, which lives as long as the pair."""

    def __init__(self, first: Renderer) -> None:
        self._first, self._second = first, first.beside()
        self._world = getattr(first, "world", None)

    def is_of(self, renderer: Renderer) -> bool:
        """Return whether it is the pair of this renderer, in the world that this one has now."""
        return renderer is self._first and getattr(renderer, "world", None) is self._world

    def refine(self, request: RenderRequest, cancel: Callable[[], bool]) -> Parts:
        """Yield each part of the picture by the first renderer, and the same by the second with the other method.

        The world is always left as the first has placed it: queries may be answered between two parts."""
        self._second.settings = replace(self._first.settings, method=request.second)
        self._second.take_scene(self._first)
        first, second = request.refine(self._first, cancel), request.refine(self._second, cancel)
        with closing(first) as ours, closing(second) as theirs:
            begun = False
            for frame, _ in ours:
                try:
                    if begun:
                        self._second.take_turn(request.time)
                    begun = True
                    other, _ = next(theirs)
                finally:
                    self._first.take_turn(request.time)
                yield frame, other
