"""Two renderers of one world, which trace the same picture by two methods, part after part in turn.

Each has modes, certificates and counters of its own, so that neither gains by what the other has found out.  The world
is placed again whenever the turn changes, as methods differ in what they count as static.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from typing import Any, Protocol

from tracer.renderer import Frame, Settings
from tracer.scene.model import Camera


class Paired(Protocol):
    """The part of `tracer.Renderer` that is used here."""

    settings: Settings

    def refine(
        self,
        time: float,
        camera: Camera | None = None,
        cancel: Callable[[], bool] | None = None,
        parts: Sequence[float] = ...,
        samples: int = ...,
        focus: tuple[float, float] | None = None,
    ) -> Generator[Frame, None, None]: ...

    def beside(self) -> Any: ...

    def follow(self, other: Any) -> None: ...

    def take_turn(self, time: float) -> None: ...


@dataclass(frozen=True)
class Asked:
    """What `Renderer.refine` is given."""

    time: float
    camera: Camera
    cancel: Callable[[], bool]
    parts: Sequence[float]
    samples: int
    focus: tuple[float, float] | None

    def of(self, renderer: Paired) -> Generator[Frame, None, None]:
        return renderer.refine(self.time, self.camera, self.cancel, self.parts, self.samples, self.focus)


class Pair:
    """A renderer and another beside it, which lives as long as the pair."""

    def __init__(self, first: Paired) -> None:
        self._first, self._second = first, first.beside()
        self._world = getattr(first, "world", None)

    def is_of(self, renderer: Paired) -> bool:
        """Whether it is the pair of this renderer, in the world that this one has now."""
        return renderer is self._first and getattr(renderer, "world", None) is self._world

    def refine(self, asked: Asked, method: str) -> Generator[tuple[Frame, Frame], None, None]:
        """Each part of the picture by the first renderer, and the same by the second with another method.

        The world is always left as the first has placed it: questions may be asked of it between two parts."""
        self._second.settings = replace(self._first.settings, method=method)
        self._second.follow(self._first)
        with closing(asked.of(self._first)) as ours, closing(asked.of(self._second)) as theirs:
            begun = False
            for frame in ours:
                try:
                    if begun:
                        self._second.take_turn(asked.time)
                    begun = True
                    other = next(theirs)
                finally:
                    self._first.take_turn(asked.time)
                yield frame, other
