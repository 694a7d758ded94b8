"""What all tests share: where the BART scenes are, what a screen is for, and settings that are nobody's own."""

from __future__ import annotations

import ctypes
import gc
import os
import sys
import tempfile
from pathlib import Path

import pytest
from hypothesis.internal.conjecture import providers

from viewer.util.screen import has_display, no_display_reason

BART = Path(__file__).resolve().parents[1].parent / "shared" / "bart"

# Before anything reads them: tests neither see nor change what the user of this machine has set.
_HOME = tempfile.TemporaryDirectory(prefix="shadowcull-tests-")
os.environ["SHADOWCULL_CONFIG_DIR"] = str(Path(_HOME.name) / "shadowcull")
os.environ["XDG_CONFIG_HOME"] = _HOME.name


# Hypothesis also draws constants of the sources that are loaded: examples would change with any of them, and with what
# else is tested.
providers._get_local_constants = lambda: providers._local_constants


# What is imported and collected lives to the end: nobody looks through it for garbage, then or later.
gc.disable()


def pytest_collection_finish() -> None:
    from tracer.compiling.processes import ask_operators_once  # loads all of the tracer, which tests need, too

    ask_operators_once()  # kernels of the tests' own are compiled as the program's are
    gc.freeze()
    gc.enable()


# glibc keeps what threads have freed for threads to come: of a process of tests, gigabytes.
_trim = getattr(ctypes.CDLL(None), "malloc_trim", None) if sys.platform.startswith("linux") else None


@pytest.hookimpl(trylast=True)
def pytest_runtest_teardown(item: pytest.Item, nextitem: pytest.Item | None) -> None:
    if _trim is not None and (nextitem is None or nextitem.path != item.path):
        _trim(ctypes.c_size_t(0))


@pytest.fixture(scope="session")
def bart() -> Path:
    """The folder of BART's scenes beside the repository; tests that need it are skipped where it is absent."""
    if not BART.is_dir():
        pytest.skip(f"the BART scenes are not at {BART}")
    return BART


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests marked `gui` open a window and take longest, so they begin early, that no process waits for another's at
    the end."""
    items.sort(key=lambda item: item.get_closest_marker("gui") is None)
    if not has_display():
        reason = pytest.mark.skip(reason=f"{no_display_reason()}; 'make test' brings one along")
        for item in items:
            if item.get_closest_marker("gui"):
                item.add_marker(reason)
