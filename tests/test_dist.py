"""What is in the wheel and in the source distribution, and a package of another project in the place of ours."""

from __future__ import annotations

import importlib
import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

import shadowcull

ROOT = Path(__file__).resolve().parent.parent


@pytest.mark.slow
def test_the_wheel_has_what_the_program_needs_and_nothing_else(tmp_path: Path) -> None:
    spec = importlib.util.spec_from_file_location("dist", ROOT / "tools" / "dist.py")
    assert spec is not None and spec.loader is not None
    dist = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(dist)
    sources, wheel = dist.build(tmp_path)
    assert dist.wrong(sources, wheel) == []


def test_the_program_knows_its_own_packages() -> None:
    assert [shadowcull.foreign(name, mark) for name, mark in shadowcull.OWN.items()] == ["", ""]


@pytest.mark.parametrize("name", ["tracer", "viewer"])
def test_another_projects_package_is_one_line(name: str, tmp_path: Path) -> None:
    (tmp_path / name).mkdir()
    (tmp_path / name / "__init__.py").write_text("def start(): ...\n")
    code = f"import sys; sys.path[:0] = {[str(tmp_path), str(ROOT)]!r}; import shadowcull; sys.exit(shadowcull.main())"
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 1 and done.stdout == ""
    assert f"is another project's package '{name}'; install shadowcull in an environment" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_a_package_that_was_overwritten_or_removed_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shadowcull, "__file__", str(tmp_path / "shadowcull.py"))
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "tracer_of_tests").mkdir()
    assert "as another project's was removed; install shadowcull again" in shadowcull.foreign("tracer_of_tests", "mark")
    (tmp_path / "tracer_of_tests" / "__init__.py").write_text("")
    importlib.invalidate_caches()
    assert "is another project's package" in shadowcull.foreign("tracer_of_tests", "mark")
    (tmp_path / "tracer_of_tests" / "__init__.py").write_text("mark = 1")
    assert shadowcull.foreign("tracer_of_tests", "mark") == ""


def test_the_installed_command_starts_from_anywhere(tmp_path: Path) -> None:
    """Also where the packages stay with their sources, and only this file and data are copied beside others."""
    (tmp_path / "shadowcull.py").write_text((ROOT / "shadowcull.py").read_text())
    (tmp_path / "viewer" / "data").mkdir(parents=True)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), str(tmp_path)])}
    command = [sys.executable, str(tmp_path / "shadowcull.py"), "--version"]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "") and done.stdout.startswith("shadowcull")
