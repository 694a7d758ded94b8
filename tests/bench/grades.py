"""Report cards of all methods, a line each, as `shadowcull grade` makes them: in a small setting, in two minutes.

make grades                       all methods that a scene of few lights is worth
make grades ARGS="--write"        into the page of methods, docs/methods.md
make grades ARGS="paper cells"    these alone
"""

from __future__ import annotations

import argparse
import sys

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
from viewer.util.resources import scene_path

BEGIN, END = "<!-- graded by make grades -->\n", "<!-- end of what is graded -->\n"
HEADINGS = ("method", *CHANGES, "steps", "tests", "time", "memory", "threads")
SETTINGS = Settings(width=144, height=96, depth=2)


def line(card: Card) -> tuple[str, ...]:
    """The card in a line: wrong answers for each kind of change, then what it costs."""
    total = card.total
    rows = [card.rows[change] for change in CHANGES]
    wrong = ("" if row.right else f"{row.wrong / row.due:.3%}" if row.wrong else f"{row.differing} px" for row in rows)
    threads = "others" if card.other_pictures else "other counters" if card.other_counters else "same"
    costs = saved(total.saved("steps")), saved(total.saved("tests")), f"{total.time[0]:.2f}"
    return f"`{card.method}`", *wrong, *costs, memory(card.memory_bytes) if card.memory_bytes else "", threads


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
        *_, card = Grade(method, scenes, SETTINGS, shrinks=False).each()
        table.append(f"| {' | '.join(line(card))} |")
        print(f"{method}: {verdict(card)}", flush=True)
        lies += card.claims_exact and not card.total.right
    print("\n".join(table))
    if options.write:
        before, _, rest = PAGE.read_text().partition(BEGIN)
        PAGE.write_text(before + BEGIN + "\n" + "\n".join(table) + "\n\n" + END + rest.partition(END)[2])
    return 1 if lies else 0


if __name__ == "__main__":
    sys.exit(main())
