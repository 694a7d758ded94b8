"""Settings under a name: a few that come with the program, and those that the user has saved."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from viewer.state import codec
from viewer.state.methods import ADAPTIVE, BY_MODES, CERTIFIED, NO_CULLING
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences, Preset
from viewer.state.session import Session
from viewer.state.views import View

LONGEST_NAME = 60
OF_THE_MOMENT = {"spans", "zoom", "slice", "caption", "savings", "magnified"}
"""Options of drawing that belong to what is shown at the time: no preset keeps them."""


@dataclass(frozen=True)
class BuiltIn:
    """A preset that comes with the program: what its state says nothing of stays as it is."""

    name: str
    tip: str
    state: dict[str, dict[str, Any]]


BUILT_IN = (
    BuiltIn(
        "As in the paper",
        "The method paper, tested one way, with zoom factor 4, 10 bounces, a ray for each pixel, and point lights; "
        "every frame of the animation is traced, each in full, at 512 x 512. (The window always traces through its "
        "fast trees; the command bench takes the paper's kd-tree.)",
        {
            "settings": {
                "method": BY_MODES, "symmetric": False, "zoom_factor": 4.0, "depth": 10, "samples": 1, "verify": False,
                "lamp_radius": 0.0, "lamp_samples": None,
            },
            "pace": {
                "fixed_size": True, "width": 512, "height": 512, "progressive": False, "every_frame": True,
                "keep_tracing": False,
            },
        },
    ),
    BuiltIn(
        "Every ray traced",
        "No culling: the picture that all others are compared with.",
        {"settings": {"method": NO_CULLING, "verify": False}},
    ),
    BuiltIn(
        "Quick and exact",
        "The method auto, which culls where that is quicker, in the size of the window, refined while nothing moves.",
        {
            "settings": {"method": ADAPTIVE, "verify": False, "samples": 16},
            "pace": {"fixed_size": False, "progressive": True, "every_frame": False},
        },
    ),
    BuiltIn(
        "What the paper gets wrong",
        "The method paper with every culled ray traced as well, and pixels with a wrong shadow marked.",
        {
            "settings": {"method": BY_MODES, "verify": True},
            "draw": {"view": View.DIFFERENCE.value, "mark_wrong": True},
        },
    ),
    BuiltIn(
        "What certificates prove",
        "The method certified, which goes on proving while nothing moves, and the view of its certificates.",
        {
            "settings": {"method": CERTIFIED, "verify": False},
            "draw": {"view": View.CERTIFICATE.value},
            "pace": {"keep_tracing": True},
        },
    ),
)  # fmt: skip


class Presets:
    """`own` are the user's, in their order."""

    def __init__(
        self,
        session: Session,
        preferences: Preferences,
        notices: Notices,
        locked: Callable[[], bool],
        save: Callable[[], None],
        begin_step: Callable[[str], None] = lambda name: None,
    ) -> None:
        """Nothing is applied while `locked()`, which says so itself; `save` writes the preferences, `begin_step` names
        the step of undo that follows."""
        self._session, self._preferences, self._notices = session, preferences, notices
        self._locked, self._save, self._begin_step = locked, save, begin_step

    @property
    def own(self) -> list[Preset]:
        return self._preferences.presets

    @property
    def _all(self) -> list[BuiltIn | Preset]:
        return [*BUILT_IN, *self.own]

    @property
    def names(self) -> list[str]:
        """All, those of the program first."""
        return [preset.name for preset in self._all]

    def tip(self, name: str) -> str:
        """Return what a preset does."""
        return next((preset.tip for preset in BUILT_IN if preset.name == name), "saved by you")

    def apply(self, name: str) -> None:
        """Apply a preset; a damaged one is one line and changes nothing."""
        if self._locked():
            return
        session = self._session
        preset = next((one for one in self._all if one.name == name), None)
        try:
            if preset is None or not preset.state:
                raise ValueError("there is none of this name" if preset is None else "it holds no settings")
            parts = {part: preset.state[part] for part in ("settings", "draw", "pace") if part in preset.state}
            state = codec.state_from_json(parts, session.state)
        except ValueError as error:
            self._notices.say(f"the preset {name} cannot be applied: {error}", error=True)
            return
        self._begin_step(f"preset {name}")
        lights = len(session.scene.lights) if session.scene is not None else 0
        session.state = state.on_machine_of(session.state).with_draw(light=min(state.draw.light, max(lights - 1, 0)))
        self._notices.say(f"preset applied: {name}")

    def save(self, name: str) -> bool:
        """Keep what holds now under a name, in the place of one that has it; returns whether that could be done."""
        name = " ".join(name.split())[:LONGEST_NAME]
        if not name or self._is_built_in(name):
            why = "comes with the program; choose another name" if name else "give it a name"
            self._notices.say(f"preset not saved: {name + ' ' if name else ''}{why}", error=True)
            return False
        state = codec.state_to_json(self._session.state)
        draw = {option: value for option, value in state["draw"].items() if option not in OF_THE_MOMENT}
        kept = Preset(name, {"settings": state["settings"], "draw": draw, "pace": state["pace"]})
        at = self._find(name)
        if at is None:
            self.own.append(kept)
        else:
            self.own[at] = kept
        self._save()
        self._notices.say(f"preset {'saved' if at is None else 'replaced'}: {name}")
        return True

    def rename(self, index: int, name: str) -> bool:
        """Give one of the user's another name; returns whether that could be done."""
        name = " ".join(name.split())[:LONGEST_NAME]
        taken = self._find(name)
        if not name or self._is_built_in(name) or taken not in (None, index):
            self._notices.say(f"not renamed: {f'there is a preset {name}' if name else 'give it a name'}", error=True)
            return False
        self.own[index].name = name
        self._save()
        return True

    def delete(self, index: int) -> None:
        """Forget one of the user's."""
        gone = self.own.pop(index)
        self._save()
        self._notices.say(f"preset deleted: {gone.name}")

    def _find(self, name: str) -> int | None:
        return next((i for i, preset in enumerate(self.own) if preset.name == name), None)

    def _is_built_in(self, name: str) -> bool:
        return any(preset.name == name for preset in BUILT_IN)
