"""Where compiled kernels are kept: what is changed, damaged, full, read-only, or used by many at once does no harm."""

from __future__ import annotations

import ast
import multiprocessing
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import pytest

from tests import kernel_processes
from tests.platforms import linux_only, posix_only
from tests.sweeps import cases
from tracer.compiling import compilation, processes, steps
from tracer.runtime import kernel_cache
from tracer.runtime.kernel_cache import sources_of
from tracer.scene.model import Cancelled

ROOT = Path(__file__).resolve().parent.parent
# What each process takes longest to load.
PROCESSES = multiprocessing.get_context("forkserver" if os.name == "posix" else "spawn")
PROCESSES.set_forkserver_preload(["tests.kernel_processes", "platformdirs"])


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A folder with a copy of the tracer, and in it a kernel that asks a helper of another file for a number."""
    shutil.copytree(ROOT / "tracer", tmp_path / "tracer", ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "tracer" / "__init__.py").write_text("")  # so that a process loads no more than it asks
    (tmp_path / "tracer" / "geometry" / "tiny.py").write_text(
        "from tracer.runtime.kernels import kernel\nfrom tracer.simd.tiny import value\n\n"
        "@kernel\ndef ask(x):\n    return value() + x\n"
    )
    write_helper(tmp_path, 1)
    return tmp_path


def write_helper(package: Path, value: int) -> None:
    (package / "tracer" / "simd" / "tiny.py").write_text(
        f"from tracer.runtime.kernels import subkernel\n\n@subkernel\ndef value():\n    return {value}\n"
    )


def start(package: Path, folder: Path, *numbers: str, slow: bool = False, **more: str) -> tuple[Any, Connection]:
    """A process that asks the kernel for numbers, and where its answer will come from."""
    return started(kernel_processes.ask, str(package), {"SHADOWCULL_CACHE_DIR": str(folder)} | more, numbers, slow)


def started(target: Callable[..., None], *arguments: Any) -> tuple[Any, Connection]:
    answer, other = PROCESSES.Pipe(duplex=False)
    process = PROCESSES.Process(target=target, args=(*arguments, other))
    process.start()
    other.close()
    return process, answer


def finish(one: tuple[Any, Connection]) -> tuple[Any, ...]:
    """What a process says: the kernel's answers, how many versions of it came from the cache, and from where."""
    process, answer = one
    assert answer.poll(120)
    said = answer.recv()
    process.join(120)
    assert not isinstance(said, str), said
    return said


def ask(package: Path, folder: Path, *numbers: str, **more: str) -> tuple[list[float], int, Path]:
    return finish(start(package, folder, *numbers, **more))


def test_a_kernel_is_found_again_wherever_its_sources_lie_and_never_stale(package: Path) -> None:
    cached = package / "cache"
    answers, hits, folder = ask(package, cached, "1")
    assert (answers, hits) == ([2.0], 0)
    (package / "tracer" / "culling" / "modes.py").write_text("changed = True\n")
    (package / "tracer" / "simd" / "tiny.py").touch()
    assert ask(package, cached, "1") == ([2.0], 1, folder), "what changed is not asked"
    shutil.copytree(package / "tracer", package / "copy" / "tracer")
    assert ask(package / "copy", cached, "1") == ([2.0], 1, folder)
    write_helper(package, 10)
    answers, hits, other = ask(package, cached, "1")
    assert (answers, hits) == ([11.0], 0)
    assert folder != other and folder.parent == other.parent == cached
    write_helper(package, 1)
    assert ask(package, cached, "1") == ([2.0], 1, folder)


def test_a_kernel_from_no_file_is_compiled_and_not_kept(tmp_path: Path) -> None:
    """As in a notebook, where another cell may stand in the same line."""
    code = "from tracer.runtime.kernels import kernel\n\n@kernel\ndef twice(x):\n    return 2 * x\nprint(twice(21))\n"
    assert finish(started(kernel_processes.run, code, {"SHADOWCULL_CACHE_DIR": str(tmp_path)})) == ("42\n",)
    assert not list(tmp_path.rglob("*.nbc"))


def statements(body: list[ast.stmt]) -> Iterator[ast.AST]:
    for node in body:
        yield node
        for name in ("body", "orelse", "finalbody", "handlers", "cases"):
            yield from statements(getattr(node, name, []))


def test_all_that_a_source_imports_is_found() -> None:
    """The imports that are found by their form are those that Python's own parser finds."""
    for path in sorted((ROOT / "tracer").rglob("*.py")):
        imported = kernel_cache._imported(path)
        tree = ast.parse(path.read_text())
        for_types = [b for b in tree.body if isinstance(b, ast.If) and ast.unparse(b.test) == "TYPE_CHECKING"]
        for node in statements([block for block in tree.body if block not in for_types]):
            if isinstance(node, ast.Import):
                taken = [name.name for name in node.names]
            elif isinstance(node, ast.ImportFrom):
                assert not node.level and node.module
                below = (ROOT.joinpath(*node.module.split("."), name.name) for name in node.names)
                taken = [
                    f"{node.module}.{file.name}" if file.is_dir() or file.with_suffix(".py").exists() else node.module
                    for file in below
                ]
            else:
                continue
            for module in taken:
                stem = ROOT.joinpath(*module.split("."))
                file = stem / "__init__.py" if stem.is_dir() else stem.with_suffix(".py")
                assert not module.startswith("tracer") or file in imported, (path, module)


def test_what_is_ready_depends_on_all_kernels_that_are_made_ready() -> None:
    names = {path.relative_to(ROOT / "tracer").as_posix() for path in sources_of(kernel_cache._STEPS)}
    methods = {f"methods/{name}.py" for name in ("paper", "cache", "certified", "certified_lights")}
    assert methods | {"inspect/ray_probe.py"} <= names


def test_shading_depends_on_vectors_and_not_on_methods() -> None:
    shading = {path.relative_to(ROOT / "tracer").as_posix() for path in sources_of(ROOT / "tracer/shading/whitted.py")}
    assert {"shading/whitted.py", "simd/vectors.py", "culling/shadow_testing.py", "runtime/kernels.py"} <= shading
    assert not any(name.startswith(("methods/", "geometry/kdtree", "renderer")) for name in shading)


def test_processes_that_compile_at_once_lose_and_mix_up_nothing(package: Path) -> None:
    cached = package / "cache"
    numbers = [f"__import__('numpy').{kind}(3)" for kind in ("int8", "uint8", "int16", "uint16")]
    processes = [start(package, cached, *half, slow=True) for half in (numbers[:2], numbers[2:])]
    assert [finish(process)[0] for process in processes] == [[4.0] * 2] * 2
    assert ask(package, cached, *numbers)[:2] == ([4.0] * 4, 4)


def test_a_damaged_cache_is_compiled_anew(package: Path) -> None:
    cached = package / "cache"
    folder = ask(package, cached, "1")[2]
    for pattern in ("*.nbc", "*.nbi"):
        (damaged,) = folder.rglob(f"tiny.ask{pattern}")
        damaged.write_bytes(damaged.read_bytes()[:100])
        assert ask(package, cached, "1")[:2] == ([2.0], 0), pattern
        assert ask(package, cached, "1")[:2] == ([2.0], 1), pattern


def test_without_a_folder_a_temporary_one_serves_and_goes(package: Path) -> None:
    cached = package / "cache"
    cached.write_text("a file is in its place")
    answers, hits, folder = ask(package, cached, "1", "1.5")
    assert (answers, hits) == ([2.0, 2.5], 0)
    assert cached not in folder.parents and not folder.exists()


@contextmanager
def mounted(folder: Path, size: str) -> Iterator[None]:
    """A file system of its own; skips the test where that is not allowed."""
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(folder)]
    is_root = os.name == "posix" and os.geteuid() == 0
    if not is_root or not shutil.which("mount") or subprocess.run(command, capture_output=True).returncode:
        pytest.skip("only root may mount a file system, and not everywhere")
    try:
        yield
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def test_a_full_disk_is_survived(package: Path) -> None:
    cached = package / "cache"
    with mounted(cached, "64k"):
        answers, _, folder = ask(package, cached, "1")
        assert answers == [2.0] and cached not in folder.parents
        (cached / "filling").write_bytes(bytes(40_000))
        assert ask(package, cached, "1", "1.5", TMPDIR=str(cached))[0] == [2.0, 2.5]


def test_a_folder_that_may_only_be_read_is_read(package: Path) -> None:
    cached = package / "cache"
    with mounted(cached, "64m"):
        folder = ask(package, cached, "1")[2]
        subprocess.run(["mount", "-o", "remount,ro", str(cached)], check=True)
        assert ask(package, cached, "1", "1.5") == ([2.0, 2.5], 1, folder)
        write_helper(package, 10)
        answers, _, other = ask(package, cached, "1")
        assert answers == [11.0] and cached not in other.parents


def test_kernels_stay_where_the_clock_was_set_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SHADOWCULL_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(kernel_cache, "_KEPT", 8)
    for age in range(8):
        old = tmp_path / f"{age:016x}"
        old.mkdir()
        os.utime(old, (time.time() + 3e8 - age,) * 2)
    for program in range(6):  # each with sources of its own
        kernel_cache._clock.cache_clear()
        kernel_cache._make_folder(f"{program:015x}f")
    there = {folder.name for folder in tmp_path.iterdir()}
    assert there == {f"{program:015x}f" for program in range(6)} | {f"{age:016x}" for age in range(2)}


def test_kernels_of_old_sources_are_removed_at_last(package: Path) -> None:
    cached, most = package / "cache", kernel_cache._KEPT
    for age in range(most + 5):
        old = cached / f"{age:016x}"
        old.mkdir(parents=True)
        (old / "kernel.nbc").write_bytes(b"code")
        os.utime(old, (time.time() - 100 * age - 100,) * 2)
    others = cached / "notes", cached / "0123"
    for other in others:
        other.mkdir()
    folder = ask(package, cached, "1")[2]
    left = {path.name for path in cached.iterdir() if path.is_dir()} - {other.name for other in others}
    assert len(left) == most and all(other.is_dir() for other in others)
    new = 2  # of this kernel, and of all that is made ready
    assert folder.name in left and {f"{age:016x}" for age in range(most - new)} < left
    assert ask(package, cached, "1")[1] == 1


# --- compiling in processes of their own ------------------------------------------------------------


@pytest.mark.parametrize(
    ("lights", "accelerator"),
    [(1, "bvh8"), *cases((), ((1, "kdtree"), (16, "kdtree"), (16, "bvh8"), (1, "kdtree-lazy")))],
)
def test_what_is_compiled_beside_is_what_a_frame_needs(lights: int, accelerator: str) -> None:
    """All steps are done, and with all kernels there nothing is compiled: so each is compiled as it is called."""
    compilation.warm_up(lights=lights, accelerator=accelerator)
    folders = [folder for source, folder in kernel_cache._folders.items() if source.is_relative_to(ROOT / "tracer")]
    before = sorted(path for folder in folders for path in folder.glob("*.nbc"))  # tests beside compile kernels, too
    told: list[tuple[str, float]] = []
    done: set[str] = set()
    drawable: list[set[str]] = []
    report = lambda *what: told.append(what)  # noqa: E731
    processes.compile_in_processes(report, lights, accelerator, done, lambda: drawable.append(set(done)))
    assert done == set(steps.SHARES) == {step for part in steps.PARTS.values() for step in part}
    assert len(drawable) == 1 and drawable[0] >= done - {"other methods"}
    assert sorted(path for folder in folders for path in folder.glob("*.nbc")) == before and len(before) > 50
    fractions = [fraction for _, fraction in told]
    assert fractions == sorted(fractions) and fractions[-1] > 0.7
    assert sum(steps.SHARES.values()) == pytest.approx(1.0)


def test_for_a_picture_less_is_compiled_and_the_rest_later(tmp_path: Path) -> None:
    code = (
        "from tracer.compiling import compilation, steps\n"
        "made = []\n"
        "compilation.compile_in_processes = lambda *arguments: made.append(list(arguments[-1]))\n"
        "compilation.picture_steps = lambda *a: iter(['primary rays'])\n"
        "compilation.method_steps = lambda *a: iter(['other methods'])\n"
        "(compilation.version_folder() / 'kernel.nbc').touch()\n"
        "compilation.warm_up(picture_only=True)\n"
        "assert compilation.can_draw() and compilation.compiled_before(picture_only=True)\n"
        "assert not compilation.compiled_before()\n"
        "compilation.warm_up(picture_only=True)\n"
        "compilation.warm_up()\n"
        "assert compilation.compiled_before()\n"
        "assert made == [list(steps.FOR_A_PICTURE), ['methods']], made\n"
    )
    assert finish(started(kernel_processes.run, code, {"SHADOWCULL_CACHE_DIR": str(tmp_path)})) == ("",)


def test_a_cache_is_compiled_for_its_processor(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(compilation, "version_folder", lambda: tmp_path)
    monkeypatch.setattr(compilation, "anything_kept", lambda: True)
    compilation._mark_kept("bvh8-uint32", picture_only=False)
    assert compilation.compiled_before() and compilation.compiled_before(picture_only=True)
    codegen = compilation.cpu_target.target_context.codegen()
    monkeypatch.setattr(type(codegen), "magic_tuple", lambda self: ("a system", "a processor", "+its,+instructions"))
    assert not compilation.compiled_before()


def test_cancelling_ends_the_processes(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[subprocess.Popen] = []
    make = processes._worker
    monkeypatch.setattr(processes, "_worker", lambda *a: made.append(make(*a)) or made[-1])

    def report(what: str, fraction: float) -> None:
        if len(made) == 2:
            raise Cancelled

    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    with pytest.raises(Cancelled):
        processes.compile_in_processes(report, 1, "bvh8", set())
    assert [process.returncode for process in made] == [-signal.SIGKILL if os.name == "posix" else 1] * 2


@posix_only
def test_processes_that_cannot_be_had_cost_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "executable", shutil.which("false"))
    done: set[str] = set()
    processes.compile_in_processes(lambda *what: None, 1, "bvh8", done)
    assert not done


@linux_only
def test_processes_end_with_the_one_that_wants_them(tmp_path: Path) -> None:
    code = (
        "from tracer.compiling import compilation, processes\n"
        "make = processes._worker\n"
        "def worker(*a):\n    made = make(*a)\n    print(made.pid, flush=True)\n    return made\n"
        "processes._worker = worker\n"
        "compilation.warm_up()\n"
    )
    environment = os.environ | {"SHADOWCULL_CACHE_DIR": str(tmp_path)}
    parent = subprocess.Popen(
        [sys.executable, "-c", code], cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True
    )
    assert parent.stdout is not None
    workers = [Path("/proc") / parent.stdout.readline().strip() for _ in range(2)]
    assert all(worker.exists() for worker in workers)
    parent.kill()
    parent.wait()
    parent.stdout.close()
    end = time.monotonic() + 20.0
    while any(_lives(worker) for worker in workers):
        assert time.monotonic() < end, "a process outlives the one that wants its kernels"
        time.sleep(0.05)


def _lives(process: Path) -> bool:
    try:
        return process.joinpath("stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_a_method_with_kernels_of_its_own_is_made_ready_by_name() -> None:
    """What `warm_up` makes is ready with it; `free` has kernels of its own, which make_ready names as it compiles."""
    assert all(compilation.ready_for(name) for name in ("none", "paper+cache+rest", "cells", "certified", "auto"))
    told: list[str] = []
    compilation._methods.discard(compilation._variant(1, "bvh8", "free"))
    assert not compilation.ready_for("free")
    compilation.make_ready("free", progress=lambda what, fraction: told.append(what))
    compilation.make_ready("free", progress=lambda what, fraction: told.append(what))
    assert told == ["compiling the kernels of Free (answers known)"] and compilation.ready_for("free")
    assert not compilation.ready_for("free", lights=40)
