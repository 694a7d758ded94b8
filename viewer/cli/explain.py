"""The command `explain`: why the shadow rays of one pixel were culled or traced, and what became of all its rays."""

from __future__ import annotations

import json
import math
from argparse import Namespace
from dataclasses import replace
from typing import Any

from rich.console import Console
from rich.text import Text
from rich.tree import Tree

from tracer.experiments.hunt import History
from tracer.experiments.warmup_frames import WarmupFrame
from tracer.inspect.paper_steps import PaperSteps, in_words, paper_steps, text
from tracer.inspect.path_records import VERDICTS, PathRay, RayTree, ShadowRays
from tracer.inspect.reasons import Why
from tracer.inspect.why import why
from tracer.inspect.why_in_words import Words, plain, primitive_in_words
from tracer.method import Method
from tracer.renderer import Renderer
from tracer.scene.lights import named_light
from tracer.scene.load import check_scene_file
from tracer.scene.model import Scene
from tracer.util.text import printable
from viewer.cli import options
from viewer.cli.arguments import Parser, count
from viewer.cli.console import Work, working
from viewer.output.ray_rows import RayFilter, RayRow, RayRows, RaySubset, totals
from viewer.services.inspector import with_origins

MOST_LIGHTS = 3  # that are named before a sentence that they share; of more, the number is said
EPILOG = """\
examples:
  shadowcull explain default --pixel 200,300
  shadowcull explain kitchen.aff --frame 50 --warmup 10 --pixel 256,400 --only wrong
  shadowcull explain default --pixel 200,300 --method certified
  shadowcull explain default --pixel 200,300 --accelerator kdtree --json
  shadowcull explain default --pixel 200,300 --steps

The tree has the pixel's primary, reflected and refracted rays, and below each the shadow rays from where it ends: not
due, culled and by what, passed over, or traced, with the steps and tests of the ray alone and what blocks it. Culling
uses what earlier frames have shown: --warmup N first traces the N frames before, and --repeat N the frame itself.
--steps prints the paper's text as it runs for the pixel instead, in each of these frames and in the frame itself.
"""


def parser() -> Parser:
    description = "Say what became of each ray of a pixel: which shadow rays were due, culled or traced, and why."
    parser = Parser("explain", description, EPILOG + options.method_summaries())
    add = parser.add_argument
    options.add_pixel(parser)
    add("--only", choices=list(RaySubset), default="all", help="which shadow rays are listed (default: all)")
    add("--light", type=count(0, 2**31 - 1), metavar="N", help="only shadow rays to this light")
    instead = parser.add_mutually_exclusive_group()
    instead.add_argument("--steps", action="store_true", help="run the paper's text for the pixel, line by line")
    instead.add_argument("--json", action="store_true", help="all rays as JSON on standard output")
    options.add_tracing(parser)
    return parser


def run(given: Namespace) -> int:
    """Trace a frame, and print the reasons and the tree of a pixel's rays; raises SceneError and ValueError in one
    line, or Cancelled."""
    check_scene_file(given.path)
    settings, (x, y) = options.pixel_settings(given), given.pixel
    if given.steps:
        settings = replace(settings, modes=not Method.parse(settings.method).clusters)
    with working() as work:
        scene = options.read_scene(given.path, given, work)
        light = None if given.light is None else options.light_index(given, "--light ", given.light, scene)
        time = options.moment(scene, given)
        frames = [*options.frames_before(scene, given, work), WarmupFrame(time, given.camera)]
        options.prepare_kernels(work, len(scene.lights), given.accelerator, settings.method)
        renderer = Renderer(scene, settings, work.progress)
        if given.steps:
            each = options.traced(renderer, frames, work)
            stepped = [paper_steps(renderer, frame, x, y, work.cancelled) for frame in each]
        else:
            found = _why(renderer, frames, x, y, work)
    width, height = given.size
    title = f"{given.path.name}, {time:.3f} s, pixel {x},{y} of {width} × {height}, method {settings.method}"
    if given.steps:
        for number, steps in enumerate(stepped, 1):
            print(printable(f"{title}, frame {number} of {len(stepped)}, by tracer/reference.py"))
            print(*map(printable, steps_lines(steps, scene, light)), sep="\n")
        return 0
    tree = found.tree
    assert tree is not None
    if given.json:
        print(json.dumps(ray_data(tree, scene) | {"why": why_data(found, scene)}, indent=2))
    else:
        _print(found, tree, scene, RayFilter(RaySubset(given.only), light), title)
    return 0


def _why(renderer: Renderer, frames: list[WarmupFrame], x: int, y: int, work: Work) -> Why:
    """Trace frames, and find out about a pixel of the last one, with which of those before gave it its modes."""
    history, before = History(renderer.scene), len(frames) - 1
    for number, frame in enumerate(options.traced(renderer, frames, work)):
        if number < before:
            history.add(frame, frames[number])
    found = why(renderer, frame, x, y, work.cancelled)
    keeps_modes = found.primitive >= 0 and frame.settings.keeps_modes
    origins = history.origins.of(int(frame.unit[y, x])) if keeps_modes else None

    def name(number: int) -> str:
        return "the frame before" if before == 1 else f"frame {number + 1} of the {before} frames before this"

    return found if origins is None else with_origins(found, origins, name)


def _print(found: Why, tree: RayTree, scene: Scene, shown: RayFilter, title: str) -> None:
    console = Console()
    if not console.is_terminal:
        console = Console(width=100_000, soft_wrap=True)  # a line for each row, whatever reads it
    console.print(Text(printable(title), "bold"))
    for line in why_lines(found, scene, shown.light):
        console.print(Text(printable(line)))
    said = [totals(tree)]
    if shown != RayFilter():
        of = "" if shown.light is None else f" of {named_light(scene.lights, shown.light)}"
        said.append(f"shadow rays shown: {shown.shown.value}{of}")
    drawn = Tree(Text("\n".join(said), "bold"), guide_style="dim")
    for row in RayRows(tree, scene, shown).top:
        _add(drawn, row)
    console.print(drawn, markup=False, highlight=False)
    if tree.frame.statistics.decision:
        console.print(Text(tree.frame.statistics.decision, "italic"))


def _add(tree: Tree, row: RayRow) -> None:
    """Add a row, and those below it, but for the single samples and lights of many with the same fate."""
    red, green, blue = (round(255 * channel) for channel in row.color)
    below = tree.add(Text(printable(row.text), f"rgb({red},{green},{blue})" if len(row.places) else "bold"))
    if "fate" in row.key:
        return
    for one in row.rows:
        _add(below, one)


# --- the reasons and steps as text, and all as JSON ----------------------------------------------------


def steps_lines(found: PaperSteps, scene: Scene, light: int | None = None) -> list[str]:
    """Return a line for each step, below what it runs for: its number in the module, its text and its values; then the
    modes that are left.  `light` leaves out shadow rays to others."""
    lines, of = [found.remark] if found.remark else [], ("", "")
    for step in found.steps:
        if light is not None and step.part.light not in (-1, light):
            continue
        if of != (of := (found.heading(step, scene), step.note)):
            lines.append(of[0])
        values = " ".join(filter(None, (step.note, ", ".join(map(str, step.values)))))
        lines.append(f"{step.line:5} {text()[step.line]:72}  {values}".rstrip())
    lines.append("Modes that this leaves:" if found.modes else "Nothing is seen here, so that no mode is set.")
    for primitive, (occlusion, shadow) in found.modes.items():
        told = [f"{named_light(scene.lights, k)} {in_words('shadow', mode)}" for k, mode in enumerate(shadow)]
        told = told if light is None else told[light : light + 1]
        lines.append(f"  {primitive_in_words(scene, primitive)}: {'; '.join([in_words('mode', occlusion), *told])}")
    return lines


def why_lines(found: Why, scene: Scene, light: int | None = None) -> list[str]:
    """Return a line for each sentence: why the rays to the lights, or to one of them, were culled or traced, with the
    lights that share it; how the primitive stands; and its comparison with the two reference pixels."""
    if found.primitive < 0:
        return ["Nothing is seen here but the background."]
    words, lines = Words(scene, found), []
    shared: dict[str, list[int]] = {}
    for one in found.reasons:
        if light is None or one.light == light:
            sentence = " ".join(filter(None, (plain(words.reason(one)), plain(words.answer(one)))))
            shared.setdefault(sentence, []).append(one.light)
    for sentence, lights in shared.items():
        named = ", ".join(named_light(scene.lights, number) for number in lights[:MOST_LIGHTS])
        more = f" and {len(lights) - MOST_LIGHTS} more" if len(lights) > MOST_LIGHTS else ""
        lines.append(f"{named}{more}: {sentence}")
    if found.coverage is not None:
        lines.append(plain(words.coverage(found.coverage)))
    lines += [plain(words.reference(one)) for one in found.references]
    return lines


def why_data(found: Why, scene: Scene) -> list[dict[str, Any]]:
    """Return the reasons as data for JSON, each with its sentence."""
    words = Words(scene, found)
    return [
        {
            "light": one.light, "rule": one.rule.name, "section": one.rule.section or None, "fate": one.fate.name,
            "sentence": plain(words.reason(one)), "answer": plain(words.answer(one)) or None,
        }
        for one in found.reasons
    ]  # fmt: skip


def ray_data(tree: RayTree, scene: Scene) -> dict[str, Any]:
    """Return the pixel, how it was rendered, and its rays with all shadow rays that are due, as data for JSON."""
    frame, settings = tree.frame, tree.frame.settings
    return {
        "pixel": [tree.x, tree.y], "size": [frame.width, frame.height], "time": frame.time,
        "method": settings.method, "accelerator": settings.accelerator, "color": _numbers(tree.color),
        "due": tree.due, "traced": tree.traced,
        "verdicts": {verdict.value: number for verdict, number in tree.counts.items()},
        "rays": [_ray(tree, ray, scene) for ray in tree.rays],
    }  # fmt: skip


def _ray(tree: RayTree, ray: PathRay, scene: Scene) -> dict[str, Any]:
    s, hit = ray.shadows, None
    due = [] if s is None else [place for place, number in enumerate(s.verdict) if VERDICTS[number].due]
    if s is not None:
        hit = {"t": ray.t, **_primitive(ray.primitive, scene), "point": _numbers(ray.point)}
    data = {
        "ray": ray.number, "parent": ray.parent if ray.parent >= 0 else None,
        "kind": ray.kind.value, "bounce": ray.bounce,
        "origin": _numbers(ray.origin), "direction": _numbers(ray.direction),
        "weight": _numbers(ray.weight), "light": _numbers(ray.light),
        "traversal_steps": ray.steps, "intersection_tests": ray.tests,
        "hit": hit, "shadow_rays": [_shadow_ray(tree, s, place, scene) for place in due if s is not None],
    }  # fmt: skip
    return data if s is None else data | {"facing_away": len(s.light) - len(due)}


def _shadow_ray(tree: RayTree, s: ShadowRays, place: int, scene: Scene) -> dict[str, Any]:
    light, blocker, met, reason = int(s.light[place]), int(s.blocker[place]), int(s.met[place]), s.reason(place)
    return {
        "light": light, "sample": place - s.of_light(light).start, "position": _numbers(tree.samples[place]),
        "verdict": VERDICTS[s.verdict[place]].value, "lit": bool(s.lit[place]), "wrong": bool(s.wrong[place]),
        "blocker": {**_primitive(blocker, scene), "t": float(s.blocked_at[place])} if blocker >= 0 else None,
        "met": met if met >= 0 else None, "moving_objects_asked": bool(s.asked_moving[place]),
        "traversal_steps": int(s.steps[place]), "intersection_tests": int(s.tests[place]),
        "names": list(reason.named), "known": reason.known or None, "told": reason.told or None,
    }  # fmt: skip


def _primitive(number: int, scene: Scene) -> dict[str, Any]:
    return {"primitive": number, "object": scene.name_of(number)}


def _numbers(values: Any) -> list[float | None]:
    """Three numbers; JSON has none that are not finite."""
    return [float(x) if math.isfinite(x) else None for x in values]
