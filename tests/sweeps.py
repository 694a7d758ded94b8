"""How many cases sweeps try: some in every run, many more by `make test-all`; always the same ones."""

from __future__ import annotations

import os
from collections.abc import Sequence
from itertools import product
from typing import Any, TypeVar

from tracer.geometry.accelerators import ACCELERATORS as EVERY_ACCELERATOR
from tracer.geometry.accelerators import BVH8, KD_TREE

ALL = os.environ.get("SHADOWCULL_TESTS") == "all"
MORE = 16  # times as many examples of random scenes

T = TypeVar("T")


def cases(usual: T, in_all: T) -> T:
    return in_all if ALL else usual


# Each structure has its own tests; what all must do is tried with these.
ACCELERATORS = cases((KD_TREE, BVH8), EVERY_ACCELERATOR)


def examples(usual: int) -> int:
    return cases(usual, MORE * usual)


def crossed(*axes: Sequence[Any]) -> list[tuple[Any, ...]]:
    """Arguments of a test along several axes: in every run so many that each value of each axis is met, as what goes
    wrong goes wrong by one of them; all combinations by `make test-all`."""
    most = max(map(len, axes))
    return cases([tuple(axis[i % len(axis)] for axis in axes) for i in range(most)], list(product(*axes)))
