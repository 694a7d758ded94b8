"""The state of the interface itself: what is open, what was asked for, and what the pointer holds.

Panels and commands share it; what they do to the scene goes through the controller."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, TypeVar, cast

from tracer.culling.fate import Fate
from tracer.scene.lights import named_light
from viewer.services.controller import Controller
from viewer.services.paper_figures import PaperFigures
from viewer.services.tour import Tour
from viewer.state.views import View
from viewer.window.command import Command
from viewer.window.display import Graphics
from viewer.window.gl_window import FullScreen
from viewer.window.guard import Guard
from viewer.window.keyboard import Keyboard, Keymap, is_key


class CaptureKind(Enum):
    """What a screenshot shows."""

    PICTURE = "the picture alone"
    WINDOW = "the window with its panels"
    CLIPBOARD = "the picture alone, to the clipboard"


class Dialog(Enum):
    """What can come up over the window, by its title."""

    OPEN_FILE = "Open a scene or a saved picture"
    SAVE_AS = "Save picture as"
    PRESETS = "Presets"
    KEYS = "Keyboard and mouse"
    PALETTE = "Command palette"


@dataclass
class Picture:
    """The picture in the window: the size in framebuffer pixels that it may fill (`area`), the one that it fills, the
    newest frame's, what the camera orbits around and of which scene that is, and what the pointer did last: the button
    that was pressed, whether with Ctrl, where, and whether it was dragged."""

    area: tuple[int, int] = (0, 0)
    size: tuple[int, int] = (0, 0)
    shape: tuple[int, int] = (1, 1)
    pivot: tuple[float, float, float] | None = None
    pivot_scene: object = None
    pressed: int = 0
    with_ctrl: bool = False
    pressed_at: tuple[float, float] = (0.0, 0.0)
    dragged: bool = False


State = TypeVar("State")


@dataclass(slots=True)
class Ui:
    """See the module.  `capture_view` is the view that a picture is wanted of, `dialogs` are those that are open, the
    newest last, `fate_shown` is the fate of shadow rays whose pixels are to stand out; there are `graphics` as long as
    the window has a GL context."""

    controller: Controller
    commands: list[Command] = field(default_factory=list)
    panels_hidden: bool = False
    workspace: str = ""
    full_screen: FullScreen = field(default_factory=FullScreen)
    capture_wanted: CaptureKind | None = None
    capture_view: View | None = None
    dialogs: list[Dialog] = field(default_factory=list)
    keyboard: Keyboard = field(default_factory=Keyboard)
    fate_shown: Fate | None = None
    exit: Callable[[], None] = lambda: None
    reset_layout: Callable[[], None] = lambda: None
    graphics: Graphics = field(init=False)
    show_panel: Callable[[str], Any] = lambda label: None
    panel_labels: tuple[str, ...] = ()
    guard: Guard = field(init=False)
    keymap: Keymap = field(init=False)
    tour: Tour = field(init=False)
    figures: PaperFigures = field(init=False)
    picture: Picture = field(default_factory=Picture)
    _states: dict[type, Any] = field(default_factory=dict)
    _cache: dict[str, tuple[object, object, Any]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.keymap = Keymap(self.controller.preferences, {})
        self.tour, self.figures = Tour(self.controller, self.key_or_menu), PaperFigures(self.controller)

    def state(self, kind: type[State]) -> State:
        """The state of a panel, an object of this class for as long as the program runs."""
        if kind not in self._states:
            self._states[kind] = kind()
        return cast(State, self._states[kind])

    def cached(self, name: str, of: object, chosen: object, compute: Callable[[], Any]) -> Any:
        """What was computed of this object (a frame, results) for what is chosen, computed now if it is new."""
        known = self._cache.get(name)
        if known is None or known[0] is not of or known[1] != chosen:
            known = self._cache[name] = (of, chosen, compute())
        return known[2]

    def open(self, dialog: Dialog) -> None:
        if dialog not in self.dialogs:
            self.dialogs.append(dialog)

    def close(self, dialog: Dialog) -> None:
        if dialog in self.dialogs:
            self.dialogs.remove(dialog)

    def toggle(self, dialog: Dialog) -> None:
        (self.close if dialog in self.dialogs else self.open)(dialog)

    def offer_panel(self, label: str) -> None:
        """Open a panel, unless panels are hidden."""
        if not self.panels_hidden:
            self.show_panel(label)

    def light_name(self, light: int) -> str:
        """A light as every panel calls it: by its number in the scene as it was read, and its name if it has one."""
        scene = self.controller.session.scene
        return named_light(scene.lights if scene is not None else (), light)

    def take_commands(self, commands: list[Command]) -> None:
        """Make these the commands, with the keys that the user has chosen for them."""
        self.commands = commands
        self.keymap = Keymap(self.controller.preferences, {command.name: command.keys for command in commands})
        kept = self.controller.preferences.keys
        for name, keys in list(kept.items()):
            kept[name] = [key for key in keys if is_key(key)]  # a file may hold anything

    def key(self, name: str) -> str:
        """Return the key of a command as the user reads it, as in " (Shift+L)"; "" without one."""
        shown = self.key_label(name)
        return f" ({shown})" if shown else ""

    def key_label(self, name: str) -> str:
        """The same without brackets."""
        return self.keyboard.label(next(iter(self.keymap.of(name)), ""))

    def key_or_menu(self, name: str) -> str:
        """The key of a command, or of what is done while one is held, as the user reads it; without one, where the
        command is in the menus."""
        menus = (f"{c.menu} > {c.name}".replace("/", " > ") for c in self.commands if c.name == name)
        return self.key_label(name) or next(menus, name)
