"""What each command understands: its options, their help, and what follows below them."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from tracer.geometry.accelerators import ACCELERATORS
from tracer.method import DEFAULT_METHOD
from tracer.settings import MAX_NODES
from tracer.version import program_version
from viewer.cli import examples
from viewer.cli.argument_types import (
    BeyondMemory,
    before,
    count,
    cube_side,
    factors,
    lamp_samples,
    method,
    methods_or_all,
    number,
    pixel,
    several,
    size,
)
from viewer.cli.edit_options import add_edits
from viewer.cli.mesh_arguments import add_mesh_options
from viewer.cli.parser import Parser
from viewer.util import resources

WARMUP = "first trace the N frames before it"
CAMERA = "position, direction, up, angle; a file with that, or a saved picture"


def viewer() -> Parser:
    """Of the command that opens the window."""
    parser = Parser(
        prog="shadowcull",
        description="An interactive ray tracer that shows shadow culling at work.",
        epilog=examples.COMMANDS,
    )
    add_scene(parser)
    _add_lamps(parser)
    add_mesh_options(parser)
    parser.add_argument("--version", action="version", version=f"shadowcull {program_version()}")
    parser.add_argument("--or-picture", action="store_true", help=argparse.SUPPRESS)
    return parser


def bench() -> Parser:
    """Of `bench`."""
    parser = Parser(
        prog="shadowcull bench",
        description="Render a path of frames by several methods and print what each saves, as the paper's Table 1.",
        epilog=examples.BENCH + examples.methods(),
    )
    add = parser.add_argument
    add_scene(parser)
    add(
        "--methods",
        type=methods_or_all,
        default=["paper"],
        metavar="M,...",
        help=f"which methods: {methods()}; none is always measured too; or all, for those that are worth comparing in "
        "the scene (default: paper)",
    )
    add("--path-frames", type=count(1, 1_000_000), metavar="N", help="resample the animation to N frames")
    add("--frames", metavar="A:B", help="only the frames A to B - 1 of the path")
    add("--size", type=size, default=(512, 512), metavar="WxH", help="width and height in pixels (default: 512x512)")
    add("--verify", action="store_true", help="trace every culled shadow ray as well, and count wrong answers")
    add("--json", type=Path, metavar="FILE", help="every figure of every frame")
    add("--csv", type=Path, metavar="FILE", help="the table")
    add("--plot", type=Path, metavar="FILE", help="savings per frame, drawn for a slide: a .png, .svg or .pdf")
    add_tracing_options(parser, "kdtree", many_lamps=True)  # whose steps are the paper's
    add_zoom_factor(parser)
    return parser


def zoom() -> Parser:
    """Of `zoom`."""
    parser = Parser(
        prog="shadowcull zoom",
        description="Move towards a primitive in steps, and show whether its shadows stay right for each zoom factor.",
        epilog=examples.ZOOM,
    )
    add = parser.add_argument
    add_scene(parser)
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--primitive", type=count(0, 2**31 - 1), metavar="N", help="towards this primitive")
    which.add_argument("--pixel", type=pixel, metavar="X,Y", help="towards what this pixel of the first frame shows")
    add_moment(parser)
    add("--camera", metavar="JSON", help=f"where to start from: {CAMERA}")
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
    add_tracing_options(parser, "bvh8")
    parser.set_defaults(zoom_factor=4.0, verify=True)  # each test has its own, and verifies
    return parser


def explain() -> Parser:
    """Of `explain`."""
    parser = Parser(
        prog="shadowcull explain",
        description="Say what became of each ray of a pixel: which shadow rays were asked, culled or traced, and why.",
        epilog=examples.EXPLAIN + examples.methods(),
    )
    add = parser.add_argument
    add_scene(parser)
    add("--pixel", type=pixel, required=True, metavar="X,Y", help="column and row, counted from the upper left")
    add_moment(parser)
    add("--size", type=size, default=(512, 512), metavar="WxH", help="width and height in pixels (default: 512x512)")
    help_ = f"how shadow rays are culled: {methods()} (default: {DEFAULT_METHOD})"
    add("--method", type=method, metavar="M", help=help_)
    only = ("all", "traced", "untraced", "blocked", "wrong")
    add("--only", choices=only, default="all", help="which shadow rays are listed (default: all)")
    add("--light", type=count(0, 2**31 - 1), metavar="N", help="only shadow rays to this light")
    add("--json", action="store_true", help="all rays as JSON on standard output")
    add("--camera", metavar="JSON", help=f"another camera: {CAMERA}")
    add_edits(parser)
    add_before(parser)
    help_ = "then trace the frame itself N times (default: 1 without --warmup and --before, else 0)"
    add("--repeat", type=count(0, 1000), metavar="N", help=help_)
    add_tracing_options(parser, "bvh8")
    add_zoom_factor(parser)
    parser.set_defaults(verify=False, samples=1)
    return parser


def cube() -> Parser:
    """Of `cube`."""
    parser = Parser(
        prog="shadowcull cube",
        description="Save what a light sees, as the method lightbuffer has it: its cube unfolded, on the left what is "
        "known of each cell, on the right how far from the light all is in shadow.",
        epilog=examples.CUBE,
    )
    add = parser.add_argument
    add_scene(parser)
    add("--light", type=count(0, 2**31 - 1), default=0, metavar="N", help="which light (default: 0)")
    add(
        "--side",
        type=cube_side,
        default=256,
        metavar="N",
        help="cells along an edge, a power of two from 16 to 1024 (default: 256)",
    )
    add("-o", "--output", type=Path, default=Path("cube.png"), metavar="FILE", help="the picture (default: cube.png)")
    add("--no-legend", action="store_true", help="a pixel for each cell, without legends")
    add_moment(parser)
    add_tracing_options(parser, "bvh8")
    parser.set_defaults(verify=False, samples=1, size=(16, 16), zoom_factor=4.0)
    return parser


def info() -> Parser:
    """Of `info`."""
    parser = Parser(
        prog="shadowcull info",
        description="Say what a scene, or that of a saved picture, holds: primitives, lights, materials, frames, "
        "bounds, and warnings. Of a model without camera and lights it counts what is in the file, lit by two lights, "
        "and says what the studio adds in which the window and the commands that trace set it.",
        epilog=examples.INFO,
    )
    add_scene(parser)
    parser.add_argument("--json", action="store_true", help="as JSON on standard output")
    return parser


def add_scene(parser: Parser, more: str = "") -> None:
    """The scene, and where its files may be."""
    add = parser.add_argument
    add("scene", nargs="?", metavar="SCENE", help=_scene_help() + more)
    help_ = "another folder than its own that the scene may read files from; may be given several times"
    add("--folder", type=Path, action="append", default=[], metavar="DIR", help=help_)
    add_beyond_memory(parser)


def add_beyond_memory(parser: Parser) -> None:
    """To go on where a scene needs more memory than there is."""
    help_ = "read a scene even if it needs more memory than there is, which may end this program or others"
    parser.add_argument("--beyond-memory", action=BeyondMemory, nargs=0, help=help_)


def add_before(parser: Parser) -> None:
    """The frames from which modes are learnt: those before on the path, or any."""
    parser.add_argument("--warmup", type=count(0, 100_000), default=0, metavar="N", help=WARMUP)
    help_ = "before these, trace the frames of this list of [time, camera], or of the JSON of a find of hunt"
    parser.add_argument("--before", type=before, default=(), metavar="JSON", help=help_)


def add_moment(parser: Parser) -> None:
    """Either of two ways to name a moment of the animation."""
    moment = parser.add_mutually_exclusive_group()
    moment.add_argument("--frame", type=int, metavar="N", help="number of the frame in the animation (default: 0)")
    moment.add_argument("--time", type=float, metavar="T", help="time in seconds, instead of a frame")


def add_tracing_options(parser: Parser, accelerator: str, many_lamps: bool = False) -> None:
    """What all commands that trace have in common, with the structure that is theirs by default; `many_lamps`: they
    take several kinds of lamps."""
    add = parser.add_argument
    help_ = f"the tree that rays are traced through (default: {accelerator})"
    add("--accelerator", choices=ACCELERATORS, default=accelerator, help=help_)
    add("--threads", type=count(0, 1024), default=0, metavar="N", help="0, the default: one per core")
    add("--depth", type=count(0, 100), default=10, metavar="D", help="the most bounces (default: 10)")
    add("--symmetric", action="store_true", help="occlusion tests in both directions between neighbouring pixels")
    _add_lamps(parser, many_lamps)
    _add_cuts(parser)
    add_mesh_options(parser)


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


def _add_cuts(parser: Parser) -> None:
    """How fine clusters of lights are."""
    help_ = "the part of a point's light that a cluster of lights may be wrong by (default: 0.02; 0: no clusters)"
    parser.add_argument("--lightcuts-error", type=number(0.0, 1e9), default=0.02, metavar="E", help=help_)
    help_ = "clusters of lights for a point, at most (default: 1000)"
    parser.add_argument("--lightcuts-nodes", type=count(1, MAX_NODES), default=1000, metavar="N", help=help_)


def add_zoom_factor(parser: Parser) -> None:
    help_ = "a primitive that covers this many times its highest pixel count is examined again (default: 4)"
    parser.add_argument("--zoom-factor", type=number(1.0, 1e9), default=4.0, metavar="F", help=help_)


def methods() -> str:
    """The bases, and what can be added to them."""
    from tracer.method import additions, bases

    names = [kind.name for kind in bases(measures=True)]
    added = " or ".join(f"+{kind.name}" for kind in additions(measures=True))
    return f"{', '.join(names[:-1])} or {names[-1]}, each with or without {added}, as in certified+cache"


def _scene_help() -> str:
    names = ", ".join(resources.embedded_scenes())
    return f"a file (.aff .nff .obj .ply .stl .gltf .glb) or a scene that comes with the program ({names})"
