"""Certificates from frame to frame: what is dropped with what moves, what is kept, and what they may take."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import tracer
from tests.sweeps import ACCELERATORS, cases
from tests.tracing.brute import meet_all
from tests.tracing.shades import BEHIND, GOING, MIDDLES, floor, going, kite, roof
from tests.tracing.worlds import GREY, certificates_of, quad, scene
from tracer.geometry.accelerators import BVH8
from tracer.geometry.rays import ray_batch
from tracer.inspect.ray_tree import ray_tree
from tracer.neighbours.certified.cells import CANDIDATES, FINAL, FULL, LIT, NOBODY, SETTLED, make_cells, named_by
from tracer.neighbours.certified.cost_model import CostModel
from tracer.neighbours.certified.invalidate import copy_kept
from tracer.neighbours.certified.store import CertificateStore
from tracer.scene.animation import Animation
from tracer.scene.model import Cancelled

SETTINGS = tracer.Settings(64, 48, 2, "certified", threads=1)
EAGER = CostModel(2, 4, 2, 8, True, 1)  # small pictures are to have many certificates on either structure
# Near enough for a hit to be certain: not much farther away than twice the largest coordinate.
LIGHTS = [(0.0, 0.0, 11.0), (1.0, -1.0, 10.0), (-1.0, 0.5, 10.0)]
LIT_SQUARES = scene(floor() + roof(6.0, 1.0), lights=LIGHTS, camera=BEHIND)
SAILING = scene(
    floor() + roof(6.0, 0.4),
    dynamic=(kite("sails"),),
    lights=[(0.0, 0.0, 10.0), (0.0, -9.0, 1.0)],
    camera=BEHIND,
    animation=Animation({"sails": going([(0, -1.0), (1, -1.0), (2, 1.0), (4, 1.0)])}),
)


@pytest.fixture(params=cases((BVH8,), ACCELERATORS))  # pictures are held against none's on every structure
def accelerator(request: pytest.FixtureRequest) -> str:
    return request.param


def _pair(made: tracer.Scene, settings: tracer.Settings) -> tuple[tracer.Renderer, tracer.Renderer]:
    """One that culls nothing and one that goes by certificates, of one world."""
    world = tracer.World(made, made.time_range[0], settings.accelerator)
    return tracer.Renderer(made, replace(settings, method="none"), world=world), tracer.Renderer(
        made, settings, world=world, cost_model=EAGER
    )


def _certificates(renderer: tracer.Renderer) -> CertificateStore:
    store = certificates_of(renderer)
    assert store is not None
    return store


def _states(renderer: tracer.Renderer) -> np.ndarray:
    """(cells, lights) what is certified, by number of the cell; cell 0 is none."""
    certificates = _certificates(renderer)
    words = certificates.cells.words[: int(certificates.cells.used[0])].astype(np.uint64)
    lights = certificates.cells.lists.shape[1]
    return np.stack([(words >> np.uint64(2 + 2 * light)) & np.uint64(3) for light in range(lights)], axis=1)


def _naming(renderer: tracer.Renderer, primitives: np.ndarray) -> np.ndarray:
    """(cells, lights) whether a certificate rests on one of primitives (k,), its own or that of the whole it is of."""
    cells = _certificates(renderer).cells
    result = np.zeros((int(cells.used[0]), cells.lists.shape[1]), np.bool_)
    for (number, light), state in np.ndenumerate(_states(renderer)):
        holder = number
        while state == FULL and cells.lists[holder, light] == NOBODY:
            holder = cells.parent[holder]
        named = named_by(cells, int(holder), light)
        if state and named is not None:
            result[number, light] = np.isin(named, primitives).any()
    return result


def _beneath(x: float) -> np.ndarray:
    """(128,) which of the floor's triangles the kite's shadow may touch where it is at x, from above."""
    return (np.abs(MIDDLES[:, 0] - 2 * x) < 1.7) & (np.abs(MIDDLES[:, 1]) < 1.7)


# --- what moves ---------------------------------------------------------------------------------------


def test_a_light_that_moves_loses_its_certificates_and_no_other_does(accelerator: str):
    none, certified = _pair(LIT_SQUARES, replace(SETTINGS, accelerator=accelerator))
    for _ in range(3):
        certified.render()
    before = _states(certified)
    assert all((before[:, light] == state).sum() > 20 for light in range(3) for state in (FULL, LIT))
    lamps = list(LIT_SQUARES.lights)
    lamps[1] = replace(lamps[1], position=(-1.0, -1.0, 10.0))
    none.scene = certified.scene = replace(LIT_SQUARES, lights=tuple(lamps))
    moving = certified.begin(0.0)
    moving.place_objects_and_lights()
    after = _states(certified)
    assert not after[:, 1].any() and np.array_equal(after[:, [0, 2]], before[:, [0, 2]])
    lamps[1] = replace(lamps[1], position=(-0.8, -1.0, 10.0))
    none.scene = certified.scene = replace(LIT_SQUARES, lights=tuple(lamps))
    for certified_again in (False, True, True):
        expected, frame = none.render(), certified.render()
        assert expected.color.tobytes() == frame.color.tobytes()
        assert _states(certified)[:, 1].any() == certified_again
    assert (_states(certified)[:, 1] == FULL).sum() > 20


def test_an_object_that_starts_takes_along_what_names_it_and_nothing_else(accelerator: str):
    certified = tracer.Renderer(SAILING, replace(SETTINGS, accelerator=accelerator), cost_model=EAGER)
    for time in (0.0, 0.3, 0.6):
        certified.render(time)
    kite = np.flatnonzero(certified.world.object_of == 1)
    before, naming = _states(certified), _naming(certified, kite)
    assert naming.sum() > 10 and (before[~naming] > 0).sum() > 100
    certified.begin(1.5).place_objects_and_lights()
    after = _states(certified)
    assert not after[naming].any() and np.array_equal(after[~naming], before[~naming])


def test_an_object_that_stops_takes_along_what_it_may_darken_and_nothing_else(accelerator: str):
    certified = tracer.Renderer(SAILING, replace(SETTINGS, accelerator=accelerator), cost_model=EAGER)
    for time in (1.6, 1.7, 2.2):  # where it is in the last of these it stays
        certified.render(time)
    before = _states(certified)
    owners = _certificates(certified).cells.owner[: len(before)] >> 1
    on_floor = owners < len(MIDDLES)
    shaded = on_floor & _beneath(1.0)[np.where(on_floor, owners, 0)]
    assert (before[shaded, 0] == LIT).sum() > 10 and (before[on_floor & ~shaded, 0] > 0).sum() > 100
    certified.begin(2.6).place_objects_and_lights()
    after = _states(certified)
    kept = after == before
    assert kept[on_floor & ~shaded].all() and kept[on_floor, 1].all(), "the other light is below it"
    assert kept[before == FULL].all()
    assert not after[~kept].any() and (~kept[shaded, 0]).sum() > 10


def test_pictures_stay_right_while_objects_start_and_stop(accelerator: str):
    none, certified = _pair(SAILING, replace(SETTINGS, accelerator=accelerator, verify=True))
    for time in GOING:
        expected, frame = none.render(time), certified.render(time)
        assert expected.color.tobytes() == frame.color.tobytes(), f"at {time}"
        assert frame.statistics.shadow.wrong == 0
    assert frame.statistics.shadow.culled > 0


# --- what they may take -------------------------------------------------------------------------------


def test_no_more_are_made_than_the_budget_allows_and_counters_repeat(accelerator: str):
    settings = replace(SETTINGS, accelerator=accelerator, width=66, height=66, certificates=50)
    runs = {threads: _pair(LIT_SQUARES, replace(settings, threads=threads)) for threads in (1, 2, 4)}
    made = []
    for _ in range(4):
        frames = [certified.render() for _, certified in runs.values()]
        told = [f.statistics.to_dict() | {"seconds": 0, "phases": {}} for f in frames]
        assert told[0] == told[1] == told[2]
        made.append(frames[0].statistics.certificates)
    assert 0 < max(made) <= 50 and sum(made) > 100
    states = [_states(certified) for _, certified in runs.values()]
    assert np.array_equal(states[0], states[1]) and np.array_equal(states[0], states[2])


def test_without_time_nothing_is_certified(accelerator: str):
    with pytest.raises(ValueError, match="certificate_seconds"):
        replace(SETTINGS, certificate_seconds=float("nan")).validated()
    for budget in ({"certificate_seconds": 0.0}, {"certificates": 0}):
        none, certified = _pair(LIT_SQUARES, replace(SETTINGS, accelerator=accelerator, **budget))
        for _ in range(2):
            expected, frame = none.render(), certified.render()
            assert expected.color.tobytes() == frame.color.tobytes()
            assert frame.statistics.certificates == frame.statistics.shadow.culled == 0
            assert "certification" in frame.statistics.phases
        assert not _states(certified).any()


def test_memory_is_bounded_and_pictures_stay_right(accelerator: str):
    settings = replace(SETTINGS, accelerator=accelerator)
    _, free = _pair(LIT_SQUARES, settings)
    cameras = [replace(BEHIND, position=(4.0 * np.sin(k), -12.0, 3.0 + k)) for k in range(6)]
    for camera in cameras:
        free.render(camera=camera)
    bound = 0.4e-6 * _certificates(free).bytes
    none, certified = _pair(LIT_SQUARES, replace(settings, certificate_memory=bound))
    for camera in [*cameras, *cameras]:
        expected, frame = none.render(camera=camera), certified.render(camera=camera)
        assert expected.color.tobytes() == frame.color.tobytes()
        assert _certificates(certified).bytes <= 1.1e6 * bound
    assert _certificates(certified).bytes > 0.3e6 * bound and frame.statistics.shadow.culled > 0


# --- what they say ------------------------------------------------------------------------------------


def test_what_a_certificate_names_is_what_blocks(accelerator: str):
    settings = replace(SETTINGS, accelerator=accelerator, width=48, height=36)
    certified = tracer.Renderer(LIT_SQUARES, settings, cost_model=EAGER)
    for _ in range(4):
        frame = certified.render()
    told = dict.fromkeys(("full", "lit", "candidates"), 0)
    for y, x in np.argwhere(frame.primitive >= 0):
        tree = ray_tree(certified, frame, x, y)
        for point, place in tree.shadow_rays():
            if point.parent >= 0:
                continue
            s, light = point.shadows, int(point.shadows.light[place])
            certificate, named = _certificates(certified).describe(point.primitive, point.end, light)
            told[certificate] = told.get(certificate, 0) + 1
            met, lit = _met(certified, tree.samples[place], point.end), s.blocker[place] < 0
            if certificate == "full":
                assert not lit and met & set(named)
            elif certificate == "lit":
                assert lit and not met and named == ()
            elif certificate == "candidates" and named:
                assert met <= set(named)
    assert min(told.values()) > 20


def _met(renderer: tracer.Renderer, light: np.ndarray, point: np.ndarray) -> set[int]:
    """The primitives between a light and a point, of all there are."""
    ray = ray_batch(light[None], (point - light)[None], 1e-5, 1.0)
    everything = np.ones(len(renderer.world.object_of), np.bool_)
    return {int(i) for i in np.flatnonzero(np.isfinite(meet_all(renderer.world, ray, everything).t[0]))}


def _under(plate: list, accelerator: str) -> dict[tuple[str, tuple[int, ...]], int]:
    """What is certified of a square under a plate of two triangles that hide all of it, at so many pixels each."""
    square = quad((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0))
    camera = replace(BEHIND, position=(0.0, -6.0, 2.0), direction=(0.0, 6.0, -2.0))
    made = scene(square + plate, lights=[(0.0, 0.0, 6.0)], camera=camera)
    none, certified = _pair(made, replace(SETTINGS, accelerator=accelerator))
    for _ in range(3):
        expected, frame = none.render(), certified.render()
        assert expected.color.tobytes() == frame.color.tobytes()
    told: Counter[tuple[str, tuple[int, ...]]] = Counter()
    for y, x in np.argwhere((frame.primitive == 0) | (frame.primitive == 1)):
        point = ray_tree(certified, frame, x, y).rays[0]
        certificate, named = _certificates(certified).describe(point.primitive, point.end, 0)
        told[certificate, tuple(sorted(named))] += 1
    assert frame.statistics.shadow.culled == sum(n for (certificate, _), n in told.items() if certificate == "full")
    return told


def test_two_triangles_that_overlap_hide_a_square_together(accelerator: str):
    plate = [[(0.2, -6, 3), (0.2, 6, 3), (-6, 0, 3)], [(-0.2, -6, 3), (-0.2, 6, 3), (6, 0, 3)]]
    told = _under(plate, accelerator)
    assert {certificate for certificate, _ in told} == {"full"} and told["full", (2, 3)] > 50


def test_under_a_plate_all_but_its_diagonal_is_certified(accelerator: str):
    """Rays to there are certain to be blocked, but neither triangle is certain to be what blocks them."""
    told = _under(roof(3.0, 2.0), accelerator)
    assert told["full", (2,)] > 40 and told["full", (3,)] > 40
    assert all({2, 3} <= set(named) for certificate, named in told if certificate == "candidates")


# --- frames that are none -----------------------------------------------------------------------------


def test_resolutions_may_change_between_frames(accelerator: str):
    none, certified = _pair(LIT_SQUARES, replace(SETTINGS, accelerator=accelerator))
    for width, height in ((64, 48), (200, 20), (7, 5), (64, 48)):
        for renderer in (none, certified):
            renderer.settings = replace(renderer.settings, width=width, height=height)
        for _ in range(2):
            expected, frame = none.render(), certified.render()
            assert expected.color.tobytes() == frame.color.tobytes()
            assert frame.cells is not None and frame.cells.shape == (height, width)
    assert frame.statistics.shadow.culled > 0


def test_cancelled_frames_leave_nothing_wrong_behind(accelerator: str):
    none, certified = _pair(SAILING, replace(SETTINGS, accelerator=accelerator, width=98, height=66))
    cancelled = 0
    for number, time in enumerate(GOING):
        asked = iter(range(number))
        try:
            certified.render(time, cancel=lambda asked=asked: next(asked, None) is None)
        except Cancelled:
            cancelled += 1
        at = GOING[-1 - number]
        expected, frame = none.render(at), certified.render(at)
        assert expected.color.tobytes() == frame.color.tobytes(), f"after {number} questions"
    assert cancelled > 5 and frame.statistics.shadow.culled > 0 and (_states(certified) == CANDIDATES).any()


def _counted(frame: tracer.Frame) -> dict:
    return frame.statistics.to_dict() | {"seconds": 0, "phases": {}}


ASIDE = replace(BEHIND, position=(6.0, -10.0, 3.0), direction=(-6.0, 10.0, -3.0))


def _counters_after(settings: tracer.Settings, give_up: Callable[[tracer.Renderer], None]) -> list[dict]:
    """Of three frames, after the first two of which another is given up."""
    certified, frames = tracer.Renderer(LIT_SQUARES, settings, cost_model=EAGER), []
    for number in range(3):
        frames.append(certified.render())
        if number < 2:
            give_up(certified)
    return [_counted(frame) for frame in frames]


def test_counters_after_a_cancelled_frame_are_those_without_it(accelerator: str):
    """Whenever it was cancelled."""
    settings = replace(SETTINGS, accelerator=accelerator, width=98, height=66)
    expected = _counters_after(settings, lambda certified: None)
    assert all(one["certificates"] > 0 for one in expected[:2])

    certified, asked = tracer.Renderer(LIT_SQUARES, settings, cost_model=EAGER), []
    certified.render()
    other = certified.render(camera=ASIDE, cancel=lambda: bool(asked.append(True)))
    assert other.statistics.certificates > 20 and len(asked) > 10
    for number in range(len(asked) - 4):  # later frames have less to certify, and ask less often

        def cancelled(certified: tracer.Renderer, number: int = number) -> None:
            questions = iter(range(number))
            with pytest.raises(Cancelled):
                certified.render(camera=ASIDE, cancel=lambda: next(questions, None) is None)

        assert _counters_after(settings, cancelled) == expected, f"cancelled at question {number}"


def test_counters_after_a_picture_that_was_left_before_it_was_whole_are_those_without_it(accelerator: str):
    settings = replace(SETTINGS, accelerator=accelerator, width=98, height=66)
    expected = _counters_after(settings, lambda certified: None)
    for shown in (1, 3):

        def left(certified: tracer.Renderer, shown: int = shown) -> None:
            refining = certified.refine(camera=ASIDE)
            for _ in range(shown):
                next(refining)
            refining.close()

        assert _counters_after(settings, left) == expected, f"left after {shown} pictures"


def test_further_samples_request_nothing(accelerator: str):
    """Though they see, in a mirror, more points of the screens' backs than the first does."""
    mirror = quad((-6, 5, 0), (6, 5, 0), (6, 5, 6), (-6, 5, 6))
    screens = [t for x in range(-3, 3) for t in quad((x, 0, 1), (x + 0.9, 0, 1), (x + 0.9, 0, 3), (x, 0, 3))]
    blinds = [t for x in range(-3, 3) for t in quad((x, 1, 2), (x + 0.4, 1, 2), (x + 0.4, 1, 5), (x, 1, 5))]
    made = scene(
        mirror + screens + blinds,
        lights=[(0.0, 4.0, 4.0), (2.0, 4.0, 5.0)],
        camera=BEHIND,
        materials=(replace(GREY, specular=(0.9, 0.9, 0.9)),),
    )
    settings = replace(SETTINGS, accelerator=accelerator, width=40, height=30)
    one, many = (tracer.Renderer(made, replace(settings, samples=n), cost_model=EAGER) for n in (1, 6))
    seen = [(one.render(), many.render()) for _ in range(4)]
    assert sum(first.statistics.certificates for first, _ in seen[1:]) > 20
    for first, other in seen:
        assert _counted(first) == _counted(other)


@pytest.mark.parametrize("budget", [1, 2])
def test_a_budget_smaller_than_the_number_of_lights_makes_certificates(accelerator: str, budget: int):
    settings = replace(SETTINGS, accelerator=accelerator, certificates=budget)
    none, certified = _pair(LIT_SQUARES, settings)
    expected = none.render()
    for _ in range(6):
        frame = certified.render()
        assert frame.statistics.certificates == budget
        assert frame.color.tobytes() == expected.color.tobytes()
    states = _states(certified)
    assert 5 * budget < np.count_nonzero(states) and states.any(axis=0).sum() > 1


def test_cells_that_share_a_list_of_candidates_share_it_when_others_are_dropped():
    room, lights = 40, 4
    cells, few = make_cells(2, lights, room), np.array([7, 8, 9], np.int32)
    cells.names[2], cells.names[3:6] = len(few) + SETTLED, few
    cells.named[0], cells.used[0] = 6, room
    cells.lists[1:] = 2
    cells.owner[1:], cells.child[1:] = np.arange(1, room) % 2, FINAL
    target = make_cells(2, lights, room)._replace(names=np.zeros(len(cells.names), np.int32))
    copy_kept(cells, np.array([False, True, False, False]), target)
    assert int(target.used[0]) == 1 + room // 2 and int(target.named[0]) == 6
    for cell in range(1, int(target.used[0])):
        for light in range(lights):
            named = named_by(target, cell, light)
            assert named is not None and np.array_equal(named, few)
