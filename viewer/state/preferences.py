"""What the user set and expects to find again: one small JSON file, never half-written.

The file lies in the user's configuration folder (`SHADOWCULL_CONFIG_DIR` names another).  It is
written to a temporary file beside it that then takes its name, so a crash or a full disk leaves
the old one whole.  Reading forgives: a value that is missing, of the wrong kind or out of range
keeps its default, and a file that is no JSON is kept under another name and reported.
"""

from __future__ import annotations

import json
import os
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

import platformdirs

from tracer.frame import Settings
from tracer.method import DEFAULT_METHOD, Method
from tracer.scene.lights import MAX_SAMPLES
from viewer.state.merging import merged
from viewer.state.methods import ADAPTIVE, NO_CULLING, is_method, with_base
from viewer.state.palette import BENEATH
from viewer.state.views import View
from viewer.util.files import file_lock, write_text
from viewer.util.json_numbers import finite

SETTINGS_FILE = "settings.json"
FORMAT = 2
"""Of the file. Version 0.2 wrote none, and its default method, auto, as if it had been chosen."""
PATIENCE = 2.0  # seconds that one window waits for another to save
RECENT_SCENES = 10
RECENT_COMMANDS = 30
THEMES = ("dark", "light")
SCALES = (0.75, 0.9, 1.0, 1.1, 1.25, 1.5, 1.75, 2.0)
"""Sizes of the interface that are offered."""
MOST_CERTIFYING = 0.9
"""Part of a frame's time that may go into certificates."""
LONGEST_SIDE = 8192
"""Pixels of a picture of fixed size."""
DEFAULT_TEMPLATE = "{scene}-{view}-{frame:04d}-{date}-{time}.png"

# Limits of the numbers; whatever lies outside is not from this program.
_RANGES: dict[str, tuple[float, float]] = {
    "target_fps": (1.0, 240.0),
    "ui_scale": (0.75, 2.0),
    "speed": (0.001, 1000.0),
    "playback_rate": (0.01, 100.0),
    "fixed_width": (1, LONGEST_SIDE),
    "fixed_height": (1, LONGEST_SIDE),
    "zoom_factor": (1.0, 1e6),
    "certificate_share": (0.0, MOST_CERTIFYING),
    "depth": (0, 100),
    "samples": (1, 64),
    "lamp_samples": (0, MAX_SAMPLES),
    "threads": (0, 1024),
    "shading": (0.0, 1.0),
    "beneath": (0.0, 0.6),
    "legend_x": (0.0, 1.0),
    "legend_y": (0.0, 1.0),
}


@dataclass
class Preferences:
    """Everything that outlives the window.  `format` is that of the file (`FORMAT`); `speed` is relative to the scene's
    own pace, 1 by default; `method` is the one to cull by while `culling` is on, `certificate_share` the part of a
    frame's time in motion that may go into certificates; `samples` is how many a pixel gets at idle; `lamp_samples` how
    many each lamp has, 0 for as many as the scene says (the radius of lamps is measured in units of the scene, and not
    kept); `savings` says that what culling saves is shown above the picture; `legend_x` and `legend_y` say where in the
    room that the picture leaves to its legend this lies, 0 to 1 from left and top; `tour` says that the tour has not
    been shown yet, `last` is the snapshot, as JSON, to start from where that is asked for; `keys` are
    those that the user has chosen, by the names of commands, and `used` what the command palette ran last, newest
    first."""

    format: int = FORMAT
    target_fps: float = 15.0
    dynamic_resolution: bool = True
    fixed_resolution: bool = False
    fixed_width: int = 512
    fixed_height: int = 512
    smooth_upscaling: bool = True
    navigation: str = "fly"
    speed: float = 1.0
    loop: bool = True
    every_frame: bool = False
    playback_rate: float = 1.0
    keep_tracing: bool = False
    culling: bool = True
    method: str = DEFAULT_METHOD
    certificate_share: float = 0.15
    symmetric: bool = False
    zoom_factor: float = 4.0
    depth: int = 10
    samples: int = 16
    lamp_samples: int = 0
    threads: int = 0
    verify: bool = False
    view: str = "color"
    shading: float = 0.35
    outlines: bool = False
    mark_wrong: bool = True
    beneath: float = BENEATH
    work_shares: bool = False
    savings: bool = True
    legend: bool = True
    legend_x: float = 0.0
    legend_y: float = 1.0
    legend_in_pictures: bool = False
    savings_in_pictures: bool = False
    pixel_values: bool = True
    draw_explanation: bool = True
    screenshot_folder: str = ""
    screenshot_template: str = DEFAULT_TEMPLATE
    tev: str = "127.0.0.1:14158"
    tour: bool = True
    theme: str = "dark"
    ui_scale: float = 1.0
    start_where_left: bool = False
    last: dict = field(default_factory=dict)
    watch_scene: bool = True
    keys: dict[str, list[str]] = field(default_factory=dict)
    used: list[str] = field(default_factory=list)
    presets: list[dict] = field(default_factory=list)
    recent: list[str] = field(default_factory=list)
    bookmarks: dict[str, list[dict]] = field(default_factory=dict)

    def settings(self) -> Settings:
        """Settings to trace with; the defaults where these do not go together."""
        method = self.method if self.culling else NO_CULLING
        names = ("symmetric", "zoom_factor", "depth", "samples", "threads", "verify")
        try:
            values = {name: getattr(self, name) for name in names}
            return Settings(method=method, lamp_samples=self.lamp_samples or None, **values).validated()
        except ValueError:
            return Settings()

    def keep(self, settings: Settings) -> None:
        """Remember what was chosen to trace with."""
        s = settings
        self.culling = Method.parse(s.method).culls
        self.method = s.method if self.culling else self.method
        self.symmetric, self.zoom_factor = s.symmetric, s.zoom_factor
        self.depth, self.samples, self.threads, self.verify = s.depth, s.samples, s.threads, s.verify
        self.lamp_samples = s.lamp_samples or 0

    @property
    def picture_folder(self) -> Path:
        """Where pictures and results are saved."""
        return Path(self.screenshot_folder or default_screenshot_folder()).expanduser()

    def chosen_view(self) -> View:
        return View(self.view) if self.view in set(View) else View.COLOR

    def reset(self, kept: Collection[str]) -> None:
        """Everything as it was at first, but for these fields."""
        for item in fields(self):
            if item.name not in kept:
                setattr(self, item.name, getattr(Preferences(), item.name))

    def remember_scene(self, path: Path) -> None:
        """Put a scene at the head of the recent ones."""
        name = str(path)
        self.recent = [name, *(r for r in self.recent if r != name)][:RECENT_SCENES]


def config_folder() -> Path:
    """Where settings live; not created here."""
    override = os.environ.get("SHADOWCULL_CONFIG_DIR")
    return Path(override) if override else Path(platformdirs.user_config_dir("shadowcull", appauthor=False))


def default_screenshot_folder() -> Path:
    """The user's own pictures folder, where pictures are saved unless another is set."""
    return Path(platformdirs.user_pictures_dir()) / "shadowcull"


def load_preferences(folder: Path | None = None) -> tuple[Preferences, str | None]:
    """The stored preferences, and one line about what was wrong with the file, or None."""
    data, problem = _read((folder or config_folder()) / SETTINGS_FILE)
    return (Preferences() if data is None else _from_json(data)), problem


def save_preferences(
    preferences: Preferences, folder: Path | None = None, base: Mapping[str, Any] | None = None
) -> str | None:
    """Write the preferences in one step; returns None, or one line saying why they could not be written.

    With a `base`, what they were made from, as a dictionary, changes that another window has stored meanwhile stay."""
    folder = folder or config_folder()
    path, mine = folder / SETTINGS_FILE, asdict(preferences)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with file_lock(path, PATIENCE):
            if base is not None:
                stored, _ = _read(path)
                mine = merged(base, mine, {**base, **(stored or {})})
            write_text(path, json.dumps(mine, indent=2))
    except OSError as error:
        return f"settings not saved: {path}: {error.strerror}" if error.strerror else f"settings not saved: {error}"
    return None


def _read(path: Path) -> tuple[Mapping[str, Any] | None, str | None]:
    """What a file of settings holds, None where there is none to be had; and one line about what was wrong with it.

    A file that cannot be read is kept under another name, so that saving does not destroy it."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        if not isinstance(data, dict):
            raise ValueError("not an object")
        return _of_today(data), None
    except FileNotFoundError:
        return None, None
    except (OSError, ValueError, RecursionError) as error:
        why = f"could not be read ({error.strerror})" if isinstance(error, OSError) else "were damaged"
    kept = path.with_suffix(".damaged.json")
    try:
        os.replace(path, kept)
    except OSError:
        kept = path
    return None, f"settings {why}, defaults are used; the old file is kept as {kept}"


def _from_json(data: Mapping[str, Any]) -> Preferences:
    preferences = Preferences(tour=False)  # who has a file without a word of it has used the program before
    for item in fields(Preferences):
        if item.name in data:
            default = getattr(preferences, item.name)
            value = checked(item.name, data[item.name], default)
            setattr(preferences, item.name, value)
    return preferences


def _of_today(data: Mapping[str, Any]) -> Mapping[str, Any]:
    """What is stored, with the default method in the place of the one that version 0.2 has written unasked; what is
    added to it was chosen."""
    method = data.get("method")
    if "format" in data or not isinstance(method, str) or not is_method(method):
        return data
    if Method.parse(method).base == ADAPTIVE:
        return {**data, "method": with_base(method, DEFAULT_METHOD)}
    return data


def checked(name: str, value: Any, default: Any) -> Any:
    """The value of a field if it is of the default's kind and in its range, else the default."""
    if isinstance(default, bool) or isinstance(value, bool):
        return value if isinstance(value, bool) and isinstance(default, bool) else default
    if isinstance(default, int | float):
        low, high = _RANGES.get(name, (float("-inf"), float("inf")))
        try:
            return type(default)(value) if low <= finite(value) <= high else default
        except ValueError:
            return default
    if name == "method":
        return value if isinstance(value, str) and is_method(value) and Method.parse(value).culls else default
    listed = isinstance(value, list)
    if name == "theme":
        return value if value in THEMES else default
    if name == "recent":
        return [v for v in value if isinstance(v, str)][:RECENT_SCENES] if listed else default
    if name == "keys":
        return _keys(value) if isinstance(value, dict) else default
    if name == "used":
        return [v for v in value if isinstance(v, str)][:RECENT_COMMANDS] if listed else default
    if name == "presets":
        return [v for v in value if isinstance(v, dict) and isinstance(v.get("name"), str)] if listed else default
    if name == "bookmarks":
        if not isinstance(value, dict) or not all(isinstance(v, list) for v in value.values()):
            return default
        return {scene: [mark for mark in marks if isinstance(mark, dict)] for scene, marks in value.items()}
    return value if isinstance(value, type(default)) else default


def _keys(data: Mapping[str, Any]) -> dict[str, list[str]]:
    """Lists of keys alone; which keys there are is the window's to know."""
    return {
        name: [key for key in keys if isinstance(key, str)] for name, keys in data.items() if isinstance(keys, list)
    }
