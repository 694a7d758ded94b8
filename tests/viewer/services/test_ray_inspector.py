"""The clicked pixel's rays are listed while somebody looks, and stay true."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.viewer.desk import Desk
from viewer.services.ray_inspector import RayInspector
from viewer.state import navigation
from viewer.window.panels.ray_overlay import RayLine, ray_lines


def looked_at(desk: Desk) -> RayInspector:
    """The inspector of a desk whose panel is seen from now on."""
    rays, tick = desk.c.rays, desk.tick

    def with_panel() -> None:
        rays.watch()
        tick()

    desk.tick = with_panel  # type: ignore[method-assign]
    return rays


def middle(desk: Desk) -> tuple[float, float]:
    """A pixel of the square that is lit and whose neighbours are alike."""
    frame = desk.c.frame
    here = (frame.primitive >= 0) & (frame.primitive < 2)
    for shift in (-2, 2):
        here &= np.roll(here, shift, 0) & np.roll(here, shift, 1)
    y, x = np.argwhere(here)[here.sum() // 2]
    return (x + 0.5) / frame.width, (y + 0.5) / frame.height


def lines(rays: RayInspector) -> list[RayLine]:
    """What is drawn of the rays on their own frame."""
    return ray_lines(rays.tree.frame, rays.tree, rays.shown)


def test_nothing_is_listed_unless_it_is_seen(desk: Desk) -> None:
    desk.c.selection.select(middle(desk))
    desk.rest()
    assert desk.c.rays.tree is None
    rays, traced = looked_at(desk), desk.c.history.frames
    desk.until(lambda: rays.tree is not None)
    assert (rays.tree.x, rays.tree.y) == desk.c.selection.pixel and rays.tree.frame.primitive is desk.c.frame.primitive
    assert desk.c.history.frames == traced
    desk.c.selection.clear()
    desk.until(lambda: rays.tree is None)


def test_the_tree_is_of_the_newest_picture_and_keeps_what_is_selected(desk: Desk) -> None:
    rays = looked_at(desk)
    desk.c.selection.select(middle(desk))
    desk.until(lambda: rays.tree is not None)
    first, row = rays.tree, rays.seen[1][1]
    rays.select(row)
    desk.c.motion.move(navigation.look(desk.c.session.camera, 0.02, 0.0, desk.c.motion.world_up))
    desk.until(lambda: rays.tree is not first and rays.tree.frame.primitive is desk.c.frame.primitive)
    assert rays.selected is not None and rays.selected.key == row.key
    desk.c.motion.move(navigation.look(desk.c.session.camera, 2.5, 0.0, desk.c.motion.world_up))
    desk.rest()
    assert rays.tree is not None, "out of sight it is what it was"


def test_rays_follow_an_edit_of_the_scene(desk: Desk) -> None:
    """The picture before and the one after are of the same time, camera and settings."""
    rays, c = looked_at(desk), desk.c
    c.selection.select(middle(desk))
    desk.until(lambda: rays.tree is not None)
    rays.select(rays.seen[1][1])
    first, drawn = rays.tree, lines(rays)
    assert drawn
    c.editing.change(c.editing.now.with_light(0, False))
    desk.until(lambda: rays.tree is not None and rays.tree is not first)
    desk.rest()
    assert len(lines(rays)) < len(drawn), "a light less shines on it"
    c.undo.undo()
    desk.rest()
    assert len(lines(rays)) == len(drawn)
    again = replace(first, frame=replace(first.frame, color=first.frame.color.copy()))
    assert (again, again.frame) != (first, first.frame), "arrays alone cannot be compared as one"
