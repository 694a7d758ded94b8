"""What is on its way, in words: the first picture of a scene, and answers that wait for what is being traced."""

from __future__ import annotations

from viewer.services.controller import Controller
from viewer.window.panels import status


def after(c: Controller) -> str:
    """What is traced before a question about the picture is answered; nothing where it is answered at once."""
    if c.scheduler.refines_lamps:
        return "the samples of lamps"
    if c.scheduler.adds_samples:
        return "this sample"
    return "this picture" if c.renderer.busy else ""


def first_picture(c: Controller) -> str:
    """What goes on while there is no picture, in a sentence."""
    doing = status.doing(c)
    if doing == status.IDLE:
        return "No picture has been traced yet."
    return "Tracing the first picture ..." if doing == status.TRACING else f"{doing[0].upper()}{doing[1:]}"
