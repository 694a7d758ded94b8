"""How contestants are timed: turn by turn, what they answer compared, and whether there is a second core at all."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Protocol

import numpy as np
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh
from numba import njit
from numpy.typing import NDArray

from tests.bench.embree import MODES, EmbreeRays, EmbreeScene, Mode
from tracer.geometry.rays import RAY_OFFSET, Rays
from tracer.geometry.world import World
from tracer.runtime.parallel import for_each_chunk, thread_count

SAME_T = 1e-4  # relative
LEAST_AGREEMENT = 0.9999
SPIN = 4_000_000  # steps, some ten milliseconds
SECOND_CORE = 1.9  # what two threads that only spin must gain on one, for the second core to be called there


class Contestant(Protocol):
    """What is timed is `run` alone."""

    name: str

    def prepare(self) -> None: ...

    def run(self) -> None: ...

    def answers(self) -> NDArray: ...


class Ours:
    """A batch of rays that a placed world is asked about."""

    def __init__(self, world: World, rays: Rays, closest: bool, threads: int = 1) -> None:
        self.name = f"ours, {threads} thread{'s' if threads > 1 else ''}"
        self._query: Callable[[Rays, int], Any] = world.closest_hits if closest else world.any_hits
        self._rays, self._threads, self._result = rays, threads, None

    def prepare(self) -> None:
        self._result = None

    def run(self) -> None:
        self._result = self._query(self._rays, self._threads)

    def answers(self) -> NDArray[np.float32]:
        """As `EmbreeRays.answers` of the last run."""
        result: Any = self._result
        return result.t if hasattr(result, "t") else np.where(result, np.float32(-np.inf), self._rays.t_max)


class Embreex:
    """A batch of rays of unit direction, by embreex's own call for closest hits."""

    name = "embreex"

    def __init__(self, triangles: NDArray[np.float32], rays: Rays) -> None:
        self._scene = rtcore_scene.EmbreeScene()
        self._mesh = TriangleMesh(self._scene, triangles)
        self._origins, self._directions = (np.ascontiguousarray(v.T) for v in (rays.origin, rays.direction))
        self._found: Any = None

    def prepare(self) -> None:
        self._found = None

    def run(self) -> None:
        self._found = self._scene.run(self._origins, self._directions, output=1)

    def answers(self) -> NDArray[np.float32]:
        return np.where(np.asarray(self._found["primID"]) >= 0, self._found["tfar"], np.float32(np.inf))


class All:
    """Several contestants as one, run one after another."""

    def __init__(self, name: str, parts: Sequence[Contestant]) -> None:
        self.name, self._parts = name, parts

    def prepare(self) -> None:
        for part in self._parts:
            part.prepare()

    def run(self) -> None:
        for part in self._parts:
            part.run()

    def answers(self) -> NDArray:
        return np.concatenate([part.answers() for part in self._parts])


@dataclass(frozen=True)
class Spread:
    """Median and quartiles."""

    median: float
    lower: float
    upper: float

    @staticmethod
    def of(values: Sequence[float] | NDArray) -> Spread:
        return Spread(*(float(x) for x in np.percentile(values, (50, 25, 75))))

    def text(self, form: str = ".2f") -> str:
        return f"{self.median:{form}} ({self.lower:{form}} to {self.upper:{form}})"

    def to_json(self) -> dict[str, float]:
        return asdict(self)


def seconds(contestant: Contestant) -> float:
    """One run."""
    contestant.prepare()
    before = time.perf_counter()
    contestant.run()
    return time.perf_counter() - before


def race(
    contestants: Sequence[Contestant], rounds: int, between: Callable[[], float] | None = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Seconds (contestants, rounds), after a first run of each that is not timed; they take turns, and every
    other round in the opposite order.  `between` is called before and after each round: (rounds,), its lower value."""
    for contestant in contestants:
        seconds(contestant)
    times = np.empty((len(contestants), rounds))
    beside = np.empty(rounds + 1)
    for k in range(rounds):
        beside[k] = between() if between else 0.0
        for i in range(len(contestants))[:: 1 if k % 2 else -1]:
            times[i, k] = seconds(contestants[i])
    beside[rounds] = between() if between else 0.0
    return times, np.minimum(beside[:-1], beside[1:])


def heats(scene: EmbreeScene, rays: Rays, closest: bool, runs: int, modes: Sequence[Mode] = MODES) -> dict[Mode, float]:
    """The least seconds of so many runs of each mode on one thread, the best mode first."""
    least = {}
    for mode in modes:
        contestant = EmbreeRays(scene, rays, closest, mode)
        least[mode] = min(seconds(contestant) for _ in range(runs + 1))
    return dict(sorted(least.items(), key=lambda item: item[1]))


def oracle(scene: EmbreeScene, rays: Rays, closest: bool) -> NDArray[np.float32]:
    """Embree's answers, ray by ray.  With robust off it misses some triangles that are large and flat, so
    answers are held against those of a robust scene, whoever gives them."""
    asked = EmbreeRays(scene, rays, closest, Mode(1, False, True))
    asked.prepare()
    asked.run()
    return asked.answers()


def differing(
    rays: Rays, one: NDArray[np.float32], other: NDArray[np.float32], offset: float = np.float32(RAY_OFFSET)
) -> int:
    """How many rays have answers that are not the same: both a miss, both blocked, or t within SAME_T.

    Of hits right at the origin that asks too much: one contestant's rays are carried into the space of an
    object, the other's triangles out of it, either rounds coordinates, and grazing rays make much of
    it.  So t may also differ by as much as lies between a surface and where the tracer's rays leave it.
    """
    slack = offset * np.abs(rays.origin).max(axis=0)
    hit = np.isfinite(other)
    apart = np.abs(np.subtract(one, other, where=hit, out=np.zeros_like(one)))
    same = np.where(hit, apart <= SAME_T * np.abs(np.where(hit, other, 0)) + slack, one == other)
    return int((~same).sum())


@njit(nogil=True)
def _spin(steps):
    """Work that needs a core and nothing else."""
    state = np.uint64(1)
    for _ in range(steps):
        state ^= state << np.uint64(13)  # xorshift: no step can be spared
        state ^= state >> np.uint64(7)
        state ^= state << np.uint64(17)
    return state


def _spin_once(chunk: int, worker: int) -> None:
    _spin(SPIN)


def second_core() -> float:
    """How much faster two threads spin than one, at best 2: what the machine grants right now."""
    took = []
    for threads in (1, 2, 1):  # what disturbs one thread alone must not pass for a second core
        before = time.perf_counter()
        for_each_chunk(_spin_once, threads, threads)
        took.append(time.perf_counter() - before)
    return 2 * min(took[0], took[2]) / took[1]


def thread_numbers() -> tuple[int, ...]:
    """One thread, and two where this process may use as many."""
    return (1, 2) if thread_count() > 1 else (1,)
