"""Methods as the viewer chooses among them; what each can do is `tracer.method`'s to say."""

from __future__ import annotations

from collections.abc import Iterable

from tracer.method import DEFAULT_METHOD, Kind, Method, additions, bases
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
