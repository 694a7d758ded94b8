"""Numbers as people read them, in the window and on the command line alike."""

from __future__ import annotations

from tracer.util.text import MOST_PERCENT, saved


def count(number: float) -> str:
    """A number that may be large, in groups: 12,345,678."""
    return f"{int(number):,}"


def percent(part: float, whole: float) -> str:
    """A share with one decimal; one too small for that with two digits, so that it does not look like none."""
    if not whole:
        return "-"
    share = 100.0 * part / whole
    return f"{share:.2g} %" if 0.0 < share < 0.05 else f"{share:.1f} %"


def whole_percent(part: float) -> str:
    """A part of 1 in whole per cents: 38 %."""
    return f"{100.0 * part:.0f} %"


def saved_in_words(part: float) -> str:
    """The same where no heading says that it is about saving: 41.2% saved."""
    return saved(part) if part < -MOST_PERCENT else f"{saved(part)} saved"


def changed(part: float) -> str:
    """By which part some work is more, or less, than other work: +3.1%, −41.2%, or 1,194 × as many."""
    return saved(-part) if part > MOST_PERCENT else f"{part:+.1%}".replace("-", "−")


def several(number: int, name: str, names: str = "") -> str:
    """So many of something: 1 node, 2 nodes."""
    return f"{count(number)} {name if number == 1 else names or name + 's'}"


def memory(size: int) -> str:
    """Return so many bytes as people say it: 850 kB, 12.3 MB."""
    return f"{size / 1e6:.1f} MB" if size >= 1e6 else f"{max(size / 1e3, 0.1):.3g} kB"
