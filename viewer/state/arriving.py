"""What a method and a view that were chosen elsewhere are worth in a scene that has just been opened."""

from __future__ import annotations

from tracer.fit import lamps_in, remark, says_nothing, too_few
from tracer.method import Method
from tracer.scene.lights import Light
from tracer.settings import Settings
from viewer.state.views import View

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
