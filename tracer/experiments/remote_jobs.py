"""Jobs that processes of a cluster do, in any order, and what comes of them, as soon as it comes.

Scenes travel as bytes within the jobs' graph: nobody needs to see the same files, one process gets them from the
scheduler and the others from one another, and a process that dies takes nothing along.
"""

from __future__ import annotations

import pickle
import platform
import secrets
from collections import Counter, OrderedDict
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import nullcontext
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue
from typing import Any

from filelock import FileLock

from tracer.compiling.compilation import compiled_before, is_first, make_all_ready, ready_for
from tracer.experiments.cluster import Cluster, in_one_line
from tracer.geometry.world import World
from tracer.runtime.kernel_cache import cache_root
from tracer.scene.model import Cancelled, Scene
from tracer.util.version import program_version, tracer_code

Emit = Callable[[Any], None]
Function = Callable[[Any, Scene, Emit, Callable[[], bool]], Any]
"""What a process does with what it is given, by a scene: it may emit parts of its result, and ask whether it is to
stop.  It lies in a module that can be imported there."""
WAIT = 0.1  # seconds from one look at `cancelled` to the next
_FIRST = 4096  # jobs that are handed over at once


@dataclass(frozen=True)
class Job:
    """What to do by the scene of a name."""

    scene: str
    given: Any


@dataclass
class Outcome:
    """What has come since the last one: parts and whole results of jobs, by their numbers, and why some failed."""

    parts: list[tuple[int, Any]] = field(default_factory=list)
    results: list[tuple[int, Any]] = field(default_factory=list)
    failures: list[tuple[int, str]] = field(default_factory=list)

    @property
    def ended(self) -> int:
        """How many jobs have ended."""
        return len(self.results) + len(self.failures)


def do(
    cluster: Cluster,
    function: Function,
    scenes: Mapping[str, Scene],
    jobs: Sequence[Job],
    cancelled: Callable[[], bool] = lambda: False,
    on_wait: Callable[[], None] = lambda: None,
    fetch: bool = True,
) -> Iterator[Outcome]:
    """Do jobs, the first ones first; yields what has come as long as there is something to come.

    A job whose process dies is done again by another, up to three times; one that fails ends no other.  What a job
    emits is on its way before the job ends, so that it outlives its process; what it returns stays there until it is
    fetched, for which there must be a reason: size, as the scheduler remembers the last 1000 parts.  Without `fetch`,
    results are None.  Raises Cancelled once `cancelled()`; `on_wait` is called now and then."""
    client, topic = cluster.client, f"shadowcull-{secrets.token_hex(8)}"
    arrived: SimpleQueue[tuple[int, Any, bool]] = SimpleQueue()  # a job, its part or its future, and which

    def take(event: Any) -> None:
        number, part = pickle.loads(event[1])
        arrived.put((number, part, True))

    client.subscribe_topic(topic, take)
    futures: dict[int, Any] = {}
    program = program_version(), tracer_code()
    try:
        sent: dict[str, Any] = {}
        needed = Counter(job.scene for job in jobs)
        waiting = iter(enumerate(jobs))
        left = len(jobs)

        def hand_over(most: int) -> None:
            for number, job in _next(waiting, most):
                if job.scene not in sent:
                    blob = pickle.dumps(scenes[job.scene], pickle.HIGHEST_PROTOCOL)
                    sent[job.scene] = client.submit(_unpacked, blob, key=f"scene-{topic}-{len(sent)}", priority=0)
                future = client.submit(
                    _perform, function, job.given, sent[job.scene], topic, number, program,
                    key=f"job-{topic}-{number}", priority=-number, pure=False,
                )  # fmt: skip
                futures[number] = future
                future.add_done_callback(lambda done, number=number: arrived.put((number, done, False)))

        hand_over(_FIRST)
        while left:
            outcome = _sorted(_all_of(arrived))
            ended = [(number, futures[number]) for number, _ in outcome.results]
            if fetch and ended:
                outcome.results = _fetched(client, ended, cancelled)
            for number, _ in [*outcome.results, *outcome.failures]:
                futures.pop(number).release()
                scene = jobs[number].scene
                needed[scene] -= 1
                if not needed[scene]:
                    sent.pop(scene).release()  # no process keeps it any longer
            left -= outcome.ended
            hand_over(outcome.ended)
            if outcome.parts or outcome.ended:
                yield outcome
            if cancelled():
                raise Cancelled("cancelled")
            on_wait()
    finally:
        if futures:
            client.cancel(list(futures.values()), force=True)
        client.unsubscribe_topic(topic)


def _next(waiting: Iterator[tuple[int, Job]], most: int) -> Iterator[tuple[int, Job]]:
    for _, one in zip(range(most), waiting):
        yield one


def _all_of(arrived: SimpleQueue[tuple[int, Any, bool]]) -> list[tuple[int, Any, bool]]:
    """All that has arrived, after a short wait for something."""
    found = []
    try:
        found.append(arrived.get(timeout=WAIT))
        while True:
            found.append(arrived.get_nowait())
    except Empty:
        return found


def _sorted(arrived: list[tuple[int, Any, bool]]) -> Outcome:
    """What has arrived, by its kind; results are still to be fetched."""
    outcome = Outcome()
    for number, what, is_part in arrived:
        if is_part:
            outcome.parts.append((number, what))
        elif what.status == "finished":
            outcome.results.append((number, None))
        else:
            outcome.failures.append((number, _why(what)))
    return outcome


def _fetched(client: Any, ended: list[tuple[int, Any]], cancelled: Callable[[], bool]) -> list[tuple[int, Any]]:
    """The results of futures; of one whose process has died since, once it is there again.  Raises Cancelled."""
    fetcher = ThreadPoolExecutor(1, thread_name_prefix="fetch")
    try:
        values = fetcher.submit(client.gather, [future for _, future in ended])
        while not values.done():
            wait([values], WAIT)
            if cancelled():
                raise Cancelled("cancelled")
        return [(number, value) for (number, _), value in zip(ended, values.result())]
    finally:
        fetcher.shutdown(wait=False)


def _why(future: Any) -> str:
    """Why a job failed, in one line."""
    from distributed.scheduler import KilledWorker

    error = future.exception()
    if isinstance(error, KilledWorker):
        return "each process that tried it died, perhaps for want of memory"
    if isinstance(error, ModuleNotFoundError):
        return f"a process lacks what it needs; install the same Shadowcull there ({error})"
    return in_one_line(error) if error is not None else "it was cancelled by the scheduler"


# --- in the processes of the cluster ------------------------------------------------------------------

KEPT_WORLDS = 2
_worlds: OrderedDict[tuple[str, str, float], World] = OrderedDict()


def world_of(scene: Scene, code: str, accelerator: str, start: float) -> World:
    """The geometry of a scene of this code, as it is kept or built at `start`; for one renderer at a time."""
    key = (code, accelerator, start)
    if key not in _worlds:
        while len(_worlds) >= KEPT_WORLDS:
            _worlds.popitem(last=False)
        _worlds[key] = World(scene, start, accelerator)
    _worlds.move_to_end(key)
    return _worlds[key]


def prepare(lights: int, accelerator: str, method: str) -> None:
    """Make ready the kernels; of the processes that share a cache, one compiles and the others wait for it."""
    kept = compiled_before(lights, accelerator, is_first(method)) and ready_for(method, lights, accelerator)
    with nullcontext() if kept else FileLock(cache_root() / "sweep.lock"):
        make_all_ready([method], lights, accelerator)


def check_program(version: str, tracer: str) -> None:
    """Raise ValueError, in one line, where this process runs another program than the one that asks."""
    if (version, tracer) != (program_version(), tracer_code()):
        raise ValueError(
            f"{platform.node()} has Shadowcull {program_version()} ({tracer_code()}), not {version} ({tracer}); "
            "install the same there"
        )


def _unpacked(blob: bytes) -> Scene:
    scene: Scene = pickle.loads(blob)
    return scene


def _perform(function: Function, given: Any, scene: Scene, topic: str, number: int, program: tuple[str, str]) -> Any:
    """Do a job in a process of the cluster."""
    from distributed import get_worker

    check_program(*program)
    worker: Any = get_worker()
    key = worker.get_current_task()

    def emit(part: Any) -> None:
        worker.log_event(topic, pickle.dumps((number, part), pickle.HIGHEST_PROTOCOL))

    def cancelled() -> bool:
        """Nobody waits for it any more: whoever asked has cancelled it, or has gone."""
        state = worker.state.tasks.get(key)
        return state is None or state.state in ("cancelled", "released", "forgotten")

    return function(given, scene, emit, cancelled)
