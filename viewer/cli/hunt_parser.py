"""What the command `hunt` understands."""

from __future__ import annotations

from pathlib import Path

from viewer.cli import examples, parsers
from viewer.cli.argument_types import count, method, number, size, span
from viewer.cli.parser import Parser


def hunt() -> Parser:
    """Of `hunt`."""
    parser = Parser(
        prog="shadowcull hunt",
        description="Search a path of frames, and pictures beside it, for the worst wrong pixels of a method.",
        epilog=examples.HUNT + examples.methods(),
    )
    add = parser.add_argument
    parsers.add_scene(parser)
    add("--method", type=method, default="paper", metavar="M", help=f"whose: {parsers.methods()} (default: paper)")
    add("--frames", type=span, metavar="A-B", help="the frames A to B of the path, or one (default: all)")
    add("--step", type=count(1, 1_000_000), default=1, metavar="N", help="only every N-th of them (default: 1)")
    add("--camera", metavar="JSON", help=f"stand still, and let time pass: {parsers.CAMERA}")
    add("--around", type=count(0, 1_000_000), default=0, metavar="N", help="then N pictures beside it (default: 0)")
    help_ = "how far these are, at most, in parts of the distance to what is wrong (default: 0.3)"
    add("--radius", type=number(0.0, 100.0), default=0.3, metavar="R", help=help_)
    add("--seed", type=count(0, 2**31 - 1), default=1, metavar="S", help="which of them are drawn (default: 1)")
    add("--keep", type=count(1, 1000), default=8, metavar="K", help="how many finds, the worst (default: 8)")
    add("--size", type=size, default=(512, 512), metavar="WxH", help="width and height in pixels (default: 512x512)")
    help_ = "a folder for a figure and a JSON of each find, and for hunt.json"
    add("-o", "--output", type=Path, metavar="DIR", help=help_)
    parsers.add_tracing_options(parser, "bvh8")
    parsers.add_zoom_factor(parser)
    parser.set_defaults(verify=True)
    return parser
