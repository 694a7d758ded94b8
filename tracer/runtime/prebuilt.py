"""Kernels that were compiled elsewhere: the package `shadowcull-kernels`, where it is installed.

It holds a cache (`kernel_cache`) for one version of Python and of numba, once for each level of x86-64 that it was made
for.  What suits this machine is copied into the user's cache before anything is compiled, and from then on code is made
for that level, so that what lies there is found.

Reading a cache runs what it holds.  So a file is taken only if the package's manifest has its SHA-256, and another
process tries the kernels first: where that dies, or traces a picture that is not the one it should be, this process
compiles as if there were no package.  numba promises nothing about caches of other machines: where anything differs,
the package is not used.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from contextlib import suppress
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import platformdirs

from tracer.util.version import tracer_code

_ROOT = Path(__file__).parents[2]  # of the packages
PACKAGE, MANIFEST = "shadowcull_kernels", "manifest.json"
TRIAL = "tracer.compiling.trial"  # the module that tries them, in a process of its own
SECONDS = 60.0  # that it may take
_V2 = "cx16 sahf popcnt sse3 sse4.1 sse4.2 ssse3"
_V3 = f"{_V2} avx avx2 bmi bmi2 f16c fma lzcnt movbe xsave"
LEVELS = {"x86-64-v4": f"{_V3} avx512f avx512bw avx512cd avx512dq avx512vl".split(), "x86-64-v3": _V3.split()}
"""Features, as LLVM calls them, that a processor needs for a level; the highest level first."""


def wanted_root() -> Path:
    """Return the folder of the user's cache, if it can be written to."""
    base = os.environ.get("SHADOWCULL_CACHE_DIR")
    if base:
        return Path(base).expanduser()
    if (_ROOT / "pyproject.toml").exists():
        return _ROOT / ".cache" / "kernels"
    return Path(platformdirs.user_cache_dir("shadowcull")) / "kernels"


def runs_level(level: str) -> bool:
    """Return whether this processor has all that a level needs."""
    from llvmlite import binding  # takes as long to load as all else here, and most have no package

    has = binding.get_host_cpu_features()
    return all(has.get(feature, False) for feature in LEVELS[level])


def versions() -> dict[str, str]:
    """Return what kernels were compiled by and for, all of which must be the same here."""
    from llvmlite import binding

    return {
        "tracer": tracer_code(),
        "python": str(sys.implementation.cache_tag),
        "numba": version("numba"),
        "llvmlite": version("llvmlite"),
        "platform": f"{sys.platform}-{binding.get_default_triple()}",
    }


def use() -> None:
    """Take what fits this machine into the cache, once, and have code made for its level from now on.

    To be called before numba is imported, which reads the processor's name once."""
    if "numba" in sys.modules or os.environ.get("NUMBA_CPU_NAME"):  # somebody has chosen for what code is made
        return
    level = taken_into(wanted_root())
    if level:
        os.environ |= _environment(level)  # of processes that compile as well


def taken_into(root: Path) -> str:
    """Return the level whose kernels the cache at `root` has from the package; nothing where none can be used here."""
    found = _package()
    if found is None:
        return ""
    folder, manifest, level = found
    name = hashlib.sha256(json.dumps(manifest, sort_keys=True).encode()).hexdigest()[:16]
    taken, refused = root / f"{name}-{level}.taken", root / f"{name}-{level}.refused"
    if taken.exists() or refused.exists():
        return level if taken.exists() else ""
    try:
        _take(folder / level, manifest["files"][level], manifest["answer"], root, level)
        taken.touch()
        return level
    except (OSError, ValueError, subprocess.SubprocessError):
        with suppress(OSError):
            refused.touch()
        return ""


def _environment(level: str) -> dict[str, str]:
    return {"NUMBA_CPU_NAME": level, "NUMBA_CPU_FEATURES": ""}


def _package() -> tuple[Path, dict[str, Any], str] | None:
    """The folder of the package, its manifest, and the level of this machine; None unless all fits."""
    try:
        spec = find_spec(PACKAGE)
        if spec is None or not spec.submodule_search_locations:
            return None
        folder = Path(spec.submodule_search_locations[0])
        manifest = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
        level = next((one for one in LEVELS if one in manifest["files"] and runs_level(one)), "")
        fits = level and manifest["versions"] == versions()
    except (OSError, ValueError, LookupError, TypeError):
        return None
    return (folder, manifest, level) if fits else None


def _take(folder: Path, files: dict[str, str], answer: str, root: Path, level: str) -> None:
    """Copy the files of a level, each with its SHA-256, into the cache, if another process gives the answer with them.

    Raises OSError, ValueError for a file that is not as it was made or another answer, and SubprocessError."""
    root.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=root, prefix="prebuilt-") as kept:
        for name, digest in files.items():
            data = (folder / name).read_bytes()
            if hashlib.sha256(data).hexdigest() != digest:
                raise ValueError(f"{name} is damaged")
            path = Path(kept) / name
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(data)
        modules = os.pathsep.join([str(_ROOT), *filter(None, sys.path)])
        environment = os.environ | _environment(level) | {"SHADOWCULL_CACHE_DIR": kept, "PYTHONPATH": modules}
        command = [sys.executable, "-P", "-m", TRIAL]
        tried = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=SECONDS, check=True)
        if tried.stdout.strip() != answer:
            raise ValueError("another picture was traced")
        for name in files:
            path = root / name
            path.parent.mkdir(exist_ok=True)
            if not path.exists():  # what was compiled here is as good
                shutil.move(Path(kept) / name, path)
