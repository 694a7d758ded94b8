"""What is seen until there is a picture: how far loading and compiling are, over a preview where there is one."""

from __future__ import annotations

import time

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.services.jobs import Job
from viewer.window.panels.area import write_lines
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, centred, clipped, em, paragraph

_PREPARING = {
    True: "Compiling kernels for this processor. They are cached, so later starts only load them.",
    False: "Loading compiled kernels from the cache.",
}


def show(ui: Ui) -> None:
    """A small window, while the rest stays usable.  What is compiled behind a picture is shown in the status bar, and
    in words over a preview."""
    c, loader = ui.controller, ui.controller.loader
    preparing = loader.warm_up_job if c.frame is None else None
    jobs = [job for job in (preparing, loader.load_job) if job is not None]
    if not jobs or c.preview.geometry is not None:
        return
    centred(em(26.0), 1.0 if ui.tour.step is not None else 0.5)  # above the tour
    flags = imgui.WindowFlags_.no_title_bar | imgui.WindowFlags_.no_resize | imgui.WindowFlags_.no_docking
    flags |= imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_focus_on_appearing
    imgui.begin("##progress", None, int(flags))
    for job in jobs:
        if preparing is not None and job is loader.load_job and job.fraction >= 1.0:
            clipped(job.label, QUIET)  # it waits for the other
            continue
        paragraph(job.title)
        so_far = f"{100.0 * job.fraction:.0f} %, {time.monotonic() - job.started:.0f} s so far"
        imgui.progress_bar(job.fraction, ImVec2(-1.0, 0.0), so_far)
        paragraph(_PREPARING[loader.compiles] if job is preparing else job.label or "starting", QUIET)
    if loader.load_job is not None and imgui.button(f"{icons.ICON_FA_XMARK}  Cancel##load"):
        loader.cancel()
    imgui.end()


def show_preview(ui: Ui, room: ImVec2) -> bool:
    """The preview, if there is any, as an item that takes the pointer, and what it is."""
    texture = ui.graphics.preview.texture_id if ui.graphics.preview is not None else None
    if texture is None:
        return False
    corner = imgui.get_cursor_screen_pos()
    imgui.set_next_item_allow_overlap()
    imgui.invisible_button("preview", room, int(imgui.ButtonFlags_.mouse_button_mask_))
    end = ImVec2(corner.x + room.x, corner.y + room.y)
    imgui.get_window_draw_list().add_image(imgui.ImTextureRef(texture), corner, end)
    write_lines(words(ui.controller.loader.warm_up_job), corner)
    return True


def words(compiling: Job | None) -> list[str]:
    """What is said over the preview, a line each."""
    far = f"Compiling the ray tracer: {100.0 * compiling.fraction:.0f} %. " if compiling is not None else ""
    return ["Preview: no shadows, no reflections, no textures", f"{far}Then the picture is traced."]
