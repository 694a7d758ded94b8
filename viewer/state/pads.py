"""Game pads and space mice: what they say, and what of it moves the camera."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum

from tracer.scene.model import Camera
from viewer.state.navigation import Vector, fly, look

TURN = 1.6
"""Radians per second with a stick at its end."""


class Kind(Enum):
    """How the axes of a device are to be read."""

    GAMEPAD = "game pad"
    SPACE_MOUSE = "space mouse"


@dataclass(frozen=True)
class Pad:
    """A device as it is now.  `axes` are those of GLFW's game pads (sticks, -1 to 1, right and down; triggers, -1 at
    rest) or the six of a space mouse (right, towards you, down; then the turns about these), -1 to 1; `pressed` holds
    names of buttons, of game pads alone."""

    name: str
    kind: Kind
    axes: tuple[float, ...]
    pressed: frozenset[str] = field(default=frozenset())


@dataclass(frozen=True)
class Push:
    """Where a hand wants to go, -1 to 1 each: along the camera's right, the world's up and the view; and turns."""

    right: float = 0.0
    up: float = 0.0
    forward: float = 0.0
    turn_right: float = 0.0
    turn_up: float = 0.0

    def __bool__(self) -> bool:
        return any((self.right, self.up, self.forward, self.turn_right, self.turn_up))


def push(pad: Pad, dead_zone: float) -> Push:
    """What the axes of a device ask for; a hand that does not touch it asks for nothing."""
    a = [*pad.axes, *[0.0] * 6]
    if pad.kind is Kind.SPACE_MOUSE:
        x, y, z, pitch, _, yaw = (_beyond(value, dead_zone) for value in a[:6])
        return Push(x, -z, -y, yaw, -pitch)
    (x, y), (turn_x, turn_y) = _stick(a[0:2], dead_zone), _stick(a[2:4], dead_zone)
    if len(pad.axes) < 6:
        return Push(x, 0.0, -y, turn_x, -turn_y)
    down, up = (_beyond(0.5 * (value + 1.0), dead_zone) for value in a[4:6])
    return Push(x, up - down, -y, turn_x, -turn_y)


def moved(camera: Camera, wanted: Push, way: float, seconds: float, world: Vector) -> Camera:
    """The camera after so many seconds, in which a full push goes `way` world units."""
    if wanted.right or wanted.up or wanted.forward:
        camera = fly(camera, wanted.right * way, wanted.up * way, wanted.forward * way, world)
    if wanted.turn_right or wanted.turn_up:
        camera = look(camera, wanted.turn_right * TURN * seconds, wanted.turn_up * TURN * seconds, world)
    return camera


def _stick(xy: Sequence[float], dead_zone: float) -> tuple[float, float]:
    """A stick's two axes, whose dead zone is round: a slight slant stays one."""
    length = (xy[0] ** 2 + xy[1] ** 2) ** 0.5
    if length <= dead_zone or not length < 1e6:
        return 0.0, 0.0
    size = _beyond(min(length, 1.0), dead_zone) / length
    return xy[0] * size, xy[1] * size


def _beyond(value: float, dead_zone: float) -> float:
    """An axis without its dead zone, from 0 at its border; fine near it, as the square of the rest."""
    if not abs(value) > dead_zone:
        return 0.0
    part = (min(abs(value), 1.0) - dead_zone) / (1.0 - dead_zone)
    return part * part if value > 0.0 else -part * part
