"""What the user set and expects to find again: one small JSON file, never half-written, in the user's configuration
folder (`SHADOWCULL_CONFIG_DIR` names another).

Reading forgives: a value that is missing, of the wrong kind or out of range keeps its default, and a file that is no
JSON is kept under another name and reported."""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, get_type_hints

import platformdirs

from tracer.method import DEFAULT_METHOD, Method
from tracer.util.setting import setting, settings_of
from viewer.state import codec
from viewer.util.files import file_lock, write_text

SETTINGS_FILE = "settings.json"
FORMAT = 3
"""Of the file; of older ones, what has the same name is read."""
PATIENCE = 2.0  # seconds that one window waits for another to save
RECENT_SCENES = 10
RECENT_COMMANDS = 30
THEMES = ("dark", "light")
NAVIGATION = {
    "fly": "drag to look around, W A S D Q E to move",
    "orbit": "drag to turn around the point that was clicked",
}
SCALES = (0.75, 0.9, 1.0, 1.1, 1.25, 1.5, 1.75, 2.0)
"""Sizes of the interface that are offered."""
DEFAULT_TEMPLATE = "{scene}-{view}-{frame:04d}-{date}-{time}.png"


@dataclass
class NamedState:
    """A state under a name, or a part of one: a bookmark, or a preset."""

    name: str
    state: dict[str, Any]


@dataclass
class Preferences:
    """Everything that outlives the window.

    `state` is what the window starts with (`codec.remembered`), `method` the one to cull by while culling is on.
    `speed` is relative to the scene's own pace.  `tour` says that the tour has not been shown yet.  `keys` are those
    that the user has chosen, by the names of commands, and `used` is what the command palette ran last, newest first.
    `bookmarks` are by the path of their scene."""

    format: int = FORMAT
    state: dict[str, Any] = field(default_factory=dict)
    method: str = setting(DEFAULT_METHOD, "Method", "What culls while culling is on.", check=Method.parse)
    navigation: str = setting("fly", "Mode", "How the pointer moves the camera.", choices=NAVIGATION, panel="Camera")
    speed: float = setting(1.0, "Speed", "How fast the camera flies: 1 crosses the scene in about eight seconds.",
                           low=0.001, high=1000.0, slider=(0.05, 20.0), log=True, unit=" x",
                           panel="Camera")  # fmt: skip
    loop: bool = setting(True, "Loop", "Begin again where the animation ends.")
    playback_rate: float = setting(1.0, "Rate", "How fast time passes: 1 is the scene's own time.", low=0.01,
                                   high=100.0, slider=(0.1, 10.0), log=True, unit=" x", panel="Camera")  # fmt: skip
    savings: bool = setting(
        True, "What culling saves",
        "Say it in a sentence above the picture, with a bar of the shadow rays by what became of them.",
    )  # fmt: skip
    legend_in_pictures: bool = setting(
        False, "Legend in saved pictures", "Draw the legend of the view into them.", panel="Saving"
    )
    savings_in_pictures: bool = setting(
        False, "Savings in saved pictures", "Say above them what culling saves.", panel="Saving"
    )
    pixel_values: bool = setting(
        True, "Values in pixels", "Write each pixel's value into it, and draw a grid, where pixels are large enough.",
        panel="Pixels",
    )  # fmt: skip
    screenshot_folder: str = setting("", "Folder", "Where pictures and results are saved.",
                                     unset="shadowcull, in your folder of pictures", panel="Saving")  # fmt: skip
    screenshot_template: str = setting(DEFAULT_TEMPLATE, "Name", "The template of the file's name.", panel="Saving")
    tev: str = setting("127.0.0.1:14158", "tev", "Where tev or HDRView listens, for Send to tev.", panel="Saving")
    tour: bool = True
    theme: str = setting("dark", "Theme", "The colours of the interface.", choices=THEMES)
    ui_scale: float = setting(
        1.0, "Size of the interface", "How large its letters are.", low=SCALES[0], high=SCALES[-1], percent=True,
        panel="Window",
    )  # fmt: skip
    watch_scene: bool = setting(
        True, "Reload when files change", "Read the scene, and what it includes, again: textures, materials, meshes."
    )
    keys: dict[str, list[str]] = field(default_factory=dict)
    used: list[str] = field(default_factory=list)
    presets: list[NamedState] = field(default_factory=list)
    recent: list[str] = field(default_factory=list)
    bookmarks: dict[str, list[NamedState]] = field(default_factory=dict)

    @property
    def picture_folder(self) -> Path:
        """Where pictures and results are saved."""
        usual = Path(platformdirs.user_pictures_dir()) / "shadowcull"  # the user's own pictures
        return Path(self.screenshot_folder or usual).expanduser()

    def reset(self, kept: Collection[str]) -> None:
        """Make everything as it was at first, but for these fields."""
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


def load_preferences(folder: Path | None = None) -> tuple[Preferences, str | None]:
    """The stored preferences, and one line about what was wrong with the file, or None."""
    data, problem = _read((folder or config_folder()) / SETTINGS_FILE)
    return (Preferences() if data is None else _from_json(data)), problem


def save_preferences(
    preferences: Preferences | Mapping[str, Any], folder: Path | None = None, base: Mapping[str, Any] | None = None
) -> str | None:
    """Write the preferences in one step; returns None, or one line saying why they could not be written.

    With a `base`, what they were made from, as a dictionary, changes that another window has stored meanwhile stay."""
    path, mine = (folder or config_folder()) / SETTINGS_FILE, codec.to_json(preferences)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with file_lock(path, PATIENCE):
            if base is not None:
                stored, _ = _read(path)
                mine = merged(base, mine, {**base, **(stored or {})})
            write_text(path, codec.text(mine, indent=2))
    except OSError as error:
        return f"settings not saved: {f'{path}: {error.strerror}' if error.strerror else error}"
    return None


def _read(path: Path) -> tuple[Mapping[str, Any] | None, str | None]:
    """What a file of settings holds, None where there is none to be had; and one line about what was wrong with it.

    A file that cannot be read is kept under another name, so that saving does not destroy it."""
    try:
        data = codec.from_text(path.read_text(encoding="utf-8"))
        if not isinstance(data, dict):
            raise ValueError("not an object")
        return data, None
    except FileNotFoundError:
        return None, None
    except (OSError, ValueError) as error:
        why = f"could not be read ({error.strerror})" if isinstance(error, OSError) else "were damaged"
    kept = path.with_suffix(".damaged.json")
    try:
        os.replace(path, kept)
    except OSError:
        kept = path
    return None, f"settings {why}, defaults are used; the old file is kept as {kept}"


def _from_json(data: Mapping[str, Any]) -> Preferences:
    """The preferences that are stored: what is wrong with a value, or beyond what there may be, is left out."""
    preferences = Preferences(tour=False)  # who has a file without a word of it has used the program before
    hints, declared = get_type_hints(Preferences), {one.name: one for one in settings_of(Preferences)}
    for item in fields(Preferences):
        if item.name in data:
            value = codec.forgiven(data[item.name], hints[item.name], getattr(preferences, item.name))
            if item.name not in declared or not declared[item.name].problem(value):
                setattr(preferences, item.name, value)
    preferences.format = FORMAT
    preferences.recent, preferences.used = preferences.recent[:RECENT_SCENES], preferences.used[:RECENT_COMMANDS]
    return preferences


# --- two windows -----------------------------------------------------------------------------------

_ABSENT = object()


def merged(base: Any, mine: Any, theirs: Any) -> Any:
    """Return what is stored after `mine` was changed from `base`, while others made `theirs` of it; all as JSON.

    What only one side has changed is as that side has it; so what `mine` knows nothing of, as a newer version's fields,
    stays.  Where both have, dictionaries are merged in turn, what either has added to a list is in it, what either has
    taken out is not, and else mine wins."""
    if base in (mine, theirs):
        return theirs if mine == base else mine
    if isinstance(mine, Mapping) and isinstance(theirs, Mapping):
        sides = base if isinstance(base, Mapping) else {}, mine, theirs
        found = {name: merged(*(side.get(name, _ABSENT) for side in sides)) for name in {**mine, **theirs}}
        return {name: value for name, value in found.items() if value is not _ABSENT}
    if isinstance(mine, list) and isinstance(theirs, list):
        before = base if isinstance(base, list) else []
        kept = [item for item in mine if item in theirs or item not in before]
        names = [item["name"] for item in kept if isinstance(item, Mapping)]  # of presets or bookmarks
        added = [item for item in theirs if item not in before and item not in kept]
        return kept + [item for item in added if not isinstance(item, Mapping) or item.get("name") not in names]
    return mine
