"""Texts as people and shells read them."""

from __future__ import annotations

import os

from tests.commands import shell_words
from tests.platforms import posix_only
from tracer.util.text import shell_line, wrapped


@posix_only
def test_words_for_a_shell_come_back_and_command_no_terminal() -> None:
    words = ["plain", "", "it's", "a\\b", "\x1b]0;title\x07", "line\nnext\u202e'", os.fsdecode(b"caf\xe9.aff"), "日本"]
    line = shell_line(words)
    assert line.isprintable()
    assert shell_words(line) == words


def test_a_word_of_any_length_is_broken_without_measuring_it_letter_by_letter() -> None:
    measured: list[str] = []

    def measure(text: str) -> float:
        measured.append(text)
        return 7.0 * len(text)

    lines = wrapped(f"before {'W' * 10_000} after", measure, 100.0)
    assert lines[0] == "before" and set(lines[1:-1]) == {14 * "W"} and lines[-1] == f"{10_000 % 14 * 'W'} after"
    assert sum(map(len, measured)) < 20 * 10_000
