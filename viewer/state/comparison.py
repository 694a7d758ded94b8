"""Two pictures beside each other, A and B, the live one; and whether and how they are compared, which is a part of the
window's state."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from tracer.frame import Frame
from tracer.method import title_of
from viewer.state.views import View


class CompareMode(StrEnum):
    """How two pictures are compared."""

    label: str
    command: str
    help: str

    def __new__(cls, value: str, label: str, command: str, help: str) -> CompareMode:
        made = str.__new__(cls, value)
        made._value_, made.label, made.command, made.help = value, label, command, help
        return made

    FLIP = "flip", "Flip", "Flip between A and B", "Show B, and A while its key is held."
    WIPE = "wipe", "Wipe", "Wipe between A and B", "Show A left of a line and B right of it. Drag the line."
    SIDE = "side", "Side by side", "A and B side by side", "Show A on the left and B on the right."
    DIFFERENCE = (
        "difference", "Signed difference", "Signed difference B - A",
        "Show B - A: lime where B has more, violet where it has less.",
    )  # fmt: skip


@dataclass(frozen=True)
class Side:
    """One of the two pictures: a frame in a view, of the scene of this name, at the frame number of its animation;
    `light_number` is what people call its light."""

    frame: Frame
    view: View
    light: int
    scene: str
    number: int
    light_number: int | None = None

    @property
    def method(self) -> str:
        """What people read of the method that traced it."""
        return title_of(self.frame.settings.method)

    @property
    def view_in_words(self) -> str:
        """Its view, and the light where that is about one."""
        number = self.light if self.light_number is None else self.light_number
        return f"{self.view.label.lower()}{f', light {number}' if self.view.of_light else ''}"

    def named(self, other: Side) -> str:
        """Return the method that traced it, and what else sets it apart from the other."""
        parts = [self.method]
        if self.view_in_words != other.view_in_words:
            parts.append(self.view_in_words)
        if self.scene != other.scene:
            parts.append(self.scene)
        if self.frame.time != other.frame.time or self.scene != other.scene:
            parts.append(f"frame {self.number}")
        mine, its = self.frame.settings, other.frame.settings
        for name, text in (("depth", "depth {}"), ("samples", "{} samples"), ("lamp_samples", "{} lamp samples")):
            if getattr(mine, name) not in (None, getattr(its, name)):
                parts.append(text.format(getattr(mine, name)))
        if len(parts) == 1 and mine.method == its.method and self.frame.camera != other.frame.camera:
            parts.append("another camera")
        return ", ".join(parts)


@dataclass(frozen=True)
class Compare:
    """Whether and how two pictures are compared; `second` is the method that traces A live, "" where A was kept."""

    on: bool = False
    mode: CompareMode = CompareMode.WIPE
    second: str = ""

    def changes(self, after: Compare) -> dict[str, str]:
        """Return what has changed since, in a few words for each."""
        found = {}
        if (self.on, self.mode) != (after.on, after.mode):
            found["on"] = f"comparison: {after.mode.label.lower()}" if after.on else "comparison off"
        if self.second != after.second:
            found["second"] = f"A by {title_of(after.second)}" if after.second else "A as it was kept"
        return found
