"""Builds the package `shadowcull-kernels` in `dist`: compiled kernels for this platform, Python and version of numba.

    python tools/kernels.py            for each level of x86-64 that this processor runs

Kernels are compiled once for each level, and a tiny picture that is traced by them must be that of kernels which are
compiled for this very processor, bit for bit.  How they are used: `tracer/runtime/prebuilt.py`.
"""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from tracer.runtime import prebuilt  # noqa: E402

_PROJECT = """\
[build-system]
requires = ["hatchling"]
build-backend = "hatchling.build"

[project]
name = "shadowcull-kernels"
version = "{version}"
description = "Compiled kernels of Shadowcull, so that the first picture need not wait for them"
license = "MIT"
requires-python = "=={python}.*"
dependencies = ["shadowcull=={version}", "numba=={numba}", "llvmlite=={llvmlite}"]

[tool.hatch.build.targets.wheel]
packages = ["{package}"]

[tool.hatch.build.targets.wheel.hooks.custom]
"""
_HOOK = """\
from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class OfThisPlatform(BuildHookInterface):
    def initialize(self, version, build_data):
        build_data["pure_python"] = False
        build_data["tag"] = "{tag}"
"""


def compiled(folder: Path, level: str) -> str:
    """Compile into a folder for a level, or for this processor where that is ""; returns the tiny picture's digest.

    Raises CalledProcessError."""
    chosen = prebuilt.environment_of(level)
    environment = {name: value for name, value in os.environ.items() if name not in chosen}
    environment |= {"SHADOWCULL_CACHE_DIR": str(folder), "PYTHONPATH": str(ROOT)}
    environment |= chosen if level else {}
    drawing = "from viewer.views import paint; paint.make_ready()"
    subprocess.run([sys.executable, "-c", drawing], env=environment, check=True)
    command = [sys.executable, "-m", prebuilt.TRIAL, "all"]
    return subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=True).stdout.strip()


def write_package(folder: Path, levels: list[str]) -> None:
    """Write the package with its manifest; raises ValueError where a level traces another picture."""
    with tempfile.TemporaryDirectory() as own:
        expected = compiled(Path(own), "")
    files: dict[str, dict[str, str]] = {}
    for level in levels:
        print(f"compiling for {level}", flush=True)
        if compiled(folder / level, level) != expected:
            raise ValueError(f"kernels for {level} trace another picture than those for this processor")
        files[level] = prebuilt.digests(folder / level)
    manifest = {"versions": prebuilt.versions(), "answer": expected, "files": files}
    (folder / prebuilt.MANIFEST).write_text(json.dumps(manifest, indent=1), encoding="utf-8")
    (folder / "__init__.py").write_text('"""Compiled kernels of Shadowcull."""\n', encoding="utf-8")


def build(target: Path, levels: list[str]) -> Path:
    """Build the wheel with kernels for these levels; raises ValueError and CalledProcessError."""
    from hatchling.builders.wheel import WheelBuilder

    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    now, python = prebuilt.versions(), f"{sys.version_info.major}{sys.version_info.minor}"
    system = {"linux": "manylinux_2_17_x86_64", "win32": "win_amd64"}.get(sys.platform, "macosx_11_0_x86_64")
    with tempfile.TemporaryDirectory() as made:
        project = Path(made)
        write_package(project / prebuilt.PACKAGE, levels)
        text = _PROJECT.format(
            version=version, numba=now["numba"], llvmlite=now["llvmlite"], package=prebuilt.PACKAGE,
            python=f"{sys.version_info.major}.{sys.version_info.minor}",
        )  # fmt: skip
        (project / "pyproject.toml").write_text(text, encoding="utf-8")
        (project / "hatch_build.py").write_text(_HOOK.format(tag=f"cp{python}-cp{python}-{system}"), encoding="utf-8")
        (wheel,) = WheelBuilder(str(project)).build(directory=str(target), versions=["standard"])
    return Path(wheel)


def main() -> int:
    levels = [level for level in prebuilt.LEVELS if prebuilt.runs_level(level)]
    if platform.machine().lower() not in ("x86_64", "amd64") or not levels:
        print("shadowcull: kernels are only built where x86-64-v3 runs", file=sys.stderr)
        return 1
    for old in (ROOT / "dist").glob("shadowcull_kernels-*"):
        old.unlink()
    wheel = build(ROOT / "dist", levels)
    print(f"{wheel.relative_to(ROOT)}, {wheel.stat().st_size / 1e6:.1f} MB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
