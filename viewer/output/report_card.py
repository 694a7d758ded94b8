"""The report card of a method as columns, in words, and as Markdown."""

from __future__ import annotations

from tracer.experiments.grade import PROVES, Card, Row
from tracer.method import Method
from tracer.util.text import saved
from viewer.output.reports import SPEED_UP, WRONG, Column
from viewer.util.numbers import memory, percent, several

COLUMNS: tuple[Column[Row], ...] = (
    Column("scene", "where", lambda row: row.scene, text=True),
    Column("what changes", "while all else stands still", lambda row: row.change, text=True),
    Column("wrong answers", WRONG.meaning,
           lambda row: WRONG.cell(row.counted) if row.counted.wrong else "none"),
    Column("other pixels", "pixels of another colour than by none, in both trees",
           lambda row: f"{row.differing:,}" if row.differing else "none"),
    Column("steps saved", "traversal steps saved, in the kd-tree", lambda row: saved(row.counted.average_steps)),
    Column("tests saved", "intersection tests saved, there", lambda row: saved(row.counted.average_tests)),
    Column("speed-up", "over none, frame by frame in turn, in the fast tree on one thread",
           lambda row: SPEED_UP.cell(row.timed)),
    Column("memory", "what the method held at most, besides modes",
           lambda row: memory(row.timed.memory_bytes) if row.timed.memory_bytes else "none"),
)  # fmt: skip


def verdict(card: Card) -> str:
    """Say in a sentence whether the method is right, and whether that is what it claims."""
    if card.right:
        claims = "as it claims to be exact" if card.claims_exact else "though it does not claim to be exact"
        answers = several(sum(row.due for row in card.rows), "shadow answer")
        return f"Nothing wrong was found, {claims}: all of {answers} are right."
    said = "Wrong, though it claims to be exact" if card.claims_exact else "Not exact, as it says"
    unit = "wrong pixel" if Method.parse(card.method).clusters else "wrong answer"
    wrong, differing = sum(row.counted.wrong for row in card.rows), sum(row.differing for row in card.rows)
    found = ((wrong, unit), (differing, "other pixel"), (card.other_pictures, "other picture"))
    changes = dict.fromkeys(row.change for row in card.rows)
    right = [change for change in changes if all(row.right for row in card.rows if row.change == change)]
    never = f"; none while {' or '.join(right)}" if right else ""
    many = f" by {card.threads} threads" if card.other_pictures else ""
    return f"{said}: {', '.join(several(count, name) for count, name in found if count)}{many}{never}."


def in_words(card: Card) -> list[str]:
    """Say in a sentence each what the table does not."""
    said = [verdict(card)]
    counts = ((row.answers, row.proved, row.refuted) for row in card.rows)
    answers, proved, refuted = map(sum, zip(*counts, strict=True))
    if answers:
        share = f"prove {percent(proved, answers)} of its answers at first hits"
        said.append(f"Certificates of {PROVES} {share}, and refute {f'{refuted:,}' if refuted else 'none'}.")
    if card.other_counters:
        measured = " (it goes by measured times)" if Method.parse(card.method).adaptive else ""
        said.append(f"With {card.threads} threads, these counters differ{measured}: {', '.join(card.other_counters)}.")
    elif not card.other_pictures:
        said.append(f"Pictures and counters are the same with {card.threads} threads as with one.")
    if worst := card.worst:
        enough = f"It was shrunk from {worst.first} to {worst.left}. " if worst.left else ""
        said.append(f"The worst wrong pixel: {worst.where}. {enough}{worst.words}")
    return said if card.whole else [*said, "The card is not whole: it was cancelled."]


def as_markdown(card: Card) -> str:
    """Return the card as Markdown."""
    rows = [[column.heading for column in COLUMNS], ["---" if column.text else "---:" for column in COLUMNS]]
    rows += [[column.cell(row) for column in COLUMNS] for row in card.rows]
    written = [f"## Report card: `{card.method}`, {card.size[0]} × {card.size[1]}", ""]
    written += [*(f"| {' | '.join(row)} |" for row in rows), "", *(f"- {sentence}" for sentence in in_words(card))]
    if card.whole and card.worst and card.worst.scene:
        written += ["", "What is left of the scene, as AFF:", "", "```", *card.worst.scene.splitlines(), "```"]
    return "\n".join(written) + "\n"
