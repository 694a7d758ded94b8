"""The preview in each of the window's frames: before its widgets, and the window's framebuffer stays bound."""

from __future__ import annotations

import time

import moderngl

from viewer.window.preview import PreviewDisplay
from viewer.window.ui import Ui

BRINGING = 0.01  # seconds of each of the window's frames, at most, unless one piece takes longer


def draw(ui: Ui) -> None:
    """Draw the preview where there is one, from where the camera is; free what it took once there is none any more."""
    c, display = ui.controller, ui.display
    geometry = c.preview.geometry
    if display is None or geometry is None:
        if ui.preview is not None:
            ui.preview.release()
            ui.preview = None
        return
    if ui.preview is None or ui.preview.geometry is not geometry:
        if ui.preview is not None:
            ui.preview.release()
        ui.preview = PreviewDisplay(display.context, geometry)
    width, height = ui.picture_area
    if min(width, height) < 1:
        return
    window = display.context.detect_framebuffer()
    try:
        until = time.perf_counter() + BRINGING
        while ui.preview.bring() and time.perf_counter() < until:
            pass
        if ui.preview.whole:
            ui.preview.draw(c.session.camera, (width, height), hurried=c.motion.under_way)
        else:
            c.wake()
    finally:
        window.use()
        display.context.disable(moderngl.DEPTH_TEST)
