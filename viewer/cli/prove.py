"""The command `prove`: what is certified of a frame's cells, as proofs that anybody can check."""

from __future__ import annotations

import json
from argparse import Namespace
from dataclasses import replace
from pathlib import Path

import numpy as np

from tracer.experiments.warmup_frames import WarmupFrame
from tracer.methods.certified import CertifiedCells
from tracer.neighbours.certified.proofs import as_json
from tracer.renderer import Renderer
from tracer.scene.load import check_scene_file
from tracer.util.version import program_version
from viewer.cli import arguments, options
from viewer.cli.arguments import Parser
from viewer.cli.console import working
from viewer.util.files import check_writable, write_text
from viewer.util.numbers import several

METHOD = "certified"
EPILOG = """\
examples:
  shadowcull prove figure3 -o proofs.json --size 64x48
  shadowcull prove kitchen.aff -o proofs.json --frame 50 --warmup 20 --size 256x256
  shadowcull check-proofs proofs.json

The file has, as JSON, the lights, all that is static, the prisms of the cells that the frame shows, and for each cell
and light that is certified the verdict and the triangles that it rests on; every number exactly as it was used.
"""


def parser() -> Parser:
    description = "Trace a frame by certified cells, and write what is certified of it as proofs."
    parser = Parser("prove", description, EPILOG)
    options.add_scene(parser)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FILE", help="the proofs, as JSON")
    options.add_moment(parser)
    options.add_size(parser)
    help_ = f"another camera: {options.CAMERA}"
    parser.add_argument("--camera", type=arguments.camera, metavar="JSON", help=help_)
    options.add_history(parser)
    options.add_tracing(parser)
    parser.set_defaults(repeat=0)
    return parser


def run(given: Namespace) -> int:
    """Trace, and write; raises SceneError, ValueError and OSError, each in one line, or Cancelled."""
    check_scene_file(given.path)
    check_writable(given.output)
    settings = replace(options.tracing_settings(given), method=METHOD)
    with working() as work:
        scene = options.read_scene(given.path, given, work)
        time, before = options.moment(scene, given), options.frames_before(scene, given, work)
        options.prepare_kernels(work, len(scene.lights), given.accelerator, METHOD)
        renderer = Renderer(scene, settings, work.progress)
        for frame in options.traced(renderer, [*before, WarmupFrame(time, given.camera)], work):  # noqa: B007
            pass
        method = renderer.state.method(METHOD)
        if not isinstance(method, CertifiedCells) or method.store is None or frame.cells is None:
            raise ValueError(f"{given.path.name}: there are no cells; prove takes scenes of up to 31 lights")
        if not method.store.certified.any():
            raise ValueError(f"{given.path.name}: nothing is certified, as no light is a point that stands still")
        work.progress("writing the proofs", 1.0)
        seen = np.unique(frame.cells[frame.cells > 0]).tolist()
        proofs = as_json(method.store, seen, len(renderer.world.primitives.triangles))
    if not proofs["proofs"]:
        raise ValueError(f"{given.path.name}: nothing is certified of what is seen; trace frames before (--warmup N)")
    about = {"made_by": f"shadowcull {program_version()}", "scene": given.path.name, "time": time}
    write_text(given.output, json.dumps(about | proofs) + "\n")
    full = sum(proof["verdict"] == "full" for proof in proofs["proofs"])
    cells, lit = several(len(proofs["cells"]), "cell"), len(proofs["proofs"]) - full
    print(f"{given.output}: {cells}, {full:,} times hidden, {lit:,} times lit")
    return 0
