"""`shadowcull`: the window by default, and the commands that need none.

    shadowcull [SCENE]          the viewer
    shadowcull render SCENE     one frame into files
    shadowcull film SCENE       a path, or a flight, into pictures and a video
    shadowcull bench SCENE      the paper's table over a path of frames
    shadowcull sweep STUDY      many scenes, methods and settings, by several processes
    shadowcull zoom SCENE       towards a primitive, and whether its shadows keep up
    shadowcull explain SCENE    what became of the rays of one pixel
    shadowcull hunt SCENE       the worst wrong pixels of a method
    shadowcull cube SCENE       what a light sees in each direction, as a picture
    shadowcull figure SCENE     a frame by several methods, side by side
    shadowcull check FILE       whether saved pictures and figures are still true
    shadowcull info SCENE       what a scene holds

The exit code is 0 only on success; every error is one line on standard error.  What needs GL is
imported only to open the window.
"""

from __future__ import annotations

import os
import sys
from argparse import Namespace
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tracer.similar import did_you_mean
from viewer.cli import hunt_parser, parsers, picture_parsers, sweep_parser
from viewer.cli.mesh_arguments import mesh_options
from viewer.cli.parser import MISUSED, Parser
from viewer.util import resources
from viewer.util.messages import ERROR, say
from viewer.util.screen import has_display, no_display_reason

if TYPE_CHECKING:
    from tracer.scene.mesh_options import MeshOptions

OpenWindow = Callable[[Path | None, dict[str, Any], Sequence[Path], "MeshOptions"], int]
"""Opens the viewer on a scene or a saved picture, with some settings, folders that scenes may read files from, and how
meshes are read; returns the exit code, or raises OSError in one line."""

FAILED, INTERRUPTED = 1, 130


def main(arguments: Sequence[str], open_window: OpenWindow) -> int:
    """Run a command line; returns the exit code."""
    arguments = list(arguments)
    commands: dict[str, Callable[[list[str]], int]] = {
        "render": _render,
        "bench": _bench,
        "zoom": _zoom,
        "explain": _explain,
        "info": _info,
        "film": _film,
        "figure": _figure,
        "check": _check,
        "hunt": _hunt,
        "sweep": _sweep,
        "cube": _cube,
    }
    try:
        if arguments and arguments[0] in commands:
            return commands[arguments[0]](arguments[1:])
        return _view(arguments, list(commands), open_window)
    except KeyboardInterrupt:
        say("cancelled")
        return INTERRUPTED
    except BrokenPipeError:
        # Whoever read our output has gone (`| head`): no error, but nothing may be flushed to it at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    except Exception as error:
        return _failed(error)


def _failed(error: Exception) -> int:
    """Say what went wrong; a mistake of the program's own can be asked for its traceback."""
    from tracer.scene.model import Cancelled, SceneError

    if isinstance(error, Cancelled):
        say("cancelled")
        return INTERRUPTED
    if isinstance(error, MemoryError):
        why = f": {error}" if str(error) else ""
        say(f"out of memory{why}; a simpler scene or a smaller --size needs less", ERROR)
    elif isinstance(error, SceneError | ValueError | OSError) and str(error):
        say(error, ERROR)
    else:
        say(f"{type(error).__name__}: {error} (a bug in the program; SHADOWCULL_DEBUG=1 shows where)", ERROR)
    if os.environ.get("SHADOWCULL_DEBUG"):
        raise error
    return FAILED


def _view(arguments: list[str], commands: list[str], open_window: OpenWindow) -> int:
    """Open the window, or say why not."""
    parser = parsers.viewer()
    if arguments and not arguments[0].startswith("-"):
        _check_is_scene(parser, arguments[0], commands)
    options = parser.parse_args(arguments)
    if not has_display():
        if options.or_picture:
            return _picture_instead(options)
        named = options.scene or resources.DEFAULT_SCENE
        say(f"{no_display_reason()}; without one, use: shadowcull render {named} -o out.png")
        return MISUSED
    lamps = {name: getattr(options, name) for name in ("lamp_radius", "lamp_samples")}
    settings = {name: value for name, value in lamps.items() if value is not None}
    scene = resources.scene_path(options.scene) if options.scene is not None else None
    return open_window(scene, settings, options.folder, mesh_options(options))


def _check_is_scene(parser: Parser, name: str, commands: list[str]) -> None:
    """A word that is no file may be a command mistyped: better said now than as an error about a missing file."""
    if name in resources.embedded_scenes() or Path(name).exists() or Path(name).suffix:
        return
    hint = did_you_mean(name, [*commands, *resources.embedded_scenes()]) or f": the commands are {', '.join(commands)}"
    parser.error(f"{name!r} is not a command, a file or a scene that comes with the program{hint}")


def _picture_instead(options: Namespace) -> int:
    """Without a display, `make run` still does the main job: it shows what culling saves, stage by stage."""
    say(f"{no_display_reason()}; rendering to files instead")

    from viewer.cli import first_light, saved_pictures

    path = resources.scene_path(options.scene or resources.DEFAULT_SCENE)
    if saved_pictures.is_capture(path):
        return _render([str(options.scene)])
    first_light.show(path, options)
    return 0


def _render(arguments: list[str]) -> int:
    parser = picture_parsers.render()
    options = parser.parse_args(arguments)

    from viewer.cli import render, saved_pictures

    path = resources.scene_path(options.scene)
    if saved_pictures.is_capture(path):
        picture = path
        path, kept = saved_pictures.defaults(picture)
        parser.set_defaults(**kept)
        options = parser.parse_args(arguments)
        saved_pictures.settle(options, kept)
        saved_pictures.name_output(options, picture)
    options.camera = saved_pictures.camera(options.camera)
    render.render(path, options)
    return 0


def _film(arguments: list[str]) -> int:
    path, options = _with_saved(picture_parsers.film(), arguments)

    from viewer.cli import film

    return 0 if film.film(path, options) else INTERRUPTED


def _figure(arguments: list[str]) -> int:
    path, options = _with_saved(picture_parsers.figure(), arguments)

    from viewer.cli import figure

    figure.figure(path, options)
    return 0


def _with_saved(parser: Parser, arguments: list[str]) -> tuple[Path, Namespace]:
    """The scene and the options, which begin with those of a saved picture if that stands for a scene."""
    options = parser.parse_args(arguments)

    from viewer.cli import saved_pictures

    path = resources.scene_path(options.scene)
    if saved_pictures.is_capture(path):
        path, kept = saved_pictures.defaults(path)
        parser.set_defaults(**kept)
        options = parser.parse_args(arguments)
        saved_pictures.settle(options, kept)
    options.camera = saved_pictures.camera(options.camera)
    return path, options


def _check(arguments: list[str]) -> int:
    options = picture_parsers.check().parse_args(arguments)

    from viewer.cli import check

    return 0 if check.check(options) else FAILED


def _bench(arguments: list[str]) -> int:
    options = parsers.bench().parse_args(arguments)

    from viewer.cli import bench

    return 0 if bench.bench(resources.scene_path(options.scene), options) else INTERRUPTED


def _sweep(arguments: list[str]) -> int:
    options = sweep_parser.sweep().parse_args(arguments)

    from viewer.cli import sweep

    return 0 if sweep.sweep(options.study, options) else INTERRUPTED


def _zoom(arguments: list[str]) -> int:
    options = parsers.zoom().parse_args(arguments)

    from viewer.cli import saved_pictures, zoom

    options.camera = saved_pictures.camera(options.camera)
    return 0 if zoom.run(resources.scene_path(options.scene), options) else INTERRUPTED


def _explain(arguments: list[str]) -> int:
    options = parsers.explain().parse_args(arguments)

    from viewer.cli import explain, saved_pictures

    options.camera = saved_pictures.camera(options.camera)
    explain.explain(resources.scene_path(options.scene), options)
    return 0


def _cube(arguments: list[str]) -> int:
    options = parsers.cube().parse_args(arguments)

    from viewer.cli import cube

    cube.cube(resources.scene_path(options.scene), options)
    return 0


def _hunt(arguments: list[str]) -> int:
    options = hunt_parser.hunt().parse_args(arguments)

    from viewer.cli import hunt, saved_pictures

    options.camera = saved_pictures.camera(options.camera)
    return 0 if hunt.run(resources.scene_path(options.scene), options) else INTERRUPTED


def _info(arguments: list[str]) -> int:
    options = parsers.info().parse_args(arguments)

    from viewer.cli import info, saved_pictures

    path = resources.scene_path(options.scene)
    info.info(
        saved_pictures.defaults(path)[0] if saved_pictures.is_capture(path) else path, options.json, options.folder
    )
    return 0
