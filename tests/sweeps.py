"""How many cases sweeps try: some in every run, many more by `make test-all`; always the same ones."""

from __future__ import annotations

import os
from typing import TypeVar

ALL = os.environ.get("SHADOWCULL_TESTS") == "all"
MORE = 8  # times as many examples of random scenes

T = TypeVar("T")


def cases(usual: T, in_all: T) -> T:
    return in_all if ALL else usual


def examples(usual: int) -> int:
    return cases(usual, MORE * usual)
