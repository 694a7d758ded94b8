"""A short run of the checks of bounds, a longer one by `make test-all`: `make bounds` goes on as long as one likes."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.fuzz.bounds import CASES, SETTLED
from tests.platforms import linux_only
from tests.sweeps import cases

ROOT = Path(__file__).resolve().parents[2]
PAST = """
import sys
import numpy as np
from tests.fuzz.guarded import MEMORY
from tracer.runtime.kernels import kernel
from tracer.simd import address_of, load_f32x16, store

@kernel
def copy(a, out, first):
    store(address_of(out), load_f32x16(address_of(a) + 4 * first))

with MEMORY.used(at_end=sys.argv[1] == "end"):
    a, out = np.ones(64, np.float32), np.zeros(16, np.float32)
copy(a, out, 48)
assert out.all()
print("inside", flush=True)
copy(a, out, int(sys.argv[2]))
print("outside")
"""


@linux_only
@pytest.mark.parametrize("side", cases([("end", "50")], [("end", "50"), ("beginning", "-2")]))
def test_who_reads_past_an_array_by_address_is_stopped(side: tuple[str, str]) -> None:
    done = subprocess.run([sys.executable, "-c", PAST, *side], cwd=ROOT, capture_output=True, text=True)
    assert done.stdout == "inside\n" and done.returncode < 0, done.stderr


@linux_only
def test_kernels_stay_inside_their_arrays() -> None:
    """Compiled as usual, on guarded arrays; a process of its own, which a fault ends."""
    many = cases(1, 32) * len(CASES)
    command = [sys.executable, "-m", "tests.fuzz.bounds", "--from", "0", "--until", str(time.time() + 500)]
    done = subprocess.run([*command, "--count", str(many)], cwd=ROOT, env=os.environ, capture_output=True, text=True)
    assert done.returncode == 0, (done.stdout[-1000:], done.stderr[-3000:])
    assert done.stdout.split().count(SETTLED) == many
