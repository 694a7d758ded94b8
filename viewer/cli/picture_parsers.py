"""What the commands understand that make pictures: `render`, `film`, `figure` and `check`."""

from __future__ import annotations

from pathlib import Path

from tracer.method import DEFAULT_METHOD
from viewer.cli import examples, parsers
from viewer.cli.argument_types import (
    count,
    crops,
    curve,
    method,
    methods,
    number,
    place,
    size,
    slice_,
    span,
    tev_address,
    values,
    view,
)
from viewer.cli.edit_options import add_edits
from viewer.cli.parser import Parser
from viewer.cli.sweep_parser import add_processes


def render() -> Parser:
    """Of `render`."""
    parser = Parser(
        prog="shadowcull render",
        description="Trace one frame, print its statistics, and write it as a picture, as buffers, or as a figure.",
        epilog=examples.RENDER + examples.methods(),
    )
    add = parser.add_argument
    parsers.add_scene(parser, ", or a saved picture, to render it again")
    help_ = "the picture; a .png also remembers how it was made, and an .exr has all buffers"
    add("-o", "--output", type=Path, metavar="FILE", help=help_)
    parsers.add_moment(parser)
    _add_picture(parser)
    parsers.add_before(parser)
    add("--repeat", type=count(0, 1000), default=0, metavar="N", help="then trace the frame itself N times")
    add("--print-command", action="store_true", help="print the whole command for this picture, and trace nothing")
    help_ = "show the frame and its buffers in tev or HDRView, which is open there"
    add("--to-tev", type=tev_address, metavar="HOST:PORT", help=help_)
    add("--half", action="store_true", help="colours and normals of an .exr with 16 bits, not 32")
    add("--buffers", type=Path, metavar="FILE.npz", help="what was found at each pixel, as arrays; see below")
    help_ = "the paper's Figure 1 with the numbers of this frame, for slides"
    add("--figure1", type=Path, metavar="FILE.svg", help=help_)
    parsers.add_tracing_options(parser, "bvh8")
    parsers.add_zoom_factor(parser)
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
        help=f"how shadow rays are culled: {parsers.methods()} (default: {DEFAULT_METHOD}, or the "
        "method that a view belongs to: certified, lightcuts, voxels or lie-exact)",
    )
    add(
        "--view",
        type=view,
        default="color",
        metavar="V",
        help="what to draw: color, occlusion, shadow:LIGHT, primitive, depth, normal, pixel-count, difference, "
        "wipe:PART, certificate:LIGHT, penumbra:LIGHT, lights, cuts, voxels:LIGHT, cell-lights, tree, fate:LIGHT, "
        "moving-shadow:LIGHT, saved or cost, "
        "as counts of rays or as shares like saved:share (default: color)",
    )
    add("--legend", action="store_true", help="draw the view's legend into the picture")
    _add_display(parser)
    add("--no-marks", action="store_true", help="no rings around wrong pixels in the views difference and wipe")
    _add_style(parser)
    add("--camera", metavar="JSON", help=f"another camera: {parsers.CAMERA}")
    add_edits(parser)


def film() -> Parser:
    """Of `film`."""
    parser = Parser(
        prog="shadowcull film",
        description="Trace the frames of a scene's path, or of a flight through bookmarks, into numbered pictures, and "
        "into a video.",
        epilog=examples.FILM + examples.methods(),
    )
    add = parser.add_argument
    parsers.add_scene(parser, ", or a saved picture, for its scene, settings and view")
    help_ = "a folder for the pictures; or film.mp4, whose pictures go to film-frames"
    add("-o", "--output", type=Path, metavar="DIR|FILE.mp4", help=help_)
    add("--frames", type=span, metavar="A-B", help="the frames A to B of the path, or one (default: all)")
    help_ = "fly through where these saved pictures were taken, at an even speed, in place of the path"
    add("--through", type=Path, nargs="+", metavar="PICTURE", help=help_)
    add("--bookmarks", action="store_true", help="fly through the scene's bookmarks, which the window keeps")
    help_ = "how long the film is (default: every frame of the path once; 2 seconds from bookmark to bookmark)"
    add("--seconds", type=number(0.01, 86_400.0), metavar="S", help=help_)
    add("--fps", type=number(1.0, 240.0), default=25.0, metavar="F", help="frames a second (default: 25)")
    add_processes(parser)
    _add_picture(parser)
    parsers.add_tracing_options(parser, "bvh8")
    parsers.add_zoom_factor(parser)
    add("--verify", action="store_true", help="trace every culled shadow ray as well, and count wrong answers")
    parser.set_defaults(frame=None, time=None, warmup=0, repeat=0, before=())
    return parser


def figure() -> Parser:
    """Of `figure`."""
    parser = Parser(
        prog="shadowcull figure",
        description="Draw one frame by several methods side by side: crops, what differs from none, and counts.",
        epilog=examples.FIGURE + examples.methods(),
    )
    add = parser.add_argument
    parsers.add_scene(parser, ", or a saved picture, for its scene, settings and view")
    add("-o", "--output", type=Path, metavar="FILE", help="the figure, a .png or .pdf, which says how it was made")
    add(
        "--methods",
        type=methods,
        default=["none", "paper", "certified"],
        metavar="M,...",
        help="which methods, in the order of the columns (default: none,paper,certified)",
    )
    add("--crops", type=crops, default=(), metavar="X,Y,W,H;...", help="rectangles of pixels that are shown enlarged")
    parsers.add_before(parser)
    parsers.add_moment(parser)
    _add_picture(parser)
    parsers.add_tracing_options(parser, "kdtree")  # whose steps are the paper's
    parsers.add_zoom_factor(parser)
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
    help_ = "a .png or .exr that this program saved, or a .png or .pdf of figure"
    add("pictures", nargs="+", type=Path, metavar="FILE", help=help_)
    help_ = "another folder than its own that a scene may read files from; may be given several times"
    add("--folder", type=Path, action="append", default=[], metavar="DIR", help=help_)
    parsers.add_beyond_memory(parser)
    add("--threads", type=count(0, 1024), default=0, metavar="N", help="0, the default: one per core")
    return parser


def _add_display(parser: Parser) -> None:
    """How colours and numbers that were found become those of a picture."""
    from viewer.state.tone import MOST_EXPOSURE, WHITES, Curve

    add, stops = parser.add_argument, number(-MOST_EXPOSURE, MOST_EXPOSURE)
    add("--exposure", type=stops, default=0.0, metavar="STOPS", help="brighter by so many stops (default: 0)")
    help_ = "the colour, once exposed, that becomes white (default: 1)"
    add("--white", type=number(*WHITES), default=1.0, metavar="W", help=help_)
    help_ = f"the tone curve: {', '.join(Curve)} (default: none)"
    add("--tone", type=curve, default=Curve.NONE, metavar="CURVE", help=help_)
    add("--mark-clipped", action="store_true", help="stripes over pixels that are too bright, or black")
    help_ = "what has the first and the last colour in the views depth, saved, cost and lights (default: as they come)"
    add("--range", type=values, metavar="LOW:HIGH", help=help_)


def _add_style(parser: Parser) -> None:
    """How `render` draws, beside the view."""
    from viewer.state.draw_options import MIDDLE
    from viewer.state.palette import BENEATH

    add = parser.add_argument
    add("--legend-at", type=place, metavar="X,Y", help="where the legend is: 0,0 is the upper left (default: 0,1)")
    help_ = (
        "what culling saves, above the picture: a sentence, with TEXT for what is known of steps and time, and a bar"
    )
    add("--savings", nargs="?", const="", metavar="TEXT", help=help_)
    add("--caption", default="", metavar="TEXT", help="a line below the picture, like '{scene}, frame {frame}'")
    add("--outlines", action="store_true", help="draw the borders between primitives")
    help_ = "how much of the light shows under flat colours, 0 to 1 (default: 0.35)"
    add("--shading", type=number(0.0, 1.0), default=0.35, metavar="S", help=help_)
    help_ = "the slice of the views voxels and tree: across which axis, and where along it, 0 to 1 (default: y:0.25)"
    add("--slice", type=slice_, default=MIDDLE, metavar="AXIS:PART", help=help_)
    help_ = f"brightness of the picture beneath the difference, and behind a slice, 0 to 1 (default: {BENEATH:g})"
    add("--beneath", type=number(0.0, 1.0), default=BENEATH, metavar="B", help=help_)
    help_ = "draw rings for a picture that is shown N times as large (default: 1)"
    add("--magnified", type=count(1, 100), default=1, metavar="N", help=help_)
