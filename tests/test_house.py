"""The house: that its papers agree with each other, and that it grows no more."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parent.parent
LOCKS = ("run", "dev")


def project() -> dict:
    return tomllib.loads((ROOT / "pyproject.toml").read_text())


def locked(name: str) -> dict[str, str]:
    """Package -> version of a lock."""
    text = (ROOT / "tools" / f"{name}.lock").read_text()
    return dict(re.findall(r"^([a-z0-9-]+)==(\S+)", text, re.MULTILINE))


def test_no_test_imports_another() -> None:
    """What tests share lies in modules that are none: a test can be moved, split or run alone."""
    for path in (ROOT / "tests").rglob("*.py"):
        found = re.search(r"^(from|import) tests(\.\w+)*[. ](import )?(test_|conftest)", path.read_text(), re.MULTILINE)
        assert not found, f"{path.relative_to(ROOT)}: {found[0]}"


@pytest.mark.slow
def test_commands_without_a_window_load_neither_gl_nor_matplotlib() -> None:
    """Not even on the way: a machine without libGL can render, and `--help` is quick.  Only a plot loads matplotlib, so
    that the window and the other commands start no slower."""
    code = (
        "import sys, viewer.__main__, viewer.cli.bench, viewer.cli.render, tracer\n"
        "print([m for m in ('matplotlib',) if m in sys.modules])\n"
        "import viewer.services.controller\n"
        "print([m for m in ('moderngl', 'glfw', 'imgui_bundle', 'OpenGL', 'glcontext') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert done.stdout.split() == ["[]", "[]"], done.stdout + done.stderr


@pytest.mark.parametrize("name", LOCKS)
def test_lock_holds_for_anyone(name: str) -> None:
    """Hashes for every package, and neither an index nor a path of the machine that wrote it."""
    text = (ROOT / "tools" / f"{name}.lock").read_text()
    assert not re.search(r"https?://|file:|--index|--find-links|--trusted|@ |/opt|/home", text)
    for block in re.split(r"\n(?=[a-z])", text)[1:]:
        assert "--hash=sha256:" in block, block.splitlines()[0]


@pytest.mark.parametrize(("name", "groups"), [("run", ["build"]), ("dev", ["build", "test", "lint", "bench", "lock"])])
def test_lock_satisfies_the_ranges(name: str, groups: list[str]) -> None:
    data, versions = project(), locked(name)
    wanted = data["project"]["dependencies"] + [r for g in groups for r in data["dependency-groups"][g]]
    for requirement in map(Requirement, wanted):
        version = versions[requirement.name.lower()]
        assert version in requirement.specifier, f"{requirement} but {version} in tools/{name}.lock"


def test_locks_agree() -> None:
    run, dev = locked("run"), locked("dev")
    assert {package: dev.get(package) for package in run} == run


def test_every_dependency_has_a_range() -> None:
    data = project()
    wanted = data["project"]["dependencies"] + [r for g in data["dependency-groups"].values() for r in g]
    for requirement in map(Requirement, wanted):
        assert {">=", "<"} <= {s.operator for s in requirement.specifier}, requirement


# Lines of Python, and files of it: each only ever goes down.
MOST_LINES = {"viewer": 26_653, "tracer": 42_576, "tests/viewer": 13_191, "tests": 39_070}
MOST_FILES = {"viewer": 180}


@pytest.mark.parametrize("package", MOST_LINES)
def test_packages_grow_no_longer(package: str) -> None:
    files = list((ROOT / package).rglob("*.py"))
    assert len(files) <= MOST_FILES.get(package, len(files)), "fewer files, each of one idea"
    assert sum(len(path.read_text().splitlines()) for path in files) <= MOST_LINES[package]


def test_the_change_log_knows_this_version() -> None:
    assert f"## {project()['project']['version']}" in (ROOT / "CHANGELOG.md").read_text()
