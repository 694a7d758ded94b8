"""The window's life, and what happens in each of its frames, in order.

Hello ImGui owns the window, its GL context, the docking and the screen's density.  It calls a frame in three parts:

    before_widgets   newest frame -> state -> queries about the frame -> scheduler (`advance`), then the picture, with
                     all GL work
    widgets          panels (drawn by Hello ImGui from `layout.PANELS`), keys, and what lies over the panels; what the
                     user does there is in the state, and seen in the next frame of the window
    after_widgets    pictures of the window
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import moderngl
from imgui_bundle import glfw_utils, hello_imgui, imgui, immapp

import glfw  # after imgui_bundle, which brings the library that both must share  # isort: skip

from tracer.frame import Frame
from tracer.scene.mesh_options import IN_STUDIO, MeshOptions
from tracer.scene.model import Scene
from viewer.services.controller import Controller
from viewer.state.preferences import config_folder, load_preferences
from viewer.util.messages import failure
from viewer.util.resources import default_scene
from viewer.window import commands, graphics, layout, menus, style
from viewer.window.display import Graphics
from viewer.window.gl_window import NO_OPENGL, closing_by_signals, window_params
from viewer.window.guard import Guard
from viewer.window.layout import Layout
from viewer.window.panels import dialogs, picture, scene, sides, status
from viewer.window.panels.named_states import preset_commands
from viewer.window.ui import CaptureKind, Ui

TITLE = "Shadowcull"
OnFrame = Callable[[Frame], bool | None]
Step = Callable[[str, Callable[[], object]], object]
Runner = Callable[[hello_imgui.RunnerParams, immapp.AddOnsParams], None]
SMALLEST_SIZE = (240, 160)
FASTEST = 60.0  # frames a second of the window's own
# Where a processor draws the window, each frame takes time from tracing: one is drawn for each picture and each of the
# user's doings, up to so many a second, and while something moves not fewer than so many.
FASTEST_BY_PROCESSOR, SLOWEST_BY_PROCESSOR = 30.0, 12.0
IDLE = 8.0  # frames a second while nothing happens
SETTLED = 4  # frames of a new window until it and its panels have taken their places
ACTIVE = 0.25  # seconds after an event until nothing happens
DRAWN_BY_PROCESSOR = ("llvmpipe", "softpipe", "swrast", "software")


def advance(c: Controller, size: tuple[int, int], step: Step = lambda _name, work: work()) -> None:
    """Bring all that has no widgets one frame of the window further, in this order.

    `size` is what there is room for in the picture's window, in pixels (0 if hidden); `step` does a piece of work of
    this name, so that a mistake in one ends no other."""
    # What threads have finished.
    step("Showing a scene that was read", c.take_scene)
    step("Reloading what has changed", lambda: c.loader.reload_changed(c.runs.current is None))
    step("Saving files", c.captures.report_saved)
    step("Quitting once all is saved", c.questions.leave_when_saved)
    step("Taking the newest frame", c.take_frame)
    # The state: time, camera, edits, and the steps of undo.
    step("Moving", c.move)
    step("Noting what can be undone", c.undo.note_changes)
    step("Editing the scene", c.apply_edits)
    step("Comparing", c.comparing.update)
    # The scheduler: queries about the newest frame are answered before the next.
    step("Inspecting the pixel", lambda: c.inspector.update(c.own_traced, not c.motion.is_animating))
    step("Running the paper's text", lambda: c.stepping.update(c.own_traced, not c.motion.is_animating))
    step("Listing the scene", lambda: c.table.update(c.own_traced))
    step("Compiling the method", c.loader.compile_method)
    step("Asking for the next frame", lambda: c.scheduler.request(c.frame_inputs(size)))
    step("Recording the light", c.scheduler.record_light)
    # What the newest frame is kept for.
    step("Selecting where one went", lambda: c.navigator.select_when_shown(c.traced))
    step("Measuring speed", c.measure)
    step("Saving preferences", lambda: c.settings.save_changes(c.motion.is_animating))


class App:
    """The window's life: made, run once, closed."""

    def __init__(
        self, scene_path: Path | None, settings: dict[str, Any] | None = None, folders: Sequence[Path] = (),
        meshes: MeshOptions = IN_STUDIO, scene: Scene | None = None, on_frame: OnFrame | None = None,
    ) -> None:  # fmt: skip
        """A window on a scene or a saved picture; without one on what was open last, where that is wanted, else on the
        embedded room.

        `settings` are fields of `tracer.Settings` that win over what is opened first; scenes may read files from
        `folders` besides their own; `meshes` says how meshes are read.  A `scene` takes the place of a path; `on_frame`
        is told of each whole picture."""
        style.forget()
        preferences, problem = load_preferences()
        self.controller = Controller(preferences)
        self.ui = Ui(self.controller)
        self.ui.guard = Guard(self.controller.notices, lambda name, fault: status.instead_of_part(self.ui, name, fault))
        self.ui.take_commands(commands.build(self.ui))
        self.ui.exit = lambda: self.controller.questions.before_quitting(lambda: self._exit())
        self._on_frame = on_frame
        self._told: Frame | None = None  # what the script has seen
        self.params = self._params()
        self.layout = Layout(self.ui, self.params)
        self._frame_began = time.perf_counter()
        self._capture_this_frame = False
        self._dropped_files: list[Path] = []
        self.drawn_by_processor = self.iconified = self.was_open = False
        self._room = (0, 0)
        if preferences.tour:
            preferences.tour = False  # on the first start only; the menu Help has it again
            self.ui.tour.start()
        if problem:
            self.controller.notices.say(problem, error=True)
        loader = self.controller.loader

        def open_first() -> None:
            loader.start(settings or {}, folders, meshes)
            if scene is not None:
                loader.take(scene)
            else:
                loader.open(scene_path or default_scene())

        self._open_first = open_first

    def run(self, runner: Runner = immapp.run) -> int:
        """Open the window and stay until it is closed; returns the exit code.  Raises OSError, in one line, where the
        display has no OpenGL for it."""
        hook, threading.excepthook = threading.excepthook, self._thread_failed
        try:
            with closing_by_signals(self._exit):
                runner(self.params, immapp.AddOnsParams(with_implot=True))
        except RuntimeError as error:
            if self.was_open:
                raise
            raise OSError(NO_OPENGL) from error
        finally:
            threading.excepthook = hook
            self.controller.close()
        return 0

    def _thread_failed(self, of: threading.ExceptHookArgs) -> None:
        """A thread ended by an exception that nobody caught."""
        if of.exc_value is not None:
            name = of.thread.name if of.thread is not None else "a thread"
            self.controller.notices.report(failure(of.exc_value, f"{name} failed", known=()))

    # --- one frame -------------------------------------------------------------------------------

    def before_widgets(self) -> None:
        """Take the newest frame, bring the state forward, ask for the next frame, and draw the picture."""
        self._frame_began = time.perf_counter()
        ui, step = self.ui, self.ui.guard.step
        step("Setting the theme", self._set_theme)
        step("Full screen", ui.full_screen.apply)
        step("Opening dropped files", self._open_dropped)
        advance(self.controller, self._room_for_picture(), step)
        step("The script's function", self._call_script)
        step("Drawing the picture", lambda: graphics.draw(ui))
        step("Drawing recorded pictures", ui.graphics.textures.update)
        step("Saving the picture", self._capture_picture)
        self._set_frame_rate()

    def widgets(self) -> None:
        """Draw what is no docked panel, and read the keys."""
        ui, step = self.ui, self.ui.guard.step
        style.fill_windows(True)
        step("The layout", self.layout.update)
        step("Reading the keys", lambda: menus.handle_keys(ui))
        step("Flying", lambda: picture.fly(ui))
        step("Comparing", lambda: sides.read_key(ui))
        dialogs.show(ui)
        step("The tour", ui.tour.update)
        step("A figure of the paper", ui.figures.update)

    def after_widgets(self) -> None:
        """Finish a frame that is drawn but not yet shown."""
        self.ui.guard.step("Saving the window", self._capture_window)
        self.controller.undo.held = imgui.is_any_item_active()
        self.controller.drawn_seconds = time.perf_counter() - self._frame_began

    # --- its steps --------------------------------------------------------------------------------

    def _set_theme(self) -> None:
        p = self.controller.preferences
        if style.update(p.theme, p.ui_scale):
            self.params.imgui_window_params.background_color = style.BACKGROUND
        style.fill_windows(False)  # not the one that panels are docked in, which begins before `widgets`

    def _open_dropped(self) -> None:
        dropped, self._dropped_files = self._dropped_files, []
        if len(dropped) > 1:
            self.controller.notices.say(f"{len(dropped)} files were dropped; only {dropped[0].name} is opened")
        if dropped:
            self.controller.loader.open(dropped[0])

    def _room_for_picture(self) -> tuple[int, int]:
        size = imgui.get_io().display_size
        if self.iconified or min(size.x, size.y) < 1:
            return 0, 0
        if imgui.get_frame_count() >= SETTLED:
            self._room = self.ui.picture.area
        return self._room

    def _call_script(self) -> None:
        """Hand a whole picture to the script that opened the window, once; it closes the window by returning False."""
        traced = self.controller.traced
        if self._on_frame is None or traced is None or not traced.whole or traced.frame is self._told:
            return
        self._told = traced.frame
        if self._on_frame(traced.frame) is False:
            self._exit()

    def _capture_picture(self) -> None:
        graphics.capture(self.ui)
        if self.ui.capture_wanted is CaptureKind.WINDOW:
            self.ui.capture_wanted = None
            self._capture_this_frame = True  # when it is drawn, from here on, with all that was asked for before

    def _capture_window(self) -> None:
        if self._capture_this_frame:
            self._capture_this_frame = False
            size = glfw.get_framebuffer_size(glfw_utils.glfw_window_hello_imgui())
            self.controller.captures.capture(self.controller.frame, self.ui.graphics.display.read_window(*size))

    def _set_frame_rate(self) -> None:
        """Doze but when something moves: whatever comes from a thread wakes the window, and it needs the processor."""
        idling = self.params.fps_idling
        is_animating = self.controller.motion.is_animating
        by_processor = is_animating and self.drawn_by_processor
        idling.enable_idling = by_processor or not is_animating
        idling.fps_idle = SLOWEST_BY_PROCESSOR if by_processor else IDLE
        idling.time_active_after_last_event = 0.0 if by_processor else ACTIVE

    # --- the window ------------------------------------------------------------------------------

    def _params(self) -> hello_imgui.RunnerParams:
        params = window_params(TITLE, layout.ready_file(config_folder()))
        params.imgui_window_params.background_color = style.BACKGROUND
        params.fps_idling.fps_max = FASTEST
        call = params.callbacks
        call.load_additional_fonts = style.load_fonts
        call.post_init = self._ready
        call.show_menus = lambda: self.ui.guard.panel("The menus", self._menus)
        call.show_status = lambda: self.ui.guard.panel("The status bar", lambda: status.show(self.ui))
        call.pre_new_frame = self.before_widgets
        call.show_gui = self.widgets
        call.before_swap = self.after_widgets
        call.before_exit = self._leave
        return params

    def _menus(self) -> None:
        menus.show(self.ui, lambda: [*scene.commands(self.ui), *self.ui.commands, *preset_commands(self.ui)])
        self.layout.show_menu()
        self.layout.show_workspaces()

    def _ready(self) -> None:
        """The window and its GL context exist."""
        self.was_open = True
        self.ui.graphics = Graphics(moderngl.create_context())
        self.drawn_by_processor = any(name in self.ui.graphics.renderer_name.lower() for name in DRAWN_BY_PROCESSOR)
        if self.drawn_by_processor:
            self.params.fps_idling.fps_max = FASTEST_BY_PROCESSOR
        self.controller.wake.connect(hello_imgui.request_refresh)
        window = glfw_utils.glfw_window_hello_imgui()
        # While a window of few pixels grows, ImGui can take its growth for density, and has no room for such letters.
        glfw.set_window_size_limits(window, *SMALLEST_SIZE, glfw.DONT_CARE, glfw.DONT_CARE)
        glfw.set_window_close_callback(window, self._close_wanted)
        glfw.set_window_iconify_callback(window, self._iconify)  # to ask in each frame would take a millisecond
        glfw.set_drop_callback(window, self._dropped)  # type: ignore[arg-type]  # it gets a list
        self._open_first()

    def _close_wanted(self, window: Any) -> None:
        """The window's close button, or the desktop: the same as the command."""
        glfw.set_window_should_close(window, False)
        self.ui.guard.step("Quitting", self.ui.exit)

    def _iconify(self, _window: Any, iconified: int) -> None:
        self.iconified = bool(iconified)

    def _dropped(self, _window: Any, paths: list[str]) -> None:
        self._dropped_files = [Path(p) for p in paths]
        hello_imgui.request_refresh()

    def _leave(self) -> None:
        self.controller.wake.connect(None)  # threads may still be at work when the window is gone
        del self.ui.graphics  # all of it goes with the context

    def _exit(self) -> None:
        self.params.app_shall_exit = True
