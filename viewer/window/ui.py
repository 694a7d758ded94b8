"""The state of the interface itself: what is open, what was asked for, and what the pointer holds.

Panels and commands share it; what they do to the scene goes through the controller.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from typing import Any

from tracer.culling.fate import Fate
from tracer.scene.lights import named_light
from tracer.why_in_words import Link
from viewer.output.capture import FIELDS
from viewer.services.controller import Controller
from viewer.services.file_browser import Browser
from viewer.services.tour import Tour
from viewer.state.keymap import Keymap
from viewer.state.pixels import Pixels, Point
from viewer.state.placing import Rect
from viewer.state.preferences import default_screenshot_folder
from viewer.state.preview_geometry import PreviewGeometry
from viewer.state.views import View
from viewer.window.command import Command, is_key
from viewer.window.display import Compared, Display
from viewer.window.finder import Finder
from viewer.window.full_screen import FullScreen
from viewer.window.guard import Guard
from viewer.window.keyboard import Keyboard
from viewer.window.magnifier import Magnifier
from viewer.window.preview import PreviewDisplay
from viewer.window.screening import Screening
from viewer.window.shots import Shots


class CaptureKind(Enum):
    """What a screenshot shows."""

    PICTURE = "the picture alone"
    WINDOW = "the window with its panels"
    CLIPBOARD = "the picture alone, to the clipboard"


@dataclass
class Fold:
    """What became of the panels: hidden all, or folded into a strip in a small window, with one of them open."""

    hidden: bool = False
    folded: bool = False
    drawer: str = ""

    @property
    def away(self) -> bool:
        """Whether no panel is docked beside the picture."""
        return self.hidden or self.folded


@dataclass
class Ui:
    """See the module. `picture_area` is the size, in framebuffer pixels, that the picture may fill, `picture_size` the
    one that it fills; `wiping` says that the pointer holds the line of the wipe, `pointed_light` and `pointed_link`
    which light and which name it is on in the inspector, whose rays are to unfold for `rays_wanted` frames;
    `light_filters` is what is typed above each list of lights; `screening` is the recorded picture that is shown in the
    picture's place; `legend_shown` says whether the picture shows its legend, `legend_place` where that is on the
    screen, `legend_held` where the pointer holds it; `fate_shown` is the fate of
    shadow rays whose pixels are to stand out; `key_wanted` names the command that waits for a key to be pressed;
    `editing` is the list and the place in it of a name that is being edited, `edited` that name; `tour_height` is what
    the picture leaves free below it for the tour, `tour_place` where that is: left, top and width. `gesture` is what a
    drag does that moves no camera, from `gesture_at` on, a point of the picture; `menu_at` is the point that the menu
    over the picture is about; `plot_pointed` is the frame of a plot that the pointer was on last.
    `what_if_drawn` is the frame of ImGui's in which the panel What if was drawn last, `what_if_below` how high all is
    below its list of lights, `held_light` the light that the pointer drags, and `changed_shown` says that changed
    pixels are to be seen. `find_focus` asks for the keyboard above the table of what is in the scene, of which
    `find_drawn` rows were drawn last, each `find_height` pixels high, in the order `find_order`. `chorded` are the keys
    that steer which were pressed with Ctrl, Alt or Super. `capture_view` is the view that a picture is wanted of."""

    controller: Controller
    display: Display | None = None
    commands: list[Command] = field(default_factory=list)
    browser: Browser = field(default_factory=Browser)
    fold: Fold = field(default_factory=Fold)
    full_screen: FullScreen = field(default_factory=FullScreen)
    capture_wanted: CaptureKind | None = None
    capture_view: View | None = None
    save_as_open: bool = False
    shortcuts_open: bool = False
    keyboard: Keyboard = field(default_factory=Keyboard)
    fate_shown: Fate | None = None
    key_wanted: str = ""
    finder: Finder = field(default_factory=Finder)
    presets_open: bool = False
    editing: tuple[str, int] | None = None
    edited: str = ""
    editing_fresh: bool = False
    new_preset: str = ""
    key_filter: str = ""
    more_in_menus: dict[str, Callable[[], None]] = field(default_factory=dict)
    paste_from: Callable[[], str] = lambda: ""
    copy_to: Callable[[str], None] = lambda text: None
    about_open: bool = False
    per_pixel: bool = True
    plot_pointed: int | None = None
    picture_area: tuple[int, int] = (0, 0)
    picture_focused: bool = False
    picture_shape: tuple[int, int] = (1, 1)
    pivot: tuple[float, float, float] | None = None
    pivot_scene: object = None
    modifiers: int = 0
    chorded: set[str] = field(default_factory=set)
    pressed: int = 0
    pressed_at: tuple[float, float] = (0.0, 0.0)
    dragged: bool = False
    wiping: bool = False
    new_bookmark: str = ""
    dropped: list[Path] = field(default_factory=list)
    renderer_name: str = ""
    request_exit: Callable[[], None] = lambda: None
    reset_layout: Callable[[], None] = lambda: None
    restart_graphics: Callable[[], None] = lambda: None
    show_panel: Callable[[str], Any] = lambda label: None
    panel_labels: tuple[str, ...] = ()
    guard: Guard = field(init=False)
    log_errors_only: bool = False
    zoom_all_steps: bool = False
    pointed_light: int | None = None
    pointed_link: Link | None = None
    rays_wanted: int = 0
    what_if_drawn: int = -9
    what_if_below: float = 0.0
    held_light: int | None = None
    changed_shown: bool = False
    light_filters: dict[str, str] = field(default_factory=dict)
    find_focus: bool = False
    find_drawn: int = 0
    find_height: float = 0.0
    find_order: object = None
    shots: Shots | None = None
    cube_shows: int = 0
    preview: PreviewDisplay | None = None
    not_previewed: PreviewGeometry | None = None
    screening: Screening | None = None
    compared: Compared | None = None
    magnifier: Magnifier | None = None
    picture_size: tuple[int, int] = (0, 0)
    pixels: Pixels = field(default_factory=Pixels)
    gesture: str = ""
    gesture_at: Point = (0.0, 0.0)
    menu_at: Point = (0.0, 0.0)
    legend_shown: bool = False
    legend_place: Rect | None = None
    legend_held: tuple[float, float] = (0.0, 0.0)
    tour_height: float = 0.0
    tour_place: tuple[float, float, float] | None = None
    _cache: dict[str, tuple[object, object, Any]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.keymap = Keymap(self.controller.preferences, {})
        self.tour = Tour(self.controller, lambda label: self.show_panel(label), self.key_or_menu)

    def cached(self, name: str, of: object, chosen: object, compute: Callable[[], Any]) -> Any:
        """What was computed of this object (a frame, results) for what is chosen, computed now if it is new."""
        known = self._cache.get(name)
        if known is None or known[0] is not of or known[1] != chosen:
            known = self._cache[name] = (of, chosen, compute())
        return known[2]

    def light_name(self, light: int) -> str:
        """A light as every panel calls it: by its number in the scene as it was read, and its name if it has one."""
        scene = self.controller.session.scene
        return named_light(scene.lights if scene is not None else (), light)

    def show_rays(self) -> None:
        """Show the rays of the clicked pixel."""
        self.rays_wanted = 3  # until what is to be scrolled is laid out
        self.show_panel("Inspector")

    def take_commands(self, commands: list[Command]) -> None:
        """Make these the commands, with the keys that the user has chosen for them."""
        self.commands = commands
        self.keymap = Keymap(self.controller.preferences, {command.name: command.keys for command in commands})
        kept = self.controller.preferences.keys
        for name, keys in list(kept.items()):
            kept[name] = [key for key in keys if is_key(key)]  # a file may hold anything

    def edit(self, place: tuple[str, int], name: str) -> None:
        """Begin to edit a name in a list."""
        self.editing, self.edited, self.editing_fresh = place, name, True

    def key(self, name: str) -> str:
        """The key of a command as the user reads it on the keyboard, in brackets after a blank; "" without one."""
        return self.keys(name)

    def keys(self, *names: str) -> str:
        """The keys of several, as in " (L and Shift+L)"; those that have one."""
        shown = " and ".join(filter(None, map(self.key_label, names)))
        return f" ({shown})" if shown else ""

    def key_label(self, name: str) -> str:
        """The same without brackets."""
        return self.keyboard.label(self.keymap.shown(name))

    def key_or_menu(self, name: str) -> str:
        """The key of a command, or of what is done while one is held, as the user reads it; without one, where the
        command is in the menus."""
        menus = (f"{c.menu} > {c.name}".replace("/", " > ") for c in self.commands if c.name == name)
        return self.key_label(name) or next(menus, name)

    @property
    def default_folder(self) -> Path:
        return default_screenshot_folder()

    @property
    def template_help(self) -> str:
        return "Fields:\n" + "\n".join(f"{{{name}}}  {meaning}" for name, meaning in FIELDS.items())
