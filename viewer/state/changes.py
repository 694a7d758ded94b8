"""What is otherwise in one state than in another, in a few words: for undo, the list of edits, and the command line."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from tracer.scene.edits import Edits
from tracer.setting import ALWAYS, settings_of
from viewer.state.view_state import ViewState

CAMERA = "camera"

_EDITS = {
    "lights_off": ("light {}", "off", "on", "--without-light={}"),
    "moved_lights": ("light {}", "moved", "where it was", "--move-light={}={}"),
    "hidden": ("{}", "hidden", "shown", "--hide={}"),
    "hidden_primitives": ("primitive {}", "hidden", "shown", "--hide-primitive={}"),
    "static": ("{}", "static", "moving", "--make-static={}={}"),
    "moving": ("{}", "moving", "static", "--make-moving={}"),
}
"""By the field of `Edits`: what is edited, what it is then and what without the edit, and the option that asks for it,
with a place or a time where there is one."""


def changes(old: ViewState, new: ViewState) -> dict[str, str]:
    """Return what has changed from one state to another: for each field, in a few words, what it is now."""
    changed = {
        one.path: one.in_words(one.get(new))
        for one in settings_of(ViewState)
        if one.stored == ALWAYS and one.get(old) != one.get(new)
    }
    changed |= {f"comparison.{name}": said for name, said in old.compare.changes(new.compare).items()}
    if old.camera != new.camera:
        changed[CAMERA] = "camera onto the scene's path" if new.camera is None else "camera"
    return changed | edits_in_words(old.edits, new.edits)


def edits_in_words(before: Edits, after: Edits) -> dict[str, str]:
    """Return what has changed from the one to the other: for each target, in a few words, what it is now."""
    changed = {}
    for name, (called, edited, unedited, _) in _EDITS.items():
        old, new = _targets(before, name), _targets(after, name)
        for target in sorted(target for target in {**old, **new} if old.get(target) != new.get(target)):
            changed[f"{name} {target}"] = f"{called.format(target)} {edited if target in new else unedited}"
    return changed


def one_by_one(edits: Edits) -> list[tuple[str, Edits]]:
    """Return each edit in a few words, and all others without it."""
    found = []
    for item in fields(Edits):
        kept = getattr(edits, item.name)
        for one in kept:
            without = replace(edits, **{item.name: type(kept)(other for other in kept if other != one)})
            found += [(said, without) for said in edits_in_words(without, edits).values()]
    return sorted(found, key=lambda pair: pair[0])


def as_options(edits: Edits) -> list[str]:
    """Return the options of a command line that ask for these edits, to the bit."""
    options = []
    for name, (_, _, _, option) in _EDITS.items():
        for target, value in sorted(_targets(edits, name).items()):
            place = ",".join(map(repr, value)) if isinstance(value, tuple) else repr(value)
            options.append(option.format(target, place))
    return options


def _targets(edits: Edits, name: str) -> dict[Any, Any]:
    """Return what a field of edits is about, each with its place, its time or True."""
    kept = getattr(edits, name)
    return dict(kept) if isinstance(kept, tuple) else dict.fromkeys(kept, True)
