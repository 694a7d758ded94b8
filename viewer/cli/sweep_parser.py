"""What `sweep` understands, and the options of all commands whose work several processes can share."""

from __future__ import annotations

import argparse
from pathlib import Path

from viewer.cli.argument_types import count
from viewer.cli.parser import Parser

EPILOG = """\
examples:
  shadowcull sweep study.toml
  shadowcull sweep study.toml --workers 8 --plot study.svg
  shadowcull sweep study.toml --scheduler tcp://10.0.0.1:8786
  shadowcull sweep study.toml --table

A study is a TOML file:

  title = "Three rooms"
  scenes = ["default", "office", "kitchen/kitchen.aff"]  # of the program, or files beside the study
  methods = ["none", "paper", "certified"]
  sizes = ["256x256", "512x512"]
  seeds = [1, 2, 3]    # each traces all of it
  shake = 0.01         # and moves the camera aside, by up to this part of the scene's diagonal
  warmup = 20          # a method that learns sees only so many frames before each, which are then independent
  [path]
  frames = 100         # resample the animation
  first = 0
  last = 49
  [settings]           # a value, or a list of them: depth, symmetric, zoom_factor, verify, accelerator, lamp_radius,
  depth = [2, 10]      # lamp_samples, certificates, certificate_seconds, certificate_memory, lightcuts_error,
                       # lightcuts_nodes, light_buffer_side, light_buffer_memory

Frames of methods that learn nothing are tasks of their own. Other methods trace their whole path in one task, as in
bench, unless there is a warmup. Each task has one thread. Every frame is kept as soon as it is traced, as a row of
Parquet in the folder of results, and the same command again traces only what is missing. Ctrl-C ends the sweep at once.

The table says of each method, under the same circumstances, how many steps and tests it saves on average; which part
of the shadow rays is known, that is culled or tested against dynamic objects only; the median processor time of a
frame; and the speed-up, which is the processor time of all frames by none over that by the method.

--scheduler takes the address of a Dask scheduler whose workers have the same version of Shadowcull and one thread each;
scenes are sent to them. Needs Dask and PyArrow: install shadowcull[sweep].
"""


def sweep() -> Parser:
    """Of `sweep`."""
    parser = Parser(
        prog="shadowcull sweep",
        description="Trace a study, scenes by methods by settings by seeds, by several processes, and keep every frame "
        "as a row.",
        epilog=EPILOG,
    )
    add = parser.add_argument
    add("study", type=Path, metavar="STUDY.toml", help="what to trace; see below")
    help_ = "the folder of the results (default: beside the study, STUDY-results)"
    add("-o", "--output", type=Path, metavar="DIR", help=help_)
    add_processes(parser)
    add("--table", action="store_true", help="trace nothing; print the table of what there is")
    add("--plot", type=Path, metavar="FILE", help="draw what there is at the end: a .png, .svg or .pdf")
    add("--anew", action="store_true", help="throw away what there is, and trace all of it")
    return parser


def add_processes(parser: argparse.ArgumentParser) -> None:
    """Who does the work: processes of this machine, or those of a cluster."""
    group = parser.add_mutually_exclusive_group()
    help_ = "so many processes of this machine, with one thread each"
    group.add_argument("--workers", type=count(1, 1024), metavar="N", help=help_)
    help_ = "the workers of a Dask scheduler that runs there, such as tcp://10.0.0.1:8786"
    group.add_argument("--scheduler", metavar="ADDRESS", help=help_)
