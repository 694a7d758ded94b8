"""Whether and how the live picture, B, is compared with another, A: a part of the window's state."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class CompareMode(StrEnum):
    """How two pictures are compared."""

    label: str
    command: str
    help: str

    def __new__(cls, value: str, label: str, command: str, help: str) -> CompareMode:
        made = str.__new__(cls, value)
        made._value_, made.label, made.command, made.help = value, label, command, help
        return made

    FLIP = "flip", "Flip", "Flip between A and B", "Show B, and A while Z is held."
    WIPE = "wipe", "Wipe", "Wipe between A and B", "Show A left of a line and B right of it. Drag the line."
    SIDE = "side", "Side by side", "A and B side by side", "Show A on the left and B on the right."
    DIFFERENCE = (
        "difference", "Signed difference", "Signed difference B - A",
        "Show B - A: orange where B has more, blue where it has less.",
    )  # fmt: skip


class Source(StrEnum):
    """Where A comes from."""

    KEPT = "kept"
    METHOD = "method"


@dataclass(frozen=True)
class Compare:
    """Whether and how two pictures are compared: with `same_view` a kept A is shown in the view of B; `limit` is the
    range of the difference, None for one that fits; `second` is the method that traces A, where it is not kept."""

    on: bool = False
    mode: CompareMode = CompareMode.WIPE
    source: Source = Source.KEPT
    same_view: bool = False
    limit: float | None = None
    second: str = ""

    def changes(self, after: Compare) -> dict[str, str]:
        """Return what has changed since, in a few words for each."""
        words = {
            "on": f"comparison: {after.mode.label.lower()}" if after.on else "comparison off",
            "source": "A by another method" if after.source is Source.METHOD else "A as it was kept",
            "second": f"second method {after.second}",
            "same_view": "A in the view of B" if after.same_view else "A in its own view",
            "limit": "range of the difference",
        }
        changed = {name for name in words if getattr(self, name) != getattr(after, name)}
        if self.mode is not after.mode:
            changed.add("on")
        if not self.second:
            changed.discard("second")  # it was chosen with the source
        return {name: said for name, said in words.items() if name in changed}
