"""Builds the source distribution and the wheel in `dist`, checks them, and installs the wheel where nothing else is.

    python tools/dist.py [--newest] [--oldest]

Without options it builds and checks what is in them; with `--newest` and `--oldest` it also installs the wheel in a
fresh environment, with the newest or the oldest packages that it allows, and uses it from a folder outside this one,
which compiles the kernels anew and says how long that took.  Installing, and twine's check, need the package index.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tarfile
import tempfile
import time
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TWINE = "twine>=7,<8"
UV = [sys.executable, "-m", "uv", "--system-certs"]  # as tools/environment.sh does
_OF_WHEEL = ("shadowcull.py", "tracer/", "viewer/", "shadowcull-")
_OF_SOURCES = (
    "shadowcull.py", "tracer/", "viewer/", "shaders/", "assets/", "tests/", "tools/", "docs/", ".ci/", ".gitignore",
    "ARCHITECTURE.md", "CHANGELOG.md", "CITATION.cff", "CONTRIBUTING.md", "LICENSE", "Makefile", "PKG-INFO",
    "README.md", "SECURITY.md", "pyproject.toml",
)  # fmt: skip
_NEVER = ("__pycache__", ".cache/", ".pyc", ".part", ".venv", "build/", "/out/")


def build(folder: Path) -> tuple[Path, Path]:
    """The source distribution and the wheel, built in a folder as anybody's tools would, the latter from the former."""
    from hatchling.builders.sdist import SdistBuilder
    from hatchling.builders.wheel import WheelBuilder

    (sources,) = SdistBuilder(str(ROOT)).build(directory=str(folder), versions=["standard"])
    with tempfile.TemporaryDirectory() as unpacked, tarfile.open(sources) as archive:
        archive.extractall(unpacked, **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))
        (root,) = Path(unpacked).iterdir()
        (wheel,) = WheelBuilder(str(root)).build(directory=str(folder), versions=["standard"])
    return Path(sources), Path(wheel)


def wrong(sources: Path, wheel: Path) -> list[str]:
    """What is in them that should not be, and what is not that the program needs."""
    with tarfile.open(sources) as archive:
        in_sources = {member.name.partition("/")[2] for member in archive if member.isfile()}
    with zipfile.ZipFile(wheel) as archive:
        in_wheel = set(archive.namelist())
    said = [f"{wheel.name} has {name}" for name in in_wheel if not name.startswith(_OF_WHEEL)]
    said += [f"{sources.name} has {name}" for name in in_sources if not name.startswith(_OF_SOURCES)]
    said += [f"a {name} is in them" for name in in_wheel | in_sources if any(word in name for word in _NEVER)]
    needed = {name: name for name in in_sources if name.startswith(("tracer/", "viewer/", "shadowcull.py"))}
    needed |= {name: f"viewer/data/{name}" for name in in_sources if name.startswith(("shaders/", "assets/scenes/"))}
    needed["assets/icon.png"] = "viewer/data/assets/icon.png"
    said += [f"{wheel.name} lacks {name}" for name in needed.values() if name not in in_wheel]
    on_disk = {
        path.relative_to(ROOT).as_posix()
        for top in ("tracer", "viewer", "shaders", "assets/scenes", "tests", "tools")
        for path in (ROOT / top).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    return sorted(said + [f"{sources.name} lacks {name}" for name in on_disk - in_sources])


def install_and_use(wheel: Path, oldest: bool) -> None:
    """In an environment of its own, from a folder outside the sources.  Raises CalledProcessError."""
    with tempfile.TemporaryDirectory(prefix="shadowcull-dist-") as folder:
        python = Path(folder) / "env" / "bin" / "python"
        _run([*UV, "venv", "--quiet", "--python", sys.executable, str(python.parents[1])])
        install = [*UV, "pip", "install", "--quiet", "--python", str(python)]
        if oldest:
            _run([*install, "--resolution", "lowest-direct", "--all-extras", "-r", str(ROOT / "pyproject.toml")])
        _run([*install, *(["--no-deps"] if oldest else []), str(wheel)])
        kept = ("PYTHONPATH", "PYTHONHOME", "SHADOWCULL_CACHE_DIR")
        environment = {name: value for name, value in os.environ.items() if name not in kept}
        environment |= {"XDG_CACHE_HOME": f"{folder}/cache", "XDG_CONFIG_HOME": f"{folder}/config"}
        command = [str(python.with_name("shadowcull")), "render", "default", "-o", "a.png", "--size", "320x240"]
        for what in ("first", "second"):
            began = time.monotonic()
            _run(command, cwd=folder, env=environment, stdout=subprocess.DEVNULL)
            kind = "oldest" if oldest else "newest"
            print(f"with the {kind} packages the {what} picture took {time.monotonic() - began:.1f} s", flush=True)
        for rest in (["info", "default", "--json"], ["--help"]):
            _run([command[0], *rest], cwd=folder, env=environment, stdout=subprocess.DEVNULL)


def _run(command: list[str], **options) -> None:
    subprocess.run(command, check=True, **options)


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--newest", action="store_true", help="install and use it with the newest packages")
    parser.add_argument("--oldest", action="store_true", help="install and use it with the oldest packages")
    given = parser.parse_args()
    folder = ROOT / "dist"
    for old in folder.glob("shadowcull-*"):
        old.unlink()
    built = build(folder)
    for line in (said := wrong(*built)):
        print(line, file=sys.stderr)
    if said:
        return 1
    try:
        _run([*UV, "tool", "run", "--from", TWINE, "twine", "check", "--strict", *map(str, built)])
        for wanted, oldest in ((given.newest, False), (given.oldest, True)):
            if wanted:
                install_and_use(built[1], oldest)
    except subprocess.CalledProcessError as error:
        print(f"shadowcull: failed: {' '.join(error.cmd)}", file=sys.stderr)
        return 1
    for path in built:
        print(f"{path.relative_to(ROOT)}, {path.stat().st_size / 1e6:.1f} MB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
