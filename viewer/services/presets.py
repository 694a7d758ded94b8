"""Settings under a name: a few that come with the program, and those that the user has saved."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

from viewer.state.choices import Choices
from viewer.state.methods import ADAPTIVE, BY_MODES, CERTIFIED, NO_CULLING
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.views import View

LONGEST_NAME = 60


@dataclass(frozen=True)
class BuiltIn:
    """A preset that comes with the program: what it says nothing of stays as it is."""

    name: str
    tip: str
    settings: dict[str, Any]
    view: View | None = None
    looks: dict[str, Any] = field(default_factory=dict)


BUILT_IN = (
    BuiltIn(
        "As in the paper",
        "The method paper, tested one way, with zoom factor 4, 10 bounces, a ray for each pixel, and point lights; "
        "every frame of the animation is traced, each in full, at 512 x 512. (The window always traces through its "
        "fast trees; the command bench takes the paper's kd-tree.)",
        {
            "method": BY_MODES, "symmetric": False, "zoom_factor": 4.0, "depth": 10, "samples": 1, "verify": False,
            "lamp_radius": 0.0, "lamp_samples": None,
        },
        None,
        {
            "fixed_resolution": True, "fixed_width": 512, "fixed_height": 512, "dynamic_resolution": False,
            "every_frame": True, "keep_tracing": False,
        },
    ),
    BuiltIn(
        "Every ray traced",
        "No culling: the picture that all others are compared with.",
        {"method": NO_CULLING, "verify": False},
    ),
    BuiltIn(
        "Quick and exact",
        "The method auto, which culls where that is quicker, in the size of the window, refined while nothing moves.",
        {"method": ADAPTIVE, "verify": False, "samples": 16},
        None,
        {"fixed_resolution": False, "dynamic_resolution": True, "every_frame": False},
    ),
    BuiltIn(
        "What the paper gets wrong",
        "The method paper with every culled ray traced as well, and pixels with a wrong shadow marked.",
        {"method": BY_MODES, "verify": True},
        View.DIFFERENCE,
        {"mark_wrong": True},
    ),
    BuiltIn(
        "What certificates prove",
        "The method certified, which goes on proving while nothing moves, and the view of its certificates.",
        {"method": CERTIFIED, "verify": False},
        View.CERTIFICATE,
        {"keep_tracing": True},
    ),
)  # fmt: skip


class Presets:
    """`own` are the user's, as {"name": ..., "choices": JSON of Choices}, in their order."""

    def __init__(
        self,
        session: Session,
        preferences: Preferences,
        notices: Notices,
        locked: Callable[[], bool],
        save: Callable[[], None],
        call_next: Callable[[str], None] = lambda name: None,
    ) -> None:
        """Nothing is applied while `locked()`, which says so itself; `save` writes the preferences, `call_next` names
        the step of undo that follows."""
        self._session, self._preferences, self._notices = session, preferences, notices
        self._locked, self._save, self._call_next = locked, save, call_next

    @property
    def own(self) -> list[dict]:
        return self._preferences.presets

    @property
    def names(self) -> list[str]:
        """All, those of the program first."""
        return [preset.name for preset in BUILT_IN] + [str(preset.get("name", "?")) for preset in self.own]

    def tip(self, name: str) -> str:
        """What a preset does."""
        return next((preset.tip for preset in BUILT_IN if preset.name == name), "saved by you")

    def apply(self, name: str) -> None:
        """Make its choices hold; a damaged one is one line and changes nothing."""
        if self._locked():
            return
        try:
            choices = self._choices(name)
            self._call_next(f"preset {name}")
            choices.put_into(self._session, self._preferences)
        except (ValueError, KeyError) as error:
            self._notices.say(f"the preset {name} cannot be applied: {error}", error=True)
            return
        self._notices.say(f"preset applied: {name}")

    def save(self, name: str) -> bool:
        """Keep what holds now under a name, in the place of one that has it; returns whether that could be done."""
        name = " ".join(name.split())[:LONGEST_NAME]
        if not name or self._is_built_in(name):
            why = "comes with the program; choose another name" if name else "give it a name"
            self._notices.say(f"preset not saved: {name + ' ' if name else ''}{why}", error=True)
            return False
        kept = {"name": name, "choices": Choices.of(self._session, self._preferences).to_json()}
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
        self.own[index]["name"] = name
        self._save()
        return True

    def delete(self, index: int) -> None:
        """Forget one of the user's."""
        gone = self.own.pop(index)
        self._save()
        self._notices.say(f"preset deleted: {gone.get('name', '?')}")

    def _choices(self, name: str) -> Choices:
        built_in = next((preset for preset in BUILT_IN if preset.name == name), None)
        if built_in is None:
            at = self._find(name)
            if at is None:
                raise ValueError("there is none of this name")
            return Choices.from_json(self.own[at].get("choices"))
        now = Choices.of(self._session, self._preferences)
        view = built_in.view or now.view
        return replace(now, settings=now.settings | built_in.settings, view=view, looks=now.looks | built_in.looks)

    def _find(self, name: str) -> int | None:
        return next((i for i, preset in enumerate(self.own) if preset.get("name") == name), None)

    def _is_built_in(self, name: str) -> bool:
        return any(preset.name == name for preset in BUILT_IN)
