"""The preview in each of the window's frames: before its widgets, and the window's framebuffer stays bound."""

from __future__ import annotations

import time

import moderngl

from viewer.state.preview_geometry import PreviewGeometry
from viewer.window.display import Display
from viewer.window.preview import PreviewDisplay
from viewer.window.ui import Ui

BRINGING = 0.01  # seconds of each of the window's frames, at most, unless one piece takes longer


def draw(ui: Ui) -> None:
    """Draw the preview where there is one, from where the camera is; free what it took once there is none any more.

    A geometry that failed to be drawn is not tried again in this window."""
    geometry = ui.controller.preview.geometry
    if ui.display is None or geometry is None:
        release(ui)
    elif ui.not_previewed is not geometry:
        try:
            _draw(ui, ui.display, geometry)
        except Exception:
            release(ui)
            ui.not_previewed = geometry
            raise


def release(ui: Ui) -> None:
    """Free what the preview took; whatever comes next is tried."""
    if ui.preview is not None:
        ui.preview.release()
    ui.preview = ui.not_previewed = None


def _draw(ui: Ui, display: Display, geometry: PreviewGeometry) -> None:
    c = ui.controller
    if ui.preview is None or ui.preview.geometry is not geometry:
        release(ui)
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
