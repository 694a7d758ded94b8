"""Runs scenarios in the real window, one after another, each in a window of its own.

    python -m tests.viewer.real_window

Reads lines of JSON, `{"name", "size", "scene", "folder", "settings"}`, and answers each by a line with the scenario's
exit code.  ImGui's test engine drives the keyboard and the pointer; a scenario is a function of a `Driver` in
`tests.viewer.scenarios`.  One process opens many windows, as most of the time that a window takes goes into starting
Python, loading kernels and compiling shaders.  What is said meanwhile goes to standard error."""

from __future__ import annotations

import ctypes
import gc
import json
import os
import sys
import traceback
from contextlib import nullcontext
from pathlib import Path

from imgui_bundle import hello_imgui, imgui, immapp
from imgui_bundle.immapp import testing
from PIL import Image

from tests.viewer.driver import PATIENCE, SMALL, Driver
from tests.viewer.scenarios import SCENARIOS
from tests.viewer.scenarios.starting import first_start
from viewer.services import beside, refinement
from viewer.state.savings import LEAST
from viewer.window import gl_window
from viewer.window.app import App

# There what culling saves is told above the picture, for which methods are timed after each picture.
MEASURING = ("fitting", "panels", "savings")
# There pictures have the size of the room that the window has for them; elsewhere they are small.
FILLING = ("capturing", "experimenting", "figures", "fitting", "flying", "hiding", "resizing", "touring")
SIZE = (320, 200)
# There the window is small, as nothing is asked of its layout: what fills it is soon traced.
IN_SMALL = ("at_home", "capturing", "closeup", "comparing", "experimenting", "figures", "flying", "navigating",
            "resizing", "touring")  # fmt: skip
DOZING = ("explaining",)  # there the window rests when nothing moves: what threads find out must wake it


def run(name: str, size: list[int], scene: str, folder: str) -> int:
    """The exit code of the window that the scenario was played in."""
    gl_window.first_size = lambda: SMALL if name in IN_SMALL else tuple(size)
    app = App(Path(scene))
    if name != "touring":
        app.ui.tour.end()  # it comes by itself on the first start
    app.controller.preferences.screenshot_folder = str(Path(folder) / "pictures")
    app.controller.session.set_pace(progressive=True, fixed_size=name not in FILLING, width=SIZE[0], height=SIZE[1])
    app.controller.preferences.savings = name in MEASURING
    app.controller.settings.change(samples=1)  # else idle pictures go on changing
    failed: list[BaseException] = []
    played = False

    def test(context) -> None:
        nonlocal played
        engine = imgui.test_engine.get_io(hello_imgui.get_imgui_test_engine())
        engine.config_watchdog_warning = engine.config_watchdog_kill_test = 2.0 * PATIENCE
        driver = Driver(app, context, Path(folder), dozes=name in DOZING)
        try:
            played = True
            if name != "starting":
                driver.settle()
            SCENARIOS[name](driver)
        except BaseException as error:
            failed.append(error)
            traceback.print_exc()
            seen = Path(folder) / "failed.png"
            print(f"the window is shown in {seen}", file=sys.stderr)
            Image.fromarray(driver.window()).save(seen)

    def runner(params, add_ons: immapp.AddOnsParams) -> None:
        # The scenario says itself what went wrong; the engine only notices that a window closed meanwhile.
        testing.run(test_function=test, runner_params=params, add_ons_params=add_ons, raise_on_error=False)

    with first_start() if name == "starting" else nullcontext():
        code = app.run(runner)
    if not played:
        failed.append(AssertionError("no window came"))
        print("no window came", file=sys.stderr)
    stuck = app.controller.renderer._thread.is_alive()
    if stuck:
        print("the render thread outlived the window", file=sys.stderr)
    return 1 if failed or stuck else code


def main() -> None:
    gc.freeze()  # what is imported lives to the end
    refinement.MOST_FRAMES = 4  # at idle with certificates: more of them show nothing that these do not
    beside.MOST_ROUNDS = LEAST  # as soon as anything is told, the comparison ends
    with os.fdopen(os.dup(1), "w") as answers:
        os.dup2(2, 1)  # what ImGui prints is no answer
        for line in sys.stdin:
            asked = json.loads(line)
            os.environ["SHADOWCULL_CONFIG_DIR"] = asked.pop("settings")
            code = run(**asked)
            sys.stderr.flush()
            ctypes.CDLL(None).fflush(None)
            print(code, file=answers, flush=True)


if __name__ == "__main__":
    main()
