"""The method `auto`: it never takes much longer than `none`, takes what pays, and does not flutter; pictures are right
whatever it decides."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np
import pytest

import tracer
from tests.sweeps import ACCELERATORS, cases
from tests.tracing.nasty_worlds import nasty_walk
from tests.tracing.worlds import certificates_of
from tracer.method import Kind, register, unregister
from tracer.methods.adaptive_policy import AdaptivePolicy, Plan, Trial
from tracer.methods.auto import Auto
from tracer.methods.interface import Services
from tracer.neighbours.certified.cost_model import CostModel

TILES = 64
LEARNT = 3.0  # frames' time of certifying after which all is known


@dataclass
class Machine:
    """Frames of 0.1 s by `none`, and how a method fares with them: what look-ups save, as a part, of the known and
    the unknown, how noisy times are, and what setting up takes."""

    saves: Callable[[float], float]
    noise: float = 0.0
    setup: float = 0.05
    dear: bool = False
    none: list[float] = field(default_factory=list)
    auto: list[float] = field(default_factory=list)
    looked_up: list[bool] = field(default_factory=list)

    def run(self, frames: int, seed: int = 1) -> Machine:
        rng = np.random.default_rng(seed)
        policy, ready, invested = AdaptivePolicy(self.setup, self.dear), False, 0.0
        for _ in range(frames):
            plan = policy.plan(TILES)
            spent, frame = 0.0, 0.1 * (1.0 + 0.3 * rng.random())
            if plan.needs_certificates and not ready:
                ready, spent = True, self.setup * (0.7 + 0.6 * rng.random())
                policy.spend(spent)
                policy.made_ready()
            certified = min(plan.seconds * (1.0 + 0.5 * rng.random()), max(0.0, 0.1 * LEARNT - invested))
            policy.spend(certified)
            invested += certified
            known = min(1.0, invested / (0.1 * LEARNT))
            shading = frame * (1.0 - self.saves(known) if plan.looks_up else 1.0)
            trials = [self._trial(frame / TILES, known, rng) for _ in range(plan.trials)]
            tried = sum(t.plain if plan.looks_up else t.certified for t in trials)
            policy.spend(tried, trying=True)
            whole = shading + spent + certified + tried
            policy.finish(whole, shading, trials)
            self.none.append(frame)
            self.auto.append(whole)
            self.looked_up.append(plan.looks_up)
        return self

    def _trial(self, plain: float, known: float, rng: np.random.Generator) -> Trial:
        told = plain * (1.0 - self.saves(known)) * np.exp(self.noise * rng.normal())
        told *= 4.0 if rng.random() < 0.5 * self.noise else 1.0  # somebody else had the processor
        return Trial(plain, told, 1000, int(1000 * known))

    @property
    def worst(self) -> float:
        """Over any fifty frames, auto's time against none's."""
        none, auto = (np.convolve(times, np.ones(50), "valid") for times in (self.none, self.auto))
        return float((auto / none).max())

    @property
    def changes(self) -> int:
        return int(np.count_nonzero(np.diff(self.looked_up)))


@pytest.mark.parametrize("noise", [0.0, 0.05, 0.15])
@pytest.mark.parametrize("dear", [False, True])
def test_where_look_ups_never_pay_hardly_anything_is_lost(noise: float, dear: bool):
    for seed in range(cases(2, 5)):
        machine = Machine(lambda known: 0.05 * known - 0.06, noise, dear=dear).run(400, seed)
        assert machine.worst < 1.03
        assert not any(machine.looked_up[100:]) and machine.changes <= (2 if dear else 0)


@pytest.mark.parametrize("noise", [0.0, 0.05, 0.15])
def test_where_they_pay_they_are_made(noise: float):
    for seed in range(cases(2, 5)):
        machine = Machine(lambda known: 0.35 * known - 0.03, noise).run(600, seed)
        assert machine.worst < 1.03 and machine.changes <= (1 if noise < 0.1 else 5)
        assert sum(machine.auto[400:]) < (0.8 if noise < 0.1 else 0.95) * sum(machine.none[400:])


def test_where_rays_are_dear_they_are_made_from_the_start():
    machine = Machine(lambda known: 0.5 * known, 0.05, dear=True).run(200)
    assert not machine.looked_up[0] and machine.looked_up[1] and all(machine.looked_up[100:])
    assert machine.worst < 1.03 and sum(machine.auto) < 0.8 * sum(machine.none)


def test_when_they_no_longer_pay_they_are_left():
    pays = [True]
    machine = Machine(lambda known: (0.3 if pays[0] else -0.1) * known, 0.05)
    policy = AdaptivePolicy(0.01, False)
    policy.made_ready()
    assert policy.reason == "Every shadow ray is traced: certificates have had too few trials yet."
    rng, wrong = np.random.default_rng(3), 0
    for frame in range(600):
        pays[0] = frame < 300
        plan = policy.plan(TILES)
        trials = [machine._trial(0.1 / TILES, 1.0, rng) for _ in range(plan.trials)]
        for trial in trials:
            policy.spend(trial.plain, trying=True)
        policy.finish(0.1, 0.1, trials)
        wrong += plan.looks_up and not pays[0]
        assert frame != 299 or plan.looks_up
    assert wrong < 30 and not policy.looks_up and "slower" in policy.reason


def test_nothing_is_bought_that_the_purse_cannot_pay():
    policy = AdaptivePolicy(10.0, False)
    for _ in range(1000):
        assert policy.plan(TILES) == Plan()
        policy.finish(0.1, 0.1, [])
    assert "not worth setting up yet" in policy.reason
    assert policy.plan(TILES, patience=0.4) == Plan(False, 0.4, 8), "where nobody waits it costs nothing"


# --- frames ------------------------------------------------------------------------------------------


class ByLot(AdaptivePolicy):
    """Decides by lot."""

    def __init__(self, *_: object) -> None:
        super().__init__(0.0, False)
        self._lots = np.random.default_rng(7)

    def plan(self, tiles: int, patience: float = 0.0) -> Plan:
        looks_up, certifies, trials = self._lots.integers(0, [2, 2, 3])
        return Plan(bool(looks_up), 10.0 * certifies, int(trials))


class Whimsical(Auto):
    """Looks certificates up, makes some and tries tiles as the lot falls."""

    def __init__(self, services: Services) -> None:
        super().__init__(services)
        self.policy = ByLot()


@pytest.fixture
def whimsical() -> Iterator[str]:
    register(Kind("whimsical", "By lot.", Whimsical, has_certificates=True, adaptive=True))
    yield "whimsical"
    unregister("whimsical")


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_pictures_and_modes_are_right_whatever_is_decided(whimsical: str, accelerator: str):
    model = CostModel(2, 4, 3, 48, True, 1)
    plain, told, tried = 0, 0, 0
    for seed in range(cases(5, 20)):
        walk = nasty_walk(seed, frames=8)
        world = tracer.World(walk.scene, accelerator=accelerator)
        settings = {"width": 70, "height": 20, "depth": 2, "accelerator": accelerator, "modes": bool(seed % 2)}
        none, auto = (
            tracer.Renderer(
                walk.scene,
                tracer.Settings(method=m, threads=1 + seed % 2, **settings),
                world=world,
                cost_model=model,
            )
            for m in ("none+rest", whimsical)
        )
        for number, (time, camera) in enumerate(walk.frames):
            expected, frame = none.render(time, camera), auto.render(time, camera)
            assert frame.color.tobytes() == expected.color.tobytes(), f"seed {seed}, frame {number}"
            assert not auto.settings.modes or np.array_equal(frame.modes, expected.modes)
            assert frame.statistics.by_modes == expected.statistics.by_modes
            shadow, other = frame.statistics.shadow, expected.statistics.shadow
            assert shadow.due == other.due and frame.statistics.secondary.rays == expected.statistics.secondary.rays
            assert (frame.certificates is not None) >= (shadow.culled > 0)
            plain, told = plain + (frame.certificates is None), told + (shadow.culled > 0)
        tried += len(auto.begin(0.0).methods[0].policy._trials)
    assert min(plain, told, tried) > 10


def test_auto_says_what_it_does_and_why():
    walk = nasty_walk(2, frames=4)
    auto = tracer.Renderer(walk.scene, tracer.Settings(32, 24, 2, "auto"))
    for time, camera in walk.frames:
        decision = auto.render(time, camera).statistics.decision
        assert decision.endswith(".") and decision.startswith(
            ("Every shadow ray is traced", "Certificates are looked up")
        )
    assert tracer.Renderer(walk.scene, tracer.Settings(8, 8, 1, "none")).render().statistics.decision == ""
    auto.reset_modes()
    assert certificates_of(auto) is None


def test_a_frame_that_nobody_waits_for_certifies_as_long_as_it_may():
    walk = nasty_walk(5, frames=4)
    settings = tracer.Settings(96, 64, 2, "auto", certificate_seconds=5.0, patient=True)
    auto = tracer.Renderer(walk.scene, settings)
    assert auto.render(*walk.frames[0]).statistics.certificates > 0


def test_with_lamps_of_another_kind_it_measures_anew():
    """What certificates saved with points says nothing of lamps, but what has been set up stays."""
    made = nasty_walk(3, lights=2).scene
    renderer = tracer.Renderer(made, tracer.Settings(32, 24, 1, "auto", threads=1))
    auto = next(method for method in renderer.begin(made.time_range[0]).methods if isinstance(method, Auto))
    for change in ({"lamp_samples": 16, "lamp_radius": 0.2}, {"lamp_samples": 64}):
        renderer.render(made.time_range[0])
        before = auto.policy
        renderer.render(made.time_range[0])
        assert auto.policy is before
        renderer.settings = replace(renderer.settings, **change)
        renderer.render(made.time_range[0])
        assert auto.policy is not before, change
