"""The command palette's mind: what can be found, what was typed, and what of it is meant."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum

from viewer.state.fuzzy import match, nearly

RECENT_BONUS = 15.0
"""For what was run last; less for what was run before."""
_OTHER_KINDS = 4.0  # which a command goes before, where both fit alike


class Kind(Enum):
    """What an item is."""

    COMMAND = "command"
    SETTING = "setting"
    PRESET = "preset"
    BOOKMARK = "bookmark"
    SCENE = "scene"


@dataclass(frozen=True)
class Item:
    """Something that can be found.  `path` says where else it is, such as its menu; `key` is as the user reads it;
    `why_not` says why it cannot be run now, "" where it can; `also` holds words that find it as well.  An item with
    `value` is a setting that is typed: `value` is what it is now, and `take` tries another, returning what is wrong
    with it or ""."""

    name: str
    label: str
    kind: Kind
    run: Callable[[], None]
    path: str = ""
    key: str = ""
    checked: bool | None = None
    enabled: bool = True
    why_not: str = ""
    also: str = ""
    value: str | None = None
    take: Callable[[str], str] | None = None
    hint: str = ""


@dataclass(frozen=True)
class Found:
    """An item, and the places of the letters in its label that were typed."""

    item: Item
    places: tuple[int, ...] = ()


def find(typed: str, items: Sequence[Item], used: Sequence[str]) -> list[Found]:
    """What fits, best first; without a word typed all, what was used last first.  Where nothing fits, what is nearly
    called so."""
    rank = {name: place for place, name in enumerate(used)}
    if not typed.strip():
        recent = sorted((item for item in items if item.name in rank), key=lambda item: rank[item.name])
        return [Found(item) for item in (*recent, *(item for item in items if item.name not in rank))]
    scored = []
    for number, item in enumerate(items):
        fits = match(typed, item.label, f"{item.path} {item.kind.value} {item.also}")
        if fits is not None:
            score = fits.score - (_OTHER_KINDS if item.kind is not Kind.COMMAND else 0.0)
            score += RECENT_BONUS / (1.0 + rank[item.name]) if item.name in rank else 0.0
            scored.append((-score, number, Found(item, fits.places)))
    if not scored:
        like = [(-nearly(typed, item.label), number, Found(item)) for number, item in enumerate(items)]
        scored = [entry for entry in like if entry[0] < 0.0]
    return [found for *_, found in sorted(scored, key=lambda entry: entry[:2])]


class Finder:
    """`wanted` says that it is to be opened; `typed` is what is typed, `marked` the place of the line that Enter runs,
    `setting` the setting whose value is being typed, `problem` what is wrong with that."""

    def __init__(self) -> None:
        self.wanted = False
        self.items: list[Item] = []
        self.found: list[Found] = []
        self.typed = ""
        self.marked = 0
        self.setting: Item | None = None
        self.problem = ""
        self.moved = True
        self.fresh = True
        self._sought: tuple[str, tuple[str, ...]] | None = None

    def begin(self) -> None:
        """Open it, empty."""
        self.wanted, self.typed, self.marked, self.setting, self.problem = True, "", 0, None, ""
        self.moved = self.fresh = True
        self._sought = None

    def follow(self, items: list[Item], used: Sequence[str]) -> None:
        """Take up how all items are now; they are searched again only where something else is typed."""
        self.items = items
        names = (self.typed, tuple(item.name for item in items))
        if self.setting is not None:
            return
        if names != self._sought:
            self._sought = names
            self.found = find(self.typed, items, used)
            self.marked = min(self.marked, max(0, len(self.found) - 1))
        else:
            now = {item.name: item for item in items}
            self.found = [Found(now[f.item.name], f.places) for f in self.found]

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
    def aimed(self) -> Item | None:
        """What Enter would run."""
        return self.found[self.marked].item if self.setting is None and self.marked < len(self.found) else None

    def enter(self, item: Item | None) -> Callable[[], None] | None:
        """Take an item, or the value that was typed for one; returns what is to be run now that it closes, None while
        it stays open."""
        if self.setting is not None:
            taking = self.setting
            self.problem = taking.take(self.typed) if taking.take is not None else ""
            return None if self.problem else _nothing
        if item is None:
            return None
        if not item.enabled:
            self.problem = f"{item.label}: {item.why_not or 'cannot be done now'}"
            return None
        if item.value is not None:
            self.setting, self.typed, self.problem, self.fresh = item, item.value, "", True
            return None
        return item.run


def _nothing() -> None:
    pass
