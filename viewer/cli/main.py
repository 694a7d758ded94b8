"""`shadowcull`: the window by default, and the commands that need none, each in the file of its name.

A command's file has a `parser`, and `run`, which returns an exit code.  That is 0 only on success; every error is one
line on standard error.  What needs GL is imported only to open the window, and a command only to run it.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tracer.scene.model import Cancelled
from tracer.util.suggest import did_you_mean
from tracer.util.version import program_version
from viewer.cli.arguments import FAILED, INTERRUPTED, MISUSED, Parser
from viewer.util import resources
from viewer.util.messages import ERROR, failure, say
from viewer.util.screen import has_display, no_display_reason

if TYPE_CHECKING:
    from tracer.scene.mesh_options import MeshOptions

OpenWindow = Callable[[Path | None, dict[str, Any], Sequence[Path], "MeshOptions"], int]
"""Opens the viewer on a scene or a saved picture, with some settings, folders that scenes may read files from, and how
meshes are read; returns the exit code, or raises OSError in one line."""

COMMANDS = {
    "render": ("SCENE", "trace one frame into a picture, its buffers, or both; needs no display"),
    "film": ("SCENE", "trace a path, or a flight through bookmarks, into pictures and a video"),
    "bench": ("SCENE", "measure, over a path of frames, what culling saves"),
    "sweep": ("STUDY", "measure many scenes, methods and settings by several processes, or machines"),
    "zoom": ("SCENE", "move towards a primitive, and see whether its shadows stay right"),
    "explain": ("SCENE", "say what became of each ray of one pixel"),
    "hunt": ("SCENE", "search a path for the worst wrong pixels of a method"),
    "shrink": ("SCENE", "reduce a wrong pixel to the few triangles, lights and frames that it takes"),
    "grade": ("METHOD", "say whether a method is right, what it costs, and what it learns wrongly"),
    "figure": ("SCENE", "draw a frame by several methods side by side"),
    "check": ("FILE", "render saved pictures and figures again, and say whether they are still true"),
    "prove": ("SCENE", "write what is certified of a frame as proofs that anybody can check"),
    "check-proofs": ("FILE", "check such proofs in exact arithmetic"),
    "info": ("SCENE", "say what a scene holds"),
}
_EXAMPLES = """
examples:
  shadowcull
  shadowcull kitchen.aff --lamp-radius 0.1
  shadowcull render kitchen.aff -o kitchen.png --frame 50 --warmup 10 --view occlusion
  shadowcull info kitchen.aff --json

Each command has its own --help.
"""


def main(arguments: Sequence[str], open_window: OpenWindow) -> int:
    """Run a command line; returns the exit code."""
    arguments = list(arguments)
    try:
        if arguments and arguments[0] in COMMANDS:
            return _run(arguments[0], arguments[1:])
        return _view(arguments, open_window)
    except (KeyboardInterrupt, Cancelled):
        say("cancelled")
        return INTERRUPTED
    except BrokenPipeError:  # whoever read our output has gone (`| head`): no error
        _flush_nothing_more()
        return FAILED
    except Exception as error:
        if isinstance(error, OSError):  # of the output, perhaps: its disk is full
            _flush_nothing_more()
        return _failed(error)


def _flush_nothing_more() -> None:
    """Let an output that takes nothing not be tried again at exit, which would be said and change the exit code."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _run(name: str, arguments: list[str]) -> int:
    command = import_module(f"viewer.cli.{name.replace('-', '_')}")
    parser: Parser = command.parser()
    options = parser.parse_args(arguments)
    if "line" in options:
        options.line = arguments
    if "scene" in options:
        options.path = resources.scene_path(options.scene)
    if "view" in options:
        from viewer.cli import pictures

        options = pictures.filled_in(parser, options, arguments)
    return int(command.run(options))


def _failed(error: Exception) -> int:
    """Say what went wrong; a bug of the program's own can be asked for its traceback."""
    found = failure(error)
    if isinstance(error, MemoryError):
        say(f"{found.text}; a simpler scene or a smaller --size needs less", ERROR)
    else:
        say(found.text if found.expected else f"{found.text} (a bug; SHADOWCULL_DEBUG=1 shows where)", ERROR)
    if os.environ.get("SHADOWCULL_DEBUG"):
        raise error
    return FAILED


def _view(arguments: list[str], open_window: OpenWindow) -> int:
    """Open the window, or say why not."""
    parser = viewer_parser()
    if arguments and not arguments[0].startswith("-"):
        _check_is_scene(parser, arguments[0])
    options = parser.parse_args(arguments)
    if not has_display():
        named = options.scene or resources.DEFAULT_SCENE
        say(f"{no_display_reason()}; without one, use: shadowcull render {named} -o out.png")
        return MISUSED

    from viewer.cli.options import mesh_options

    lamps = {name: getattr(options, name) for name in ("lamp_radius", "lamp_samples")}
    settings = {name: value for name, value in lamps.items() if value is not None}
    scene = resources.scene_path(options.scene) if options.scene is not None else None
    return open_window(scene, settings, options.folder, mesh_options(options))


def viewer_parser() -> Parser:
    """Make the parser of the command that opens the window."""
    from tracer.settings import Settings
    from viewer.cli.options import add_meshes, add_scene, add_settings

    lines = [("[SCENE]", "open the viewer")]
    lines += [(f"{name} {what}", summary) for name, (what, summary) in COMMANDS.items()]
    commands = "commands:\n" + "".join(f"  shadowcull {words:13} {summary}\n" for words, summary in lines)
    parser = Parser("", "An interactive ray tracer that shows shadow culling at work.", commands + _EXAMPLES)
    add_scene(parser)
    add_settings(parser, Settings, "lamp_radius", "lamp_samples")
    add_meshes(parser)
    parser.add_argument("--version", action="version", version=f"shadowcull {program_version()}")
    return parser


def _check_is_scene(parser: Parser, name: str) -> None:
    """A word that is no file may be a command mistyped: better said now than as an error about a missing file."""
    if name in resources.embedded_scenes() or Path(name).exists() or Path(name).suffix:
        return
    hint = did_you_mean(name, [*COMMANDS, *resources.embedded_scenes()]) or f": the commands are {', '.join(COMMANDS)}"
    parser.error(f"{name!r} is not a command, a file or a scene that comes with the program{hint}")
