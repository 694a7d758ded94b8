"""What a process of its own makes of a package with one kernel.

It imports nothing of the tracer before it is told which package to take it from, so that it can be forked from a
process that has loaded numba and no more."""

from __future__ import annotations

import atexit
import contextlib
import io
import os
import sys
import tempfile
import time
import traceback
from multiprocessing.connection import Connection
from pathlib import Path

import numba

numba.njit(lambda x: x + 1)(1)  # so that whoever is forked from here finds numba ready


def ask(package: str, more: dict[str, str], numbers: tuple[str, ...], slow: bool, answer: Connection) -> None:
    """Send what `tracer.geometry.tiny.ask` in a package says of numbers, with how many versions of it came from the
    cache, and the folder that was taken; or else a text that says what went wrong.  `more` is put into the
    environment."""
    try:
        os.chdir(package)
        os.environ.update(more)
        tempfile.tempdir = None  # which the environment may have changed
        sys.path.insert(0, package)
        if slow:
            _write_slowly()
        from tracer.geometry import tiny
        from tracer.runtime.kernel_cache import folder_of

        said = [float(tiny.ask(eval(number))) for number in numbers]
        answer.send((said, sum(tiny.ask.stats.cache_hits.values()), folder_of(Path(tiny.__file__))))
        atexit._run_exitfuncs()  # which a forked process leaves out
    except BaseException:
        answer.send(traceback.format_exc())


def run(code: str, more: dict[str, str], answer: Connection) -> None:
    """Send what code from no file prints, or else a text that says what went wrong."""
    try:
        os.environ.update(more)
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            exec(code, {"__name__": "__main__"})
        answer.send((printed.getvalue(),))
    except BaseException:
        answer.send(traceback.format_exc())


def _write_slowly() -> None:
    """Between reading which versions of a kernel there are and writing that there is one more, others have time to do
    so."""
    from numba.core.caching import IndexDataCacheFile

    save = IndexDataCacheFile._save_index
    IndexDataCacheFile._save_index = lambda *a: (time.sleep(0.2), save(*a))
