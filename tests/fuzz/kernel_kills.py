"""Kills programs while they compile into a cache that all share: what is left of them is used or made anew."""

from __future__ import annotations

import importlib.util
import os
import tempfile
from pathlib import Path

import numpy as np

from tests.fuzz.kills import forked, killed
from tracer.runtime import kernel_cache

TINY = """
from tracer.runtime.kernels import kernel

@kernel
def ask(x):
    return x + 1
"""
VALUES = (1, 1.5, np.int8(3), np.float32(0.5), np.uint16(7), 2j)


def kill_often(number: int, rng: np.random.Generator) -> tuple[int, int, str]:
    """How many were killed, after how many of them the next program failed, and why first."""
    failed, first = 0, ""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "tiny.py"
        source.write_text(TINY)
        for _ in range(number):
            killed(lambda _at: _compile(Path(folder), source), 0, float(rng.uniform(0.0, 1.2)))
            child = forked(lambda: _compile(Path(folder), source, VALUES[:2]))
            if os.waitpid(child, 0)[1]:
                failed, first = failed + 1, first or "the next program failed"
            if rng.random() < 0.5:  # else it is there already
                for path in (Path(folder) / "cache").rglob("*.nb?"):
                    path.unlink()
    return number, failed, first


def _compile(folder: Path, source: Path, values: tuple = VALUES) -> None:
    """Compile or load a kernel for some kinds of numbers, in a cache of its own."""
    os.environ["SHADOWCULL_CACHE_DIR"] = str(folder / "cache")
    kernel_cache._folders.clear()
    spec = importlib.util.spec_from_file_location("tiny", source)
    assert spec is not None and spec.loader is not None
    tiny = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tiny)
    for value in values:
        assert tiny.ask(value) == value + 1, value
