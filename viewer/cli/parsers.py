"""What each command understands: its options, their help, and what follows below them."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

from viewer.cli import examples
from viewer.cli.argument_types import (
    annotation_list,
    count,
    crops,
    factors,
    lamp_samples,
    method,
    number,
    pixel,
    place,
    several,
    size,
    span,
    tev_address,
    view,
)
from viewer.util import resources
from viewer.util.messages import ERROR, say
from viewer.util.version import program_version

MISUSED = 2
"""Exit code where a command line is wrong."""
_CAMERA = "position, direction, up, angle; a file with that, or a saved picture"


class Parser(argparse.ArgumentParser):
    """Options by their whole names; errors in one line, which names where help is."""

    def __init__(self, prog: str, description: str, epilog: str) -> None:
        super().__init__(
            prog=prog,
            description=description,
            epilog=epilog,
            formatter_class=argparse.RawDescriptionHelpFormatter,
            allow_abbrev=False,
        )

    def error(self, message: str) -> NoReturn:
        say(f"{message} (see '{self.prog} --help')", ERROR)
        sys.exit(MISUSED)


def viewer() -> Parser:
    """Of the command that opens the window."""
    parser = Parser(
        prog="shadowcull",
        description="An interactive ray tracer that shows shadow culling at work.",
        epilog=examples.COMMANDS,
    )
    _add_scene(parser)
    _add_lamps(parser)
    parser.add_argument("--version", action="version", version=f"shadowcull {program_version()}")
    parser.add_argument("--or-picture", action="store_true", help=argparse.SUPPRESS)
    return parser


def render() -> Parser:
    """Of `render`."""
    parser = Parser(
        prog="shadowcull render",
        description="Trace one frame of a scene, print its statistics, and write a picture, its buffers, or both.",
        epilog=examples.RENDER + examples.methods(),
    )
    add = parser.add_argument
    _add_scene(parser, ", or a saved picture, to render it again")
    help_ = "the picture; a .png also remembers how it was made, and an .exr has all buffers"
    add("-o", "--output", type=Path, metavar="FILE", help=help_)
    _add_moment(parser)
    _add_picture(parser)
    add("--warmup", type=count(0, 100_000), default=0, metavar="N", help="first trace the N frames before it")
    add("--repeat", type=count(0, 1000), default=0, metavar="N", help="then trace the frame itself N times")
    add("--print-command", action="store_true", help="print the whole command for this picture, and trace nothing")
    help_ = "show the frame and its buffers in tev or HDRView, which is open there"
    add("--to-tev", type=tev_address, metavar="HOST:PORT", help=help_)
    add("--half", action="store_true", help="colours and normals of an .exr with 16 bits, not 32")
    add("--buffers", type=Path, metavar="FILE.npz", help="what was found at each pixel, as arrays; see below")
    _add_tracing_options(parser, "bvh8")
    _add_zoom_factor(parser)
    add("--verify", action="store_true", help="trace every culled shadow ray as well, and count wrong answers")
    return parser


def _add_picture(parser: Parser) -> None:
    """What one picture is to be like."""
    add = parser.add_argument
    add("--size", type=size, default=(512, 512), metavar="WxH", help="width and height in pixels (default: 512x512)")
    add("--samples", type=count(1, 4096), default=1, metavar="N", help="rays per pixel, averaged (default: 1)")
    add(
        "--method",
        type=method,
        metavar="M",
        help=f"how shadow rays are culled: {_methods()} (default: auto, or paper or certified for views that show "
        "what these do)",
    )
    add(
        "--view",
        type=view,
        default="color",
        metavar="V",
        help="what to draw: color, occlusion, shadow:LIGHT, primitive, depth, normal, pixel-count, difference, "
        "wipe:PART, certificate:LIGHT, penumbra:LIGHT, lights, saved or cost, as counts of rays or as shares like "
        "saved:share (default: color)",
    )
    add("--legend", action="store_true", help="draw the view's legend into the picture")
    add("--no-marks", action="store_true", help="no rings around wrong pixels in the views difference and wipe")
    _add_style(parser)
    add("--camera", metavar="JSON", help=f"another camera: {_CAMERA}")


def film() -> Parser:
    """Of `film`."""
    parser = Parser(
        prog="shadowcull film",
        description="Trace the frames of a scene's path, or of a flight through bookmarks, into numbered pictures, and "
        "into a video.",
        epilog=examples.FILM + examples.methods(),
    )
    add = parser.add_argument
    _add_scene(parser, ", or a saved picture, for its scene, settings and view")
    help_ = "a folder for the pictures; or film.mp4, whose pictures go to film-frames"
    add("-o", "--output", type=Path, metavar="DIR|FILE.mp4", help=help_)
    add("--frames", type=span, metavar="A-B", help="the frames A to B of the path (default: all)")
    help_ = "fly through where these saved pictures were taken, at an even speed, in place of the path"
    add("--through", type=Path, nargs="+", metavar="PICTURE", help=help_)
    add("--bookmarks", action="store_true", help="fly through the scene's bookmarks, which the window keeps")
    help_ = "how long the film is (default: every frame of the path once; 2 seconds from bookmark to bookmark)"
    add("--seconds", type=number(0.01, 86_400.0), metavar="S", help=help_)
    add("--fps", type=number(1.0, 240.0), default=25.0, metavar="F", help="frames a second (default: 25)")
    _add_picture(parser)
    _add_tracing_options(parser, "bvh8")
    _add_zoom_factor(parser)
    add("--verify", action="store_true", help="trace every culled shadow ray as well, and count wrong answers")
    parser.set_defaults(frame=None, time=None, warmup=0, repeat=0)
    return parser


def figure() -> Parser:
    """Of `figure`."""
    parser = Parser(
        prog="shadowcull figure",
        description="Draw one frame by several methods side by side: crops, what differs from none, and counts.",
        epilog=examples.FIGURE + examples.methods(),
    )
    add = parser.add_argument
    _add_scene(parser, ", or a saved picture, for its scene, settings and view")
    add("-o", "--output", type=Path, metavar="FILE", help="the figure, a .png or .pdf, which says how it was made")
    add(
        "--methods",
        type=several(method),
        default=["none", "paper", "certified"],
        metavar="M,...",
        help="which methods, in the order of the columns (default: none,paper,certified)",
    )
    add("--crops", type=crops, default=(), metavar="X,Y,W,H;...", help="rectangles of pixels that are shown enlarged")
    add("--warmup", type=count(0, 100_000), default=0, metavar="N", help="first trace the N frames before it")
    _add_moment(parser)
    _add_picture(parser)
    _add_tracing_options(parser, "kdtree")  # whose steps are the paper's
    _add_zoom_factor(parser)
    parser.set_defaults(repeat=0, verify=False)
    return parser


def check() -> Parser:
    """Of `check`."""
    parser = Parser(
        prog="shadowcull check",
        description="Render saved pictures and figures again, and say of each whether it is still true.",
        epilog=examples.CHECK,
    )
    add = parser.add_argument
    add("pictures", nargs="+", type=Path, metavar="FILE", help="a .png that this program saved, or a .pdf of figure")
    help_ = "another folder than its own that a scene may read files from; may be given several times"
    add("--folder", type=Path, action="append", default=[], metavar="DIR", help=help_)
    add("--threads", type=count(0, 1024), default=0, metavar="N", help="0, the default: one per core")
    return parser


def _add_style(parser: Parser) -> None:
    """How `render` draws, beside the view."""
    from viewer.state.views import BENEATH

    add = parser.add_argument
    add("--legend-at", type=place, metavar="X,Y", help="where the legend is: 0,0 is the upper left (default: 0,1)")
    add("--caption", default="", metavar="TEXT", help="a line below the picture, like '{scene}, frame {frame}'")
    add("--annotations", type=annotation_list, default=(), metavar="JSON", help="arrows, boxes and words; see below")
    add("--outlines", action="store_true", help="draw the borders between primitives")
    help_ = "how much of the light shows under flat colours, 0 to 1 (default: 0.35)"
    add("--shading", type=number(0.0, 1.0), default=0.35, metavar="S", help=help_)
    help_ = f"brightness of the picture beneath the difference, 0 to 1 (default: {BENEATH:g})"
    add("--beneath", type=number(0.0, 1.0), default=BENEATH, metavar="B", help=help_)
    help_ = "draw rings for a picture that is shown N times as large (default: 1)"
    add("--magnified", type=count(1, 100), default=1, metavar="N", help=help_)


def bench() -> Parser:
    """Of `bench`."""
    parser = Parser(
        prog="shadowcull bench",
        description="Render a path of frames by several methods and print what each saves, as the paper's Table 1.",
        epilog=examples.BENCH + examples.methods(),
    )
    add = parser.add_argument
    _add_scene(parser)
    add(
        "--methods",
        type=lambda text: [name.strip() for name in text.split(",")],
        default=["paper"],
        metavar="M,...",
        help=f"which methods: {_methods()}; none is always measured too (default: paper)",
    )
    add("--path-frames", type=count(1, 1_000_000), metavar="N", help="resample the animation to N frames")
    add("--frames", metavar="A:B", help="only the frames A to B - 1 of the path")
    add("--size", type=size, default=(512, 512), metavar="WxH", help="width and height in pixels (default: 512x512)")
    add("--verify", action="store_true", help="trace every culled shadow ray as well, and count wrong answers")
    add("--json", type=Path, metavar="FILE", help="every figure of every frame")
    add("--csv", type=Path, metavar="FILE", help="the table")
    add("--plot", type=Path, metavar="FILE", help="savings per frame, drawn for a slide: a .png, .svg or .pdf")
    _add_tracing_options(parser, "kdtree", many_lamps=True)  # whose steps are the paper's
    _add_zoom_factor(parser)
    return parser


def zoom() -> Parser:
    """Of `zoom`."""
    parser = Parser(
        prog="shadowcull zoom",
        description="Move towards a primitive in steps, and show whether its shadows stay right for each zoom factor.",
        epilog=examples.ZOOM,
    )
    add = parser.add_argument
    _add_scene(parser)
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--primitive", type=count(0, 2**31 - 1), metavar="N", help="towards this primitive")
    which.add_argument("--pixel", type=pixel, metavar="X,Y", help="towards what this pixel of the first frame shows")
    _add_moment(parser)
    add("--camera", metavar="JSON", help=f"where to start from: {_CAMERA}")
    add("--steps", type=count(1, 10_000), default=30, metavar="N", help="how many (default: 30)")
    add(
        "--ratio",
        type=number(0.001, 0.9999),
        default=0.94,
        metavar="R",
        help="each step goes to this part of the distance (default: 0.94)",
    )
    add("--factors", type=factors, default=(4.0, 16.0), metavar="F,...", help="zoom factors (default: 4,16)")
    add("--size", type=size, default=(512, 512), metavar="WxH", help="width and height in pixels (default: 512x512)")
    add("--json", type=Path, metavar="FILE", help="every figure of every step")
    add("--csv", type=Path, metavar="FILE", help="a line for each step")
    add("--plot", type=Path, metavar="FILE", help="counts, modes and wrong pixels over the steps: a .png, .svg or .pdf")
    _add_tracing_options(parser, "bvh8")
    parser.set_defaults(zoom_factor=4.0, verify=True)  # each test has its own, and verifies
    return parser


def info() -> Parser:
    """Of `info`."""
    parser = Parser(
        prog="shadowcull info",
        description="Say what a scene, or that of a saved picture, holds: primitives, lights, materials, frames, "
        "bounds, and warnings.",
        epilog=examples.INFO,
    )
    _add_scene(parser)
    parser.add_argument("--json", action="store_true", help="as JSON on standard output")
    return parser


def _add_scene(parser: Parser, more: str = "") -> None:
    """The scene, and where its files may be."""
    add = parser.add_argument
    add("scene", nargs="?", metavar="SCENE", help=_scene_help() + more)
    help_ = "another folder than its own that the scene may read files from; may be given several times"
    add("--folder", type=Path, action="append", default=[], metavar="DIR", help=help_)


def _add_moment(parser: Parser) -> None:
    """Either of two ways to name a moment of the animation."""
    moment = parser.add_mutually_exclusive_group()
    moment.add_argument("--frame", type=int, metavar="N", help="number of the frame in the animation (default: 0)")
    moment.add_argument("--time", type=float, metavar="T", help="time in seconds, instead of a frame")


def _add_tracing_options(parser: Parser, accelerator: str, many_lamps: bool = False) -> None:
    """What all commands that trace have in common, with the structure that is theirs by default; `many_lamps`: they
    take several kinds of lamps."""
    add = parser.add_argument
    help_ = f"the tree that rays are traced through (default: {accelerator})"
    add("--accelerator", choices=("kdtree", "bvh8"), default=accelerator, help=help_)
    add("--threads", type=count(0, 1024), default=0, metavar="N", help="0, the default: one per core")
    add("--depth", type=count(0, 100), default=10, metavar="D", help="the most bounces (default: 10)")
    add("--symmetric", action="store_true", help="occlusion tests in both directions between neighbouring pixels")
    _add_lamps(parser, many_lamps)


def _add_lamps(parser: Parser, many: bool = False) -> None:
    """What makes lamps of a scene's lights; without an option, they are as the scene, or a saved picture, says."""
    add = parser.add_argument
    radius: Callable[[str], object] = number(0.0, 1e9)
    samples: Callable[[str], object] = lamp_samples
    more = "; several, with commas, are measured one after another" if many else ""
    if many:
        radius, samples = several(radius), several(samples)
    help_ = "make every point light and sphere a sphere of this radius, in the scene's units; 0 makes them points"
    add("--lamp-radius", type=radius, metavar="R,..." if many else "R", help=help_ + more)
    help_ = "points from which each lamp shines (default: as the scene says, and 16 for what --lamp-radius makes)"
    add("--lamp-samples", type=samples, metavar="N,..." if many else "N", help=help_ + more)


def _add_zoom_factor(parser: Parser) -> None:
    help_ = "a primitive that covers this many times its highest pixel count is examined again (default: 4)"
    parser.add_argument("--zoom-factor", type=number(1.0, 1e9), default=4.0, metavar="F", help=help_)


def _methods() -> str:
    """The bases, and what can be added to them."""
    from tracer.method import additions, bases

    names = [kind.name for kind in bases(measures=True)]
    added = " or ".join(f"+{kind.name}" for kind in additions())
    return f"{', '.join(names[:-1])} or {names[-1]}, each with or without {added}, as in certified+cache"


def _scene_help() -> str:
    names = ", ".join(resources.embedded_scenes())
    return f"a file (.aff .nff .obj .ply .stl .gltf .glb) or a scene that comes with the program ({names})"
