"""What game pads and space mice ask for."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tracer.scene.model import Camera
from viewer.state.pads import TURN, Kind, Pad, Push, moved, push

UP = np.array([0.0, 1.0, 0.0])
HERE = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0))


def pad(*axes: float) -> Pad:
    return Pad("pad", Kind.GAMEPAD, (*axes, *(0.0, 0.0, 0.0, 0.0, -1.0, -1.0)[len(axes) :]))


def test_a_pad_that_nobody_touches_asks_for_nothing():
    assert not push(pad(), 0.15) and not push(pad(0.1, -0.1), 0.15), "nor do sticks that stand a little askew"
    assert not push(pad(float("nan"), 0.0), 0.15)
    assert not push(Pad("mouse", Kind.SPACE_MOUSE, (0.01,) * 6), 0.05)


def test_sticks_move_and_turn_and_triggers_go_up_and_down():
    assert push(pad(1.0, 0.0), 0.15) == Push(right=1.0) and push(pad(0.0, -1.0), 0.15) == Push(forward=1.0)
    assert push(pad(0.0, 0.0, 1.0, -1.0 * 0), 0.15) == Push(turn_right=1.0)
    assert push(pad(0.0, 0.0, 0.0, 1.0), 0.15) == Push(turn_up=-1.0)
    assert push(pad(0.0, 0.0, 0.0, 0.0, 1.0, -1.0), 0.15) == Push(up=-1.0)
    assert push(pad(0.0, 0.0, 0.0, 0.0, -1.0, 1.0), 0.15) == Push(up=1.0)


def test_a_stick_begins_softly_at_the_border_of_its_dead_zone_and_keeps_its_direction():
    assert 0.0 < push(pad(0.2, 0.0), 0.15).right < 0.01
    slanted = push(pad(0.6, -0.3), 0.15)
    assert slanted.right / slanted.forward == pytest.approx(2.0), "the dead zone is round"
    corner = push(pad(1.0, -1.0), 0.15)
    assert math.hypot(corner.right, corner.forward) == pytest.approx(1.0), "no faster across the corner"


def test_a_space_mouse_moves_and_turns_at_once():
    mouse = Pad("mouse", Kind.SPACE_MOUSE, (1.0, -1.0, -1.0, 0.0, 0.0, 1.0))
    assert push(mouse, 0.1) == Push(1.0, 1.0, 1.0, 1.0, 0.0)


def test_a_push_moves_the_camera_as_far_as_it_says():
    after = moved(HERE, Push(right=1.0, forward=0.5), 2.0, 0.1, UP)
    assert after.position == pytest.approx((2.0, 0.0, -1.0)) and after.direction == HERE.direction
    turned = moved(HERE, Push(turn_right=1.0), 2.0, 0.1, UP).basis()[2]
    assert math.acos(float(turned @ HERE.basis()[2])) == pytest.approx(0.1 * TURN) and turned[0] > 0.0
