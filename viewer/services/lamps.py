"""How many samples lamps have: few in motion, and at idle more, step by step, until there are as many as chosen.

Shadow modes are those of a lamp as it is sampled, and are dropped when the number of its samples changes.  So all
pictures of a motion have the same number, with which the picture that follows at idle begins as well; and each step
takes four times as many samples as the one before, so that there are few of them.
"""

from __future__ import annotations

from tracer.frame import Settings
from tracer.scene.lights import Light, as_lamps
from viewer.services.governor import Governor
from viewer.state.session import Session

FEWEST = 4
"""Samples of a lamp in the first picture at idle, and in motion where there is time for them."""
GROWTH = 4
KEPT = 4  # radii that lamps had last
OFFERED = (1, 4, 16, 64, 256)
"""To choose from; the scene may say any other number."""


class LampSamples:
    """What lamps a scene has by some settings, and how many samples they have."""

    def __init__(self) -> None:
        self._lights: tuple[Light, ...] | None = None
        self._said: dict[float | None, int] = {}

    def any(self, lights: tuple[Light, ...], settings: Settings) -> bool:
        """Whether any light is no point."""
        return self._by_scene(lights, settings.lamp_radius) > 0

    def most(self, lights: tuple[Light, ...], settings: Settings) -> int:
        """Samples of the lamp that has the most; 1 where all lights are points, or there are none."""
        said = self._by_scene(lights, settings.lamp_radius)
        return max(said, 1) if settings.lamp_samples is None or said == 0 else settings.lamp_samples

    def _by_scene(self, lights: tuple[Light, ...], radius: float | None) -> int:
        """Most samples of a lamp that the scene says, 0 without lamps; lights are gone through once."""
        if lights is not self._lights:
            self._lights, self._said = lights, {}
        if radius not in self._said:
            lamps = (light for light in as_lamps(lights, radius, None) if light.kind != "point")
            self._said = {
                **dict(list(self._said.items())[1 - KEPT :]),
                radius: max((x.samples for x in lamps), default=0),
            }
        return self._said[radius]


def first(most: int) -> int:
    """Samples of the first picture at idle, of so many in the end."""
    return most if most < 2 * FEWEST else FEWEST


def after(samples: int, most: int) -> int:
    """Samples of the picture after one with so many: the last step is skipped where it adds little."""
    more = FEWEST
    while more <= samples:
        more *= GROWTH
    return most if 2 * more > most else more


class LampSteps:
    """How many samples the lamps of the session's scene have in the next picture, and in the last at idle."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._table = LampSamples()
        self._moving: int | None = None  # samples while anything moves

    def most(self, settings: Settings) -> int:
        """Samples by some settings, of the lamp that has the most."""
        scene = self._session.scene
        return self._table.most(scene.lights, settings) if scene is not None else 1

    @property
    def wanted(self) -> int:
        """How many there should be at idle."""
        return self.most(self._session.settings)

    @property
    def any(self) -> bool:
        """Whether any light is no point, by the settings."""
        scene = self._session.scene
        return scene is not None and self._table.any(scene.lights, self._session.settings)

    def in_motion(self, governor: Governor, size: tuple[int, int], seconds: float) -> int:
        """Samples of the next picture of this size, which there are so many seconds for; the same until `at_rest`, so
        that modes are of use."""
        if self._moving is None:
            self._moving = governor.moving_samples(*size, seconds)
        return min(self._moving, self.wanted)

    def at_rest(self, last: Settings | None, come: bool) -> int:
        """Samples of the next picture; `last` are the settings of the picture of the same view that was asked for last,
        and `come` says whether it is there, whole."""
        self._moving = None
        most = self.wanted
        if last is None:
            return first(most)
        has = self.most(last)
        return min(max(first(most), after(has, most) if come else has), most)
