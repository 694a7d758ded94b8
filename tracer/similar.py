"""What somebody may have meant by a name that there is not."""

from __future__ import annotations

from collections.abc import Iterable


def similar(word: str, known: Iterable[str]) -> str:
    """The one of the known names that a word is most like; "" where it is like none."""
    import difflib  # only where something is wrong

    names = {name.lower(): name for name in known}
    close = difflib.get_close_matches(word.lower(), list(names), n=1)
    return names[close[0]] if close else ""


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """A question for the end of a message: ": did you mean 'paper'?"; "" where nothing is like it."""
    found = similar(word, known)
    return f": did you mean '{found}'?" if found else ""
