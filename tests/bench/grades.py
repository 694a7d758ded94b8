"""Report cards of all methods, a line each, as `shadowcull grade` makes them: in a small setting, within some minutes.

make grades                       all methods that a scene of few lights is worth
make grades ARGS="--write"        into the page of methods, docs/methods.md
make grades ARGS="paper cells"    these alone
"""

from __future__ import annotations

import argparse
import sys
from statistics import mean

from tests.bench.methods import PAGE
from tracer.experiments.grade import Card, Grade
from tracer.experiments.trials import CHANGES
from tracer.method import bases
from tracer.scene.load import load_scene
from tracer.settings import Settings
from tracer.util.text import saved
from viewer.cli.grade import STANDARD
from viewer.output.report_card import verdict
from viewer.util.numbers import memory
from viewer.util.resources import DEFAULT_SCENE, scene_path

BEGIN, END = "<!-- graded by make grades -->\n", "<!-- end of what is graded -->\n"
HEADINGS = ("method", *CHANGES, "steps", "tests", "time", "memory", "threads")
SETTINGS, FRAMES = Settings(width=96, height=64, depth=2), 4


def line(card: Card) -> tuple[str, ...]:
    """The card in a line: wrong answers for each kind of change, then what it costs."""
    wrong = []
    for change in CHANGES:
        rows = [row for row in card.rows if row.change == change]
        share = sum(row.counted.wrong for row in rows) / sum(row.due for row in rows)
        wrong.append("" if all(row.right for row in rows) else f"{share:.3%}")
    large = [row for row in card.rows if row.scene == DEFAULT_SCENE]  # in the other scenes there is nothing to save
    steps, tests = mean(row.counted.average_steps for row in large), mean(row.counted.average_tests for row in large)
    seconds = sum(row.timed.path_seconds for row in large)
    time = seconds / sum(row.timed.path_seconds * row.timed.speed_up for row in large)
    held = max(row.timed.memory_bytes for row in large)
    threads = "other pictures" if card.other_pictures else "other counters" if card.other_counters else "the same"
    return f"`{card.method}`", *wrong, saved(steps), saved(tests), f"{time:.2f}", memory(held) if held else "", threads


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("methods", nargs="*", metavar="METHOD", help="default: all that are worth it")
    parser.add_argument("--write", action="store_true", help="write the table into docs/methods.md")
    options = parser.parse_args()
    scenes = [(load_scene(scene_path(name)), first) for name, first in STANDARD.items()]
    most = max(len(scene.lights) for scene, _ in scenes)
    methods = options.methods or [kind.name for kind in bases(measures=True) if kind.fits(most)]
    table = [f"| {' | '.join(HEADINGS)} |", "|---" + "|---:" * (len(HEADINGS) - 1) + "|"]
    lies = 0
    for method in methods:
        *_, card = Grade(method, scenes, SETTINGS, FRAMES, shrinks=False).each()
        table.append(f"| {' | '.join(line(card))} |")
        print(f"{method}: {verdict(card)}", flush=True)
        lies += card.claims_exact and not card.right
    print("\n".join(table))
    if options.write:
        before, _, rest = PAGE.read_text().partition(BEGIN)
        PAGE.write_text(before + BEGIN + "\n" + "\n".join(table) + "\n\n" + END + rest.partition(END)[2])
    return 1 if lies else 0


if __name__ == "__main__":
    sys.exit(main())
