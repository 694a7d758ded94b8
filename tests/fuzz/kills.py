"""Kills programs that write, at random moments, and looks at what is left: the old file or the new one, whole.

A child is forked for each kill, so that hundreds of them take seconds: it writes one version of a file after another
until it is killed, by a signal that nothing can catch.  Then each file that people see must be whole, and once somebody
writes there again, nothing may be left of the dead.
"""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

Write = Callable[[Path, int], None]
"""Writes a version of something, by its number, in a folder."""
Check = Callable[[Path], None]
"""Raises an exception where a file that has its name is not whole."""


@dataclass(frozen=True)
class Written:
    """Something that the program writes; `tells` unless another is to tell that it could not be written."""

    name: str
    write: Write
    check: Check
    tells: bool = True


@dataclass
class Outcome:
    """What was found: kills, among them those that came while something was half written; and what was wrong."""

    kills: int = 0
    interrupted: int = 0
    broken: int = 0
    litter: int = 0
    first: str = ""

    @property
    def good(self) -> bool:
        return not self.broken and not self.litter

    def fail(self, what: str) -> None:
        self.first = self.first or what


def kill_often(written: Written, folder: Path, kills: int, rng: np.random.Generator) -> Outcome:
    """Kill so many writers one after another, each at a moment of its own; the folder is there and empty."""
    outcome = Outcome()
    one = _in_child(lambda: written.write(folder, 1))
    for number in range(kills):
        killed(lambda at: written.write(folder, at), 2 + number * 1000, float(rng.uniform(0.0, 2.0 * one)))
        outcome.kills += 1
        outcome.interrupted += any(_is_hidden(path) for path in folder.rglob("*"))
        try:
            written.check(folder)
        except Exception as error:
            outcome.broken += 1
            outcome.fail(f"{type(error).__name__}: {error}")
            for path in folder.rglob("*"):  # so that each break is counted once
                if path.is_file():
                    path.unlink()
    _in_child(lambda: written.write(folder, 1))
    left = [path.name for path in folder.rglob("*") if _is_hidden(path)]
    outcome.litter = len(left)
    if left:
        outcome.fail(f"left behind: {left[0]}")
    return outcome


def _in_child(write: Callable[[], None]) -> float:
    """Let a child write, which knows nothing of what this process has written; the seconds that it takes."""
    read, told = os.pipe()

    def work() -> None:
        write()  # what is needed is imported
        began = time.perf_counter()
        write()
        os.write(told, repr(time.perf_counter() - began).encode())

    child = forked(work)
    os.close(told)
    with os.fdopen(read) as pipe:
        text = pipe.read()
    assert os.waitpid(child, 0)[1] == 0, "a writer failed"
    return float(text)


def forked(work: Callable[[], None]) -> int:
    """A child that does some work; its exit code is 1 if that raises an exception, which it prints."""
    child = os.fork()
    if child == 0:
        code = 1
        try:
            work()
            code = 0
        except BaseException as error:
            print(f"a child failed: {type(error).__name__}: {error}", file=sys.stderr, flush=True)
        finally:
            os._exit(code)
    return child


def killed(write: Callable[[int], None], first: int, seconds: float) -> None:
    """Let a child write from a number on, and kill it after so many seconds from its first write on."""
    read, told = os.pipe()

    def work() -> None:
        os.write(told, b"x")
        for number in range(first, first + 1000):
            write(number)

    child = forked(work)
    os.close(told)
    os.read(read, 1)
    os.close(read)
    time.sleep(seconds)
    os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    assert os.WIFSIGNALED(status), "a writer ended before it was killed"


def _is_hidden(path: Path) -> bool:
    return path.is_file() and path.name.startswith(".")
