"""Commands: what the menus, the keys, the list of keys and the palette are made of.

Keys that are held down to fly are no commands: `viewer.window.keyboard` lists them, and `viewer.window.panels.picture`
reads them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

from viewer.services.controller import Controller

MENUS = ("File", "Edit", "View", "Picture", "Compare", "Camera", "Time", "Culling", "Run", "Help")


class Kind(Enum):
    """What the palette finds."""

    COMMAND = "command"
    SETTING = "setting"
    PRESET = "preset"
    BOOKMARK = "bookmark"
    SCENE = "scene"


class Condition(NamedTuple):
    """When a command can be run, and why not where it cannot."""

    holds: Callable[[], bool]
    reason: str


@dataclass(frozen=True)
class Command:
    """An action.  `menu` may name a menu within another, as "Camera/Bookmarks".  `key` is the one that it has unless
    the user gives it others, written as it is shown, e.g. "Ctrl+O"; `other_keys` do the same on other keyboards, and
    are not shown; `also` holds words by which the palette finds it, too; `checked` makes it a tick in its menu, where
    `tip` says more about it; `title` is what it is called now, where that is not its name, and "" where it is not to
    be seen.

    In the palette there are more, which have no key, and of which `menu` says where else they are.  One with `value` is
    a setting that is typed: `value` is what it is now, and `take` tries another, returning what is wrong with it."""

    name: str
    menu: str
    run: Callable[[], object]
    key: str = ""
    checked: Callable[[], bool] | None = None
    enabled: Condition | None = None
    separated: bool = False
    repeats: bool = False
    tip: str | Callable[[], str] = ""
    also: str = ""
    other_keys: tuple[str, ...] = ()
    title: str | Callable[[], str] | None = None
    kind: Kind = Kind.COMMAND
    value: str | None = None
    take: Callable[[str], str] | None = None

    @property
    def label(self) -> str:
        """What it is called now; "" while it is not to be seen."""
        title = self.name if self.title is None else self.title
        return title if isinstance(title, str) else title()

    @property
    def more(self) -> str:
        """What more is said about it now."""
        return self.tip if isinstance(self.tip, str) else self.tip()

    @property
    def is_checked(self) -> bool:
        """Whether it has a tick now."""
        return self.checked is not None and self.checked()

    @property
    def why_not(self) -> str:
        """Why it cannot be run now; "" where it can."""
        return "" if self.enabled is None or self.enabled.holds() else self.enabled.reason

    @property
    def keys(self) -> tuple[str, ...]:
        """All that it has."""
        return (self.key, *self.other_keys) if self.key else ()


def scene_open(c: Controller) -> Condition:
    """Return that there is a scene."""
    return Condition(lambda: c.session.scene is not None, "no scene is open")
