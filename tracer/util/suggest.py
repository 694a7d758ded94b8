"""What somebody may have meant by a name that there is not."""

from __future__ import annotations

import os
from collections.abc import Iterable
from itertools import islice
from pathlib import Path

_MOST_FILES = 10_000  # of a folder that are looked at


def similar(word: str, known: Iterable[str], least: float = 0.6) -> str:
    """The one of the known names that a word is most like; "" where it is like none, of 1 by less than `least`."""
    import difflib  # only where something is wrong

    names = {name.lower(): name for name in known}
    close = difflib.get_close_matches(word.lower(), list(names), n=1, cutoff=least)
    return names[close[0]] if close else ""


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """A question for the end of a message: ": did you mean 'paper'?"; "" where nothing is like it."""
    found = similar(word, known)
    return f": did you mean '{found}'?" if found else ""


def did_you_mean_file(path: Path) -> str:
    """The same for a file that is missing, of those of its kind that lie in its folder; else what to do."""
    beside = path.parent
    try:
        with os.scandir(beside) as entries:
            names = [entry.name for entry in islice(entries, _MOST_FILES)]
    except OSError:
        names = []
    stems = {Path(name).stem: name for name in names if Path(name).suffix.lower() == path.suffix.lower()}
    found = similar(path.stem, stems)  # the ending, which all have, would make them alike
    return f": did you mean '{beside / stems[found]}'?" if found else "; check the path"
