"""Kernels that come compiled: taken where all fits and a trial succeeds, and else as if they were not there."""

from __future__ import annotations

import hashlib
import json
import runpy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.sweeps import ALL
from tracer.runtime import prebuilt

ROOT = Path(__file__).resolve().parents[1]
LEVEL, ANSWER = "x86-64-v3", "the right picture"
KERNEL = "0123456789abcdef/shade.py311.1.nbc"


@pytest.fixture(autouse=True)
def processor(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The features that the processor of a test has."""
    features = list(prebuilt.LEVELS[LEVEL])
    monkeypatch.setattr("llvmlite.binding.get_host_cpu_features", lambda: dict.fromkeys(features, True))
    return features


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Path]:
    """Write a package with one kernel; `trial` is what the process does that tries it, `more` its manifest's own."""

    def write(trial: str = f"print({ANSWER!r})", damaged: bool = False, **more: Any) -> Path:
        folder = tmp_path / "site" / prebuilt.PACKAGE
        path = folder / LEVEL / KERNEL
        path.parent.mkdir(parents=True)
        path.write_bytes(b"machine code")
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        manifest = {"versions": prebuilt.versions(), "answer": ANSWER, "files": {LEVEL: {KERNEL: digest}}}
        (folder / prebuilt.MANIFEST).write_text(json.dumps(manifest | more))
        (folder / "__init__.py").touch()
        if damaged:
            path.write_bytes(b"machine Code")
        (tmp_path / "site" / "a_trial.py").write_text(trial)
        monkeypatch.syspath_prepend(str(tmp_path / "site"))
        monkeypatch.setattr(prebuilt, "TRIAL", "a_trial")
        return tmp_path / "site" / "a_trial.py"

    return write


def test_what_fits_is_tried_once_and_then_in_the_cache(package: Callable[..., Path], tmp_path: Path) -> None:
    root = tmp_path / "cache"
    trial = package(trial=f"import os; assert os.environ['NUMBA_CPU_NAME'] == {LEVEL!r}; print({ANSWER!r})")
    assert prebuilt.taken_into(root) == LEVEL
    assert (root / LEVEL / KERNEL).read_bytes() == b"machine code"
    trial.write_text("raise SystemExit(1)")
    assert prebuilt.taken_into(root) == LEVEL, "it was tried a second time"


def test_what_was_compiled_for_this_processor_stays(package: Callable[..., Path], tmp_path: Path) -> None:
    package()
    own = tmp_path / "cache" / KERNEL
    own.parent.mkdir(parents=True)
    own.write_bytes(b"compiled here")
    assert prebuilt.taken_into(tmp_path / "cache") == LEVEL and own.read_bytes() == b"compiled here"


COMPILES = f"""
import os, pathlib
(pathlib.Path(os.environ["SHADOWCULL_CACHE_DIR"]) / {LEVEL!r} / {KERNEL!r}).with_suffix(".2.nbc").touch()
print({ANSWER!r})
"""


@pytest.mark.parametrize(
    ("given", "tried"),
    [
        ({"damaged": True}, True),
        ({"trial": COMPILES}, True),
        ({"trial": "print('another picture')"}, True),
        ({"trial": "import os; os.abort()"}, True),
        ({"versions": {"numba": "0.1"}}, False),
        ({"files": {}}, False),
        ({"files": {"x86-64-v9": {}}}, False),
        ({"versions": 3, "files": 5}, False),
        ({"answer": None}, False),
        ({"files": {LEVEL: ["no names"]}}, False),
        ({"files": {LEVEL: {"../../outside": "0"}}}, False),
    ],
    ids=lambda given: str(given)[:40],
)
def test_what_does_not_fit_is_as_if_it_were_not_there(
    given: dict[str, Any], tried: bool, package: Callable[..., Path], tmp_path: Path
) -> None:
    root = tmp_path / "cache"
    trial = package(**given)
    assert prebuilt.taken_into(root) == "" and not list(root.rglob("*.nbc"))
    trial.write_text(f"print({ANSWER!r})")
    assert prebuilt.taken_into(root) == "", "what failed once is not tried again"
    assert len(list(root.glob("*.refused"))) == tried


def test_what_takes_too_long_is_tried_again_at_the_next_start(
    package: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    trial = package(trial="import time; time.sleep(60)")
    monkeypatch.setattr(prebuilt, "SECONDS", 0.5)
    assert prebuilt.taken_into(tmp_path / "cache") == ""
    trial.write_text(f"print({ANSWER!r})")
    monkeypatch.setattr(prebuilt, "SECONDS", 60.0)
    assert prebuilt.taken_into(tmp_path / "cache") == LEVEL


def test_a_lesser_processor_and_no_package_compile(
    processor: list[str], package: Callable[..., Path], tmp_path: Path
) -> None:
    assert prebuilt.taken_into(tmp_path / "cache") == "", "there is no package"
    package()
    processor.remove("fma")
    assert prebuilt.taken_into(tmp_path / "cache") == "" and not (tmp_path / "cache").exists()


@pytest.mark.skipif(not ALL, reason="compiles all kernels anew, which takes minutes: SHADOWCULL_TESTS=all")
def test_the_package_is_built_used_and_traces_the_same_picture(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Building compares a picture with that of kernels for this very processor, bit for bit, and so does trying."""
    monkeypatch.undo()
    build = runpy.run_path(str(ROOT / "tools" / "kernels.py"))
    levels = [level for level in prebuilt.LEVELS if prebuilt.runs_level(level)]
    build["write_package"](tmp_path / prebuilt.PACKAGE, levels)
    monkeypatch.syspath_prepend(str(tmp_path))
    assert prebuilt.taken_into(tmp_path / "cache") == levels[0]
