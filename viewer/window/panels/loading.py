"""How far loading is, and compiling on the first start: at the middle of the window while there is no picture."""

from __future__ import annotations

import time

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.services.jobs import Job
from viewer.window.panels import preview
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, centred, clipped, em, paragraph, tooltip_above


def show(ui: Ui) -> None:
    """A small window, while the rest stays usable.  What is compiled behind a picture is shown in the status bar."""
    c, opener = ui.controller, ui.controller.loader
    preparing = opener.warm_up_job if c.frame is None else None
    jobs = [job for job in (preparing, opener.load_job) if job is not None]
    if not jobs:
        return
    if ui.graphics.preview is not None:
        _slim(ui, jobs)
        return
    centred(em(26.0), 1.0 if ui.tour.step is not None else 0.5)  # above the tour
    flags = imgui.WindowFlags_.no_title_bar | imgui.WindowFlags_.no_resize | imgui.WindowFlags_.no_docking
    flags |= imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_focus_on_appearing
    imgui.begin("##progress", None, int(flags))
    for job in jobs:
        if preparing is not None and job is opener.load_job and job.fraction >= 1.0:
            clipped(job.label, QUIET)  # it waits for the other
        else:
            _job(job, doing(job, preparing, opener.compiles))
    if opener.load_job is not None:
        if opener.load_job.stopping:
            imgui.text_colored(QUIET, "cancelling ...")
        elif imgui.button(f"{icons.ICON_FA_XMARK}  Cancel##load"):
            opener.cancel()
    imgui.end()


def _slim(ui: Ui, jobs: list[Job]) -> None:
    """One line at the lower edge of the preview, which is to be seen: how far the first job is."""
    job, loader, style = jobs[0], ui.controller.loader, imgui.get_style()
    preview.make_room(ui, imgui.get_frame_height() + 2.0 * _PAD * em(1.0))
    flags = imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_docking | imgui.WindowFlags_.no_move
    flags |= imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_focus_on_appearing
    imgui.push_style_var(imgui.StyleVar_.window_padding, ImVec2(em(0.6), em(_PAD)))
    imgui.begin("##progress of the preview", None, int(flags))
    imgui.pop_style_var()
    cancel = f"{icons.ICON_FA_XMARK}  Cancel##load"
    button = 0.0
    if loader.load_job is not None:
        button = imgui.calc_text_size(cancel, True).x + 2.0 * style.frame_padding.x + style.item_spacing.x
    imgui.progress_bar(job.fraction, ImVec2(-button if button else -1.0, 0.0), in_one_line(job, loader.load_job))
    tooltip_above("\n".join(doing(each, loader.warm_up_job, loader.compiles) for each in jobs))
    if loader.load_job is not None:
        imgui.same_line()
        imgui.begin_disabled(loader.load_job.stopping)
        if imgui.button(cancel):
            loader.cancel()
        imgui.end_disabled()
    imgui.end()


def in_one_line(job: Job, load: Job | None) -> str:
    """What a job works on and how far it is, or that the load is being given up."""
    if load is not None and load.stopping:
        return "cancelling ..."
    return f"{job.title}: {_so_far(job)}"


def doing(job: Job, preparing: Job | None, compiles: bool) -> str:
    """What a job does just now; of the one that prepares kernels, whether it compiles them."""
    return _PREPARING[compiles] if job is preparing else job.label or "starting"


_PAD = 0.25  # ems
_PREPARING = {
    True: "Compiling kernels for this processor. They are cached, so later starts only load them.",
    False: "Loading compiled kernels from the cache.",
}


def _job(job: Job, does: str) -> None:
    paragraph(job.title)
    imgui.progress_bar(job.fraction, ImVec2(-1.0, 0.0), _so_far(job))
    paragraph(does, QUIET)


def _so_far(job: Job) -> str:
    return f"{100.0 * job.fraction:.0f} %, {time.monotonic() - job.started:.0f} s so far"
