"""Which texts a few typed letters mean, best first: as in editors, letters may be left out, and words come in any
order."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import SequenceMatcher
from itertools import pairwise

_EXACT = 25.0  # for a text that is no more than what was typed
_WHOLE, _PREFIX, _INITIALS, _INSIDE, _SCATTERED = 100.0, 80.0, 60.0, 50.0, 20.0
_ALIKE = 0.7  # of a mistyped word, at least


@dataclass(frozen=True)
class Match:
    """How well a text fits, and the places of the letters in it that were typed."""

    score: float
    places: tuple[int, ...] = ()


def match(typed: str, text: str, also: str = "") -> Match | None:
    """How well `text` fits what was typed; words may also be found in `also`, for less.  None if one is in neither."""
    score, places, lower, more = 0.0, set[int](), text.lower(), also.lower()
    for word in typed.lower().split():
        found = _word(word, lower)
        if found is not None:
            score += found.score
            places.update(found.places)
            continue
        elsewhere = _word(word, more)
        if elsewhere is None or elsewhere.score < _INSIDE:
            return None
        score += 0.4 * elsewhere.score
    score += _EXACT if " ".join(typed.lower().split()) == lower else 0.0
    return Match(score - 0.1 * len(text), tuple(sorted(places)))


def nearly(typed: str, text: str) -> float:
    """How much each typed word is like some word of the text, 0 to 1; 0 if one of them is like none."""
    words, least = text.lower().split(), 1.0
    for word in typed.lower().split():
        best = max((SequenceMatcher(None, word, other).ratio() for other in words), default=0.0)
        if best < _ALIKE:
            return 0.0
        least = min(least, best)
    return least


def _word(word: str, text: str) -> Match | None:
    """One word: as it is, at a word's start or inside one, else its letters in their order."""
    best: Match | None = None
    start = text.find(word)
    while start >= 0:
        begins = start == 0 or not text[start - 1].isalnum()
        end = start + len(word)
        whole = begins and (end == len(text) or not text[end].isalnum())
        score = (_WHOLE if whole else _PREFIX if begins else _INSIDE) - 0.05 * start
        if best is None or score > best.score:
            best = Match(score, tuple(range(start, end)))
        start = text.find(word, start + 1)
    if best is not None and best.score > _INITIALS:
        return best
    return max(filter(None, (best, _scattered(word, text))), key=lambda found: found.score, default=None)


def _scattered(word: str, text: str) -> Match | None:
    """Letters in their order, most of them next to each other or at the start of words."""
    starts = [i for i, letter in enumerate(text) if letter == word[0] and (i == 0 or not text[i - 1].isalnum())]
    best: Match | None = None
    for start in starts:
        places, at = [start], start
        for letter in word[1:]:
            initial = next((i for i in range(at + 1, len(text)) if text[i] == letter and not text[i - 1].isalnum()), -1)
            at = at + 1 if text[at + 1 : at + 2] == letter else initial if initial >= 0 else text.find(letter, at + 1)
            if at < 0:
                break
            places.append(at)
        else:
            gaps = sum(b - a > 1 and text[b - 1].isalnum() for a, b in pairwise(places))
            if gaps <= 1:
                initials = len(places) > 1 and all(p == 0 or not text[p - 1].isalnum() for p in places)
                score = (_INITIALS if initials else _SCATTERED) - 6.0 * gaps - 0.05 * start - 0.1 * (places[-1] - start)
                if best is None or score > best.score:
                    best = Match(score, tuple(places))
    return best
