"""The vector library's tests once more, compiled for processors that have less than this one."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from pathlib import Path

import pytest
from llvmlite import binding

from tests.sweeps import ALL

ROOT = Path(__file__).resolve().parents[2]
REPORT = "from numba.core.registry import cpu_target; print(cpu_target.target_context.codegen().magic_tuple()[1:])"


@pytest.mark.skipif(not ALL, reason="left to make test-all, as it compiles all vectors again")
@pytest.mark.parametrize("name, needs", [("x86-64", "sse2"), ("haswell", "avx2")])
def test_vectors_are_the_same_on_a_lesser_processor(name: str, needs: str):
    """AVX2 with fused multiply-add, and nothing but SSE2: twice and four times as many registers to a vector."""
    if platform.machine().lower() not in ("x86_64", "amd64") or not binding.get_host_cpu_features().get(needs):
        pytest.skip(f"this processor has no {needs}")
    environment = os.environ | {"NUMBA_CPU_NAME": name, "NUMBA_CPU_FEATURES": "", "PYTHONPATH": str(ROOT)}
    told = subprocess.run([sys.executable, "-c", REPORT], env=environment, cwd=ROOT, capture_output=True, text=True)
    assert told.stdout.strip() == str((name, ""))
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests/simd", "--ignore", __file__]
    run = subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout[-6000:] + run.stderr[-2000:]
