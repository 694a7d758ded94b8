"""The command `grade`: the report card of a method, from a file or by its name.

Ctrl-C ends it after the last whole trial: the card so far is shown, and written where it was to go."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from argparse import Namespace
from dataclasses import asdict
from pathlib import Path

from tracer.experiments.experiment import REFERENCE
from tracer.experiments.grade import FRAMES, Grade
from tracer.experiments.trials import FEWEST
from tracer.scene.model import Cancelled
from tracer.settings import Settings
from tracer.util.text import printable
from viewer.cli import arguments, options
from viewer.cli.arguments import FAILED, INTERRUPTED, MISUSED, Parser, count
from viewer.cli.console import columns_help, fitted, listed, print_table, terminal_width, working
from viewer.cli.method_file import load_method, said_of
from viewer.output.exports import write_json
from viewer.output.report_card import COLUMNS, as_markdown, in_words
from viewer.util.files import check_writable, write_text
from viewer.util.resources import scene_path

STANDARD = {"default": 20, "figure4": 18}
"""Scenes of the program, and the frame of its path that each begins with."""
OWN = "SHADOWCULL_GRADES_HERE"  # in the environment of the process that runs what a file defines
EPILOG = f"""\
examples:
  shadowcull grade mine.py -o card.json -o card.md
  shadowcull grade certified --scene kitchen.aff --size 256x192 --frames 20

A file has one method: what it registers, or else its class, which then claims to be exact. Ctrl-C keeps the trials that
are done; the exit code is then 130.

{columns_help(COLUMNS)}"""


def parser() -> Parser:
    description = "Say whether a method is right, what it costs, and what it learns wrongly when something changes."
    parser = Parser("grade", description, EPILOG + options.method_summaries())
    add = parser.add_argument
    add("method", type=_method, metavar="METHOD", help=f"a file of Python (.py), or {options.METHODS}")
    add("-o", "--output", type=Path, action="append", default=[], metavar="FILE", help="the card: a .json or a .md")
    help_ = f"where to grade, from the first frame on; may be given several times (default: {' and '.join(STANDARD)})"
    add("--scene", dest="scenes", action="append", default=[], metavar="SCENE", help=help_)
    help_ = f"frames of each trial, {FEWEST} or more (default: {FRAMES})"
    add("--frames", type=count(FEWEST, 10_000), default=FRAMES, metavar="N", help=help_)
    add("--size", type=arguments.size, default=(144, 96), metavar="WxH", help="width and height (default: 144x96)")
    add("--no-shrink", action="store_true", help="do not shrink the worst wrong pixel, which may take a while")
    options.add_settings(parser, Settings, "depth", "lamp_radius", "lamp_samples", depth=2)
    options.add_folders(parser)
    options.add_meshes(parser)
    parser.set_defaults(line=())
    return parser


def _method(text: str) -> str | Path:
    if text.endswith(".py"):
        return Path(text)
    try:
        return arguments.method(text)
    except ValueError as error:
        raise ValueError(f"{error}; or a file of Python, whose name ends in .py") from error


def run(given: Namespace) -> int:
    """Grade, print the card and write it; raises SceneError, ValueError and OSError, each in one line, or Cancelled."""
    file = given.method if isinstance(given.method, Path) else None
    for path in given.output:
        if path.suffix not in (".json", ".md"):
            raise ValueError(f"{path}: unknown kind of file; --output writes .json and .md")
        check_writable(path)
    if file and OWN not in os.environ:
        return _in_a_process_of_its_own(file, given.line)
    settings = options.tracing_settings(given, method=REFERENCE)  # that which is graded is still to be read
    with working() as work:
        firsts = dict.fromkeys(given.scenes, 0) or STANDARD
        scenes = [(options.read_scene(scene_path(name), given, work), first) for name, first in firsts.items()]
        method = load_method(file) if file else given.method
        grade = Grade(method, scenes, settings, given.frames, not given.no_shrink)
        try:
            card = work.perform(grade)
        except Exception as error:
            if file is None or isinstance(error, Cancelled | MemoryError):
                raise
            raise ValueError(said_of(error, file)) from error
    title = f"Report card of {card.method} at {card.size[0]} x {card.size[1]}"
    print_table(fitted(COLUMNS, lambda some: [listed(some, card.rows, title)], terminal_width(), 4)[0])
    for sentence in in_words(card):
        print(printable(sentence))
    for path in given.output:
        if path.suffix == ".json":
            write_json(path, asdict(card) | {"exact": card.right}, indent=1)
        else:
            write_text(path, as_markdown(card))
        print(printable(path))
    return 0 if grade.whole else INTERRUPTED


def _in_a_process_of_its_own(file: Path, line: list[str]) -> int:
    """Grade in a process that a kernel may crash; raises ValueError, in one line, if one does."""
    paths = os.pathsep.join(dict.fromkeys([*filter(None, sys.path), str(Path(__file__).parents[2])]))
    before = signal.signal(signal.SIGINT, lambda *_: None)  # Ctrl-C is for that process
    try:
        command = [sys.executable, "-P", "-m", "viewer", "grade", *line]
        code = subprocess.run(command, env=os.environ | {"PYTHONPATH": paths, OWN: "1"}).returncode
    finally:
        signal.signal(signal.SIGINT, before)
    if code not in (0, FAILED, MISUSED, INTERRUPTED):
        name = signal.Signals(-code).name if code < 0 else f"code {code:#x}"
        raise ValueError(f"{file}: a kernel has crashed ({name}); nothing checks that it stays within its arrays")
    return code
