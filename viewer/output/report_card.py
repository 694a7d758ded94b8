"""The report card of a method as columns, in words, and as Markdown."""

from __future__ import annotations

from tracer.experiments.grade import PROVES, Card, Row
from tracer.method import Method
from tracer.util.text import saved
from viewer.output.reports import Column
from viewer.util.numbers import memory, percent, several

LONGEST = 60
"""Lines of a scene that a card in Markdown shows; JSON has longer ones, too."""
Line = tuple[str, Row]


COLUMNS: tuple[Column[Line], ...] = (
    Column("what changes", "what changes while all else stands still", lambda line: line[0], text=True),
    Column("wrong answers", "wrong answers (of the shadow rays due)",
           lambda line: f"{line[1].wrong:,} ({percent(line[1].wrong, line[1].due)})" if line[1].wrong else "none"),
    Column("other pixels", "pixels of another colour than by none, in both trees",
           lambda line: f"{line[1].differing:,}" if line[1].differing else "none"),
    Column("steps saved", "traversal steps of shadow rays saved, in the kd-tree",
           lambda line: saved(line[1].saved("steps"))),
    Column("tests saved", "intersection tests of shadow rays saved, in the kd-tree",
           lambda line: saved(line[1].saved("tests"))),
    Column("time", "times as long as by none, in the fast tree on one thread",
           lambda line: "{:.2f} ± {:.2f}".format(*line[1].time)),
    Column("frames", "frames of each tree", lambda line: f"{line[1].frames}"),
)  # fmt: skip


def lines(card: Card) -> list[Line]:
    """The lines of the table, the sum of all last."""
    return [*card.rows.items(), ("all", card.total)]


def verdict(card: Card) -> str:
    """Say in a sentence whether the method is right, and whether that is what it claims."""
    total, claims = card.total, card.claims_exact
    if total.right:
        known = "as it claims" if claims else "though it does not claim to be"
        return f"Exact, {known}: all of {several(total.due, 'shadow answer')} are right."
    unit = "pixel" if Method.parse(card.method).clusters else "answer"
    what = f"{several(total.wrong, f'wrong {unit}')}, {several(total.differing, 'pixel')} of another colour"
    never = " or ".join(change for change, row in card.rows.items() if row.right)
    said = "Wrong, though it claims to be exact" if claims else "Not exact, as it says"
    return f"{said}: {what}{f'; none while {never}' if never else ''}."


def in_words(card: Card) -> list[str]:
    """Say in a sentence each what the table does not."""
    total, said = card.total, [verdict(card)]
    if total.answers:
        proven = f"prove {percent(total.proven, total.answers)} of its answers at first hits"
        said.append(f"Certificates of `{PROVES}` {proven}, and refute {total.refuted or 'none'}.")
    pictures, counters = "the same pictures", "the same counters"
    if card.other_pictures:
        pictures = f"other pictures in {card.other_pictures} of {card.threaded} frames"
    if card.other_counters:
        measured = " (it goes by measured times)" if Method.parse(card.method).adaptive else ""
        counters = f"other counters{measured}: {', '.join(card.other_counters)}"
    said.append(f"{card.threads} threads make {pictures} as one, and {counters}.")
    said.append(
        f"It holds {memory(card.memory_bytes)} at most." if card.memory_bytes else "It holds no memory of its own."
    )
    if worst := card.worst:
        enough = f"Of {worst.first}, {worst.left} are enough to show one as wrong: " if worst.left else ""
        said.append(f"The worst wrong pixel: {worst.where}. {enough}{worst.words}")
    return said if card.whole else [*said, "The card is not whole: it was cancelled."]


def as_markdown(card: Card) -> str:
    """Return the card as Markdown."""
    scenes = f"{', '.join(card.scenes)} at {card.size[0]} × {card.size[1]}"
    written = [f"## Report card: `{card.method}`", "", f"Graded in {scenes}.", ""]
    written += [f"| {' | '.join(column.heading for column in COLUMNS)} |", "|---" + "|---:" * (len(COLUMNS) - 1) + "|"]
    written += [f"| {' | '.join(column.cell(line) for column in COLUMNS)} |" for line in lines(card)]
    written += ["", *(f"- {sentence}" for sentence in in_words(card))]
    if card.worst and 0 < card.worst.scene.count("\n") <= LONGEST:
        written += ["", "What is left of the scene, as AFF:", "", "```", *card.worst.scene.splitlines(), "```"]
    return "\n".join(written) + "\n"
