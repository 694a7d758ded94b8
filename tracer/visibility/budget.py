"""What proving may take in a frame, and what it has taken."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

# What a worker counts: nodes and leaves visited and primitives tested, in the places of `culling.counters`; proofs
# tried.
STEPS, TESTS, CERTIFICATES = range(3)
COUNTERS = 3


class Budget(NamedTuple):
    """What certifying may take in a frame.

    Attributes:
        certificates: how many, each of a cell and a light.
        seconds: how long; inf for counters that repeat exactly.
    """

    certificates: float = np.inf
    seconds: float = np.inf


class Counts(NamedTuple):
    """What certifying took: nodes and leaves visited, primitives classified, certificates made."""

    steps: int = 0
    tests: int = 0
    certificates: int = 0
