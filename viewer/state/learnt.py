"""From which frames modes were learnt since they were last forgotten: as often as may be, from one and the same."""

from __future__ import annotations

from collections.abc import Hashable

from tracer.frame import Frame


class Learnt:
    """Counts frames that have set modes.  Modes are kept for each resolution apart: those of another do not count."""

    def __init__(self) -> None:
        self._seen: dict[tuple[int, int], tuple[Hashable, int]] = {}

    def forget(self) -> None:
        """Modes were forgotten: nothing is known."""
        self._seen.clear()

    def confuse(self) -> None:
        """The scene is another now: what is known was learnt from other frames than can be traced again."""
        self._seen = dict.fromkeys(self._seen, (None, 0))

    def add(self, frame: Frame) -> None:
        """A frame has set modes.  One that was left before it was whole cannot be traced again as it was."""
        size, key = (frame.width, frame.height), _key(frame) if frame.statistics.part >= 1.0 else None
        known, count = self._seen.get(size, (key, 0))
        self._seen[size] = (key, count + 1) if known == key else (None, 0)

    def repeats(self, frame: Frame) -> int | None:
        """How often this very frame was traced before it; None where there were others as well."""
        key, count = self._seen.get((frame.width, frame.height), (None, 0))
        return count - 1 if key is not None and key == _key(frame) and count else None


def _key(frame: Frame) -> Hashable:
    """What the modes that a frame sets depend on."""
    s = frame.settings
    of_settings = s.method, s.symmetric, s.zoom_factor, s.depth, s.lamp_radius, s.lamp_samples, s.accelerator
    return frame.time, frame.camera, of_settings
