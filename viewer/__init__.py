"""The viewer: everything a person touches, over the `tracer`; `show` opens its window from scripts and notebooks, and
`explore` makes a page of a frame.

    cli | window     the command line; the window, which alone knows GL and widgets
    services         threads, files, runs, and the controller that wires them
    output           pictures, figures, legends, reports
    state            what the user looks at and has chosen
    util             files, messages, numbers

Each knows only what is below it.  `viewer.__main__` starts the command line, and hands it the window to open."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tracer.frame import Frame
    from tracer.scene.model import Scene
    from viewer.output.explorable import Page


__all__ = ["explore", "load_ipython_extension", "show"]


def show(
    scene: Scene | str | Path, on_frame: Callable[[Frame], bool | None] | None = None, **settings: Any
) -> Frame | None:
    """Open the viewer on a scene, and wait until it is closed.

    Parameters
    ----------
    scene : Scene, str or Path
        What to show: a scene that was loaded or made, a file, or the name of a scene that comes with the program.
    on_frame : callable, optional
        Called with each whole `Frame` that the window shows. It runs between two frames of the window, which waits for
        it. If it returns False, the window is closed. If it raises an exception, the window says so and goes on.
    **settings
        Fields of `tracer.Settings` to begin with, such as `method="certified"`. The size is the window's.

    Returns
    -------
    Frame or None
        The last frame that was shown, or None if there was none.

    Raises
    ------
    ValueError
        If a setting is out of range.
    OSError
        If there is no display, or if a library that the window needs is missing.
    """
    # Here, so that commands that need none of it start quickly.
    from tracer.scene.model import Scene
    from tracer.settings import Settings
    from viewer.util import resources
    from viewer.util.screen import has_display, no_display_reason

    Settings(**settings).validated()
    if not has_display():
        raise OSError(f"{no_display_reason()}; tracer.Renderer needs none")
    own = isinstance(scene, Scene)
    path = None if own else resources.scene_path(str(scene))
    opened = window_module().App(path, settings, scene=scene if own else None, on_frame=on_frame)  # type: ignore[arg-type]
    opened.ui.tour.end()
    opened.run()
    return opened.controller.frame


def explore(frame: Frame, scene: Scene | None = None) -> Page:
    """Return a page in which a reader clicks pixels of a frame for all that the frame has recorded of them.

    A notebook shows the page; `explore(frame).html` is the text of an HTML file that fetches nothing.

    Parameters
    ----------
    frame : Frame
        What has been rendered. `record_fates`, `record_work` and `verify` in its settings bring views of their own.
    scene : Scene, optional
        Its scene, from which lights and primitives have their names.

    Raises
    ------
    ValueError
        If the picture is too large for a page.
    """
    from viewer.output.explorable import page_of_frame

    return page_of_frame(frame, scene)


def load_ipython_extension(ipython: Any) -> None:
    """Let every frame show itself by its page: `%load_ext viewer` in a notebook."""
    from tracer.frame import Frame
    from viewer.output.explorable import MOST_PIXELS, page_of_frame

    def shown(frame: Frame) -> str:
        return (page_of_frame(frame) if frame.primitive.size <= MOST_PIXELS else frame)._repr_html_()

    ipython.display_formatter.formatters["text/html"].for_type(Frame, shown)


def window_module() -> Any:
    """Return `viewer.window.app`, which needs GL and ImGui; raises OSError, in one line, where a library is missing."""
    try:
        from viewer.window import app
    except ImportError as error:
        raise OSError(
            f"no window can be opened, as a library is missing ({error}); 'shadowcull render' needs none"
        ) from error
    return app
