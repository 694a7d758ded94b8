"""Methods as the viewer chooses among them; what each can do is `tracer.method`'s to say."""

from __future__ import annotations

from collections.abc import Iterable

from tracer.fit import lamps_in, remark, says_nothing, too_few
from tracer.method import DEFAULT_METHOD, Kind, Method, additions, bases
from tracer.scene.lights import Light
from tracer.settings import Settings
from viewer.state.views import View

NO_CULLING, BY_MODES, CERTIFIED, ADAPTIVE = "none", "paper", "certified", "auto"
"""What is chosen to see every ray traced, the paper's modes at work, certificates, and whatever is quickest."""

SHOWN_BY = {
    View.CERTIFICATE: CERTIFIED,
    View.CUTS: "lightcuts",
    View.VOXELS: "voxels",
    View.CELL_LIGHTS: "lie-exact",
}
"""Views of what single methods have, and one that has it."""


def default_for(view: View) -> str:
    """The method for one picture in a view: the default one, or else one that has something to show there."""
    return SHOWN_BY.get(view, DEFAULT_METHOD)


def groups() -> list[tuple[str, list[Kind]]]:
    """The methods to choose from, those that are never wrong first."""
    exact, other = ([kind for kind in bases() if kind.exact is never] for never in (True, False))
    return [("Exact: the picture is that of none", exact), ("With errors", other)]


def with_additions(method: str, more: Iterable[str]) -> str:
    """The method with these additions besides its own."""
    parsed = Method.parse(method)
    return _named(parsed.base, {*parsed.additions, *more})


def is_method(name: str) -> bool:
    """Whether there is a method of this name."""
    try:
        Method.parse(name)
    except ValueError:
        return False
    return True


def with_base(method: str, base: str) -> str:
    """The method with another base and the same additions, but what is the base now."""
    return _named(base, Method.parse(method).additions)


def toggled(method: str, addition: str) -> str:
    """The method with an addition that it lacks, or without one that it has."""
    parsed = Method.parse(method)
    return _named(parsed.base, set(parsed.additions) ^ {addition})


def _named(base: str, chosen: Iterable[str]) -> str:
    """The name of a method with these additions, in their usual order."""
    wanted = set(chosen)
    return "+".join([base, *(kind.name for kind in additions(base, measures=True) if kind.name in wanted)])


# --- in a scene that has just been opened -----------------------------------------------------------

_OF_LIGHTS = (
    *(View.SHADOW, View.CERTIFICATE, View.PENUMBRA, View.LIGHTS, View.CUTS, View.VOXELS, View.CELL_LIGHTS),
    *(View.SAVED, View.DIFFERENCE, View.FATE, View.MOVING_SHADOW),
)
_OF_METHODS = (View.CERTIFICATE, View.VOXELS)  # views of what a method knows of single lights


def fitting_view(view: View, settings: Settings, lights: tuple[Light, ...]) -> tuple[View, str]:
    """The view to show a scene with these lights in: the picture where the chosen one would be of one colour; and what
    is to be said of it, or of what the method leaves to tracing, in a sentence."""
    method = Method.parse(settings.method)
    lamps, samples = lamps_in(lights, settings.lamp_radius, settings.lamp_samples)
    few = too_few(method, len(lights), samples)
    if not lights and view in _OF_LIGHTS:
        return View.COLOR, f"{_instead(view)}, as there are no lights."
    if few and view is View.CUTS:
        return View.COLOR, f"{_instead(view)}, as {few}."
    if lights and says_nothing(method, len(lights), lamps) and view in _OF_METHODS:
        return View.COLOR, f"{_instead(view)}, as {method} knows nothing of lamps of several samples."
    return view, f"The method {few}." if few else remark(method, len(lights), lamps)


def _instead(view: View) -> str:
    return f"The view is {View.COLOR.label}, not {view.label}"
