"""Compiling in processes of their own, a part each: numba compiles one kernel at a time in a process, and holds the GIL
for most of it.

    python -m tracer.compiling.processes PART LIGHTS ACCELERATOR
"""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Collection
from functools import cache
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

from numba.core.types import Boolean, Number
from numba.core.types.functions import BaseFunction

from tracer.compiling.estimate import Estimate
from tracer.compiling.steps import FOR_A_PICTURE, NEEDS, PARTS, SHARES, steps_of
from tracer.runtime.kernel_cache import cache_root
from tracer.scene.model import Progress
from tracer.simd.vectors import Mask, Vector

_USUAL = 70.0  # seconds that all of it takes one process on a usual machine, with all cores busy
_POLL = 0.1  # seconds from one look at a process to the next
_STEP = "next step: "  # before what a process says of itself, since whatever it calls may print too


def compile_in_processes(
    report: Progress,
    lights: int,
    accelerator: str,
    done: set[str],
    drawable: Callable[[], None] = lambda: None,
    wanted: Collection[str] = tuple(PARTS),
) -> None:
    """Compile the wanted parts into the cache, as many at once as there are cores; adds the steps to `done`.

    Calls `drawable` when all that a picture needs is there; what `report` raises ends the processes."""
    reported: SimpleQueue[tuple[str, str]] = SimpleQueue()  # a part, and its next step
    slots = max(2, os.cpu_count() or 1)
    parts = {part: steps for part, steps in PARTS.items() if part in wanted}
    whole = sum(SHARES[step] for steps in parts.values() for step in steps)
    shares = {step: SHARES[step] / whole for steps in parts.values() for step in steps}
    estimate = Estimate(parts, shares, slots, whole * _USUAL)
    workers: dict[str, subprocess.Popen] = {}
    readers: list[threading.Thread] = []
    under_way: dict[str, str] = {}
    waiting, ended, drawn = list(parts), set(PARTS) - set(parts), False
    try:
        while True:
            for part in [part for part in waiting if ended.issuperset(NEEDS.get(part, ()))]:
                if sum(other not in ended for other in workers) < slots:
                    waiting.remove(part)
                    workers[part] = worker = _worker(part, str(lights), accelerator)
                    readers.append(threading.Thread(target=_pass_on, args=(part, worker, reported), daemon=True))
                    readers[-1].start()
            if not drawn and ended.issuperset(FOR_A_PICTURE):
                drawn = True
                drawable()
            picture = None if drawn else estimate.seconds_left(FOR_A_PICTURE)
            report(_in_words(under_way, estimate.seconds_left(), picture), estimate.fraction)
            if len(ended) == len(PARTS):
                return
            try:
                part, step = reported.get(timeout=_POLL)
            except Empty:
                if not any(reader.is_alive() for reader in readers) and reported.empty():
                    return  # none has said why; what is lacking is compiled when it is needed
                continue
            if part in under_way:
                estimate.end(under_way[part])
                done.add(under_way.pop(part))
            if step:
                under_way[part] = step
                estimate.begin(step)
            else:
                ended.add(part)
    finally:
        for worker in workers.values():
            worker.kill()
            worker.wait()
            assert worker.stdin is not None
            worker.stdin.close()


def _in_words(under_way: dict[str, str], left: float | None, picture: float | None) -> str:
    """What is being compiled, and for how many seconds still: all of it, and what comes before a first picture."""
    names = ", ".join(under_way.values())
    if left is None:
        return names or "starting"
    if picture is None or picture == left:
        return f"{names or 'finishing'}; about {max(round(left), 1)} s left"
    return f"{names}; first picture in about {max(round(picture), 1)} s, all in {max(round(left), 1)} s"


def _pass_on(part: str, worker: subprocess.Popen, reported: SimpleQueue[tuple[str, str]]) -> None:
    """Queue each step that a worker names, until the worker ends."""
    assert worker.stdout is not None
    for line in worker.stdout:
        if line.startswith(_STEP):
            reported.put((part, line.removeprefix(_STEP).strip()))


def _worker(*arguments: str) -> subprocess.Popen:
    """A process that compiles one part, and names its steps on its standard output."""
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join(dict.fromkeys([*filter(None, sys.path), str(Path(__file__).parents[2])])),
        "SHADOWCULL_CACHE_DIR": str(cache_root()),
    }
    return subprocess.Popen(
        [sys.executable, "-P", "-m", "tracer.compiling.processes", *arguments],
        env=environment,
        stdin=subprocess.PIPE,  # nothing is written to it: it closes when this process ends, however that happens
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        encoding="utf-8",
        # Ctrl-C is for the process that asked: POSIX takes the first, Windows the second.
        start_new_session=True,
        creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),
    )


def only_compile() -> None:
    """Make this process one that compiles for another, and ends with it.  Nobody looks for garbage: with what numba
    keeps of each kernel, that costs a sixth of the time (64 of 76 s of a frame's), and leaves 0.7 GB, not 0.4."""
    threading.Thread(target=_die_with_parent, daemon=True).start()
    gc.freeze()
    gc.disable()
    ask_operators_once()


def ask_operators_once() -> None:
    """Let numba find out only once what an operator makes of numbers or vectors: it tries dozens of ways in turn, for
    each `+` in a kernel, with the same answer.  What it makes of functions depends on who calls, and in what order."""
    ask: Any = BaseFunction.get_call_type
    once = cache(lambda function, context, args: ask(function, context, args, {}))

    def asked_once(function: Any, context: Any, args: Any, kws: Any) -> Any:
        is_operator = getattr(function.typing_key, "__module__", "") == "_operator"
        if is_operator and all(isinstance(kind, (Number, Boolean, Vector, Mask)) for kind in args):
            return once(function, context, args)
        return ask(function, context, args, kws)

    BaseFunction.get_call_type = asked_once  # type: ignore[method-assign, assignment]


def _die_with_parent() -> None:
    os.read(0, 1)
    os._exit(1)


def _main(part: str, lights: str, accelerator: str) -> None:
    """Compile a part, and say on standard output which step comes next, and at the end that there is none."""
    only_compile()
    for step in steps_of(part, int(lights), accelerator):
        print(_STEP + step, flush=True)
    print(_STEP, flush=True)
    os._exit(0)  # without taking everything down piece by piece: that takes a second


if __name__ == "__main__":
    _main(*sys.argv[1:])
