"""Kernels that were compiled elsewhere: the package `shadowcull-kernels`, where it is installed.

It holds a cache (`kernel_cache`) for one version of Python and of numba, once for each level of x86-64 that it was made
for.  What suits this machine is copied into a cache of that level before anything is compiled, and from then on code is
made for the level, so that what lies there is found.

numba promises nothing about caches of other machines.  So all versions must be the same, each file must have the
SHA-256 of the manifest, which finds damage, and another process uses the kernels first.  Where that dies, has to
compile any, or traces another picture than it should, this process compiles as if there were no package.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
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
_NAME = re.compile(r"[0-9a-f]{16}/[\w.-]+")  # of a file in the cache


def wanted_root() -> Path:
    """Return the folder of the user's cache; code for a named level of processors has one of its own in it."""
    base, level = os.environ.get("SHADOWCULL_CACHE_DIR"), os.environ.get("NUMBA_CPU_NAME")
    if base:
        root = Path(base).expanduser()
    elif (_ROOT / "pyproject.toml").exists():
        root = _ROOT / ".cache" / "kernels"
    else:
        root = Path(platformdirs.user_cache_dir("shadowcull")) / "kernels"
    return root / level if level in LEVELS and root.name != level else root


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
        os.environ |= environment_of(level)  # of processes that compile as well


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
    except (ValueError, subprocess.CalledProcessError) as error:
        with suppress(OSError):
            refused.write_text(str(error), encoding="utf-8")
    except (OSError, subprocess.TimeoutExpired):
        pass  # the next start tries again
    return ""


def environment_of(level: str) -> dict[str, str]:
    """Return the variables by which numba makes code for a level."""
    return {"NUMBA_CPU_NAME": level, "NUMBA_CPU_FEATURES": ""}


def _package() -> tuple[Path, dict[str, Any], str] | None:
    """The folder of the package, its manifest, and the level of this machine; None unless all fits."""
    try:
        spec = find_spec(PACKAGE)
        if spec is None or not spec.submodule_search_locations:
            return None
        folder = Path(spec.submodule_search_locations[0])
        manifest = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
        level = next((one for one in LEVELS if runs_level(one)), "")
        files, answer = manifest["files"][level], manifest["answer"]  # of a lower level all code would be slower
        fits = manifest["versions"] == versions() and isinstance(answer, str)
        named = all(_NAME.fullmatch(name) and isinstance(digest, str) for name, digest in files.items())
    except Exception:  # whatever is wrong with it
        return None
    return (folder, manifest, level) if fits and named else None


def _take(folder: Path, files: dict[str, str], answer: str, root: Path, level: str) -> None:
    """Copy the files of a level, each with its SHA-256, into the cache, if another process gives the answer with them
    and no others.

    Raises OSError, ValueError for files that are not as they were made or another answer, and SubprocessError."""
    root.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=root, prefix="prebuilt-") as kept:
        made = Path(kept) / level
        for name in files:
            path = made / name
            path.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(folder / name, path)
        modules = os.pathsep.join([str(_ROOT), *filter(None, sys.path)])
        environment = os.environ | environment_of(level) | {"SHADOWCULL_CACHE_DIR": kept, "PYTHONPATH": modules}
        if digests(made) != files:
            raise ValueError("files are damaged")
        command = [sys.executable, "-P", "-m", TRIAL]
        tried = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=SECONDS, check=True)
        if tried.stdout.strip() != answer:
            raise ValueError("another picture was traced")
        if digests(made) != files:
            raise ValueError("kernels had to be compiled")
        for name in files:
            path = root / level / name
            path.parent.mkdir(parents=True, exist_ok=True)
            os.replace(made / name, path)


def digests(folder: Path) -> dict[str, str]:
    """Return the SHA-256 of each file in the folders of a cache, by its path there."""
    paths = (path for path in folder.glob("*/*") if path.is_file())
    return {path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest() for path in paths}
