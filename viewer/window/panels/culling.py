"""The culling: its method and settings."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from imgui_bundle import ImVec4, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.method import Method
from tracer.settings import MAX_NODES
from viewer.services.controller import Controller
from viewer.state import terms, verified
from viewer.state.preferences import MOST_CERTIFYING
from viewer.window.panels.method_choice import method_list
from viewer.window.ui import Ui
from viewer.window.widgets import (
    ERROR,
    QUIET,
    checkbox,
    paragraph,
    properties,
    row,
    same_line_for,
    wide_button,
)

_PALE = 0.55
"""How much is left of what does nothing to the pictures of the chosen method."""


def show(ui: Ui) -> None:
    """The panel."""
    c = ui.controller
    s, p = c.session.settings, c.preferences
    _method(ui)
    paragraph(trust(c), QUIET)
    clusters = Method.parse(s.method).clusters
    if not clusters:  # which keep no modes
        tip = "test two neighbouring pixels both ways: each one's ray against the other's primitive"
        tip += ui.key("Symmetric occlusion test")
        with _of_modes(s.method) as besides:
            checkbox("Symmetric occlusion test", s.symmetric, lambda on: c.settings.change(symmetric=on), tip + besides)
        same_line_for("Verify")
    tip = f"trace every culled shadow ray as well, and count wrong answers{ui.key('Verify')}"
    checkbox("Verify", s.verify, lambda on: c.settings.change(verify=on), tip)
    with properties("culling", 8.2 if Method.parse(s.method).has_certificates else 6.5) as shown:
        if shown and not clusters:
            with _of_modes(s.method) as besides:
                tip = "a primitive that covers this many times its highest pixel count is examined again"
                row("Zoom factor", tip + besides)
                flags = int(imgui.SliderFlags_.logarithmic)
                changed, factor = imgui.slider_float("##zoom", s.zoom_factor, 1.0, 64.0, "%.1f", flags)
            if changed:
                c.settings.change(zoom_factor=factor)
        if shown and clusters:
            row(
                "Error of clusters",
                "the part of a point's light that a cluster of lights may be wrong by; 0: no clusters",
            )
            flags = int(imgui.SliderFlags_.logarithmic)
            changed, error = imgui.slider_float("##cuts", 100.0 * s.lightcuts_error, 0.0, 100.0, "%.2f %%", flags)
            if changed:
                c.settings.change(lightcuts_error=max(error, 0.0) / 100.0)
            row("Clusters at most", "of lights, for a point: as many as this where the error would ask for more")
            changed, most = imgui.slider_int("##nodes", s.lightcuts_nodes, 1, MAX_NODES, "%d", flags)
            if changed:
                c.settings.change(lightcuts_nodes=min(max(most, 1), MAX_NODES))
        if shown and Method.parse(s.method).has_certificates:
            made = terms.things(terms.made(s.method)[0])
            row(
                "Certificate budget",
                f"the share of each frame's time for {made} while anything moves; when idle they get more",
            )
            share = 100.0 * p.certificate_share
            changed, share = imgui.slider_float("##share", share, 1.0, 100.0 * MOST_CERTIFYING, "%.0f %%")
            if changed:
                p.certificate_share = min(max(share / 100.0, 0.0), MOST_CERTIFYING)
    if wide_button(
        f"{icons.ICON_FA_ERASER}  Reset modes", f"forget all modes and certificates{ui.key('Reset modes')}", 2
    ):
        c.reset_modes()
    imgui.same_line()
    if wide_button(
        f"{icons.ICON_FA_ROTATE_RIGHT}  Trace again",
        f"trace the same frame once more, with what is known after the last one{ui.key('Trace again')}",
    ):
        c.scheduler.trace_again()

    def keep(on: bool) -> None:
        p.keep_tracing = on
        c.scheduler.trace_again()

    checkbox(
        "Keep tracing when idle",
        p.keep_tracing,
        keep,
        f"trace frame after frame, to watch how modes are set and certificates made{ui.key('Keep tracing when idle')}",
    )
    said = wrong_answers(c)
    if said is not None:  # at the end, where it moves nothing
        paragraph(*said)


@contextmanager
def _of_modes(method: str) -> Iterator[str]:
    """What concerns modes alone: pale where the method does not cull by them; yields what its tip says of that."""
    culls_by_them = Method.parse(method).uses_modes
    imgui.push_style_var(imgui.StyleVar_.alpha, imgui.get_style().alpha * (1.0 if culls_by_them else _PALE))
    yield "" if culls_by_them else f"\n{method} does not cull by modes: it changes those kept for the views alone"
    imgui.pop_style_var()


def _method(ui: Ui) -> None:
    """The base, and what is added to it."""
    c = ui.controller
    name = c.session.settings.method
    with properties("method", 4.0) as shown:
        if shown:
            row("Method", "which shadow rays are not traced, and what that trusts; C turns culling off and on")
            method_list(ui, "##method", name, lambda chosen: c.settings.change(method=chosen))


def trust(c: Controller) -> str:
    """What the chosen method trusts and whether it is exact, then what it does in the newest picture, and why."""
    frame, name = c.frame, c.session.settings.method
    kinds = Method.parse(name).kinds
    said = [kind.summary if len(kinds) == 1 else f"{kind.name}: {kind.summary}" for kind in kinds]
    if frame is not None and frame.settings.method == name and c.runs.current is None:
        said.append(frame.statistics.decision)
    return " ".join(filter(None, said))


def wrong_answers(c: Controller) -> tuple[str, ImVec4] | None:
    """What is wrong in the newest frame, and a colour; None where that is not known, or where the frame
    was traced with another method than the panel shows.  A run has figures of its own, in its panel."""
    if c.frame is None or not c.frame.settings.verify:
        return None
    if c.runs.current is not None:
        return f"wrong answers of the {c.runs.current.name} are in its own panel", QUIET
    if c.frame.settings.method != c.scheduler.settings.method:
        return None
    said, color = verified.in_words(c.frame.statistics), ERROR if verified.is_wrong(c.frame.statistics) else QUIET
    if not c.scheduler.settings.verify or c.session.settings.verify:
        return said, color
    return f"{said} (verified for the view {c.session.view.label})", color
