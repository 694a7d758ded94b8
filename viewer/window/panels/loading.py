"""How far loading is, and compiling on the first start: at the middle of the window while there is no picture."""

from __future__ import annotations

import time

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.services.jobs import Job
from viewer.window.panels import preview
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, centred, clipped, em, paragraph


def show(ui: Ui) -> None:
    """A small window, while the rest stays usable.  What is compiled behind a picture is shown in the status bar."""
    c, opener = ui.controller, ui.controller.loader
    preparing = opener.warm_up_job if c.frame is None else None
    jobs = [job for job in (preparing, opener.load_job) if job is not None]
    if not jobs:
        return
    if ui.preview is not None:
        preview.make_room(ui, em(26.0))
    else:
        centred(em(26.0), 1.0 if ui.tour.step is not None else 0.5)
    flags = imgui.WindowFlags_.no_title_bar | imgui.WindowFlags_.no_resize | imgui.WindowFlags_.no_docking
    flags |= imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_focus_on_appearing
    imgui.begin("##progress", None, int(flags))
    for job in jobs:
        if preparing is not None and job is opener.load_job and job.fraction >= 1.0:
            clipped(job.label, QUIET)  # it waits for the other
        else:
            _job(job, _PREPARING[opener.compiles] if job is preparing else job.label or "starting")
    if opener.load_job is not None:
        if opener.load_job.stopping:
            imgui.text_colored(QUIET, "cancelling ...")
        elif imgui.button(f"{icons.ICON_FA_XMARK}  Cancel##load"):
            opener.cancel()
    imgui.end()


_PREPARING = {
    True: "Its kernels are compiled for this processor. They are kept, so that later starts only load them.",
    False: "Its kernels were compiled before, and are loaded.",
}


def _job(job: Job, doing: str) -> None:
    passed = time.monotonic() - job.started
    paragraph(job.title)
    imgui.progress_bar(job.fraction, ImVec2(-1.0, 0.0), f"{100.0 * job.fraction:.0f} %, {passed:.0f} s so far")
    paragraph(doing, QUIET)
