"""An AFF file as a list of words, and a cursor that takes typed values from it.

Most of a scene is long runs of numbers, so a file is split at once and runs are converted in
bulk; a word's line is worked out only when a message needs it.  A file that is included fifty
times is split once, and what was read from it can be remembered by position (`AffFile.memo`).
"""

from __future__ import annotations

import os
import re
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.scene.arrays import Float64, vector
from tracer.scene.limits import LARGEST
from tracer.scene.model import SceneError

_COMMENT = re.compile(rb"[#%][^\n]*")
_SPACE = np.zeros(256, np.bool_)
_SPACE[list(b" \t\n\r\x0b\x0c")] = True


def reason(error: Exception) -> str:
    """Why a file could not be read, in a few words."""
    text = getattr(error, "strerror", None) or str(error) or type(error).__name__
    return " ".join(text.split()).lower()


def quoted(word: bytes, limit: int = 40) -> str:
    """A word as it may stand in a one-line message, whatever its bytes."""
    text = ascii(os.fsdecode(word))
    return text if len(text) <= limit else text[: limit - 3] + "..."


class AffFile:
    """The words of one file.  Braces are words of their own; comments are gone."""

    def __init__(self, path: Path, data: bytes) -> None:
        """What was read from the file."""
        self.path = path
        text = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
        if b"#" in text or b"%" in text:
            text = _COMMENT.sub(b"", text)
        self._text = text.replace(b"{", b" { ").replace(b"}", b" } ")
        self.words = self._text.split()
        self.memo: dict[int, tuple[Any, int]] = {}

    @cached_property
    def _lines(self) -> NDArray[np.intp]:
        """The line of each word, from 1."""
        characters = np.frombuffer(self._text, np.uint8)
        space = np.concatenate([[True], _SPACE[characters]])
        starts = np.flatnonzero(space[:-1] & ~space[1:])
        return np.searchsorted(np.flatnonzero(characters == ord("\n")), starts) + 1

    def line(self, index: int) -> int:
        """Line of a word, from 1; past the end, that of the last word."""
        return int(self._lines[min(index, len(self._lines) - 1)]) if len(self._lines) else 1

    def place(self, index: int) -> str:
        """`file:line` of a word."""
        return f"{self.path}:{self.line(index)}"


class Cursor:
    """Takes words, numbers and names from a file, one after another; every error is a SceneError."""

    def __init__(self, file: AffFile) -> None:
        self.file = file
        self.position = 0

    @property
    def at_end(self) -> bool:
        return self.position >= len(self.file.words)

    def error(self, what: str, index: int | None = None) -> SceneError:
        """An error at a word; by default at the word last taken."""
        return SceneError(f"{self.file.place(max(self.position - 1, 0) if index is None else index)}: {what}")

    def peek(self) -> bytes:
        return b"" if self.at_end else self.file.words[self.position]

    def at_number(self) -> bool:
        return self.peek()[:1] in (b"-", b"+", b".", *(b"%d" % i for i in range(10)))

    def word(self, what: str) -> bytes:
        if self.at_end:
            raise self.error(f"the file ends where {what} should follow; complete the file")
        self.position += 1
        return self.file.words[self.position - 1]

    def name(self, what: str) -> str:
        """A word that names something: a file, a track, a light."""
        word = self.word(what)
        if word in (b"{", b"}"):
            raise self.error(f"{quoted(word)} where {what} should stand; put it before the brace")
        return os.fsdecode(word)

    def expect(self, word: bytes, what: str) -> None:
        found = self.word(f"{quoted(word)} {what}")
        if found != word:
            raise self.error(f"{quoted(found)} where {quoted(word)} {what} should stand; insert it")

    def _take(self, count: int, what: str) -> list[bytes]:
        words = self.file.words[self.position : self.position + count]
        if len(words) < count:
            missing = f"{count - len(words)} of {count} numbers"
            raise self.error(f"the file ends within {what}, {missing} are missing; complete the file", self.position)
        self.position += count
        return words

    def numbers(self, count: int, what: str, finite: bool = True) -> Float64:
        """(count,) float64.  What is not finite or beyond LARGEST is an error unless the caller deals with it."""
        words = self._take(count, what)
        try:
            values = np.array(list(map(float, words)), np.float64)
        except ValueError:
            raise self._not_a_number(words, what, float) from None
        if finite and not (good := np.abs(values) <= LARGEST).all():
            bad = int(np.flatnonzero(~good)[0])
            index = self.position - count + bad
            how = (
                f"beyond {LARGEST:g}; write a smaller number"
                if np.isfinite(values[bad])
                else "not finite; write a number"
            )
            raise self.error(f"{quoted(words[bad])} in {what} is {how}", index)
        return values

    def number(self, what: str) -> float:
        return float(self.numbers(1, what)[0])

    def triple(self, what: str) -> tuple[float, float, float]:
        return vector(self.numbers(3, what))

    def indices(self, count: int, what: str) -> NDArray[np.int64]:
        """(count,) int64."""
        words = self._take(count, what)
        try:
            return np.array(list(map(int, words)), np.int64)
        except (ValueError, OverflowError):
            raise self._not_a_number(words, what, _index) from None

    def count(self, what: str, least: int = 0, most: int | None = None) -> int:
        """A number of things, at least `least` and at most `most`."""
        (word,) = self._take(1, f"the number of {what}")
        try:
            count = int(word)
        except ValueError:
            raise self._not_a_number([word], f"the number of {what}", int) from None
        if count < least:
            raise self.error(f"{count} {what}; give at least {least}")
        if most is not None and count > most:
            raise self.error(f"{count} {what}; give at most {most}")
        return count

    def _not_a_number(self, words: list[bytes], what: str, convert: Any) -> SceneError:
        """The error that names the first of the words just taken which does not convert."""
        kind = "number" if convert is float else "whole number"
        for offset, word in enumerate(words):
            try:
                convert(word)
            except (ValueError, OverflowError):
                index = self.position - len(words) + offset
                return self.error(f"{quoted(word)} in {what} is not a {kind}; correct it", index)
        return self.error(f"{what} holds something that is not a {kind}; correct it")


def _index(word: bytes) -> np.int64:
    return np.int64(int(word))
