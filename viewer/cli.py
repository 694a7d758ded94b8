"""`shadowcull`: the window by default, and the commands that need none.

    shadowcull [SCENE]          the viewer
    shadowcull render SCENE     one frame into files
    shadowcull bench SCENE      the paper's table over a path of frames
    shadowcull info SCENE       what a scene holds

The exit code is 0 only on success; every error is one line on standard error.  What needs GL is
imported only to open the window.
"""

from __future__ import annotations

import argparse
import difflib
import os
import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NoReturn

from viewer import resources
from viewer.screen import has_display, no_display_reason

FAILED, MISUSED, INTERRUPTED = 1, 2, 130
PICTURE = Path("out") / "first-light.png"
_VIEW_NAMES = {"colour": "color", "primitives": "primitive", "normals": "normal", "count": "pixel-count"}

_EXAMPLES = """\
commands:
  shadowcull [SCENE]       open the viewer
  shadowcull render SCENE  trace one frame into a picture, its buffers, or both; needs no display
  shadowcull bench SCENE   measure, over a path of frames, what culling saves
  shadowcull info SCENE    say what a scene holds

examples:
  shadowcull
  shadowcull kitchen.aff
  shadowcull render kitchen.aff -o kitchen.png --frame 50 --warmup 10 --view occlusion
  shadowcull info kitchen.aff --json

Each command has its own --help.
"""

_RENDER_EXAMPLES = """\
examples:
  shadowcull render -o room.png
  shadowcull render kitchen.aff -o kitchen.png --size 1024x768 --samples 16
  shadowcull render kitchen.aff -o modes.png --frame 50 --warmup 20 --view shadow:2
  shadowcull render kitchen.aff -o wrong.png --frame 50 --warmup 20 --view difference
  shadowcull render Robot.aff --frame 10 --warmup 10 --buffers robot.npz
  shadowcull render bunny.ply -o bunny.png --camera '{"position": [0, 1, 3], "direction": [0, 0, -1], "angle": 40}'

The modes of primitives are learnt from frame to frame, so that culling acts only after some frames:
--warmup N traces the N frames before the one that is wanted first.

The .npz holds color (H,W,3 float32), depth (H,W float32, distance along the unit ray, inf for a miss),
primitive and cell (H,W int32, -1 for a miss), occlusion_mode (H,W uint8, 255 for a miss), shadow_mode
(H,W,lights uint8), and for each light and primary hit lit and due (H,W,lights bool); with --verify also
reference (H,W,3 float32), the colour with every shadow answer right, and wrong (H,W int32), the number of
wrong shadow answers of each pixel.

--view difference and --view wipe verify by themselves: the first shows the pixels with wrong shadow answers,
the second the picture left of a line and what it should be right of it; wipe:0.3 puts the line at 30 % of
the width.
"""

_BENCH_EXAMPLES = """\
examples:
  shadowcull bench kitchen.aff --path-frames 100
  shadowcull bench Robot.aff --frames 100:200 --size 256x256 --verify
  shadowcull bench default --methods none,paper --symmetric --json default.json --csv default.csv
  shadowcull bench kitchen.aff --path-frames 100 --verify --plot kitchen.svg

Savings are those of shadow rays against the method none, averaged over frames, as in the paper's
Table 1. Ctrl-C ends the run and keeps the frames that are done: the table and the files are of these,
and the exit code is 130; a second one ends it at once.

The JSON holds scene, size, frames, and for each method a list with an entry per frame of each figure;
the CSV is the table. The plot shows what is saved frame by frame, with the average and the most, and
with --verify the wrong answers.
"""

_INFO_EXAMPLES = """\
examples:
  shadowcull info kitchen.aff
  shadowcull info default --json
"""


class _Parser(argparse.ArgumentParser):
    """Errors in one line, which names where help is."""

    def error(self, message: str) -> NoReturn:
        complain(f"{message} (see '{self.prog} --help')")
        sys.exit(MISUSED)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line; returns the exit code."""
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    commands: dict[str, Callable[[list[str]], int]] = {"render": _render, "bench": _bench, "info": _info}
    try:
        if arguments and arguments[0] in commands:
            return commands[arguments[0]](arguments[1:])
        return _view(arguments, list(commands))
    except KeyboardInterrupt:
        complain("cancelled", kind="")
        return INTERRUPTED
    except BrokenPipeError:
        # Whoever read our output has gone (`| head`): no error, but nothing may be flushed to it at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    except Exception as error:
        return _failed(error)


def complain(message: object, kind: str = "error: ") -> None:
    """One line on standard error."""
    print(f"shadowcull: {kind}{' '.join(str(message).split())}", file=sys.stderr, flush=True)


def _failed(error: Exception) -> int:
    """Say what went wrong; a mistake of the program's own can be asked for its traceback."""
    from tracer.scene.model import Cancelled, SceneError

    if isinstance(error, Cancelled):
        complain("cancelled", kind="")
        return INTERRUPTED
    if isinstance(error, MemoryError):
        complain("out of memory; a smaller --size needs less")
    elif isinstance(error, SceneError | ValueError | OSError) and str(error):
        complain(error)
    else:
        complain(f"{type(error).__name__}: {error} (a fault of the program; SHADOWCULL_DEBUG=1 shows where)")
    if os.environ.get("SHADOWCULL_DEBUG"):
        raise error
    return FAILED


def scene_path(name: str | None) -> Path:
    """The file that SCENE means: a path, the name of a scene that comes with the program, or the default one."""
    embedded = resources.embedded_scenes()
    if name is None:
        return resources.default_scene()
    return embedded.get(name) or Path(name)


def _view(arguments: list[str], commands: list[str]) -> int:
    """Open the window, or say why not."""
    parser = _Parser(
        prog="shadowcull",
        description="An interactive ray tracer that shows shadow culling at work.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("scene", nargs="?", metavar="SCENE", help=_scene_help())
    parser.add_argument("--version", action="version", version=f"shadowcull {_version()}")
    parser.add_argument("--or-picture", action="store_true", help=argparse.SUPPRESS)
    if arguments and not arguments[0].startswith("-"):
        _check_is_scene(parser, arguments[0], commands)
    options = parser.parse_args(arguments)
    path = scene_path(options.scene)
    if not has_display():
        if options.or_picture:
            return _picture_instead(options.scene)
        named = options.scene or resources.DEFAULT_SCENE
        complain(f"{no_display_reason()}; without one, use: shadowcull render {named} -o out.png", kind="")
        return MISUSED
    try:
        from viewer import app
    except ImportError as error:
        complain(f"no window can be opened, as a library is missing ({error}); 'shadowcull render' needs none")
        return FAILED
    return app.run(path)


def _check_is_scene(parser: _Parser, name: str, commands: list[str]) -> None:
    """A word that is no file may be a command mistyped: better said now than as an error about a missing file."""
    if name in resources.embedded_scenes() or Path(name).exists() or Path(name).suffix:
        return
    close = difflib.get_close_matches(name, [*commands, *resources.embedded_scenes()], n=1)
    hint = f"did you mean '{close[0]}'?" if close else f"the commands are {', '.join(commands)}"
    parser.error(f"{name!r} is no command, no file and no scene that comes with the program: {hint}")


def _picture_instead(scene: str | None) -> int:
    """Without a display, `make run` still does the main job: a frame after enough others for culling to act."""
    print(f"shadowcull: {no_display_reason()}; rendering to a file instead", file=sys.stderr, flush=True)
    PICTURE.parent.mkdir(exist_ok=True)
    where = ["--frame", "12", "--warmup", "12"] if scene is None else ["--warmup", "8"]
    return _render([scene or resources.DEFAULT_SCENE, "-o", str(PICTURE.absolute()), "--size", "640x480", *where])


def _render(arguments: list[str]) -> int:
    parser = _Parser(
        prog="shadowcull render",
        description="Trace one frame of a scene, print its statistics, and write a picture, its buffers, or both.",
        epilog=_RENDER_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("scene", nargs="?", metavar="SCENE", help=_scene_help())
    add("-o", "--output", type=Path, metavar="FILE", help="the picture; a .png also remembers how it was made")
    moment = parser.add_mutually_exclusive_group()
    moment.add_argument("--frame", type=int, metavar="N", help="number of the frame in the animation (default: 0)")
    moment.add_argument("--time", type=float, metavar="T", help="time in seconds, instead of a frame")
    add("--size", type=_size, default=(512, 512), metavar="WxH", help="width and height in pixels (default: 512x512)")
    add("--samples", type=_count(1, 4096), default=1, metavar="N", help="rays per pixel, averaged (default: 1)")
    add("--method", choices=("none", "paper"), default="paper", help="how shadow rays are culled (default: paper)")
    add(
        "--view",
        type=_view_option,
        default="color",
        metavar="V",
        help="what to draw: color, occlusion, shadow:LIGHT, primitive, depth, normal, pixel-count, difference or "
        "wipe:PART (default: color)",
    )
    add("--camera", metavar="JSON", help="another camera: position, direction, up, angle; or a file with that")
    add("--warmup", type=_count(0, 100_000), default=0, metavar="N", help="trace the N frames before it first")
    add("--buffers", type=Path, metavar="FILE.npz", help="what was found at each pixel, as arrays; see below")
    _add_tracing_options(parser)
    add("--verify", action="store_true", help="trace every culled shadow ray as well, and count wrong answers")
    options = parser.parse_args(arguments)

    from viewer import headless

    options.camera = headless.camera_option(options.camera) if options.camera is not None else None
    headless.render(scene_path(options.scene), options)
    return 0


def _bench(arguments: list[str]) -> int:
    parser = _Parser(
        prog="shadowcull bench",
        description="Render a path of frames by several methods and print what each saves, as the paper's Table 1.",
        epilog=_BENCH_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("scene", nargs="?", metavar="SCENE", help=_scene_help())
    add(
        "--methods",
        type=lambda text: [name.strip() for name in text.split(",")],
        default=["paper"],
        metavar="M,...",
        help="none, paper; none is always among them (default: paper)",
    )
    add("--path-frames", type=_count(1, 1_000_000), metavar="N", help="resample the animation to N frames")
    add("--frames", metavar="A:B", help="only the frames A to B - 1 of the path")
    add("--size", type=_size, default=(512, 512), metavar="WxH", help="width and height in pixels (default: 512x512)")
    add("--verify", action="store_true", help="trace every culled shadow ray as well, and count wrong answers")
    add("--json", type=Path, metavar="FILE", help="every figure of every frame")
    add("--csv", type=Path, metavar="FILE", help="the table")
    add("--plot", type=Path, metavar="FILE", help="savings per frame, drawn for a slide: a .png, .svg or .pdf")
    _add_tracing_options(parser)
    options = parser.parse_args(arguments)

    from viewer import bench

    return 0 if bench.bench(scene_path(options.scene), options) else INTERRUPTED


def _add_tracing_options(parser: _Parser) -> None:
    """What `render` and `bench` have in common."""
    add = parser.add_argument
    add("--accelerator", choices=("kdtree",), default="kdtree", help="the structure that rays go through")
    add("--threads", type=_count(0, 1024), default=0, metavar="N", help="0, the default: one per core")
    add("--depth", type=_count(0, 100), default=10, metavar="D", help="the most bounces (default: 10)")
    add("--symmetric", action="store_true", help="occlusion tests in both directions between neighbouring pixels")
    add("--zoom-factor", type=float, default=4.0, metavar="F", help="growth after which modes are learnt anew (4)")


def _info(arguments: list[str]) -> int:
    parser = _Parser(
        prog="shadowcull info",
        description="Say what a scene holds: primitives, lights, materials, frames, bounds, and warnings.",
        epilog=_INFO_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("scene", nargs="?", metavar="SCENE", help=_scene_help())
    parser.add_argument("--json", action="store_true", help="as JSON on standard output")
    options = parser.parse_args(arguments)

    from viewer import headless

    headless.info(scene_path(options.scene), options.json)
    return 0


def _scene_help() -> str:
    names = ", ".join(resources.embedded_scenes())
    return f"a file (.aff .nff .obj .ply .stl .gltf .glb) or a scene that comes with the program ({names})"


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("shadowcull")
    except PackageNotFoundError:
        return "(not installed)"


def _size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d{1,6})[xX×](\d{1,6})", text.strip())
    if not match or not int(match[1]) or not int(match[2]):
        raise argparse.ArgumentTypeError(f"{text!r} is no size; give one like 640x480")
    return int(match[1]), int(match[2])


def _count(least: int, most: int) -> Callable[[str], int]:
    def parse(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"{text!r} is no whole number") from None
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(f"{value} is not in {least} to {most}")
        return value

    return parse


def _view_option(text: str) -> tuple:
    """A view, the light it speaks of, and the place of a wipe's line."""
    from viewer.views import View

    name, colon, detail = text.partition(":")
    name = _VIEW_NAMES.get(name, name)
    details = {View.SHADOW: r"\d{1,9}", View.WIPE: r"0|1|[01]?\.\d{1,9}"}
    known = ", ".join({View.SHADOW: "shadow:LIGHT", View.WIPE: "wipe:PART"}.get(v, v.value) for v in View)
    if name not in set(View) or (colon and not re.fullmatch(details.get(View(name), r"(?!)"), detail, re.ASCII)):
        raise argparse.ArgumentTypeError(f"{text!r} is no view; the views are {known}")
    view = View(name)
    wipe = float(detail) if view is View.WIPE and detail else 0.5
    if wipe > 1.0:
        raise argparse.ArgumentTypeError(f"{text!r}: the line of a wipe lies at 0 to 1 of the width")
    return view, int(detail) if view is View.SHADOW and detail else 0, wipe
