"""Steps that scenarios of several subjects take."""

from __future__ import annotations

from pathlib import Path

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons
from PIL import Image

from tests.viewer.driver import Driver
from viewer.util.resources import embedded_scenes

KEY = imgui.Key


def figure4(d: Driver, frame: int) -> None:
    """The paper's Figure 4 up to a frame, as it is described there: 128 x 128 pixels, frame by frame."""
    p = d.c.preferences
    d.c.session.set_pace(progressive=False, fixed_size=True, width=128, height=128, every_frame=False)
    p.loop = False
    d.c.settings.change(method="paper")
    d.drop(embedded_scenes()["figure4"])
    d.wait(lambda: d.c.session.scene.path.name == "figure4.aff", "the scene of Figure 4")
    d.settle()

    def traced() -> bool:
        return not d.c.active and d.c.traced.whole and d.c.frame.time == d.c.session.time

    for number in range(1, frame + 1):
        d.press(KEY.right_arrow)
        assert d.c.session.frame == number
        d.wait(traced, f"frame {number}")
    d.settle()


def saved_results(d: Driver, panel: str) -> dict[str, Path]:
    """Save results by the panel's buttons; the files by their endings."""
    folder = d.folder / "pictures"
    before = set(folder.glob("*"))
    d.scroll_down(panel)
    for kind in ("JSON", "CSV", "Plot"):
        d.click(f"//{panel}/**/{icons.ICON_FA_FLOPPY_DISK} {kind}")
    d.wait(lambda: not d.c.captures.busy, "the files to be written")
    d.frames(2)
    assert not d.c.notices.message.error, d.said
    files = {path.suffix: path for path in set(folder.glob("*")) - before}
    assert set(files) == {".json", ".csv", ".png"}
    with Image.open(files[".png"]) as plot:
        assert plot.size == (1920, 1080)
    return files
