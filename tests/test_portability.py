"""Nothing that only POSIX has is needed to import the program, so that it starts on Windows and macOS too."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.sweeps import ALL
from tracer.experiments.cluster import Cluster
from tracer.runtime import parallel

ROOT = Path(__file__).resolve().parent.parent

# Other people's packages are loaded before anything is taken away: what they need where is their own affair.
IMPORT_EVERYTHING = """
import importlib, os, pkgutil, signal, sys
import filelock, glfw, imgui_bundle, matplotlib.figure, moderngl, numba, PIL.Image, platformdirs, rich.progress, trimesh

for name in ("fcntl", "grp", "posix", "pty", "pwd", "readline", "resource", "syslog", "termios", "tty"):
    sys.modules[name] = None
for name in ("fork", "geteuid", "getpgid", "getpriority", "getuid", "killpg", "mkfifo", "nice", "pread", "setpriority",
             "setsid", "sched_getaffinity", "uname", "O_CLOEXEC", "O_NONBLOCK", "PRIO_PROCESS", "WNOHANG"):
    delattr(os, name)
for name in ("SIGALRM", "SIGHUP", "SIGKILL", "SIGPIPE", "SIGUSR1", "SIGWINCH", "alarm", "pthread_kill", "sigwait"):
    delattr(signal, name)

import tracer, viewer
for package in (tracer, viewer):
    for module in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
            print(module.name)
"""


@pytest.mark.skipif(os.name != "posix", reason="what POSIX has cannot be taken away where it is not there")
@pytest.mark.skipif(not ALL, reason="left to make test-all, and to CI on Windows")
def test_everything_can_be_imported_without_what_only_posix_has() -> None:
    done = subprocess.run([sys.executable, "-c", IMPORT_EVERYTHING], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    files = {path for package in ("tracer", "viewer") for path in (ROOT / package).rglob("*.py")}
    expected = {path for path in files if path.name not in ("__init__.py", "__main__.py")}
    imported = {ROOT.joinpath(*name.split(".")).with_suffix(".py") for name in done.stdout.split()}
    assert imported >= expected, f"not imported: {sorted(map(str, expected - imported))}"


def test_threads_start_where_they_have_no_priorities(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only Linux gives threads priorities of their own: elsewhere a thread's number is no process's."""

    def no_such_process(kind: int, number: int) -> int:
        raise ProcessLookupError

    monkeypatch.setattr(sys, "platform", "darwin")
    monkeypatch.setattr(os, "getpriority", no_such_process, raising=False)
    done = [False] * 4
    parallel.for_each_chunk(lambda chunk, worker: done.__setitem__(chunk, True), len(done), threads=2)
    assert all(done)


def test_processes_are_ended_where_there_is_no_sigkill(monkeypatch: pytest.MonkeyPatch) -> None:
    """As on Windows."""
    with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as process:
        monkeypatch.delattr(signal, "SIGKILL", raising=False)
        nanny = SimpleNamespace(pid=process.pid)
        Cluster(None, SimpleNamespace(workers={0: nanny})).kill()
        assert process.wait(30) != 0


def test_as_many_threads_as_cores_where_none_tells_which_it_may_use(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: 5)
    assert parallel.thread_count() == 5
    monkeypatch.setattr(os, "cpu_count", lambda: None)
    assert parallel.thread_count() == 1
