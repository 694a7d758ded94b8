"""The command palette without a window: what can be found, what was typed, and what of it is meant."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from rapidfuzz import fuzz

from viewer.window.command import Command, Kind

RECENT_BONUS = 15.0
"""For what was run last; less for what was run before."""
_OTHER_KINDS = 4.0  # which a command goes before, where both fit alike
_MISTYPED, _ALIKE = -1000.0, 75.0  # to which is added how alike the words are, of 100, and that is at least so much


def match(typed: str, label: str, also: str = "") -> float | None:
    """How well a label fits what was typed; words may also be found in `also`, for less.  None if one is in neither.

    Words count as they stand (100), by their beginnings (80), as initials of the label's words (60), anywhere in it
    (50), in `also` (30), or, much less, mistyped; a shorter label before a longer one."""
    label, also, words = label.lower(), also.lower(), typed.lower().split()
    starts = [i for i, letter in enumerate(label) if letter.isalnum() and (i == 0 or not label[i - 1].isalnum())]
    initials, score = "".join(label[i] for i in starts), -0.1 * len(label) + 25.0 * (" ".join(words) == label)
    for word in words:
        start = next((i for i in starts if label.startswith(word, i)), -1)
        if start >= 0:
            whole = not label[start + len(word) : start + len(word) + 1].isalnum()
            score += (100.0 if whole else 80.0) - 0.05 * start
        elif len(word) > 1 and initials.startswith(word):
            score += 60.0
        elif word in label:
            score += 50.0 - 0.05 * label.find(word)
        elif word in also:
            score += 30.0
        elif len(word) > 3 and (alike := fuzz.partial_ratio(word, label, score_cutoff=_ALIKE)):
            score += _MISTYPED + alike
        else:
            return None
    return score


def find(typed: str, items: Sequence[Command], used: Sequence[str]) -> list[Command]:
    """What fits, best first, or else what is nearly called so; without a word all, what was used last first."""
    rank = {name: place for place, name in enumerate(used)}
    if not typed.strip():
        return sorted(items, key=lambda item: rank.get(item.name, len(rank)))
    scored = []
    for number, item in enumerate(items):
        score = match(typed, item.label, f"{item.name} {item.menu} {item.kind.value} {item.also}")
        if score is not None:
            score -= _OTHER_KINDS if item.kind is not Kind.COMMAND else 0.0
            score += RECENT_BONUS / (1.0 + rank[item.name]) if item.name in rank else 0.0
            scored.append((-score, number))
    as_typed = [entry for entry in scored if entry[0] < -0.5 * _MISTYPED]
    return [items[number] for _, number in sorted(as_typed or scored)]


@dataclass
class Finder:
    """`typed` is what is typed, `marked` the place of the line that Enter runs, which the list scrolls to where it has
    `moved`, `setting` the setting whose value is being typed, `problem` what is wrong with that; a `fresh` line takes
    the keyboard."""

    found: list[Command] = field(default_factory=list)
    typed: str = ""
    marked: int = 0
    setting: Command | None = None
    problem: str = ""
    moved: bool = True
    fresh: bool = True

    def begin(self) -> None:
        """Open it, empty."""
        self.typed, self.marked, self.setting, self.problem = "", 0, None, ""
        self.moved = self.fresh = True

    def update(self, items: Sequence[Command], used: Sequence[str]) -> None:
        """Find what is typed among all items, as they are now."""
        if self.setting is None:
            self.found = find(self.typed, items, used)
            self.marked = min(self.marked, max(0, len(self.found) - 1))

    def type(self, text: str) -> None:
        """Another text stands in the line."""
        self.typed, self.problem = text, ""
        if self.setting is None:
            self.marked, self.moved = 0, True

    def step(self, lines: int) -> None:
        """Mark another line; past the end comes the first."""
        if self.found and self.setting is None:
            self.marked = (self.marked + lines) % len(self.found)
            self.moved = True

    @property
    def aimed(self) -> Command | None:
        """What Enter would run."""
        return self.found[self.marked] if self.setting is None and self.marked < len(self.found) else None

    def enter(self, item: Command | None) -> bool:
        """Take an item, or the value that was typed for one; returns whether it closes now, and the item is to be
        run."""
        if self.setting is not None:
            self.problem = self.setting.take(self.typed) if self.setting.take is not None else ""
            return not self.problem
        if item is None:
            return False
        if not item.enabled():
            self.problem = f"{item.label}: {item.why_not or 'cannot be done now'}"
            return False
        if item.value is not None:
            self.setting, self.typed, self.problem, self.fresh = item, item.value, "", True
        return item.value is None
