"""The addition `rest`: objects whose animated transform does not move them now count as static."""

from __future__ import annotations

from tracer.methods.interface import ShadowMethod


class Resting(ShadowMethod):
    """Lets objects that rest block shadow rays, and carry modes, as static geometry does (`tracer.culling.rest`)."""

    def follows_rest(self) -> bool:
        return True
