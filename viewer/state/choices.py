"""What the user has chosen to see and how: settings, view, light and the looks of the picture, as one value.

It is what a step of undo brings back, and what a preset keeps.  Camera, time and scene are no part of it.  How closely
the picture is looked at, ranges of colours and the comparison are undone, but no preset keeps them: they belong to what
is shown at the time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from tracer.setting import check_all
from viewer.state import codec
from viewer.state.comparison import Chosen
from viewer.state.draw_options import Slice
from viewer.state.preferences import Preferences, checked
from viewer.state.session import Session, settings_from_json, settings_to_json
from viewer.state.tone import NEUTRAL, Tone
from viewer.state.views import View
from viewer.state.zooming import Zoom
from viewer.util.json_numbers import number, whole

LOOKS = {
    "outlines": "outlines",
    "mark_wrong": "marks of wrong pixels",
    "work_shares": "shares of rays",
    "draw_explanation": "shadow rays drawn",
    "legend": "legend",
    "shading": "shading",
    "beneath": "picture beneath",
    "smooth_upscaling": "smooth upscaling",
    "fixed_resolution": "fixed size",
    "fixed_width": "width",
    "fixed_height": "height",
    "dynamic_resolution": "progressive refinement",
    "certificate_share": "share of certificates",
    "keep_tracing": "tracing at idle",
    "every_frame": "every frame",
}
"""Fields of the preferences that change what the picture shows, and what each is called."""

_SETTINGS = {
    "depth": "bounces",
    "symmetric": "symmetric occlusion test",
    "zoom_factor": "zoom factor",
    "lamp_radius": "lamp radius",
    "lamp_samples": "lamp samples",
    "lightcuts_error": "error of clusters",
    "lightcuts_nodes": "clusters of lights",
}


@dataclass(frozen=True)
class Choices:
    """`settings` holds fields of `tracer.Settings` as a snapshot does, `looks` those of LOOKS; None says nothing.
    `light_number` is what people call the light."""

    settings: dict[str, Any]
    view: View = View.COLOR
    light: int = 0
    wipe: float = 0.5
    looks: dict[str, Any] = field(default_factory=dict)
    tone: Tone | None = None
    clipping: bool | None = None
    spans: dict[View, tuple[float, float]] | None = None
    zoom: Zoom | None = None
    comparison: Chosen | None = None
    cut: Slice | None = None
    light_number: int | None = field(default=None, compare=False)

    @staticmethod
    def of(session: Session, preferences: Preferences) -> Choices:
        """Those that hold now."""
        looks = {name: getattr(preferences, name) for name in LOOKS}
        s = session
        return Choices(
            settings_to_json(s.settings), s.view, s.light, s.wipe, looks,
            s.tone, s.clipping, dict(s.spans), s.zoom, s.comparison.chosen, s.cut, s.light_number,
        )  # fmt: skip

    def put_into(self, session: Session, preferences: Preferences) -> None:
        """Make them hold; what they say nothing of stays.  Raises ValueError, and changes nothing, where the settings
        do not go together."""
        settings = replace(session.settings, **self.settings).validated()
        lights = len(session.scene.lights) if session.scene is not None else 0
        session.settings, session.view, session.wipe = settings, self.view, self.wipe
        session.light = min(self.light, max(lights - 1, 0))
        session.tone = session.tone if self.tone is None else self.tone
        session.clipping = session.clipping if self.clipping is None else self.clipping
        session.spans = session.spans if self.spans is None else dict(self.spans)
        session.zoom = session.zoom if self.zoom is None else self.zoom
        session.cut = session.cut if self.cut is None else self.cut
        if self.comparison is not None:
            session.comparison.choose(self.comparison)
        preferences.keep(settings)
        preferences.view = self.view.value
        for name, value in self.looks.items():
            setattr(preferences, name, value)

    def to_json(self) -> dict[str, Any]:
        values = {"settings": self.settings, "view": self.view.value, "light": self.light, "wipe": self.wipe}
        tone = {} if self.tone is None else {"tone": codec.to_json(self.tone)}
        clipping = {} if self.clipping is None else {"clipping": self.clipping}
        return values | {"looks": self.looks} | tone | clipping

    @staticmethod
    def from_json(data: Any) -> Choices:
        """The inverse of `to_json`; raises ValueError, in one line, on anything else."""
        if not isinstance(data, Mapping):
            raise ValueError("it holds no settings")
        looks, defaults = data.get("looks", {}), Preferences()
        if not isinstance(looks, Mapping):
            raise ValueError("its looks are damaged")
        try:
            return Choices(
                settings_from_json(data.get("settings", {})),
                View(data.get("view", View.COLOR)),
                max(0, whole(data.get("light", 0))),
                min(max(number(data.get("wipe", 0.5)), 0.0), 1.0),
                {name: checked(name, looks[name], getattr(defaults, name)) for name in LOOKS if name in looks},
                check_all(codec.patched(NEUTRAL, data["tone"])) if "tone" in data else None,
                bool(data["clipping"]) if "clipping" in data else None,
            )
        except TypeError:
            raise ValueError("it is damaged") from None


def differences(before: Choices, after: Choices) -> dict[str, str]:
    """What has changed from the one to the other: for each field, in a few words, what it is now."""
    changed: dict[str, str] = {}
    for name in before.settings.keys() | after.settings.keys():
        value = after.settings.get(name)
        if before.settings.get(name) != value:
            changed[f"settings.{name}"] = _in_words(_SETTINGS.get(name, name.replace("_", " ")), value)
    if before.view is not after.view:
        changed["view"] = f"view {after.view.label}"
    if before.light != after.light:
        changed["light"] = f"light {after.light if after.light_number is None else after.light_number}"
    if before.wipe != after.wipe:
        changed["wipe"] = "line of the wipe"
    for name, called in LOOKS.items():
        if before.looks.get(name) != after.looks.get(name):
            changed[f"looks.{name}"] = _in_words(called, after.looks.get(name))
    if before.tone != after.tone and after.tone is not None:
        changed["tone"] = f"tone {after.tone.in_words() or 'as traced'}"
    if before.clipping != after.clipping:
        changed["clipping"] = _in_words("marks of clipped pixels", after.clipping)
    if before.spans != after.spans:
        changed["spans"] = "range of colours"
    if before.cut != after.cut and after.cut is not None:
        changed["cut"] = f"slice {after.cut.in_words()}"
    if before.zoom != after.zoom and after.zoom is not None:
        changed["zoom"] = "zoom to the whole picture" if after.zoom.fits else f"zoom to {after.zoom.scale:.3g} x"
    if before.comparison is not None and after.comparison is not None:
        words = before.comparison.changes(after.comparison)
        changed |= {f"comparison.{name}": said for name, said in words.items()}
    return changed


def _in_words(name: str, value: Any) -> str:
    if isinstance(value, bool):
        return f"{name} {'on' if value else 'off'}"
    if value is None:
        return f"{name} of the scene"
    return f"{name} {value:.4g}" if isinstance(value, float) else f"{name} {value}"
